subroutine umesh3(tx, prt)
  !! Mesh command OPERator id: the rows of an extraction operator that several elements of BEZIer share, a record for each
  !! function, to a blank record.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use feap_host, only: this_record, record_length, fail
  use feap_items, only: item_list, split_record, read_items
  use feap_arrays, only: is_counting, count_mesh
  use feap_mesh, only: begin_pass, add_operator, last_node, last_element
  implicit none
  character(15), intent(in) :: tx(*)      ! FEAP's items: they hold but 15 letters
  logical, intent(in) :: prt              ! whether data are to be printed
  include 'umac1.h'
  character(record_length) :: line
  type(item_list) :: items
  real(wp), allocatable :: row(:), rows(:, :), more(:, :)
  integer :: id
  logical, external :: pcomp

  if (pcomp(uct, 'mes3', 4)) then
    uct = 'oper'
    return
  end if
  call begin_pass(is_counting())
  call this_record(line)
  call split_record(line, items)
  if (items%n < 2) call fail('OPERator: write OPERator and its number')
  id = items%whole(2)
  do
    call read_items(items)
    if (items%n == 0) exit
    call items%rest(1, row)
    if (.not. allocated(rows)) allocate (rows(0, size(row)))
    if (size(row) /= size(rows, 2)) call fail('row '//whole_number(size(rows, 1) + 1)//' of OPERator '// &
      whole_number(id)//' has '//whole_number(size(row))//' coefficients, the first has '//whole_number(size(rows, 2)))
    allocate (more(size(rows, 1) + 1, size(row)))
    more(1:size(rows, 1), :) = rows
    more(size(more, 1), :) = row
    call move_alloc(more, rows)
  end do
  if (.not. allocated(rows)) call fail('OPERator '//whole_number(id)//' has no rows')
  call add_operator(id, rows)
  if (is_counting()) call count_mesh(last_node, last_element, 0)
end subroutine umesh3
