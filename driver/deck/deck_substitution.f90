module deck_substitution
  !! {expr} in a line of a deck: the value takes its place before the line is split into items.
  use messages, only: message_log, quoted
  use expressions, only: symbol_source, value, expression_problem, evaluate, value_text, unknown_value
  use logical_lines, only: logical_line, blank_line, append_text
  implicit none (type, external)
  private
  public :: substitute

contains

  subroutine substitute(line, symbols, scratch, is_damaged, log)
    !! Replaces {expr} by its value, inner braces first.
    type(logical_line), intent(inout) :: line
    class(symbol_source), intent(in) :: symbols       !! for the expressions
    type(logical_line), intent(inout) :: scratch      !! a buffer, kept from line to line
    logical, intent(inout) :: is_damaged              !! becomes true after an error, stays otherwise
    type(message_log), intent(inout) :: log
    integer, parameter :: deepest = 20
    type(expression_problem) :: problem
    type(value) :: v
    integer :: opening(deepest), depth, i, k

    if (index(line%text(1:line%n), '{') == 0) return
    call blank_line(scratch)
    depth = 0
    k = 1
    do i = 1, line%n
      if (k <= line%joins) then
        if (line%join_column(k) == i) then
          line%join_column(k) = scratch%n + 1   ! continuations move with the text
          k = k + 1
        end if
      end if
      if (line%text(i:i) == '{' .and. depth < deepest) then
        depth = depth + 1
        opening(depth) = scratch%n + 1
        call append_text(scratch, '{')
      else if (line%text(i:i) == '}' .and. depth > 0) then
        call evaluate(scratch%text(opening(depth)+1:scratch%n), symbols, v, problem)
        if (problem%found) call log%add_error(line%at, '', problem%fact, problem%remedy)
        if (v%kind == unknown_value) is_damaged = .true.
        scratch%n = opening(depth) - 1
        call append_text(scratch, value_text(v))
        depth = depth - 1
      else
        call append_text(scratch, line%text(i:i))
      end if
    end do
    if (depth > 0) then
      call log%add_error(line%at, '', '"}" is missing behind ' // &
        quoted(scratch%text(opening(depth):scratch%n)), '')
      is_damaged = .true.
    end if
    line%n = 0
    call append_text(line, scratch%text(1:scratch%n))
  end subroutine substitute
end module deck_substitution
