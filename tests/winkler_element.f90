module winkler_element
  !! Winkler bedding: springs normal to a line (2D) or a surface (3D), k [force/length per area].
  !!
  !!     fe(:,a) = sum_g k R_a n (n . u) w_g j_g        ke(:,a,:,b) = sum_g k R_a R_b n n^T w_g j_g
  use kinds, only: wp
  use status_codes, only: ok
  use user_element
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use surface_frame, only: tangent_frame_at
  implicit none (type, external)
  private
  public :: winkler_element_type

  type, extends(element_type) :: winkler_element_type
    real(wp) :: k = 0
  contains
    procedure :: define, evaluate
  end type winkler_element_type

contains

  subroutine define(self, ndm, properties, fault, bad_record)
    class(winkler_element_type), intent(inout) :: self
    integer, intent(in) :: ndm
    type(property_record), intent(in) :: properties(:)
    character(:), allocatable, intent(out) :: fault
    integer, intent(out) :: bad_record

    self%ndm = ndm
    self%ndf = ndm
    bad_record = size(properties)
    if (bad_record == 1) self%k = sum(properties(1)%values)
    if (.not. self%k > 0) fault = 'the bedding takes one line, STIFfness k, with k > 0'
  end subroutine define

  pure subroutine evaluate(self, task, geo, state, fe, ke, energy, status)
    class(winkler_element_type), intent(in) :: self
    integer, intent(in) :: task
    type(element_geometry), intent(inout) :: geo
    type(element_state), intent(inout) :: state
    real(wp), contiguous, intent(inout) :: fe(:, :), ke(:, :, :, :)
    type(element_energy), intent(out) :: energy
    integer, intent(out) :: status
    real(wp) :: xi(geo%dp, product(geo%degree(:geo%dp) + 1)), wt(size(xi, 2)), area
    real(wp) :: shp(geo%nen), dshp(geo%dp, geo%nen), d2shp(0, 0)
    real(wp) :: x(geo%ndm), tau(geo%ndm, geo%dp), n(geo%ndm), k(geo%ndm, geo%ndm), u(geo%ndm)
    integer :: a, b, g

    fe = 0
    if (task == task_tangent) ke = 0
    call tensor_rule(geo%degree(:geo%dp) + 1, xi, wt)
    do g = 1, size(wt)
      call shape_functions(geo%degree(:geo%dp), geo%we, geo%ce, xi(:, g), 1, shp, dshp, d2shp, status)
      if (status == ok) call tangent_frame_at(geo%xe, shp, dshp, x, tau, n, area, status)
      if (status /= ok) return
      k = self%k*area*wt(g)*spread(n, 2, geo%ndm)*spread(n, 1, geo%ndm)
      u = matmul(state%ue, shp)
      energy%stored = energy%stored + 0.5_wp*dot_product(u, matmul(k, u))
      do b = 1, geo%nen
        fe(:, b) = fe(:, b) + matmul(k, u)*shp(b)
        if (task /= task_tangent) cycle
        do a = b, geo%nen  ! a symmetric element fills the blocks a >= b
          ke(:, a, :, b) = ke(:, a, :, b) + k*shp(a)*shp(b)
        end do
      end do
    end do
  end subroutine evaluate
end module winkler_element
