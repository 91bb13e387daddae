module shortest_text
  !! Numbers as short texts that read back to the same bits.
  use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_is_finite
  use kinds, only: wp, i8
  implicit none (type, external)
  private
  public :: real_text, integer_text

  interface integer_text
    module procedure :: integer_text_default, integer_text_long
  end interface integer_text

contains

  pure function real_text(value) result(text)
    !! 15 significant digits if they suffice, else 16 or 17; trailing zeros dropped: 2.0E-02.
    real(wp), intent(in) :: value
    character(:), allocatable :: text

    character(11), parameter :: forms(3) = [character(11) :: '(es24.14e3)', '(es24.15e3)', '(es24.16e3)']
    character(24) :: buffer
    real(wp) :: again
    integer :: i, point, last, power

    if (ieee_is_nan(value)) then
      text = 'nan'
      return
    else if (.not. ieee_is_finite(value)) then
      text = merge('inf ', '-inf', value > 0)
      text = trim(text)
      return
    end if
    do i = merge(size(forms), 1, abs(value) > 0.99_wp*huge(value)), size(forms)  ! fewer digits might round beyond huge
      write (buffer, forms(i)) value
      read (buffer, *) again
      if (transfer(again, 0_i8) == transfer(value, 0_i8)) exit
    end do
    buffer = adjustl(buffer)
    power = index(buffer, 'E')
    point = index(buffer, '.')
    last = power - 1
    do while (buffer(last:last) == '0' .and. last > point + 1)
      last = last - 1
    end do
    if (buffer(power+2:power+2) == '0') then
      text = buffer(:last)//buffer(power:power+1)//buffer(power+3:power+4)
    else
      text = buffer(:last)//buffer(power:power+4)
    end if
  end function real_text

  pure function integer_text_default(value) result(text)
    integer, intent(in) :: value
    character(:), allocatable :: text

    text = integer_text_long(int(value, i8))
  end function integer_text_default

  pure function integer_text_long(value) result(text)
    integer(i8), intent(in) :: value
    character(:), allocatable :: text

    character(24) :: buffer

    write (buffer, '(i0)') value
    text = trim(buffer)
  end function integer_text_long
end module shortest_text
