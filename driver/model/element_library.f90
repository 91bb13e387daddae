module element_library
  !! The only file that names all elements. To add one: `use` it, add its keyword and one case.
  use user_element, only: element_type
  use solid_element, only: solid_element_type
  use shell_element, only: shell_element_type
  use gpts_element, only: gpts_element_type
  implicit none (type, external)
  private
  public :: new_element

contains

  subroutine new_element(keyword, element, known)
    character(4), intent(in) :: keyword                          !! first four letters, lower case
    class(element_type), allocatable, intent(out) :: element     !! unallocated if the keyword is unknown
    character(:), allocatable, intent(out) :: known              !! what exists, for messages

    known = 'SOLId, SHELl'
    select case (keyword)
    case ('soli'); allocate (solid_element_type :: element)
    case ('shel'); allocate (shell_element_type :: element)
    case ('gpts'); allocate (gpts_element_type :: element)
    end select
  end subroutine new_element
end module element_library
