module funit_exceptions
  !! Failures that were thrown and not yet caught: one list for the process, as in pFUnit.
  implicit none (type, external)
  private
  public :: SourceLocation, throw, catch, anyExceptions, take_exception

  type :: SourceLocation
    character(255) :: file_name = ''  !! without folder
    integer :: line = 0
  end type SourceLocation

  type :: exception
    character(:), allocatable :: message
    type(SourceLocation) :: location
  end type exception

  interface catch
    module procedure catch_any, catch_message
  end interface catch

  type(exception), allocatable, save :: thrown(:)

contains

  subroutine throw(message, location)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    type(exception), allocatable :: longer(:)
    integer :: i, n

    n = thrown_count()
    allocate (longer(n + 1))
    do i = 1, n
      longer(i) = thrown(i)
    end do
    longer(n + 1)%message = ''
    if (present(message)) longer(n + 1)%message = trim(message)
    if (present(location)) longer(n + 1)%location = location
    call move_alloc(longer, thrown)
  end subroutine throw

  function catch_any() result(caught)
    !! Takes the latest failure off the list.
    logical :: caught

    caught = anyExceptions()
    if (caught) call remove(thrown_count())
  end function catch_any

  function catch_message(message) result(caught)
    !! Takes the first failure with this message off the list.
    character(*), intent(in) :: message
    logical :: caught
    integer :: i

    caught = .false.
    do i = 1, thrown_count()
      if (thrown(i)%message /= message) cycle
      caught = .true.
      call remove(i)
      return
    end do
  end function catch_message

  function anyExceptions() result(any_left)
    logical :: any_left

    any_left = thrown_count() > 0
  end function anyExceptions

  subroutine take_exception(message, location)
    !! The oldest failure; there must be one.
    character(:), allocatable, intent(out) :: message
    type(SourceLocation), intent(out) :: location

    message = thrown(1)%message
    location = thrown(1)%location
    call remove(1)
  end subroutine take_exception

  function thrown_count() result(n)
    integer :: n

    n = 0
    if (allocated(thrown)) n = size(thrown)
  end function thrown_count

  subroutine remove(which)
    integer, intent(in) :: which  !! place in the list
    type(exception), allocatable :: shorter(:)
    integer :: i

    allocate (shorter(size(thrown) - 1))
    do i = 1, size(shorter)
      shorter(i) = thrown(merge(i, i + 1, i < which))
    end do
    call move_alloc(shorter, thrown)
  end subroutine remove
end module funit_exceptions
