module spline_commands
  !! T-SPline (meshes from files) and EXPOrt (meshes to files).
  !!
  !!     T-SPline FILE="name" [MATErial=m] [BODY=b] [NAME=n]
  !!       set MATErial=m [BODY=b]
  !!
  !! The file is text `.iga`, BEXT 2.0 text, BEXT JSON or the project's own `.h5`, told apart by
  !! content; its path is relative to the file that the command stands in. The lines that follow, to
  !! a blank line or the next command, give materials and bodies to element sets of the file.
  !!
  !! The file's nodes and elements follow those that are there: with one file and nothing before
  !! it, node k of the file (from 0) is node k+1. All elements form the element set of the file's
  !! name without folder and ending. The file's sets keep their names (sets of sides become
  !! surfaces). With NAME=n the element set is n and the others are n.SET, so that several
  !! files can be told apart. Elements that repeat an earlier one exactly are left out, functions of
  !! an element that have one node are added. Nodes that no element uses are switched off.
  !!
  !! Differences from FEAP: NAME, the set lines, several files in one deck.
  !!
  !!     EXPOrt FILE="name.iga" | FILE="name.h5"
  !!
  !! writes the mesh with all sets into the folder of the results when the deck is run (not with
  !! --check), whatever the analysis then comes to. Node and element numbers stay.
  use kinds, only: wp
  use messages, only: message_log, deck_place, quoted, whole_text, in_place, name_hint, string, &
    lower_case
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type, set_nodes, set_elements, set_surface, mesh_export
  use model_sets, only: add_set, find_set_of_kind, set_names
  use mesh_draft, only: draft_type
  use data_lines, only: next_line
  use element_commands, only: begin_origin
  use extraction_mesh, only: extraction_mesh_type, problem_list, used_by_elements, &
    repeated_elements, names_a_node_twice, set_of_nodes, set_of_elements
  use mesh_files, only: read_mesh_file, report_problems
  use file_system, only: file_exists, folder_exists
  implicit none (type, external)
  private
  public :: read_spline_file, read_export, follow_tied_nodes, beside

contains

  subroutine read_spline_file(deck, command, model, draft, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(extraction_mesh_type), target :: mesh
    type(problem_list) :: problems
    character(:), allocatable :: file, name, path, prefix
    integer, allocatable :: new_of(:)
    integer :: body, material, error_count

    error_count = log%error_count()
    file = ''
    name = ''
    material = 1
    body = 1
    call command%text_option('file', file, log)
    call command%text_option('name', name, log)
    call command%integer_option('material', material, log)
    call command%integer_option('body', body, log)
    call command%check_options([character(8) :: 'file', 'material', 'body', 'name'], log)
    if (len(file) == 0) call command%add_error(log, 'the name of the file is missing', &
      'Write T-SPline FILE="name"')
    if (body < 1) call command%add_error(log, 'bodies are numbered from 1', '')
    prefix = ''
    if (len(name) > 0) prefix = name // '.'
    if (len(name) == 0) name = stem(file)
    if (log%error_count() == error_count) then
      path = beside(command%at%file, file)
      if (.not. file_exists(path) .or. folder_exists(path)) then
        call command%add_error(log, 'there is no file ' // quoted(path), &
          'The name is relative to the deck; put it in quotes')
        draft%has_lost_file = .true.
        call pass_lines(deck, log)
        return
      end if
      call read_mesh_file(path, mesh, problems)
      if (problems%count == 0 .and. model%ndm == 2) call check_plane(mesh, problems)
      call report_problems(problems, path, 'T-SPline', command%at%order, log)
    end if
    if (log%error_count() > error_count) then
      draft%has_lost_file = .true.
      call pass_lines(deck, log)
      return
    end if
    call add_elements(mesh, path, name, material, body, command, model, draft, log, new_of)
    call add_sets(mesh, path, name, prefix, command, new_of, draft%nn - mesh%nn, model, log)
    call read_set_lines(deck, prefix, model, draft, log)
  end subroutine read_spline_file

  subroutine check_plane(mesh, problems)
    type(extraction_mesh_type), intent(in) :: mesh
    type(problem_list), intent(inout) :: problems
    logical, allocatable :: used(:)
    integer :: a

    call used_by_elements(mesh, used)
    do a = 1, mesh%nn
      if (.not. used(a) .or. .not. abs(mesh%x(3, a)) > 0) cycle
      call problems%add(mesh%node_line(a), 'a node of a deck in the plane has z /= 0', &
        'Let ndm be 3 in the deck, or correct the file')
      return
    end do
  end subroutine check_plane

  subroutine add_elements(mesh, path, name, material, body, command, model, draft, log, new_of)
    type(extraction_mesh_type), intent(in), target :: mesh
    character(*), intent(in) :: path, name
    integer, intent(in) :: material, body
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    integer, allocatable, intent(out) :: new_of(:)   !! element of the mesh (ne of the file)
    type(record) :: origin
    integer, allocatable :: op_of(:), same_as(:)
    integer :: a, e, first, id, old_nn, op, repeated

    old_nn = draft%nn
    do a = 1, mesh%nn
      call draft%set_node(old_nn + a, mesh%x(1:model%ndm, a), mesh%w(a))
    end do
    origin = command
    origin%at%file = path
    origin%at%line = 0
    call begin_origin(draft, origin, 'T-SPline', name)
    draft%origins(size(draft%origins))%is_open = .false.
    call repeated_elements(mesh%elements, same_as)
    allocate (new_of(mesh%elements%ne))
    allocate (op_of(mesh%elements%nop), source=0)
    first = model%mesh%ne + 1
    repeated = 0
    do e = 1, mesh%elements%ne
      if (same_as(e) > 0) then
        new_of(e) = new_of(same_as(e))
        repeated = repeated + 1
        if (repeated == 1) id = e
        cycle
      end if
      if (names_a_node_twice(mesh%elements%connectivity(e))) then
        call add_with_sums(mesh%elements%connectivity(e), mesh%elements%operator(e))
        cycle
      end if
      op = mesh%elements%operator_of(e)
      if (op_of(op) == 0) call model%mesh%add_operator(mesh%elements%operator(e), op_of(op))
      call model%mesh%add_element_with_operator(mesh%elements%dp(e), mesh%elements%degree(:, e), &
        mesh%elements%connectivity(e) + old_nn, op_of(op), new_of(e))
    end do
    if (repeated > 0) then
      origin%at%line = mesh%element_line(id)
      call log%add_warning(origin%at, 'T-SPline', whole_text(repeated) // &
        ' elements repeat an earlier one exactly (the first of them begins here)', &
        'They are left out')
    end if
    call draft%note_elements(first, model%mesh%ne, material, body, origin%at)
    do e = 1, mesh%elements%ne
      if (same_as(e) == 0) draft%line(new_of(e)) = mesh%element_line(e)
    end do

  contains

    subroutine add_with_sums(nodes, ce)
      !! Functions of one node become one function.
      integer, intent(in) :: nodes(:)
      real(wp), intent(in) :: ce(:, :)
      real(wp), allocatable :: sums(:, :)
      integer :: distinct(size(nodes)), b, k, n

      allocate (sums(size(nodes), size(ce, 2)), source=0.0_wp)
      n = 0
      do b = 1, size(nodes)
        k = findloc(distinct(1:n), nodes(b), dim=1)
        if (k == 0) then
          n = n + 1
          k = n
          distinct(n) = nodes(b)
        end if
        sums(k, :) = sums(k, :) + ce(b, :)
      end do
      call model%mesh%add_element(mesh%elements%dp(e), mesh%elements%degree(:, e), &
        distinct(1:n) + old_nn, sums(1:n, :), new_of(e))
    end subroutine add_with_sums
  end subroutine add_elements

  subroutine add_sets(mesh, path, name, prefix, command, new_of, old_nn, model, log)
    !! Node sets hold their nodes as they are before TIE (follow_tied_nodes).
    type(extraction_mesh_type), intent(in) :: mesh
    character(*), intent(in) :: path, name, prefix
    type(record), intent(in) :: command
    integer, intent(in) :: new_of(:)             !! elements of the mesh
    integer, intent(in) :: old_nn                !! nodes before those of the file
    type(model_type), intent(inout) :: model
    type(message_log), intent(inout) :: log
    type(deck_place) :: at
    integer, allocatable :: items(:), sides(:)
    integer :: e, i, kind, old
    logical :: has_own

    at = command%at
    at%file = path
    has_own = .false.
    do i = 1, size(mesh%sets)
      associate (set => mesh%sets(i))
        at%line = set%line
        kind = set_surface
        if (set%kind == set_of_nodes) kind = set_nodes
        if (set%kind == set_of_elements) kind = set_elements
        old = find_set_of_kind(model, prefix // set%name, kind)
        if (old > 0) then
          call log%add_error(at, 'T-SPline', 'the name ' // quoted(prefix // set%name) // &
            ' is taken', 'See ' // model%sets(old)%place // &
            '; with NAME=n in the command the sets of this file are called n.SET')
          cycle
        end if
        has_own = has_own .or. (kind == set_elements .and. lower_case(prefix // set%name) == &
          lower_case(name))
        if (kind == set_nodes) then
          call add_set(model, prefix // set%name, in_place(at), kind, set%items + old_nn, set%sides)
        else
          items = new_of(set%items)
          sides = set%sides
          call drop_repeated(items, sides)
          call add_set(model, prefix // set%name, in_place(at), kind, items, sides)
        end if
      end associate
    end do
    if (has_own) return
    at%line = 0
    old = find_set_of_kind(model, name, set_elements)
    if (old > 0) then
      call command%add_error(log, 'the name ' // quoted(name) // ' is taken', 'See ' // &
        model%sets(old)%place // '; give another by NAME=n')
    else
      call add_set(model, name, in_place(at), set_elements, [(e, e = minval(new_of), &
        maxval(new_of))], [integer ::])
    end if
  end subroutine add_sets

  subroutine drop_repeated(items, sides)
    !! Elements, or elements with sides, each once, in their order.
    integer, allocatable, intent(inout) :: items(:), sides(:)
    logical, allocatable :: seen(:, :), keep(:)
    integer :: k, side

    allocate (seen(0:6, maxval([1, items])), source=.false.)
    allocate (keep(size(items)))
    do k = 1, size(items)
      side = 0
      if (size(sides) > 0) side = sides(k)
      keep(k) = .not. seen(side, items(k))
      seen(side, items(k)) = .true.
    end do
    if (all(keep)) return
    if (size(sides) > 0) sides = pack(sides, keep)
    items = pack(items, keep)
  end subroutine drop_repeated

  subroutine read_set_lines(deck, prefix, model, draft, log)
    !! `set MATErial=m [BODY=b]`: of element sets.
    type(deck_type), intent(inout) :: deck
    character(*), intent(in) :: prefix
    type(model_type), intent(in) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(record) :: rec
    integer :: body, material, set
    logical :: more

    do
      call next_line(deck, rec, log, more, may_end=.true., names=set_names(model, set_elements))
      if (.not. more) exit
      if (rec%is_damaged) cycle
      set = find_set_of_kind(model, rec%word(1), set_elements)
      if (set == 0) set = find_set_of_kind(model, prefix // rec%word(1), set_elements)
      if (set == 0) then
        call rec%add_error(log, 'there is no element set ' // quoted(rec%word(1)) // &
          ' (nor a command of that name)', &
          name_hint(rec%word(1), set_names(model, set_elements), 'element sets'))
        cycle
      end if
      material = 0
      body = 0
      call rec%integer_option('material', material, log)
      call rec%integer_option('body', body, log)
      call rec%check_options([character(8) :: 'material', 'body'], log)
      if (material == 0 .and. body == 0) call rec%add_error(log, &
        'this line gives neither material nor body', 'Write set MATErial=m [BODY=b]')
      if (body < 0) call rec%add_error(log, 'bodies are numbered from 1', '')
      if (material /= 0) draft%material(model%sets(set)%items) = material
      if (body > 0) draft%body(model%sets(set)%items) = body
    end do
  end subroutine read_set_lines

  subroutine pass_lines(deck, log)
    !! The lines of a file that could not be read.
    type(deck_type), intent(inout) :: deck
    type(message_log), intent(inout) :: log
    type(record) :: rec
    logical :: more

    do
      call next_line(deck, rec, log, more, may_end=.true.)
      if (.not. more) exit
    end do
  end subroutine pass_lines

  subroutine follow_tied_nodes(model, draft)
    !! Node sets of files name the nodes that stand for theirs after TIE.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(in) :: draft
    integer :: i

    do i = 1, size(model%sets)
      if (model%sets(i)%kind == set_nodes) model%sets(i)%items = &
        draft%tied_to(model%sets(i)%items)
    end do
  end subroutine follow_tied_nodes

  subroutine read_export(command, model, log)
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(message_log), intent(inout) :: log
    type(mesh_export) :: new
    character(:), allocatable :: file
    integer :: point

    file = ''
    call command%text_option('file', file, log)
    call command%check_options(['file'], log)
    new%at = command%at
    new%file = file
    point = index(file, '.', back=.true.)
    if (len(file) == 0) then
      call command%add_error(log, 'the name of the file is missing', &
        'Write EXPOrt FILE="name.iga" or FILE="name.h5"')
      return
    else if (index(file, '/') > 0 .or. scan(file, new_line('a')) > 0) then
      call command%add_error(log, 'the file ' // quoted(file) // ' would lie elsewhere', &
        'It is written into the folder of the results: give its name alone')
      return
    end if
    select case (lower_case(file(point + 1:)))
    case ('iga');   new%is_text = .true.
    case ('h5');    new%is_text = .false.
    case default
      call command%add_error(log, 'the ending of ' // quoted(file) // ' names no known format', &
        'It is .iga or .h5')
      return
    end select
    if (lower_case(file) == 'restart.h5') call command%add_error(log, &
      'the file ' // quoted(file) // ' is written by the program itself', 'Give another name')
    model%exports = [model%exports, new]
  end subroutine read_export

  pure function beside(file, name) result(path)
    !! A path that is relative to the folder of a file.
    character(*), intent(in) :: file, name
    character(:), allocatable :: path

    path = name
    if (name(1:1) /= '/') path = file(1:index(file, '/', back=.true.)) // name
  end function beside

  pure function stem(file) result(name)
    !! Without folder and ending.
    character(*), intent(in) :: file
    character(:), allocatable :: name
    integer :: point

    name = file(index(file, '/', back=.true.) + 1:)
    point = index(name, '.', back=.true.)
    if (point > 1) name = name(1:point - 1)
  end function stem
end module spline_commands
