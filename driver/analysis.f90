module analysis
  !! Carries out the solution commands of a deck: steps, their log lines, and what they leave on disk.
  use, intrinsic :: iso_c_binding, only: c_int
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type
  use solution_commands, only: solution_command, solution_program, do_dt, do_time, do_loop, do_next, do_solve, &
    do_tolerance, do_print, do_line_search, do_cutback, do_backend, do_predictor, do_path
  use equilibrium, only: equilibrium_type, start_equilibrium, form_equilibrium
  use newton, only: newton_settings, newton_report
  use step_control, only: step_control_type, step_report, start_control, advance
  use path_control, only: path_control_type, start_path, advance_path, path_off, by_time, by_dissipation
  use linear_solver, only: backend_name, ordering_name, backend_cholmod
  use restart_state, only: read_restart
  use result_frame, only: named_text_type
  use run_results, only: run_results_type
  use run_log, only: log_type
  use timers, only: timer_set, phase_names, phase_output
  implicit none (type, external)
  private
  public :: run_analysis, exit_done, exit_failed, exit_deck, exit_machine

  integer, parameter :: exit_done = 0, exit_failed = 1, exit_deck = 2, exit_machine = 3

  interface
    function interrupted() bind(c, name='bezel_interrupted') result(yes)
      import :: c_int
      integer(c_int) :: yes
    end function interrupted
    subroutine watch_interrupts() bind(c, name='bezel_watch_interrupts')
    end subroutine watch_interrupts
  end interface

  type :: run_state
    type(equilibrium_type) :: eq
    type(step_control_type) :: control
    type(path_control_type) :: path
    type(newton_settings) :: settings
    real(wp) :: dt = 1, target_time = 0
    real(wp) :: dt_began = 0             !! time when DT was set
    integer :: dt_count = 0              !! TIMEs since then: n*dt has no rounding to add up
    integer :: step = 0                  !! steps asked for so far
    integer :: resumed_step = 0          !! steps that a restart has behind it
    integer :: times = 0                 !! TIMEs met, those that a finished path skips too
    logical :: caught_up = .true.        !! a restart has come to the state that it goes on from
    integer :: steps_in_all = 0
    integer :: iterations = 0, cutbacks = 0
    logical :: print_iterations = .false.
  end type run_state

contains

  subroutine run_analysis(model, program, results, provenance, restart, log, clock, code)
    type(model_type), intent(inout), target :: model
    type(solution_program), intent(in) :: program
    type(run_results_type), intent(inout) :: results       !! with its folder begun
    type(named_text_type), intent(in) :: provenance(:)
    logical, intent(in) :: restart
    type(log_type), intent(inout) :: log
    type(timer_set), intent(inout) :: clock
    integer, intent(out) :: code                           !! exit status
    type(run_state), target :: run
    character(:), allocatable :: message
    integer :: status

    code = exit_done
    call watch_interrupts()
    call start_equilibrium(model, run%eq, clock, status)
    if (status /= ok) then
      call log%put('error: '//run%eq%fault)
      code = exit_deck
      return
    end if
    if (.not. run%eq%system%symmetric .and. &
      any(program%commands%what == do_backend .and. program%commands%count == backend_cholmod)) then
      call log%put('error: SOLVer CHOLmod needs a symmetric tangent, but follower loads or an element make it '// &
        'unsymmetric. Use SOLVer UMFPack or AUTO')
      code = exit_deck
      return
    end if
    if (run%eq%solver%indefinite .and. &
      any(program%commands%what == do_backend .and. program%commands%count == backend_cholmod)) then
      call log%put('error: SOLVer CHOLmod needs a positive definite tangent, but an end face that is free to warp has a '// &
        'multiplier. Use SOLVer UMFPack or AUTO')
      code = exit_deck
      return
    end if
    if (any(program%commands%what == do_path .and. program%commands%count == by_dissipation) .and. &
      .not. can_dissipate(run%eq)) then
      call log%put('error: PATH DISSipation needs something that dissipates, but no interface of the deck is cohesive. Use '// &
        'PATH ARClength, or PATH AUTO')
      code = exit_deck
      return
    end if
    call start_control(run%control, model)
    if (restart) then
      call read_restart(results%folder%file('restart.h5'), results%identity, run%resumed_step, run%eq, run%control, &
                        run%path, message)
      if (allocated(message)) then
        call log%put('error: '//message)
        code = exit_deck
        return
      end if
      run%caught_up = run%path%times == 0
      call results%resume(model, provenance, run%resumed_step, run%eq%time_n)
      call log%put('restart after step '//text(run%resumed_step)//', time '//number(run%eq%time_n))
    else
      call results%begin(model, provenance)
    end if
    call count_steps(program, run%steps_in_all)
    call log%put(text(run%eq%system%map%neq)//' equations, '//text(run%eq%point_count)//' interface points')
    call execute(model, program, run, results, log, clock, code)
    if (code == exit_done .and. restart .and. run%step <= run%resumed_step) then
      ! killed after the last step: its fields may be missing
      call restore_last_state(model, run, clock)
      call leave_last_state(model, run, results, clock, run%step)
    end if
    if (code == exit_done .and. run%step > run%resumed_step) call leave_last_state(model, run, results, clock, run%step)
    if (allocated(results%fault)) then
      call log%put('error: '//results%fault)
      code = exit_machine
    end if
    call log_shares(run, log, clock)
  end subroutine run_analysis

  pure function can_dissipate(eq) result(yes)
    !! Whether an interface has a history: the dissipated energy that path following controls is that of interfaces.
    type(equilibrium_type), intent(in) :: eq
    logical :: yes
    integer :: i

    yes = any([(size(eq%interfaces(i)%hist) > 0, i=1, size(eq%interfaces))])
  end function can_dissipate

  subroutine count_steps(program, steps)
    !! How often TIME comes up in all.
    type(solution_program), intent(in) :: program
    integer, intent(out) :: steps
    integer :: factor(0:size(program%commands)), depth, i

    steps = 0
    depth = 0
    factor(0) = 1
    do i = 1, size(program%commands)
      select case (program%commands(i)%what)
      case (do_loop)
        depth = depth + 1
        factor(depth) = factor(depth - 1)*program%commands(i)%count
      case (do_next)
        depth = depth - 1
      case (do_time)
        steps = steps + factor(depth)
      end select
    end do
  end subroutine count_steps

  subroutine execute(model, program, run, results, log, clock, code)
    !! The command list. A loop that holds TANG but no TIME is Newton's method: its count limits the iterations.
    type(model_type), intent(inout), target :: model
    type(solution_program), intent(in) :: program
    type(run_state), intent(inout), target :: run
    type(run_results_type), intent(inout) :: results
    type(log_type), intent(inout) :: log
    type(timer_set), intent(inout) :: clock
    integer, intent(inout) :: code
    integer :: left(size(program%commands)), at, most

    at = 1
    left = -1
    most = run%settings%most_iterations
    do while (at <= size(program%commands))
      associate (command => program%commands(at))
        select case (command%what)
        case (do_dt)
          run%dt = command%value(1)
          run%dt_began = run%target_time
          run%dt_count = 0
        case (do_path)
          call set_path(command, run, results)
          if (path_is_done(run)) call log%put('PATH: the time '//number(run%eq%time_n)//' is not before UNTIl='// &
            number(run%path%until)//': the TIMEs that follow do nothing')
        case (do_time)
          run%times = run%times + 1
          if (path_is_done(run)) then
            at = at + 1
            cycle
          end if
          run%dt_count = run%dt_count + 1
          run%target_time = run%dt_began + run%dt_count*run%dt
          run%step = run%step + 1
        case (do_tolerance)
          run%settings%energy_tolerance = command%value(1)
          if (command%value(2) > 0) run%settings%residual_tolerance = command%value(2)
        case (do_print)
          run%print_iterations = command%count == 1
        case (do_line_search)
          ! LINEsearch: always; LINEsearch,,0: never; without the command: only where Newton struggles
          run%settings%line_search_from = merge(2, huge(1), command%value(1) > 0)
          if (command%value(1) > 0) run%settings%line_search_ratio = command%value(1)
        case (do_cutback)
          run%control%most_halvings = command%count
        case (do_predictor)
          run%control%continue_rate = command%count == 1
        case (do_backend)
          run%eq%solver%backend = command%count
          run%eq%solver%ordering = command%other
        case (do_loop)
          if (left(at) < 0) left(at) = command%count
          if (left(at) == 0) then
            left(at) = -1
            at = command%other
          else if (is_newton_loop(program, at)) then
            run%settings%most_iterations = command%count
            call solve_step(model, run, results, log, clock, code)
            run%settings%most_iterations = most
            left(at) = -1
            at = command%other
          end if
        case (do_next)
          left(command%other) = left(command%other) - 1
          at = command%other - 1
        case (do_solve)
          call solve_step(model, run, results, log, clock, code)
        end select
      end associate
      if (code /= exit_done .or. allocated(results%fault)) return
      at = at + 1
    end do
  end subroutine execute

  subroutine set_path(command, run, results)
    !! PATH. A restart has read the state of the path: commands that lie behind it change nothing.
    type(solution_command), intent(in) :: command
    type(run_state), intent(inout) :: run
    type(run_results_type), intent(inout) :: results

    results%time_is_step = results%time_is_step .or. command%count /= path_off
    if (run%caught_up) then
      call start_path(run%path, command%count, command%value(1))
      run%path%most_length = command%value(2)
      run%path%until = command%value(3)
      run%path%wanted_iterations = command%other
      run%path%began = run%eq%time_n
    end if
    run%target_time = run%path%began  ! for TIMEs after PATH OFF
    run%dt_began = run%path%began
    run%dt_count = 0
  end subroutine set_path

  pure function path_is_done(run) result(yes)
    !! Whether path following has come to its last time; in a restart, not before its first step.
    type(run_state), intent(in) :: run
    logical :: yes

    yes = run%path%asked /= path_off .and. run%caught_up .and. run%eq%time_n >= run%path%until
  end function path_is_done

  pure function is_newton_loop(program, at) result(yes)
    type(solution_program), intent(in) :: program
    integer, intent(in) :: at
    logical :: yes

    associate (body => program%commands(at + 1:program%commands(at)%other - 1)%what)
      yes = any(body == do_solve) .and. .not. any(body == do_time .or. body == do_loop)
    end associate
  end function is_newton_loop

  subroutine solve_step(model, run, results, log, clock, code)
    !! Solve up to the time that TIME has set, and leave what the deck asks for.
    type(model_type), intent(inout), target :: model
    type(run_state), intent(inout), target :: run
    type(run_results_type), intent(inout) :: results
    type(log_type), intent(inout) :: log
    type(timer_set), intent(inout) :: clock
    integer, intent(inout) :: code
    type(step_report) :: report
    integer :: status
    real(wp) :: before
    logical :: advanced

    if (run%step == 0) then   ! TANG without TIME: a load at its present factor
      run%target_time = run%target_time + run%dt
      run%step = 1
      run%steps_in_all = 1
    end if
    if (.not. run%caught_up) then
      run%caught_up = run%times == run%path%times
      if (run%caught_up) run%step = run%resumed_step
      return
    end if
    if (run%step <= run%resumed_step) return
    before = run%eq%time_n
    if (run%path%asked /= path_off) then
      if (path_is_done(run)) return
      run%path%most_time = run%dt
      call advance_path(model, run%eq, run%settings, run%control, run%path, clock, report, status)
      advanced = status == ok
    else
      if (.not. run%target_time > run%eq%time_n) return
      call advance(model, run%eq, run%settings, run%control, run%target_time, clock, report, status)
      advanced = run%eq%time_n > before
    end if
    run%iterations = run%iterations + report%iterations
    run%cutbacks = run%cutbacks + report%cutbacks
    if (run%print_iterations) call log_iterations(report%last, log)
    call log_step(run, report, log, clock)
    if (status /= ok) then
      call log%put('step '//text(run%step)//' failed after '//text(report%cutbacks)//' cut-backs at time ' &
        //number(run%eq%time_n)//': '//report%last%fault)
      if (size(model%props) > 0) call log%put('a smaller DT, a smaller penalty, more elements or more Gauss points on the '// &
        'slave surface may help; PRINt shows the iterations')
      if (size(model%props) == 0) call log%put('without PROPortional everything acts at once, and halving a step does '// &
        'not help: add PROPortional 1, then lines of time and value')
      call restore_last_state(model, run, clock)
      call log%put('the last converged state (time '//number(run%eq%time_n)//') is on disk')
      code = exit_failed
      if (advanced) then
        call results%add_row(model, run%eq, run%step, report%iterations, report%cutbacks)
      else
        run%step = run%step - 1
      end if
      call leave_last_state(model, run, results, clock, run%step - merge(1, 0, advanced))
      return
    end if
    call clock%start(phase_output)
    call results%add_row(model, run%eq, run%step, report%iterations, report%cutbacks)
    if (results%wants_fields(model, run%step, run%eq%time_n)) call results%write_fields(model, run%eq, run%step)
    if (model%outputs%restart_every > 0) then
      run%path%times = run%times
      if (mod(run%step, model%outputs%restart_every) == 0) call results%write_state(run%eq, run%control, run%path, run%step)
    end if
    call clock%stop(phase_output)
    if (interrupted() /= 0) then
      call log%put('interrupted after step '//text(run%step)//'; --restart continues from here')
      code = exit_failed
      call leave_last_state(model, run, results, clock, run%step)
    end if
  end subroutine solve_step

  subroutine restore_last_state(model, run, clock)
    !! After a failed attempt: gaps, tractions and energies of the last converged state again, for the results.
    type(model_type), intent(inout), target :: model
    type(run_state), intent(inout), target :: run
    type(timer_set), intent(inout) :: clock
    real(wp) :: none(0, 0)
    integer :: status

    call form_equilibrium(model, run%eq, .false., none, [logical ::], clock, status)
  end subroutine restore_last_state

  subroutine leave_last_state(model, run, results, clock, whole_steps)
    !! Fields and restart state of the last converged state. A restart goes on after the steps that are whole.
    type(model_type), intent(inout), target :: model
    type(run_state), intent(inout), target :: run
    type(run_results_type), intent(inout) :: results
    type(timer_set), intent(inout) :: clock
    integer, intent(in) :: whole_steps

    call clock%start(phase_output)
    if (model%outputs%fields .and. results%last_field_step /= run%step) call results%write_fields(model, run%eq, run%step)
    run%path%times = run%times - (run%step - whole_steps)
    if (model%outputs%restart_every > 0) call results%write_state(run%eq, run%control, run%path, whole_steps)
    call clock%stop(phase_output)
  end subroutine leave_last_state

  subroutine log_step(run, report, log, clock)
    type(run_state), intent(in) :: run
    type(step_report), intent(in) :: report
    type(log_type), intent(inout) :: log
    type(timer_set), intent(in) :: clock
    character(200) :: line
    real(wp) :: seconds, remaining

    write (line, '(a,i6,a,es13.6,a,i4,a,i3,a,i6,a,es9.2)') 'step', run%step, '  time', run%eq%time_n, '  iterations', &
      report%iterations, '  cut-backs', report%cutbacks, '  active', run%eq%active, '  residual', report%last%residual
    if (run%path%asked /= path_off) then
      select case (run%path%mode_done)
      case (by_time);        line = trim(line)//'  by time'
      case (by_dissipation); line = trim(line)//'  by dissipation'
      case default;          line = trim(line)//'  by arc length'
      end select
      if (run%path%passed_limit) line = trim(line)//', limit point passed'
    end if
    call log%put(trim(line))
    seconds = clock%elapsed()
    remaining = seconds*real(run%steps_in_all - run%step, wp)/max(1, run%step - run%resumed_step)
    write (line, '(a,i0,a,i0,a,i0,a,i0,a,i0,a)') 'step ', run%step, ' of ', run%steps_in_all, ', iterations ', &
      run%iterations, ', active ', run%eq%active, ', about ', nint(remaining), ' s left'
    call log%progress(trim(line))
  end subroutine log_step

  subroutine log_iterations(report, log)
    !! A line for each Newton iteration of the last increment.
    type(newton_report), intent(in) :: report
    type(log_type), intent(inout) :: log
    character(160) :: line
    integer :: k

    if (.not. allocated(report%records)) return
    do k = 1, size(report%records)
      associate (r => report%records(k))
        write (line, '(a,i3,a,es10.3,a,es10.3,a,es10.3,a,i6,a,i4,a)') '  iteration', k, '  residual', r%residual, &
          '  energy', r%energy, '  correction', r%correction, '  active', r%active, '  switched', r%changed, &
          merge('  not positive definite', '                       ', r%cholesky_failed)
        call log%put(trim(line))
      end associate
    end do
  end subroutine log_iterations

  subroutine log_shares(run, log, clock)
    !! Where the time went.
    type(run_state), intent(in) :: run
    type(log_type), intent(inout) :: log
    type(timer_set), intent(in) :: clock
    character(120) :: line
    real(wp) :: total, known
    integer :: i

    total = max(clock%elapsed(), tiny(1.0_wp))
    associate (s => run%eq%solver%statistics)
      call log%put('solver '//trim(backend_name(s%backend))//', ordering '//trim(ordering_name(s%ordering))//', ' &
        //text(s%factorisations)//' factorisations ('//text(s%fallbacks)//' not positive definite), ' &
        //text(run%eq%patterns)//' patterns')
    end associate
    write (line, '(a,f10.3,a,i0,a,i0,a)') 'total', total, ' s, ', run%iterations, ' iterations, ', run%cutbacks, &
      ' cut-backs'
    call log%put(trim(line))
    if (run%eq%leaps > 0) call log%put(text(run%eq%leaps)//' increments were cut back because slave points moved past the '// &
      'search distance; a larger REACh avoids that')
    known = 0
    do i = 1, size(phase_names)
      if (clock%calls(i) == 0) cycle
      known = known + clock%seconds(i)
      write (line, '(2x,a,f10.3,a,f6.1,a,i0,a)') phase_names(i), clock%seconds(i), ' s', &
        100*clock%seconds(i)/total, ' %  ', clock%calls(i), ' calls'
      call log%put(trim(line))
    end do
    write (line, '(2x,a,f10.3,a,f6.1,a)') 'other       ', total - known, ' s', 100*(total - known)/total, ' %'
    call log%put(trim(line))
  end subroutine log_shares

  pure function text(n) result(string)
    integer, intent(in) :: n
    character(:), allocatable :: string
    character(12) :: buffer

    write (buffer, '(i0)') n
    string = trim(buffer)
  end function text

  pure function number(x) result(string)
    real(wp), intent(in) :: x
    character(:), allocatable :: string
    character(24) :: buffer

    write (buffer, '(g0.9)') x
    string = trim(adjustl(buffer))
  end function number
end module analysis
