! Take the place of FEAP's routines of these names by standing before its archive on the link line. Elements with an
! extraction operator get their own Gauss points and functions; lines go on through FEAP's int1d and shp1d.

subroutine quadr1d(d)
  implicit none
  real(8), intent(in) :: d(*)             ! of the material; d(5): points per direction
  include 'eldata.h'
  include 'qudshp.h'
  integer, parameter :: room = 20         ! nodes and points that the arrays hold
  external :: int1d

  interface
    subroutine spline_points(number, dp, nel, wanted, room, sg, lint) bind(c, name='bezel_feap_points')
      use, intrinsic :: iso_c_binding, only: c_int, c_double
      !! in feap_shapes
      integer(c_int), intent(in) :: number, dp, nel, wanted, room
      real(c_double), intent(inout) :: sg(dp + 1, *)
      integer(c_int), intent(out) :: lint
    end subroutine spline_points
  end interface

  quad = .true.
  npm = nel - 1
  call spline_points(n_el, 1, nel, nint(d(5)), room, sg1, lint)
  if (lint > 0) return
  lint = min(5, nint(d(5)))
  if (lint == 0) lint = nel
  call int1d(lint, sg1)
end subroutine quadr1d

subroutine interp1d(l, xl, ndm, nel, flag)
  implicit none
  integer, intent(in) :: l, ndm, nel      ! point; space dimension, nodes
  real(8), intent(in) :: xl(ndm, *)
  logical, intent(in) :: flag             ! without quadrature: natural derivatives
  include 'qudshp.h'
  external :: shp1d
  integer :: done
  integer, external :: present_element

  interface
    subroutine spline_functions(number, dp, nel, natural, sg, xl, shp, jac, done) bind(c, name='bezel_feap_functions')
      use, intrinsic :: iso_c_binding, only: c_int, c_double
      !! in feap_shapes
      integer(c_int), intent(in) :: number, dp, nel, natural
      real(c_double), intent(in) :: sg(dp + 1), xl(dp, nel)
      real(c_double), intent(inout) :: shp(dp + 1, nel), jac
      integer(c_int), intent(out) :: done
    end subroutine spline_functions
  end interface

  call spline_functions(present_element(), 1, nel, merge(1, 0, flag .and. .not. quad), sg1(1, l), xl(1, 1:nel), &
    shp1(1, 1, l), jac(l), done)
  if (done == 1) return
  call shp1d(sg1(1, l), xl, shp1(1, 1, l), ndm, nel, jac(l))
  jac(l) = jac(l)*sg1(2, l)
end subroutine interp1d
