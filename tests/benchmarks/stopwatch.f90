module stopwatch
  !! CPU time per call, the best of many batches:
  !!
  !!     call watch%begin()
  !!     do while (watch%goes_on())
  !!       ... the call ...
  !!     end do
  !!     ... watch%best ...
  !!
  !! A batch lasts at least a few milliseconds; what else the machine does can only make one slower.
  use, intrinsic :: iso_fortran_env, only: int64
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: stopwatch_type

  real(wp), parameter :: shortest_batch = 4.0e-3_wp   !! [s]

  type :: stopwatch_type
    real(wp) :: best = huge(1.0_wp)       !! CPU time of one call [s]
    real(wp) :: budget = 0.25_wp          !! CPU time spent in all [s]; at least one batch is finished
    integer(int64) :: calls = 0           !! so far
    integer(int64), private :: batch = 0, left = 0
    real(wp), private :: began = 0, batch_began = 0
  contains
    procedure :: begin
    procedure :: goes_on
  end type stopwatch_type

contains

  subroutine begin(self)
    class(stopwatch_type), intent(inout) :: self

    self%best = huge(1.0_wp)
    self%calls = 0
    self%batch = 0
    self%left = 0
    call cpu_time(self%began)
  end subroutine begin

  logical function goes_on(self)
    class(stopwatch_type), intent(inout) :: self
    real(wp) :: now, spent

    goes_on = .true.
    if (self%left > 0) then
      self%left = self%left - 1
      self%calls = self%calls + 1
      return
    end if
    call cpu_time(now)
    if (self%batch == 0) then
      self%batch = 1
    else
      spent = now - self%batch_began
      if (spent < shortest_batch) then
        self%batch = 2*self%batch
      else
        self%best = min(self%best, spent/real(self%batch, wp))
        goes_on = now - self%began < self%budget
        if (.not. goes_on) return
      end if
    end if
    self%left = self%batch - 1
    self%calls = self%calls + 1
    call cpu_time(self%batch_began)
  end function goes_on
end module stopwatch
