module extraordinary_ring
  !! The faces around an extraordinary point: bi-quartic elements that join with a continuous
  !! tangent plane along their common edges (spokes) and at the point.
  !!
  !! Spoke i, of knot interval d_i, i = 1 ... n counter-clockwise, is the edge v = 0 of face i,
  !! whose
  !! u runs along it, and the edge u = 0 of face i-1, whose v does. With c = cos(2 pi/n) every
  !! function f of the space, hence the surface itself, satisfies along spoke i
  !!
  !!     f^i_,v(u,0)/d_(i+1) + f^(i-1)_,u(0,u)/d_(i-1) = 2 c (1-u)^2 f^i_,u(u,0)/d_i
  !!
  !! Since the factors depend on the mesh alone, surface and functions share them: functions are
  !! C1 on the surface and the surface has one tangent plane, wherever control points lie
  !! (Groisser, Peters, CAGD 34, 2015: matched constructions). At the far end (1-u)^2 joins C1 to
  !! the faces beyond. The spokes are cubics, so that both sides have degree 4.
  !!
  !! In quartic Bezier coefficients f_kl with spoke coefficients s_k (cubic) and e_k (raised to
  !! degree 4)
  !! the condition reads, k = 0 ... 4 (k = 3, 4 hold by the C1 join of the outer coefficients):
  !!
  !!     k = 0   s^i_1 = s_0 + d_i g . (cos, sin)(2 pi i/n)                       a plane
  !!     k = 1   t^i + t^(i-1) = r_i = 3c/4 ((s^i_2 - s_0)/d_i^2 - 3 (s^i_1 - s_0)/d_i^2),
  !!             f^i_11 = e^i_1 + e^(i+1)_1 - s_0 + d_i d_(i+1) t^i               twists
  !!     k = 2   (f^i_21 - e^i_2)/d_(i+1) + (f^(i-1)_12 - e^i_2)/d_(i-1) = c/4 (s^i_3 - s^i_2)/d_i
  !!
  !! The twists follow from r for odd n; for even n the alternating sum of r must vanish (which
  !! takes away one s_2) and one twist is free. Free are also f_21 at each spoke, f_22 in each face,
  !! and the plane, by three control points q_j at angles 2 pi j/3 and the radius of two spokes.
  !! All are values of the spline or its Bezier coefficients, so that functions sum to one and are
  !! independent.
  !!
  !! This is for points whose seams would cross others (seam_lines says why seams are preferred). It
  !! is the setting of Scott et al. (CMAME 254, 2013; bi-quartic, spokes G1, the other edges C1),
  !! with all the freedom that the smoothness leaves. Since the factor belongs to the length of
  !! the spoke, which halves with every refinement, the error of bending falls with h only.
  use kinds, only: wp
  use sparse_row, only: row_type, clear, add_term, add_row, add_scaled_term
  use point_joint, only: plane_rows, twist_rows
  implicit none (type, external)
  private
  public :: ring_type, ring_coefficients, dependent_spoke, spoke_cosine

  real(wp), parameter :: pi = acos(-1.0_wp)

  type :: ring_type
    integer :: n = 0                         !! faces
    real(wp), allocatable :: d(:)            !! knot intervals of the spokes (n)
    type(row_type), allocatable :: b(:,:,:)  !! cubic Bezier coefficients of the faces away from the
                                             !! point, index 2 or 3 in one direction (0:3,0:3,n)
    integer :: plane = 0                     !! first of the three control points of the plane
    integer, allocatable :: middle(:)        !! control points f_21 (n)
    integer, allocatable :: centre(:)        !! control points f_22 (n)
    integer :: twist = 0                     !! control point f_11 of face 1, if n is even
  end type ring_type

contains

  pure real(wp) function spoke_cosine(n)
    integer, intent(in) :: n                 !! faces at the point

    spoke_cosine = cos(2*pi/n)
  end function spoke_cosine

  pure subroutine dependent_spoke(ring, near, far)
    !! Even n: the inner coefficient of the last face at the end of spoke n, from k = 1 summed with
    !! alternating signs.
    type(ring_type), intent(in) :: ring      !! b(1,2), b(2,1) of the other corners are there
    type(row_type), intent(in) :: near       !! b(1,2) of face n-1
    type(row_type), intent(inout) :: far     !! b(2,1) of face n

    type(row_type) :: s0, s1(ring%n), s2
    real(wp) :: factor
    integer :: after, before, i, n

    n = ring%n
    call plane_rows(ring%d, 2*pi/ring%n, ring%plane, s0, s1)
    call clear(far)
    ! s_2 of spoke n: (s2_n - s0)/d_n^2 = sum_i (-1)^i 3 (s1_i - s0)/d_i^2 - sum_(i<n) (-1)^i
    ! (s2_i - s0)/d_i^2
    call add_row(far, 1.0_wp, s0)
    do i = 1, n
      factor = 3*(-1)**i * (ring%d(n)/ring%d(i))**2
      call add_row(far, factor, s1(i))
      call add_row(far, -factor, s0)
      if (i == n) exit
      before = merge(n, i - 1, i == 1)
      after = i + 1
      call clear(s2)
      call add_row(s2, ring%d(before), ring%b(2,1,i))
      call add_row(s2, ring%d(after), ring%b(1,2,before))
      factor = -(-1)**i * (ring%d(n)/ring%d(i))**2
      call add_row(far, factor/(ring%d(before) + ring%d(after)), s2)
      call add_row(far, -factor, s0)
    end do
    ! and b(2,1) from it
    factor = (ring%d(n-1) + ring%d(1)) / ring%d(n-1)
    far%c(1:far%n) = factor*far%c(1:far%n)
    call add_row(far, -ring%d(1)/ring%d(n-1), near)
  end subroutine dependent_spoke

  pure subroutine ring_coefficients(ring, f)
    type(ring_type), intent(in) :: ring
    type(row_type), allocatable, intent(out) :: f(:,:,:)   !! quartic coefficients (0:4,0:4,n)

    type(row_type) :: s0, s1(ring%n), e1(ring%n), e2(ring%n), r(ring%n), t(ring%n), row(0:3)
    real(wp) :: c, factor, near
    integer :: after, before, i, j, k, n

    n = ring%n
    c = spoke_cosine(n)
    allocate (f(0:4,0:4,n))
    call plane_rows(ring%d, 2*pi/ring%n, ring%plane, s0, s1)
    do i = 1, n
      call clear(e1(i))
      call add_row(e1(i), 0.25_wp, s0)
      call add_row(e1(i), 0.75_wp, s1(i))
      call clear(e2(i))
      call add_row(e2(i), 0.5_wp, s1(i))
      call add_row(e2(i), 0.5_wp, ring%b(2,0,i))
      call clear(r(i))
      factor = 0.75_wp*c/ring%d(i)**2
      call add_row(r(i), factor, ring%b(2,0,i))
      call add_row(r(i), 2*factor, s0)
      call add_row(r(i), -3*factor, s1(i))
    end do

    ! twists
    if (mod(n, 2) == 0) then
      factor = 1 / (ring%d(1)*ring%d(2))
      call clear(t(1))
      call add_scaled_term(t(1), factor, ring%twist)
      call add_row(t(1), -factor, e1(1))
      call add_row(t(1), -factor, e1(2))
      call add_row(t(1), factor, s0)
    end if
    call twist_rows(r, mod(n, 2) == 1, t)

    do i = 1, n
      after = modulo(i, n) + 1
      before = modulo(i - 2, n) + 1
      do k = 0, 4
        do j = 0, 4
          call clear(f(j,k,i))
        end do
      end do
      call add_row(f(0,0,i), 1.0_wp, s0)
      call add_row(f(1,0,i), 1.0_wp, e1(i))
      call add_row(f(2,0,i), 1.0_wp, e2(i))
      call add_row(f(0,1,i), 1.0_wp, e1(after))
      call add_row(f(0,2,i), 1.0_wp, e2(after))
      call add_row(f(1,1,i), 1.0_wp, e1(i))
      call add_row(f(1,1,i), 1.0_wp, e1(after))
      call add_row(f(1,1,i), -1.0_wp, s0)
      call add_row(f(1,1,i), ring%d(i)*ring%d(after), t(i))
      call add_term(f(2,1,i), ring%middle(i))
      call add_term(f(2,2,i), ring%centre(i))
      ! outer coefficients: two layers of the cubics, raised to degree 4 in both directions
      do k = 3, 4
        near = merge(1.0_wp, 0.25_wp, k == 4)
        do j = 0, 3
          call clear(row(j))
          call add_row(row(j), near, ring%b(3,j,i))
          if (k == 3) call add_row(row(j), 0.75_wp, ring%b(2,j,i))
        end do
        call raise(row, f(k,:,i))
        do j = 0, 3
          call clear(row(j))
          call add_row(row(j), near, ring%b(j,3,i))
          if (k == 3) call add_row(row(j), 0.75_wp, ring%b(j,2,i))
        end do
        call raise(row, f(:,k,i))
      end do
    end do
    ! second coefficients from the other side of the spokes
    do i = 1, n
      after = modulo(i, n) + 1
      before = modulo(i - 2, n) + 1
      associate (g => f(1,2,before))
        call add_row(g, 1.0_wp, e2(i))
        factor = 0.25_wp*c*ring%d(before)/ring%d(i)
        call add_row(g, factor, ring%b(3,0,i))
        call add_row(g, -factor, ring%b(2,0,i))
        factor = ring%d(before)/ring%d(after)
        call add_scaled_term(g, -factor, ring%middle(i))
        call add_row(g, factor, e2(i))
      end associate
    end do
  end subroutine ring_coefficients

  pure subroutine raise(cubic, quartic)
    type(row_type), intent(in) :: cubic(0:)
    type(row_type), intent(inout) :: quartic(0:)

    integer :: k

    call clear(quartic(0))
    call add_row(quartic(0), 1.0_wp, cubic(0))
    do k = 1, 3
      call clear(quartic(k))
      call add_row(quartic(k), 0.25_wp*k, cubic(k-1))
      call add_row(quartic(k), 1 - 0.25_wp*k, cubic(k))
    end do
    call clear(quartic(4))
    call add_row(quartic(4), 1.0_wp, cubic(3))
  end subroutine raise
end module extraordinary_ring
