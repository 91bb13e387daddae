module expression_functions
  !! The functions and the power of expressions. None raises a floating-point exception: what would is told as a fact.
  use kinds, only: wp
  use number_text, only: write_number, equal
  implicit none (type, external)
  private
  public :: functions, most_arguments, too_large
  public :: is_function, argument_range, function_value, power, is_zero

  integer, parameter :: most_arguments = 20
  real(wp), parameter :: largest_log = 709.7_wp
  character(*), parameter :: too_large = 'the result is too large'
  character(5), parameter :: functions(18) = [character(5) :: 'sin', 'cos', 'tan', 'asin', 'acos', 'atan', &
    'atan2', 'sqrt', 'exp', 'log', 'log10', 'abs', 'min', 'max', 'int', 'nint', 'floor', 'mod']

contains

  pure logical function is_function(name)
    character(*), intent(in) :: name         !! lower case

    is_function = any(functions == name)
  end function is_function

  pure subroutine argument_range(name, least, most)
    character(*), intent(in) :: name         !! of a function
    integer, intent(out) :: least, most      !! arguments that it takes

    least = 1
    most = 1
    select case (name)
    case ('atan2', 'mod')
      least = 2
      most = 2
    case ('min', 'max')
      most = most_arguments
    end select
  end subroutine argument_range

  subroutine function_value(name, x, y, fact)
    character(*), intent(in) :: name                     !! of a function, lower case
    real(wp), intent(in) :: x(:)                         !! arguments, as many as it takes
    real(wp), intent(out) :: y                           !! 0 if it has no value
    character(:), allocatable, intent(out) :: fact       !! why it has no value, else ''

    fact = ''
    y = 0
    select case (name)
    case ('sin');   y = sin(x(1))
    case ('cos');   y = cos(x(1))
    case ('tan');   y = tan(x(1))
    case ('atan');  y = atan(x(1))
    case ('abs');   y = abs(x(1))
    case ('min');   y = minval(x)
    case ('max');   y = maxval(x)
    case ('int');   y = aint(x(1))
    case ('nint');  y = anint(x(1))
    case ('floor')
      y = aint(x(1))
      if (y > x(1)) y = y - 1
    case ('asin', 'acos')
      if (abs(x(1)) > 1) then
        fact = undefined(name, x(1))
      else if (name == 'asin') then
        y = asin(x(1))
      else
        y = acos(x(1))
      end if
    case ('atan2')
      if (.not. all(is_zero(x(1:2)))) then
        y = atan2(x(1), x(2))
      else
        fact = undefined(name, 0.0_wp)
      end if
    case ('sqrt')
      if (x(1) < 0) then
        fact = undefined(name, x(1))
      else
        y = sqrt(x(1))
      end if
    case ('log', 'log10')
      if (x(1) <= 0) then
        fact = undefined(name, x(1))
      else if (name == 'log') then
        y = log(x(1))
      else
        y = log10(x(1))
      end if
    case ('exp')
      if (x(1) > largest_log) then
        fact = too_large
      else
        y = exp(x(1))
      end if
    case ('mod')
      if (is_zero(x(2))) then
        fact = 'mod divides by zero'
      else
        y = mod(x(1), x(2))
      end if
    case default
      error stop 'expression_functions: a function without value'
    end select
  end subroutine function_value

  subroutine power(a, b, y, fact)
    !! y = a^b.
    real(wp), intent(in) :: a, b
    real(wp), intent(out) :: y
    character(:), allocatable, intent(out) :: fact       !! why it has no value, else ''
    real(wp) :: magnitude
    logical :: odd

    fact = ''
    y = 0
    if (is_zero(b)) then
      y = 1
    else if (is_zero(a)) then
      y = a
      if (b < 0) fact = 'zero is raised to a negative power'
    else if (a < 0 .and. .not. equal(aint(b), b)) then
      fact = 'a negative number is raised to a broken power'
    else
      odd = .false.
      if (a < 0) odd = equal(modulo(b, 2.0_wp), 1.0_wp)
      magnitude = log(abs(a))
      if (is_zero(magnitude)) then
        y = 1
      else if (abs(b) > largest_log/abs(magnitude)) then
        if ((b > 0) .eqv. (magnitude > 0)) fact = too_large
      else
        y = abs(a)**b
      end if
      if (odd) y = -y
    end if
  end subroutine power

  function undefined(name, x) result(fact)
    character(*), intent(in) :: name
    real(wp), intent(in) :: x
    character(:), allocatable :: fact

    fact = name // ' is not defined for ' // write_number(x)
  end function undefined

  elemental logical function is_zero(x)
    real(wp), intent(in) :: x

    is_zero = equal(x, 0.0_wp)
  end function is_zero
end module expression_functions
