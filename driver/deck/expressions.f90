module expressions
  !! Expressions of a deck: numbers and words combined by operators, functions, parameters and
  !! tables.
  !!
  !!     or          .or.  ||                     lowest
  !!     and         .and. &&
  !!     not         .not.
  !!     comparison  ==  /=  <  <=  >  >=         one, not chained; words: == and /= only, any case
  !!     sum         +  -
  !!     product     *  /
  !!     sign        -a  +a                       -2^2 = -4
  !!     power       ^  **                        2^3^2 = 2^9, 2^-1 = 1/2     highest
  !!
  !! Functions: sin cos tan asin acos atan atan2 sqrt exp log log10 abs min max int nint floor mod;
  !! constant pi. Angles are in radians. True is 1, false is 0, and any number but 0 counts as true.
  !! Names are compared in any case, words are written in quotes ("N"). In `table(row, column)` a
  !! key is taken literally if the table has it, and is evaluated otherwise: nx(N3, mesh). The right
  !! side of .and. and .or. must be written correctly but is evaluated only where it decides.
  !!
  !! No evaluation raises a floating-point exception: what would is a problem, with the character
  !! where it arose. A value that depends on something whose own problem was reported already is
  !! unknown, without a second problem.
  use kinds, only: wp
  use messages, only: name_hint, lower_case, quoted, whole_text
  use number_text, only: read_number, equal
  use expression_values, only: value, unknown_value, number_value, word_value, set_number, value_text
  use expression_symbols, only: symbol_source, no_symbols
  use expression_functions, only: functions, most_arguments, too_large, is_function, argument_range, &
    function_value, power, is_zero
  use expression_cursor, only: cursor_type, blanks, skip_blanks, ahead, next_is, next_is_either, &
    go_deeper, fail, fail_value, unexpected, need_closing, need_number, need_numbers
  implicit none (type, external)
  private
  public :: value, unknown_value, number_value, word_value, value_text
  public :: symbol_source, no_symbols, expression_problem
  public :: evaluate, is_name, is_reserved

  character(*), parameter :: name_characters = &
    'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_'

  type :: expression_problem
    logical :: found = .false.
    character(:), allocatable :: fact       !! what is wrong and where in the expression
    character(:), allocatable :: remedy     !! may be ''
    character(:), allocatable :: name       !! the name that is not known, else ''
  end type expression_problem

contains

  subroutine evaluate(text, symbols, v, problem)
    character(*), intent(in) :: text                   !! the whole expression
    class(symbol_source), intent(in) :: symbols        !! parameters and tables
    type(value), intent(out) :: v                      !! unknown after a problem
    type(expression_problem), intent(out) :: problem
    type(cursor_type) :: at

    problem%fact = ''
    problem%remedy = ''
    problem%name = ''
    if (verify(text, blanks) == 0) then
      call fail(at, 1, 'the expression is empty', '')
      problem%fact = at%fact
    else
      call parse_or(text, at, symbols, v)
      call skip_blanks(text, at)
      if (at%failed_at == 0 .and. at%pos <= len(text)) call unexpected(text, at)
      if (at%failed_at > 0) problem%fact = at%fact // ' at character ' // &
        whole_text(at%failed_at) // &
        ' of ' // quoted(text)
    end if
    if (at%failed_at == 0) return
    problem%found = .true.
    problem%remedy = at%remedy
    problem%name = at%name
    v%kind = unknown_value
    v%x = 0
  end subroutine evaluate

  recursive subroutine parse_or(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    type(value) :: b
    logical :: live

    call parse_and(text, at, symbols, v)
    do while (next_is_either(text, at, '.or.', '||'))
      live = at%live
      if (v%kind == number_value) at%live = live .and. is_zero(v%x)
      call parse_and(text, at, symbols, b)
      call join(at, live, b, 1.0_wp, v)
      if (at%failed_at > 0) return
    end do
  end subroutine parse_or

  recursive subroutine parse_and(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    type(value) :: b
    logical :: live

    call parse_not(text, at, symbols, v)
    do while (next_is_either(text, at, '.and.', '&&'))
      live = at%live
      if (v%kind == number_value) at%live = live .and. .not. is_zero(v%x)
      call parse_not(text, at, symbols, b)
      call join(at, live, b, 0.0_wp, v)
      if (at%failed_at > 0) return
    end do
  end subroutine parse_and

  subroutine join(at, live, b, decided, a)
    !! a = a .and. b (decided if a = 0) or a .or. b (decided if a = 1).
    type(cursor_type), intent(inout) :: at
    logical, intent(in) :: live             ! of the whole
    type(value), intent(in) :: b
    real(wp), intent(in) :: decided
    type(value), intent(inout) :: a
    logical :: evaluated

    evaluated = at%live
    at%live = live
    call need_number(at, a, at%pos - 1)
    if (.not. evaluated) then
      a%x = decided
    else
      call need_numbers(at, a, b, at%pos - 1)
      if (a%kind == number_value) a%x = merge(0.0_wp, 1.0_wp, is_zero(b%x))
    end if
  end subroutine join

  recursive subroutine parse_not(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v

    if (next_is(text, at, '.not.')) then
      call go_deeper(at)
      if (at%failed_at > 0) return
      call parse_not(text, at, symbols, v)
      at%depth = at%depth - 1
      call need_number(at, v, at%pos - 1)
      if (v%kind == number_value) v%x = merge(1.0_wp, 0.0_wp, is_zero(v%x))
    else
      call parse_comparison(text, at, symbols, v)
    end if
  end subroutine parse_not

  recursive subroutine parse_comparison(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    type(value) :: b
    character(2), parameter :: operators(6) = ['==', '/=', '<=', '>=', '< ', '> ']
    integer :: i, place
    logical :: holds

    call parse_sum(text, at, symbols, v)
    if (at%failed_at > 0) return
    do i = 1, size(operators)
      place = at%pos
      if (next_is(text, at, trim(operators(i)))) exit
    end do
    if (i > size(operators)) return
    call parse_sum(text, at, symbols, b)
    if (at%failed_at > 0) return
    if (v%kind == unknown_value .or. b%kind == unknown_value) then
      v%kind = unknown_value
      return
    end if
    if (v%kind /= b%kind) then
      call fail_value(at, place, 'a number is compared with a word', v)
      return
    end if
    if (v%kind == word_value) then
      holds = lower_case(v%word) == lower_case(b%word)
      if (i > 2) call fail(at, place, 'words can be compared by == and /= only', '', .true.)
      if (i == 2) holds = .not. holds
    else
      select case (operators(i))
      case ('=='); holds = equal(v%x, b%x)
      case ('/='); holds = .not. equal(v%x, b%x)
      case ('<='); holds = v%x <= b%x
      case ('>='); holds = v%x >= b%x
      case ('< '); holds = v%x < b%x
      case default; holds = v%x > b%x
      end select
    end if
    call set_number(v, merge(1.0_wp, 0.0_wp, holds))
  end subroutine parse_comparison

  recursive subroutine parse_sum(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    type(value) :: b
    logical :: minus
    integer :: place

    call parse_product(text, at, symbols, v)
    do while (at%failed_at == 0)
      call skip_blanks(text, at)
      place = at%pos
      minus = next_is(text, at, '-')
      if (.not. minus) then
        if (.not. next_is(text, at, '+')) return
      end if
      call parse_product(text, at, symbols, b)
      call need_numbers(at, v, b, place)
      if (v%kind /= number_value) cycle
      if (max(exponent(v%x), exponent(b%x)) >= maxexponent(1.0_wp)) then
        call fail_value(at, place, too_large, v)
      else
        v%x = merge(v%x - b%x, v%x + b%x, minus)
      end if
    end do
  end subroutine parse_sum

  recursive subroutine parse_product(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    type(value) :: b
    logical :: division
    integer :: place

    call parse_sign(text, at, symbols, v)
    do while (at%failed_at == 0)
      call skip_blanks(text, at)
      place = at%pos
      if (ahead(text, at, '/=')) return
      division = next_is(text, at, '/')
      if (.not. division) then
        if (.not. next_is(text, at, '*')) return
      end if
      call parse_sign(text, at, symbols, b)
      call need_numbers(at, v, b, place)
      if (v%kind /= number_value) cycle
      if (division .and. is_zero(b%x)) then
        call fail_value(at, place, 'division by zero', v)
      else if (is_zero(v%x) .or. is_zero(b%x)) then
        v%x = 0
      else if (division) then
        if (exponent(v%x) - exponent(b%x) >= maxexponent(1.0_wp)) then
          call fail_value(at, place, too_large, v)
        else
          v%x = v%x/b%x
        end if
      else if (exponent(v%x) + exponent(b%x) > maxexponent(1.0_wp)) then
        call fail_value(at, place, too_large, v)
      else
        v%x = v%x*b%x
      end if
    end do
  end subroutine parse_product

  recursive subroutine parse_sign(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    logical :: minus
    integer :: place

    call skip_blanks(text, at)
    place = at%pos
    minus = next_is(text, at, '-')
    if (.not. minus) then
      if (.not. next_is(text, at, '+')) then
        call parse_power(text, at, symbols, v)
        return
      end if
    end if
    call go_deeper(at)
    if (at%failed_at > 0) return
    call parse_sign(text, at, symbols, v)
    at%depth = at%depth - 1
    call need_number(at, v, place)
    if (minus) v%x = -v%x
  end subroutine parse_sign

  recursive subroutine parse_power(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    type(value) :: b
    integer :: place
    real(wp) :: x
    character(:), allocatable :: fact

    call parse_primary(text, at, symbols, v)
    if (at%failed_at > 0) return
    call skip_blanks(text, at)
    place = at%pos
    if (.not. next_is(text, at, '^')) then
      if (.not. next_is(text, at, '**')) return
    end if
    call go_deeper(at)
    if (at%failed_at > 0) return
    call parse_sign(text, at, symbols, b)
    at%depth = at%depth - 1
    call need_numbers(at, v, b, place)
    if (v%kind /= number_value) return
    x = v%x
    call power(x, b%x, v%x, fact)
    if (len(fact) > 0) call fail_value(at, place, fact, v)
  end subroutine parse_power

  recursive subroutine parse_primary(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    integer :: used, last
    real(wp) :: x

    call skip_blanks(text, at)
    if (at%pos > len(text)) then
      call fail(at, at%pos, 'the expression ends where a number or a name is needed', '')
      return
    end if
    select case (text(at%pos:at%pos))
    case ('0':'9', '.')
      call read_number(text(at%pos:), x, used)
      if (used == 0) then
        call unexpected(text, at)
      else if (used < 0) then
        call fail(at, at%pos, 'the number is too large', '')
      else
        call set_number(v, x)
        at%pos = at%pos + used
        if (at%pos <= len(text)) then
          if (verify(text(at%pos:at%pos), name_characters) == 0) call unexpected(text, at)
        end if
      end if
    case ('"')
      last = index(text(at%pos+1:), '"')
      if (last == 0) then
        call fail(at, at%pos, 'the quotes are not closed', '')
        return
      end if
      v%kind = word_value
      v%word = text(at%pos+1:at%pos+last-1)
      at%pos = at%pos + last + 1
    case ('(')
      at%pos = at%pos + 1
      call go_deeper(at)
      if (at%failed_at > 0) return
      call parse_or(text, at, symbols, v)
      at%depth = at%depth - 1
      call need_closing(text, at)
    case ('a':'z', 'A':'Z')
      call parse_name(text, at, symbols, v)
    case default
      call unexpected(text, at)
    end select
  end subroutine parse_primary

  recursive subroutine parse_name(text, at, symbols, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    character(:), allocatable :: name
    integer :: first
    logical :: found

    first = at%pos
    do while (at%pos <= len(text))
      if (verify(text(at%pos:at%pos), name_characters) > 0) exit
      at%pos = at%pos + 1
    end do
    name = lower_case(text(first:at%pos-1))

    if (next_is(text, at, '(')) then
      call go_deeper(at)
      if (at%failed_at > 0) return
      if (is_function(name)) then
        call parse_function(text, at, symbols, name, first, v)
      else if (symbols%has_table(name)) then
        call parse_table(text, at, symbols, name, first, v)
      else
        call fail(at, first, 'there is no function or table ' // &
          quoted(text(first:first+len(name)-1)), &
          name_hint(name, functions, 'functions') // ' ' // &
            symbols%symbol_hint(name))
      end if
      at%depth = at%depth - 1
      return
    end if
    if (name == 'pi') then
      call set_number(v, acos(-1.0_wp))
      return
    end if
    call symbols%find_symbol(name, v, found)
    if (found .or. .not. at%live) return
    call fail(at, first, 'there is no parameter ' // quoted(text(first:first+len(name)-1)), &
      symbols%symbol_hint(name))
    at%name = text(first:first+len(name)-1)
  end subroutine parse_name

  recursive subroutine parse_function(text, at, symbols, name, first, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    character(*), intent(in) :: name
    integer, intent(in) :: first             ! where the name stands
    type(value), intent(out) :: v
    type(value) :: b
    real(wp) :: x(most_arguments)
    integer :: n, least, largest
    logical :: known
    character(:), allocatable :: fact

    call argument_range(name, least, largest)
    x = 0
    n = 0
    known = .true.
    do
      call parse_or(text, at, symbols, b)
      if (at%failed_at > 0) return
      call need_number(at, b, at%pos - 1)
      if (at%failed_at > 0) return
      n = n + 1
      known = known .and. b%kind == number_value
      if (n <= most_arguments) x(n) = b%x
      if (.not. next_is(text, at, ',')) exit
    end do
    call need_closing(text, at)
    if (at%failed_at > 0) return
    if (n < least .or. n > largest) then
      if (largest == most_arguments) then
        call fail(at, first, name // ' takes 1 to ' // whole_text(largest) // ' arguments, not ' // &
          whole_text(n), '')
      else
        call fail(at, first, name // ' takes ' // whole_text(least) // ' argument' // &
          trim(merge('s', ' ', least > 1)) // ', not ' // whole_text(n), '')
      end if
      return
    end if
    if (.not. known) return
    v%kind = number_value

    call function_value(name, x(:n), v%x, fact)
    if (len(fact) > 0) call fail_value(at, first, fact, v)
  end subroutine parse_function

  recursive subroutine parse_table(text, at, symbols, name, first, v)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    character(*), intent(in) :: name
    integer, intent(in) :: first             ! where the name stands
    type(value), intent(out) :: v
    character(:), allocatable :: row, column, fact, remedy
    logical :: known_row, known_column

    column = ''
    known_column = .true.
    call parse_key(text, at, symbols, name, .false., row, known_row)
    if (at%failed_at > 0) return
    if (next_is(text, at, ',')) call parse_key(text, at, symbols, name, .true., column, &
      known_column)
    call need_closing(text, at)
    if (at%failed_at > 0 .or. .not. (known_row .and. known_column .and. at%live)) return
    call symbols%look_up(name, row, column, v, fact, remedy)
    if (len(fact) > 0) call fail(at, first, fact, remedy)
  end subroutine parse_table

  recursive subroutine parse_key(text, at, symbols, table, is_column, key, known)
    character(*), intent(in) :: text
    type(cursor_type), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    character(*), intent(in) :: table
    logical, intent(in) :: is_column
    character(:), allocatable, intent(out) :: key
    logical, intent(out) :: known            ! false: depends on something with a problem
    type(value) :: v
    integer :: last, depth

    known = .true.
    depth = 0
    last = at%pos
    do while (last <= len(text))
      select case (text(last:last))
      case ('(')
        depth = depth + 1
      case (')')
        depth = depth - 1
        if (depth < 0) exit
      case (',')
        if (depth == 0) exit
      end select
      last = last + 1
    end do
    key = trim(adjustl(text(at%pos:last-1)))
    if (symbols%has_key(table, is_column, lower_case(key))) then
      at%pos = last
      return
    end if
    call parse_or(text, at, symbols, v)
    if (at%failed_at > 0) then
      ! a word that is no parameter was meant as a key: let the look-up name the keys
      if (.not. is_name(key) .or. .not. allocated(at%name)) return
      if (at%name /= key) return
      at%failed_at = 0
      at%pos = last
    else
      known = v%kind /= unknown_value
      key = value_text(v)
    end if
  end subroutine parse_key

  pure logical function is_name(text)
    !! A letter, then letters, digits and underscores.
    character(*), intent(in) :: text

    is_name = .false.
    if (len(text) == 0) return
    is_name = verify(text, name_characters) == 0 .and. verify(text(1:1), '0123456789_') > 0
  end function is_name

  pure logical function is_reserved(name)
    !! Names that a parameter or table cannot have.
    character(*), intent(in) :: name         !! any case

    is_reserved = is_function(lower_case(name)) .or. lower_case(name) == 'pi'
  end function is_reserved
end module expressions
