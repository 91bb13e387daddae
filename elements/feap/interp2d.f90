! Take the place of FEAP's routines of these names by standing before its archive on the link line. Elements with an
! extraction operator get their own Gauss points and functions; quadrilaterals go on through FEAP's int2d and shp2d.

subroutine quadr2d(d, stiff)
  implicit none
  real(8), intent(in) :: d(*)             ! of the material; d(5): points per direction
  logical, intent(in) :: stiff            ! stiffness or mass: the same rule serves both
  include 'eldata.h'
  include 'pmod2d.h'
  include 'qudshp.h'
  integer, parameter :: room = 64         ! nodes and points that the arrays hold
  integer :: n
  external :: int2d, refuse_element

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
  npm = 1
  n = nint(d(5))
  call spline_points(n_el, 2, nel, n, room, sg2, lint)
  if (lint > 0) then
    if (etype /= 1) call refuse_element(n_el, 'mixed and enhanced elements have no modes for splines. '// &
      'Write DISPlacement in its material')
    return
  end if
  if (any(nel == [3, 6, 7])) call refuse_element(n_el, 'it has no extraction operator, and triangles need FEAP''s own '// &
    'interp2d. Give the operator, or link without interp2d.o')
  n = min(5, n)
  if (nel > 4) npm = 3
  if (nel > 9) npm = 6
  if (n == 0) n = merge(2, merge(3, 4, nel <= 9), nel <= 4)
  call int2d(n, lint, sg2)
end subroutine quadr2d

subroutine interp2d(l, xl, ix, ndm, nel, flag)
  implicit none
  integer, intent(in) :: l, ndm, nel      ! point; space dimension, nodes
  integer, intent(in) :: ix(*)
  real(8), intent(in) :: xl(ndm, *)
  logical, intent(in) :: flag             ! natural derivatives
  include 'qudshp.h'
  external :: shp2d
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

  call spline_functions(present_element(), 2, nel, merge(1, 0, flag), sg2(1, l), xl, shp2(1, 1, l), jac(l), done)
  if (done == 1) return
  call shp2d(sg2(1, l), xl, shp2(1, 1, l), jac(l), ndm, nel, ix, flag)
  jac(l) = jac(l)*sg2(3, l)
end subroutine interp2d
