module number_text
  !! Numbers to and from the text of decks and mesh files, fast enough for millions of lines and rounded
  !! correctly: up to 15 digits with small exponents are exact in double arithmetic (mantissa below
  !! 2^53, power of ten below 10^23), the rest goes through the C library's strtod. Exponents may be
  !! written with E or D.
  use, intrinsic :: iso_c_binding, only: c_char, c_double, c_null_char, c_null_ptr, c_ptr
  use kinds, only: wp, i8
  implicit none (type, external)
  private
  public :: read_number, write_number, equal

  integer, parameter :: largest_power = 22
  real(wp), parameter :: power_of_ten(0:largest_power) = [ &
    1e0_wp, 1e1_wp, 1e2_wp, 1e3_wp, 1e4_wp, 1e5_wp, 1e6_wp, 1e7_wp, 1e8_wp, 1e9_wp, 1e10_wp, &
      1e11_wp, &
    1e12_wp, 1e13_wp, 1e14_wp, 1e15_wp, 1e16_wp, 1e17_wp, 1e18_wp, 1e19_wp, 1e20_wp, 1e21_wp, &
      1e22_wp]

  interface
    pure function c_strtod(text, last) result(x) bind(c, name='strtod')
      import :: c_char, c_double, c_ptr
      implicit none (type, external)
      character(kind=c_char), intent(in) :: text(*)
      type(c_ptr), value :: last
      real(c_double) :: x
    end function c_strtod
  end interface

contains

  pure subroutine read_number(text, x, used)
    !! The longest number that the text begins with.
    character(*), intent(in) :: text    !! no blanks in front
    real(wp), intent(out) :: x          !! its value; 0 if there is none
    integer, intent(out) :: used        !! its characters; 0: no number; < 0: too large
    integer(i8) :: mantissa
    integer :: i, n, digits, scale, exponent, leading, kept
    logical :: negative, negative_exponent, point

    x = 0
    used = 0
    n = len(text)
    if (n == 0) return
    i = 1
    negative = text(1:1) == '-'
    if (negative .or. text(1:1) == '+') i = 2

    mantissa = 0
    digits = 0      ! all digits
    kept = 0        ! significant digits
    scale = 0       ! digits after the point
    point = .false.
    do while (i <= n)
      select case (text(i:i))
      case ('0':'9')
        digits = digits + 1
        if (kept > 0 .or. text(i:i) /= '0') kept = kept + 1
        if (kept <= 18) mantissa = 10*mantissa + (iachar(text(i:i)) - 48)
        if (point) scale = scale + 1
      case ('.')
        if (point .or. begins_operator(text(i:))) exit
        point = .true.
      case default
        exit
      end select
      i = i + 1
    end do
    if (digits == 0) return
    used = i - 1

    exponent = 0
    if (i < n) then
      if (scan(text(i:i), 'eEdD') > 0) then
        i = i + 1
        negative_exponent = text(i:i) == '-'
        if (negative_exponent .or. text(i:i) == '+') i = i + 1
        do while (i <= n)
          if (text(i:i) < '0' .or. text(i:i) > '9') exit
          if (exponent < 100000) exponent = 10*exponent + (iachar(text(i:i)) - 48)
          used = i
          i = i + 1
        end do
        if (negative_exponent) exponent = -exponent
      end if
    end if

    if (kept == 0) then
      if (negative) x = -x     ! the sign of zero is kept
      return
    end if
    if (kept <= 18 .and. mantissa < 9007199254740992_i8 .and. &
      abs(exponent - scale) <= largest_power) then
      if (exponent >= scale) then
        x = real(mantissa, wp)*power_of_ten(exponent - scale)
      else
        x = real(mantissa, wp)/power_of_ten(scale - exponent)
      end if
      if (negative) x = -x
      return
    end if
    leading = kept - scale + exponent   ! the value is below 10^leading
    if (leading > 309) then
      used = -used
    else if (leading == 309 .and. text_above_largest(text(1:used))) then
      used = -used
    else if (leading > -400) then
      x = by_library(text(1:used))
    end if
  end subroutine read_number

  pure logical function text_above_largest(text)
    !! Does a number between 1e308 and 1e309 exceed the largest one? strtod would raise an
    !! exception.
    character(*), intent(in) :: text
    character(*), parameter :: largest = '17976931348623157'
    character(len(largest)) :: digits
    integer :: i, n

    digits = repeat('0', len(digits))
    n = 0
    do i = 1, len(text)
      if (n == len(digits) .or. scan(text(i:i), 'eEdD') > 0) exit
      if (scan(text(i:i), '0123456789') == 0) cycle
      if (n == 0 .and. text(i:i) == '0') cycle
      n = n + 1
      digits(n:n) = text(i:i)
    end do
    text_above_largest = digits > largest
  end function text_above_largest

  pure logical function begins_operator(text)
    !! Is the point at the beginning that of .and., .or.? (`1.and.2`, but `1.d0` is a number)
    character(*), intent(in) :: text

    begins_operator = .false.
    if (len(text) < 3) return
    select case (text(2:2))
    case ('a', 'A', 'o', 'O', 'n', 'N')
      begins_operator = .true.
    end select
  end function begins_operator

  pure function by_library(text) result(x)
    character(*), intent(in) :: text
    real(wp) :: x
    character(len(text) + 1, c_char) :: buffer
    integer :: i

    buffer = text // c_null_char
    i = scan(buffer, 'dD')
    if (i > 0) buffer(i:i) = 'e'
    x = c_strtod(buffer, c_null_ptr)
  end function by_library

  elemental logical function equal(a, b)
    !! Exactly equal, on purpose.
    real(wp), intent(in) :: a, b

    equal = a <= b .and. a >= b
  end function equal

  pure function write_number(x) result(text)
    !! The shortest text that reads back as the same number; whole numbers without a point.
    real(wp), intent(in) :: x
    character(:), allocatable :: text
    character(32) :: buffer
    character(12) :: form
    real(wp) :: again
    integer :: digits, used

    if (abs(x) < 1e15_wp) then
      if (equal(aint(x), x)) then
        write (buffer, '(i0)') int(x, i8)
        text = trim(buffer)
        return
      end if
    end if
    do digits = 1, 17
      write (form, '(a,i0,a)') '(es32.', digits - 1, 'e3)'
      write (buffer, form) x
      buffer = adjustl(buffer)
      call read_number(trim(buffer), again, used)
      if (used == len_trim(buffer) .and. equal(again, x)) exit
    end do
    text = trim(buffer)
    if (abs(x) < 1e-4_wp .or. abs(x) >= 1e15_wp) return
    write (form, '(a,i0,a)') '(f32.', max(1, min(digits, 17) - 1 - floor(log10(abs(x)))), ')'
    write (buffer, form) x
    buffer = adjustl(buffer)
    call read_number(trim(buffer), again, used)
    if (used == len_trim(buffer) .and. equal(again, x)) text = trim(buffer)
  end function write_number
end module number_text
