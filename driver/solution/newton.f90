module newton
  !! Newton's method for one increment: R(u, t_new) = 0 from the committed state.
  !!
  !! The start is either the last increment continued (where all time functions go on at the rate they had), or the
  !! committed state with the prescribed increments put into the first linear system: K_ff dq = -R_f - K_fp du_p.
  !! After a correction whose energy |dq . r| is small a residual-only pass decides: a factorisation is never spent on
  !! a state that has converged already. A correction at the rounding of the values themselves also ends the iteration:
  !! where stresses are small differences (nearly incompressible, high degree) the residual stays above any tolerance.
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: wp
  use status_codes, only: ok, no_convergence, singular_matrix, status_text
  use model_data, only: model_type
  use dof_map, only: is_prescribed
  use equilibrium, only: equilibrium_type, form_equilibrium, force_scale
  use timers, only: timer_set, phase_factorise, phase_solve
  implicit none (type, external)
  private
  public :: newton_settings, newton_record, newton_report, solve_increment
  public :: measure, ratio, note_active, changed_points, append

  type :: newton_settings
    real(wp) :: energy_tolerance = 1.0e-12_wp    !! of the correction, relative to the increment's work: when to look
    real(wp) :: residual_tolerance = 1.0e-9_wp   !! relative to the forces of the model: what decides
    integer :: most_iterations = 20
    integer :: line_search_from = 6              !! first iteration with a line search: only where Newton struggles
    real(wp) :: line_search_ratio = 0.8_wp       !! as in FEAP: accepted when |dq . r| falls below this share
  end type newton_settings

  real(wp), parameter :: rounding = 1.0e-12_wp             !! a relative correction that is only rounding
  real(wp), parameter :: left_over = 1.0e-3_wp            !! share of the run's largest forces that always counts
  real(wp), parameter :: settled_residual = 1.0e-6_wp     !! and the relative residual that it may leave

  type :: newton_record
    !! One iteration, for the log and for the test of quadratic convergence.
    real(wp) :: residual = 0       !! |r| relative to the reference force, before the correction
    real(wp) :: energy = 0         !! |dq . r|
    real(wp) :: correction = 0     !! max |dq|
    integer :: active = 0
    integer :: changed = 0         !! interface points that switched
    logical :: cholesky_failed = .false.
  end type newton_record

  type :: newton_report
    integer :: iterations = 0      !! linear solutions
    real(wp) :: residual = 0       !! at the end, relative
    type(newton_record), allocatable :: records(:)
    character(:), allocatable :: fault
  end type newton_report

contains

  subroutine solve_increment(model, eq, settings, t_new, rate, continue_rate, clock, report, status)
    type(model_type), intent(inout) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(newton_settings), intent(in) :: settings
    real(wp), intent(in) :: t_new
    real(wp), intent(in) :: rate(:, :)              !! last increment per unit of time (ndf,nn)
    logical, intent(in) :: continue_rate            !! start from it
    type(timer_set), intent(inout) :: clock
    type(newton_report), intent(out) :: report
    integer, intent(out) :: status
    real(wp), allocatable :: du(:, :), dq(:)
    logical, allocatable :: moves(:), was_active(:)
    real(wp) :: reference, energy, energy_reference, size_r
    integer :: k, fallbacks
    logical :: look, settled

    allocate (report%records(0), dq(eq%system%map%neq), du(model%ndf, model%columns()))
    report%fault = ''
    eq%time = t_new
    call eq%system%map%prescribed_increment(model, t_new, eq%un, du)
    if (continue_rate) then
      eq%u = eq%un + (t_new - eq%time_n)*rate
      call eq%system%map%expand(model, t_new, eq%u)
      allocate (moves(0))
    else
      eq%u = eq%un
      moves = any(abs(du) > 0, 1)
      if (.not. any(moves)) moves = [logical ::]
    end if
    reference = 0
    energy_reference = 0
    look = .false.
    settled = .false.
    call note_active(eq, was_active)

    do k = 1, settings%most_iterations + 1
      if (look .or. k > settings%most_iterations) then
        call form_equilibrium(model, eq, .false., du, moves, clock, status)
        if (status /= ok) exit
        call measure(eq, reference, size_r)
        report%residual = ratio(size_r, reference)
        if ((report%residual <= settings%residual_tolerance .or. settled) .and. eq%forced == 0) then
          call final_record(eq, report, was_active)
          return
        end if
        if (k > settings%most_iterations) then
          status = no_convergence
          exit
        end if
      end if
      call form_equilibrium(model, eq, .true., du, moves, clock, status)
      if (status /= ok) exit
      if (size(moves) > 0) then   ! prescribed increments that u does not hold yet, to first order
        eq%f = eq%f + eq%f_moved
        call eq%system%map%reduce(eq%f, eq%r)
      end if
      call measure(eq, reference, size_r)
      report%residual = ratio(size_r, reference)
      if (.not. ieee_is_finite(size_r)) then
        status = no_convergence
        report%fault = 'the residual is not a number'
        exit
      end if
      if (k > 1 .or. continue_rate) then
        ! nothing left to correct: the state stands without another solution
        if (k == 1 .and. report%residual > settings%residual_tolerance) then
          if (reference <= rounding*largest_stiffness_force(eq)) report%residual = size_r/largest_stiffness_force(eq)
        end if
        if (report%residual <= settings%residual_tolerance .and. size(moves) == 0 .and. eq%forced == 0) then
          call final_record(eq, report, was_active)
          return
        end if
      end if

      fallbacks = eq%solver%statistics%fallbacks
      call clock%start(phase_factorise)
      call eq%solver%factorise(eq%system%matrix, status)
      call clock%stop(phase_factorise)
      if (status /= ok) then
        report%fault = 'the tangent: '//status_text(status)
        if (status == singular_matrix) report%fault = report%fault// &
          '. Is a body free to move? Hold it by BOUNdary, or let it touch from the start'
        exit
      end if
      call clock%start(phase_solve)
      eq%r = -eq%r
      call eq%solver%solve(eq%r, dq, status)
      call clock%stop(phase_solve)
      if (status /= ok) then
        report%fault = 'the tangent: '//status_text(status)
        exit
      end if
      report%iterations = report%iterations + 1
      energy = abs(dot_product(dq, eq%r))
      energy_reference = max(energy_reference, energy, increment_work(eq, du))
      call append(report, newton_record(ratio(size_r, reference), energy, maxval(abs(dq)), eq%active, &
        changed_points(eq, was_active), eq%solver%statistics%fallbacks > fallbacks))
      call note_active(eq, was_active)

      if (size(moves) > 0) then
        eq%u = eq%u + du
        moves = [logical ::]
      end if
      if (k >= settings%line_search_from .and. eq%forced == 0) then
        call search_line(model, eq, settings, dq, du, moves, clock, status)
        if (status /= ok) exit
      else
        call eq%system%map%add_increment(dq, eq%u)
      end if
      settled = report%records(size(report%records))%changed == 0 .and. &
        eq%system%map%increment_size(dq) <= rounding*eq%system%map%value_size(eq%u) .and. report%residual <= settled_residual
      look = settled .or. energy <= settings%energy_tolerance*energy_reference
    end do
    if (len(report%fault) == 0) report%fault = eq%fault
    if (len(report%fault) == 0) report%fault = status_text(status)
    if (status == no_convergence .and. report%iterations >= settings%most_iterations) then
      report%fault = 'no convergence within the allowed iterations'
      if (any(report%records%cholesky_failed)) report%fault = report%fault// &
        '; the tangent is not positive definite there, as at a limit point, which PATH AUTO may pass'
    end if
  end subroutine solve_increment

  subroutine search_line(model, eq, settings, dq, du, moves, clock, status)
    !! Shorten a correction until the out-of-balance work along it has fallen, at most four times.
    type(model_type), intent(inout) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(newton_settings), intent(in) :: settings
    real(wp), intent(in) :: dq(:)
    real(wp), intent(in) :: du(:, :)
    logical, intent(in) :: moves(:)
    type(timer_set), intent(inout) :: clock
    integer, intent(out) :: status
    real(wp) :: work_before, s, s_next, work_after
    integer :: trial

    work_before = dot_product(dq, eq%r)
    s = 1
    call eq%system%map%add_increment(dq, eq%u)
    do trial = 1, 4
      call form_equilibrium(model, eq, .false., du, moves, clock, status)
      s_next = 0.5_wp*s
      if (status == ok) then
        work_after = -dot_product(dq, eq%r)
        if (abs(work_after) <= settings%line_search_ratio*abs(work_before)) return
        s_next = min(max(s*work_before/(work_before - work_after), 0.1_wp*s), 0.8_wp*s)  ! secant, safeguarded
        if (.not. s_next > 0) s_next = 0.5_wp*s
      end if
      call eq%system%map%add_increment((s_next - s)*dq, eq%u)
      s = s_next
    end do
    status = ok
  end subroutine search_line

  subroutine measure(eq, reference, size_r)
    !! |r|, and the forces that it is compared with: reactions and loads, the largest of the increment so far. Bodies
    !! that have come apart carry none, only the rounding of what they carried.
    type(equilibrium_type), intent(in) :: eq
    real(wp), intent(inout) :: reference
    real(wp), intent(out) :: size_r

    reference = max(reference, force_scale(eq), left_over*eq%largest_force)
    size_r = eq%system%map%residual_size(eq%r, reference)
  end subroutine measure

  pure function largest_stiffness_force(eq) result(force)
    !! Largest entry of the tangent times the largest control value: where all reactions are only rounding of this, bodies
    !! move freely (towards each other), and there is nothing else to compare a residual with.
    type(equilibrium_type), intent(in) :: eq
    real(wp) :: force

    force = maxval(abs(eq%system%matrix%values))*eq%system%map%value_size(eq%u)
  end function largest_stiffness_force

  pure function ratio(size_r, reference) result(relative)
    real(wp), intent(in) :: size_r, reference
    real(wp) :: relative

    relative = 0
    if (size_r > 0) relative = size_r/max(reference, tiny(1.0_wp)/epsilon(1.0_wp))
  end function ratio

  function increment_work(eq, du) result(work)
    !! Work of the reactions over the prescribed increment and of the loads over the step, for scale.
    type(equilibrium_type), intent(in) :: eq
    real(wp), intent(in) :: du(:, :)
    real(wp) :: work

    work = abs(sum(eq%f*du, mask=eq%system%map%eq == is_prescribed)) + abs(sum(eq%fext*(eq%u - eq%un)))
  end function increment_work

  subroutine note_active(eq, active)
    type(equilibrium_type), intent(in) :: eq
    logical, allocatable, intent(inout) :: active(:)
    integer :: i, n

    if (.not. allocated(active)) allocate (active(eq%point_count), source=.false.)
    n = 0
    do i = 1, size(eq%interfaces)
      active(n + 1:n + eq%interfaces(i)%np) = eq%interfaces(i)%active
      n = n + eq%interfaces(i)%np
    end do
  end subroutine note_active

  function changed_points(eq, active) result(changed)
    type(equilibrium_type), intent(in) :: eq
    logical, intent(in) :: active(:)
    integer :: changed, i, n

    changed = 0
    n = 0
    do i = 1, size(eq%interfaces)
      changed = changed + count(eq%interfaces(i)%active .neqv. active(n + 1:n + eq%interfaces(i)%np))
      n = n + eq%interfaces(i)%np
    end do
  end function changed_points

  subroutine final_record(eq, report, was_active)
    type(equilibrium_type), intent(in) :: eq
    type(newton_report), intent(inout) :: report
    logical, intent(in) :: was_active(:)

    call append(report, newton_record(report%residual, 0.0_wp, 0.0_wp, eq%active, changed_points(eq, was_active), .false.))
  end subroutine final_record

  subroutine append(report, record)
    type(newton_report), intent(inout) :: report
    type(newton_record), intent(in) :: record
    report%records = [report%records, record]
  end subroutine append
end module newton
