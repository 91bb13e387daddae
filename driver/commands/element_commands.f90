module element_commands
  !! ELEMents (FEAP's numbering of Lagrange elements), OPERator and BEZIer (elements with their
  !! extraction operators).
  !!
  !! Differences from FEAP: element numbers rise one by one; 2D elements have 4 or 9 nodes, 3D
  !! elements 8; the rest is BEZIer's. `BODY=b` of a command gives its elements to body b (1).
  use kinds, only: wp
  use messages, only: message_log, whole_text, in_place
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type
  use mesh_draft, only: draft_type, element_origin, named_operator
  use data_lines, only: next_line
  use lagrange, only: lagrange_operator, lagrange_nodes, equispaced
  use tensor_product, only: tensor_operator
  implicit none (type, external)
  private
  public :: read_elements, read_operator, read_bezier, element_options, begin_origin

  !> place in the tensor grid (first direction fastest) of each node in FEAP's order
  integer, parameter :: quad_4(4) = [1, 2, 4, 3]
  integer, parameter :: quad_9(9) = [1, 3, 9, 7, 2, 6, 8, 4, 5]
  integer, parameter :: brick_8(8) = [1, 2, 4, 3, 5, 6, 8, 7]

contains

  subroutine element_options(rec, material, body, log)
    !! MATErial=m and BODY=b of a command.
    type(record), intent(in) :: rec
    integer, intent(inout) :: material, body    !! stay if not given
    type(message_log), intent(inout) :: log

    call rec%integer_option('material', material, log)
    call rec%integer_option('body', body, log)
    call rec%check_options([character(8) :: 'material', 'body'], log)
    if (body < 1) then
      call rec%add_error(log, 'bodies are numbered from 1', '')
      body = 1
    end if
  end subroutine element_options

  subroutine begin_origin(draft, rec, command, name)
    !! The elements that follow come from this data set (or from another file that it includes).
    type(draft_type), intent(inout) :: draft
    type(record), intent(in) :: rec
    character(*), intent(in) :: command, name
    type(element_origin) :: origin
    integer :: n

    n = size(draft%origins)
    if (n > 0) then
      associate (last => draft%origins(n))
        if (command == last%command .and. name == last%name .and. rec%at%file == last%at%file &
          .and. last%is_open) return
        last%is_open = .false.
      end associate
    end if
    origin%at = rec%at
    origin%command = command
    origin%name = name
    origin%is_open = .true.
    draft%origins = [draft%origins, origin]
  end subroutine begin_origin

  subroutine end_origin(draft)
    type(draft_type), intent(inout) :: draft

    if (size(draft%origins) > 0) draft%origins(size(draft%origins))%is_open = .false.
  end subroutine end_origin

  subroutine check_number(rec, e, model, draft, log)
    !! Element numbers rise one by one. A number that is wrong is told once, then counting goes on
    !! from there.
    type(record), intent(in) :: rec
    integer, intent(in) :: e                     !! as the deck says
    type(model_type), intent(in) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    integer :: expected

    expected = model%mesh%ne + draft%lost_elements + 1
    if (e == expected) return
    call rec%add_error(log, 'expected element ' // whole_text(expected) // ', found ' // &
      whole_text(e), &
      'Element numbers rise one by one')
    draft%lost_elements = e - 1 - model%mesh%ne
  end subroutine check_number

  subroutine read_elements(deck, command, model, draft, log)
    !! Records `n ng mat n1 n2 ...`: elements between n and that of the next record have nodes
    !! n1+ng, n1+2ng, ... (0: 1).
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command          !! the command itself
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(record) :: rec
    integer, allocatable :: nodes(:), old(:)
    integer :: body, material, old_material, n, ng, old_n, old_ng, k
    logical :: more

    body = 1
    call command%integer_option('body', body, log)
    call command%check_options(['body'], log)
    old_n = 0
    old_ng = 1
    old_material = 1
    allocate (old(0))
    do
      call next_line(deck, rec, log, more)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      call begin_origin(draft, rec, 'ELEMents', '')
      if (.not. any(rec%count - 3 == merge([4, 9], [8, 8], model%ndm == 2))) then
        call rec%add_error(log, 'an element with ' // whole_text(max(0, rec%count - 3)) // &
          ' nodes', &
          'Records are n ng mat n1 n2 ... with ' // trim(merge('4 or 9', '8     ', &
          model%ndm == 2)) // &
          ' nodes; others are given by BEZIer')
        draft%lost_elements = draft%lost_elements + 1
        old_n = 0
        cycle
      end if
      allocate (nodes(rec%count - 3))
      call rec%integer(1, n, log, 'element number')
      call rec%integer(2, ng, log, 'increment', 0)
      call rec%integer(3, material, log, 'material')
      call rec%integers(4, nodes, log, 'nodes')
      if (old_n > 0 .and. size(old) == size(nodes)) then
        do k = old_n + 1, n - 1
          call add_lagrange(old + merge(old_ng, 1, old_ng /= 0)*(k - old_n), old_material)
        end do
      end if
      call check_number(rec, n, model, draft, log)
      call add_lagrange(nodes, material)
      old_n = n
      old_ng = ng
      old_material = material
      call move_alloc(nodes, old)
    end do
    call end_origin(draft)

  contains

    subroutine add_lagrange(ix, mat)
      integer, intent(in) :: ix(:), mat
      integer :: grid(size(ix)), dp, p, id
      real(wp), allocatable :: c(:, :), ce(:, :), x(:)

      dp = model%ndm
      p = merge(2, 1, size(ix) == 9)
      allocate (c(p + 1, p + 1), x(p + 1), ce(size(ix), size(ix)))
      call lagrange_nodes(p, equispaced, x)
      call lagrange_operator(p, x, c)
      if (dp == 2) then
        call tensor_operator(c, c, ce)
      else
        call tensor_operator(c, c, c, ce)
      end if
      select case (size(ix))
      case (4);     grid(quad_4) = ix
      case (9);     grid(quad_9) = ix
      case default; grid(brick_8) = ix
      end select
      call model%mesh%add_element(dp, spread(p, 1, dp), grid, ce, id)
      call draft%note_elements(id, id, mat, body, rec%at)
    end subroutine add_lagrange
  end subroutine read_elements

  subroutine read_operator(deck, command, model, draft, log)
    !! OPERator id, then its rows.
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(named_operator) :: new
    type(record) :: rec
    real(wp), allocatable :: rows(:, :), row(:)
    integer :: i, n, error_count
    logical :: more

    error_count = log%error_count()
    new%at = command%at
    call command%integer(2, new%id, log, 'number of the operator')
    do i = 1, size(draft%operators)
      if (draft%operators(i)%id == new%id) call command%add_error(log, 'operator ' // &
        whole_text(new%id) // &
        ' is defined twice', 'The first stands in ' // in_place(draft%operators(i)%at))
    end do
    allocate (rows(0, 0))
    n = 0
    do
      call next_line(deck, rec, log, more)
      if (.not. more) exit
      if (n > 0 .and. rec%count /= size(rows, 1)) then
        call rec%add_error(log, 'this row has ' // whole_text(rec%count) // &
          ' coefficients, the first has ' // &
          whole_text(size(rows, 1)), &
          'A row is a function, its coefficients are those of the Bernstein polynomials')
        cycle
      end if
      allocate (row(rec%count))
      call rec%numbers(1, row, log, 'coefficients')
      rows = reshape([rows, row], [size(row), n + 1])
      n = n + 1
      deallocate (row)
    end do
    if (n == 0) call command%add_error(log, 'the operator has no rows', &
      'Give one row for each function')
    if (log%error_count() == error_count) call model%mesh%add_operator(transpose(rows), new%op)
    draft%operators = [draft%operators, new]
  end subroutine read_operator

  subroutine read_bezier(deck, command, model, draft, log)
    !! Records `e DEGRee p q [r] NODEs n1 ... nn [MATErial=m] [OPERator=id]`, each followed, without
    !! OPERator, by nn rows of (p+1)(q+1)[(r+1)] coefficients.
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(record) :: rec
    integer, allocatable :: degree(:), nodes(:)
    real(wp), allocatable :: ce(:, :)
    integer :: body, material, own_material, operator, op, e, i, id, nb, error_count
    logical :: more

    material = 1
    body = 1
    call element_options(command, material, body, log)
    do
      call next_line(deck, rec, log, more)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      call begin_origin(draft, rec, 'BEZIer', '')
      error_count = log%error_count()
      own_material = material
      operator = 0
      call rec%integer(1, e, log, 'element number')
      call list_after(rec, 'degr', 'degrees', degree, log)
      call list_after(rec, 'node', 'nodes', nodes, log)
      call rec%integer_option('material', own_material, log)
      call rec%integer_option('operator', operator, log)
      call rec%check_options([character(8) :: 'degree', 'nodes', 'material', 'operator'], log)
      if (log%error_count() == error_count) then
        if (size(degree) < 1 .or. size(degree) > 3 .or. any(degree < 1)) call rec%add_error(log, &
          'an element has 1 to 3 degrees, all positive', 'Write e DEGRee p q NODEs n1 n2 ...')
        if (size(nodes) == 0) call rec%add_error(log, 'the element has no nodes', &
          'Write e DEGRee p q NODEs n1 n2 ...')
      end if
      if (log%error_count() > error_count) then
        if (operator == 0) call skip_rows(deck, size(nodes), log, more)
        draft%lost_elements = draft%lost_elements + 1
        if (.not. more) exit
        cycle
      end if
      call check_number(rec, e, model, draft, log)
      nb = product(degree + 1)
      op = 0
      if (operator > 0) then
        do i = 1, size(draft%operators)
          if (draft%operators(i)%id == operator) op = i
        end do
        if (op == 0) then
          call rec%add_error(log, 'there is no operator ' // whole_text(operator), &
            known_operators(draft))
        else
          op = draft%operators(op)%op
          if (op > 0) call check_operator(rec, model, op, operator, size(nodes), nb, log)
        end if
      else
        if (allocated(ce)) deallocate (ce)
        allocate (ce(size(nodes), nb))
        call read_rows(deck, e, ce, log, more)
        if (log%error_count() == error_count) call model%mesh%add_operator(ce, op)
      end if
      if (log%error_count() == error_count .and. op > 0) then
        call model%mesh%add_element_with_operator(size(degree), degree, nodes, op, id)
        call draft%note_elements(id, id, own_material, body, rec%at)
      else
        draft%lost_elements = draft%lost_elements + 1
      end if
      if (.not. more) exit
    end do
    call end_origin(draft)
  end subroutine read_bezier

  subroutine check_operator(rec, model, op, operator, nen, nb, log)
    type(record), intent(in) :: rec
    type(model_type), intent(in) :: model
    integer, intent(in) :: op, operator          !! its numbers in the mesh and in the deck
    integer, intent(in) :: nen, nb               !! functions and Bernstein polynomials
    type(message_log), intent(inout) :: log

    if (model%mesh%op_rows(op) /= nen) call rec%add_error(log, 'operator ' // &
      whole_text(operator) // ' has ' // &
      whole_text(model%mesh%op_rows(op)) // ' rows, the element has ' // whole_text(nen) // &
      ' nodes', '')
    if (model%mesh%op_columns(op) /= nb) call rec%add_error(log, 'operator ' // &
      whole_text(operator) // &
      ' has rows of ' // whole_text(model%mesh%op_columns(op)) // &
      ' coefficients, the degrees need ' // &
      whole_text(nb), '')
  end subroutine check_operator

  function known_operators(draft) result(text)
    type(draft_type), intent(in) :: draft
    character(:), allocatable :: text
    integer :: i

    text = 'There are no operators before this line'
    if (size(draft%operators) == 0) return
    text = 'Known operators:'
    do i = 1, min(20, size(draft%operators))
      text = text // ' ' // whole_text(draft%operators(i)%id)
    end do
  end function known_operators

  subroutine list_after(rec, word, what, list, log)
    !! Whole numbers after a word, up to the next word.
    type(record), intent(in) :: rec
    character(4), intent(in) :: word
    character(*), intent(in) :: what
    integer, allocatable, intent(out) :: list(:)
    type(message_log), intent(inout) :: log
    integer :: first, last

    first = rec%find(word)
    if (first == 0) then
      allocate (list(0))
      call rec%add_error(log, 'the element has no ' // what, 'Write e DEGRee p q NODEs n1 n2 ...')
      return
    end if
    last = first
    do while (last <= rec%count)
      if (any(rec%key(last) == ['degr', 'node', 'mate', 'oper'])) exit
      last = last + 1
    end do
    allocate (list(last - first))
    call rec%integers(first, list, log, what)
  end subroutine list_after

  subroutine read_rows(deck, e, ce, log, more)
    type(deck_type), intent(inout) :: deck
    integer, intent(in) :: e                     !! element, for messages
    real(wp), intent(out) :: ce(:, :)            !! its extraction operator (nen,nb)
    type(message_log), intent(inout) :: log
    logical, intent(out) :: more                 !! .false.: the set ended too early
    type(record) :: rec
    integer :: a

    ce = 0
    do a = 1, size(ce, 1)
      call next_line(deck, rec, log, more)
      if (.not. more) then
        call rec%add_error(log, 'element ' // whole_text(e) // ' has ' // whole_text(a - 1) // &
          ' rows of ' // &
          whole_text(size(ce, 1)), 'Give a row of its extraction operator for each node')
        return
      end if
      if (rec%count /= size(ce, 2)) then
        call rec%add_error(log, 'row ' // whole_text(a) // ' of element ' // whole_text(e) // &
          ' has ' // &
          whole_text(rec%count) // ' coefficients', 'Its degrees need ' // whole_text(size(ce, 2)))
      else
        call rec%numbers(1, ce(a, :), log, 'coefficients')
      end if
    end do
  end subroutine read_rows

  subroutine skip_rows(deck, n, log, more)
    type(deck_type), intent(inout) :: deck
    integer, intent(in) :: n
    type(message_log), intent(inout) :: log
    logical, intent(out) :: more
    type(record) :: rec
    integer :: a

    more = .true.
    do a = 1, n
      call next_line(deck, rec, log, more)
      if (.not. more) return
    end do
  end subroutine skip_rows
end module element_commands
