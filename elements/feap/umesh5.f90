subroutine umesh5(tx, prt)
  !! Mesh command CONTact SLAVe=surface MASTer=surface MATErial=m [GP=n] [SIDE=-1] [REACh=r] [THICkness=d]: an element
  !! for each Gauss point of the slave surface. THICkness: the gap is that of the faces of shells, d half the thicknesses
  !! of both. Records follow, to a blank one: BONDed or UNBOnded BOX x1 x2 y1 y2 [z1 z2], the part of a
  !! cohesive interface that is bonded or cracked from the start; SLAVe=surface, MASTer=surface, as FEAP's own command
  !! records hold names of 15 letters only.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use feap_host, only: this_record, record_length, fail, note
  use feap_items, only: item_list, split_record, read_items
  use feap_arrays, only: is_counting, first_free, count_mesh, space_dimension, store_element
  use feap_mesh, only: begin_pass, last_node, last_element
  use feap_contact, only: bond_box, add_interface, largest_pair, pair_nodes
  implicit none
  character(15), intent(in) :: tx(*)      ! FEAP's items: they hold but 15 letters
  logical, intent(in) :: prt              ! whether data are to be printed
  include 'umac1.h'
  character(record_length) :: line
  type(item_list) :: items
  type(bond_box), allocatable :: boxes(:)
  integer, allocatable :: nodes(:)
  real(wp), allocatable :: bounds(:)
  type(bond_box) :: box
  character(:), allocatable :: slave_name, master_name
  real(wp) :: side, reach, offset, margin
  integer :: slave, master, material, place, gp, np, first, node, e, i
  logical, external :: pcomp

  if (pcomp(uct, 'mes5', 4)) then
    uct = 'cont'
    return
  end if
  call begin_pass(is_counting())
  call this_record(line)
  call split_record(line, items)
  slave = items%find('slav')
  master = items%find('mast')
  place = items%find('mate')
  if (place == 0) call fail('CONTact: write CONTact SLAVe=surface MASTer=surface MATErial=m [GP=n]')
  material = items%whole(place)
  gp = 2
  if (items%find('gp  ') > 0) gp = items%whole(items%find('gp  '))
  if (gp < 1) call fail('CONTact: GP is the number of Gauss points per direction, at least 1')
  side = 1
  if (items%find('side') > 0) side = sign(1.0_wp, items%number(items%find('side')))
  reach = 0
  if (items%find('reac') > 0) reach = items%number(items%find('reac'))
  offset = 0
  if (items%find('thic') > 0) offset = items%number(items%find('thic'))
  if (offset < 0) call fail('CONTact: THICkness is half the thicknesses of both shells, not negative')
  call first_free(node, first)
  first = max(first, last_element + 1)
  slave_name = items%text(slave)
  master_name = items%text(master)
  allocate (boxes(0))
  do
    call read_items(items)
    if (items%n == 0) exit
    if (items%key(1) == 'slav') slave_name = items%text(2)
    if (items%key(1) == 'mast') master_name = items%text(2)
    if (any(items%key(1) == ['slav', 'mast'])) cycle
    call items%rest(3, bounds)
    if (all(items%key(1) /= ['bond', 'unbo']) .or. items%key(2) /= 'box' .or. size(bounds) /= 2*space_dimension()) &
      call fail('CONTact: write BONDed or UNBOnded BOX x1 x2 y1 y2 [z1 z2]; a blank record ends CONTact')
    box%bonded = items%key(1) == 'bond'
    do i = 1, size(bounds)/2
      margin = 1.0e-9_wp*maxval(abs(bounds))
      box%low(i) = minval(bounds(2*i - 1:2*i)) - margin
      box%high(i) = maxval(bounds(2*i - 1:2*i)) + margin
    end do
    boxes = [boxes, box]
  end do
  if (slave_name == '' .or. master_name == '') &
    call fail('CONTact: write SLAVe=surface and MASTer=surface behind CONTact or in records of their own')
  call add_interface(slave_name, master_name, gp, side, reach, offset, material, first, boxes, np)
  last_element = first + np - 1
  if (is_counting()) then
    call count_mesh(last_node, last_element, largest_pair())
    return
  end if
  do e = first, last_element
    call pair_nodes(e, nodes)
    call store_element(e, material, nodes)
  end do
  if (prt) call note('CONTact '//slave_name//' on '//master_name//': elements '//whole_number(first)//' to '// &
    whole_number(last_element))
end subroutine umesh5
