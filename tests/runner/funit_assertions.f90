module funit_assertions
  !! The assertions. Each throws at most one failure, which names the first element that differs.
  !! Reals and integers have rank 0 to 2; both sides have one shape, or the first one is a scalar.
  use, intrinsic :: iso_fortran_env, only: real64, int32, int64
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_is_finite
  use funit_exceptions, only: SourceLocation, throw, catch
  implicit none (type, external)
  private
  public :: assertEqual, assertNotEqual, assertRelativelyEqual, assertLessThan, &
    assertLessThanOrEqual, assertGreaterThan, assertGreaterThanOrEqual, assertTrue, assertFalse, &
    assertAll, assertAny, assertIsNaN, assertIsFinite, assertSameShape, assertFail, &
    assertExceptionRaised

  interface assertEqual
    module procedure equal_real, equal_real_exactly, equal_int32, equal_int64, equal_logical, &
      equal_string, equal_strings
  end interface assertEqual
  interface assertNotEqual
    module procedure not_equal_real, not_equal_int32, not_equal_int64
  end interface assertNotEqual
  interface assertLessThan
    module procedure less_real, less_int32, less_int64
  end interface assertLessThan
  interface assertLessThanOrEqual
    module procedure less_or_equal_real, less_or_equal_int32, less_or_equal_int64
  end interface assertLessThanOrEqual
  interface assertGreaterThan
    module procedure greater_real, greater_int32, greater_int64
  end interface assertGreaterThan
  interface assertGreaterThanOrEqual
    module procedure greater_or_equal_real, greater_or_equal_int32, greater_or_equal_int64
  end interface assertGreaterThanOrEqual
  interface assertTrue
    module procedure true_scalar, true_array
  end interface assertTrue
  interface assertFalse
    module procedure false_scalar, false_array
  end interface assertFalse
  interface assertExceptionRaised
    module procedure raised_any, raised_message
  end interface assertExceptionRaised

  ! The relations, by the name under which a failure reports them.
  character(*), parameter :: equal = 'equal to', different = 'different from', less = 'less than', &
    less_or_equal = 'at most', greater = 'greater than', greater_or_equal = 'at least', &
    relatively_equal = 'relatively equal to'

contains

  ! Reals.

  subroutine equal_real(expected, actual, tolerance, message, location)
    real(real64), intent(in) :: expected(..), actual(..), tolerance
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_reals(equal, expected, actual, tolerance, message, location)
  end subroutine equal_real

  subroutine equal_real_exactly(expected, actual, message, location)
    real(real64), intent(in) :: expected(..), actual(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_reals(equal, expected, actual, 0.0_real64, message, location)
  end subroutine equal_real_exactly

  subroutine assertRelativelyEqual(expected, actual, tolerance, message, location)
    real(real64), intent(in) :: expected(..), actual(..), tolerance
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_reals(relatively_equal, expected, actual, tolerance, message, location)
  end subroutine assertRelativelyEqual

  subroutine not_equal_real(expected, actual, message, location)
    real(real64), intent(in) :: expected(..), actual(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_reals(different, expected, actual, 0.0_real64, message, location)
  end subroutine not_equal_real

  subroutine less_real(lhs, rhs, message, location)
    real(real64), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_reals(less, lhs, rhs, 0.0_real64, message, location)
  end subroutine less_real

  subroutine less_or_equal_real(lhs, rhs, message, location)
    real(real64), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_reals(less_or_equal, lhs, rhs, 0.0_real64, message, location)
  end subroutine less_or_equal_real

  subroutine greater_real(lhs, rhs, message, location)
    real(real64), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_reals(greater, lhs, rhs, 0.0_real64, message, location)
  end subroutine greater_real

  subroutine greater_or_equal_real(lhs, rhs, message, location)
    real(real64), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_reals(greater_or_equal, lhs, rhs, 0.0_real64, message, location)
  end subroutine greater_or_equal_real

  subroutine assertIsNaN(x, message, location)
    real(real64), intent(in) :: x
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    if (.not. ieee_is_nan(x)) call fail('expected NaN, found ' // real_text(x), message, location)
  end subroutine assertIsNaN

  subroutine assertIsFinite(x, message, location)
    real(real64), intent(in) :: x
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    if (.not. ieee_is_finite(x)) call fail('expected a finite number, found ' // real_text(x), &
      message, location)
  end subroutine assertIsFinite

  ! Integers.

  subroutine equal_int32(expected, actual, message, location)
    integer(int32), intent(in) :: expected(..), actual(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(equal, flat_int32(expected), shape(expected), flat_int32(actual), &
      shape(actual), message, location)
  end subroutine equal_int32

  subroutine equal_int64(expected, actual, message, location)
    integer(int64), intent(in) :: expected(..), actual(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(equal, flat_int64(expected), shape(expected), flat_int64(actual), &
      shape(actual), message, location)
  end subroutine equal_int64

  subroutine not_equal_int32(expected, actual, message, location)
    integer(int32), intent(in) :: expected(..), actual(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(different, flat_int32(expected), shape(expected), flat_int32(actual), &
      shape(actual), message, location)
  end subroutine not_equal_int32

  subroutine not_equal_int64(expected, actual, message, location)
    integer(int64), intent(in) :: expected(..), actual(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(different, flat_int64(expected), shape(expected), flat_int64(actual), &
      shape(actual), message, location)
  end subroutine not_equal_int64

  subroutine less_int32(lhs, rhs, message, location)
    integer(int32), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(less, flat_int32(lhs), shape(lhs), flat_int32(rhs), shape(rhs), &
      message, location)
  end subroutine less_int32

  subroutine less_int64(lhs, rhs, message, location)
    integer(int64), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(less, flat_int64(lhs), shape(lhs), flat_int64(rhs), shape(rhs), &
      message, location)
  end subroutine less_int64

  subroutine less_or_equal_int32(lhs, rhs, message, location)
    integer(int32), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(less_or_equal, flat_int32(lhs), shape(lhs), flat_int32(rhs), &
      shape(rhs), message, location)
  end subroutine less_or_equal_int32

  subroutine less_or_equal_int64(lhs, rhs, message, location)
    integer(int64), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(less_or_equal, flat_int64(lhs), shape(lhs), flat_int64(rhs), &
      shape(rhs), message, location)
  end subroutine less_or_equal_int64

  subroutine greater_int32(lhs, rhs, message, location)
    integer(int32), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(greater, flat_int32(lhs), shape(lhs), flat_int32(rhs), shape(rhs), &
      message, location)
  end subroutine greater_int32

  subroutine greater_int64(lhs, rhs, message, location)
    integer(int64), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(greater, flat_int64(lhs), shape(lhs), flat_int64(rhs), shape(rhs), &
      message, location)
  end subroutine greater_int64

  subroutine greater_or_equal_int32(lhs, rhs, message, location)
    integer(int32), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(greater_or_equal, flat_int32(lhs), shape(lhs), flat_int32(rhs), &
      shape(rhs), message, location)
  end subroutine greater_or_equal_int32

  subroutine greater_or_equal_int64(lhs, rhs, message, location)
    integer(int64), intent(in) :: lhs(..), rhs(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(greater_or_equal, flat_int64(lhs), shape(lhs), flat_int64(rhs), &
      shape(rhs), message, location)
  end subroutine greater_or_equal_int64

  subroutine assertSameShape(expected, actual, message, location)
    integer, intent(in) :: expected(:), actual(:)  !! two shapes
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (size(expected) == size(actual)) then
      if (all(expected == actual)) return
    end if
    call fail('expected shape ' // list_text(expected) // ', found ' // list_text(actual), &
      message, location)
  end subroutine assertSameShape

  ! Logicals, strings, exceptions.

  subroutine equal_logical(expected, actual, message, location)
    logical, intent(in) :: expected(..), actual(..)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call compare_integers(equal, flat_logical(expected), shape(expected), flat_logical(actual), &
      shape(actual), message, location, as_logical=.true.)
  end subroutine equal_logical

  subroutine true_scalar(condition, message, location)
    logical, intent(in) :: condition
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    if (.not. condition) call fail('expected true, found false', message, location)
  end subroutine true_scalar

  subroutine true_array(conditions, message, location)
    logical, intent(in) :: conditions(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    if (.not. all(conditions)) then
      call fail('expected true, found false at ' // list_text(findloc(conditions, .false.)), &
        message, location)
    end if
  end subroutine true_array

  subroutine false_scalar(condition, message, location)
    logical, intent(in) :: condition
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    if (condition) call fail('expected false, found true', message, location)
  end subroutine false_scalar

  subroutine false_array(conditions, message, location)
    logical, intent(in) :: conditions(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    if (any(conditions)) then
      call fail('expected false, found true at ' // list_text(findloc(conditions, .true.)), &
        message, location)
    end if
  end subroutine false_array

  subroutine assertAll(conditions, message, location)
    logical, intent(in) :: conditions(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    call true_array(conditions, message, location)
  end subroutine assertAll

  subroutine assertAny(conditions, message, location)
    logical, intent(in) :: conditions(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    if (.not. any(conditions)) call fail('expected a true one, found none', message, location)
  end subroutine assertAny

  subroutine equal_string(expected, actual, message, location)
    !! Blanks at both ends do not count, as in pFUnit.
    character(*), intent(in) :: expected, actual
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (trim(adjustl(expected)) == trim(adjustl(actual))) return
    call fail('expected "' // trim(expected) // '", found "' // trim(actual) // '"', message, &
      location)
  end subroutine equal_string

  subroutine equal_strings(expected, actual, message, location)
    character(*), intent(in) :: expected(:), actual(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    integer :: i

    if (size(expected) /= size(actual)) then
      call fail('expected shape ' // list_text(shape(expected)) // ', found ' // &
        list_text(shape(actual)), message, location)
      return
    end if
    do i = 1, size(expected)
      if (trim(adjustl(expected(i))) == trim(adjustl(actual(i)))) cycle
      call fail('expected "' // trim(expected(i)) // '", found "' // trim(actual(i)) // &
        '" at ' // list_text([i]), message, location)
      return
    end do
  end subroutine equal_strings

  subroutine assertFail(message, location)
    character(*), intent(in) :: message
    type(SourceLocation), intent(in), optional :: location
    call throw(message, location)
  end subroutine assertFail

  subroutine raised_any(location)
    type(SourceLocation), intent(in), optional :: location
    if (.not. catch()) call throw('expected an exception, found none', location)
  end subroutine raised_any

  subroutine raised_message(message, location)
    character(*), intent(in) :: message
    type(SourceLocation), intent(in), optional :: location
    if (.not. catch(message)) call throw('expected the exception "' // message // &
      '", found none', location)
  end subroutine raised_message

  ! The comparisons behind them.

  subroutine compare_reals(relation, lhs, rhs, tolerance, message, location)
    character(*), intent(in) :: relation
    real(real64), intent(in) :: lhs(..), rhs(..), tolerance
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    real(real64), allocatable :: l(:), r(:)
    integer :: i
    character(:), allocatable :: text

    if (.not. conformable(shape(lhs), shape(rhs), message, location)) return
    l = flat_real(lhs)
    r = flat_real(rhs)
    if (rank(lhs) == 0) l = spread(l(1), 1, size(r))
    if (relation == relatively_equal .and. any(l == 0)) then
      call fail('expected zero, to which nothing is relatively equal', message, location)
      return
    end if
    do i = 1, size(r)
      if (holds(l(i), r(i))) cycle
      text = 'expected ' // real_text(l(i)) // ' ' // relation // ' ' // real_text(r(i))
      if (relation == equal .or. relation == relatively_equal) then
        text = 'expected ' // real_text(l(i)) // ', found ' // real_text(r(i))
        if (ieee_is_finite(l(i)) .and. ieee_is_finite(r(i))) then
          text = text // ', difference ' // real_text(r(i) - l(i)) // ' (' // &
            trim(merge('relative tolerance', 'tolerance         ', &
            relation == relatively_equal)) // ' ' // &
            real_text(tolerance) // ')'
        end if
      end if
      call fail(text // place(i, shape(rhs)), message, location)
      return
    end do

  contains

    function holds(a, b) result(yes)
      !! A NaN stands in no relation, and no comparison sees one, so that such tests survive
      !! trapping.
      real(real64), intent(in) :: a, b
      logical :: yes

      yes = .false.
      if (ieee_is_nan(a) .or. ieee_is_nan(b)) return
      select case (relation)
      case (equal)
        yes = a == b
        if (.not. yes .and. ieee_is_finite(a) .and. ieee_is_finite(b)) yes = abs(b - a) <= tolerance
      case (relatively_equal)
        if (ieee_is_finite(a) .and. ieee_is_finite(b)) yes = abs(b - a) <= tolerance * abs(a)
      case (different);        yes = a /= b
      case (less);             yes = a < b
      case (less_or_equal);    yes = a <= b
      case (greater);          yes = a > b
      case (greater_or_equal); yes = a >= b
      end select
    end function holds
  end subroutine compare_reals

  subroutine compare_integers(relation, lhs, lhs_shape, rhs, rhs_shape, message, location, &
    as_logical)
    character(*), intent(in) :: relation
    integer(int64), intent(in) :: lhs(:), rhs(:)
    integer, intent(in) :: lhs_shape(:), rhs_shape(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    logical, intent(in), optional :: as_logical  !! print 1 and 0 as true and false
    integer(int64), allocatable :: l(:)
    integer :: i
    logical :: holds
    character(:), allocatable :: text

    if (.not. conformable(lhs_shape, rhs_shape, message, location)) return
    l = lhs
    if (size(lhs_shape) == 0) l = spread(lhs(1), 1, size(rhs))
    do i = 1, size(rhs)
      holds = .false.
      select case (relation)
      case (equal);            holds = l(i) == rhs(i)
      case (different);        holds = l(i) /= rhs(i)
      case (less);             holds = l(i) < rhs(i)
      case (less_or_equal);    holds = l(i) <= rhs(i)
      case (greater);          holds = l(i) > rhs(i)
      case (greater_or_equal); holds = l(i) >= rhs(i)
      end select
      if (holds) cycle
      if (relation /= equal) then
        text = 'expected ' // integer_text(l(i)) // ' ' // relation // ' ' // integer_text(rhs(i))
      else if (present(as_logical)) then
        text = merge('expected true, found false', 'expected false, found true', l(i) == 1)
      else
        text = 'expected ' // integer_text(l(i)) // ', found ' // integer_text(rhs(i)) // &
          ', difference ' // integer_text(rhs(i) - l(i))
      end if
      call fail(text // place(i, rhs_shape), message, location)
      return
    end do
  end subroutine compare_integers

  function conformable(lhs, rhs, message, location) result(yes)
    !! Throws if the shapes differ and the first is not a scalar's, or if the rank is above two.
    integer, intent(in) :: lhs(:), rhs(:)
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location
    logical :: yes

    if (size(rhs) > 2) then
      call fail('ranks above 2 are not compared by this runner', message, location)
      yes = .false.
      return
    end if
    yes = size(lhs) == 0
    if (.not. yes .and. size(lhs) == size(rhs)) yes = all(lhs == rhs)
    if (.not. yes) call fail('expected shape ' // list_text(lhs) // ', found ' // &
      list_text(rhs), message, location)
  end function conformable

  subroutine fail(what, message, location)
    character(*), intent(in) :: what
    character(*), intent(in), optional :: message
    type(SourceLocation), intent(in), optional :: location

    if (present(message)) then
      call throw(trim(message) // ': ' // what, location)
    else
      call throw(what, location)
    end if
  end subroutine fail

  pure function flat_real(x) result(flat)
    real(real64), intent(in) :: x(..)
    real(real64), allocatable :: flat(:)

    select rank (x)
    rank (0); flat = [x]
    rank (1); flat = x
    rank (2); flat = reshape(x, [size(x)])
    rank default; allocate (flat(0))
    end select
  end function flat_real

  pure function flat_int32(x) result(flat)
    integer(int32), intent(in) :: x(..)
    integer(int64), allocatable :: flat(:)

    select rank (x)
    rank (0); flat = [int(x, int64)]
    rank (1); flat = int(x, int64)
    rank (2); flat = int(reshape(x, [size(x)]), int64)
    rank default; allocate (flat(0))
    end select
  end function flat_int32

  pure function flat_int64(x) result(flat)
    integer(int64), intent(in) :: x(..)
    integer(int64), allocatable :: flat(:)

    select rank (x)
    rank (0); flat = [x]
    rank (1); flat = x
    rank (2); flat = reshape(x, [size(x)])
    rank default; allocate (flat(0))
    end select
  end function flat_int64

  pure function flat_logical(x) result(flat)
    logical, intent(in) :: x(..)
    integer(int64), allocatable :: flat(:)

    select rank (x)
    rank (0); flat = [merge(1_int64, 0_int64, x)]
    rank (1); flat = merge(1_int64, 0_int64, x)
    rank (2); flat = merge(1_int64, 0_int64, reshape(x, [size(x)]))
    rank default; allocate (flat(0))
    end select
  end function flat_logical

  pure function place(i, extents) result(text)
    !! ' at [2,1]' for the i-th element of an array, nothing for a scalar.
    integer, intent(in) :: i, extents(:)
    character(:), allocatable :: text

    select case (size(extents))
    case (0);     text = ''
    case (1);     text = ' at ' // list_text([i])
    case default; text = ' at ' // list_text([1 + modulo(i - 1, extents(1)), &
      1 + (i - 1) / extents(1)])
    end select
  end function place

  pure function list_text(list) result(text)
    integer, intent(in) :: list(:)
    character(:), allocatable :: text
    integer :: i

    text = '['
    do i = 1, size(list)
      if (i > 1) text = text // ','
      text = text // integer_text(int(list(i), int64))
    end do
    text = text // ']'
  end function list_text

  pure function integer_text(value) result(text)
    integer(int64), intent(in) :: value
    character(:), allocatable :: text
    character(24) :: buffer

    write (buffer, '(i0)') value
    text = trim(buffer)
  end function integer_text

  pure function real_text(value) result(text)
    real(real64), intent(in) :: value
    character(:), allocatable :: text
    character(32) :: buffer

    write (buffer, '(g0)') value
    text = trim(buffer)
  end function real_text
end module funit_assertions
