module sparse_row
  !! A linear combination of control points: numbers and factors. Short, so that terms are looked up
  !! one by one.
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: row_type, clear, add_term, add_row, add_scaled_term

  type :: row_type
    integer :: n = 0                     !! terms in use
    integer, allocatable :: id(:)        !! control points, each once
    real(wp), allocatable :: c(:)        !! their factors
  end type row_type

  integer, parameter :: first_size = 16

contains

  pure subroutine clear(row)
    type(row_type), intent(inout) :: row

    row%n = 0
    if (.not. allocated(row%id)) allocate (row%id(first_size), row%c(first_size))
  end subroutine clear

  pure subroutine add_term(row, id)
    !! The control point itself.
    type(row_type), intent(inout) :: row
    integer, intent(in) :: id

    call add_scaled_term(row, 1.0_wp, id)
  end subroutine add_term

  pure subroutine add_scaled_term(row, factor, id)
    type(row_type), intent(inout) :: row
    real(wp), intent(in) :: factor
    integer, intent(in) :: id

    integer, allocatable :: longer_id(:)
    real(wp), allocatable :: longer_c(:)
    integer :: k

    if (.not. allocated(row%id)) allocate (row%id(first_size), row%c(first_size))
    do k = 1, row%n
      if (row%id(k) == id) then
        row%c(k) = row%c(k) + factor
        return
      end if
    end do
    if (row%n == size(row%id)) then
      allocate (longer_id(2*row%n), longer_c(2*row%n))
      longer_id(1:row%n) = row%id
      longer_c(1:row%n) = row%c
      call move_alloc(longer_id, row%id)
      call move_alloc(longer_c, row%c)
    end if
    row%n = row%n + 1
    row%id(row%n) = id
    row%c(row%n) = factor
  end subroutine add_scaled_term

  pure subroutine add_row(row, factor, other)
    !! row := row + factor other
    type(row_type), intent(inout) :: row
    real(wp), intent(in) :: factor
    type(row_type), intent(in) :: other

    integer :: k

    do k = 1, other%n
      call add_scaled_term(row, factor*other%c(k), other%id(k))
    end do
  end subroutine add_row
end module sparse_row
