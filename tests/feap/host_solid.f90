! The host's own solid, of small strains, which knows nothing of splines: it asks quadr1d, quadr2d or quadr3d for points and
! interp1d, interp2d or interp3d for functions, as FEAP's solids do. MATErial, then SOLId and ELAStic ISOTropic E nu.

subroutine host_solid(d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
  use feap_items, only: item_list, read_items
  implicit none
  integer, intent(in) :: ndf, ndm, nst, isw
  integer, intent(inout) :: ix(*)
  real(8), intent(inout) :: d(*)
  real(8), intent(in) :: ul(ndf, *), xl(ndm, *), tl(*)
  real(8), intent(inout) :: s(nst, nst), p(nst)
  include 'eldata.h'
  include 'pmod2d.h'
  include 'umac1.h'
  type(item_list) :: items
  real(8), save :: lambda = 0, mu = 0
  external :: quadr1d, quadr2d, quadr3d

  etype = 1
  dtype = 1
  select case (isw)
  case (-1)
    utx(1) = 'solid'
  case (1)
    d(1) = 0
    do
      call read_items(items)
      if (items%n == 0) exit
      if (items%key(1) /= 'elas') cycle
      mu = items%number(3)/(2*(1 + items%number(4)))
      lambda = 2*mu*items%number(4)/(1 - 2*items%number(4))
    end do
  case (3, 6)
    d(1:5) = 0
    if (ndm == 1) call quadr1d(d)
    if (ndm == 2) call quadr2d(d, .true.)
    if (ndm == 3) call quadr3d(d, .true.)
    call assemble_solid()
  end select

contains

  subroutine assemble_solid()
    include 'qudshp.h'
    real(8) :: grad(ndm, nel), k(ndm, ndm)
    integer :: a, b, i, j, l, row, column
    external :: interp1d, interp2d, interp3d

    do l = 1, lint
      if (ndm == 1) then
        call interp1d(l, xl, ndm, nel, .false.)
        grad = shp1(1:1, 1:nel, l)
      else if (ndm == 2) then
        call interp2d(l, xl, ix, ndm, nel, .false.)
        grad = shp2(1:2, 1:nel, l)
      else
        call interp3d(l, xl, ndm, nel)
        grad = shp3(1:3, 1:nel, l)
      end if
      do b = 1, nel
        do a = 1, nel
          do j = 1, ndm
            do i = 1, ndm
              k(i, j) = (lambda*grad(i, a)*grad(j, b) + mu*grad(j, a)*grad(i, b))*jac(l)
              if (i == j) k(i, j) = k(i, j) + mu*dot_product(grad(:, a), grad(:, b))*jac(l)
            end do
          end do
          row = ndf*(a - 1)
          column = ndf*(b - 1)
          p(row + 1:row + ndm) = p(row + 1:row + ndm) - matmul(k, ul(1:ndm, b))
          if (isw == 3) s(row + 1:row + ndm, column + 1:column + ndm) = &
            s(row + 1:row + ndm, column + 1:column + ndm) + k
        end do
      end do
    end do
  end subroutine assemble_solid
end subroutine host_solid

! FEAP's points and functions of ordinary elements: this host has none.

subroutine int1d(l, sg)
  implicit none
  integer, intent(in) :: l
  real(8), intent(in) :: sg(*)

  error stop 'host: an element without operator came to int1d'
end subroutine int1d

subroutine shp1d(s, xl, shp, ndm, nel, xjac)
  implicit none
  integer, intent(in) :: ndm, nel
  real(8), intent(in) :: s, xl(*), shp(*), xjac

  error stop 'host: an element without operator came to shp1d'
end subroutine shp1d

subroutine int2d(l, lint, sg)
  implicit none
  integer, intent(in) :: l, lint
  real(8), intent(in) :: sg(*)

  error stop 'host: an element without operator came to int2d'
end subroutine int2d

subroutine shp2d(ss, xl, shp, xsj, ndm, nel, ix, flag)
  implicit none
  integer, intent(in) :: ndm, nel, ix(*)
  real(8), intent(in) :: ss(*), xl(*), shp(*), xsj
  logical, intent(in) :: flag

  error stop 'host: an element without operator came to shp2d'
end subroutine shp2d

subroutine int3d(ll, lint, s)
  implicit none
  integer, intent(in) :: ll, lint
  real(8), intent(in) :: s(*)

  error stop 'host: an element without operator came to int3d'
end subroutine int3d

subroutine shp3d(ss, xsj, shp, x, ndm)
  implicit none
  integer, intent(in) :: ndm
  real(8), intent(in) :: ss(*), xsj, shp(*), x(*)

  error stop 'host: an element without operator came to shp3d'
end subroutine shp3d
