subroutine umesh1(tx, prt)
  !! Mesh command T-SPline [FILE="name"] [MATErial=m]: control points, weights, elements with their operators and surfaces
  !! of a file (.iga, BEXT text, BEXT JSON). Records follow, to a blank one: FILE="name", as FEAP's own command records
  !! hold names of 15 letters only; `set MATErial=m`, element sets of the file with other materials.
  use extraction_mesh, only: extraction_mesh_type, set_of_elements, set_of_nodes, whole_number
  use feap_host, only: this_record, record_length, fail, note
  use feap_items, only: item_list, split_record, read_items
  use feap_arrays, only: is_counting, first_free, count_mesh, space_dimension, store_node, store_element
  use feap_mesh, only: begin_pass, add_file, mesh, element_of, last_node, last_element
  implicit none
  character(15), intent(in) :: tx(*)      ! FEAP's items: they hold but 15 letters
  logical, intent(in) :: prt              ! whether data are to be printed
  include 'umac1.h'
  character(record_length) :: line
  character(:), allocatable :: path
  type(item_list) :: items
  type(extraction_mesh_type), target :: file
  character(record_length), allocatable :: sets(:)
  character(record_length) :: name
  integer, allocatable :: material(:), set_material(:)
  integer :: material_of_all, node, element, e, i, k, nodes_before
  logical, external :: pcomp

  if (pcomp(uct, 'mes1', 4)) then
    uct = 't-sp'
    return
  end if
  call begin_pass(is_counting())
  call this_record(line)
  call split_record(line, items)
  material_of_all = 1
  if (items%find('mate') > 0) material_of_all = items%whole(items%find('mate'))
  path = items%text(items%find('file'))
  allocate (sets(0), set_material(0))
  do
    call read_items(items)
    if (items%n == 0) exit
    if (items%key(1) == 'file') then
      path = items%text(2)
    else
      name = items%text(1)
      sets = [sets, name]
      set_material = [set_material, items%whole(items%n)]
    end if
  end do
  if (path == '') call fail('T-SPline: the file is missing. Write FILE="name.iga" behind T-SPline or in the next record')

  call first_free(node, element)
  call add_file(path, space_dimension(), node, element, file)
  nodes_before = last_node - file%nn
  element = last_element - file%elements%ne
  allocate (material(file%elements%ne), source=material_of_all)
  do k = 1, size(sets)
    do i = 1, size(file%sets)
      if (file%sets(i)%kind /= set_of_elements .or. file%sets(i)%name /= sets(k)) cycle
      material(file%sets(i)%items) = set_material(k)
      exit
    end do
    if (i > size(file%sets)) call fail(path//' has no element set "'//trim(sets(k))//'"; a blank record ends T-SPline')
  end do

  if (is_counting()) then
    call count_mesh(last_node, last_element, largest_element())
    return
  end if
  do i = 1, file%nn
    call store_node(nodes_before + i, file%x(:, i))
  end do
  do e = 1, file%elements%ne
    call store_element(element + e, material(e), mesh%connectivity(element_of(element + e)))
  end do
  if (.not. prt) return
  call note('T-SPline '//path//': nodes '//whole_number(nodes_before + 1)//' to '//whole_number(last_node)// &
    ', elements '//whole_number(element + 1)//' to '//whole_number(last_element))
  do i = 1, size(file%sets)
    if (file%sets(i)%kind /= set_of_nodes) call note('set '//file%sets(i)%name//': '//whole_number(size(file%sets(i)%items)))
  end do

contains

  pure integer function largest_element()
    integer :: n

    largest_element = 0
    do n = 1, mesh%ne
      largest_element = max(largest_element, mesh%nen(n))
    end do
  end function largest_element
end subroutine umesh1
