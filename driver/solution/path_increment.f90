module path_increment
  !! One increment of path following: control values u and load time t are both unknown, and a constraint chooses the
  !! next point of the equilibrium path,
  !!
  !!     R(u, t) = 0        g(u, t) = 0
  !!     arc length:    g = |x - x_n|^2 - s^2          over all control points (Riks; Crisfield's cylinder)
  !!     dissipation:   g = D(u) - D_n - delta         dissipated energy of the interfaces (Gutierrez 2004)
  !!
  !! Newton's correction is bordered, with one factorisation and two right-hand sides:
  !!
  !!     K dq_r = -r,  K dq_t = -dr/dt,  dt = -(g + c . dq_r)/(c_t + c . dq_t),  dq = dq_r + dt dq_t
  !!
  !! where dr/dt holds the rates of loads and of prescribed values. c = dg/dq is exact: the interface elements give the
  !! gradient of their dissipated energy.
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: wp
  use status_codes, only: ok, no_convergence, status_text
  use model_data, only: model_type
  use equilibrium, only: equilibrium_type, form_equilibrium
  use load_assembly, only: load_rates
  use interface_points, only: add_dissipation_gradient
  use newton, only: newton_settings, newton_report, newton_record, measure, ratio, note_active, changed_points, append
  use timers, only: timer_set, phase_factorise, phase_solve
  implicit none (type, external)
  private
  public :: path_constraint, solve_path_increment, path_arc, path_dissipation, nothing_left

  integer, parameter :: path_arc = 1, path_dissipation = 2
  character(*), parameter :: nothing_left = 'nothing is left to dissipate'
  real(wp), parameter :: constraint_tolerance = 1.0e-6_wp   !! relative; where on the path a step ends matters little

  type :: path_constraint
    integer :: kind = path_arc
    real(wp) :: length = 0                  !! s [length] or delta [energy]
    real(wp) :: most_time = huge(1.0_wp)    !! largest change of the load time in one correction
    real(wp) :: forward_time = 0            !! first change of the load time where the constraint cannot tell
    real(wp), allocatable :: along(:, :)    !! last increment of u, which says where forward is; none at the start
    real(wp) :: along_time = 0              !! last increment of t
  end type path_constraint

contains

  subroutine solve_path_increment(model, eq, settings, constraint, clock, report, status)
    !! From the committed state; on success eq%u and eq%time hold the next one, not committed.
    type(model_type), intent(inout) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(newton_settings), intent(in) :: settings
    type(path_constraint), intent(in) :: constraint
    type(timer_set), intent(inout) :: clock
    type(newton_report), intent(out) :: report
    integer, intent(out) :: status
    real(wp), allocatable :: rate(:, :), gradient(:, :), fext_rate(:, :)
    real(wp), allocatable :: rhs(:, :), dq(:, :), c(:)
    logical, allocatable :: was_active(:)
    real(wp) :: reference, size_r, g, scale_g, slope, dt, ct
    integer :: k, neq, fallbacks

    neq = eq%system%map%neq
    allocate (report%records(0), rhs(neq, 2), dq(neq, 2), c(neq))
    allocate (rate, gradient, fext_rate, mold=eq%u)
    report%fault = ''
    reference = 0
    eq%u = eq%un
    eq%time = eq%time_n
    call eq%system%map%expand(model, eq%time, eq%u)   ! at the start, what is prescribed there already
    call note_active(eq, was_active)
    do k = 1, settings%most_iterations + 1
      call eq%system%map%rates(model, eq%time, rate)
      call form_equilibrium(model, eq, .true., rate, any(abs(rate) > 0, 1), clock, status)
      if (status /= ok) exit
      call measure(eq, reference, size_r)
      report%residual = ratio(size_r, reference)
      if (.not. ieee_is_finite(size_r)) then
        status = no_convergence
        report%fault = 'the residual is not a number'
        exit
      end if
      call form_constraint(model, eq, constraint, g, scale_g, gradient)
      if (k > 1 .and. report%residual <= settings%residual_tolerance .and. eq%forced == 0 .and. &
        abs(g) <= constraint_tolerance*scale_g) then
        call append(report, newton_record(report%residual, 0.0_wp, 0.0_wp, eq%active, changed_points(eq, was_active), &
                                          .false.))
        return
      end if
      if (k > settings%most_iterations .or. goes_round(report)) then
        status = no_convergence
        exit
      end if

      call load_rates(model, eq%loads, eq%time, eq%u, fext_rate)
      rhs(:, 1) = -eq%r
      fext_rate = fext_rate - eq%f_moved
      call eq%system%map%reduce(fext_rate, rhs(:, 2))
      if (.not. any(abs(rhs(:, 2)) > 0)) then
        status = no_convergence
        report%fault = 'nothing moves at this time: path following needs loads or prescribed values whose time '// &
          'functions go on'
        exit
      end if
      fallbacks = eq%solver%statistics%fallbacks
      call clock%start(phase_factorise)
      call eq%solver%factorise(eq%system%matrix, status)
      call clock%stop(phase_factorise)
      if (status /= ok) then
        report%fault = 'the tangent: '//status_text(status)
        exit
      end if
      call clock%start(phase_solve)
      call eq%solver%solve(rhs, dq, status)
      call clock%stop(phase_solve)
      if (status /= ok) then
        report%fault = 'the tangent: '//status_text(status)
        exit
      end if
      report%iterations = report%iterations + 1

      if (k == 1 .and. constraint%kind == path_arc) then
        dt = first_arc(model, eq, constraint, dq(:, 2), rate)
      else
        if (.not. any(abs(gradient) > 0) .and. eq%energies%dissipated > eq%energies_n%dissipated) then
          status = no_convergence
          report%fault = nothing_left
          exit
        end if
        call eq%system%map%reduce(gradient, c)
        ct = sum(gradient*rate)
        slope = ct + dot_product(c, dq(:, 2))
        g = g + dot_product(c, dq(:, 1))
        dt = constraint%forward_time
        if (abs(g) < abs(slope)*constraint%most_time) then
          dt = -g/slope
        else if (k > 1 .or. abs(slope) > 0) then
          dt = sign(constraint%most_time, -g*slope)
        end if
      end if
      dq(:, 1) = dq(:, 1) + dt*dq(:, 2)
      call append(report, newton_record(report%residual, abs(dot_product(dq(:, 1), eq%r)), maxval(abs(dq(:, 1))), &
        eq%active, changed_points(eq, was_active), eq%solver%statistics%fallbacks > fallbacks))
      call note_active(eq, was_active)
      eq%time = eq%time + dt
      call eq%system%map%add_increment(dq(:, 1), eq%u)
      call eq%system%map%expand(model, eq%time, eq%u)
    end do
    if (len(report%fault) == 0) report%fault = eq%fault
    if (len(report%fault) == 0) report%fault = 'no convergence of path following within the allowed iterations'
  end subroutine solve_path_increment

  pure function goes_round(report) result(yes)
    !! Whether the iteration alternates between two states, as it does where points load and unload in turn: it would
    !! never end.
    type(newton_report), intent(in) :: report
    logical :: yes
    real(wp) :: now(2), before(2)
    integer :: n

    n = size(report%records)
    yes = n >= 8
    if (.not. yes) return
    now = report%records(n - 1:n)%residual
    before = report%records(n - 3:n - 2)%residual
    yes = all(abs(now - before) <= 1.0e-3_wp*before)
  end function goes_round

  subroutine form_constraint(model, eq, constraint, g, scale_g, gradient)
    !! g, what it is compared with, and dg/du.
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(path_constraint), intent(in) :: constraint
    real(wp), intent(out) :: g, scale_g
    real(wp), intent(out) :: gradient(:, :)    !! as eq%u
    integer :: i

    gradient = 0
    if (constraint%kind == path_arc) then
      scale_g = constraint%length**2
      g = sum((eq%u(1:model%ndm, 1:model%nn) - eq%un(1:model%ndm, 1:model%nn))**2) - scale_g
      gradient(1:model%ndm, 1:model%nn) = 2*(eq%u(1:model%ndm, 1:model%nn) - eq%un(1:model%ndm, 1:model%nn))
    else
      scale_g = constraint%length
      g = eq%energies%dissipated - eq%energies_n%dissipated - scale_g
      do i = 1, size(eq%interfaces)
        call add_dissipation_gradient(model, i, eq%interfaces(i), eq%u, eq%un, eq%time, eq%time - eq%time_n, gradient)
      end do
    end if
  end subroutine form_constraint

  function first_arc(model, eq, constraint, dq_t, rate) result(dt)
    !! The tangent of the path, as long as the arc, in the direction of the last increment; at the start, with
    !! growing time.
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: eq
    type(path_constraint), intent(in) :: constraint
    real(wp), intent(in) :: dq_t(:)       !! dq/dt of the path
    real(wp), intent(in) :: rate(:, :)    !! du/dt of prescribed values
    real(wp) :: dt
    real(wp), allocatable :: tangent(:, :)
    real(wp) :: forward

    tangent = rate
    call eq%system%map%spread_increment(dq_t, tangent)
    forward = 1
    if (allocated(constraint%along)) then
      forward = sum(tangent(1:model%ndm, 1:model%nn)*constraint%along(1:model%ndm, 1:model%nn))
      if (.not. abs(forward) > 0) forward = constraint%along_time
    end if
    dt = constraint%length/norm2(tangent(1:model%ndm, 1:model%nn))
    dt = sign(min(dt, constraint%most_time), forward)
  end function first_arc
end module path_increment
