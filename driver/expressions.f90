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
  use number_text, only: read_number, write_number, equal
  implicit none (type, external)
  private
  public :: value, symbol_source, no_symbols, expression_problem
  public :: unknown_value, number_value, word_value
  public :: evaluate, is_name, is_reserved, value_text

  integer, parameter :: unknown_value = 0   !! its problem has been reported
  integer, parameter :: number_value = 1
  integer, parameter :: word_value = 2

  integer, parameter :: deepest = 200       !! nested parentheses, signs and powers
  real(wp), parameter :: largest_log = 709.7_wp
  character(*), parameter :: blanks = ' ' // achar(9)
  character(*), parameter :: name_characters = &
    'abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_'
  character(5), parameter :: functions(17) = [character(5) :: 'sin', 'cos', 'tan', 'asin', &
    'acos', 'atan', &
    'atan2', 'sqrt', 'exp', 'log', 'log10', 'abs', 'min', 'max', 'int', 'nint', 'floor']
  character(5), parameter :: more_functions(1) = [character(5) :: 'mod']

  type :: value
    integer :: kind = unknown_value
    real(wp) :: x = 0                       !! if it is a number
    character(:), allocatable :: word       !! if it is a word
  end type value

  type :: expression_problem
    logical :: found = .false.
    character(:), allocatable :: fact       !! what is wrong and where in the expression
    character(:), allocatable :: remedy     !! may be ''
    character(:), allocatable :: name       !! the name that is not known, else ''
  end type expression_problem

  type, abstract :: symbol_source
    !! Where expressions find parameters and tables. Names arrive in lower case.
  contains
    procedure(find_symbol), deferred :: find_symbol
    procedure(has_table), deferred :: has_table
    procedure(has_key), deferred :: has_key
    procedure(look_up), deferred :: look_up
    procedure(symbol_hint), deferred :: symbol_hint
  end type symbol_source

  abstract interface
    subroutine find_symbol(self, name, v, found)
      import :: symbol_source, value
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: name
      type(value), intent(out) :: v
      logical, intent(out) :: found
    end subroutine find_symbol

    logical function has_table(self, name)
      import :: symbol_source
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: name
    end function has_table

    logical function has_key(self, table, column, key)
      import :: symbol_source
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: table
      logical, intent(in) :: column          !! a column key, else a row key
      character(*), intent(in) :: key
    end function has_key

    subroutine look_up(self, table, row, column, v, fact, remedy)
      import :: symbol_source, value
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: table, row
      character(*), intent(in) :: column     !! '': the only column
      type(value), intent(out) :: v
      character(:), allocatable, intent(out) :: fact, remedy   !! fact is '' if all is well
    end subroutine look_up

    function symbol_hint(self, name) result(hint)
      import :: symbol_source
      implicit none (type, external)
      class(symbol_source), intent(in) :: self
      character(*), intent(in) :: name
      character(:), allocatable :: hint      !! remedy for a name that is not known
    end function symbol_hint
  end interface

  type, extends(symbol_source) :: no_symbols
    !! Plain arithmetic.
  contains
    procedure :: find_symbol => no_symbol
    procedure :: has_table => no_table
    procedure :: has_key => no_key
    procedure :: look_up => no_look_up
    procedure :: symbol_hint => no_hint
  end type no_symbols

  type :: parse_state
    integer :: pos = 1                      ! next character
    integer :: depth = 0
    logical :: live = .true.                ! false beside a decided .and. or .or.
    integer :: failed_at = 0                ! character of the problem; 0: none
    character(:), allocatable :: fact, remedy, name
  end type parse_state

contains

  subroutine evaluate(text, symbols, v, problem)
    character(*), intent(in) :: text                   !! the whole expression
    class(symbol_source), intent(in) :: symbols        !! parameters and tables
    type(value), intent(out) :: v                      !! unknown after a problem
    type(expression_problem), intent(out) :: problem
    type(parse_state) :: at

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
    type(parse_state), intent(inout) :: at
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
    type(parse_state), intent(inout) :: at
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
    type(parse_state), intent(inout) :: at
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
    type(parse_state), intent(inout) :: at
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
    type(parse_state), intent(inout) :: at
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
      call fail(at, place, 'a number is compared with a word', '', .true.)
      v%kind = unknown_value
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
    type(parse_state), intent(inout) :: at
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
        call too_large(at, place, v)
      else
        v%x = merge(v%x - b%x, v%x + b%x, minus)
      end if
    end do
  end subroutine parse_sum

  recursive subroutine parse_product(text, at, symbols, v)
    character(*), intent(in) :: text
    type(parse_state), intent(inout) :: at
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
        call fail(at, place, 'division by zero', '', .true.)
        v%kind = unknown_value
      else if (is_zero(v%x) .or. is_zero(b%x)) then
        v%x = 0
      else if (division) then
        if (exponent(v%x) - exponent(b%x) >= maxexponent(1.0_wp)) then
          call too_large(at, place, v)
        else
          v%x = v%x/b%x
        end if
      else if (exponent(v%x) + exponent(b%x) > maxexponent(1.0_wp)) then
        call too_large(at, place, v)
      else
        v%x = v%x*b%x
      end if
    end do
  end subroutine parse_product

  recursive subroutine parse_sign(text, at, symbols, v)
    character(*), intent(in) :: text
    type(parse_state), intent(inout) :: at
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
    type(parse_state), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    type(value), intent(out) :: v
    type(value) :: b
    integer :: place

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
    if (v%kind == number_value) call raise(at, place, b%x, v)
  end subroutine parse_power

  subroutine raise(at, place, b, v)
    !! v = v^b.
    type(parse_state), intent(inout) :: at
    integer, intent(in) :: place
    real(wp), intent(in) :: b
    type(value), intent(inout) :: v
    real(wp) :: magnitude
    logical :: odd

    if (is_zero(b)) then
      v%x = 1
    else if (is_zero(v%x)) then
      if (b < 0) then
        call fail(at, place, 'zero is raised to a negative power', '', .true.)
        v%kind = unknown_value
      end if
    else if (v%x < 0 .and. .not. equal(aint(b), b)) then
      call fail(at, place, 'a negative number is raised to a broken power', '', .true.)
      v%kind = unknown_value
    else
      odd = .false.
      if (v%x < 0) odd = equal(modulo(b, 2.0_wp), 1.0_wp)
      magnitude = log(abs(v%x))
      if (is_zero(magnitude)) then
        v%x = 1
      else if (abs(b) > largest_log/abs(magnitude)) then
        if ((b > 0) .eqv. (magnitude > 0)) call too_large(at, place, v)
        v%x = 0
      else
        v%x = abs(v%x)**b
      end if
      if (odd) v%x = -v%x
    end if
  end subroutine raise

  recursive subroutine parse_primary(text, at, symbols, v)
    character(*), intent(in) :: text
    type(parse_state), intent(inout) :: at
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
    type(parse_state), intent(inout) :: at
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
          name_hint(name, [functions, more_functions], 'functions') // ' ' // &
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
    type(parse_state), intent(inout) :: at
    class(symbol_source), intent(in) :: symbols
    character(*), intent(in) :: name
    integer, intent(in) :: first             ! where the name stands
    type(value), intent(out) :: v
    integer, parameter :: most = 20
    type(value) :: b
    real(wp) :: x(most)
    integer :: n, least, largest
    logical :: known

    least = 1
    largest = 1
    select case (name)
    case ('atan2', 'mod')
      least = 2
      largest = 2
    case ('min', 'max')
      largest = most
    end select
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
      if (n <= most) x(n) = b%x
      if (.not. next_is(text, at, ',')) exit
    end do
    call need_closing(text, at)
    if (at%failed_at > 0) return
    if (n < least .or. n > largest) then
      if (largest == most) then
        call fail(at, first, name // ' takes 1 to ' // whole_text(most) // ' arguments, not ' // &
          whole_text(n), '')
      else
        call fail(at, first, name // ' takes ' // whole_text(least) // ' argument' // &
          trim(merge('s', ' ', least > 1)) // ', not ' // whole_text(n), '')
      end if
      return
    end if
    if (.not. known) return
    v%kind = number_value

    select case (name)
    case ('sin');   v%x = sin(x(1))
    case ('cos');   v%x = cos(x(1))
    case ('tan');   v%x = tan(x(1))
    case ('atan');  v%x = atan(x(1))
    case ('abs');   v%x = abs(x(1))
    case ('min');   v%x = minval(x(:n))
    case ('max');   v%x = maxval(x(:n))
    case ('int');   v%x = aint(x(1))
    case ('nint');  v%x = anint(x(1))
    case ('floor')
      v%x = aint(x(1))
      if (v%x > x(1)) v%x = v%x - 1
    case ('asin', 'acos')
      if (abs(x(1)) > 1) then
        call outside(at, first, name, x(1), v)
      else if (name == 'asin') then
        v%x = asin(x(1))
      else
        v%x = acos(x(1))
      end if
    case ('atan2')
      if (.not. all(is_zero(x(1:2)))) then
        v%x = atan2(x(1), x(2))
      else
        call outside(at, first, name, 0.0_wp, v)
      end if
    case ('sqrt')
      if (x(1) < 0) then
        call outside(at, first, name, x(1), v)
      else
        v%x = sqrt(x(1))
      end if
    case ('log', 'log10')
      if (x(1) <= 0) then
        call outside(at, first, name, x(1), v)
      else if (name == 'log') then
        v%x = log(x(1))
      else
        v%x = log10(x(1))
      end if
    case ('exp')
      if (x(1) > largest_log) then
        call too_large(at, first, v)
      else
        v%x = exp(x(1))
      end if
    case ('mod')
      if (is_zero(x(2))) then
        call fail(at, first, 'mod divides by zero', '', .true.)
        v%kind = unknown_value
      else
        v%x = mod(x(1), x(2))
      end if
    case default
      error stop 'expressions: a function without value'
    end select
  end subroutine parse_function

  recursive subroutine parse_table(text, at, symbols, name, first, v)
    character(*), intent(in) :: text
    type(parse_state), intent(inout) :: at
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
    type(parse_state), intent(inout) :: at
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

  subroutine need_numbers(at, a, b, place)
    !! Both operands must be numbers; a becomes unknown if either is not.
    type(parse_state), intent(inout) :: at
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
    type(parse_state), intent(inout) :: at
    type(value), intent(inout) :: a          ! becomes unknown if it is a word
    integer, intent(in) :: place             ! character that a problem names

    if (a%kind /= word_value) return
    call fail(at, place, 'a number is needed, not the word ' // quoted(a%word), '', .true.)
    a%kind = unknown_value
  end subroutine need_number

  subroutine need_closing(text, at)
    character(*), intent(in) :: text
    type(parse_state), intent(inout) :: at

    if (at%failed_at > 0) return
    if (next_is(text, at, ')')) return
    if (at%pos > len(text)) then
      call fail(at, at%pos, '")" is missing', '')
    else
      call unexpected(text, at)
    end if
  end subroutine need_closing

  subroutine go_deeper(at)
    type(parse_state), intent(inout) :: at

    at%depth = at%depth + 1
    if (at%depth > deepest) call fail(at, at%pos, 'the expression is nested too deeply', &
      'Split it with the help of parameters.')
  end subroutine go_deeper

  subroutine unexpected(text, at)
    character(*), intent(in) :: text
    type(parse_state), intent(inout) :: at

    call skip_blanks(text, at)
    if (text(at%pos:at%pos) == '=') then
      call fail(at, at%pos, '"=" is unexpected', 'Compare by "==".')
    else
      call fail(at, at%pos, quoted(text(at%pos:at%pos)) // ' is unexpected', '')
    end if
  end subroutine unexpected

  subroutine outside(at, place, name, x, v)
    type(parse_state), intent(inout) :: at
    integer, intent(in) :: place
    character(*), intent(in) :: name
    real(wp), intent(in) :: x
    type(value), intent(inout) :: v

    call fail(at, place, name // ' is not defined for ' // write_number(x), '', .true.)
    v%kind = unknown_value
  end subroutine outside

  subroutine too_large(at, place, v)
    type(parse_state), intent(inout) :: at
    integer, intent(in) :: place
    type(value), intent(inout) :: v

    call fail(at, place, 'the result is too large', '', .true.)
    v%kind = unknown_value
  end subroutine too_large

  subroutine fail(at, place, fact, remedy, only_if_live)
    !! Keeps the first problem. Problems of values count only where the value is used.
    type(parse_state), intent(inout) :: at
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

  pure subroutine skip_blanks(text, at)
    character(*), intent(in) :: text
    type(parse_state), intent(inout) :: at

    do while (at%pos <= len(text))
      if (index(blanks, text(at%pos:at%pos)) == 0) return
      at%pos = at%pos + 1
    end do
  end subroutine skip_blanks

  logical function next_is(text, at, symbol)
    !! Takes the symbol if it comes next, after blanks.
    character(*), intent(in) :: text
    type(parse_state), intent(inout) :: at
    character(*), intent(in) :: symbol       ! lower case

    next_is = .false.
    if (at%failed_at > 0) return
    call skip_blanks(text, at)
    next_is = ahead(text, at, symbol)
    if (next_is) at%pos = at%pos + len(symbol)
  end function next_is

  logical function next_is_either(text, at, symbol, other)
    character(*), intent(in) :: text
    type(parse_state), intent(inout) :: at
    character(*), intent(in) :: symbol, other

    next_is_either = next_is(text, at, symbol)
    if (.not. next_is_either) next_is_either = next_is(text, at, other)
  end function next_is_either

  elemental logical function is_zero(x)
    real(wp), intent(in) :: x

    is_zero = equal(x, 0.0_wp)
  end function is_zero

  pure logical function ahead(text, at, symbol)
    character(*), intent(in) :: text
    type(parse_state), intent(in) :: at
    character(*), intent(in) :: symbol

    ahead = .false.
    if (at%pos + len(symbol) - 1 > len(text)) return
    ahead = lower_case(text(at%pos:at%pos+len(symbol)-1)) == symbol
  end function ahead

  pure subroutine set_number(v, x)
    type(value), intent(inout) :: v
    real(wp), intent(in) :: x

    v%kind = number_value
    v%x = x
    if (allocated(v%word)) deallocate (v%word)
  end subroutine set_number

  pure logical function is_name(text)
    !! A letter, then letters, digits and underscores.
    character(*), intent(in) :: text

    is_name = .false.
    if (len(text) == 0) return
    is_name = verify(text, name_characters) == 0 .and. verify(text(1:1), '0123456789_') > 0
  end function is_name

  pure logical function is_function(name)
    character(*), intent(in) :: name         !! lower case

    is_function = any(functions == name) .or. any(more_functions == name)
  end function is_function

  pure logical function is_reserved(name)
    !! Names that a parameter or table cannot have.
    character(*), intent(in) :: name         !! any case

    is_reserved = is_function(lower_case(name)) .or. lower_case(name) == 'pi'
  end function is_reserved

  pure function value_text(v) result(text)
    type(value), intent(in) :: v
    character(:), allocatable :: text        !! the word, or the number (whole ones without a point)

    select case (v%kind)
    case (word_value);   text = v%word
    case (number_value); text = write_number(v%x)
    case default;        text = ''
    end select
  end function value_text

  subroutine no_symbol(self, name, v, found)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: name
    type(value), intent(out) :: v
    logical, intent(out) :: found

    associate (unused => self, also => name)
    end associate
    v%kind = unknown_value
    found = .false.
  end subroutine no_symbol

  logical function no_table(self, name)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: name

    associate (unused => self, also => name)
    end associate
    no_table = .false.
  end function no_table

  logical function no_key(self, table, column, key)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: table
    logical, intent(in) :: column
    character(*), intent(in) :: key

    associate (unused => self, also => table, again => column, too => key)
    end associate
    no_key = .false.
  end function no_key

  subroutine no_look_up(self, table, row, column, v, fact, remedy)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: table, row, column
    type(value), intent(out) :: v
    character(:), allocatable, intent(out) :: fact, remedy

    associate (unused => self, also => row, too => column)
    end associate
    v%kind = unknown_value
    fact = 'there is no table ' // quoted(table)
    remedy = ''
  end subroutine no_look_up

  function no_hint(self, name) result(hint)
    class(no_symbols), intent(in) :: self
    character(*), intent(in) :: name
    character(:), allocatable :: hint

    associate (unused => self, also => name)
    end associate
    hint = ''
  end function no_hint
end module expressions
