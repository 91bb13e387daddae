module gpts_element
  !! The interface element: one slave Gauss point with the functions of its slave facet (first) and of the master facet
  !! that it projects on. Formulation in `gpts_kernel`, law in `interface_law`. Lines of law data:
  !!
  !!     PENAlty eps                                                 contact stiffness
  !!     COHEsive PMAX p_max  GIC G_Ic  GMAX g_max | STIFfness K     bilinear cohesion, K = p_max / g_max
  !!     REVErsible                                                  unloading follows the envelope back
  !!
  !! History, with cohesion only: the largest opening h, and that at the start, which is g_u where the point is not
  !! bonded. Energy counts as dissipated from the start on: D(h) - D(h at the start).
  use kinds, only: wp
  use status_codes, only: ok, bad_extraction
  use user_element, only: element_type, element_geometry, element_state, element_energy, property_record, &
    task_prepare, task_tangent, task_dissipation_gradient
  use rational_basis, only: shape_functions
  use surface_frame, only: tangent_frame_at
  use interface_law, only: gap_law, gap_response, contact_law, cohesive_law, dissipated_energy, interface_damage, &
    has_cohesion
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
    procedure :: begin_history
    procedure :: is_bonded
    procedure :: output_names
    procedure :: output
  end type gpts_element_type

contains

  subroutine define(self, ndm, properties, fault, bad_record)
    class(gpts_element_type), intent(inout) :: self
    integer, intent(in) :: ndm
    type(property_record), intent(in) :: properties(:)
    character(:), allocatable, intent(out) :: fault
    integer, intent(out) :: bad_record
    real(wp) :: penalty
    integer :: i, cohesive, reversible, status

    self%ndm = ndm
    self%ndf = ndm
    self%symmetric = .true.
    penalty = 0
    cohesive = 0
    reversible = 0
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
      case ('cohe')
        if (cohesive > 0) fault = 'COHEsive is given twice: keep one of the lines'
        cohesive = i
      case ('reve')
        if (size(properties(i)%words) > 1 .or. size(properties(i)%values) > 0) fault = 'REVErsible takes no data'
        reversible = i
      case default
        fault = 'unknown interface law "'//properties(i)%words(1)//'". Known laws: PENAlty, COHEsive, REVErsible'
      end select
      if (allocated(fault)) return
    end do
    bad_record = 0
    if (.not. penalty > 0) then
      fault = 'the penalty is missing: add PENAlty=number'
    else if (cohesive > 0) then
      bad_record = cohesive
      call read_cohesion(properties(cohesive), penalty, self%law, fault)
      if (.not. allocated(fault)) bad_record = 0
    else if (reversible > 0) then
      bad_record = reversible
      fault = 'there is no cohesion that could be reversible: add COHEsive PMAX=p GIC=G GMAX=g, or leave it out'
    end if
    self%law%reversible = reversible > 0
  end subroutine define

  subroutine read_cohesion(line, penalty, law, fault)
    type(property_record), intent(in) :: line
    real(wp), intent(in) :: penalty
    type(gap_law), intent(inout) :: law
    character(:), allocatable, intent(out) :: fault
    character(*), parameter :: form = 'Write COHEsive PMAX=strength GIC=toughness and one of GMAX=opening, STIFfness=slope'
    character(9), parameter :: names(4) = [character(9) :: 'PMAX', 'GIC', 'GMAX', 'STIFfness']
    real(wp) :: given(4)                                 ! in the order of the names
    real(wp) :: g_max, g_u
    integer :: i, k, status

    given = -1
    if (size(line%words) - 1 /= size(line%values)) then
      fault = 'each item of COHEsive is a word and a number. '//form
      return
    end if
    do i = 1, size(line%values)
      k = findloc(['pmax', 'gic ', 'gmax', 'stif'], line%words(i + 1), 1)
      if (k == 0) then
        fault = 'unknown item "'//trim(line%words(i + 1))//'" of COHEsive. '//form
        return
      else if (.not. (line%values(i) > 0 .and. line%values(i) <= huge(1.0_wp))) then
        fault = trim(names(k))//' must be a positive number, not '//text_of(line%values(i))
        return
      else if (given(k) > 0) then
        fault = trim(names(k))//' is given twice. '//form
        return
      end if
      given(k) = line%values(i)
    end do
    do k = 1, 2
      if (given(k) > 0) cycle
      fault = trim(names(k))//' is missing. '//form
      return
    end do
    if (given(3) > 0 .eqv. given(4) > 0) then
      fault = trim(merge('both GMAX and STIFfness are given    ', 'neither GMAX nor STIFfness is given  ', given(3) > 0)) &
        //'. '//form
      return
    end if
    g_max = given(3)
    if (given(4) > 0) g_max = given(1)/given(4)
    g_u = 2*given(2)/given(1)
    call cohesive_law(penalty, given(1), given(2), g_max, law, status)
    if (status == ok) return
    fault = 'the strength is reached at the opening g_max = '//text_of(g_max)// &
      ', where the toughness is spent already (g_u = 2 GIC/PMAX = '//text_of(g_u)//'). '
    if (given(4) > 0) then
      fault = fault//'STIFfness must be larger than PMAX**2/(2 GIC) = '//text_of(given(1)/g_u)
    else
      fault = fault//'GMAX must be smaller than that'
    end if
  end subroutine read_cohesion

  function text_of(x) result(text)
    real(wp), intent(in) :: x
    character(:), allocatable :: text
    character(32) :: digits

    write (digits, '(es12.4)') x
    text = trim(adjustl(digits))
  end function text_of

  pure subroutine sizes(self, geo, ntable, nhist)
    class(gpts_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    integer, intent(out) :: ntable   !! weight w_g j_g, then the slave functions
    integer, intent(out) :: nhist    !! the largest opening and that at the start

    ntable = geo%nen + 1
    nhist = merge(2, 0, self%law%p_max > 0)
  end subroutine sizes

  pure subroutine begin_history(self, bonded, hist)
    class(gpts_element_type), intent(in) :: self
    logical, intent(in) :: bonded
    real(wp), intent(out) :: hist(:)

    hist = merge(0.0_wp, self%law%g_u, bonded)
  end subroutine begin_history

  pure function is_bonded(self, hist) result(bonded)
    class(gpts_element_type), intent(in) :: self
    real(wp), intent(in) :: hist(:)
    logical :: bonded

    bonded = .false.
    if (size(hist) > 0) bonded = has_cohesion(self%law, hist(1))
  end function is_bonded

  pure subroutine output_names(self, names)
    class(gpts_element_type), intent(in) :: self
    character(24), allocatable, intent(out) :: names(:)  !! with cohesion only

    if (self%law%p_max > 0) then
      names = [character(24) :: 'opening', 'damage']
    else
      allocate (names(0))
    end if
  end subroutine output_names

  pure subroutine output(self, geo, state, xi, values, status)
    !! The largest opening and the damage of the committed history.
    class(gpts_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    type(element_state), intent(in) :: state
    real(wp), intent(in) :: xi(:, :)           !! one column, not read
    real(wp), intent(out) :: values(:, :)      !! (2,1)
    integer, intent(out) :: status

    values(1, :) = state%hist_n(1)
    values(2, :) = interface_damage(self%law, state%hist_n(1))
    status = merge(ok, bad_extraction, geo%dp >= 0 .and. size(xi, 2) == 1)
  end subroutine output

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
    type(gap_law) :: law
    type(gap_response) :: response
    integer :: a, dp, ns
    logical :: want_tangent

    dp = self%ndm - 1
    if (task == task_prepare) then
      call prepare_point(self%ndm, dp, geo, status)
      return
    end if
    if (geo%master%nen == 0) then
      call evaluate_unpaired(self%law, task, geo%table(1), state, fe, ke, energy)
      status = ok
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
      law = self%law
      law%offset = m%offset
      opening = 0
      if (size(state%hist_n) > 0) opening = state%hist_n(1)
      if (any(m%held(1:dp))) then
        call gpts_corner_point(geo%table(2:ns + 1), x(:, 1:ns), shp, dshp, d2shp, x(:, ns + 1:), m%side, m%held(1:dp), &
                               law, opening, geo%table(1), want_tangent, response, fe, ke, status)
      else
        call gpts_point(geo%table(2:ns + 1), x(:, 1:ns), shp, dshp, d2shp, x(:, ns + 1:), m%side, law, opening, &
                        geo%table(1), want_tangent, response, fe, ke, status)
      end if
    end associate
    if (status /= ok) return
    if (task == task_dissipation_gradient) then
      call turn_to_dissipation(response, geo%table(1), fe)
    else if (size(state%hist) > 1) then
      state%hist(1) = response%opening
      state%hist(2) = state%hist_n(2)
    end if
    energy%gap = response%gap
    energy%traction = response%traction
    energy%penalty = response%penalty_energy
    energy%stored = response%elastic_energy
    if (size(state%hist_n) > 1) energy%dissipated = geo%table(1) &
      *(dissipated_energy(self%law, response%opening) - dissipated_energy(self%law, state%hist_n(2)))
    energy%active = abs(response%traction) > 0 .or. abs(response%slope) > 0
  end subroutine evaluate

  pure subroutine evaluate_unpaired(law, task, wt, state, fe, ke, energy)
    !! A point without master facet does nothing; what it dissipated stays.
    type(gap_law), intent(in) :: law
    integer, intent(in) :: task
    real(wp), intent(in) :: wt                           !! w_g j_g [area]
    type(element_state), intent(inout) :: state
    real(wp), contiguous, intent(inout) :: fe(:, :)
    real(wp), contiguous, intent(inout) :: ke(:, :, :, :)
    type(element_energy), intent(out) :: energy

    fe = 0
    if (task == task_tangent) ke = 0
    energy%active = .false.
    if (size(state%hist_n) < 2) return
    if (task /= task_dissipation_gradient) state%hist = state%hist_n
    energy%dissipated = wt*(dissipated_energy(law, state%hist_n(1)) - dissipated_energy(law, state%hist_n(2)))
  end subroutine evaluate_unpaired

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
