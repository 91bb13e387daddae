module gpts_kernel
  !! Gauss-point-to-surface interface (contact and cohesion, frictionless) of one slave Gauss point
  !! with the master facet that it projects on; equations (34)-(58) of the paper, in the plane (one
  !! surface parameter) and in space (two) alike.
  !!
  !!     g = (x_s - x_m) . n,     A_ab = m_ab - g k_ab,     upper indices: inverses
  !!
  !! (with an offset of the law, p is that of the gap g - offset: between mid-surfaces of shells g is
  !! their distance, and the gap is that of the faces which look at each other)
  !!
  !! Vectors over the slave, then the master control points:
  !!
  !!     N = [ R^s n ; -R^m n ]     N_a = [ 0 ; -R^m_,a n ]     T_a = [ R^s tau_a ; -R^m tau_a ]
  !!     D_a = A^ab (T_b - g N_b)     Nbar_a = N_a - k_ab D_b
  !!
  !!     fe = p N w_g j_g
  !!     ke = [ dp/dg N N^T
  !!          + p ( g m^ab Nbar_a Nbar_b^T + D_a N_a^T + N_a D_a^T - k_ab D_a D_b^T ) ] w_g j_g
  !!
  !! The caller has solved the projection: x_s - x_m is normal to the master. ke is symmetric: with
  !! Nbar_a written out, every column (k,b) is a combination of the vectors N, N_a and D_a,
  !!
  !!     ke(:,kb) = N (dp/dg N)_kb + N_a p ( D_a + g m^ac Nbar_c )_kb
  !!              + D_a p ( Nbar_a - g k_ac m^cd Nbar_d )_kb          (times w_g j_g)
  !!
  !! The gradient of the dissipation, dD/dg N w_g j_g, is fe dissipation_slope / (p w_g j_g): the
  !! returned slope includes w_g j_g, and p vanishes only where the slope does too.
  use kinds, only: wp
  use status_codes, only: ok, singular_projection
  use surface_frame, only: tangent_frame_at, metric_and_curvature
  use interface_law, only: has_cohesion, gap_law, gap_response, interface_response
  implicit none (type, external)
  private
  public :: gpts_point

  ! det A over det m below which x_s is at a centre of curvature
  real(wp), parameter :: singular_ratio = 1.0e-12_wp
  ! A gap below this times the coordinates is rounding: the faces touch, and their points are closed.
  ! Otherwise the first tangent of two blocks face to face has closed and open points at random. Points with cohesion
  ! don't need it: their traction must be continuous, or a stiff penalty keeps Newton's method from converging.
  real(wp), parameter :: touching = 32 * epsilon(1.0_wp)

contains

  pure subroutine gpts_point(shp_s, xs, shp_m, dshp_m, d2shp_m, xm, side, law, opening_n, wt, &
      want_tangent, response, fe, ke, status)
    real(wp), intent(in) :: shp_s(:)                     !! slave basis at the Gauss point (nes)
    real(wp), intent(in) :: xs(:,:)               !! current slave control points (ndm,nes) [length]
    real(wp), intent(in) :: shp_m(:)                     !! master basis at the projection (nem)
    real(wp), intent(in) :: dshp_m(:,:)                  !! its derivatives (dp,nem), dp = ndm - 1
    real(wp), intent(in) :: d2shp_m(:,:)    !! second derivatives, packed; read for the tangent only
    real(wp), intent(in) :: xm(:,:)              !! current master control points (ndm,nem) [length]
    real(wp), intent(in) :: side                !! +1 or -1: the master's outward normal is side * n
    type(gap_law), intent(in) :: law
    real(wp), intent(in) :: opening_n                    !! committed largest opening [length]
    real(wp), intent(in) :: wt         !! w_g j_g of the slave in the reference configuration [area]
    logical, intent(in) :: want_tangent                  !! whether ke is computed
    type(gap_response), intent(out) :: response         !! gap, traction, history; energies times wt
    real(wp), contiguous, intent(inout) :: fe(:,:)       !! internal force (ndm,nes+nem) [force]
    real(wp), contiguous, intent(inout) :: ke(:,:,:,:)   !! its derivative: blocks a >= b
                                                         !! (ndm,nes+nem,ndm,nes+nem) [force/length]
    integer, intent(out) :: status                       !! ok, singular_map, singular_projection
    real(wp) :: x(size(xm,1)), tau(size(xm,1),size(dshp_m,1)), nrm(size(xm,1)), area
    real(wp), dimension(size(dshp_m,1),size(dshp_m,1)) :: metric, metric_inv, curvature
    real(wp) :: distance, gap
    integer :: a, nes

    nes = size(shp_s)
    call tangent_frame_at(xm, shp_m, dshp_m, x, tau, nrm, area, status)
    if (status /= ok) return
    nrm = side * nrm

    x = -x
    do a = 1, nes
      x = x + shp_s(a) * xs(:,a)
    end do
    distance = dot_product(x, nrm)
    gap = distance - law%offset
    if (abs(gap) <= touching * maxval(abs(xm)) .and. .not. has_cohesion(law, opening_n)) gap = 0
    call interface_response(law, gap, opening_n, response)
    response%penalty_energy = wt * response%penalty_energy
    response%elastic_energy = wt * response%elastic_energy
    response%dissipated = wt * response%dissipated
    response%dissipation_slope = wt * response%dissipation_slope

    do a = 1, nes
      fe(:,a) = (wt * response%traction * shp_s(a)) * nrm
    end do
    do a = 1, size(shp_m)
      fe(:,nes+a) = (-wt * response%traction * shp_m(a)) * nrm
    end do

    if (.not. want_tangent) return
    if (abs(response%traction) > 0) then
      call metric_and_curvature(xm, d2shp_m, tau, nrm, metric, metric_inv, curvature)
      call full_tangent(size(xm, 1), size(dshp_m, 1), nes, size(shp_m), shp_s, shp_m, dshp_m, &
        tau, nrm, metric, metric_inv, curvature, distance, response, wt, ke, status)
    else
      call main_tangent(size(xm, 1), nes, size(shp_m), shp_s, shp_m, nrm, wt * response%slope, ke)
    end if
  end subroutine gpts_point

  pure subroutine main_tangent(ndm, nes, nem, shp_s, shp_m, nrm, stiffness, ke)
    !! Without traction there is no geometric part, and none of its singularities.
    integer, intent(in) :: ndm, nes, nem                 !! dimension, slave and master functions
    real(wp), intent(in) :: shp_s(nes), shp_m(nem)
    real(wp), intent(in) :: nrm(ndm)                     !! master normal
    real(wp), intent(in) :: stiffness                    !! dp/dg w_g j_g
    real(wp), intent(inout) :: ke(ndm*(nes+nem),ndm*(nes+nem))
    real(wp) :: n0(ndm*(nes+nem))                        ! N
    integer :: c, first

    if (abs(stiffness) > 0) then
      call gap_vector(ndm, nes, nem, shp_s, shp_m, nrm, n0)
      do c = 1, size(n0)
        first = ndm * ((c - 1) / ndm) + 1
        ke(first:,c) = (stiffness * n0(c)) * n0(first:)
      end do
    else
      do c = 1, size(n0)
        ke(ndm*((c-1)/ndm)+1:,c) = 0
      end do
    end if
  end subroutine main_tangent

  pure subroutine gap_vector(ndm, nes, nem, shp_s, shp_m, nrm, n0)
    !! N, the derivative of the gap.
    integer, intent(in) :: ndm, nes, nem                 !! dimension, slave and master functions
    real(wp), intent(in) :: shp_s(nes), shp_m(nem)
    real(wp), intent(in) :: nrm(ndm)                     !! master normal
    real(wp), intent(out) :: n0(ndm,nes+nem)
    integer :: a

    do a = 1, nes
      n0(:,a) = shp_s(a) * nrm
    end do
    do a = 1, nem
      n0(:,nes+a) = -shp_m(a) * nrm
    end do
  end subroutine gap_vector

  pure subroutine full_tangent(ndm, dp, nes, nem, shp_s, shp_m, dshp_m, tau, nrm, metric, &
      metric_inv, curvature, gap, response, wt, ke, status)
    integer, intent(in) :: ndm, dp, nes, nem             !! dimensions, slave and master functions
    real(wp), intent(in) :: shp_s(nes), shp_m(nem), dshp_m(dp,nem)
    real(wp), intent(in) :: tau(ndm,dp), nrm(ndm)        !! master frame, normal outward
    real(wp), intent(in) :: metric(dp,dp)                !! m_ab
    real(wp), intent(in) :: metric_inv(dp,dp)            !! m^ab
    real(wp), intent(in) :: curvature(dp,dp)             !! k_ab with the outward normal
    real(wp), intent(in) :: gap                          !! g, the distance of the surfaces
    type(gap_response), intent(in) :: response
    real(wp), intent(in) :: wt                           !! w_g j_g [area]
    real(wp), intent(inout) :: ke(ndm*(nes+nem),ndm*(nes+nem))
    integer, intent(out) :: status                       !! ok, singular_projection
    real(wp), dimension(ndm*(nes+nem)) :: n0             ! N
    real(wp), dimension(ndm*(nes+nem),dp) :: n1, t, d, nbar
    real(wp), dimension(ndm*(nes+nem)) :: of_n           ! what multiplies N in each column
    real(wp), dimension(ndm*(nes+nem),dp) :: of_n1, of_d ! what multiplies N_a and D_a
    real(wp) :: lift(dp,dp), bend(dp,dp)                 ! g m^ab, g k_ac m^cb
    real(wp) :: a_inv(dp,dp), p
    integer :: a, al, be, c, first, i, r

    p = wt * response%traction
    call inverse_of_a(metric, curvature, gap, a_inv, status)
    if (status /= ok) return
    lift = gap * metric_inv
    bend = matmul(curvature, lift)

    call gap_vector(ndm, nes, nem, shp_s, shp_m, nrm, n0)
    of_n = (wt * response%slope) * n0
    do al = 1, dp
      i = 0
      do a = 1, nes
        n1(i+1:i+ndm,al) = 0
        t(i+1:i+ndm,al) = shp_s(a) * tau(:,al)
        i = i + ndm
      end do
      do a = 1, nem
        n1(i+1:i+ndm,al) = -dshp_m(al,a) * nrm
        t(i+1:i+ndm,al) = -shp_m(a) * tau(:,al)
        i = i + ndm
      end do
    end do
    do al = 1, dp
      d(:,al) = 0
      do be = 1, dp
        d(:,al) = d(:,al) + a_inv(al,be) * (t(:,be) - gap * n1(:,be))
      end do
    end do
    do al = 1, dp
      nbar(:,al) = n1(:,al)
      do be = 1, dp
        nbar(:,al) = nbar(:,al) - curvature(al,be) * d(:,be)
      end do
    end do
    do al = 1, dp
      of_n1(:,al) = p * d(:,al)
      of_d(:,al) = p * nbar(:,al)
      do be = 1, dp
        of_n1(:,al) = of_n1(:,al) + (p * lift(al,be)) * nbar(:,be)
        of_d(:,al) = of_d(:,al) - (p * bend(al,be)) * nbar(:,be)
      end do
    end do

    do c = 1, size(n0)
      first = ndm * ((c - 1) / ndm) + 1
      do r = first, size(n0)
        ke(r,c) = of_n(c) * n0(r) + of_n1(c,1) * n1(r,1) + of_d(c,1) * d(r,1)
      end do
      do al = 2, dp
        do r = first, size(n0)
          ke(r,c) = ke(r,c) + of_n1(c,al) * n1(r,al) + of_d(c,al) * d(r,al)
        end do
      end do
    end do
  end subroutine full_tangent

  pure subroutine inverse_of_a(metric, curvature, gap, a_inv, status)
    !! A^ab, where A = m - g k is positive definite: elsewhere x_m is not closest.
    real(wp), intent(in) :: metric(:,:)                  !! m_ab
    real(wp), intent(in) :: curvature(:,:)               !! k_ab
    real(wp), intent(in) :: gap                          !! g
    real(wp), intent(out) :: a_inv(:,:)                  !! A^ab
    integer, intent(out) :: status                       !! ok, singular_projection
    real(wp) :: low(size(metric,1),size(metric,1)), det, det_metric

    a_inv = 0
    low = metric - gap * curvature
    if (size(metric, 1) == 1) then
      det = low(1,1)
      det_metric = metric(1,1)
    else
      det = low(1,1) * low(2,2) - low(2,1)**2
      det_metric = metric(1,1) * metric(2,2) - metric(2,1)**2
    end if
    status = singular_projection
    if (.not. (low(1,1) > 0 .and. det > singular_ratio * det_metric)) return
    status = ok

    if (size(metric, 1) == 1) then
      a_inv(1,1) = 1 / det
    else
      a_inv(1,1) = low(2,2) / det
      a_inv(2,1) = -low(2,1) / det
      a_inv(1,2) = a_inv(2,1)
      a_inv(2,2) = low(1,1) / det
    end if
  end subroutine inverse_of_a
end module gpts_kernel
