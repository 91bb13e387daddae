! Take the place of FEAP's routines of these names by standing before its archive on the link line. Elements with an
! extraction operator get their own Gauss points and functions; bricks go on through FEAP's int3d and shp3d.

subroutine quadr3d(d, stiff)
  implicit none
  real(8), intent(in) :: d(*)             ! of the material; d(5): points per direction
  logical, intent(in) :: stiff            ! stiffness or mass: the same rule serves both
  include 'eldata.h'
  include 'pmod2d.h'
  include 'qudshp.h'
  integer, parameter :: in_small_strain = 125, in_finite_strain = 9   ! nodes and points that FEAP's elements hold
  integer :: n
  external :: int3d, refuse_element

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
  ttfl = .false.
  nvn = 8
  npm = 1
  call spline_points(n_el, 3, nel, nint(d(5)), merge(in_small_strain, in_finite_strain, dtype > 0), sg3, lint)
  if (lint > 0) return
  if (any(nel == [4, 10, 11, 14, 15])) call refuse_element(n_el, 'it has no extraction operator, and tetrahedra need '// &
    'FEAP''s own interp3d. Give the operator, or link without interp3d.o')
  n = merge(2, merge(3, 4, nel <= 27), nel <= 8)
  npm = merge(1, merge(4, 10, nel <= 27), nel <= 8)
  call int3d(n, lint, sg3)
end subroutine quadr3d

subroutine interp3d(l, xl, ndm, nel)
  implicit none
  integer, intent(in) :: l, ndm, nel      ! point; space dimension, nodes
  real(8), intent(in) :: xl(ndm, *)
  include 'qudshp.h'
  external :: shp3d
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

  shpm(1:nel, l) = 0                      ! FEAP's mixed elements alone read it
  call spline_functions(present_element(), 3, nel, 0, sg3(1, l), xl, shp3(1, 1, l), jac(l), done)
  if (done == 1) return
  call shp3d(sg3(1, l), jac(l), shp3(1, 1, l), xl, ndm)
  jac(l) = sg3(4, l)*jac(l)
end subroutine interp3d
