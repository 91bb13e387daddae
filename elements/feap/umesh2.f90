subroutine umesh2(tx, prt)
  !! Mesh command BEZIer [MATErial=m]: elements in the form of the project's decks, records
  !! `e DEGRee p q [r] NODEs n1 n2 ... [MATErial=m] [OPERator=id]`, each followed, without OPERator, by a record of
  !! coefficients for each node. A blank record ends the command; a record that ends with & goes on in the next one.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use feap_host, only: this_record, record_length, fail, note
  use feap_items, only: item_list, split_record, read_items
  use feap_arrays, only: is_counting, count_mesh, store_element
  use feap_mesh, only: begin_pass, add_element, find_operator, mesh, last_node, last_element
  implicit none
  character(15), intent(in) :: tx(*)      ! FEAP's items: they hold but 15 letters
  logical, intent(in) :: prt              ! whether data are to be printed
  include 'umac1.h'
  character(record_length) :: line
  type(item_list) :: items
  integer, allocatable :: degree(:), nodes(:), list(:)
  real(wp), allocatable :: ce(:, :), row(:)
  integer :: material, own_material, e, a, id, op, nb, most, first
  logical, external :: pcomp

  if (pcomp(uct, 'mes2', 4)) then
    uct = 'bezi'
    return
  end if
  call begin_pass(is_counting())
  call this_record(line)
  call split_record(line, items)
  material = 1
  if (items%find('mate') > 0) material = items%whole(items%find('mate'))
  most = 0
  first = last_element
  do
    call read_items(items)
    if (items%n == 0) exit
    e = items%whole(1)
    call items%integers_after('degr', degree)
    call items%integers_after('node', nodes)
    if (size(degree) < 1 .or. size(degree) > 3 .or. size(nodes) < 1) &
      call fail('BEZIer, behind element '//whole_number(last_element)// &
      ': write e DEGRee p q NODEs n1 n2 ..., and a row for each node, in place of: '//items%line)
    own_material = material
    if (items%find('mate') > 0) own_material = items%whole(items%find('mate'))
    nb = product(degree + 1)
    call items%integers_after('oper', list)
    if (size(list) > 0) then
      op = find_operator(list(1))
      if (op == 0) call fail('element '//whole_number(e)//': there is no OPERator '//whole_number(list(1))// &
        ' before BEZIer')
      if (mesh%op_rows(op) /= size(nodes) .or. mesh%op_columns(op) /= nb) call fail('element '//whole_number(e)// &
        ' needs '//whole_number(size(nodes))//' rows of '//whole_number(nb)//' coefficients, OPERator '// &
        whole_number(list(1))//' has '//whole_number(mesh%op_rows(op))//' of '//whole_number(mesh%op_columns(op)))
      call add_element(e, degree, nodes, op=op, id=id)
    else
      if (allocated(ce)) deallocate (ce)
      allocate (ce(size(nodes), nb))
      do a = 1, size(nodes)
        call read_items(items)
        call items%rest(1, row)
        if (size(row) /= nb) call fail('row '//whole_number(a)//' of element '//whole_number(e)//' has '// &
          whole_number(size(row))//' coefficients. Its degrees need '//whole_number(nb))
        ce(a, :) = row
      end do
      call add_element(e, degree, nodes, ce=ce, id=id)
    end if
    most = max(most, size(nodes))
    if (.not. is_counting()) call store_element(e, own_material, nodes)
  end do
  if (is_counting()) call count_mesh(last_node, last_element, most)
  if (prt .and. .not. is_counting()) call note('BEZIer: elements up to '//whole_number(max(first, last_element)))
end subroutine umesh2
