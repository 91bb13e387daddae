module surface_load
  !! Loads on facets of any basis (edges in two dimensions, faces in three) and in the body. With
  !! the tangents of the facet, tau_k = x_,k, and its area vector N = (tau_y, -tau_x) or
  !! tau_1 x tau_2, which points outward when the facet's parameters are directed so:
  !!
  !!   dead traction       f_a = - sum_g R_a t |N_0| w_g       per reference area
  !!   dead pressure       f_a = + sum_g R_a p N_0 w_g         reference normal and area
  !!   follower pressure   f_a = + sum_g R_a p N w_g           current normal and area
  !!   body force          f_a = - sum_g R_a b V_g             per reference volume
  !!
  !! A traction on a curve in space (the edge of a shell) is a force per length, |N_0| its |tau|.
  !! A positive pressure pushes against the surface. As everywhere, f is an internal force, minus
  !! the load, and K = df/du. Only follower pressure has one,
  !!
  !!   K_ai,bj = sum_g R_a p dN_i/dtau_jk R_b,k w_g,
  !!
  !! unsymmetric unless the pressure is constant and the surface closed (or held at its rim), so all
  !! its blocks are filled.
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: dead_traction, dead_pressure, follower_pressure, body_force

contains

  pure subroutine dead_traction(xe, shp, dshp, wt, traction, fe)
    real(wp), intent(in) :: xe(:,:)         !! reference control points (ndm,nen) [length]
    real(wp), intent(in) :: shp(:,:)        !! R at the points of the facet (nen,ng)
    real(wp), intent(in) :: dshp(:,:,:)     !! their parametric derivatives (dp,nen,ng)
    real(wp), intent(in) :: wt(:)           !! weights of the rule on the parent facet (ng)
    real(wp), intent(in) :: traction(:,:)   !! force per reference area or length (ndm,ng)
    real(wp), intent(out) :: fe(:,:)        !! minus the load (ndm,nen) [force]
    real(wp) :: tau(size(xe,1),size(dshp,1)), area(size(xe,1))
    integer :: g

    fe = 0
    do g = 1, size(wt)
      call tangents(xe, dshp(:,:,g), tau)
      if (size(tau, 2) == size(tau, 1) - 1) then
        call area_vector(tau, area)
      else
        area = tau(:,1)
      end if
      call add_point(shp(:,g), -traction(:,g)*(norm2(area)*wt(g)), fe)
    end do
  end subroutine dead_traction

  pure subroutine dead_pressure(xe, shp, dshp, wt, pressure, fe)
    real(wp), intent(in) :: xe(:,:)         !! reference control points (ndm,nen) [length]
    real(wp), intent(in) :: shp(:,:)        !! R at the points of the facet (nen,ng)
    real(wp), intent(in) :: dshp(:,:,:)     !! their parametric derivatives (ndm-1,nen,ng)
    real(wp), intent(in) :: wt(:)           !! weights of the rule on the parent facet (ng)
    real(wp), intent(in) :: pressure(:)     !! pressure against the outward normal (ng) [stress]
    real(wp), intent(out) :: fe(:,:)        !! minus the load (ndm,nen) [force]
    real(wp) :: tau(size(xe,1),size(xe,1)-1), area(size(xe,1))
    integer :: g

    fe = 0
    do g = 1, size(wt)
      call tangents(xe, dshp(:,:,g), tau)
      call area_vector(tau, area)
      call add_point(shp(:,g), area*(pressure(g)*wt(g)), fe)
    end do
  end subroutine dead_pressure

  pure subroutine follower_pressure(xe, ue, shp, dshp, wt, pressure, fe, ke)
    real(wp), intent(in) :: xe(:,:)         !! reference control points (ndm,nen) [length]
    real(wp), intent(in) :: ue(:,:)         !! displacements (ndm,nen) [length]
    real(wp), intent(in) :: shp(:,:)        !! R at the points of the facet (nen,ng)
    real(wp), intent(in) :: dshp(:,:,:)     !! their parametric derivatives (ndm-1,nen,ng)
    real(wp), intent(in) :: wt(:)           !! weights of the rule on the parent facet (ng)
    real(wp), intent(in) :: pressure(:)     !! pressure against the outward normal (ng) [stress]
    real(wp), intent(out) :: fe(:,:)        !! minus the load (ndm,nen) [force]
    real(wp), intent(out) :: ke(:,:,:,:)    !! df/du (ndm,nen,ndm,nen), unsymmetric, all blocks
    real(wp) :: x(size(xe,1),size(xe,2))
    real(wp) :: tau(size(xe,1),size(xe,1)-1), area(size(xe,1))
    real(wp) :: darea(size(xe,1),size(xe,1),size(xe,1)-1), dforce(size(xe,1),size(xe,1))
    integer :: a, b, g, j, k

    fe = 0
    ke = 0
    x = xe + ue
    do g = 1, size(wt)
      call tangents(x, dshp(:,:,g), tau)
      call area_vector(tau, area)
      call add_point(shp(:,g), area*(pressure(g)*wt(g)), fe)
      call area_linearisation(tau, darea)
      do b = 1, size(xe, 2)
        dforce = 0
        do k = 1, size(tau, 2)
          dforce = dforce + darea(:,:,k)*(dshp(k,b,g)*pressure(g)*wt(g))
        end do
        do j = 1, size(xe, 1)
          do a = 1, size(xe, 2)
            ke(:,a,j,b) = ke(:,a,j,b) + shp(a,g)*dforce(:,j)
          end do
        end do
      end do
    end do
  end subroutine follower_pressure

  pure subroutine body_force(shp, dvol, force, fe)
    real(wp), intent(in) :: shp(:,:)        !! R at the points of the element (nen,ng)
    real(wp), intent(in) :: dvol(:)         !! reference volumes (ng) [length^ndm]
    real(wp), intent(in) :: force(:,:)      !! force per reference volume (ndm,ng) [stress/length]
    real(wp), intent(out) :: fe(:,:)        !! minus the load (ndm,nen) [force]
    integer :: g

    fe = 0
    do g = 1, size(dvol)
      call add_point(shp(:,g), -force(:,g)*dvol(g), fe)
    end do
  end subroutine body_force

  pure subroutine add_point(shp, force, fe)
    real(wp), intent(in) :: shp(:)          !! R at a point (nen)
    real(wp), intent(in) :: force(:)        !! force at the point (ndm)
    real(wp), intent(inout) :: fe(:,:)      !! force on the control points (ndm,nen)
    integer :: a

    do a = 1, size(shp)
      fe(:,a) = fe(:,a) + shp(a)*force
    end do
  end subroutine add_point

  pure subroutine tangents(x, dshp, tau)
    real(wp), intent(in) :: x(:,:)          !! control points (ndm,nen) [length]
    real(wp), intent(in) :: dshp(:,:)       !! parametric derivatives (dp,nen)
    real(wp), intent(out) :: tau(:,:)       !! covariant tangents (ndm,dp) [length]
    integer :: a, k

    tau = 0
    do a = 1, size(x, 2)
      do k = 1, size(tau, 2)
        tau(:,k) = tau(:,k) + x(:,a)*dshp(k,a)
      end do
    end do
  end subroutine tangents

  pure subroutine area_vector(tau, area)
    !! The normal times the area per parent area: no division, so a collapsed edge does no harm.
    real(wp), intent(in) :: tau(:,:)        !! covariant tangents (ndm,ndm-1) [length]
    real(wp), intent(out) :: area(:)        !! area vector (ndm) [length^(ndm-1)]

    if (size(tau, 1) == 2) then
      area = [tau(2,1), -tau(1,1)]
    else
      area = cross(tau(:,1), tau(:,2))
    end if
  end subroutine area_vector

  pure subroutine area_linearisation(tau, darea)
    real(wp), intent(in) :: tau(:,:)        !! covariant tangents (ndm,ndm-1) [length]
    real(wp), intent(out) :: darea(:,:,:)   !! dN_i/dtau_jk (ndm,ndm,ndm-1)
    real(wp) :: e(3)
    integer :: j

    if (size(tau, 1) == 2) then
      darea(:,:,1) = reshape([0, -1, 1, 0], [2, 2])
      return
    end if
    do j = 1, 3
      e = 0
      e(j) = 1
      darea(:,j,1) = cross(e, tau(:,2))
      darea(:,j,2) = cross(tau(:,1), e)
    end do
  end subroutine area_linearisation

  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)      !! vectors
    real(wp) :: c(3)                        !! a x b

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross

end module surface_load
