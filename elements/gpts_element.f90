module gpts_element
  !! The interface element: one slave Gauss point with the functions of its slave facet (first) and of the master facet
  !! that it projects on. Formulation in `gpts_kernel`, law in `interface_law`. Its history is one word: the largest
  !! opening. MATErial lines: `PENAlty eps`.
  use kinds, only: wp
  use status_codes, only: ok
  use user_element, only: element_type, element_geometry, element_state, element_energy, property_record, &
    task_prepare, task_tangent, task_dissipation_gradient
  use rational_basis, only: shape_functions
  use surface_frame, only: tangent_frame_at
  use interface_law, only: gap_law, gap_response, contact_law
  use gpts_kernel, only: gpts_point
  use gpts_corner, only: gpts_corner_point
  implicit none (type, external)
  private
  public :: gpts_element_type

  type, extends(element_type) :: gpts_element_type
    type(gap_law) :: law
  contains
    procedure :: define
    procedure :: sizes
    procedure :: evaluate
  end type gpts_element_type

contains

  subroutine define(self, ndm, properties, fault, bad_record)
    class(gpts_element_type), intent(inout) :: self
    integer, intent(in) :: ndm
    type(property_record), intent(in) :: properties(:)
    character(:), allocatable, intent(out) :: fault
    integer, intent(out) :: bad_record
    real(wp) :: penalty
    integer :: i, status

    self%ndm = ndm
    self%ndf = ndm
    self%symmetric = .true.
    bad_record = 0
    penalty = 0
    do i = 1, size(properties)
      bad_record = i
      if (size(properties(i)%words) < 1) then
        fault = 'a law of the interface is expected, such as PENAlty 1e3'
        return
      end if
      select case (properties(i)%words(1))
      case ('pena')
        if (size(properties(i)%values) /= 1) then
          fault = 'PENAlty takes one number, the contact stiffness [force/length per area]'
          return
        end if
        penalty = properties(i)%values(1)
        call contact_law(penalty, self%law, status)
        if (status /= ok) then
          fault = 'the penalty must be positive'
          return
        end if
      case default
        fault = 'unknown interface law "'//properties(i)%words(1)//'". Known laws: PENAlty'
        return
      end select
    end do
    bad_record = 0
    if (.not. penalty > 0) fault = 'the penalty is missing: add PENAlty=number'
  end subroutine define

  pure subroutine sizes(self, geo, ntable, nhist)
    class(gpts_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    integer, intent(out) :: ntable   !! weight w_g j_g, then the slave functions
    integer, intent(out) :: nhist    !! the largest opening

    ntable = geo%nen + 1
    nhist = merge(1, 0, self%law%p_max > 0)
  end subroutine sizes

  pure subroutine evaluate(self, task, geo, state, fe, ke, energy, status)
    class(gpts_element_type), intent(in) :: self
    integer, intent(in) :: task
    type(element_geometry), intent(inout) :: geo
    type(element_state), intent(inout) :: state
    real(wp), contiguous, intent(inout) :: fe(:, :)
    real(wp), contiguous, intent(inout) :: ke(:, :, :, :)
    type(element_energy), intent(out) :: energy
    integer, intent(out) :: status
    real(wp) :: x(self%ndm, geo%nen)
    real(wp) :: shp(geo%master%nen), dshp(self%ndm - 1, geo%master%nen)
    real(wp) :: d2shp((self%ndm - 1)*self%ndm/2, geo%master%nen)
    real(wp) :: opening
    type(gap_response) :: response
    integer :: a, dp, ns
    logical :: want_tangent

    dp = self%ndm - 1
    if (task == task_prepare) then
      call prepare_point(self%ndm, dp, geo, status)
      return
    end if
    do a = 1, geo%nen
      x(:, a) = geo%xe(:, a) + state%ue(1:self%ndm, a)
    end do
    ns = geo%nes
    associate (m => geo%master)
      want_tangent = task == task_tangent
      call shape_functions(m%degree(1:dp), m%we, m%ce, m%xi(1:dp), merge(2, 1, want_tangent), shp, dshp, d2shp, status)
      if (status /= ok) return
      opening = 0
      if (size(state%hist_n) > 0) opening = state%hist_n(1)
      if (any(m%held(1:dp))) then
        call gpts_corner_point(geo%table(2:ns + 1), x(:, 1:ns), shp, dshp, d2shp, x(:, ns + 1:), m%side, m%held(1:dp), &
                               self%law, opening, geo%table(1), want_tangent, response, fe, ke, status)
      else
        call gpts_point(geo%table(2:ns + 1), x(:, 1:ns), shp, dshp, d2shp, x(:, ns + 1:), m%side, self%law, opening, &
                        geo%table(1), want_tangent, response, fe, ke, status)
      end if
    end associate
    if (status /= ok) return
    if (task == task_dissipation_gradient) then
      call turn_to_dissipation(response, geo%table(1), fe)
    else if (size(state%hist) > 0) then
      state%hist(1) = response%opening
    end if
    energy%gap = response%gap
    energy%traction = response%traction
    energy%penalty = response%penalty_energy
    energy%stored = response%elastic_energy
    energy%dissipated = response%dissipated
    energy%active = abs(response%traction) > 0 .or. abs(response%slope) > 0
  end subroutine evaluate

  pure subroutine turn_to_dissipation(response, wt, fe)
    !! From fe = p N w_g j_g to dD/dg N w_g j_g. p vanishes only where dD/dg does.
    type(gap_response), intent(in) :: response           !! its slope of D includes w_g j_g
    real(wp), intent(in) :: wt                           !! w_g j_g [area]
    real(wp), contiguous, intent(inout) :: fe(:, :)

    if (response%dissipation_slope > 0) then
      fe = (response%dissipation_slope/(wt*response%traction))*fe
    else
      fe = 0
    end if
  end subroutine turn_to_dissipation

  pure subroutine prepare_point(ndm, dp, geo, status)
    !! Slave functions at the Gauss point and w_g j_g, measured in the reference configuration.
    integer, intent(in) :: ndm, dp
    type(element_geometry), intent(inout) :: geo   !! the slave facet alone
    integer, intent(out) :: status
    real(wp) :: shp(geo%nen), dshp(dp, geo%nen), d2shp(0, 0)
    real(wp) :: x(ndm), tau(ndm, dp), nrm(ndm), area

    call shape_functions(geo%degree(1:dp), geo%we, geo%ce, geo%xi(1:dp), 1, shp, dshp, d2shp, status)
    if (status /= ok) return
    call tangent_frame_at(geo%xe, shp, dshp, x, tau, nrm, area, status)
    if (status /= ok) return
    geo%table(1) = geo%wt*area
    geo%table(2:geo%nen + 1) = shp
  end subroutine prepare_point
end module gpts_element
