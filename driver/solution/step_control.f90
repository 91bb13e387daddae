module step_control
  !! From one asked-for time to the next: the increment is solved whole if Newton converges, else in halves, quarters,
  !! ... (cut-back); after an easy increment the next one is twice as long again (growth). What converged stays.
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type
  use equilibrium, only: equilibrium_type, commit, roll_back
  use newton, only: newton_settings, newton_report, solve_increment
  use interface_leaps, only: refuse_leaps
  use timers, only: timer_set
  implicit none (type, external)
  private
  public :: step_control_type, step_report, start_control, advance, note_rate

  integer, parameter :: easy = 8   !! an increment of so many iterations or fewer lets the next one grow

  type :: step_control_type
    integer :: most_halvings = 10
    logical :: continue_rate = .true.         !! start increments from the last one's rate where that applies
    integer :: level = 0                      !! present increments are 2**(-level) of the asked ones
    logical :: has_rate = .false.
    real(wp) :: time_before = 0               !! time before the last increment
    real(wp), allocatable :: rate(:, :)       !! last increment per unit of time (ndf,nn)
  end type step_control_type

  type :: step_report
    integer :: iterations = 0                 !! linear solutions, failed attempts included
    integer :: cutbacks = 0
    integer :: increments = 0
    type(newton_report) :: last               !! of the last attempt
  end type step_report

contains

  subroutine start_control(control, model)
    type(step_control_type), intent(inout) :: control
    type(model_type), intent(in) :: model

    allocate (control%rate(model%ndf, model%columns()), source=0.0_wp)
  end subroutine start_control

  subroutine advance(model, eq, settings, control, target_time, clock, report, status)
    !! Solve up to target_time. On failure the state is the last converged one, at or after the start.
    type(model_type), intent(inout) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(newton_settings), intent(in) :: settings
    type(step_control_type), intent(inout) :: control
    real(wp), intent(in) :: target_time
    type(timer_set), intent(inout) :: clock
    type(step_report), intent(out) :: report
    integer, intent(out) :: status
    real(wp) :: span, dt, t_new
    logical :: continued

    span = target_time - eq%time_n
    status = ok
    do while (eq%time_n < target_time)
      dt = span/2.0_wp**control%level
      t_new = eq%time_n + dt
      if (t_new > target_time - 0.5_wp*span/2.0_wp**control%most_halvings) t_new = target_time
      continued = control%continue_rate .and. rates_go_on(model, control, eq%time_n, t_new)
      call solve_increment(model, eq, settings, t_new, control%rate, continued, clock, report%last, status)
      report%iterations = report%iterations + report%last%iterations
      if (status /= ok .and. continued) then
        call roll_back(eq)
        call solve_increment(model, eq, settings, t_new, control%rate, .false., clock, report%last, status)
        report%iterations = report%iterations + report%last%iterations
      end if
      call refuse_leaps(model, eq, report%last, status)
      if (status == ok) then
        call note_rate(control, eq)
        call commit(eq)
        report%increments = report%increments + 1
        if (report%last%iterations <= easy) control%level = max(control%level - 1, 0)
      else
        call roll_back(eq)
        if (control%level >= control%most_halvings) return
        control%level = control%level + 1
        report%cutbacks = report%cutbacks + 1
      end if
    end do
  end subroutine advance

  subroutine note_rate(control, eq)
    !! The rate of an increment that is about to be committed.
    type(step_control_type), intent(inout) :: control
    type(equilibrium_type), intent(in) :: eq

    control%has_rate = abs(eq%time - eq%time_n) > 0
    if (.not. control%has_rate) return
    control%rate = (eq%u - eq%un)/(eq%time - eq%time_n)
    control%time_before = eq%time_n
  end subroutine note_rate

  pure function rates_go_on(model, control, time, t_new) result(yes)
    !! Whether every time function goes on at the rate of the last increment.
    type(model_type), intent(in) :: model
    type(step_control_type), intent(in) :: control
    real(wp), intent(in) :: time, t_new
    logical :: yes
    real(wp) :: before, now
    integer :: i

    yes = control%has_rate .and. size(model%props) > 0
    if (.not. yes) return
    do i = 1, size(model%props)
      associate (p => model%props(i))
        before = (p%at(time) - p%at(control%time_before))/(time - control%time_before)
        now = (p%at(t_new) - p%at(time))/(t_new - time)
        yes = abs(now - before) <= 1.0e-6_wp*max(abs(now), abs(before))
      end associate
      if (.not. yes) return
    end do
  end function rates_go_on
end module step_control
