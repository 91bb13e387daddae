module report
  !! One line a number: `group|what|unit|value`, which tests/studies/benchmark.py turns into tables.
  use, intrinsic :: iso_fortran_env, only: output_unit
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: put, text

contains

  subroutine put(group, what, unit, value)
    character(*), intent(in) :: group    !! table
    character(*), intent(in) :: what     !! row
    character(*), intent(in) :: unit     !! column
    real(wp), intent(in) :: value

    write (output_unit, '(a,es12.4)') group//'|'//what//'|'//unit//'|', value
    flush (output_unit)
  end subroutine put

  pure function text(n) result(digits)
    integer, intent(in) :: n
    character(:), allocatable :: digits
    character(12) :: buffer

    write (buffer, '(i0)') n
    digits = trim(buffer)
  end function text
end module report
