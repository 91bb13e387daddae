module abaqus_calls
  !! What UEXTERNALDB and UEL do. UEL reaches compute_element by its C name: an external procedure that used this module would
  !! save and restore the floating-point state at every call (gfortran, as modules below use ieee_arithmetic), which costs a
  !! tenth of a plane element.
  use, intrinsic :: iso_c_binding, only: c_int, c_double
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use user_element, only: element_energy, task_residual, task_tangent
  use abaqus_job, only: read_job, interface_kind
  use abaqus_elements, only: bulk_forces, interface_forces, call_fault
  use abaqus_state, only: job, has_job, tell, stop_analysis
  implicit none (type, external)
  private
  public :: begin_job, compute_element

contains

  subroutine begin_job(folder, name)
    !! Read the job file.
    character(*), intent(in) :: folder, name
    character(:), allocatable :: fault

    call read_job(folder, name, job, fault)
    has_job = .not. allocated(fault)
    if (.not. has_job) call stop_analysis(fault, [0])
  end subroutine begin_job

  subroutine compute_element(jelem, jtype, flag, ndofel, nrhs, mlvarx, mcrd, nnode, nsvars, nprops, ndload, coords, props, u, &
      rhs, amatrx, svars, energy, pnewdt) bind(c, name='bezel_uel_element')
    integer(c_int), intent(in) :: jelem, jtype                       !! number and type of the element
    integer(c_int), intent(in) :: flag                               !! LFLAGS(3)
    integer(c_int), intent(in) :: ndofel, nrhs, mlvarx, mcrd, nnode, nsvars, nprops, ndload
    real(c_double), intent(in) :: coords(mcrd, nnode), props(nprops), u(ndofel)
    real(c_double), intent(inout) :: rhs(mlvarx, nrhs), amatrx(ndofel, ndofel)
    real(c_double), intent(inout) :: svars(nsvars)                  !! of the increment's start, then of its end
    real(c_double), intent(inout) :: energy(8)                      !! 2: elastic, 4: dissipated, 6: in the penalty
    real(c_double), intent(inout) :: pnewdt
    character(:), allocatable :: fault
    type(element_energy) :: energies
    integer :: numbers(3), place, status, task
    real(wp) :: force(ndofel), states(nsvars)

    numbers = jelem
    if (.not. has_job) call stop_analysis('user element %I: no operators were read; the routine UEXTERNALDB belongs to UEL', &
                                          numbers)
    place = job%find(jelem)
    if (place == 0) call stop_analysis('user element %I has no extraction operator: the job file knows no such number; '// &
                                       'see FIRST= of SOLID and INTERFACE', numbers)
    task = task_tangent
    if (flag == 5) task = task_residual
    call call_fault(job, job%places(place), flag, jtype, mcrd, nnode, ndofel, nprops, nsvars, ndload, coords, numbers(2:), &
                    fault)
    if (allocated(fault)) call stop_analysis('user element %I '//fault, numbers)

    states = svars
    if (job%places(place)%kind == interface_kind) then
      call interface_forces(job, job%places(place), job%ndm, nnode, props, task, u, states, force, amatrx, energies, fault, &
                            status)
    else
      call bulk_forces(job, job%places(place), job%ndm, nnode, props, task, u, force, amatrx, energies, fault, status)
    end if
    if (allocated(fault)) call stop_analysis('user element %I '//fault, numbers)
    if (status /= ok) then
      call tell(1, 'user element %I: '//status_text(status)//'; the increment is cut', numbers)
      pnewdt = min(pnewdt, 0.25_wp)
      force = 0
      if (task == task_tangent) amatrx = 0
    end if
    if (flag == 2) return
    rhs(1:ndofel, 2:) = 0
    rhs(1:ndofel, 1) = -force
    if (status /= ok) return
    svars = states
    energy(2) = energies%stored
    energy(4) = energies%dissipated
    energy(6) = energies%penalty
  end subroutine compute_element
end module abaqus_calls
