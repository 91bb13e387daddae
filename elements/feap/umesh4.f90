subroutine umesh4(tx, prt)
  !! Mesh command SURFace name: records `e side e side ...` to a blank one. Sides: 1 s=0, 2 s=1, 3 t=0, 4 t=1, 5 u=0,
  !! 6 u=1; 0 the element itself (a line in the plane, a surface in space).
  use extraction_mesh, only: whole_number
  use feap_host, only: this_record, record_length, fail
  use feap_items, only: item_list, split_record, read_items
  use feap_arrays, only: is_counting, count_mesh
  use feap_mesh, only: begin_pass, add_surface, has_operator, element_of, mesh, last_node, last_element
  implicit none
  character(15), intent(in) :: tx(*)      ! FEAP's items: they hold but 15 letters
  logical, intent(in) :: prt              ! whether data are to be printed
  include 'umac1.h'
  character(record_length) :: line
  character(:), allocatable :: name
  type(item_list) :: items
  integer, allocatable :: elements(:), sides(:)
  integer :: i, e
  logical, external :: pcomp

  if (pcomp(uct, 'mes4', 4)) then
    uct = 'surf'
    return
  end if
  call begin_pass(is_counting())
  call this_record(line)
  call split_record(line, items)
  name = items%text(2)
  if (name == '') call fail('SURFace: write SURFace and its name')
  allocate (elements(0), sides(0))
  do
    call read_items(items)
    if (items%n == 0) exit
    if (mod(items%n, 2) /= 0) call fail('SURFace '//name//': records are pairs of element and side: '//items%line)
    do i = 1, items%n, 2
      e = items%whole(i)
      if (.not. has_operator(e)) call fail('SURFace '//name//': element '//whole_number(e)// &
        ' has no extraction operator. SURFace stands after T-SPline and BEZIer')
      elements = [elements, e]
      sides = [sides, items%whole(i + 1)]
      if (sides(size(sides)) < 0 .or. sides(size(sides)) > 2*mesh%dp(element_of(e))) &
        call fail('SURFace '//name//': element '//whole_number(e)//' has no side '//items%text(i + 1))
    end do
  end do
  call add_surface(name, elements, sides)
  if (is_counting()) call count_mesh(last_node, last_element, 0)
end subroutine umesh4
