module material_laws
  !! Elastic laws of solids in nominal form: energy psi per reference volume, first Piola stress
  !! P = dpsi/dF and its derivative A_iJkL = dP_iJ/dF_kL. With B = F F^T, C = F^T F, J = det F in
  !! three dimensions, lambda and mu Lame's parameters:
  !!
  !!   neo-Hookean    psi = mu/2 (tr C - 3) - mu ln J + U(J),    q = J U',    kappa = J q'
  !!                  P = mu F + (q - mu) F^-T
  !!                  A_iJkL = mu d_ik d_JL + (mu - q) F^-1_Jk F^-1_Li + kappa F^-1_Ji F^-1_Lk
  !!     neo_hooke            U = lambda/2 (ln J)^2                (Dimitri et al. 2014, eq. (59))
  !!     neo_hooke_quadratic  U = lambda/4 (J^2 - 1 - 2 ln J)      (FEAP: FINIte, VOLUme 1)
  !!   st_venant      E = (C - I)/2,  psi = lambda/2 (tr E)^2 + mu E : E
  !!                  S = lambda tr E I + 2 mu E,  P = F S
  !!                  A_iJkL = d_ik S_JL + lambda F_iJ F_kL + mu (B_ik d_JL + F_iL F_kJ)
  !!   small_strain   psi and S with eps = sym F - I in place of E,  P = S
  !!
  !! In two dimensions F is the in-plane part (2,2), and z = F_33 the stretch through the thickness:
  !! 1 in plane strain, the root of P_33(F, z) = 0 in plane stress. Every law is written once, for n
  !! dimensions and z. In plane stress A is condensed to A - c (x) c / d, c = dP/dz, d = dP_33/dz.
  use kinds, only: wp
  use status_codes, only: ok, inverted_element, bad_law_data, law_failed
  implicit none (type, external)
  private
  public :: solid_law, define_solid_law, stress, stress_and_tangent, cauchy_stress
  public :: neo_hooke, neo_hooke_quadratic, st_venant, small_strain
  public :: plane_strain, plane_stress, three_dimensional

  integer, parameter :: neo_hooke = 1            !! kind: U = lambda/2 (ln J)^2
  integer, parameter :: neo_hooke_quadratic = 2  !! kind: U = lambda/4 (J^2 - 1 - 2 ln J)
  integer, parameter :: st_venant = 3            !! kind: St. Venant-Kirchhoff
  integer, parameter :: small_strain = 4         !! kind: linear isotropic elasticity

  integer, parameter :: plane_strain = 1         !! mode: F_33 = 1
  integer, parameter :: plane_stress = 2         !! mode: P_33 = 0
  integer, parameter :: three_dimensional = 3    !! mode: F has three dimensions

  type :: solid_law
    !! An isotropic elastic law; define_solid_law fills it.
    integer :: kind = 0            !! neo_hooke, neo_hooke_quadratic, st_venant, small_strain
    integer :: mode = 0            !! plane_strain, plane_stress, three_dimensional
    integer :: ndm = 0             !! dimension of F: 2 or 3
    real(wp) :: e = 0, nu = 0      !! Young's modulus [stress], Poisson's ratio
    real(wp) :: mu = 0, lambda = 0 !! Lame's parameters [stress]
  end type solid_law

contains

  pure subroutine define_solid_law(kind, mode, e, nu, law, status)
    integer, intent(in) :: kind            !! one of the laws above
    integer, intent(in) :: mode            !! one of the modes above
    real(wp), intent(in) :: e              !! Young's modulus, positive [stress]
    real(wp), intent(in) :: nu             !! Poisson's ratio, -1 < nu < 0.5
    type(solid_law), intent(out) :: law    !! the law
    integer, intent(out) :: status         !! ok, bad_law_data

    status = bad_law_data
    if (all(kind /= [neo_hooke, neo_hooke_quadratic, st_venant, small_strain])) return
    if (all(mode /= [plane_strain, plane_stress, three_dimensional])) return
    if (.not. (e > 0 .and. e <= huge(e))) return
    if (.not. (nu > -1 .and. nu < 0.5_wp)) return
    law%kind = kind
    law%mode = mode
    law%ndm = merge(3, 2, mode == three_dimensional)
    law%e = e
    law%nu = nu
    law%mu = e / (2 * (1 + nu))
    law%lambda = 2 * law%mu * nu / (1 - 2*nu)
    status = ok
  end subroutine define_solid_law

  pure subroutine stress(law, f, psi, p, status)
    type(solid_law), intent(in) :: law                 !! the law
    real(wp), intent(in) :: f(law%ndm,law%ndm)         !! deformation gradient F_iJ
    real(wp), intent(out) :: psi                       !! energy per reference volume [stress]
    real(wp), intent(out) :: p(law%ndm,law%ndm)        !! first Piola stress P_iJ [stress]
    integer, intent(out) :: status                     !! ok, inverted_element, law_failed
    real(wp) :: z

    call thickness_stretch(law, f, z, status)
    if (status /= ok) return
    ! a literal passed by value lets the compiler clone the laws for each dimension: half the time
    if (law%ndm == 2) then
      call law_stress(law, 2, f, z, psi, p, status)
    else
      call law_stress(law, 3, f, z, psi, p, status)
    end if
  end subroutine stress

  pure subroutine stress_and_tangent(law, f, psi, p, a, status)
    type(solid_law), intent(in) :: law                          !! the law
    real(wp), intent(in) :: f(law%ndm,law%ndm)                  !! deformation gradient F_iJ
    real(wp), intent(out) :: psi                                !! energy per volume [stress]
    real(wp), intent(out) :: p(law%ndm,law%ndm)                 !! first Piola stress P_iJ [stress]
    real(wp), intent(out) :: a(law%ndm,law%ndm,law%ndm,law%ndm) !! A_iJkL = dP_iJ/dF_kL [stress]
    integer, intent(out) :: status                              !! ok, inverted_element, law_failed
    real(wp) :: z

    call thickness_stretch(law, f, z, status)
    if (status /= ok) return
    if (law%ndm == 2) then
      call law_tangent(law, 2, f, z, psi, p, a, status)
    else
      call law_tangent(law, 3, f, z, psi, p, a, status)
    end if
    if (law%mode == plane_stress .and. status == ok) call condense_thickness(law, f, z, a, status)
  end subroutine stress_and_tangent

  pure subroutine cauchy_stress(law, f, sigma, status)
    type(solid_law), intent(in) :: law          !! the law
    real(wp), intent(in) :: f(law%ndm,law%ndm)  !! deformation gradient F_iJ
    real(wp), intent(out) :: sigma(6)           !! Cauchy stress xx, yy, zz, xy, yz, xz [stress]
    integer, intent(out) :: status              !! ok, inverted_element, law_failed
    real(wp) :: s(3,3), fi(law%ndm,law%ndm), p(law%ndm,law%ndm), c(law%ndm,law%ndm)
    real(wp) :: z, psi, d, det
    integer :: n

    n = law%ndm
    call thickness_stretch(law, f, z, status)
    if (status /= ok) return
    call law_stress(law, n, f, z, psi, p, status)
    if (status /= ok) return
    s = 0
    if (n == 2) call thickness_terms(law, f, z, s(3,3), c, d)
    if (law%kind == small_strain) then
      s(:n,:n) = p
    else
      call invert(n, f, fi, det)
      s(:n,:n) = matmul(p, transpose(f))    ! beside s_33 = P_33 F_33: F_33 = 1 or P_33 = 0
      s = s/(det*z)
    end if
    sigma = [s(1,1), s(2,2), s(3,3), s(1,2), s(2,3), s(1,3)]
  end subroutine cauchy_stress

  pure subroutine law_stress(law, n, f, z, psi, p, status)
    type(solid_law), intent(in) :: law     !! the law
    integer, value :: n                    !! dimension of F
    real(wp), intent(in) :: f(n,n)         !! deformation gradient
    real(wp), intent(in) :: z              !! stretch through the thickness
    real(wp), intent(out) :: psi           !! energy per reference volume
    real(wp), intent(out) :: p(n,n)        !! first Piola stress
    integer, intent(out) :: status         !! ok, inverted_element
    real(wp) :: fi(n,n), s(n,n), q, kappa

    select case (law%kind)
    case (neo_hooke, neo_hooke_quadratic)
      call neo_hooke_stress(law, n, f, z, psi, p, fi, q, kappa, status)
    case (st_venant)
      call st_venant_stress(law, n, f, z, psi, p, s, status)
    case default
      call small_strain_stress(law, n, f, z, psi, p)
      status = ok
    end select
  end subroutine law_stress

  pure subroutine law_tangent(law, n, f, z, psi, p, a, status)
    type(solid_law), intent(in) :: law     !! the law
    integer, value :: n                    !! dimension of F
    real(wp), intent(in) :: f(n,n)         !! deformation gradient
    real(wp), intent(in) :: z              !! stretch through the thickness, kept fixed
    real(wp), intent(out) :: psi           !! energy per reference volume
    real(wp), intent(out) :: p(n,n)        !! first Piola stress
    real(wp), intent(out) :: a(n,n,n,n)    !! its derivative at fixed z
    integer, intent(out) :: status         !! ok, inverted_element
    real(wp) :: fi(n,n), s(n,n), b(n,n), q, kappa
    integer :: i, j, k, l

    select case (law%kind)
    case (neo_hooke, neo_hooke_quadratic)
      call neo_hooke_stress(law, n, f, z, psi, p, fi, q, kappa, status)
      if (status /= ok) return
      do l = 1, n
        do k = 1, n
          do j = 1, n
            do i = 1, n
              a(i,j,k,l) = (law%mu - q)*fi(j,k)*fi(l,i) + kappa*fi(j,i)*fi(l,k)
            end do
          end do
        end do
      end do
      do j = 1, n
        do i = 1, n
          a(i,j,i,j) = a(i,j,i,j) + law%mu
        end do
      end do
    case (st_venant)
      call st_venant_stress(law, n, f, z, psi, p, s, status)
      if (status /= ok) return
      b = matmul(f, transpose(f))
      do l = 1, n
        do k = 1, n
          do j = 1, n
            do i = 1, n
              a(i,j,k,l) = law%lambda*f(i,j)*f(k,l) + law%mu*f(i,l)*f(k,j)
            end do
          end do
          a(:,l,k,l) = a(:,l,k,l) + law%mu*b(:,k)
          a(k,:,k,l) = a(k,:,k,l) + s(:,l)
        end do
      end do
    case default
      call small_strain_stress(law, n, f, z, psi, p)
      status = ok
      a = 0
      do j = 1, n
        do i = 1, n
          a(i,i,j,j) = a(i,i,j,j) + law%lambda
          a(i,j,i,j) = a(i,j,i,j) + law%mu
          a(i,j,j,i) = a(i,j,j,i) + law%mu
        end do
      end do
    end select
  end subroutine law_tangent

  pure subroutine neo_hooke_stress(law, n, f, z, psi, p, fi, q, kappa, status)
    type(solid_law), intent(in) :: law     !! the law
    integer, value :: n                    !! dimension of F
    real(wp), intent(in) :: f(n,n)         !! deformation gradient
    real(wp), intent(in) :: z              !! stretch through the thickness
    real(wp), intent(out) :: psi           !! energy per reference volume
    real(wp), intent(out) :: p(n,n)        !! first Piola stress
    real(wp), intent(out) :: fi(n,n)       !! F^-1
    real(wp), intent(out) :: q, kappa      !! J U' and J (J U')'
    integer, intent(out) :: status         !! ok, inverted_element
    real(wp) :: det, log_j, u

    call invert(n, f, fi, det)
    if (.not. det > 0) then
      status = inverted_element
      return
    end if
    status = ok
    log_j = log(det*z)
    if (law%kind == neo_hooke) then
      u = law%lambda/2 * log_j**2
      q = law%lambda * log_j
      kappa = law%lambda
    else
      u = law%lambda/4 * ((det*z)**2 - 1 - 2*log_j)
      q = law%lambda/2 * ((det*z)**2 - 1)
      kappa = law%lambda * (det*z)**2
    end if
    psi = law%mu/2 * (sum(f**2) - n + z**2 - 1) - law%mu*log_j + u
    p = law%mu*f + (q - law%mu)*transpose(fi)
  end subroutine neo_hooke_stress

  pure subroutine st_venant_stress(law, n, f, z, psi, p, s, status)
    type(solid_law), intent(in) :: law     !! the law
    integer, value :: n                    !! dimension of F
    real(wp), intent(in) :: f(n,n)         !! deformation gradient
    real(wp), intent(in) :: z              !! stretch through the thickness
    real(wp), intent(out) :: psi           !! energy per reference volume
    real(wp), intent(out) :: p(n,n)        !! first Piola stress
    real(wp), intent(out) :: s(n,n)        !! second Piola stress
    integer, intent(out) :: status         !! ok, inverted_element
    real(wp) :: fi(n,n), strain(n,n), det, strain_33, tr
    integer :: i

    call invert(n, f, fi, det)
    if (.not. det > 0) then
      status = inverted_element
      return
    end if
    status = ok
    strain = matmul(transpose(f), f) / 2
    do i = 1, n
      strain(i,i) = strain(i,i) - 0.5_wp
    end do
    strain_33 = (z**2 - 1) / 2
    call linear_stress(law, n, strain, strain_33, psi, s, tr)
    p = matmul(f, s)
  end subroutine st_venant_stress

  pure subroutine small_strain_stress(law, n, f, z, psi, p)
    type(solid_law), intent(in) :: law     !! the law
    integer, value :: n                    !! dimension of F
    real(wp), intent(in) :: f(n,n)         !! I + displacement gradient
    real(wp), intent(in) :: z              !! 1 + strain through the thickness
    real(wp), intent(out) :: psi           !! energy per volume
    real(wp), intent(out) :: p(n,n)        !! stress
    real(wp) :: strain(n,n), tr
    integer :: i

    strain = (f + transpose(f)) / 2
    do i = 1, n
      strain(i,i) = strain(i,i) - 1
    end do
    call linear_stress(law, n, strain, z - 1, psi, p, tr)
  end subroutine small_strain_stress

  pure subroutine linear_stress(law, n, strain, strain_33, psi, s, tr)
    type(solid_law), intent(in) :: law     !! the law
    integer, value :: n                    !! dimension
    real(wp), intent(in) :: strain(n,n)    !! strain tensor
    real(wp), intent(in) :: strain_33      !! strain through the thickness (0 in 3D)
    real(wp), intent(out) :: psi           !! energy per volume
    real(wp), intent(out) :: s(n,n)        !! lambda tr I + 2 mu strain
    real(wp), intent(out) :: tr            !! trace of the strain
    integer :: i

    tr = strain_33
    do i = 1, n
      tr = tr + strain(i,i)
    end do
    psi = law%lambda/2 * tr**2 + law%mu*(sum(strain**2) + strain_33**2)
    s = 2*law%mu*strain
    do i = 1, n
      s(i,i) = s(i,i) + law%lambda*tr
    end do
  end subroutine linear_stress

  pure subroutine thickness_stretch(law, f, z, status)
    !! Plane stress: z with P_33(F, z) = 0, in closed form but for neo_hooke. There, with t = ln z,
    !! g(t) = mu (exp(2t) - 1) + lambda (ln J_2 + t) = 0 is convex, and both starting values lie on
    !! the right of the root, from where Newton is monotone.
    type(solid_law), intent(in) :: law          !! the law
    real(wp), intent(in) :: f(law%ndm,law%ndm)  !! deformation gradient
    real(wp), intent(out) :: z                  !! F_33; 1 in the other modes
    integer, intent(out) :: status              !! ok, inverted_element, law_failed
    integer, parameter :: most_iterations = 100
    real(wp) :: det, log_det, t, step, slope, z2
    integer :: iteration

    z = 1
    status = ok
    if (law%mode /= plane_stress) return
    if (law%kind == small_strain) then
      z = 1 - law%lambda/(law%lambda + 2*law%mu) * (f(1,1) + f(2,2) - 2)
      return
    end if
    det = f(1,1)*f(2,2) - f(1,2)*f(2,1)
    if (.not. det > 0) then
      status = inverted_element
      return
    end if
    select case (law%kind)
    case (neo_hooke_quadratic)
      z2 = (law%mu + law%lambda/2) / (law%mu + law%lambda/2 * det**2)
    case (st_venant)
      z2 = 1 - law%lambda/(law%lambda + 2*law%mu) * (sum(f**2) - 2)
    case default
      log_det = log(det)
      t = -law%lambda*log_det / (law%lambda + 2*law%mu)
      if (t > 0 .and. law%lambda > 0) t = min(t, log(1 - law%lambda/law%mu*log_det) / 2)
      status = law_failed
      do iteration = 1, most_iterations
        slope = 2*law%mu*exp(2*t) + law%lambda
        if (.not. slope > 0) exit
        step = -(law%mu*(exp(2*t) - 1) + law%lambda*(log_det + t)) / slope
        t = t + step
        if (abs(step) <= 8*epsilon(t)*(1 + abs(t))) then
          status = ok
          exit
        end if
      end do
      z2 = exp(2*t)
    end select
    if (.not. z2 > 0) status = law_failed
    if (status == ok) z = sqrt(z2)
  end subroutine thickness_stretch

  pure subroutine thickness_terms(law, f, z, p33, c, d)
    type(solid_law), intent(in) :: law     !! the law
    real(wp), intent(in) :: f(2,2)         !! in-plane deformation gradient
    real(wp), intent(in) :: z              !! stretch through the thickness
    real(wp), intent(out) :: p33           !! P_33 [stress]
    real(wp), intent(out) :: c(2,2)        !! dP_iJ/dz = dP_33/dF_iJ [stress]
    real(wp), intent(out) :: d             !! dP_33/dz [stress]
    real(wp) :: fi(2,2), p(2,2), s(2,2), psi, q, kappa
    integer :: status

    select case (law%kind)
    case (neo_hooke, neo_hooke_quadratic)
      call neo_hooke_stress(law, 2, f, z, psi, p, fi, q, kappa, status)
      p33 = law%mu*z + (q - law%mu)/z
      c = kappa/z * transpose(fi)
      d = law%mu + (law%mu - q + kappa)/z**2
    case (st_venant)
      s(1,1) = law%lambda/2 * (sum(f**2) - 2) + (law%lambda/2 + law%mu)*(z**2 - 1)    ! S_33
      p33 = z*s(1,1)
      c = law%lambda*z*f
      d = s(1,1) + (law%lambda + 2*law%mu)*z**2
    case default
      p33 = law%lambda*(f(1,1) + f(2,2) - 2) + (law%lambda + 2*law%mu)*(z - 1)
      c = reshape([law%lambda, 0.0_wp, 0.0_wp, law%lambda], [2, 2])
      d = law%lambda + 2*law%mu
    end select
  end subroutine thickness_terms

  pure subroutine condense_thickness(law, f, z, a, status)
    type(solid_law), intent(in) :: law            !! the law
    real(wp), intent(in) :: f(2,2)                !! in-plane deformation gradient
    real(wp), intent(in) :: z                     !! stretch with P_33 = 0
    real(wp), intent(inout) :: a(2,2,2,2)         !! tangent at fixed z, then with P_33 = 0 [stress]
    integer, intent(out) :: status                !! ok, law_failed
    real(wp) :: c(2,2), p33, d
    integer :: k, l

    call thickness_terms(law, f, z, p33, c, d)
    if (.not. d > 0) then
      status = law_failed
      return
    end if
    status = ok
    do l = 1, 2
      do k = 1, 2
        a(:,:,k,l) = a(:,:,k,l) - c*(c(k,l)/d)
      end do
    end do
  end subroutine condense_thickness

  pure subroutine invert(n, f, fi, det)
    integer, value :: n                    !! dimension, 2 or 3
    real(wp), intent(in) :: f(n,n)         !! a matrix
    real(wp), intent(out) :: fi(n,n)       !! its inverse; undefined where det <= 0
    real(wp), intent(out) :: det           !! its determinant

    if (n == 2) then
      det = f(1,1)*f(2,2) - f(1,2)*f(2,1)
      if (.not. det > 0) return
      fi(1,1) = f(2,2)
      fi(2,1) = -f(2,1)
      fi(1,2) = -f(1,2)
      fi(2,2) = f(1,1)
    else
      fi(1,1) = f(2,2)*f(3,3) - f(2,3)*f(3,2)
      fi(2,1) = f(2,3)*f(3,1) - f(2,1)*f(3,3)
      fi(3,1) = f(2,1)*f(3,2) - f(2,2)*f(3,1)
      det = f(1,1)*fi(1,1) + f(1,2)*fi(2,1) + f(1,3)*fi(3,1)
      if (.not. det > 0) return
      fi(1,2) = f(1,3)*f(3,2) - f(1,2)*f(3,3)
      fi(2,2) = f(1,1)*f(3,3) - f(1,3)*f(3,1)
      fi(3,2) = f(1,2)*f(3,1) - f(1,1)*f(3,2)
      fi(1,3) = f(1,2)*f(2,3) - f(1,3)*f(2,2)
      fi(2,3) = f(1,3)*f(2,1) - f(1,1)*f(2,3)
      fi(3,3) = f(1,1)*f(2,2) - f(1,2)*f(2,1)
    end if
    fi = fi*(1/det)
  end subroutine invert

end module material_laws
