module linear_rows
  !! Linear conditions G x = 0 on some of many values, and projections onto what obeys them: an orthonormal basis Q of
  !! the rows gives P = 1 - Q^T Q. Gram-Schmidt takes the row of which most is left first, so that rows that others imply
  !! up to rounding come last and are dropped.
  use kinds, only: wp
  use growing_arrays, only: make_room
  implicit none (type, external)
  private
  public :: linear_rows_type

  type :: linear_rows_type
    integer :: n = 0                        !! independent rows, known when finished
    integer, private :: given = 0           !! rows so far
    integer, allocatable :: place(:)        !! column of a value, 0: no row concerns it
    integer, allocatable :: concerned(:)    !! values of the columns
    real(wp), allocatable :: q(:,:)         !! rows, when finished orthonormal (columns,n)
  contains
    procedure :: start
    procedure :: add_row
    procedure :: finish
    procedure :: project
  end type linear_rows_type

  real(wp), parameter :: dependent = 1e-9_wp    !! what is left of a row, relative, that others imply

contains

  pure subroutine start(self, concerned)
    class(linear_rows_type), intent(inout) :: self
    logical, intent(in) :: concerned(:)     !! values that rows may concern; all others stay

    integer :: a, k

    self%n = 0
    self%given = 0
    self%concerned = pack([(a, a = 1, size(concerned))], concerned)
    self%place = [(0, a = 1, size(concerned))]
    do k = 1, size(self%concerned)
      self%place(self%concerned(k)) = k
    end do
    if (allocated(self%q)) deallocate (self%q)
    allocate (self%q(size(self%concerned),0))
  end subroutine start

  pure subroutine add_row(self, values, coef)
    !! sum coef(i) x(values(i)) = 0; what belongs to values that stay is left out.
    class(linear_rows_type), intent(inout) :: self
    integer, intent(in) :: values(:)
    real(wp), intent(in) :: coef(:)

    real(wp) :: row(size(self%concerned))
    integer :: i

    row = 0
    do i = 1, size(values)
      if (self%place(values(i)) > 0) row(self%place(values(i))) = row(self%place(values(i))) + coef(i)
    end do
    if (.not. norm2(row) > dependent*maxval(abs(coef))) return
    call make_room(self%q, self%given + 1)
    self%given = self%given + 1
    self%q(:,self%given) = row/norm2(row)
  end subroutine add_row

  pure subroutine finish(self)
    class(linear_rows_type), intent(inout) :: self

    real(wp) :: left(self%given), row(size(self%concerned))
    integer :: i, k, pass

    left = 1
    do while (self%n < self%given)
      k = self%n + maxloc(left(self%n+1:), 1)
      if (.not. left(k) > dependent) exit
      row = self%q(:,k)
      do pass = 1, 2                        ! the second removes what rounding has left
        do i = 1, self%n
          row = row - self%q(:,i)*dot_product(self%q(:,i), row)
        end do
        row = row/norm2(row)
      end do
      self%n = self%n + 1
      self%q(:,k) = self%q(:,self%n)
      left(k) = left(self%n)
      self%q(:,self%n) = row
      do k = self%n + 1, self%given
        self%q(:,k) = self%q(:,k) - row*dot_product(row, self%q(:,k))
        left(k) = norm2(self%q(:,k))
      end do
    end do
  end subroutine finish

  pure subroutine project(self, x)
    !! The nearest values that obey all rows.
    class(linear_rows_type), intent(in) :: self
    real(wp), intent(inout) :: x(:)

    real(wp) :: y(size(self%concerned))
    integer :: i

    y = x(self%concerned)
    do i = 1, self%n
      y = y - self%q(:,i)*dot_product(self%q(:,i), y)
    end do
    x(self%concerned) = y
  end subroutine project
end module linear_rows
