module shell_kernel
  !! Kirchhoff-Love shell of any smooth basis, without rotations as unknowns, total Lagrangian (Kiendl, Bletzinger,
  !! Linhard, Wuechner 2009, in covariant derivatives of the current mid-surface). With x_,i = sum_a R_a,i x_a,
  !! a_i = x_,i, a_3 = a_1 x a_2 / j, b_ij = x_,ij . a_3, capital letters at the start:
  !!
  !!   eps_ij  = (a_ij - A_ij)/2          kap_ij  = B_ij - b_ij
  !!   n       = t C eps                  m       = t^3/12 C kap
  !!   d eps   = sum_a R_a,(i a_j) . du_a             d kap = - sum_a H_a,ij a_3 . du_a
  !!   H_a,ij  = R_a,ij - G^k_ij R_a,k,    G^k_ij = a^k . x_,ij,    g_a = R_a,k a^k
  !!   f_a     = int n_ij R_a,i a_j - m_ij H_a,ij a_3 dA
  !!   K_ab    = int d eps_a : tC : d eps_b + (H_a : t^3/12 C : H_b) a_3 a_3^T + (n_ij R_a,i R_b,j) 1
  !!             + (m : H_a) g_b a_3^T + (m : H_b) a_3 g_a^T + (m : b) (g_a . g_b) a_3 a_3^T dA
  !!   energy  = int (n : eps + m : kap)/2 dA
  !!
  !! The derivatives R_,i and R_,ij are taken along two orthonormal directions E_i of the tangent plane of the start at
  !! each point, so that A_ij = 1, dA is the area itself and C is the isotropic plane-stress matrix. shell_points computes
  !! them once, the host keeps them. A linear law takes all geometry from the start and drops the terms of n and m.
  !! Pairs ij are packed 11, 22, 12; only the blocks a >= b of the tangent are filled. A law with points over the thickness
  !! adds what its section has beyond tC and t^3/12 C (shell_section).
  use kinds, only: wp
  use status_codes, only: ok, singular_map
  use rational_basis, only: shape_functions
  use shell_law, only: shell_law_type
  use shell_section, only: section_type, section_of, add_section_force
  implicit none (type, external)
  private
  public :: shell_state, shell_points, shell_tangent, shell_force, shell_state_at, curvature_at_start
  public :: n_derivatives, n_frame

  integer, parameter :: n_derivatives = 5   !! of a function at a point: R_,1 R_,2 R_,11 R_,22 R_,12
  integer, parameter :: n_frame = 15        !! of the start: E_1, E_2, X_,11, X_,22, X_,12
  integer, parameter :: width = 4           !! functions of a block: their sums stay in registers
  real(wp), parameter :: vanishing = 1.0e-12_wp   !! sine of an angle between tangents that counts as none

  type :: shell_state
    !! The mid-surface at a point. A linear law has a, a_3, dual, gamma and b of the start.
    real(wp) :: a(3,2)          !! tangents a_i
    real(wp) :: a3(3)           !! unit normal
    real(wp) :: da3(3)          !! its change since the start
    real(wp) :: dual(3,2)       !! a^i
    real(wp) :: gamma(2,3)      !! G^k_ij [1/length]
    real(wp) :: b(3)            !! curvature b_ij [1/length]
    real(wp) :: j               !! area ratio
    real(wp) :: eps(3)          !! membrane strain 11, 22, 2*12
    real(wp) :: kap(3)          !! bending strain 11, 22, 2*12 [1/length]
  end type shell_state

contains

  pure subroutine shell_points(degree, xe, we, ce, xi, wt, shp, dshp, frame, area, status)
    integer, intent(in) :: degree(2)               !! Bernstein degrees
    real(wp), contiguous, intent(in) :: xe(:,:)    !! reference control points (3,nen) [length]
    real(wp), contiguous, intent(in) :: we(:)      !! control weights (nen)
    real(wp), contiguous, intent(in) :: ce(:,:)    !! extraction operator (nen,nb)
    real(wp), intent(in) :: xi(:,:)                !! points in [0,1]^2 (2,ng)
    real(wp), intent(in) :: wt(:)                  !! weights of the rule on the parent element (ng)
    real(wp), contiguous, intent(out) :: shp(:,:)  !! R (nen,ng)
    real(wp), contiguous, intent(out) :: dshp(:,:,:)  !! R_,1 R_,2 [1/length] R_,11 R_,22 R_,12 [1/length^2] (5,nen,ng)
    real(wp), contiguous, intent(out) :: frame(:,:)   !! E_1, E_2, X_,11, X_,22, X_,12 (15,ng)
    real(wp), intent(out) :: area(:)               !! reference areas (ng) [length^2]
    integer, intent(out) :: status                 !! ok, bad_weight, singular_map
    real(wp) :: d1(2,size(xe, 2)), d2(3,size(xe, 2)), tangent(3,2), normal(3), e(3,2), t11, t12, t22, l1
    integer :: a, g, i, q

    status = ok
    do g = 1, size(wt)
      call shape_functions(degree, we, ce, xi(:,g), 2, shp(:,g), d1, d2, status)
      if (status /= ok) return
      tangent = matmul(xe, transpose(d1))
      normal = cross(tangent(:,1), tangent(:,2))
      l1 = norm2(tangent(:,1))
      if (.not. norm2(normal) > vanishing*l1*norm2(tangent(:,2))) then
        status = singular_map
        return
      end if
      area(g) = norm2(normal)*wt(g)
      normal = normal/norm2(normal)
      e(:,1) = tangent(:,1)/l1
      e(:,2) = cross(normal, e(:,1))
      ! E_i = t_ai A_a
      t11 = 1/l1
      t22 = 1/dot_product(tangent(:,2), e(:,2))
      t12 = -dot_product(tangent(:,2), e(:,1))*t22*t11
      do a = 1, size(xe, 2)
        dshp(1,a,g) = t11*d1(1,a)
        dshp(2,a,g) = t12*d1(1,a) + t22*d1(2,a)
        dshp(3,a,g) = t11**2*d2(1,a)
        dshp(4,a,g) = t12**2*d2(1,a) + 2*t12*t22*d2(3,a) + t22**2*d2(2,a)
        dshp(5,a,g) = t11*(t12*d2(1,a) + t22*d2(3,a))
      end do
      frame(1:6,g) = reshape(e, [6])
      do q = 1, 3
        do i = 1, 3
          frame(3 + 3*q + i,g) = sum(xe(i,:)*dshp(2 + q,:,g))
        end do
      end do
    end do
  end subroutine shell_points

  pure subroutine shell_force(dshp, frame, area, ue, law, fe, energy, status)
    real(wp), contiguous, intent(in) :: dshp(:,:,:)   !! derivatives (5,nen,ng)
    real(wp), contiguous, intent(in) :: frame(:,:)    !! of the start (15,ng)
    real(wp), contiguous, intent(in) :: area(:)       !! reference areas (ng) [length^2]
    real(wp), contiguous, intent(in) :: ue(:,:)       !! displacements (3,nen) [length]
    type(shell_law_type), intent(in) :: law
    real(wp), contiguous, intent(out) :: fe(:,:)      !! internal force (3,nen) [force]
    real(wp), intent(out) :: energy                   !! stored energy [force length]
    integer, intent(out) :: status                    !! ok, singular_map, too_thick
    type(shell_state) :: now
    type(section_type) :: section
    real(wp) :: n(3), m(3)
    integer :: g

    fe = 0
    energy = 0
    status = ok
    do g = 1, size(area)
      call shell_state_at(size(ue, 2), dshp(:,:,g), frame(:,g), ue, law%is_linear, now, status)
      if (status /= ok) return
      n = law%membrane(now%eps)
      m = law%bending(now%kap)
      if (law%points > 0) then
        call section_of(law, curvature_at_start(frame(:,g)), section, status)
        if (status /= ok) return
        call add_section_force(section, now%eps, now%kap, n, m)
      end if
      n = area(g)*n
      m = area(g)*m
      energy = energy + (dot_product(n, now%eps) + dot_product(m, now%kap))/2
      call add_force(size(ue, 2), dshp(:,:,g), now, n, m, fe)
    end do
  end subroutine shell_force

  pure subroutine shell_tangent(dshp, frame, area, ue, law, fe, ke, energy, status)
    real(wp), contiguous, intent(in) :: dshp(:,:,:)   !! derivatives (5,nen,ng)
    real(wp), contiguous, intent(in) :: frame(:,:)    !! of the start (15,ng)
    real(wp), contiguous, intent(in) :: area(:)       !! reference areas (ng) [length^2]
    real(wp), contiguous, intent(in) :: ue(:,:)       !! displacements (3,nen) [length]
    type(shell_law_type), intent(in) :: law
    real(wp), contiguous, intent(out) :: fe(:,:)      !! internal force (3,nen) [force]
    real(wp), contiguous, intent(inout) :: ke(:,:,:,:)  !! df/du (3,nen,3,nen), blocks a >= b
    real(wp), intent(out) :: energy                   !! stored energy [force length]
    integer, intent(out) :: status                    !! ok, singular_map, too_thick

    call tangent_of(size(ue, 2), (size(ue, 2) + width - 1)/width, size(area), dshp, frame, area, ue, law, fe, ke, &
      energy, status)
  end subroutine shell_tangent

  pure subroutine tangent_of(nen, blocks, ng, dshp, frame, area, ue, law, fe, ke, energy, status)
    integer, value :: nen                             !! functions
    integer, value :: blocks                          !! of `width` functions that hold all
    integer, value :: ng                              !! Gauss points
    real(wp), intent(in) :: dshp(n_derivatives,nen,ng)
    real(wp), intent(in) :: frame(n_frame,ng)
    real(wp), intent(in) :: area(ng)
    real(wp), intent(in) :: ue(3,nen)
    type(shell_law_type), intent(in) :: law
    real(wp), intent(out) :: fe(3,nen)
    real(wp), intent(inout) :: ke(3,nen,3,nen)
    real(wp), intent(out) :: energy
    integer, intent(out) :: status
    type(shell_state) :: now(ng)
    type(section_type) :: section(ng*min(law%points, 1))
    real(wp) :: n(3,ng), m(3,ng), d(width,n_derivatives,ng,blocks), columns(width,3,n_derivatives,3,ng)
    real(wp) :: sums(width,3,width,3)
    integer :: a, block, first, g, i, k, last, q, r, row_block, row_first

    fe = 0
    energy = 0
    status = ok
    do g = 1, ng
      call shell_state_at(nen, dshp(1,1,g), frame(1,g), ue, law%is_linear, now(g), status)
      if (status /= ok) return
      n(:,g) = law%membrane(now(g)%eps)
      m(:,g) = law%bending(now(g)%kap)
      if (law%points > 0) then
        call section_of(law, curvature_at_start(frame(:,g)), section(g), status)
        if (status /= ok) return
        call add_section_force(section(g), now(g)%eps, now(g)%kap, n(:,g), m(:,g))
      end if
      n(:,g) = area(g)*n(:,g)
      m(:,g) = area(g)*m(:,g)
      energy = energy + (dot_product(n(:,g), now(g)%eps) + dot_product(m(:,g), now(g)%kap))/2
      call add_force(nen, dshp(1,1,g), now(g), n(1,g), m(1,g), fe)
    end do
    if (law%is_linear) then
      n = 0
      m = 0
    end if
    do block = 1, blocks
      first = width*(block - 1)
      last = min(width, nen - first)
      do g = 1, ng
        do q = 1, n_derivatives
          do r = 1, last
            d(r,q,g,block) = dshp(q,first + r,g)
          end do
          do r = last + 1, width
            d(r,q,g,block) = 0
          end do
        end do
      end do
    end do
    ! blocks of functions b, with blocks of rows a from the diagonal on
    do block = 1, blocks
      first = width*(block - 1)
      last = min(width, nen - first)
      do g = 1, ng
        call columns_of(d(1,1,g,block), now(g), n(1,g), m(1,g), area(g), law, columns(1,1,1,1,g))
        if (law%points > 0) call add_section_columns(d(1,1,g,block), now(g), section(g), area(g), columns(1,1,1,1,g))
      end do
      do row_block = block, blocks
        row_first = width*(row_block - 1)
        do k = 1, 3
          call block_sums(ng, d(1,1,1,row_block), columns(1,1,1,k,1), sums(1,1,1,k))
        end do
        do r = 1, last
          do k = 1, 3
            do a = max(row_first, first + r - 1) + 1, min(row_first + width, nen)
              do i = 1, 3
                ke(i,a,k,first + r) = sums(r,i,a - row_first,k)
              end do
            end do
          end do
        end do
      end do
    end do
  end subroutine tangent_of

  pure subroutine block_sums(ng, d, columns, sums)
    !! K_ai,bk = sum_gq D_aq z_bikq of a block of a, a block of b and one k.
    integer, value :: ng
    real(wp), intent(in) :: d(width,n_derivatives,ng)              !! D
    real(wp), intent(in) :: columns(width,3,3*n_derivatives,*)     !! z, that of k first
    real(wp), intent(out) :: sums(width,3,width)                   !! (b,i,a)
    real(wp) :: c(width,3,width)
    integer :: a, g, i, q, r

    c = 0
    do g = 1, ng
      do q = 1, n_derivatives
        do a = 1, width
          do i = 1, 3
            !GCC$ unroll 1
            do r = 1, width
              c(r,i,a) = c(r,i,a) + d(a,q,g)*columns(r,i,q,g)
            end do
          end do
        end do
      end do
    end do
    sums = c
  end subroutine block_sums

  pure subroutine columns_of(d, now, n, m, area, law, z)
    !! What multiplies the derivatives q of a function a in K_ai,bk at a point, for a block of functions b.
    real(wp), intent(in) :: d(width,n_derivatives)      !! derivatives of the functions b
    type(shell_state), intent(in) :: now
    real(wp), intent(in) :: n(3), m(3)                  !! forces and moments, times the area of the point
    real(wp), intent(in) :: area                        !! of the point [length^2]
    type(shell_law_type), intent(in) :: law
    real(wp), intent(out) :: z(width,3,n_derivatives,3) !! z(b,i,q,k)
    real(wp) :: c11, c12, c33, d11, d12, d33, mb, m12, d_11, d_22, d_12, h11, h22, h12, mh, gg1, gg2
    real(wp) :: a1(3), a2(3), a3(3), u1(3), u2(3), gb(width,3), s(width,3,3), y(width,3)
    real(wp) :: v(width,3,3), p(width,3,2), nb(width,2), mhb(width)
    integer :: i, k, r

    a1 = now%a(:,1)
    a2 = now%a(:,2)
    a3 = now%a3
    u1 = now%dual(:,1)
    u2 = now%dual(:,2)
    c11 = area*law%c11*law%thickness
    c12 = area*law%c12*law%thickness
    c33 = area*law%c33*law%thickness
    d11 = c11*law%thickness**2/12
    d12 = c12*law%thickness**2/12
    d33 = c33*law%thickness**2/12
    m12 = 2*m(3)
    mb = m(1)*now%b(1) + m(2)*now%b(2) + m12*now%b(3)
    !GCC$ unroll 1
    do r = 1, width
      nb(r,1) = n(1)*d(r,1) + n(3)*d(r,2)
      nb(r,2) = n(3)*d(r,1) + n(2)*d(r,2)
      h11 = d(r,3) - now%gamma(1,1)*d(r,1) - now%gamma(2,1)*d(r,2)
      h22 = d(r,4) - now%gamma(1,2)*d(r,1) - now%gamma(2,2)*d(r,2)
      h12 = d(r,5) - now%gamma(1,3)*d(r,1) - now%gamma(2,3)*d(r,2)
      mhb(r) = m(1)*h11 + m(2)*h22 + m12*h12
      y(r,1) = d11*h11 + d12*h22
      y(r,2) = d12*h11 + d11*h22
      y(r,3) = 4*d33*h12
    end do
    do k = 1, 3
      !GCC$ unroll 1
      do r = 1, width
        d_11 = d(r,1)*a1(k)
        d_22 = d(r,2)*a2(k)
        d_12 = d(r,1)*a2(k) + d(r,2)*a1(k)
        s(r,k,1) = c11*d_11 + c12*d_22
        s(r,k,2) = c12*d_11 + c11*d_22
        s(r,k,3) = c33*d_12
        gb(r,k) = d(r,1)*u1(k) + d(r,2)*u2(k)
      end do
    end do
    do i = 1, 3
      !GCC$ unroll 1
      do r = 1, width
        v(r,i,1) = a3(i)*y(r,1) + m(1)*gb(r,i)
        v(r,i,2) = a3(i)*y(r,2) + m(2)*gb(r,i)
        v(r,i,3) = a3(i)*y(r,3) + m12*gb(r,i)
      end do
    end do
    do i = 1, 3
      !GCC$ unroll 1
      do r = 1, width
        gg1 = u1(1)*gb(r,1) + u1(2)*gb(r,2) + u1(3)*gb(r,3)
        gg2 = u2(1)*gb(r,1) + u2(2)*gb(r,2) + u2(3)*gb(r,3)
        p(r,i,1) = mb*gg1*a3(i) - now%gamma(1,1)*v(r,i,1) - now%gamma(1,2)*v(r,i,2) - now%gamma(1,3)*v(r,i,3)
        p(r,i,2) = mb*gg2*a3(i) - now%gamma(2,1)*v(r,i,1) - now%gamma(2,2)*v(r,i,2) - now%gamma(2,3)*v(r,i,3)
      end do
    end do
    do k = 1, 3
      do i = 1, 3
        !GCC$ unroll 1
        do r = 1, width
          mh = mhb(r)*a3(i)
          z(r,i,1,k) = a1(i)*s(r,k,1) + a2(i)*s(r,k,3) + p(r,i,1)*a3(k) + mh*u1(k)
          z(r,i,2,k) = a2(i)*s(r,k,2) + a1(i)*s(r,k,3) + p(r,i,2)*a3(k) + mh*u2(k)
          z(r,i,3,k) = v(r,i,1)*a3(k)
          z(r,i,4,k) = v(r,i,2)*a3(k)
          z(r,i,5,k) = v(r,i,3)*a3(k)
        end do
      end do
    end do
    do i = 1, 3
      !GCC$ unroll 1
      do r = 1, width
        z(r,i,1,i) = z(r,i,1,i) + nb(r,1)
        z(r,i,2,i) = z(r,i,2,i) + nb(r,2)
      end do
    end do
  end subroutine columns_of

  pure subroutine add_section_columns(d, now, section, area, z)
    !! What the section's stiffness beyond the closed form adds to the columns: d eps_a . dn_b + d kap_a . dm_b.
    real(wp), intent(in) :: d(width,n_derivatives)      !! derivatives of the functions b
    type(shell_state), intent(in) :: now
    type(section_type), intent(in) :: section
    real(wp), intent(in) :: area                        !! of the point [length^2]
    real(wp), intent(inout) :: z(width,3,n_derivatives,3) !! z(b,i,q,k)
    real(wp), parameter :: twice(3) = [1, 1, 2]         !! a pair 12 stands for 21 too
    real(wp) :: h(width,3), gh(width,3), dh(width,3), deps(width,3), dn(width,3), dm(width,3), t(width,3), a3
    integer :: i, k, q, r

    do q = 1, 3
      !GCC$ unroll 1
      do r = 1, width
        h(r,q) = area*twice(q)*(d(r,2 + q) - now%gamma(1,q)*d(r,1) - now%gamma(2,q)*d(r,2))
      end do
    end do
    do q = 1, 3
      !GCC$ unroll 1
      do r = 1, width
        gh(r,q) = section%coupling(q,1)*h(r,1) + section%coupling(q,2)*h(r,2) + section%coupling(q,3)*h(r,3)
        dh(r,q) = section%bending(q,1)*h(r,1) + section%bending(q,2)*h(r,2) + section%bending(q,3)*h(r,3)
      end do
    end do
    do k = 1, 3
      a3 = now%a3(k)
      !GCC$ unroll 1
      do r = 1, width
        deps(r,1) = area*d(r,1)*now%a(k,1)
        deps(r,2) = area*d(r,2)*now%a(k,2)
        deps(r,3) = area*(d(r,1)*now%a(k,2) + d(r,2)*now%a(k,1))
      end do
      do q = 1, 3
        !GCC$ unroll 1
        do r = 1, width
          dn(r,q) = section%membrane(q,1)*deps(r,1) + section%membrane(q,2)*deps(r,2) + section%membrane(q,3)*deps(r,3) &
            - gh(r,q)*a3
          dm(r,q) = twice(q)*(section%coupling(1,q)*deps(r,1) + section%coupling(2,q)*deps(r,2) &
            + section%coupling(3,q)*deps(r,3) - dh(r,q)*a3)
        end do
      end do
      do i = 1, 3
        do q = 1, 3
          !GCC$ unroll 1
          do r = 1, width
            t(r,q) = -now%a3(i)*dm(r,q)
            z(r,i,2 + q,k) = z(r,i,2 + q,k) + t(r,q)
          end do
        end do
        !GCC$ unroll 1
        do r = 1, width
          z(r,i,1,k) = z(r,i,1,k) + now%a(i,1)*dn(r,1) + now%a(i,2)*dn(r,3) &
            - now%gamma(1,1)*t(r,1) - now%gamma(1,2)*t(r,2) - now%gamma(1,3)*t(r,3)
          z(r,i,2,k) = z(r,i,2,k) + now%a(i,2)*dn(r,2) + now%a(i,1)*dn(r,3) &
            - now%gamma(2,1)*t(r,1) - now%gamma(2,2)*t(r,2) - now%gamma(2,3)*t(r,3)
        end do
      end do
    end do
  end subroutine add_section_columns

  pure function curvature_at_start(frame) result(b)
    real(wp), intent(in) :: frame(n_frame)        !! of the start
    real(wp) :: b(3)                              !! B 11, 22, 12 [1/length]
    real(wp) :: normal(3)

    normal = cross(frame(1:3), frame(4:6))
    b = matmul(normal, reshape(frame(7:15), [3, 3]))
  end function curvature_at_start

  pure subroutine add_force(nen, dshp, now, n, m, fe)
    integer, value :: nen
    real(wp), intent(in) :: dshp(n_derivatives,nen)
    type(shell_state), intent(in) :: now
    real(wp), intent(in) :: n(3), m(3)            !! forces and moments, times the area of the point
    real(wp), intent(inout) :: fe(3,nen)
    real(wp) :: y(3,n_derivatives)
    integer :: a, i, k

    do i = 1, 3
      do k = 1, 2
        y(i,k) = n(3)*now%a(i,3 - k) + n(k)*now%a(i,k) &
          + (m(1)*now%gamma(k,1) + m(2)*now%gamma(k,2) + 2*m(3)*now%gamma(k,3))*now%a3(i)
      end do
      y(i,3) = -m(1)*now%a3(i)
      y(i,4) = -m(2)*now%a3(i)
      y(i,5) = -2*m(3)*now%a3(i)
    end do
    do a = 1, nen
      do i = 1, 3
        fe(i,a) = fe(i,a) + y(i,1)*dshp(1,a) + y(i,2)*dshp(2,a) + y(i,3)*dshp(3,a) + y(i,4)*dshp(4,a) + y(i,5)*dshp(5,a)
      end do
    end do
  end subroutine add_force

  pure subroutine shell_state_at(nen, dshp, frame, ue, is_linear, now, status)
    !! Geometry and strains at a point. Strains come from displacement gradients, without the difference of large numbers.
    integer, value :: nen                              !! functions
    real(wp), intent(in) :: dshp(n_derivatives,nen)    !! derivatives
    real(wp), intent(in) :: frame(n_frame)             !! of the start
    real(wp), intent(in) :: ue(3,nen)                  !! displacements [length]
    logical, intent(in) :: is_linear                   !! small displacements
    type(shell_state), intent(out) :: now
    integer, intent(out) :: status                     !! ok, singular_map
    real(wp) :: du(3,n_derivatives), e(3,3), d(3), x2(3,3), growth, lengths
    integer :: a, i, k, q

    status = ok
    du = 0
    do a = 1, nen
      do q = 1, n_derivatives
        do i = 1, 3
          du(i,q) = du(i,q) + dshp(q,a)*ue(i,a)
        end do
      end do
    end do
    e(:,1) = frame(1:3)
    e(:,2) = frame(4:6)
    e(:,3) = cross(e(:,1), e(:,2))
    now%eps(1) = dot_product(e(:,1), du(:,1))
    now%eps(2) = dot_product(e(:,2), du(:,2))
    now%eps(3) = dot_product(e(:,1), du(:,2)) + dot_product(e(:,2), du(:,1))
    if (is_linear) then
      now%a = e(:,1:2)
      now%a3 = e(:,3)
      now%da3 = -e(:,1)*dot_product(e(:,3), du(:,1)) - e(:,2)*dot_product(e(:,3), du(:,2))
      now%dual = now%a
      now%j = 1
      x2 = reshape(frame(7:15), [3, 3])
    else
      now%eps(1) = now%eps(1) + dot_product(du(:,1), du(:,1))/2
      now%eps(2) = now%eps(2) + dot_product(du(:,2), du(:,2))/2
      now%eps(3) = now%eps(3) + dot_product(du(:,1), du(:,2))
      now%a = e(:,1:2) + du(:,1:2)
      d = cross(e(:,1), du(:,2)) + cross(du(:,1), now%a(:,2))   ! a_1 x a_2 = A_3 + d
      growth = dot_product(2*e(:,3) + d, d)                     ! j^2 - 1
      lengths = dot_product(now%a(:,1), now%a(:,1))*dot_product(now%a(:,2), now%a(:,2))
      if (.not. 1 + growth > vanishing**2*lengths) then
        status = singular_map
        return
      end if
      now%j = sqrt(1 + growth)
      now%da3 = (d - e(:,3)*(growth/(1 + now%j)))/now%j
      now%a3 = e(:,3) + now%da3
      now%dual(:,1) = cross(now%a(:,2), now%a3)/now%j
      now%dual(:,2) = cross(now%a3, now%a(:,1))/now%j
      x2 = reshape(frame(7:15), [3, 3]) + du(:,3:5)
    end if
    do q = 1, 3
      do k = 1, 2
        now%gamma(k,q) = dot_product(now%dual(:,k), x2(:,q))
      end do
      now%b(q) = dot_product(now%a3, x2(:,q))
      now%kap(q) = -dot_product(du(:,2 + q), now%a3) - dot_product(frame(4 + 3*q:6 + 3*q), now%da3)
    end do
    now%kap(3) = 2*now%kap(3)
  end subroutine shell_state_at

  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)      !! vectors
    real(wp) :: c(3)                        !! a x b

    c(1) = a(2)*b(3) - a(3)*b(2)
    c(2) = a(3)*b(1) - a(1)*b(3)
    c(3) = a(1)*b(2) - a(2)*b(1)
  end function cross
end module shell_kernel
