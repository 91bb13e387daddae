module timers
  !! Wall-clock shares of a run: a fixed list of phases, each with its time and its number of calls.
  use kinds, only: wp, i8
  implicit none (type, external)
  private
  public :: timer_set, phase_names
  public :: phase_input, phase_prepare, phase_search, phase_contact, phase_elements, phase_loads, phase_pattern, &
    phase_analyse, phase_factorise, phase_solve, phase_output

  integer, parameter :: phase_input = 1, phase_prepare = 2, phase_search = 3, phase_contact = 4, phase_elements = 5, &
    phase_loads = 6, phase_pattern = 7, phase_analyse = 8, phase_factorise = 9, phase_solve = 10, phase_output = 11
  character(12), parameter :: phase_names(11) = [character(12) :: 'input', 'prepare', 'search', 'contact', &
    'elements', 'loads', 'pattern', 'analyse', 'factorise', 'solve', 'output']

  type :: timer_set
    real(wp) :: seconds(size(phase_names)) = 0      !! [s]
    integer(i8) :: calls(size(phase_names)) = 0
    integer(i8), private :: begun(size(phase_names)) = 0
    integer(i8), private :: start_count = 0
  contains
    procedure :: reset
    procedure :: start
    procedure :: stop => stop_phase
    procedure :: elapsed
  end type timer_set

contains

  subroutine reset(self)
    class(timer_set), intent(inout) :: self
    self%seconds = 0
    self%calls = 0
    call system_clock(self%start_count)
  end subroutine reset

  subroutine start(self, phase)
    class(timer_set), intent(inout) :: self
    integer, intent(in) :: phase
    call system_clock(self%begun(phase))
  end subroutine start

  subroutine stop_phase(self, phase)
    class(timer_set), intent(inout) :: self
    integer, intent(in) :: phase
    integer(i8) :: now, rate

    call system_clock(now, rate)
    self%seconds(phase) = self%seconds(phase) + real(now - self%begun(phase), wp)/real(rate, wp)
    self%calls(phase) = self%calls(phase) + 1
  end subroutine stop_phase

  function elapsed(self) result(seconds)
    class(timer_set), intent(in) :: self
    real(wp) :: seconds  !! since reset [s]
    integer(i8) :: now, rate

    call system_clock(now, rate)
    seconds = real(now - self%start_count, wp)/real(rate, wp)
  end function elapsed
end module timers
