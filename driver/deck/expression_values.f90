module expression_values
  !! What an expression of a deck can be worth: a number, a word, or unknown where its problem was reported already.
  use kinds, only: wp
  use number_text, only: write_number
  implicit none (type, external)
  private
  public :: value, unknown_value, number_value, word_value, set_number, value_text

  integer, parameter :: unknown_value = 0   !! its problem has been reported
  integer, parameter :: number_value = 1
  integer, parameter :: word_value = 2

  type :: value
    integer :: kind = unknown_value
    real(wp) :: x = 0                       !! if it is a number
    character(:), allocatable :: word       !! if it is a word
  end type value

contains

  pure subroutine set_number(v, x)
    type(value), intent(inout) :: v
    real(wp), intent(in) :: x

    v%kind = number_value
    v%x = x
    if (allocated(v%word)) deallocate (v%word)
  end subroutine set_number

  pure function value_text(v) result(text)
    type(value), intent(in) :: v
    character(:), allocatable :: text        !! the word, or the number (whole ones without a point)

    select case (v%kind)
    case (word_value);   text = v%word
    case (number_value); text = write_number(v%x)
    case default;        text = ''
    end select
  end function value_text
end module expression_values
