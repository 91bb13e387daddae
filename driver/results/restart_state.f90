module restart_state
  !! restart.h5: all that decides the next step. Written to a draft and renamed into place, so that a run killed at any
  !! instant leaves a whole state. The matrix pattern, its ordering and the search tree are not stored but renewed, in
  !! the run that goes on and in the one that restarts alike: both continue with the same bits.
  use kinds, only: wp, i8
  use hdf5_store, only: hdf5_store_type
  use shortest_text, only: integer_text
  use equilibrium, only: equilibrium_type
  use interface_points, only: forget_search
  use step_control, only: step_control_type
  use path_control, only: path_control_type
  implicit none (type, external)
  private
  public :: write_restart, read_restart

contains

  subroutine write_restart(path, identity, step, eq, control, following, message)
    character(*), intent(in) :: path
    character(*), intent(in) :: identity                   !! deck text and parameters: a restart needs the same
    integer, intent(in) :: step
    type(equilibrium_type), intent(inout) :: eq            !! its pattern and search are renewed afterwards
    type(step_control_type), intent(in) :: control
    type(path_control_type), intent(in) :: following       !! of the equilibrium path
    character(:), allocatable, intent(out) :: message      !! what failed, unallocated when all is well
    type(hdf5_store_type) :: store
    character(:), allocatable :: group
    integer :: i

    call store%create_draft(path)
    call store%write_text('/identity', identity)
    call store%write('/steps', [step, control%level, merge(1, 0, control%has_rate), eq%active])
    call store%write('/times', [eq%time_n, control%time_before])
    call store%write('/energies', [eq%energies_n%elastic, eq%energies_n%dissipated, eq%energies_n%penalty, &
                                   eq%energies_n%work, eq%energies_n%penetration, eq%energies_n%largest_work])
    call store%write('/largest_force', [eq%largest_force])
    call store%write('/u', eq%un)
    call store%write('/f', eq%f_n)
    call store%write('/fext', eq%fext_n)
    call store%write('/rate', control%rate)
    call store%write('/history', eq%bulk%hist_n)
    call write_path(store, following)
    do i = 1, size(eq%interfaces)
      group = '/interface'//integer_text(i)
      call store%make_group(group)
      call store%write(group//'/facet', eq%interfaces(i)%facet_n)
      call store%write(group//'/held', merge(1, 0, eq%interfaces(i)%held_n))
      call store%write(group//'/xi', eq%interfaces(i)%xi_n)
      call store%write(group//'/history', eq%interfaces(i)%hist_n)
      call forget_search(eq%interfaces(i))
    end do
    call store%publish()
    eq%pattern_stands = .false.
    if (store%failed) message = store%message
  end subroutine write_restart

  subroutine read_restart(path, identity, step, eq, control, following, message)
    !! Into a started equilibrium and control.
    character(*), intent(in) :: path
    character(*), intent(in) :: identity
    integer, intent(out) :: step
    type(equilibrium_type), intent(inout) :: eq
    type(step_control_type), intent(inout) :: control
    type(path_control_type), intent(inout) :: following
    character(:), allocatable, intent(out) :: message
    type(hdf5_store_type) :: store
    character(:), allocatable :: group, stored
    integer, allocatable :: numbers(:), facet(:), held(:, :)
    real(wp), allocatable :: force(:)
    real(wp), allocatable :: times(:), energies(:), u(:, :), f(:, :), fext(:, :), rate(:, :), history(:), xi(:, :), &
      hist(:, :)
    integer :: i

    step = 0
    call store%open_to_read(path)
    call store%read_text('/identity', stored)
    if (store%failed) then
      message = store%message//'. There is no state to continue from: run without --restart'
      return
    end if
    if (stored /= identity) then
      call store%close()
      message = 'the deck or its parameters are not those of '//path// &
        '. Restart with the same ones, or run without --restart'
      return
    end if
    call store%read('/steps', numbers)
    call store%read('/times', times)
    call store%read('/energies', energies)
    call store%read('/largest_force', force)
    call store%read('/u', u)
    call store%read('/f', f)
    call store%read('/fext', fext)
    call store%read('/rate', rate)
    call store%read('/history', history)
    if (.not. store%failed) then
      if (any(shape(u) /= shape(eq%un)) .or. size(history) /= size(eq%bulk%hist)) then
        message = path//' belongs to another mesh. Run without --restart'
        return
      end if
      step = numbers(1)
      control%level = numbers(2)
      control%has_rate = numbers(3) == 1
      eq%active = numbers(4)
      eq%time_n = times(1)
      eq%time = times(1)
      control%time_before = times(2)
      control%rate = rate
      eq%energies_n%elastic = energies(1)
      eq%energies_n%dissipated = energies(2)
      eq%energies_n%penalty = energies(3)
      eq%energies_n%work = energies(4)
      eq%energies_n%penetration = energies(5)
      eq%energies_n%largest_work = energies(6)
      eq%energies = eq%energies_n
      eq%largest_force = force(1)
      eq%un = u
      eq%u = u
      eq%f_n = f
      eq%f = f
      eq%fext_n = fext
      eq%fext = fext
      eq%bulk%hist_n = history
      eq%bulk%hist = history
    end if
    call read_path(store, following)
    do i = 1, size(eq%interfaces)
      group = '/interface'//integer_text(i)
      call store%read(group//'/facet', facet)
      call store%read(group//'/held', held)
      call store%read(group//'/xi', xi)
      call store%read(group//'/history', hist)
      if (store%failed) exit
      associate (points => eq%interfaces(i))
        points%facet_n = facet
        points%facet = facet
        points%held_n = held == 1
        points%held = points%held_n
        points%xi_n = xi
        points%xi = xi
        points%hist_n = reshape(hist, shape(points%hist))
        points%hist = points%hist_n
        call forget_search(points)
      end associate
    end do
    if (store%failed) message = store%message
    call store%close()
    eq%pattern_stands = .false.
  end subroutine read_restart

  subroutine write_path(store, following)
    type(hdf5_store_type), intent(inout) :: store
    type(path_control_type), intent(in) :: following

    call store%write('/path_numbers', [following%asked, following%mode, following%mode_done, &
      following%wanted_iterations, merge(1, 0, following%has_sign), following%sign, following%negative, &
      following%limit_points, merge(1, 0, following%unstable), following%first_sign, following%first_negative, &
      following%times])
    call store%write('/path_sizes', [following%began, following%until, following%most_time, following%most_length, &
      following%time_step, following%arc, following%dissipation, following%along_time])
    if (allocated(following%along)) then
      call store%write('/path_along', following%along)
    else
      call store%write('/path_along', reshape([real(wp) ::], [0, 0]))
    end if
  end subroutine write_path

  subroutine read_path(store, following)
    type(hdf5_store_type), intent(inout) :: store
    type(path_control_type), intent(inout) :: following
    integer, allocatable :: n(:)
    real(wp), allocatable :: x(:), along(:, :)

    call store%read('/path_numbers', n)
    call store%read('/path_sizes', x)
    call store%read('/path_along', along)
    if (store%failed) return
    if (size(along) > 0) following%along = along
    following%asked = n(1)
    following%mode = n(2)
    following%mode_done = n(3)
    following%wanted_iterations = n(4)
    following%has_sign = n(5) == 1
    following%sign = n(6)
    following%negative = n(7)
    following%limit_points = n(8)
    following%unstable = n(9) == 1
    following%first_sign = n(10)
    following%first_negative = n(11)
    following%times = n(12)
    following%began = x(1)
    following%until = x(2)
    following%most_time = x(3)
    following%most_length = x(4)
    following%time_step = x(5)
    following%arc = x(6)
    following%dissipation = x(7)
    following%along_time = x(8)
  end subroutine read_path
end module restart_state
