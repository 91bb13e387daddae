module feap_materials
  !! The materials whose elements are ours: their property lines become an element object with its law.
  use extraction_mesh, only: whole_number
  use user_element, only: element_type, property_record
  use feap_host, only: fail, note
  use feap_items, only: item_list, read_items
  implicit none (type, external)
  private
  public :: define_material, of_material

  type :: material_slot
    class(element_type), allocatable :: element
  end type material_slot

  type(material_slot), allocatable, target, save :: of_material(:)   !! by FEAP's material number

contains

  subroutine read_properties(records)
    !! The property lines of a MATErial data set, to its blank record.
    type(property_record), allocatable, intent(out) :: records(:)
    type(property_record), allocatable :: longer(:)
    type(item_list) :: items
    integer :: i, n, nw, nv

    allocate (records(0))
    do
      call read_items(items)
      if (items%n == 0) return
      n = size(records)
      allocate (longer(n + 1))
      do i = 1, n
        call move_alloc(records(i)%place, longer(i)%place)
        call move_alloc(records(i)%words, longer(i)%words)
        call move_alloc(records(i)%values, longer(i)%values)
      end do
      nw = 0
      do i = 1, items%n
        if (.not. items%is_number(i)) nw = nw + 1
      end do
      longer(n + 1)%place = trim(items%line)
      allocate (longer(n + 1)%words(nw), longer(n + 1)%values(items%n - nw))
      nw = 0
      nv = 0
      do i = 1, items%n
        if (items%is_number(i)) then
          nv = nv + 1
          longer(n + 1)%values(nv) = items%number(i)
        else
          nw = nw + 1
          longer(n + 1)%words(nw) = items%key(i)
        end if
      end do
      call move_alloc(longer, records)
    end do
  end subroutine read_properties

  subroutine define_material(material, element, ndm)
    !! Read the law data of a material for an element of this kind.
    integer, intent(in) :: material
    class(element_type), intent(in) :: element
    integer, intent(in) :: ndm
    type(material_slot), allocatable :: longer(:)
    type(property_record), allocatable :: records(:)
    character(:), allocatable :: fault
    integer :: i, bad

    if (.not. allocated(of_material)) allocate (of_material(0))
    if (material > size(of_material)) then
      allocate (longer(material))
      do i = 1, size(of_material)
        call move_alloc(of_material(i)%element, longer(i)%element)
      end do
      call move_alloc(longer, of_material)
    end if
    if (allocated(of_material(material)%element)) deallocate (of_material(material)%element)
    allocate (of_material(material)%element, source=element)
    call read_properties(records)
    call of_material(material)%element%define(ndm, records, fault, bad)
    if (allocated(fault)) then
      if (bad > 0) fault = '"'//records(bad)%place//'": '//fault
      call fail('material '//whole_number(material)//': '//fault)
    end if
    do i = 1, size(records)
      call note(records(i)%place)
    end do
  end subroutine define_material
end module feap_materials
