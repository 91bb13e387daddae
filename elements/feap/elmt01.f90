subroutine elmt01(d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
  !! The solid, in two and three dimensions: MATErial, then BEZSolid and the property lines of `solid_element`.
  implicit none
  integer, intent(in) :: ndf, ndm, nst, isw
  integer, intent(inout) :: ix(*)
  real(8), intent(in) :: d(*), ul(*), xl(*), tl(*)
  real(8), intent(inout) :: s(*), p(*)
  include 'umac1.h'
  external :: define_solid

  interface
    subroutine bulk_tasks(ul, xl, s, p, ndf, ndm, nst, isw) bind(c, name='bezel_feap_bulk_tasks')
      use, intrinsic :: iso_c_binding, only: c_int, c_double
      !! in feap_tasks
      integer(c_int), intent(in) :: ndf, ndm, nst, isw
      real(c_double), intent(in) :: ul(ndf, *)
      real(c_double), intent(in), target :: xl(ndm, *)
      real(c_double), intent(inout) :: s(*), p(*)
    end subroutine bulk_tasks
  end interface

  if (isw < 0) then
    utx(1) = 'bezsolid'
  else if (isw == 1) then
    call define_solid(ix, ndf, ndm)
  else
    call bulk_tasks(ul, xl, s, p, ndf, ndm, nst, isw)
  end if
end subroutine elmt01

subroutine define_solid(ix, ndf, ndm)
  !! Task 1: read the material.
  use solid_element, only: solid_element_type
  use feap_materials, only: define_material
  implicit none
  integer, intent(in) :: ndf, ndm
  integer, intent(inout) :: ix(*)
  include 'eldata.h'
  include 'strnum.h'
  type(solid_element_type) :: solid
  integer :: i

  call define_material(ma, solid, ndm)
  do i = ndm + 1, ndf
    ix(i) = 0
  end do
  pstyp = ndm
  istv = max(istv, 6)
end subroutine define_solid
