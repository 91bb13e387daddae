program pf_preprocessor
  !! pf_preprocessor IN.pf OUT.F90: turns a test file into Fortran, for the module funit beside it.
  !! It accepts a strict subset of pFUnit 4: an unknown or malformed directive is an error with file
  !! and line, all of a file at once.
  !!
  !! A test file holds one module of its own name. Every `@assert...` becomes a call and a return if
  !! anything failed; `@test` (also with `@disable`), `@before`, `@after` mark the next subroutine.
  !! Behind the module follows the function `<name>_suite` that collects the tests.
  use, intrinsic :: iso_fortran_env, only: error_unit, iostat_end
  implicit none (type, external)

  integer, parameter :: longest_directive = 120, longest_name = 44
  !! What the next subroutine will be.
  integer, parameter :: nothing = 0, a_test = 1, a_before = 2, an_after = 3
  character(*), parameter :: letters = 'abcdefghijklmnopqrstuvwxyz', digits = '0123456789'
  character(*), parameter :: tab = achar(9)

  type :: assertion
    character(20) :: name
    integer :: least, most  !! numbers of arguments, optional ones included
  end type assertion
  type(assertion), parameter :: assertions(*) = [ &
    assertion('equal', 2, 4), assertion('notequal', 2, 3), assertion('relativelyequal', 3, 4), &
    assertion('lessthan', 2, 3), assertion('lessthanorequal', 2, 3), &
    assertion('greaterthan', 2, 3), assertion('greaterthanorequal', 2, 3), &
    assertion('true', 1, 2), assertion('false', 1, 2), assertion('all', 1, 2), &
    assertion('any', 1, 2), assertion('isnan', 1, 2), assertion('isfinite', 1, 2), &
    assertion('sameshape', 2, 3), assertion('fail', 1, 1), assertion('exceptionraised', 0, 1)]

  type :: test
    character(longest_name) :: name
    logical :: disabled
  end type test

  character(:), allocatable :: in_name, out_name, base, line, module_name, before, after
  type(test), allocatable :: tests(:)
  integer :: in_unit, out_unit, line_number, awaited, awaited_since, error_count, status
  logical :: disabled

  if (command_argument_count() /= 2) call stop_at_once('usage: pf_preprocessor IN.pf OUT.F90')
  in_name = argument(1)
  out_name = argument(2)
  base = in_name(index(in_name, '/', back=.true.) + 1:)
  open (newunit=in_unit, file=in_name, status='old', action='read', iostat=status)
  if (status /= 0) call stop_at_once(in_name // ': cannot be read')
  open (newunit=out_unit, file=out_name, status='replace', action='write', iostat=status)
  if (status /= 0) call stop_at_once(out_name // ': cannot be written')

  module_name = ''
  before = ''
  after = ''
  allocate (tests(0))
  awaited = nothing
  awaited_since = 0
  disabled = .false.
  error_count = 0
  line_number = 0
  do
    call read_line(line, status)
    if (status /= 0) exit
    line_number = line_number + 1
    call treat(line)
  end do
  if (awaited /= nothing) call refuse('no subroutine follows this directive', awaited_since)
  if (module_name == '') then
    call refuse('the file holds no "module ' // stem() // '"')
  else if (size(tests) == 0 .and. error_count == 0) then
    call refuse('the file holds no @test')
  end if
  if (error_count > 0) then
    close (out_unit, status='delete')
    stop 1, quiet = .true.
  end if
  call write_suite()
  close (out_unit)

contains

  subroutine treat(line)
    !! Copies or translates one line.
    character(*), intent(in) :: line
    character(:), allocatable :: text, word

    text = lower(squeeze(line))
    if (text == '' .or. index(text, '!') == 1) then
      call write_line(line)
    else if (text(1:1) == '@') then
      call translate(line, text)
    else if (awaited /= nothing) then
      call take_subroutine(text)
      call write_line(line)
    else
      if (bare_at(line)) call refuse('"@" within a line; a directive stands alone on its line')
      if (index(text, 'module ') == 1) then
        word = squeeze(text(8:))
        if (index(word, 'procedure') /= 1 .and. index(word, 'subroutine') /= 1 .and. index(word, &
          'function') /= 1) then
          call take_module(word)
        end if
      end if
      call write_line(line)
    end if
  end subroutine treat

  subroutine translate(line, text)
    !! One directive.
    character(*), intent(in) :: line  !! as it stands
    character(*), intent(in) :: text  !! without blanks around it, in lower case

    if (len_trim(line) > longest_directive) call refuse('a directive has at most 120 columns')
    if (module_name == '') call refuse('a directive before the module statement')
    select case (text)
    case ('@test')
      call await(a_test)
    case ('@before')
      if (before /= '') call refuse('a second @before')
      call await(a_before)
    case ('@after')
      if (after /= '') call refuse('a second @after')
      call await(an_after)
    case ('@disable')
      if (awaited /= a_test) call refuse('@disable stands between @test and its subroutine')
      disabled = .true.
    case default
      if (index(text, '@assert') == 1) then
        if (awaited /= nothing) call refuse('expected "subroutine NAME" after the directive above')
        awaited = nothing
        call translate_assertion(squeeze(line))
        return
      end if
      call refuse('unknown or malformed directive ' // text(:word_end(text)))
    end select
    call write_line('!' // line)
  end subroutine translate

  subroutine await(what)
    integer, intent(in) :: what

    if (awaited /= nothing) call refuse('expected "subroutine NAME" after the directive above')
    awaited = what
    awaited_since = line_number
    disabled = .false.
  end subroutine await

  subroutine take_subroutine(text)
    !! The statement that must follow a marking directive.
    character(*), intent(in) :: text
    character(:), allocatable :: rest, name
    integer :: n, what, i

    what = awaited
    awaited = nothing
    rest = ''
    if (index(text, 'subroutine ') == 1) rest = squeeze(text(12:))
    n = verify(rest // ' ', letters // digits // '_') - 1
    name = rest(:n)
    rest = squeeze(rest(n + 1:))
    if (index(rest, '()') == 1) rest = squeeze(rest(3:))
    if (n == 0 .or. (rest /= '' .and. index(rest, '!') /= 1)) then
      call refuse('expected "subroutine NAME", no prefix, no argument, after the directive above')
      return
    end if
    select case (what)
    case (a_before)
      before = name
    case (an_after)
      after = name
    case (a_test)
      if (n > longest_name) call refuse('the name of a test has at most 44 characters: ' // name)
      if (name == 't' .or. name == 'suite') call refuse('a test cannot be named ' // name)
      do i = 1, size(tests)
        if (tests(i)%name == name) call refuse('a second test named ' // name)
      end do
      tests = [tests, test(name, disabled)]
    end select
  end subroutine take_subroutine

  subroutine take_module(name)
    character(*), intent(in) :: name

    if (module_name /= '') call refuse('a second module in the file')
    module_name = name
    if (name /= stem()) call refuse('expected "module ' // stem() // &
      '", the name of the file, alone on its line')
  end subroutine take_module

  subroutine translate_assertion(text)
    character(*), intent(in) :: text
    character(:), allocatable :: name, arguments
    integer :: n, count, which
    logical :: balanced
    character(12) :: number

    n = verify(lower(text(2:)) // ' ', letters)
    name = text(2:n)
    arguments = squeeze(text(n + 1:))
    do which = 1, size(assertions)
      if (lower(name) == 'assert' // assertions(which)%name) exit
    end do
    if (which > size(assertions)) then
      call refuse('unknown assertion @' // name)
      return
    end if
    call count_arguments(arguments, count, balanced)
    if (.not. balanced) then
      call refuse('expected @' // name // '(...) alone on its line, without "&" and comment')
      return
    end if
    if (count < assertions(which)%least .or. count > assertions(which)%most) then
      call refuse('wrong number of arguments of @' // name)
      return
    end if
    write (number, '(i0)') line_number
    call write_line('#line ' // trim(number) // ' "' // in_name // '"')
    call write_line('  call ' // name // arguments(:len(arguments) - 1) // trim(merge(', &', &
      '  &', count > 0)))
    call write_line('    & location=SourceLocation(''' // base // ''', ' // trim(number) // '))')
    call write_line('  if (anyExceptions()) return')
    write (number, '(i0)') line_number + 1
    call write_line('#line ' // trim(number) // ' "' // in_name // '"')
  end subroutine translate_assertion

  pure subroutine count_arguments(text, count, balanced)
    !! Arguments of a list in parentheses that ends the text.
    character(*), intent(in) :: text
    integer, intent(out) :: count
    logical, intent(out) :: balanced
    character :: quote
    integer :: i, depth

    count = 0
    depth = 0
    quote = ' '
    balanced = .false.
    do i = 1, len(text)
      if (quote /= ' ') then
        if (text(i:i) == quote) quote = ' '
        cycle
      end if
      select case (text(i:i))
      case ('''', '"')
        quote = text(i:i)
      case ('!')
        return
      case ('(', '[')
        depth = depth + 1
      case (')', ']')
        depth = depth - 1
        if (depth == 0) then
          balanced = i == len(text)
          exit
        end if
      case (',')
        if (depth == 1) count = count + 1
      end select
      if (depth == 0) return
    end do
    if (balanced .and. squeeze(text(2:len(text) - 1)) /= '') count = count + 1
  end subroutine count_arguments

  pure function bare_at(line) result(found)
    !! Whether the line has an "@" outside strings and comments.
    character(*), intent(in) :: line
    logical :: found
    character :: quote
    integer :: i

    found = .false.
    quote = ' '
    do i = 1, len(line)
      if (quote /= ' ') then
        if (line(i:i) == quote) quote = ' '
      else if (line(i:i) == '''' .or. line(i:i) == '"') then
        quote = line(i:i)
      else if (line(i:i) == '!') then
        return
      else if (line(i:i) == '@') then
        found = .true.
        return
      end if
    end do
  end function bare_at

  subroutine write_suite()
    integer :: i

    call write_line('')
    call write_line('function ' // module_name // '_suite() result(suite)')
    call write_line('  use funit, only: TestSuite')
    call write_line('  use ' // module_name)
    call write_line('  implicit none')
    call write_line('  type(TestSuite) :: suite')
    call write_line('')
    call write_line('  suite%name = ''' // module_name // '''')
    if (before /= '') call write_line('  suite%before => ' // before)
    if (after /= '') call write_line('  suite%after => ' // after)
    do i = 1, size(tests)
      call write_line('  call suite%add(''' // trim(tests(i)%name) // ''', ' // &
        trim(tests(i)%name) // ', ' // &
        trim(merge('.true. ', '.false.', tests(i)%disabled)) // ')')
    end do
    call write_line('end function ' // module_name // '_suite')
  end subroutine write_suite

  subroutine refuse(what, at)
    !! An error of the test file; the run goes on to find the others.
    character(*), intent(in) :: what
    integer, intent(in), optional :: at
    character(12) :: number

    write (number, '(i0)') max(1, line_number)
    if (present(at)) write (number, '(i0)') at
    write (error_unit, '(a)') in_name // ':' // trim(number) // ': ' // what
    error_count = error_count + 1
  end subroutine refuse

  subroutine stop_at_once(what)
    character(*), intent(in) :: what

    write (error_unit, '(a)') what
    stop 2, quiet = .true.
  end subroutine stop_at_once

  subroutine write_line(text)
    character(*), intent(in) :: text

    write (out_unit, '(a)') trim(text)
  end subroutine write_line

  subroutine read_line(text, status)
    !! A line of any length, without the carriage return of other systems.
    character(:), allocatable, intent(out) :: text
    integer, intent(out) :: status
    character(256) :: part
    integer :: n

    text = ''
    do
      read (in_unit, '(a)', advance='no', iostat=status, size=n) part
      if (status > 0) call stop_at_once(in_name // ': cannot be read')
      text = text // part(:n)
      if (status /= 0) exit
    end do
    if (status /= iostat_end .or. text /= '') status = 0
    if (len(text) > 0) then
      if (text(len(text):) == achar(13)) text = text(:len(text) - 1)
    end if
  end subroutine read_line

  function argument(i) result(word)
    integer, intent(in) :: i
    character(:), allocatable :: word
    integer :: length

    call get_command_argument(i, length=length)
    allocate (character(length) :: word)
    call get_command_argument(i, word)
  end function argument

  function stem() result(name)
    !! The file's name without folder and ending, in lower case.
    character(:), allocatable :: name

    name = lower(base(:index(base // '.', '.') - 1))
  end function stem

  pure function word_end(text) result(n)
    !! Length of the directive's word.
    character(*), intent(in) :: text
    integer :: n

    n = verify(text(2:) // ' ', letters // digits // '_')
  end function word_end

  pure function squeeze(text) result(inner)
    !! Without blanks and tabs at both ends.
    character(*), intent(in) :: text
    character(:), allocatable :: inner
    integer :: first, last

    first = verify(text, ' ' // tab)
    last = verify(text, ' ' // tab, back=.true.)
    inner = ''
    if (first > 0) inner = text(first:last)
  end function squeeze

  pure function lower(text) result(small)
    character(*), intent(in) :: text
    character(len(text)) :: small
    integer :: i, k

    small = text
    do i = 1, len(text)
      k = iachar(text(i:i)) - iachar('A')
      if (k >= 0 .and. k < 26) small(i:i) = achar(iachar('a') + k)
    end do
  end function lower
end program pf_preprocessor
