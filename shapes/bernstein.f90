module bernstein
  !! Bernstein polynomials of any order on [0,1] and their tensor products on the parent element
  !! [0,1]^dp, with first and second derivatives.
  !!
  !!   B_i^p = (1-x) B_i^(p-1) + x B_(i-1)^(p-1),     dB_i^p/dx = p ( B_(i-1)^(p-1) - B_i^(p-1) )
  !!
  !! Inside the parent element every step of the recursion is a convex combination, so values keep
  !! full relative accuracy at any order; no binomial coefficient is formed. Tensor products run
  !! with the first direction fastest, k = 1 + i + (p+1) j + (p+1)(q+1) l. Second derivatives are
  !! packed as 11 | 11,22,12 | 11,22,33,12,23,13.
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: bernstein_1d, bernstein_derivatives, bernstein_basis

contains

  pure subroutine bernstein_1d(p, x, b)
    integer, intent(in) :: p          !! order, >= 0
    real(wp), intent(in) :: x         !! parametric point
    real(wp), intent(out) :: b(0:p)   !! values of the p+1 polynomials

    integer :: k

    b(0) = 1.0_wp
    do k = 1, p
      call raise_order(k, x, b)
    end do
  end subroutine bernstein_1d

  pure subroutine bernstein_derivatives(p, x, nd, b, db, d2b)
    integer, intent(in) :: p            !! order, >= 0
    real(wp), intent(in) :: x           !! parametric point
    integer, intent(in) :: nd           !! highest derivative wanted: 0, 1 or 2
    real(wp), intent(out) :: b(0:p)     !! values
    real(wp), intent(out) :: db(0:p)    !! first derivatives (undefined when nd < 1)
    real(wp), intent(out) :: d2b(0:p)   !! second derivatives (undefined when nd < 2)

    integer :: i, k

    b(0) = 1.0_wp
    do k = 1, p - 2
      call raise_order(k, x, b)
    end do

    ! b now holds order max(p-2,0)
    if (nd > 1) then
      if (p < 2) then
        d2b = 0.0_wp
      else
        d2b(0) = b(0)
        d2b(1) = -2.0_wp * b(0)
        if (p > 2) d2b(1) = d2b(1) + b(1)
        do i = 2, p - 2
          d2b(i) = b(i-2) - 2.0_wp * b(i-1) + b(i)
        end do
        if (p > 2) d2b(p-1) = b(p-3) - 2.0_wp * b(p-2)
        d2b(p) = b(p-2)
        d2b = (p * (p - 1)) * d2b
      end if
    end if

    if (p > 1) call raise_order(p - 1, x, b)
    if (nd > 0) then
      if (p < 1) then
        db = 0.0_wp
      else
        db(0) = -p * b(0)
        do i = 1, p - 1
          db(i) = p * (b(i-1) - b(i))
        end do
        db(p) = p * b(p-1)
      end if
    end if

    if (p > 0) call raise_order(p, x, b)
  end subroutine bernstein_derivatives

  pure subroutine raise_order(k, x, b)
    !! One step of the recursion, in place: from order k-1 to order k.
    integer, intent(in) :: k              !! order reached
    real(wp), intent(in) :: x             !! parametric point
    real(wp), intent(inout) :: b(0:k)     !! in: b(0:k-1) of order k-1; out: order k

    real(wp) :: from_left, old
    integer :: i

    from_left = 0.0_wp
    do i = 0, k - 1
      old = b(i)
      b(i) = from_left + (1.0_wp - x) * old
      from_left = x * old
    end do
    b(k) = from_left
  end subroutine raise_order

  pure subroutine bernstein_basis(degree, xi, nd, bez, dbez, d2bez)
    integer, intent(in) :: degree(:)                    !! orders (dp), dp = 0..3
    real(wp), intent(in) :: xi(:)                       !! parametric point (dp) in [0,1]^dp
    integer, intent(in) :: nd                           !! highest derivative wanted: 0, 1 or 2
    real(wp), contiguous, intent(inout) :: bez(:)       !! values (nb)
    real(wp), contiguous, intent(inout) :: dbez(:,:)    !! first derivatives (dp,nb), untouched
                                                        !! when nd < 1
    real(wp), contiguous, intent(inout) :: d2bez(:,:)   !! second derivatives (dp(dp+1)/2,nb),
                                                        !! untouched when nd < 2

    select case (size(degree))
    case (0)
      bez(1) = 1.0_wp
    case (1)
      call line(degree(1), xi(1), nd, bez, dbez, d2bez)
    case (2)
      call square(degree(1), degree(2), xi, nd, bez, dbez, d2bez)
    case (3)
      call cube(degree(1), degree(2), degree(3), xi, nd, bez, dbez, d2bez)
    case default
      error stop 'bernstein_basis: more than three parametric dimensions'
    end select
  end subroutine bernstein_basis

  pure subroutine line(p, xi, nd, bez, dbez, d2bez)
    integer, intent(in) :: p                !! order
    real(wp), intent(in) :: xi              !! parametric point
    integer, intent(in) :: nd               !! highest derivative wanted
    real(wp), intent(inout) :: bez(:)       !! values (nb)
    real(wp), intent(inout) :: dbez(:,:)    !! first derivatives (1,nb)
    real(wp), intent(inout) :: d2bez(:,:)   !! second derivatives (1,nb)

    real(wp) :: b(0:p), db(0:p), d2b(0:p)

    call bernstein_derivatives(p, xi, nd, b, db, d2b)
    bez(1:p+1) = b
    if (nd > 0) dbez(1,1:p+1) = db
    if (nd > 1) d2bez(1,1:p+1) = d2b
  end subroutine line

  pure subroutine square(p, q, xi, nd, bez, dbez, d2bez)
    integer, intent(in) :: p, q             !! orders
    real(wp), intent(in) :: xi(2)           !! parametric point
    integer, intent(in) :: nd               !! highest derivative wanted
    real(wp), intent(inout) :: bez(:)       !! values (nb)
    real(wp), intent(inout) :: dbez(:,:)    !! first derivatives (2,nb)
    real(wp), intent(inout) :: d2bez(:,:)   !! second derivatives (3,nb)

    real(wp) :: b1(0:p), db1(0:p), d2b1(0:p)
    real(wp) :: b2(0:q), db2(0:q), d2b2(0:q)
    integer :: i, j, k

    call bernstein_derivatives(p, xi(1), nd, b1, db1, d2b1)
    call bernstein_derivatives(q, xi(2), nd, b2, db2, d2b2)

    do j = 0, q
      k = 1 + (p + 1) * j
      do i = 0, p
        bez(k+i) = b1(i) * b2(j)
      end do
      if (nd > 0) then
        do i = 0, p
          dbez(1,k+i) = db1(i) * b2(j)
          dbez(2,k+i) = b1(i) * db2(j)
        end do
      end if
      if (nd > 1) then
        do i = 0, p
          d2bez(1,k+i) = d2b1(i) * b2(j)
          d2bez(2,k+i) = b1(i) * d2b2(j)
          d2bez(3,k+i) = db1(i) * db2(j)
        end do
      end if
    end do
  end subroutine square

  pure subroutine cube(p, q, r, xi, nd, bez, dbez, d2bez)
    integer, intent(in) :: p, q, r          !! orders
    real(wp), intent(in) :: xi(3)           !! parametric point
    integer, intent(in) :: nd               !! highest derivative wanted
    real(wp), intent(inout) :: bez(:)       !! values (nb)
    real(wp), intent(inout) :: dbez(:,:)    !! first derivatives (3,nb)
    real(wp), intent(inout) :: d2bez(:,:)   !! second derivatives (6,nb)

    real(wp) :: b1(0:p), db1(0:p), d2b1(0:p)
    real(wp) :: b2(0:q), db2(0:q), d2b2(0:q)
    real(wp) :: b3(0:r), db3(0:r), d2b3(0:r)
    integer :: i, j, k, l

    call bernstein_derivatives(p, xi(1), nd, b1, db1, d2b1)
    call bernstein_derivatives(q, xi(2), nd, b2, db2, d2b2)
    call bernstein_derivatives(r, xi(3), nd, b3, db3, d2b3)

    do l = 0, r
      do j = 0, q
        k = 1 + (p + 1) * (j + (q + 1) * l)
        do i = 0, p
          bez(k+i) = b1(i) * b2(j) * b3(l)
        end do
        if (nd > 0) then
          do i = 0, p
            dbez(1,k+i) = db1(i) * b2(j) * b3(l)
            dbez(2,k+i) = b1(i) * db2(j) * b3(l)
            dbez(3,k+i) = b1(i) * b2(j) * db3(l)
          end do
        end if
        if (nd > 1) then
          do i = 0, p
            d2bez(1,k+i) = d2b1(i) * b2(j) * b3(l)
            d2bez(2,k+i) = b1(i) * d2b2(j) * b3(l)
            d2bez(3,k+i) = b1(i) * b2(j) * d2b3(l)
            d2bez(4,k+i) = db1(i) * db2(j) * b3(l)
            d2bez(5,k+i) = b1(i) * db2(j) * db3(l)
            d2bez(6,k+i) = db1(i) * b2(j) * db3(l)
          end do
        end if
      end do
    end do
  end subroutine cube
end module bernstein
