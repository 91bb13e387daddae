module run_log
  !! What the terminal shows, repeated in log.txt. A progress line stands below it, on terminals only: output that goes
  !! to a file or a pipe has no control characters.
  use, intrinsic :: iso_fortran_env, only: output_unit
  use kinds, only: i8
  use byte_file, only: byte_file_type
  use file_system, only: is_terminal
  implicit none (type, external)
  private
  public :: log_type

  integer, parameter :: line_length = 79           !! of the progress line
  integer(i8), parameter :: pause = 100            !! least time between two progress lines [ms]

  type :: log_type
    logical :: failed = .false.
    character(:), allocatable :: message           !! what failed, allocated if failed
    logical, private :: terminal = .false.
    logical, private :: progress_shown = .false.
    logical, private :: quiet = .false.
    integer(i8), private :: last_progress = -1     !! [ms]
    type(byte_file_type), private :: file
  contains
    procedure :: begin
    procedure :: resume
    procedure :: put
    procedure :: note
    procedure :: progress
    procedure :: clear_progress
    procedure :: close => close_log
  end type log_type

contains

  subroutine begin(self, path)
    !! A new log file.
    class(log_type), intent(inout) :: self
    character(*), intent(in) :: path

    self%terminal = is_terminal(1)
    call self%file%create(path)
    call look(self)
  end subroutine begin

  subroutine resume(self, path)
    !! Go on at the end of a log file.
    class(log_type), intent(inout) :: self
    character(*), intent(in) :: path

    self%terminal = is_terminal(1)
    call self%file%extend(path)
    call look(self)
  end subroutine resume

  subroutine put(self, line)
    !! A line for the terminal and the file.
    class(log_type), intent(inout) :: self
    character(*), intent(in) :: line

    integer :: code

    call self%clear_progress()
    if (.not. self%quiet) then
      write (output_unit, '(a)', iostat=code) line
      if (code == 0) flush (output_unit, iostat=code)
      self%quiet = code /= 0
    end if
    call self%note(line)
  end subroutine put

  subroutine note(self, line)
    !! A line for the file alone.
    class(log_type), intent(inout) :: self
    character(*), intent(in) :: line

    call self%file%put_line(line)
    call self%file%flush()
    call look(self)
  end subroutine note

  subroutine progress(self, line)
    !! A line that the next one overwrites; nothing where the output is no terminal.
    class(log_type), intent(inout) :: self
    character(*), intent(in) :: line

    character(line_length) :: shown
    integer(i8) :: count, rate
    integer :: code

    if (.not. self%terminal .or. self%quiet) return
    call system_clock(count, rate)
    count = count/max(1_i8, rate/1000)
    if (self%last_progress >= 0 .and. count - self%last_progress < pause) return
    self%last_progress = count
    shown = line
    write (output_unit, '(2a)', advance='no', iostat=code) achar(13), shown
    if (code == 0) flush (output_unit, iostat=code)
    self%progress_shown = .true.
  end subroutine progress

  subroutine clear_progress(self)
    class(log_type), intent(inout) :: self

    integer :: code

    if (.not. self%progress_shown) return
    write (output_unit, '(3a)', advance='no', iostat=code) achar(13), repeat(' ', line_length), achar(13)
    if (code == 0) flush (output_unit, iostat=code)
    self%progress_shown = .false.
  end subroutine clear_progress

  subroutine close_log(self)
    class(log_type), intent(inout) :: self

    call self%clear_progress()
    call self%file%close()
    call look(self)
  end subroutine close_log

  subroutine look(self)
    class(log_type), intent(inout) :: self

    if (self%failed .or. .not. self%file%failed) return
    self%failed = .true.
    self%message = self%file%message
  end subroutine look
end module run_log
