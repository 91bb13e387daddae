module winkler_element
  !! Winkler bedding: springs of stiffness k per area, normal to a line in 2D or a surface in 3D.
  !!
  !!     fe(i,a) = sum_g k R_a (u . n) n_i w_g j_g        BEDDing k [force/length^3]
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
    procedure :: define, sizes, evaluate
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
    bad_record = min(1, size(properties))
    fault = 'write one line: BEDDing k'
    if (size(properties) /= 1) return
    if (size(properties(1)%words) /= 1 .or. size(properties(1)%values) /= 1) return
    if (properties(1)%words(1) /= 'bedd') return
    self%k = properties(1)%values(1)
    deallocate (fault)
  end subroutine define

  pure subroutine sizes(self, geo, ntable, nhist)
    class(winkler_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    integer, intent(out) :: ntable, nhist

    ntable = 0  ! nothing is precomputed
    nhist = 0   ! nothing is remembered
    if (geo%nen < 0 .or. self%ndm < 0) ntable = -1
  end subroutine sizes

  pure subroutine evaluate(self, task, geo, state, fe, ke, energy, status)
    class(winkler_element_type), intent(in) :: self
    integer, intent(in) :: task
    type(element_geometry), intent(inout) :: geo
    type(element_state), intent(inout) :: state
    real(wp), contiguous, intent(inout) :: fe(:, :), ke(:, :, :, :)
    type(element_energy), intent(out) :: energy
    integer, intent(out) :: status
    real(wp) :: shp(geo%nen), dshp(geo%dp, geo%nen), d2shp(0, 0), x(geo%ndm), tau(geo%ndm, geo%dp), nrm(geo%ndm)
    real(wp) :: area, k, un, xi(geo%dp, product(geo%degree(:geo%dp) + 1)), wt(product(geo%degree(:geo%dp) + 1))
    integer :: a, b, g, i, j

    status = ok
    if (task == task_prepare) return
    fe = 0
    if (task == task_tangent) ke = 0
    call tensor_rule(geo%degree(:geo%dp) + 1, xi, wt)
    do g = 1, size(wt)
      call shape_functions(geo%degree(:geo%dp), geo%we, geo%ce, xi(:, g), 1, shp, dshp, d2shp, status)
      if (status /= ok) return
      call tangent_frame_at(geo%xe, shp, dshp, x, tau, nrm, area, status)
      if (status /= ok) return
      k = self%k*area*wt(g)
      un = dot_product(matmul(state%ue, shp), nrm)
      energy%stored = energy%stored + 0.5_wp*k*un**2
      do a = 1, geo%nen
        fe(:, a) = fe(:, a) + k*shp(a)*un*nrm
      end do
      if (task /= task_tangent) cycle
      do concurrent (b=1:geo%nen, j=1:geo%ndm, a=1:geo%nen, i=1:geo%ndm, a >= b)  ! symmetric: only a >= b
        ke(i, a, j, b) = ke(i, a, j, b) + k*shp(a)*nrm(i)*shp(b)*nrm(j)
      end do
    end do
  end subroutine evaluate
end module winkler_element
