! What Abaqus/Standard calls: UEXTERNALDB reads JOB.bezel once, UEL computes one element. U and COORDS are of one node after
! another. RHS = -F_int, AMATRX = dF_int/du. LFLAGS(3): 1 both, 2 stiffness, 5 residual; the elements have no mass and no
! damping. An element that fails asks for a smaller increment by PNEWDT, one whose data are wrong ends the analysis.

subroutine uexternaldb(lop, lrestart, time, dtime, kstep, kinc)
  use abaqus_calls, only: begin_job
  implicit none (type, external)
  integer, intent(in) :: lop                      ! 0: the analysis begins, 4: it goes on after a restart
  integer, intent(in) :: lrestart, kstep, kinc
  real(8), intent(in) :: time(2), dtime
  external :: getoutdir, getjobname
  character(256) :: folder, name
  integer :: folder_length, name_length

  associate (u1 => lrestart, u2 => kstep, u3 => kinc, u4 => time, u5 => dtime)
  end associate
  if (lop /= 0 .and. lop /= 4) return
  call getoutdir(folder, folder_length)
  call getjobname(name, name_length)
  call begin_job(folder(1:folder_length), name(1:name_length))
end subroutine uexternaldb

subroutine uel(rhs, amatrx, svars, energy, ndofel, nrhs, nsvars, props, nprops, coords, mcrd, nnode, u, du, v, a, jtype, &
    time, dtime, kstep, kinc, jelem, params, ndload, jdltyp, adlmag, predef, npredf, lflags, mlvarx, ddlmag, mdload, &
    pnewdt, jprops, njprop, period)
  implicit none (type, external)
  integer, intent(in) :: ndofel, nrhs, nsvars, nprops, mcrd, nnode, jtype, kstep, kinc, jelem, ndload, npredf, mlvarx, &
    mdload, njprop
  real(8), intent(inout) :: rhs(mlvarx, *), amatrx(ndofel, ndofel), svars(nsvars), energy(8), pnewdt
  real(8), intent(in) :: props(nprops), coords(mcrd, nnode), u(ndofel), du(mlvarx, *), v(ndofel), a(ndofel), time(2), &
    dtime, params(*), adlmag(mdload, *), predef(2, npredf, nnode), ddlmag(mdload, *), period
  integer, intent(in) :: jdltyp(mdload, *), lflags(*), jprops(*)
  interface
    subroutine compute_element(jelem, jtype, flag, ndofel, nrhs, mlvarx, mcrd, nnode, nsvars, nprops, ndload, coords, props, &
        u, rhs, amatrx, svars, energy, pnewdt) bind(c, name='bezel_uel_element')
      use, intrinsic :: iso_c_binding, only: c_int, c_double
      implicit none (type, external)
      integer(c_int), intent(in) :: jelem, jtype, flag, ndofel, nrhs, mlvarx, mcrd, nnode, nsvars, nprops, ndload
      real(c_double), intent(in) :: coords(mcrd, nnode), props(nprops), u(ndofel)
      real(c_double), intent(inout) :: rhs(mlvarx, nrhs), amatrx(ndofel, ndofel), svars(nsvars), energy(8), pnewdt
    end subroutine compute_element
  end interface

  ! what elements without inertia, rates and loads of their own do not look at
  associate (u1 => v, u2 => a, u3 => period, u4 => predef, u5 => du(:, 1:0), u6 => time, u7 => dtime, u8 => kstep, &
      u9 => kinc, u10 => params(1:0), u11 => jdltyp(:, 1:0), u12 => adlmag(:, 1:0), u13 => ddlmag(:, 1:0), &
      u14 => jprops(1:0), u15 => njprop)
  end associate
  call compute_element(jelem, jtype, lflags(3), ndofel, nrhs, mlvarx, mcrd, nnode, nsvars, nprops, ndload, coords, props, u, &
                       rhs, amatrx, svars, energy, pnewdt)
end subroutine uel
