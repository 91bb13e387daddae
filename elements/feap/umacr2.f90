subroutine umacr2(lct, ctl)
  !! Solution command NODAl,name: time, displacements and reactions of all nodes in full digits, added to the file `name`.
  !! The reactions are those of the last REAC (REAC,FILE prints nothing).
  use kinds, only: wp
  implicit none
  character(15), intent(in) :: lct        ! name of the file
  real(wp), intent(in) :: ctl(3)
  include 'umac1.h'
  include 'cdata.h'
  include 'sdata.h'
  include 'tdata.h'
  include 'pointer.h'
  include 'comblk.h'
  integer :: unit, n, i
  logical, external :: pcomp

  if (pcomp(uct, 'mac2', 4)) then
    uct = 'noda'
    return
  end if
  if (urest /= 0) return
  open (newunit=unit, file=trim(merge('nodal          ', lct, lct == ' ')), position='append')
  write (unit, '(a,es24.16,a,i0)') 'time ', ttim, ' nodes ', numnp
  do n = 1, numnp
    write (unit, '(i8,*(es24.16))') n, (hr(np(40) + ndf*(n - 1) + i - 1), i=1, ndf), &
      (-hr(np(26) + ndf*(n - 1) + i - 1), i=1, ndf)
  end do
  close (unit)
end subroutine umacr2
