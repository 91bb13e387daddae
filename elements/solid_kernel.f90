module solid_kernel
  !! Solid element of any basis in two and three dimensions, total Lagrangian:
  !!
  !!   F_iJ     = d_iJ + sum_a u_ai G_aJ,         G_aJ = dR_a/dX_J
  !!   f_ai     = sum_g P_iJ G_aJ V_g
  !!   K_ai,bk  = sum_g G_aJ A_iJkL G_bL V_g      = df_ai/du_bk
  !!   energy   = sum_g psi V_g
  !!
  !! P = dpsi/dF and A = dP/dF come from the law, V_g is the reference volume of a Gauss point
  !! (times the thickness of a plane body, if it is not 1). G and V do not change: solid_points
  !! computes them once, the host keeps them. The tangent is symmetric, and only its blocks a >= b
  !! are filled.
  use kinds, only: wp
  use status_codes, only: ok
  use bernstein, only: bernstein_basis
  use rational_basis, only: rational_basis_1
  use geometry_map, only: physical_gradient
  use material_laws, only: solid_law, stress, stress_and_tangent, cauchy_stress
  implicit none (type, external)
  private
  public :: bernstein_table, solid_points, solid_tangent, solid_force, solid_cauchy

contains

  pure subroutine bernstein_table(degree, xi, bez, dbez)
    !! Bernstein values of a rule: common to all elements of a degree.
    integer, intent(in) :: degree(:)        !! degrees (dp)
    real(wp), intent(in) :: xi(:,:)         !! parametric points (dp,ng)
    real(wp), intent(out) :: bez(:,:)       !! values (nb,ng)
    real(wp), intent(out) :: dbez(:,:,:)    !! derivatives (dp,nb,ng)
    real(wp) :: d2bez(size(degree)*(size(degree) + 1)/2,size(bez,1))
    integer :: g

    do g = 1, size(xi, 2)
      call bernstein_basis(degree, xi(:,g), 1, bez(:,g), dbez(:,:,g), d2bez)
    end do
  end subroutine bernstein_table

  pure subroutine solid_points(xe, we, ce, bez, dbez, wt, shp, dshp, dvol, status)
    real(wp), intent(in) :: xe(:,:)                !! reference control points (ndm,nen) [length]
    real(wp), contiguous, intent(in) :: we(:)      !! control weights (nen)
    real(wp), contiguous, intent(in) :: ce(:,:)    !! extraction operator (nen,nb)
    real(wp), contiguous, intent(in) :: bez(:,:)   !! Bernstein values at the points (nb,ng)
    real(wp), contiguous, intent(in) :: dbez(:,:,:)  !! their derivatives (ndm,nb,ng)
    real(wp), intent(in) :: wt(:)                  !! weights of the rule on the parent element (ng)
    real(wp), contiguous, intent(out) :: shp(:,:)  !! R (nen,ng)
    real(wp), contiguous, intent(out) :: dshp(:,:,:)  !! dR/dX (ndm,nen,ng) [1/length]
    real(wp), intent(out) :: dvol(:)               !! reference volumes (ng) [length^ndm]
    integer, intent(out) :: status                 !! ok, bad_weight, inverted_element
    real(wp) :: parametric(size(xe,1),size(xe,2)), detj
    integer :: g

    status = ok
    do g = 1, size(wt)
      call rational_basis_1(we, ce, bez(:,g), dbez(:,:,g), shp(:,g), parametric, status)
      if (status /= ok) return
      call physical_gradient(xe, parametric, dshp(:,:,g), detj, status)
      if (status /= ok) return
      dvol(g) = wt(g)*detj
    end do
  end subroutine solid_points

  pure subroutine solid_tangent(dshp, dvol, ue, law, fe, ke, energy, status)
    real(wp), contiguous, intent(in) :: dshp(:,:,:)   !! reference gradients (ndm,nen,ng) [1/length]
    real(wp), contiguous, intent(in) :: dvol(:)       !! reference volumes (ng) [length^ndm]
    real(wp), contiguous, intent(in) :: ue(:,:)       !! displacements (ndm,nen) [length]
    type(solid_law), intent(in) :: law                !! material law of dimension ndm
    real(wp), contiguous, intent(out) :: fe(:,:)      !! internal force (ndm,nen) [force]
    real(wp), contiguous, intent(inout) :: ke(:,:,:,:)  !! df/du (ndm,nen,ndm,nen), blocks a >= b
    real(wp), intent(out) :: energy                   !! stored energy [force length]
    integer, intent(out) :: status                    !! ok, inverted_element, law_failed

    ! a literal passed by value lets the compiler clone the element for each dimension
    if (law%ndm == 2) then
      call tangent_of(2, size(dshp, 2), size(dshp, 3), dshp, dvol, ue, law, fe, ke, energy, status)
    else
      call tangent_of(3, size(dshp, 2), size(dshp, 3), dshp, dvol, ue, law, fe, ke, energy, status)
    end if
  end subroutine solid_tangent

  pure subroutine solid_force(dshp, dvol, ue, law, fe, energy, status)
    real(wp), contiguous, intent(in) :: dshp(:,:,:)   !! reference gradients (ndm,nen,ng) [1/length]
    real(wp), contiguous, intent(in) :: dvol(:)       !! reference volumes (ng) [length^ndm]
    real(wp), contiguous, intent(in) :: ue(:,:)       !! displacements (ndm,nen) [length]
    type(solid_law), intent(in) :: law                !! material law of dimension ndm
    real(wp), contiguous, intent(out) :: fe(:,:)      !! internal force (ndm,nen) [force]
    real(wp), intent(out) :: energy                   !! stored energy [force length]
    integer, intent(out) :: status                    !! ok, inverted_element, law_failed

    if (law%ndm == 2) then
      call force_of(2, size(dshp, 2), size(dshp, 3), dshp, dvol, ue, law, fe, energy, status)
    else
      call force_of(3, size(dshp, 2), size(dshp, 3), dshp, dvol, ue, law, fe, energy, status)
    end if
  end subroutine solid_force

  pure subroutine solid_cauchy(dshp, ue, law, sigma, status)
    real(wp), contiguous, intent(in) :: dshp(:,:,:)   !! reference gradients (ndm,nen,np) [1/length]
    real(wp), contiguous, intent(in) :: ue(:,:)       !! displacements (ndm,nen) [length]
    type(solid_law), intent(in) :: law                !! material law of dimension ndm
    real(wp), intent(out) :: sigma(:,:)               !! xx, yy, zz, xy, yz, xz at the points (6,np)
    integer, intent(out) :: status                    !! ok, inverted_element, law_failed
    real(wp) :: f(law%ndm,law%ndm)
    integer :: g

    status = ok
    do g = 1, size(dshp, 3)
      call deformation(law%ndm, size(ue, 2), dshp(:,:,g), ue, f)
      call cauchy_stress(law, f, sigma(:,g), status)
      if (status /= ok) return
    end do
  end subroutine solid_cauchy

  pure subroutine tangent_of(ndm, nen, ng, dshp, dvol, ue, law, fe, ke, energy, status)
    integer, value :: ndm                             !! dimension
    integer, value :: nen                             !! functions
    integer, value :: ng                              !! Gauss points
    real(wp), intent(in) :: dshp(ndm,nen,ng)          !! reference gradients
    real(wp), intent(in) :: dvol(ng)                  !! reference volumes
    real(wp), intent(in) :: ue(ndm,nen)               !! displacements
    type(solid_law), intent(in) :: law                !! material law
    real(wp), intent(out) :: fe(ndm,nen)              !! internal force
    real(wp), intent(inout) :: ke(ndm,nen,ndm,nen)    !! its derivative, blocks a >= b
    real(wp), intent(out) :: energy                   !! stored energy
    integer, intent(out) :: status                    !! ok, inverted_element, law_failed
    real(wp) :: a(ndm,ndm,ndm,ndm,ng)                 ! A_iJkL V_g
    real(wp) :: f(ndm,ndm), p(ndm,ndm), psi
    integer :: g

    fe = 0
    energy = 0
    status = ok
    do g = 1, ng
      call deformation(ndm, nen, dshp(1,1,g), ue, f)
      call stress_and_tangent(law, f, psi, p, a(1,1,1,1,g), status)
      if (status /= ok) return
      energy = energy + psi*dvol(g)
      a(:,:,:,:,g) = a(:,:,:,:,g)*dvol(g)
      p = p*dvol(g)
      call add_force(ndm, nen, dshp(1,1,g), p, fe)
    end do
    if (ndm == 2) then
      call add_columns(2, 8, nen, ng, (nen + 7)/8, dshp, a, ke)
    else
      call add_columns(3, 4, nen, ng, (nen + 3)/4, dshp, a, ke)
    end if
  end subroutine tangent_of

  pure subroutine add_columns(ndm, width, nen, ng, blocks, dshp, a, ke)
    !! K_ai,bk = sum_gJ G_aJ h_iJk, h_iJk = A_iJkL G_bL V_g, one b after the other. Functions a are
    !! taken in blocks, filled up with zeros, so large that the sums of a block stay in registers.
    integer, value :: ndm                             !! dimension
    integer, value :: width                           !! functions of a block
    integer, value :: nen                             !! functions
    integer, value :: ng                              !! Gauss points
    integer, value :: blocks                          !! that hold all functions
    real(wp), intent(in) :: dshp(ndm,nen,ng)          !! reference gradients G_aJ
    real(wp), intent(in) :: a(ndm,ndm,ndm,ndm,ng)     !! A_iJkL V_g
    real(wp), intent(inout) :: ke(ndm,nen,ndm,nen)    !! its blocks a >= b are set
    real(wp) :: grad(width,ndm,ng,blocks), h(ndm,ndm,ndm,ng), sums(width,ndm,ndm)
    integer :: b, block, first, g, i, j, k, last, r

    do block = 1, blocks
      first = width*(block - 1)
      last = min(width, nen - first)
      do g = 1, ng
        do j = 1, ndm
          do r = 1, last
            grad(r,j,g,block) = dshp(j,first+r,g)
          end do
          do r = last + 1, width
            grad(r,j,g,block) = 0
          end do
        end do
      end do
    end do
    do b = 1, nen
      ! gfortran 12 vectorises this over g with loads beyond the last point, which may lie beyond the host's memory
      !GCC$ novector
      do g = 1, ng
        call contract(ndm, a(1,1,1,1,g), dshp(1,b,g), h(1,1,1,g))
      end do
      do block = (b - 1)/width + 1, blocks
        call block_sums(ndm, width, ng, grad(1,1,1,block), h, sums)
        first = width*(block - 1)
        do k = 1, ndm
          do r = max(b - first, 1), min(nen - first, width)
            do i = 1, ndm
              ke(i,first+r,k,b) = sums(r,i,k)
            end do
          end do
        end do
      end do
    end do
  end subroutine add_columns

  pure subroutine block_sums(ndm, width, ng, grad, h, sums)
    integer, value :: ndm                             !! dimension
    integer, value :: width                           !! functions of a block
    integer, value :: ng                              !! Gauss points
    real(wp), intent(in) :: grad(width,ndm,ng)        !! G_aJ of the block
    real(wp), intent(in) :: h(ndm,ndm,ndm,ng)         !! A_iJkL G_bL V_g of one function b
    real(wp), intent(out) :: sums(width,ndm,ndm)      !! K_ai,bk
    real(wp) :: c(width,ndm,ndm)
    integer :: a, g, i, j, k

    c = 0
    do g = 1, ng
      do j = 1, ndm
        do k = 1, ndm
          do i = 1, ndm
            !GCC$ unroll 1
            do a = 1, width          ! one or two vectors, which an early unrolling would hide
              c(a,i,k) = c(a,i,k) + grad(a,j,g)*h(i,j,k,g)
            end do
          end do
        end do
      end do
    end do
    sums = c
  end subroutine block_sums

  pure subroutine force_of(ndm, nen, ng, dshp, dvol, ue, law, fe, energy, status)
    integer, value :: ndm                             !! dimension
    integer, value :: nen                             !! functions
    integer, value :: ng                              !! Gauss points
    real(wp), intent(in) :: dshp(ndm,nen,ng)          !! reference gradients
    real(wp), intent(in) :: dvol(ng)                  !! reference volumes
    real(wp), intent(in) :: ue(ndm,nen)               !! displacements
    type(solid_law), intent(in) :: law                !! material law
    real(wp), intent(out) :: fe(ndm,nen)              !! internal force
    real(wp), intent(out) :: energy                   !! stored energy
    integer, intent(out) :: status                    !! ok, inverted_element, law_failed
    real(wp) :: f(ndm,ndm), p(ndm,ndm), psi
    integer :: g

    fe = 0
    energy = 0
    status = ok
    do g = 1, ng
      call deformation(ndm, nen, dshp(1,1,g), ue, f)
      call stress(law, f, psi, p, status)
      if (status /= ok) return
      energy = energy + psi*dvol(g)
      p = p*dvol(g)
      call add_force(ndm, nen, dshp(1,1,g), p, fe)
    end do
  end subroutine force_of

  pure subroutine deformation(ndm, nen, dshp, ue, f)
    integer, value :: ndm                             !! dimension
    integer, value :: nen                             !! functions
    real(wp), intent(in) :: dshp(ndm,nen)             !! reference gradients at a point
    real(wp), intent(in) :: ue(ndm,nen)               !! displacements
    real(wp), intent(out) :: f(ndm,ndm)               !! deformation gradient F_iJ
    integer :: a, i, j

    do j = 1, ndm
      do i = 1, ndm
        f(i,j) = merge(1.0_wp, 0.0_wp, i == j)
      end do
    end do
    do a = 1, nen
      do j = 1, ndm
        do i = 1, ndm
          f(i,j) = f(i,j) + ue(i,a)*dshp(j,a)
        end do
      end do
    end do
  end subroutine deformation

  pure subroutine add_force(ndm, nen, dshp, p, fe)
    integer, value :: ndm                             !! dimension
    integer, value :: nen                             !! functions
    real(wp), intent(in) :: dshp(ndm,nen)             !! reference gradients at a point
    real(wp), intent(in) :: p(ndm,ndm)                !! P_iJ V_g
    real(wp), intent(inout) :: fe(ndm,nen)            !! internal force
    integer :: a, i, j

    do a = 1, nen
      do j = 1, ndm
        do i = 1, ndm
          fe(i,a) = fe(i,a) + p(i,j)*dshp(j,a)
        end do
      end do
    end do
  end subroutine add_force

  pure subroutine contract(ndm, a, dshp, h)
    integer, value :: ndm                             !! dimension
    real(wp), intent(in) :: a(ndm**3,ndm)             !! A_iJkL V_g, the first three indices as one
    real(wp), intent(in) :: dshp(ndm)                 !! reference gradient of function b
    real(wp), intent(out) :: h(ndm**3)                !! A_iJkL G_bL V_g
    integer :: l

    h = a(:,1)*dshp(1)
    do l = 2, ndm
      h = h + a(:,l)*dshp(l)
    end do
  end subroutine contract

end module solid_kernel
