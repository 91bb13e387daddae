module surface_frame
  !! Frame of a surface (dp = 1 in the plane, dp = 2 in space) at a point, with x_,a = sum R_A,a x_A
  !!
  !!     tau_a = x_,a     m_ab = tau_a . tau_b     k_ab = x_,ab . n     j = sqrt(det m)
  !!     n = (tau_y, -tau_x) / |tau|  in the plane,   n = tau_1 x tau_2 / |tau_1 x tau_2|  in space.
  !!
  !! The normal points outward from a body that lies to the left of a boundary curve, or below a
  !! surface whose two directions and outside form a right-handed triad. Second derivatives are
  !! packed 11 or 11, 22, 12.
  use kinds, only: wp
  use status_codes, only: ok, singular_map
  implicit none (type, external)
  private
  public :: tangent_frame_at, surface_frame_at, metric_and_curvature

  ! A tangent that is shorter than this share of the coordinates' size is rounding error of its own
  ! sum; tangents that enclose an angle smaller than this are parallel.
  real(wp), parameter :: vanishing = 1.0e-14_wp

contains

  pure subroutine tangent_frame_at(xm, shp, dshp, x, tau, nrm, area, status)
    !! What residuals and loads need: position, tangents, normal and area element, from first
    !! derivatives.
    real(wp), intent(in) :: xm(:,:)     !! control points (ndm,nem) [length]
    real(wp), intent(in) :: shp(:)      !! basis functions (nem)
    real(wp), intent(in) :: dshp(:,:)   !! their parametric derivatives (dp,nem), dp = ndm - 1
    real(wp), intent(out) :: x(:)       !! position (ndm) [length]
    real(wp), intent(out) :: tau(:,:)   !! tangents (ndm,dp) [length]
    real(wp), intent(out) :: nrm(:)     !! unit normal (ndm); zero if the map is singular
    real(wp), intent(out) :: area       !! area (or length) element j; zero if the map is singular
    integer, intent(out) :: status      !! ok, singular_map
    real(wp) :: tangents                !! product of the tangents' lengths
    real(wp) :: extent
    integer :: a, al

    x = 0
    tau = 0
    extent = 0
    do a = 1, size(xm, 2)
      x = x + shp(a) * xm(:,a)
      do al = 1, size(tau, 2)
        tau(:,al) = tau(:,al) + dshp(al,a) * xm(:,a)
      end do
      extent = max(extent, maxval(abs(xm(:,a))))
    end do

    if (size(tau, 2) == 1) then
      nrm(1) = tau(2,1)
      nrm(2) = -tau(1,1)
      tangents = 0                     ! one tangent is never parallel
    else
      nrm(1) = tau(2,1) * tau(3,2) - tau(3,1) * tau(2,2)
      nrm(2) = tau(3,1) * tau(1,2) - tau(1,1) * tau(3,2)
      nrm(3) = tau(1,1) * tau(2,2) - tau(2,1) * tau(1,2)
      tangents = norm2(tau(:,1)) * norm2(tau(:,2))
    end if
    area = norm2(nrm)

    status = ok
    do al = 1, size(tau, 2)
      if (norm2(tau(:,al)) <= vanishing * extent) status = singular_map
    end do
    if (area <= vanishing * tangents) status = singular_map
    if (status /= ok) then
      nrm = 0
      area = 0
      return
    end if
    nrm = nrm / area
  end subroutine tangent_frame_at

  pure subroutine surface_frame_at(xm, shp, dshp, d2shp, x, tau, nrm, metric, metric_inv, &
    curvature, area, status)
    !! The whole frame, with metric and curvature, for tangents of contact and for shells.
    real(wp), intent(in) :: xm(:,:)            !! control points (ndm,nem) [length]
    real(wp), intent(in) :: shp(:)             !! basis functions (nem)
    real(wp), intent(in) :: dshp(:,:)          !! first derivatives (dp,nem)
    real(wp), intent(in) :: d2shp(:,:)         !! second derivatives, packed (dp*(dp+1)/2,nem)
    real(wp), intent(out) :: x(:)              !! position (ndm) [length]
    real(wp), intent(out) :: tau(:,:)          !! tangents (ndm,dp) [length]
    real(wp), intent(out) :: nrm(:)            !! unit normal (ndm)
    real(wp), intent(out) :: metric(:,:)       !! m_ab (dp,dp) [length^2]
    real(wp), intent(out) :: metric_inv(:,:)   !! m^ab (dp,dp) [1/length^2]
    real(wp), intent(out) :: curvature(:,:)    !! k_ab (dp,dp) [length]
    real(wp), intent(out) :: area              !! area element j
    integer, intent(out) :: status             !! ok; singular_map: all but x and tau are zero

    metric = 0
    metric_inv = 0
    curvature = 0
    call tangent_frame_at(xm, shp, dshp, x, tau, nrm, area, status)
    if (status == ok) call metric_and_curvature(xm, d2shp, tau, nrm, metric, metric_inv, curvature)
  end subroutine surface_frame_at

  pure subroutine metric_and_curvature(xm, d2shp, tau, nrm, metric, metric_inv, curvature)
    !! What the full frame adds to tangents and normal, for callers that need it only sometimes.
    real(wp), intent(in) :: xm(:,:)            !! control points (ndm,nem) [length]
    real(wp), intent(in) :: d2shp(:,:)         !! second derivatives, packed (dp*(dp+1)/2,nem)
    real(wp), intent(in) :: tau(:,:)           !! tangents, not singular (ndm,dp) [length]
    real(wp), intent(in) :: nrm(:)             !! unit normal, either way (ndm)
    real(wp), intent(out) :: metric(:,:)       !! m_ab (dp,dp) [length^2]
    real(wp), intent(out) :: metric_inv(:,:)   !! m^ab (dp,dp) [1/length^2]
    real(wp), intent(out) :: curvature(:,:)    !! k_ab of that normal (dp,dp) [length]
    real(wp) :: across                         !! x_A . n
    real(wp) :: det
    integer :: a

    curvature = 0
    if (size(tau, 2) == 1) then
      metric(1,1) = dot_product(tau(:,1), tau(:,1))
      metric_inv(1,1) = 1 / metric(1,1)
      do a = 1, size(xm, 2)
        across = dot_product(xm(:,a), nrm)
        curvature(1,1) = curvature(1,1) + d2shp(1,a) * across
      end do
    else
      metric(1,1) = dot_product(tau(:,1), tau(:,1))
      metric(2,1) = dot_product(tau(:,2), tau(:,1))
      metric(1,2) = metric(2,1)
      metric(2,2) = dot_product(tau(:,2), tau(:,2))
      det = metric(1,1) * metric(2,2) - metric(2,1)**2
      metric_inv(1,1) = metric(2,2) / det
      metric_inv(2,1) = -metric(2,1) / det
      metric_inv(1,2) = metric_inv(2,1)
      metric_inv(2,2) = metric(1,1) / det
      do a = 1, size(xm, 2)
        across = dot_product(xm(:,a), nrm)
        curvature(1,1) = curvature(1,1) + d2shp(1,a) * across
        curvature(2,2) = curvature(2,2) + d2shp(2,a) * across
        curvature(1,2) = curvature(1,2) + d2shp(3,a) * across
      end do
      curvature(2,1) = curvature(1,2)
    end if
  end subroutine metric_and_curvature
end module surface_frame
