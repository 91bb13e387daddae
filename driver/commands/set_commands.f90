module set_commands
  !! SET and TIE: read as they come, carried out at END, when all nodes and elements are there.
  use kinds, only: wp
  use messages, only: message_log, deck_place, string, whole_text, quoted, name_hint, known_names, &
    in_place
  use expressions, only: value, number_value, word_value
  use deck_record, only: record
  use model_data, only: model_type, set_nodes, set_elements, set_surface
  use model_sets, only: find_set, set_names, add_set, used_nodes, nodes_of_set, unite_sets, &
    common_nodes, sorted_unique
  use mesh_draft, only: draft_type, set_request, tie_request
  use data_lines, only: name_or_number
  use tie_nodes, only: coinciding_nodes, renumber_mesh
  implicit none (type, external)
  private
  public :: read_set, read_tie, resolve_ties, resolve_sets

  character(8), parameter :: set_kinds(6) = [character(8) :: 'NODEs', 'ELEMents', 'SURFace', &
    'UNION', 'BOX', 'CORNer']

contains

  subroutine read_set(command, draft, log)
    !! SET name NODEs n1 n2 ... | ELEMents e1 e2 ... | SURFace e1 side1 e2 side2 ... | UNION a b ...
    !! | BOX x1 x2 y1 y2 [z1 z2] | CORNer a b ...
    type(record), intent(in) :: command
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(set_request) :: new
    type(string) :: name
    real(wp) :: x
    integer :: i

    new%at = command%at
    new%keyword = command%key(3)
    allocate (new%names(0), new%numbers(0))
    call command%text(2, new%name, log, 'name of the set')
    if (len(new%name) == 0) return
    if (.not. any(new%keyword == ['node', 'elem', 'surf', 'unio', 'box ', 'corn'])) then
      call command%add_error(log, 'unknown kind of set ' // quoted(command%word(3)), &
        known_names(set_kinds, 'kinds'), 3)
      new%keyword = 'lost'
    else if (command%count < 4) then
      call command%add_error(log, 'the set ' // quoted(new%name) // ' is empty', '')
      new%keyword = 'lost'
    end if
    do i = 4, command%count
      select case (new%keyword)
      case ('unio', 'corn')
        call command%text(i, name%s, log, 'name of a set')
        new%names = [new%names, name]
      case ('node', 'elem', 'surf', 'box')
        call command%number(i, x, log, 'member')
        new%numbers = [new%numbers, x]
      end select
    end do
    if (new%keyword == 'surf' .and. mod(size(new%numbers), 2) /= 0) call command%add_error(log, &
      'an element without side', &
      'Members are pairs: element side, sides are 1 to 6 (s=0, s=1, t=0, t=1, u=0, u=1)')
    draft%sets = [draft%sets, new]
  end subroutine read_set

  subroutine read_tie(command, draft, log)
    !! TIE [tol] [name name ...].
    type(record), intent(in) :: command
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(tie_request) :: new
    type(string) :: name
    type(value) :: v
    integer :: i

    new%at = command%at
    allocate (new%names(0))
    do i = 2, command%count
      call name_or_number(command, i, v, log)
      if (v%kind == number_value .and. i == 2) then
        new%tol = v%x
      else if (v%kind == word_value) then
        name%s = v%word
        new%names = [new%names, name]
      else if (v%kind == number_value) then
        call command%add_error(log, 'expected the name of a patch, found ' // &
          quoted(command%word(i)), &
          'Write TIE [tolerance] [patch patch ...]', i)
      end if
    end do
    if (.not. (new%tol >= 0 .and. new%tol < 1)) call command%add_error(log, &
      'the tolerance is out of range', &
      'It is relative to the size of the model, 1e-9 if not given', 2)
    draft%ties = [draft%ties, new]
  end subroutine read_tie

  subroutine resolve_ties(model, draft, log)
    !! Sets draft%tied_to and renumbers the mesh.
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    integer, allocatable :: group(:), map(:), nodes(:)
    logical, allocatable :: used(:)
    real(wp) :: size_of_model
    integer :: i, j, set, a, e, k, different

    draft%tied_to = [(a, a = 1, model%nn)]
    if (size(draft%ties) == 0) return
    call used_nodes(model, used)
    size_of_model = 0
    do i = 1, model%ndm
      size_of_model = max(size_of_model, maxval(model%x(i, :), mask=used) - minval(model%x(i, :), &
        mask=used))
    end do
    do i = 1, size(draft%ties)
      associate (tie => draft%ties(i))
        allocate (group(model%nn), source=0)
        allocate (map(model%nn))
        if (size(tie%names) == 0) then
          do e = 1, model%mesh%ne
            do k = model%mesh%node_ptr(e), model%mesh%node_ptr(e + 1) - 1
              group(model%mesh%nodes(k)) = model%body_of(e)
            end do
          end do
        end if
        do j = 1, size(tie%names)
          set = find_set(model, tie%names(j)%s)
          if (set == 0) then
            call log%add_error(tie%at, 'TIE', 'there is no patch or set ' // &
              quoted(tie%names(j)%s), &
              name_hint(tie%names(j)%s, set_names(model, 0), 'sets'))
            cycle
          end if
          nodes = nodes_of_set(model, set)
          group(nodes) = 1
        end do
        call coinciding_nodes(model%x, model%w, group, tie%tol*size_of_model, map, different)
        if (different > 0) call log%add_warning(tie%at, 'TIE', whole_text(different) // &
          ' pairs of nodes lie at the same place but differ in weight', 'They stay apart')
        call renumber_mesh(model%mesh, map)
        draft%tied_to = map(draft%tied_to)
        deallocate (group, map)
      end associate
    end do
  end subroutine resolve_ties

  subroutine resolve_sets(model, draft, log)
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    integer :: i

    do i = 1, size(draft%sets)
      call resolve_set(model, draft, draft%sets(i), log)
    end do
  end subroutine resolve_sets

  subroutine resolve_set(model, draft, request, log)
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(set_request), intent(in) :: request
    type(message_log), intent(inout) :: log
    integer, allocatable :: items(:), sides(:), indices(:)
    integer :: kind, old, error_count
    character(:), allocatable :: place

    error_count = log%error_count()
    place = in_place(request%at)
    old = find_set(model, request%name)
    if (old > 0) then
      call log%add_error(request%at, 'SET', 'the name ' // quoted(request%name) // ' is taken', &
        'See ' // model%sets(old)%place)
      return
    end if
    allocate (items(0), sides(0))
    kind = set_nodes
    select case (request%keyword)
    case ('node')
      call check_range(request, nint(request%numbers), model%nn, 'node', log)
      if (log%error_count() == error_count) then
        items = sorted_unique(draft%tied_to(nint(request%numbers)), model%nn)
      end if
    case ('elem')
      kind = set_elements
      call check_range(request, nint(request%numbers), model%mesh%ne, 'element', log)
      items = nint(request%numbers)
    case ('surf')
      kind = set_surface
      items = nint(request%numbers(1::2))
      sides = nint(request%numbers(2::2))
      call check_range(request, items, model%mesh%ne, 'element', log)
      if (log%error_count() == error_count) call check_sides(model, request, items, sides, log)
    case ('box')
      call nodes_in_box(model, request, items, log)
    case ('unio', 'corn')
      call indices_of_names(model, request, indices, log)
      if (size(indices) > 0 .and. log%error_count() == error_count) then
        if (request%keyword == 'unio') then
          call unite_sets(model, indices, kind, items, sides)
        else
          call common_nodes(model, indices, items)
        end if
      end if
    end select
    if (log%error_count() > error_count .or. request%keyword == 'lost') draft%has_lost_sets = .true.
    if (log%error_count() > error_count) then
      items = [integer ::]
      sides = [integer ::]
    end if
    if (size(items) == 0 .and. .not. draft%has_lost_sets) call log%add_error(request%at, 'SET', &
      'the set ' // &
      quoted(request%name) // ' is empty', trim(merge('These sets share no node', &
      'Nothing lies in the box ', &
      request%keyword == 'corn')))
    call add_set(model, request%name, place, kind, items, sides)
  end subroutine resolve_set

  subroutine check_range(request, numbers, most, what, log)
    type(set_request), intent(in) :: request
    integer, intent(in) :: numbers(:), most
    character(*), intent(in) :: what              !! 'node'
    type(message_log), intent(inout) :: log
    integer :: i

    do i = 1, size(numbers)
      if (numbers(i) >= 1 .and. numbers(i) <= most) cycle
      call log%add_error(request%at, 'SET', 'there is no ' // what // ' ' // &
        whole_text(numbers(i)), &
        'Numbers are 1 to ' // whole_text(most))
      return
    end do
  end subroutine check_range

  subroutine check_sides(model, request, items, sides, log)
    type(model_type), intent(in) :: model
    type(set_request), intent(in) :: request
    integer, intent(in) :: items(:), sides(:)
    type(message_log), intent(inout) :: log
    integer :: i

    do i = 1, min(size(items), size(sides))
      if (sides(i) >= 1 .and. sides(i) <= 2*model%mesh%dp(items(i))) cycle
      if (sides(i) == 0 .and. model%mesh%dp(items(i)) == model%ndm - 1) cycle
      call log%add_error(request%at, 'SET', 'element ' // whole_text(items(i)) // &
        ' has no side ' // &
        whole_text(sides(i)), 'Its sides are 1 to ' // whole_text(2*model%mesh%dp(items(i))))
      return
    end do
  end subroutine check_sides

  subroutine nodes_in_box(model, request, items, log)
    !! Bounds count as inside, up to rounding.
    type(model_type), intent(in) :: model
    type(set_request), intent(in) :: request
    integer, allocatable, intent(inout) :: items(:)
    type(message_log), intent(inout) :: log
    logical, allocatable :: inside(:)
    real(wp) :: near
    integer :: a, i

    if (size(request%numbers) /= 2*model%ndm) then
      call log%add_error(request%at, 'SET', 'a box has ' // whole_text(2*model%ndm) // &
        ' bounds, found ' // &
        whole_text(size(request%numbers)), 'Write SET name BOX x1 x2 y1 y2' // &
        trim(merge('      ', ' z1 z2', &
        model%ndm == 2)))
      return
    end if
    call used_nodes(model, inside)
    near = 1e-9_wp*maxval(abs(model%x))
    do a = 1, model%nn
      do i = 1, model%ndm
        inside(a) = inside(a) .and. model%x(i, a) >= request%numbers(2*i - 1) - near &
          .and. model%x(i, a) <= request%numbers(2*i) + near
      end do
    end do
    items = pack([(a, a = 1, model%nn)], inside)
  end subroutine nodes_in_box

  subroutine indices_of_names(model, request, indices, log)
    type(model_type), intent(in) :: model
    type(set_request), intent(in) :: request
    integer, allocatable, intent(out) :: indices(:)
    type(message_log), intent(inout) :: log
    integer :: i

    allocate (indices(size(request%names)))
    do i = 1, size(indices)
      indices(i) = find_set(model, request%names(i)%s)
      if (indices(i) == 0) call log%add_error(request%at, 'SET', 'there is no set ' // &
        quoted(request%names(i)%s) // ' before this line', name_hint(request%names(i)%s, &
        set_names(model, 0), 'sets'))
    end do
  end subroutine indices_of_names
end module set_commands
