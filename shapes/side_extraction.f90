module side_extraction
  !! Sides of an extraction element as extraction elements one dimension lower: the columns of C
  !! on the side, without the functions that vanish there.
  !!
  !! Sides: 1: s=0, 2: s=1, 3: t=0, 4: t=1, 5: u=0, 6: u=1. A side's own parameters run so that
  !! its normal points outward while det J > 0. In 2D (body on the left of the tangent) the bottom
  !! runs s up, the right side t up, the top s down, the left side t down. In 3D the side's
  !! parameters are s=1: (t,u), s=0: (u,t), t=1: (u,s), t=0: (s,u), u=1: (s,t), u=0: (t,s), all
  !! increasing. A side of a line is a point, dp = 0, with one Bernstein function.
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: side_functions, side_operator, side_parameters

  !> what counts as zero, relative to the largest coefficient of the operator
  real(wp), parameter :: vanishing = 1.0e-14_wp

  ! first and second parameter of the sides of a solid
  integer, parameter :: first_of(6) = [3, 2, 1, 3, 2, 1]
  integer, parameter :: second_of(6) = [2, 3, 3, 1, 1, 2]

contains

  pure integer function side_functions(degree, side) result(nb)
    !! Number of Bernstein functions on a side.
    integer, intent(in) :: degree(:)   !! degrees of the element (dp)
    integer, intent(in) :: side        !! 1 .. 2 dp

    nb = product(degree + 1) / (degree((side + 1) / 2) + 1)
  end function side_functions

  pure subroutine side_operator(degree, ce, side, side_degree, n, rows, ce_side)
    integer, intent(in) :: degree(:)           !! degrees of the element (dp), dp = 1..3
    real(wp), intent(in) :: ce(:,:)            !! operator of the element (nen,nb)
    integer, intent(in) :: side                !! 1 .. 2 dp
    integer, intent(out) :: side_degree(:)     !! degrees of the side (dp-1)
    integer, intent(out) :: n                  !! number of functions that live on the side
    integer, intent(out) :: rows(:)            !! these functions in rows(1:n), increasing (nen)
    real(wp), intent(out) :: ce_side(:,:)  !! operator of the side in rows 1:n (nen,side_functions)

    integer :: columns(side_functions(degree, side))
    real(wp) :: zero
    integer :: a

    call side_columns(degree, side, side_degree, columns)
    zero = vanishing * maxval(abs(ce))
    n = 0
    rows = 0
    ce_side = 0.0_wp
    do a = 1, size(ce, 1)
      if (all(abs(ce(a,columns)) <= zero)) cycle
      n = n + 1
      rows(n) = a
      ce_side(n,:) = ce(a,columns)
    end do
  end subroutine side_operator

  pure subroutine side_columns(degree, side, side_degree, columns)
    !! Bernstein functions of the element that live on the side, in the side's own order.
    integer, intent(in) :: degree(:)         !! degrees of the element (dp)
    integer, intent(in) :: side              !! 1 .. 2 dp
    integer, intent(out) :: side_degree(:)   !! degrees of the side (dp-1)
    integer, intent(out) :: columns(:)       !! their numbers in the element

    integer :: at(3), across, d1, d2, i, j, k, stride(3)

    stride = 0
    stride(1) = 1
    do i = 2, size(degree)
      stride(i) = stride(i-1) * (degree(i-1) + 1)
    end do

    across = (side + 1) / 2
    at = 0
    if (mod(side, 2) == 0) at(across) = degree(across)

    k = 0
    select case (size(degree))
    case (1)
      columns(1) = 1 + dot_product(at, stride)
    case (2)
      d1 = 3 - across
      side_degree(1) = degree(d1)
      do i = 0, degree(d1)
        at(d1) = i
        if (side == 1 .or. side == 4) at(d1) = degree(d1) - i
        k = k + 1
        columns(k) = 1 + dot_product(at, stride)
      end do
    case (3)
      d1 = first_of(side)
      d2 = second_of(side)
      side_degree(1:2) = [degree(d1), degree(d2)]
      do j = 0, degree(d2)
        at(d2) = j
        do i = 0, degree(d1)
          at(d1) = i
          k = k + 1
          columns(k) = 1 + dot_product(at, stride)
        end do
      end do
    case default
      error stop 'side_extraction: an element has 1 to 3 parametric dimensions'
    end select
  end subroutine side_columns

  pure subroutine side_parameters(side, eta, xi)
    !! Place in the element of a point of its side.
    integer, intent(in) :: side        !! 1 .. 2 dp
    real(wp), intent(in) :: eta(:)     !! parameters of the side (dp-1)
    real(wp), intent(out) :: xi(:)     !! parameters of the element (dp)

    integer :: across

    across = (side + 1) / 2
    xi(across) = real(1 - mod(side, 2), wp)
    select case (size(xi))
    case (1)
      continue
    case (2)
      xi(3-across) = eta(1)
      if (side == 1 .or. side == 4) xi(3-across) = 1.0_wp - eta(1)
    case (3)
      xi(first_of(side)) = eta(1)
      xi(second_of(side)) = eta(2)
    case default
      error stop 'side_extraction: an element has 1 to 3 parametric dimensions'
    end select
  end subroutine side_parameters
end module side_extraction
