module feap_host
  !! What the adapters ask of FEAP besides the arguments of their routines: the next record of the deck, messages on its
  !! output, its expressions, the end of a run.
  use kinds, only: wp
  implicit none
  private
  public :: this_record, next_record, expression, fail, note

  integer, parameter, public :: record_length = 256

contains

  subroutine this_record(line)
    character(record_length), intent(out) :: line   !! the record that FEAP has just read
    include 'comfil.h'

    line = record
  end subroutine this_record

  subroutine next_record(line)
    character(record_length), intent(out) :: line   !! blank: the end of a data set
    include 'comfil.h'
    character(15) :: words(1)
    real(wp) :: numbers(1)
    logical :: bad
    logical, external :: tinput

    bad = tinput(words, 0, numbers, 0)
    line = record
  end subroutine next_record

  function expression(text) result(value)
    !! A number as FEAP reads it: expressions with the deck's parameters.
    character(*), intent(in) :: text
    real(wp) :: value
    character(75) :: padded
    external :: setval

    padded = text
    value = 0
    call setval(padded, len_trim(padded), value)
  end function expression

  subroutine fail(text)
    !! FEAP's way of error: a line on output file and screen, the end of the run.
    character(*), intent(in) :: text                !! place, fact, remedy
    include 'iofile.h'
    external :: plstop

    write (iow, '(/2a)') ' *ERROR* ', text
    write (*, '(/2a)') ' *ERROR* ', text
    call plstop(.true.)
  end subroutine fail

  subroutine note(text)
    character(*), intent(in) :: text                !! a line for the output file
    include 'iofile.h'

    write (iow, '(5x,a)') text
  end subroutine note
end module feap_host
