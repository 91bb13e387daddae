module expression_cursor
  !! The place that reading an expression has reached, what comes next there, and the first problem that was found.
  use messages, only: lower_case, quoted
  use expression_values, only: value, unknown_value, word_value
  implicit none (type, external)
  private
  public :: cursor_type, skip_blanks, ahead, next_is, next_is_either, go_deeper
  public :: fail, unexpected, fail_value, need_closing, need_number, need_numbers, blanks

  integer, parameter :: deepest = 200       !! nested parentheses, signs and powers
  character(*), parameter :: blanks = ' ' // achar(9)

  type :: cursor_type
    integer :: pos = 1                      ! next character
    integer :: depth = 0
    logical :: live = .true.                ! false beside a decided .and. or .or.
    integer :: failed_at = 0                ! character of the problem; 0: none
    character(:), allocatable :: fact, remedy, name
  end type cursor_type

contains

  pure subroutine skip_blanks(text, at)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at

    do while (at%pos <= len(text))
      if (index(blanks, text(at%pos:at%pos)) == 0) return
      at%pos = at%pos + 1
    end do
  end subroutine skip_blanks

  pure logical function ahead(text, at, symbol)
    character(*), intent(in) :: text
    type(cursor_type), intent(in) :: at
    character(*), intent(in) :: symbol

    ahead = .false.
    if (at%pos + len(symbol) - 1 > len(text)) return
    ahead = lower_case(text(at%pos:at%pos+len(symbol)-1)) == symbol
  end function ahead

  logical function next_is(text, at, symbol)
    !! Takes the symbol if it comes next, after blanks.
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    character(*), intent(in) :: symbol       ! lower case

    next_is = .false.
    if (at%failed_at > 0) return
    call skip_blanks(text, at)
    next_is = ahead(text, at, symbol)
    if (next_is) at%pos = at%pos + len(symbol)
  end function next_is

  logical function next_is_either(text, at, symbol, other)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    character(*), intent(in) :: symbol, other

    next_is_either = next_is(text, at, symbol)
    if (.not. next_is_either) next_is_either = next_is(text, at, other)
  end function next_is_either

  subroutine need_closing(text, at)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at

    if (at%failed_at > 0) return
    if (next_is(text, at, ')')) return
    if (at%pos > len(text)) then
      call fail(at, at%pos, '")" is missing', '')
    else
      call unexpected(text, at)
    end if
  end subroutine need_closing

  subroutine go_deeper(at)
    type(cursor_type), intent(inout) :: at

    at%depth = at%depth + 1
    if (at%depth > deepest) call fail(at, at%pos, 'the expression is nested too deeply', &
      'Split it with the help of parameters.')
  end subroutine go_deeper

  subroutine need_numbers(at, a, b, place)
    !! Both operands must be numbers; a becomes unknown if either is not.
    type(cursor_type), intent(inout) :: at
    type(value), intent(inout) :: a
    type(value), intent(in) :: b
    integer, intent(in) :: place             ! character that a problem names
    type(value) :: other

    other = b
    call need_number(at, a, place)
    call need_number(at, other, place)
    if (other%kind == unknown_value) a%kind = unknown_value
  end subroutine need_numbers

  subroutine need_number(at, a, place)
    type(cursor_type), intent(inout) :: at
    type(value), intent(inout) :: a          ! becomes unknown if it is a word
    integer, intent(in) :: place             ! character that a problem names

    if (a%kind /= word_value) return
    call fail(at, place, 'a number is needed, not the word ' // quoted(a%word), '', .true.)
    a%kind = unknown_value
  end subroutine need_number

  subroutine unexpected(text, at)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at

    call skip_blanks(text, at)
    if (text(at%pos:at%pos) == '=') then
      call fail(at, at%pos, '"=" is unexpected', 'Compare by "==".')
    else
      call fail(at, at%pos, quoted(text(at%pos:at%pos)) // ' is unexpected', '')
    end if
  end subroutine unexpected

  subroutine fail(at, place, fact, remedy, only_if_live)
    !! Keeps the first problem. Problems of values count only where the value is used.
    type(cursor_type), intent(inout) :: at
    integer, intent(in) :: place
    character(*), intent(in) :: fact, remedy
    logical, intent(in), optional :: only_if_live

    if (at%failed_at > 0) return
    if (present(only_if_live) .and. .not. at%live) return
    at%failed_at = place
    at%fact = fact
    at%remedy = remedy
    at%name = ''
  end subroutine fail

  subroutine fail_value(at, place, fact, v)
    !! A problem of a value, which is unknown from here on.
    type(cursor_type), intent(inout) :: at
    integer, intent(in) :: place             ! character that the problem names
    character(*), intent(in) :: fact
    type(value), intent(inout) :: v

    call fail(at, place, fact, '', .true.)
    v%kind = unknown_value
  end subroutine fail_value
end module expression_cursor
