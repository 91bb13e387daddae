module growing_arrays
  !! Arrays that are filled one entry after another: room is doubled, so that n entries cost O(n).
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: make_room

  interface make_room
    !! make_room(array, n): array has at least n entries (last index), the old ones kept, new ones zero or false.
    module procedure make_room_integer, make_room_real, make_room_columns, make_room_logical
  end interface make_room

contains

  pure integer function new_size(old, n)
    integer, intent(in) :: old   !! entries there are
    integer, intent(in) :: n     !! entries needed

    new_size = max(n, 16, old + min(old, huge(old) - old))
  end function new_size

  pure subroutine make_room_integer(array, n)
    integer, allocatable, intent(inout) :: array(:)
    integer, intent(in) :: n
    integer, allocatable :: larger(:)

    if (.not. allocated(array)) allocate (array(0))
    if (n <= size(array)) return
    allocate (larger(new_size(size(array), n)), source=0)
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine make_room_integer

  pure subroutine make_room_real(array, n)
    real(wp), allocatable, intent(inout) :: array(:)
    integer, intent(in) :: n
    real(wp), allocatable :: larger(:)

    if (.not. allocated(array)) allocate (array(0))
    if (n <= size(array)) return
    allocate (larger(new_size(size(array), n)), source=0.0_wp)
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine make_room_real

  pure subroutine make_room_columns(array, n)
    real(wp), allocatable, intent(inout) :: array(:, :)   !! allocated; its first extent stays
    integer, intent(in) :: n
    real(wp), allocatable :: larger(:, :)

    if (n <= size(array, 2)) return
    allocate (larger(size(array, 1), new_size(size(array, 2), n)), source=0.0_wp)
    larger(:, 1:size(array, 2)) = array
    call move_alloc(larger, array)
  end subroutine make_room_columns

  pure subroutine make_room_logical(array, n)
    logical, allocatable, intent(inout) :: array(:)
    integer, intent(in) :: n
    logical, allocatable :: larger(:)

    if (.not. allocated(array)) allocate (array(0))
    if (n <= size(array)) return
    allocate (larger(new_size(size(array), n)), source=.false.)
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine make_room_logical
end module growing_arrays
