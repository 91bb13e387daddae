subroutine elmt03(d, ul, xl, ix, tl, s, p, ndf, ndm, nst, isw)
  !! The Kirchhoff-Love shell, without rotations, in three dimensions: MATErial, then BEZShell and the property lines of
  !! `shell_element`.
  implicit none
  integer, intent(in) :: ndf, ndm, nst, isw
  integer, intent(inout) :: ix(*)
  real(8), intent(in) :: d(*), ul(*), xl(*), tl(*)
  real(8), intent(inout) :: s(*), p(*)
  include 'umac1.h'
  external :: define_shell

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
    utx(1) = 'bezshell'
  else if (isw == 1) then
    call define_shell(ix, ndf, ndm)
  else
    call bulk_tasks(ul, xl, s, p, ndf, ndm, nst, isw)
  end if
end subroutine elmt03

subroutine define_shell(ix, ndf, ndm)
  !! Task 1: read the material.
  use shell_element, only: shell_element_type
  use feap_materials, only: define_material
  implicit none
  integer, intent(in) :: ndf, ndm
  integer, intent(inout) :: ix(*)
  include 'eldata.h'
  include 'strnum.h'
  type(shell_element_type) :: shell
  integer :: i

  call define_material(ma, shell, ndm)
  do i = ndm + 1, ndf
    ix(i) = 0
  end do
  pstyp = 2
  istv = max(istv, 6)
end subroutine define_shell
