module bezier_extension
  !! The smooth extension of a Bezier facet beyond one of its sides: the same (rational) polynomials over a longer
  !! interval. With f the polar form of a polynomial of order p in one direction, the points over [0,c] or [c,1] are
  !!
  !!     q_j = f(0, .., 0, c, .., c)  (c j times)   or   q_j = f(c, .., c, 1, .., 1)  (1 j times)
  !!
  !! by de Casteljau's recursion, which extrapolates where c lies outside [0,1].
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: extend_bezier

contains

  pure subroutine extend_bezier(degree, direction, c, q)
    !! The parent interval of one direction becomes [0,c] if c > 1, [c,1] if c < 0.
    integer, intent(in) :: degree(:)                !! Bernstein degrees (dp)
    integer, intent(in) :: direction                !! 1..dp
    real(wp), intent(in) :: c
    real(wp), contiguous, intent(inout) :: q(:, :)  !! homogeneous Bezier points (ndm+1,nb), first direction fastest
    integer :: first, i, j, r, stride, p

    p = degree(direction)
    stride = product(degree(1:direction - 1) + 1)
    do first = 1, size(q, 2)
      if (mod((first - 1)/stride, p + 1) /= 0) cycle
      do r = 1, p
        if (c > 1) then
          do i = p, r, -1
            j = first + i*stride
            q(:, j) = (1 - c)*q(:, j - stride) + c*q(:, j)
          end do
        else
          do i = 0, p - r
            j = first + i*stride
            q(:, j) = (1 - c)*q(:, j) + c*q(:, j + stride)
          end do
        end if
      end do
    end do
  end subroutine extend_bezier
end module bezier_extension
