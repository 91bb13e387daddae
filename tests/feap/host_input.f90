! A small host of our own in the manner of FEAP, to run the adapters of elements/feap where FEAP is not installed. This
! file: what a deck is read with. Everything here is called as FEAP's routines of the same names are.

module host_deck
  !! The deck's unit and how the run ends.
  implicit none (type, external)
  public

  integer, parameter :: deck_unit = 15
  logical :: at_end = .false.
end module host_deck

logical function tinput(tx, mt, td, nn)
  !! The next record; its first mt items as texts of 15 letters, the next nn as numbers.
  use host_deck, only: deck_unit, at_end
  use feap_items, only: item_list, split_record
  implicit none
  integer, intent(in) :: mt, nn
  character(15), intent(inout) :: tx(*)
  real(8), intent(inout) :: td(*)
  include 'comfil.h'
  type(item_list) :: items
  integer :: i, code

  tinput = .false.
  read (deck_unit, '(a)', iostat=code) record
  at_end = code /= 0
  if (at_end) record = ' '
  if (mt + nn == 0) return
  call split_record(record, items)
  do i = 1, mt
    tx(i) = items%text(i)
  end do
  do i = 1, nn
    td(i) = 0
    if (mt + i <= items%n) td(i) = items%number(mt + i)
  end do
end function tinput

logical function pcomp(a, b, n)
  !! Whether the first n letters agree, in any case.
  implicit none
  character(*), intent(in) :: a, b
  integer, intent(in) :: n
  integer :: i

  pcomp = .false.
  do i = 1, n
    if (lower(a(i:i)) /= lower(b(i:i))) return
  end do
  pcomp = .true.

contains

  pure integer function lower(c)
    character, intent(in) :: c

    lower = iachar(c)
    if (c >= 'A' .and. c <= 'Z') lower = lower + 32
  end function lower
end function pcomp

subroutine setval(xi, num, val)
  !! A number; this host has no expressions.
  implicit none
  integer, intent(in) :: num
  character(*), intent(in) :: xi
  real(8), intent(out) :: val
  integer :: code

  read (xi(1:num), *, iostat=code) val
  if (code == 0) return
  print '(3a)', ' *ERROR* "', xi(1:num), '" is no number'
  call plstop(.true.)
end subroutine setval

subroutine plstop(failed)
  implicit none
  logical, intent(in) :: failed

  if (failed) stop 1
  stop
end subroutine plstop
