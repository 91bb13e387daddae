module point_joint
  !! The tangent plane and the twists at an extraordinary point of n faces, in Bezier coefficients.
  !!
  !! Spoke i = 1 ... n, counter-clockwise, has the knot interval d_i and first coefficients
  !! s_0, s^i_1 = s_0 + d_i g . (cos, sin)(2 pi i/n): n tangents in one plane, given by three
  !! control points at angles 2 pi j/3 and the distance of two mean intervals. On the boundary these
  !! are such that each side of it needs two of them only: the first coefficients of both boundary
  !! spokes, and where it is bent s_0, else a point inside. Twists t^i of the
  !! faces between spokes i and i+1 satisfy t^i + t^(i-1) = r^i along each spoke. For odd n they
  !! follow; for even n the alternating sum of r must vanish and the first twist is free. On the
  !! boundary m faces have m + 1 spokes at the angles 0, a/m, ... a, and m - 1 sums: one twist is
  !! free.
  use kinds, only: wp
  use sparse_row, only: row_type, clear, add_row, add_scaled_term
  implicit none (type, external)
  private
  public :: plane_rows, boundary_plane_rows, boundary_plane_points, is_bent, twist_rows, &
    alternating_rest

  real(wp), parameter :: pi = acos(-1.0_wp)

contains

  pure subroutine plane_rows(d, step, plane, s0, s1)
    real(wp), intent(in) :: d(:)                 !! knot intervals of the spokes (n)
    real(wp), intent(in) :: step                 !! angle from spoke to spoke [rad]
    integer, intent(in) :: plane                 !! first of the three control points
    type(row_type), intent(inout) :: s0, s1(:)   !! the point; first coefficients of the spokes (n)

    real(wp) :: mean
    integer :: i, j

    mean = sum(d) / size(d)
    call clear(s0)
    do j = 0, 2
      call add_scaled_term(s0, 1.0_wp/3, plane + j)
    end do
    do i = 1, size(d)
      call clear(s1(i))
      do j = 0, 2
        call add_scaled_term(s1(i), 1.0_wp/3 + d(i)/(3*mean) &
          * cos((i - 1)*step - 2*pi*j/3), plane + j)
      end do
    end do
  end subroutine plane_rows

  pure logical function is_bent(angle)
    real(wp), intent(in) :: angle                !! inside, on the boundary [rad]

    is_bent = abs(sin(angle)) > 0.1_wp
  end function is_bent

  pure subroutine boundary_plane_rows(d, step, plane, s0, s1)
    real(wp), intent(in) :: d(:)                 !! knot intervals of the spokes (n+1)
    real(wp), intent(in) :: step                 !! angle from spoke to spoke [rad]
    integer, intent(in) :: plane                 !! first of the three control points
    type(row_type), intent(inout) :: s0, s1(:)   !! the point; first coefficients (n+1)

    real(wp) :: angle, inward, part(2)
    integer :: i, n

    n = size(d)
    call clear(s0)
    if (is_bent((n - 1)*step)) then
      call add_scaled_term(s0, 1.0_wp, plane + 2)
    else
      call add_scaled_term(s0, d(n)/(d(1) + d(n)), plane)
      call add_scaled_term(s0, d(1)/(d(1) + d(n)), plane + 1)
    end if
    do i = 1, n
      ! d_i g in differences of the control points
      angle = (i - 1)*step
      inward = 0
      if (is_bent((n - 1)*step)) then
        part(2) = sin(angle)/sin((n - 1)*step)
        part(1) = cos(angle) - part(2)*cos((n - 1)*step)
        part = part*d(i)/d([1, n])
      else
        part = [1, -1]*cos(angle)*d(i)/(d(1) + d(n))
        inward = sin(angle)*d(i)*n/sum(d)
      end if
      if (i == 1 .or. i == n) inward = 0
      call clear(s1(i))
      call add_row(s1(i), 1 - merge(sum(part), inward, is_bent((n - 1)*step)), s0)
      if (abs(part(1)) > 0) call add_scaled_term(s1(i), part(1), plane)
      if (abs(part(2)) > 0) call add_scaled_term(s1(i), part(2), plane + 1)
      if (abs(inward) > 0) call add_scaled_term(s1(i), inward, plane + 2)
    end do
  end subroutine boundary_plane_rows

  pure function boundary_plane_points(d, step, s0, gradient) result(x)
    real(wp), intent(in) :: d(:)                 !! knot intervals of the spokes (n+1)
    real(wp), intent(in) :: step                 !! angle from spoke to spoke [rad]
    real(wp), intent(in) :: s0(3)                !! the point
    real(wp), intent(in) :: gradient(3,2)
    real(wp) :: x(3,3)                           !! the three control points

    real(wp) :: last
    integer :: n

    n = size(d)
    last = (n - 1)*step
    x(:,1) = s0 + d(1)*gradient(:,1)
    if (is_bent(last)) then
      x(:,2) = s0 + d(n)*(cos(last)*gradient(:,1) + sin(last)*gradient(:,2))
      x(:,3) = s0
    else
      x(:,2) = s0 - d(n)*gradient(:,1)
      x(:,3) = s0 + sum(d)/n*gradient(:,2)
    end if
  end function boundary_plane_points

  pure subroutine twist_rows(r, follow, t)
    type(row_type), intent(in) :: r(:)           !! sums of neighbouring twists (n)
    logical, intent(in) :: follow                !! n is odd and all around: all twists follow
    type(row_type), intent(inout) :: t(:)        !! twists (n); else the first one is given

    integer :: i, k, n

    n = size(r)
    if (follow) then
      do i = 1, n
        call clear(t(i))
        do k = 0, n - 1
          call add_row(t(i), 0.5_wp*(-1)**k, r(modulo(i - k - 1, n) + 1))
        end do
      end do
    else
      do i = 2, n
        call clear(t(i))
        call add_row(t(i), 1.0_wp, r(i))
        call add_row(t(i), -1.0_wp, t(i-1))
      end do
    end if
  end subroutine twist_rows

  pure subroutine alternating_rest(r, last, rest)
    !! What r^last is for the alternating sum to vanish (even n).
    type(row_type), intent(in) :: r(:)           !! (n), r(last) is not looked at
    integer, intent(in) :: last
    type(row_type), intent(inout) :: rest

    integer :: i

    call clear(rest)
    do i = 1, size(r)
      if (i /= last) call add_row(rest, -1.0_wp*(-1)**(i + last), r(i))
    end do
  end subroutine alternating_rest
end module point_joint
