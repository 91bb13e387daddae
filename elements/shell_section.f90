module shell_section
  !! The law of a shell integrated over its thickness by Gauss points, with the metric of each layer. At the height z over a
  !! mid-surface of curvature B (a symmetric matrix in orthonormal directions of the start) a layer has the tangents M E_i,
  !! M = 1 - z B, and the strains of Kirchhoff and Love, linear in those of the mid-surface,
  !!
  !!   M^-1 (eps + z kap + z^2 rho) M^-1,     2 rho = - (B kap + kap B) - 2 B eps B
  !!
  !! so that a cylinder that grows by w has w/(R + z) exactly. With L_e, L_k for what multiplies eps and kap,
  !!
  !!   n = A eps + G kap,   m = G^T eps + D kap
  !!   A = sum w L_e^T C L_e det M,   G = sum w L_e^T C L_k det M,   D = sum w L_k^T C L_k det M
  !!
  !! A flat shell has A = t C, G = 0, D = t^3/12 C, the closed form of shell_law; `excess` is what a section has beyond it, of
  !! the order of t over the radius (G) and of its square. Terms in kap^2 are left out, of the order of (t kap)^2.
  use kinds, only: wp
  use status_codes, only: ok, too_thick
  use shell_law, only: shell_law_type
  implicit none (type, external)
  private
  public :: section_type, section_of, layer_strain, layer_inverse, add_section_force

  type :: section_type
    real(wp) :: membrane(3,3)      !! excess of A [force/length]
    real(wp) :: coupling(3,3)      !! G [force]
    real(wp) :: bending(3,3)       !! excess of D [force length]
  end type section_type

  real(wp), parameter :: identity(3,3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])

contains

  pure subroutine section_of(law, b, excess, status)
    type(shell_law_type), intent(in) :: law
    real(wp), intent(in) :: b(3)              !! curvature of the start 11, 22, 12 [1/length]
    type(section_type), intent(out) :: excess
    integer, intent(out) :: status            !! ok; too_thick: a face lies beyond a centre of curvature
    real(wp) :: l_e(3,3), l_k(3,3), inverse(3), stress(3,3), face(2), ratio, z
    integer :: g

    ! M is linear in z: positive definite at both faces it is so between them
    call layer_inverse(b, -law%thickness/2, inverse, face(1))
    call layer_inverse(b, law%thickness/2, inverse, face(2))
    status = too_thick
    if (.not. all(face > 0)) return
    status = ok
    ! the closed form, taken off
    excess%membrane = stress_of(law, -law%thickness, identity)
    excess%coupling = 0
    excess%bending = stress_of(law, -law%thickness**3/12, identity)
    do g = 1, law%points
      z = law%height(g)*law%thickness
      call layer_maps(b, z, l_e, l_k, ratio)
      stress = stress_of(law, law%share(g)*law%thickness*ratio, l_k)
      excess%bending = excess%bending + matmul(transpose(l_k), stress)
      excess%coupling = excess%coupling + matmul(transpose(l_e), stress)
      stress = stress_of(law, law%share(g)*law%thickness*ratio, l_e)
      excess%membrane = excess%membrane + matmul(transpose(l_e), stress)
    end do
  end subroutine section_of

  pure function stress_of(law, weight, strain) result(stress)
    !! weight C L, for three strains side by side.
    type(shell_law_type), intent(in) :: law
    real(wp), intent(in) :: weight, strain(3,3)
    real(wp) :: stress(3,3)

    stress(1,:) = weight*(law%c11*strain(1,:) + law%c12*strain(2,:))
    stress(2,:) = weight*(law%c12*strain(1,:) + law%c11*strain(2,:))
    stress(3,:) = weight*law%c33*strain(3,:)
  end function stress_of

  pure subroutine add_section_force(excess, eps, kap, n, m)
    !! What a section has beyond the closed form.
    type(section_type), intent(in) :: excess
    real(wp), intent(in) :: eps(3), kap(3)    !! strains 11, 22, 2*12
    real(wp), intent(inout) :: n(3), m(3)     !! 11, 22, 12 [force/length], [force]

    n = n + matmul(excess%membrane, eps) + matmul(excess%coupling, kap)
    m = m + matmul(eps, excess%coupling) + matmul(excess%bending, kap)
  end subroutine add_section_force

  pure function layer_strain(b, z, eps, kap) result(strain)
    !! In orthonormal directions of the layer.
    real(wp), intent(in) :: b(3)              !! curvature of the start 11, 22, 12 [1/length]
    real(wp), intent(in) :: z                 !! height [length]
    real(wp), intent(in) :: eps(3), kap(3)    !! strains of the mid-surface 11, 22, 2*12
    real(wp) :: strain(3)                     !! 11, 22, 2*12
    real(wp) :: l_e(3,3), l_k(3,3), ratio

    call layer_maps(b, z, l_e, l_k, ratio)
    strain = matmul(l_e, eps) + matmul(l_k, kap)
  end function layer_strain

  pure subroutine layer_maps(b, z, l_e, l_k, ratio)
    real(wp), intent(in) :: b(3)              !! curvature of the start 11, 22, 12 [1/length]
    real(wp), intent(in) :: z                 !! height [length]
    real(wp), intent(out) :: l_e(3,3), l_k(3,3)   !! strain of the layer from eps and from kap
    real(wp), intent(out) :: ratio            !! det M: its area over that of the mid-surface; not positive: no maps
    real(wp) :: by_b(3,3), inverse(3), by_inverse(3,3), rho(3,3)
    integer :: i

    l_e = 0
    l_k = 0
    call layer_inverse(b, z, inverse, ratio)
    if (.not. ratio > 0) return
    by_b = congruence(b)
    by_inverse = congruence(inverse)
    rho(:,1) = -[b(1), 0.0_wp, b(3)]
    rho(:,2) = -[0.0_wp, b(2), b(3)]
    rho(:,3) = -[b(3), b(3), b(1) + b(2)]/2
    l_e = -z**2*by_b
    l_k = z**2*rho
    do i = 1, 3
      l_e(i,i) = l_e(i,i) + 1
      l_k(i,i) = l_k(i,i) + z
    end do
    l_e = matmul(by_inverse, l_e)
    l_k = matmul(by_inverse, l_k)
  end subroutine layer_maps

  pure subroutine layer_inverse(b, z, inverse, ratio)
    real(wp), intent(in) :: b(3)              !! curvature of the start 11, 22, 12 [1/length]
    real(wp), intent(in) :: z                 !! height [length]
    real(wp), intent(out) :: inverse(3)       !! M^-1 11, 22, 12
    real(wp), intent(out) :: ratio            !! det M; not positive: beyond a centre of curvature, no inverse

    inverse = 0
    ratio = (1 - z*b(1))*(1 - z*b(2)) - (z*b(3))**2
    if (ratio > 0 .and. 1 - z*b(1) > 0) then
      inverse = [1 - z*b(2), 1 - z*b(1), z*b(3)]/ratio
    else
      ratio = min(ratio, 0.0_wp)
    end if
  end subroutine layer_inverse

  pure function congruence(s) result(t)
    !! X -> S X S of symmetric 2 x 2 matrices, X and the result packed as strains, S as 11, 22, 12.
    real(wp), intent(in) :: s(3)
    real(wp) :: t(3,3)

    t(1,:) = [s(1)**2, s(3)**2, s(1)*s(3)]
    t(2,:) = [s(3)**2, s(2)**2, s(2)*s(3)]
    t(3,:) = [2*s(1)*s(3), 2*s(2)*s(3), s(1)*s(2) + s(3)**2]
  end function congruence
end module shell_section
