module path_control
  !! Path following: one call, one point of the equilibrium path. The increment is prescribed as a change of the load
  !! time, as dissipated energy or as arc length; PATH AUTO chooses and changes between them by itself:
  !!
  !! - by time as long as nothing is in the way: the cheapest, and points come where the deck wants them;
  !! - by dissipation once that takes a share of the energy: it grows on the true path, also where load and
  !!   displacement both go back (snap-back);
  !! - by arc length where neither works, as beyond a limit point without dissipation (snap-through).
  !!
  !! An increment by time that converged far away, over a limit point, is known by its energy: work, stored and
  !! dissipated energy do not balance, however short the increment; it is rejected. Increments are halved when Newton
  !! fails, and lengthened when it is quick. Limit points are counted by the inertia or the determinant of the tangent.
  use kinds, only: wp
  use status_codes, only: ok, no_convergence
  use model_data, only: model_type
  use equilibrium, only: equilibrium_type, commit, roll_back, work_of_increment
  use newton, only: newton_settings, solve_increment
  use path_increment, only: path_constraint, solve_path_increment, path_arc, path_dissipation, &
    nothing_left
  use interface_leaps, only: refuse_leaps
  use linear_solver, only: inertia_unknown
  use step_control, only: step_control_type, step_report, note_rate
  use timers, only: timer_set
  implicit none (type, external)
  private
  public :: path_control_type, start_path, advance_path, path_off, path_auto, by_time, by_dissipation, by_arc

  integer, parameter :: path_off = 0, path_auto = 1            !! what the deck asks for, or one of the following
  integer, parameter :: by_time = 2, by_dissipation = 3, by_arc = 4

  real(wp), parameter :: dissipating = 0.1_wp   !! share of the energy from which dissipation controls
  real(wp), parameter :: imbalance = 0.2_wp     !! share of an increment's energy that a smooth one cannot miss
  real(wp), parameter :: negligible = 1.0e-3_wp !! share of all energy so far that may be missed
  real(wp), parameter :: spent = 1.0e-5_wp      !! share of all energy so far that need not be dissipated
  integer, parameter :: most_halvings = 4       !! of an increment before the next kind of control is tried

  type :: path_control_type
    integer :: asked = path_off
    integer :: mode = by_time               !! of the next increment
    integer :: mode_done = by_time          !! of the last one
    real(wp) :: began = 0                   !! load time when this control was set
    integer :: times = 0                    !! TIMEs of the deck behind the committed state, for a restart
    integer :: wanted_iterations = 6        !! increments grow below, shrink above
    real(wp) :: until = huge(1.0_wp)        !! the path ends where the load time first reaches this
    real(wp) :: most_time = 1               !! largest change of the load time in an increment
    real(wp) :: most_length = huge(1.0_wp)  !! largest arc or dissipated energy in an increment
    real(wp) :: time_step = 0               !! size of the next increment by each kind of control, 0: as most_time; not known yet
    real(wp) :: arc = 0                     !! [length]
    real(wp) :: dissipation = 0             !! [energy]
    logical :: has_sign = .false.           !! the two that follow are those of a converged state
    integer :: sign = 0                     !! of the determinant
    integer :: negative = inertia_unknown   !! negative pivots
    integer :: limit_points = 0             !! passed so far
    logical :: passed_limit = .false.       !! in the last increment
    logical :: nothing_left = .false.       !! in this increment, by dissipation
    logical :: unstable = .false.           !! the last tangent has another inertia than the first
    integer :: first_sign = 0, first_negative = inertia_unknown
    real(wp), allocatable :: along(:, :)    !! last increment of the control values
    real(wp) :: along_time = 0
  end type path_control_type

contains

  subroutine start_path(path, asked, length)
    !! Begin to follow the path from the present state.
    type(path_control_type), intent(inout) :: path
    integer, intent(in) :: asked
    real(wp), intent(in) :: length        !! first arc or dissipated energy; 0: what the first increment by time gives

    if (allocated(path%along)) deallocate (path%along)
    path%has_sign = .false.
    path%unstable = .false.
    path%asked = asked
    path%time_step = 0
    path%mode = by_time
    if (length > 0 .and. asked == by_arc) path%arc = length
    if (length > 0 .and. asked /= by_arc) path%dissipation = length
    if (length > 0 .and. asked /= path_auto) path%mode = asked
  end subroutine start_path

  subroutine advance_path(model, eq, settings, control, path, clock, report, status)
    !! Solve for the next point and commit it. On failure the state is the last one.
    type(model_type), intent(inout) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(newton_settings), intent(in) :: settings
    type(step_control_type), intent(inout) :: control
    type(path_control_type), intent(inout) :: path
    type(timer_set), intent(inout) :: clock
    type(step_report), intent(out) :: report
    integer, intent(out) :: status
    integer :: halvings
    logical :: smooth, ends

    halvings = 0
    path%nothing_left = .false.
    if (.not. path%time_step > 0) path%time_step = path%most_time
    path%time_step = min(path%time_step, path%most_time)
    if (path%mode /= by_time .and. starts_loaded(model, eq)) path%mode = by_time
    do
      call solve_by_mode(model, eq, settings, control, path, clock, report, status)
      report%iterations = report%iterations + report%last%iterations
      smooth = .true.
      if (status == ok) call judge(model, eq, path, smooth)
      if (status == ok .and. .not. smooth) then
        status = no_convergence
        report%last%fault = 'the increment jumped over a limit point'
      end if
      call refuse_leaps(model, eq, report%last, status)
      if (status == ok) exit
      call roll_back(eq)
      call eq%system%map%follow(eq%u)
      report%cutbacks = report%cutbacks + 1
      halvings = halvings + 1
      call shorten(path)
      ends = report%last%fault == nothing_left .and. hardly_dissipates(path, eq)
      if (report%last%fault == nothing_left .and. .not. ends) cycle
      if (halvings < most_halvings .and. .not. ends) cycle
      halvings = 0
      if (.not. other_control(path, eq, ends)) return
    end do
    call accept(model, eq, control, path, report)
  end subroutine advance_path

  pure function starts_loaded(model, eq) result(yes)
    !! Whether the run begins here with loads or prescribed values that are not zero: that state is found by time.
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: eq
    logical :: yes
    integer :: i

    yes = .not. abs(eq%time_n) > 0 .and. any([(abs(model%props(i)%at(0.0_wp)) > 0, i=1, size(model%props))])
  end function starts_loaded

  subroutine solve_by_mode(model, eq, settings, control, path, clock, report, status)
    type(model_type), intent(inout) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(newton_settings), intent(in) :: settings
    type(step_control_type), intent(in) :: control
    type(path_control_type), intent(in) :: path
    type(timer_set), intent(inout) :: clock
    type(step_report), intent(inout) :: report
    integer, intent(out) :: status
    type(path_constraint) :: constraint
    real(wp) :: t_new

    if (path%mode == by_time) then
      t_new = eq%time_n + path%time_step
      if (t_new > path%until - 1.0e-6_wp*path%time_step) t_new = path%until   ! no last step of rounding
      call solve_increment(model, eq, settings, t_new, control%rate, .false., clock, report%last, status)
      return
    end if
    constraint%kind = merge(path_arc, path_dissipation, path%mode == by_arc)
    constraint%length = merge(path%arc, path%dissipation, path%mode == by_arc)
    constraint%most_time = path%most_time
    constraint%forward_time = path%most_time
    if (allocated(path%along)) then
      constraint%along = path%along
      constraint%along_time = path%along_time
    end if
    call solve_path_increment(model, eq, settings, constraint, clock, report%last, status)
  end subroutine solve_by_mode

  subroutine judge(model, eq, path, smooth)
    !! Whether a converged increment lies on the path: its energies balance, and an arc goes on, not back to where it came
    !! from nor, once interfaces open, unloading without any dissipation.
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(in) :: eq
    type(path_control_type), intent(in) :: path
    logical, intent(out) :: smooth
    real(wp) :: work, stored, dissipated, scale

    call increments(eq, work, stored, dissipated)
    scale = max(abs(work), abs(stored), abs(dissipated))
    smooth = abs(work - stored - dissipated) <= max(imbalance*scale, negligible*energy_so_far(eq))
    if (path%mode == by_arc .and. allocated(path%along) .and. abs(dissipated) <= dissipating*scale) &
      smooth = smooth .and. sum((eq%u(1:model%ndm, 1:model%nn) - eq%un(1:model%ndm, 1:model%nn)) &
                                *path%along(1:model%ndm, 1:model%nn)) > 0
    if (path%mode == by_arc .and. eq%energies_n%dissipated > 0 .and. work < 0) &
      smooth = smooth .and. dissipated > negligible*abs(work)   ! else it goes back, unloading
  end subroutine judge

  pure function hardly_dissipates(path, eq) result(yes)
    type(path_control_type), intent(in) :: path
    type(equilibrium_type), intent(in) :: eq
    logical :: yes

    yes = path%mode == by_dissipation .and. path%dissipation <= spent*energy_so_far(eq)
  end function hardly_dissipates

  pure function energy_so_far(eq) result(energy)
    type(equilibrium_type), intent(in) :: eq
    real(wp) :: energy

    energy = max(abs(eq%energies_n%work), abs(eq%energies_n%elastic), eq%energies_n%dissipated)
  end function energy_so_far

  subroutine increments(eq, work, stored, dissipated)
    !! Of the energies since the committed state.
    type(equilibrium_type), intent(in) :: eq
    real(wp), intent(out) :: work, stored, dissipated

    work = work_of_increment(eq)
    stored = eq%energies%elastic + eq%energies%penalty - eq%energies_n%elastic - eq%energies_n%penalty
    dissipated = eq%energies%dissipated - eq%energies_n%dissipated
  end subroutine increments

  subroutine shorten(path)
    type(path_control_type), intent(inout) :: path

    select case (path%mode)
    case (by_time);        path%time_step = path%time_step/2
    case (by_dissipation); path%dissipation = path%dissipation/4
    case (by_arc);         path%arc = path%arc/2
    end select
  end subroutine shorten

  function other_control(path, eq, ends) result(found)
    !! The next kind of control to try for this increment: dissipation after time, and after it time again if what is
    !! left to dissipate is negligible; then arc length, last once more time.
    type(path_control_type), intent(inout) :: path
    type(equilibrium_type), intent(in) :: eq
    logical, intent(in) :: ends          !! nothing is left to dissipate
    logical :: found

    if (path%asked == by_dissipation .and. path%mode == by_time .and. .not. path%nothing_left) then
      path%mode = by_dissipation       ! nothing has dissipated yet: begin with an estimate
      path%dissipation = min(1.0e-2_wp*eq%energies_n%elastic, path%most_length)
      path%nothing_left = .true.       ! and only once
      found = path%dissipation > 0
      return
    end if
    found = path%asked == path_auto .and. .not. (path%mode == by_arc .and. path%nothing_left)
    if (.not. found) return
    if (path%mode == by_arc) then   ! a point that broke while everything else unloaded: the path turns forward
      found = eq%energies_n%dissipated > 0
      path%mode = by_time
      path%time_step = path%most_time
      path%nothing_left = .true.
      return
    end if
    if (path%mode == by_time .and. size(eq%interfaces) > 0 .and. .not. path%nothing_left) then
      path%mode = by_dissipation
      if (.not. path%dissipation > 0) path%dissipation = 1.0e-2_wp*max(eq%energies_n%elastic, eq%energies_n%dissipated)
      path%dissipation = min(path%dissipation, path%most_length)
      if (path%dissipation > 0) return
    else if (ends) then
      path%mode = by_time
      path%time_step = path%most_time
      path%nothing_left = .true.
      return
    end if
    path%mode = by_arc
    found = allocated(path%along)
    if (found) path%arc = norm2(path%along)/2
  end function other_control

  subroutine accept(model, eq, control, path, report)
    !! Commit, and choose the next increment.
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(step_control_type), intent(inout) :: control
    type(path_control_type), intent(inout) :: path
    type(step_report), intent(inout) :: report
    real(wp) :: work, stored, dissipated, growth, arc
    logical :: dissipates

    call increments(eq, work, stored, dissipated)
    path%along = eq%u - eq%un
    path%along_time = eq%time - eq%time_n
    path%mode_done = path%mode
    arc = norm2(path%along(1:model%ndm, 1:model%nn))
    call note_limit_point(path, eq)
    call note_rate(control, eq)
    call commit(eq)
    report%increments = 1

    growth = sqrt(real(path%wanted_iterations, wp)/max(1, report%last%iterations))
    growth = max(0.5_wp, min(2.0_wp, growth))
    if (abs(path%along_time) > 0) growth = min(growth, max(1.0_wp, path%most_time/abs(path%along_time)))
    if (abs(path%along_time) > path%most_time) growth = path%most_time/abs(path%along_time)
    if (path%mode == by_time) path%time_step = min(path%most_time, 2*path%time_step, growth*abs(path%along_time))
    if (arc > 0) path%arc = min(growth*arc, path%most_length)
    if (dissipated > 0) path%dissipation = min(growth*dissipated, path%most_length)

    select case (path%asked)
    case (path_auto)
      dissipates = dissipated > dissipating*max(abs(work), abs(stored), abs(dissipated)) .or. &
        (dissipated > 0 .and. path%along_time < 0)   ! time cannot go on where it went back
      if (dissipates) then
        path%mode = by_dissipation
      else if (path%mode == by_arc .and. (path%unstable .or. path%along_time < 0)) then
        continue
      else
        if (path%mode /= by_time) path%time_step = min(path%most_time, max(path%time_step, abs(path%along_time)))
        path%mode = by_time
      end if
    case (by_arc)
      if (path%arc > 0) path%mode = by_arc
    case (by_dissipation)
      if (dissipated > 0) path%mode = by_dissipation
    end select
  end subroutine accept

  subroutine note_limit_point(path, eq)
    !! A change of the inertia, or of the determinant's sign where the inertia is not known, between two increments.
    type(path_control_type), intent(inout) :: path
    type(equilibrium_type), intent(in) :: eq

    associate (now => eq%solver%statistics)
      path%passed_limit = path%has_sign .and. differs(path%sign, path%negative, now%determinant_sign, now%negative_pivots)
      if (path%passed_limit) path%limit_points = path%limit_points + 1
      if (.not. path%has_sign) then
        path%first_sign = now%determinant_sign
        path%first_negative = now%negative_pivots
      end if
      path%unstable = differs(path%first_sign, path%first_negative, now%determinant_sign, now%negative_pivots)
      path%sign = now%determinant_sign
      path%negative = now%negative_pivots
      path%has_sign = .true.
    end associate
  end subroutine note_limit_point

  pure function differs(sign_a, negative_a, sign_b, negative_b) result(yes)
    integer, intent(in) :: sign_a, negative_a, sign_b, negative_b
    logical :: yes

    yes = sign_a /= sign_b
    if (negative_a /= inertia_unknown .and. negative_b /= inertia_unknown) yes = negative_a /= negative_b
  end function differs
end module path_control
