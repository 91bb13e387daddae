module shell_stress
  !! Forces, moments and stresses of a shell at points, as tensors in space (xx, yy, zz, xy, yz, xz):
  !!
  !!   membrane force  N = n_ij a_i (x) a_j / j          per length of now
  !!   moment          M = m_ij a_i (x) a_j / j
  !!   Cauchy stress   sigma(z) = S_ij(z) g_i (x) g_j / J,   S = C (eps + z kap),   g_i = a_i + z kap_ij a^j,
  !!                   J = |g_1 x g_2| lambda_3,   lambda_3^2 = 1 - 2 nu/(1 - nu) (E_11 + E_22)
  !!
  !! With points over the thickness forces, moments and strains are those of shell_section, with the metric of the layers. The
  !! strain E is then that in the orthonormal directions E_i of the layer, whose tangents were M E_i, M = 1 - z B, and are
  !! a_i - z b_ij a^j now, so that
  !!
  !!   sigma(z) = S_ij g_i (x) g_j / J,   S = C E,   g_i = M^-1_ij (a_j - z b_jk a^k)
  !!
  !! z runs along the normal a_1 x a_2 from -t/2 (bottom) to t/2 (top). A linear law has a_i = E_i, j = J = 1.
  use kinds, only: wp
  use status_codes, only: ok, law_failed, too_thick
  use shell_law, only: shell_law_type
  use shell_section, only: section_type, section_of, add_section_force, layer_strain, layer_inverse
  use shell_kernel, only: shell_state
  implicit none (type, external)
  private
  public :: membrane_force, bending_moment, layer_cauchy, von_mises

contains

  pure function membrane_force(now, law) result(n)
    type(shell_state), intent(in) :: now
    type(shell_law_type), intent(in) :: law
    real(wp) :: n(6)                         !! [force/length]
    real(wp) :: both(3,2)

    both = forces(now, law)
    n = in_space(both(:,1), now%a)/now%j
  end function membrane_force

  pure function bending_moment(now, law) result(m)
    type(shell_state), intent(in) :: now
    type(shell_law_type), intent(in) :: law
    real(wp) :: m(6)                         !! [force]; positive: tension at the top
    real(wp) :: both(3,2)

    both = forces(now, law)
    m = in_space(both(:,2), now%a)/now%j
  end function bending_moment

  pure function forces(now, law) result(both)
    !! n and m in the directions of the start.
    type(shell_state), intent(in) :: now
    type(shell_law_type), intent(in) :: law
    real(wp) :: both(3,2)
    type(section_type) :: section
    integer :: status

    both(:,1) = law%membrane(now%eps)
    both(:,2) = law%bending(now%kap)
    if (law%points == 0) return
    call section_of(law, curvature_at_start(now, law), section, status)
    if (status == ok) call add_section_force(section, now%eps, now%kap, both(:,1), both(:,2))
  end function forces

  pure function curvature_at_start(now, law) result(b)
    type(shell_state), intent(in) :: now
    type(shell_law_type), intent(in) :: law
    real(wp) :: b(3)                         !! 11, 22, 12 [1/length]

    b = now%b
    if (.not. law%is_linear) b = b + [now%kap(1), now%kap(2), now%kap(3)/2]
  end function curvature_at_start

  pure subroutine layer_cauchy(now, law, z, sigma, status)
    type(shell_state), intent(in) :: now
    type(shell_law_type), intent(in) :: law
    real(wp), intent(in) :: z                !! height over the mid-surface [length]
    real(wp), intent(out) :: sigma(6)        !! Cauchy stress [stress]
    integer, intent(out) :: status           !! ok; law_failed: the thickness or the area vanishes; too_thick
    real(wp) :: strain(3), start(3), inverse(3), g(3,2), normal(3), stretch, ratio

    sigma = 0
    strain = now%eps + z*now%kap
    if (law%points > 0) then
      start = curvature_at_start(now, law)
      call layer_inverse(start, z, inverse, ratio)
      status = too_thick
      if (.not. ratio > 0) return
      strain = layer_strain(start, z, now%eps, now%kap)
    end if
    g = now%a
    ratio = 1
    status = ok
    if (.not. law%is_linear) then
      if (law%points > 0) then
        g = g - z*by_pair(now%b, now%dual)
        g = by_pair(inverse, g)
      else
        g = g + z*by_pair([now%kap(1), now%kap(2), now%kap(3)/2], now%dual)
      end if
      normal(1) = g(2,1)*g(3,2) - g(3,1)*g(2,2)
      normal(2) = g(3,1)*g(1,2) - g(1,1)*g(3,2)
      normal(3) = g(1,1)*g(2,2) - g(2,1)*g(1,2)
      stretch = 1 - 2*law%nu/(1 - law%nu)*(strain(1) + strain(2))
      ratio = norm2(normal)*sqrt(max(stretch, 0.0_wp))
      if (.not. ratio > 0) then
        status = law_failed
        return
      end if
    end if
    sigma = in_space(law%layer_stress(strain), g)/ratio
  end subroutine layer_cauchy

  pure function by_pair(s, g) result(h)
    !! h_i = s_ij g_j.
    real(wp), intent(in) :: s(3)             !! 11, 22, 12
    real(wp), intent(in) :: g(3,2)
    real(wp) :: h(3,2)

    h(:,1) = s(1)*g(:,1) + s(3)*g(:,2)
    h(:,2) = s(3)*g(:,1) + s(2)*g(:,2)
  end function by_pair

  pure function in_space(s, g) result(tensor)
    !! s_ij g_i (x) g_j.
    real(wp), intent(in) :: s(3)             !! 11, 22, 12
    real(wp), intent(in) :: g(3,2)
    real(wp) :: tensor(6)                    !! xx, yy, zz, xy, yz, xz
    integer, parameter :: first(6) = [1, 2, 3, 1, 2, 1], second(6) = [1, 2, 3, 2, 3, 3]
    integer :: c

    do c = 1, 6
      tensor(c) = s(1)*g(first(c),1)*g(second(c),1) + s(2)*g(first(c),2)*g(second(c),2) &
        + s(3)*(g(first(c),1)*g(second(c),2) + g(first(c),2)*g(second(c),1))
    end do
  end function in_space

  pure function von_mises(sigma) result(equivalent)
    real(wp), intent(in) :: sigma(6)         !! xx, yy, zz, xy, yz, xz
    real(wp) :: equivalent

    equivalent = sqrt(((sigma(1) - sigma(2))**2 + (sigma(2) - sigma(3))**2 + (sigma(3) - sigma(1))**2)/2 &
      + 3*sum(sigma(4:6)**2))
  end function von_mises
end module shell_stress
