module funit_suites
  !! Suites of tests, and the loop that runs them and reports.
  use, intrinsic :: iso_fortran_env, only: output_unit, error_unit, int64
  use funit_exceptions, only: SourceLocation, anyExceptions, take_exception
  implicit none (type, external)
  private
  public :: TestSuite, suite_runner

  abstract interface
    subroutine procedure_of_test()
    end subroutine procedure_of_test
  end interface

  type :: test_case
    character(:), allocatable :: name
    procedure(procedure_of_test), pointer, nopass :: run => null()
    logical :: disabled = .false.
  end type test_case

  type :: TestSuite
    character(:), allocatable :: name
    procedure(procedure_of_test), pointer, nopass :: before => null()
    procedure(procedure_of_test), pointer, nopass :: after => null()
    type(test_case), allocatable :: tests(:)
  contains
    procedure :: add
  end type TestSuite

  type :: suite_runner
    private
    character(:), allocatable :: filter     !! part of the names to run
    logical :: verbose = .false.            !! name every test before it runs
    integer :: run_count = 0, failed_count = 0, disabled_count = 0
    integer(int64) :: started = 0
  contains
    procedure :: open
    procedure :: run
    procedure :: close
  end type suite_runner

contains

  subroutine add(suite, name, test, disabled)
    class(TestSuite), intent(inout) :: suite
    character(*), intent(in) :: name
    procedure(procedure_of_test) :: test
    logical, intent(in) :: disabled
    type(test_case), allocatable :: longer(:)
    integer :: i, n

    n = 0
    if (allocated(suite%tests)) n = size(suite%tests)
    allocate (longer(n + 1))
    do i = 1, n
      longer(i) = suite%tests(i)
    end do
    longer(n + 1)%name = suite%name // '.' // name
    longer(n + 1)%run => test
    longer(n + 1)%disabled = disabled
    call move_alloc(longer, suite%tests)
  end subroutine add

  subroutine open(runner)
    !! Reads the command line: [-v] [-f PART_OF_A_NAME].
    class(suite_runner), intent(inout) :: runner
    character(:), allocatable :: word
    integer :: i

    runner%filter = ''
    i = 1
    do while (i <= command_argument_count())
      word = argument(i)
      select case (word)
      case ('-v', '--verbose', '-d', '--debug')
        runner%verbose = .true.
      case ('-f', '--filter')
        i = i + 1
        if (i > command_argument_count()) call refuse(word // ' needs a part of a test''s name')
        runner%filter = argument(i)
      case default
        call refuse('unknown option ' // word // '. Known: --verbose, --filter PART_OF_A_NAME')
      end select
      i = i + 1
    end do
    call system_clock(runner%started)
  end subroutine open

  subroutine run(runner, suite)
    class(suite_runner), intent(inout) :: runner
    type(TestSuite), intent(in) :: suite
    integer :: i

    do i = 1, size(suite%tests)
      associate (test => suite%tests(i))
        if (index(test%name, runner%filter) == 0) cycle
        if (test%disabled) then
          runner%disabled_count = runner%disabled_count + 1
          call report('Disabled: ' // test%name)
          cycle
        end if
        if (runner%verbose) call report('Start: <' // test%name // '>')
        runner%run_count = runner%run_count + 1
        if (associated(suite%before)) call suite%before()
        if (.not. anyExceptions()) then
          call test%run()
          if (associated(suite%after)) call suite%after()
        end if
        if (anyExceptions()) then
          runner%failed_count = runner%failed_count + 1
          if (runner%verbose) call report('Failure in <' // test%name // '>')
        end if
        do while (anyExceptions())
          call report_failure(test%name)
        end do
        if (runner%verbose) call report('  end: <' // test%name // '>')
      end associate
    end do
  end subroutine run

  subroutine close(runner)
    !! The closing lines; ends the program with a non-zero status if anything failed.
    class(suite_runner), intent(inout) :: runner
    integer(int64) :: now, rate
    character(200) :: text
    character(24) :: disabled

    call system_clock(now, rate)
    write (text, '(a,f12.3,a)') 'Time: ', real(now - runner%started) / real(rate), ' seconds'
    call report(trim(text))
    if (runner%run_count + runner%disabled_count == 0) then
      call refuse('no test has "' // runner%filter // '" in its name')
    end if
    if (runner%failed_count > 0) then
      write (text, '(*(a,i0))') 'Tests run: ', runner%run_count, ', Failures: ', &
        runner%failed_count, ', Errors: ', 0, ', Disabled: ', runner%disabled_count
      call report('FAILURES!!!')
      call report(trim(text))
      stop 2, quiet = .true.
    end if
    call report(' OK')
    write (text, '(a,i0,a)') ' (', runner%run_count, ' test'
    if (runner%run_count /= 1) text = trim(text) // 's'
    write (disabled, '(a,i0,a)') ', ', runner%disabled_count, ' disabled'
    if (runner%disabled_count > 0) text = trim(text) // disabled
    call report(trim(text) // ')')
  end subroutine close

  subroutine report_failure(name)
    !! A line a failure: place, test, what was expected and found.
    character(*), intent(in) :: name
    character(:), allocatable :: message
    type(SourceLocation) :: location
    character(12) :: line

    call take_exception(message, location)
    if (location%line > 0) then
      write (line, '(i0)') location%line
      call report(trim(location%file_name) // ':' // trim(line) // ': ' // name // ': ' // message)
    else
      call report(name // ': ' // message)
    end if
  end subroutine report_failure

  subroutine report(text)
    !! One line at once, so that it is there if the next test ends the process.
    character(*), intent(in) :: text

    write (output_unit, '(a)') text
    flush (output_unit)
  end subroutine report

  subroutine refuse(text)
    character(*), intent(in) :: text

    write (error_unit, '(a)') text
    stop 2, quiet = .true.
  end subroutine refuse

  function argument(i) result(word)
    integer, intent(in) :: i
    character(:), allocatable :: word
    integer :: length

    call get_command_argument(i, length=length)
    allocate (character(length) :: word)
    call get_command_argument(i, word)
  end function argument
end module funit_suites
