module shell_law
  !! Elastic law of a shell, integrated over its thickness t in closed form: St. Venant-Kirchhoff in plane stress,
  !!
  !!   n = t C eps,   m = t^3/12 C kap,   C = E/(1 - nu^2) [1 nu 0; nu 1 0; 0 0 (1 - nu)/2]
  !!
  !! in orthonormal directions, for strains 11, 22, 2*12 and forces 11, 22, 12. The energy of a layer at the height z is
  !! that of the strain eps + z kap; the metric's own change with z, of the order of t over the radius of curvature, is
  !! neglected, as in shells of this kind. With `points`, shell_section adds it by quadrature.
  use kinds, only: wp
  use status_codes, only: ok, bad_law_data
  use gauss_rules, only: gauss_legendre
  implicit none (type, external)
  private
  public :: shell_law_type, define_shell_law, most_points

  integer, parameter :: most_points = 20   !! over the thickness

  type :: shell_law_type
    real(wp) :: c11 = 0, c12 = 0, c33 = 0   !! C [stress]
    real(wp) :: nu = 0                      !! Poisson's ratio
    real(wp) :: thickness = 0               !! [length]
    logical :: is_linear = .false.          !! small strains and rotations
    integer :: points = 0                   !! Gauss points over the thickness; 0: closed form
    real(wp) :: height(most_points) = 0, share(most_points) = 0   !! of the points, over the thickness (from -1/2 to 1/2)
  contains
    procedure :: integrate_by_points
    procedure :: membrane
    procedure :: bending
    procedure :: layer_stress
  end type shell_law_type

contains

  pure subroutine define_shell_law(youngs, nu, thickness, is_linear, law, status)
    real(wp), intent(in) :: youngs               !! Young's modulus [stress]
    real(wp), intent(in) :: nu                   !! Poisson's ratio
    real(wp), intent(in) :: thickness            !! [length]
    logical, intent(in) :: is_linear             !! small strains and rotations
    type(shell_law_type), intent(out) :: law
    integer, intent(out) :: status               !! ok, bad_law_data

    status = bad_law_data
    if (.not. (youngs > 0 .and. nu > -1 .and. nu <= 0.5_wp .and. thickness > 0)) return
    status = ok
    law%c11 = youngs/(1 - nu**2)
    law%c12 = nu*law%c11
    law%c33 = youngs/(2*(1 + nu))
    law%nu = nu
    law%thickness = thickness
    law%is_linear = is_linear
  end subroutine define_shell_law

  pure subroutine integrate_by_points(self, n)
    class(shell_law_type), intent(inout) :: self
    integer, intent(in) :: n                !! 2 to most_points; 0: closed form

    self%points = n
    if (n == 0) return
    call gauss_legendre(n, self%height(1:n), self%share(1:n))
    self%height(1:n) = self%height(1:n) - 0.5_wp
  end subroutine integrate_by_points

  pure function membrane(self, eps) result(n)
    class(shell_law_type), intent(in) :: self
    real(wp), intent(in) :: eps(3)          !! membrane strain 11, 22, 2*12
    real(wp) :: n(3)                        !! membrane forces 11, 22, 12 [force/length]

    n = self%thickness*self%layer_stress(eps)
  end function membrane

  pure function bending(self, kap) result(m)
    class(shell_law_type), intent(in) :: self
    real(wp), intent(in) :: kap(3)          !! bending strain 11, 22, 2*12 [1/length]
    real(wp) :: m(3)                        !! moments 11, 22, 12 [force]

    m = self%thickness**3/12*self%layer_stress(kap)
  end function bending

  pure function layer_stress(self, strain) result(s)
    class(shell_law_type), intent(in) :: self
    real(wp), intent(in) :: strain(3)       !! 11, 22, 2*12
    real(wp) :: s(3)                        !! second Piola stress 11, 22, 12 [stress]

    s(1) = self%c11*strain(1) + self%c12*strain(2)
    s(2) = self%c12*strain(1) + self%c11*strain(2)
    s(3) = self%c33*strain(3)
  end function layer_stress
end module shell_law
