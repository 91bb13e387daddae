module host_memory
  !! FEAP's two blank arrays: what stands where.
  implicit none
  private
  public :: reserve_real, reserve_integer, forget_all

  integer(8), save :: next_real = 1, next_integer = 1

contains

  subroutine forget_all()
    next_real = 1
    next_integer = 1
  end subroutine forget_all

  subroutine reserve_real(slot, n)
    integer, intent(in) :: slot, n         !! pointer of FEAP; length
    include 'pointer.h'
    include 'comblk.h'

    np(slot) = next_real
    next_real = next_real + n
    if (next_real > size_of_hr) error stop 'host: hr is too small'
    hr(np(slot):next_real - 1) = 0
  end subroutine reserve_real

  subroutine reserve_integer(slot, n)
    integer, intent(in) :: slot, n
    include 'pointer.h'
    include 'comblk.h'

    np(slot) = next_integer
    next_integer = next_integer + n
    if (next_integer > size_of_mr) error stop 'host: mr is too small'
    mr(np(slot):next_integer - 1) = 0
  end subroutine reserve_integer
end module host_memory
