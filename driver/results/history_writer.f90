module history_writer
  !! history.csv: one row per converged step, handed to the system at once, so that a run killed at any instant leaves
  !! whole rows but perhaps the last. Numbers read back to the same bits; a run that goes on after a restart leaves the
  !! same bytes as one that was never stopped.
  use kinds, only: wp, i8
  use byte_file, only: byte_file_type
  use file_system, only: cut_file, file_exists, read_text_file, system_error
  use shortest_text, only: real_text, integer_text
  implicit none (type, external)
  private
  public :: history_writer_type

  character(*), parameter :: first_columns = 'step,time,iterations,cutbacks,active'

  type :: history_writer_type
    logical :: failed = .false.
    character(:), allocatable :: message    !! what failed, allocated if failed
    integer :: last_step = -1               !! step of the last row, -1: there is none
    integer, private :: columns = 0         !! after the first five
    type(byte_file_type), private :: file
  contains
    procedure :: begin
    procedure :: resume
    procedure :: add_row
    procedure :: close => close_history
    procedure, private :: complain
  end type history_writer_type

contains

  subroutine begin(self, path, labels)
    !! A new history with its header.
    class(history_writer_type), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: labels(:)    !! of the columns after the first five

    self%failed = .false.
    self%last_step = -1
    self%columns = size(labels)
    call self%file%create(path)
    call self%file%put_line(header(labels))
    call self%file%flush()
    if (self%file%failed) call self%complain(self%file%message)
  end subroutine begin

  subroutine resume(self, path, labels, step)
    !! Go on after the row of a step: later rows are dropped.
    class(history_writer_type), intent(inout) :: self
    character(*), intent(in) :: path
    character(*), intent(in) :: labels(:)    !! as at the beginning
    integer, intent(in) :: step              !! of the last row to keep, 0: none need be there

    character(:), allocatable :: text
    integer :: from, next, number, code
    logical :: failed

    self%failed = .false.
    self%last_step = -1
    self%columns = size(labels)
    failed = .not. file_exists(path)
    if (.not. failed) call read_text_file(path, text, failed)
    if (failed) then
      call self%complain('cannot read '//path//'; without it the run has to start anew')
      return
    end if
    next = index(text, new_line('a'))
    if (next == 0) then
      call self%complain(path//' has no header; the run has to start anew')
      return
    else if (text(:next-1) /= header(labels)) then
      call self%complain(path//' has other columns than the deck asks for; the run has to start anew')
      return
    end if
    from = next + 1
    do while (self%last_step < step)
      next = index(text(from:), new_line('a'))
      if (next == 0) exit
      code = 1
      if (index(text(from:from+next-2), ',') > 1) &
        read (text(from:from+index(text(from:), ',')-2), *, iostat=code) number
      if (code /= 0) exit
      if (number > step) exit
      self%last_step = number
      from = from + next
    end do
    if (self%last_step /= step .and. step > 0) then
      call self%complain(path//' has no row of step '//integer_text(step)//'; the run has to start anew')
      return
    end if
    if (.not. cut_file(path, int(from - 1, i8))) then
      call self%complain('cannot shorten '//path//': '//system_error())
      return
    end if
    call self%file%extend(path)
    if (self%file%failed) call self%complain(self%file%message)
  end subroutine resume

  subroutine add_row(self, step, time, iterations, cutbacks, active, values)
    class(history_writer_type), intent(inout) :: self
    integer, intent(in) :: step
    real(wp), intent(in) :: time
    integer, intent(in) :: iterations     !! of the step
    integer, intent(in) :: cutbacks       !! of the step
    integer, intent(in) :: active         !! interface points that carry traction
    real(wp), intent(in) :: values(:)     !! one for each label

    character(:), allocatable :: row
    integer :: k

    if (size(values) /= self%columns) error stop 'history_writer: values do not match the columns'
    row = integer_text(step)//','//real_text(time)//','//integer_text(iterations)//','//integer_text(cutbacks)// &
      ','//integer_text(active)
    do k = 1, size(values)
      row = row//','//real_text(values(k))
    end do
    call self%file%put_line(row)
    call self%file%flush()
    self%last_step = step
    if (self%file%failed) call self%complain(self%file%message)
  end subroutine add_row

  subroutine close_history(self)
    class(history_writer_type), intent(inout) :: self

    call self%file%close()
    if (self%file%failed) call self%complain(self%file%message)
  end subroutine close_history

  pure function header(labels) result(line)
    character(*), intent(in) :: labels(:)
    character(:), allocatable :: line

    integer :: k

    line = first_columns
    do k = 1, size(labels)
      line = line//','//trim(labels(k))
    end do
  end function header

  subroutine complain(self, message)
    class(history_writer_type), intent(inout) :: self
    character(*), intent(in) :: message

    if (self%failed) return
    self%failed = .true.
    self%message = message
  end subroutine complain
end module history_writer
