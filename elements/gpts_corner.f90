module gpts_corner
  !! The slave point's nearest master point lies on a kink: a corner of the plane, an edge or a corner in space, where
  !! two facets meet and neither holds the projection. There the gap is the distance to the kink itself, so that
  !! the force goes over continuously from one facet to the next. With d = x_s - x_m = g n (|n| = 1, the sign of g
  !! that of d . n_facet), P = I - n n^T, and the tangents tau_a of the directions that are free to move (none at a
  !! corner, one along an edge), over vectors as in `gpts_kernel`,
  !!
  !!     M  = [ R^s I ; -R^m I ]     N = M n     N_a = [ 0 ; -R^m_,a n ]     A_ab = m_ab - d . x_,ab
  !!     D_a = A^ab ( M tau_b - g N_b )                                        (delta xi^a)
  !!     fe = p N w_g j_g
  !!     ke = [ dp/dg N N^T + p ( D_a N_a^T + N_a D_a^T - k_ab D_a D_b^T + Q Q^T / g ) ] w_g j_g,   Q = (M - D_a tau_a^T) P
  !!
  !! where p is the traction of the gap g - offset. It is (58) of the paper before g delta n = P (delta d) is resolved into
  !! the tangents of a smooth surface.
  use kinds, only: wp
  use status_codes, only: ok, singular_projection
  use surface_frame, only: tangent_frame_at
  use interface_law, only: gap_law, gap_response, interface_response
  implicit none (type, external)
  private
  public :: gpts_corner_point

contains

  pure subroutine gpts_corner_point(shp_s, xs, shp_m, dshp_m, d2shp_m, xm, side, held, law, opening_n, wt, &
      want_tangent, response, fe, ke, status)
    real(wp), intent(in) :: shp_s(:)                     !! slave basis at the Gauss point (nes)
    real(wp), intent(in) :: xs(:, :)                     !! current slave control points (ndm,nes) [length]
    real(wp), intent(in) :: shp_m(:)                     !! master basis at the nearest point (nem)
    real(wp), intent(in) :: dshp_m(:, :)                 !! its derivatives (dp,nem)
    real(wp), intent(in) :: d2shp_m(:, :)                !! second derivatives, packed
    real(wp), intent(in) :: xm(:, :)                     !! current master control points (ndm,nem) [length]
    real(wp), intent(in) :: side                         !! +1 or -1: the master's outward normal is side * n
    logical, intent(in) :: held(:)                       !! directions in which xi rests on the kink (dp), one at least
    type(gap_law), intent(in) :: law
    real(wp), intent(in) :: opening_n                    !! committed largest opening [length]
    real(wp), intent(in) :: wt                           !! w_g j_g of the slave [area]
    logical, intent(in) :: want_tangent
    type(gap_response), intent(out) :: response
    real(wp), contiguous, intent(inout) :: fe(:, :)      !! internal force (ndm,nes+nem) [force]
    real(wp), contiguous, intent(inout) :: ke(:, :, :, :) !! blocks a >= b [force/length]
    integer, intent(out) :: status                       !! ok, singular_map, singular_projection
    real(wp) :: x(size(xm, 1)), tau(size(xm, 1), size(dshp_m, 1)), nrm(size(xm, 1)), area, distance
    integer :: a, nes

    nes = size(shp_s)
    call tangent_frame_at(xm, shp_m, dshp_m, x, tau, nrm, area, status)
    if (status /= ok) return
    nrm = side*nrm
    x = -x
    do a = 1, nes
      x = x + shp_s(a)*xs(:, a)
    end do
    distance = sign(norm2(x), dot_product(x, nrm))
    if (abs(distance) > 0) nrm = x/distance
    call interface_response(law, distance - law%offset, opening_n, response)
    response%penalty_energy = wt*response%penalty_energy
    response%elastic_energy = wt*response%elastic_energy
    response%dissipated = wt*response%dissipated
    response%dissipation_slope = wt*response%dissipation_slope
    do a = 1, nes
      fe(:, a) = (wt*response%traction*shp_s(a))*nrm
    end do
    do a = 1, size(shp_m)
      fe(:, nes + a) = (-wt*response%traction*shp_m(a))*nrm
    end do
    if (want_tangent) call corner_tangent(size(xm, 1), nes, size(shp_m), shp_s, shp_m, dshp_m, d2shp_m, xm, tau, nrm, held, &
                                          distance, response, wt, ke, status)
  end subroutine gpts_corner_point

  pure subroutine corner_tangent(ndm, nes, nem, shp_s, shp_m, dshp_m, d2shp_m, xm, tau, nrm, held, gap, response, wt, ke, status)
    integer, intent(in) :: ndm, nes, nem
    real(wp), intent(in) :: shp_s(nes), shp_m(nem), dshp_m(:, :), d2shp_m(:, :), xm(:, :), tau(:, :)
    real(wp), intent(in) :: nrm(ndm)                     !! d / g
    logical, intent(in) :: held(:)
    real(wp), intent(in) :: gap                          !! g, the signed distance
    type(gap_response), intent(in) :: response
    real(wp), intent(in) :: wt
    real(wp), intent(inout) :: ke(ndm*(nes + nem), ndm*(nes + nem))
    integer, intent(out) :: status                       !! ok, singular_projection
    real(wp) :: m(ndm*(nes + nem), ndm), q(ndm*(nes + nem), ndm)
    real(wp), dimension(ndm*(nes + nem)) :: n0, n1, d1, along
    real(wp) :: p, p_over_g, kappa, metric, low
    integer :: a, c, i, r, free

    status = ok
    p = wt*response%traction
    p_over_g = wt*response%slope                         ! the limit for g -> 0
    if (abs(gap) > 0) p_over_g = p/gap
    m = 0
    do i = 1, ndm
      do a = 1, nes
        m(ndm*(a - 1) + i, i) = shp_s(a)
      end do
      do a = 1, nem
        m(ndm*(nes + a - 1) + i, i) = -shp_m(a)
      end do
    end do
    n0 = 0
    do i = 1, ndm
      n0 = n0 + m(:, i)*nrm(i)
    end do
    q = m
    n1 = 0
    d1 = 0
    kappa = 0
    free = findloc(held, .false., 1)
    if (free > 0) then
      ! one free direction: along the edge
      do a = 1, nem
        n1(ndm*(nes + a - 1) + 1:ndm*(nes + a)) = -dshp_m(free, a)*nrm
        kappa = kappa + d2shp_m(free, a)*dot_product(xm(:, a), nrm)
      end do
      metric = dot_product(tau(:, free), tau(:, free))
      low = metric - gap*kappa
      if (.not. low > 1.0e-12_wp*metric) then
        status = singular_projection
        return
      end if
      do i = 1, ndm
        d1 = d1 + m(:, i)*tau(i, free)
      end do
      d1 = (d1 - gap*n1)/low
      do i = 1, ndm
        q(:, i) = q(:, i) - d1*tau(i, free)
      end do
    end if
    along = 0
    do i = 1, ndm
      along = along + q(:, i)*nrm(i)
    end do
    do i = 1, ndm
      q(:, i) = q(:, i) - along*nrm(i)
    end do
    do c = 1, size(n0)
      do r = ndm*((c - 1)/ndm) + 1, size(n0)
        ke(r, c) = wt*response%slope*n0(r)*n0(c) + p*(d1(r)*n1(c) + n1(r)*d1(c) - kappa*d1(r)*d1(c)) &
          + p_over_g*dot_product(q(r, :), q(c, :))
      end do
    end do
  end subroutine corner_tangent
end module gpts_corner
