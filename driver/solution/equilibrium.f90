module equilibrium
  !! The residual of the model and its tangent: R(u, t) = internal forces - loads, over all control values, and its
  !! reduction to the equations. Everything that a step changes is here; Newton and step control only drive it.
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use model_data, only: model_type
  use end_face, only: end_face_geometry, build_end_face
  use end_face_forces, only: assemble_end_faces
  use bulk_elements, only: bulk_type, prepare_bulk, assemble_bulk, commit_bulk, roll_back_bulk
  use interface_points, only: interface_points_type, prepare_interface, pair_interface, assemble_interface, &
    commit_interface, roll_back_interface
  use interface_pattern, only: pair_lists, pairs_covered
  use joint_lines, only: joint_line, prepare_joints, assemble_joints, joint_lists
  use load_assembly, only: load_points_type, prepare_loads, assemble_loads, loads_are_symmetric
  use equation_system, only: equation_system_type
  use linear_solver, only: linear_solver_type
  use user_element, only: element_energy, task_residual, task_tangent
  use timers, only: timer_set, phase_prepare, phase_search, phase_contact, phase_elements, phase_loads, phase_pattern, &
    phase_analyse
  implicit none (type, external)
  private
  public :: equilibrium_type, start_equilibrium, form_equilibrium, renew_pattern, commit, roll_back, place_text, &
    work_of_increment, force_scale, energies_type

  type :: energies_type
    real(wp) :: elastic = 0, dissipated = 0, penalty = 0   !! [force*length]
    real(wp) :: work = 0                                   !! of loads and prescribed values since the start
    real(wp) :: penetration = 0                            !! largest [length]
    real(wp) :: largest_work = 0                           !! largest |work| so far
  contains
    procedure :: balance_error
  end type energies_type

  type :: equilibrium_type
    type(equation_system_type) :: system
    type(linear_solver_type) :: solver
    type(bulk_type) :: bulk
    type(load_points_type) :: loads
    type(joint_line), allocatable :: joints(:)
    type(interface_points_type), allocatable :: interfaces(:)
    real(wp), allocatable :: u(:, :), un(:, :)     !! control values now; committed (ndf,nn)
    real(wp), allocatable :: f(:, :)               !! internal - external force of every dof: the reactions
    real(wp), allocatable :: f_moved(:, :)         !! its first-order change by prescribed increments or rates
    real(wp), allocatable :: fext(:, :)            !! external forces
    real(wp), allocatable :: f_n(:, :), fext_n(:, :) !! both at the last converged step, for the work
    real(wp), allocatable :: r(:)                  !! residual of the equations
    real(wp) :: time = 0, time_n = 0
    type(energies_type) :: energies, energies_n
    real(wp) :: largest_force = 0                  !! of reactions and loads, in all converged steps
    integer :: active = 0                          !! interface points that carry traction
    integer :: forced = 0                          !! interface points held on a kink for one evaluation: no solution
    integer :: point_count = 0                     !! of all interfaces
    integer :: patterns = 0                        !! how often the pattern was built
    integer :: leaps = 0                           !! increments refused as a slave point may have passed the master
    logical :: pattern_stands = .false.
    character(:), allocatable :: fault             !! what stopped the last evaluation, with its place
  end type equilibrium_type

contains

  subroutine start_equilibrium(model, eq, clock, status)
    !! Number, prepare, allocate.
    type(model_type), intent(inout), target :: model
    type(equilibrium_type), intent(inout), target :: eq
    type(timer_set), intent(inout) :: clock
    integer, intent(out) :: status
    type(end_face_geometry), allocatable :: faces(:)
    integer :: i, n, place
    logical :: symmetric

    call clock%start(phase_prepare)
    call prepare_bulk(model, eq%bulk, status, place)
    if (status /= ok) then
      eq%fault = place_text(model, place)//': '//status_text(status)
      return
    end if
    call prepare_loads(model, eq%loads)
    call prepare_joints(model, eq%joints, status, place)
    if (status /= ok) then
      eq%fault = 'a joint of '//place_text(model, place)//': '//status_text(status)
      return
    end if
    n = 0
    if (allocated(model%interfaces)) n = size(model%interfaces)
    allocate (eq%interfaces(n))
    symmetric = loads_are_symmetric(model)
    do i = 1, size(model%materials)
      symmetric = symmetric .and. model%materials(i)%element%symmetric
    end do
    do i = 1, n
      call prepare_interface(model, i, eq%interfaces(i), status, place)
      if (status /= ok) then
        eq%fault = model%interfaces(i)%place//': CONTact: slave surface of interface '//model%interfaces(i)%name//': '// &
          status_text(status)
        return
      end if
      eq%point_count = eq%point_count + eq%interfaces(i)%np
      symmetric = symmetric .and. model%interfaces(i)%element%symmetric
    end do
    n = 0
    if (allocated(model%end_faces)) n = size(model%end_faces)
    allocate (faces(n))
    do i = 1, n
      call build_end_face(model, i, faces(i), status)
      if (status /= ok) then
        eq%fault = 'end face '//model%end_faces(i)%name//': '//status_text(status)
        return
      end if
    end do
    call eq%system%start(model, faces, symmetric)
    eq%solver%indefinite = eq%system%map%multipliers > 0
    n = model%columns()
    allocate (eq%u(model%ndf, n), eq%un(model%ndf, n), eq%f(model%ndf, n), eq%f_moved(model%ndf, n), &
      eq%fext(model%ndf, n), eq%f_n(model%ndf, n), eq%fext_n(model%ndf, n), source=0.0_wp)
    allocate (eq%r(eq%system%map%neq), source=0.0_wp)
    call eq%system%map%follow(eq%u)   ! nothing is moved yet: what is prescribed at time 0 does work, too
    eq%un = eq%u
    call clock%stop(phase_prepare)
  end subroutine start_equilibrium

  subroutine renew_pattern(model, eq, clock, status)
    !! Build the sparse pattern for the present interface pairs and order it.
    type(model_type), intent(in) :: model
    type(equilibrium_type), intent(inout) :: eq
    type(timer_set), intent(inout) :: clock
    integer, intent(out) :: status
    integer, allocatable :: ptr(:), nodes(:)
    integer :: i

    call clock%start(phase_pattern)
    ptr = [1]
    allocate (nodes(0))
    do i = 1, size(eq%interfaces)
      call pair_lists(eq%interfaces(i), ptr, nodes)
    end do
    call joint_lists(eq%joints, ptr, nodes)
    call eq%system%rebuild(model, ptr, nodes, status)
    call clock%stop(phase_pattern)
    if (status /= ok) then
      eq%fault = 'the matrix: '//status_text(status)
      return
    end if
    call clock%start(phase_analyse)
    call eq%solver%analyse(eq%system%matrix%pattern, status)
    call clock%stop(phase_analyse)
    if (status /= ok) eq%fault = 'the analysis of the matrix: '//status_text(status)
    eq%patterns = eq%patterns + 1
    eq%pattern_stands = status == ok
  end subroutine renew_pattern

  subroutine form_equilibrium(model, eq, want_tangent, du, moves, clock, status)
    !! Residual (eq%f, eq%r) and, if wanted, tangent at eq%u and eq%time. With the tangent, the first-order change of
    !! forces by prescribed increments (or rates) du where `moves` goes to eq%f_moved.
    type(model_type), intent(inout), target :: model
    type(equilibrium_type), intent(inout), target :: eq
    logical, intent(in) :: want_tangent
    real(wp), intent(in) :: du(:, :)
    logical, intent(in) :: moves(:)
    type(timer_set), intent(inout) :: clock
    integer, intent(out) :: status
    type(element_energy) :: sums
    real(wp), allocatable :: x(:, :)
    real(wp) :: dt, stored, dissipated
    integer :: i, place, task

    task = merge(task_tangent, task_residual, want_tangent)
    dt = eq%time - eq%time_n
    stored = 0
    dissipated = 0
    sums%gap = 0
    eq%f = 0
    if (want_tangent) eq%f_moved = 0
    call eq%system%map%linearise(eq%u)
    if (size(eq%interfaces) > 0) then
      call clock%start(phase_search)
      x = model%x + eq%u(1:model%ndm, 1:model%nn)
      do i = 1, size(eq%interfaces)
        call pair_interface(model, eq%interfaces(i), x)
      end do
      eq%forced = sum(eq%interfaces%forced)
      call clock%stop(phase_search)
      if (want_tangent) then
        do i = 1, size(eq%interfaces)
          eq%pattern_stands = eq%pattern_stands .and. pairs_covered(eq%interfaces(i))
        end do
      end if
    end if
    if (want_tangent .and. .not. eq%pattern_stands) then
      call renew_pattern(model, eq, clock, status)
      if (status /= ok) return
    end if

    if (want_tangent) call eq%system%clear()
    call clock%start(phase_elements)
    call assemble_bulk(model, eq%bulk, task, eq%u, eq%un, du, moves, eq%time, dt, eq%system, eq%f, eq%f_moved, stored, &
                       dissipated, status, place)
    if (status == ok) call assemble_joints(eq%joints, task, eq%u, du, moves, eq%system, eq%f, eq%f_moved, stored, status)
    call clock%stop(phase_elements)
    if (status /= ok) then
      eq%fault = 'a joint of shells: '//status_text(status)
      if (place > 0) eq%fault = place_text(model, place)//': '//status_text(status)
      return
    end if

    if (size(eq%interfaces) > 0) then
      call clock%start(phase_contact)
      eq%active = 0
      do i = 1, size(eq%interfaces)
        call assemble_interface(model, i, eq%interfaces(i), task, eq%u, eq%un, du, moves, eq%time, dt, eq%system, eq%f, &
                                eq%f_moved, sums, status, place)
        if (status /= ok) then
          call clock%stop(phase_contact)
          eq%fault = 'an interface point of '//model%interfaces(i)%name//': '//status_text(status)
          return
        end if
        eq%active = eq%active + count(eq%interfaces(i)%active)
      end do
      call clock%stop(phase_contact)
    end if

    call clock%start(phase_loads)
    call assemble_loads(model, eq%loads, eq%time, eq%u, du, moves, want_tangent, eq%system, eq%fext, eq%f, &
                        eq%f_moved, status)
    call clock%stop(phase_loads)
    if (status /= ok) then
      eq%fault = 'a surface load: '//status_text(status)
      return
    end if
    call assemble_end_faces(eq%system, eq%u, du, moves, want_tangent, eq%f, eq%f_moved)
    if (want_tangent) call eq%system%add_curvature(eq%f)
    call eq%system%map%add_reactions(eq%f)
    if (want_tangent) call eq%system%map%add_reactions(eq%f_moved)
    call eq%system%map%reduce(eq%f, eq%r)
    eq%energies%elastic = stored + sums%stored
    eq%energies%dissipated = dissipated + sums%dissipated
    eq%energies%penalty = sums%penalty
    eq%energies%penetration = -sums%gap
    eq%fault = ''
    if (want_tangent .and. eq%system%stale > 0) then
      error stop 'form_equilibrium: the matrix pattern lacks an entry of an interface pair'
    end if
  end subroutine form_equilibrium

  subroutine commit(eq)
    !! The step converged.
    type(equilibrium_type), intent(inout) :: eq
    integer :: i

    eq%energies%work = eq%energies_n%work + work_of_increment(eq)
    eq%energies%largest_work = max(eq%energies_n%largest_work, abs(eq%energies%work))
    eq%largest_force = max(eq%largest_force, force_scale(eq))
    eq%energies_n = eq%energies
    eq%f_n = eq%f
    eq%fext_n = eq%fext
    eq%un = eq%u
    eq%time_n = eq%time
    call commit_bulk(eq%bulk)
    do i = 1, size(eq%interfaces)
      call commit_interface(eq%interfaces(i))
    end do
  end subroutine commit

  pure function force_scale(eq) result(force)
    !! Size of the reactions and loads, with which a residual is compared.
    type(equilibrium_type), intent(in) :: eq
    real(wp) :: force

    force = max(eq%system%map%reaction_size(eq%f), eq%system%map%force_size(eq%fext))
  end function force_scale

  pure function work_of_increment(eq) result(work)
    !! Work of loads and reactions since the committed state: mean forces over the increment (trapezoidal rule).
    type(equilibrium_type), intent(in) :: eq
    real(wp) :: work                 !! [force*length]

    work = 0.5_wp*sum((eq%fext + eq%fext_n)*(eq%u - eq%un)) &
      + eq%system%map%prescribed_work(0.5_wp*(eq%f + eq%f_n), eq%u - eq%un)
  end function work_of_increment

  pure function balance_error(self) result(error)
    !! (work - elastic - dissipated - penalty energy) as a share of the largest work so far; 0 before there is work.
    !! It is the error of the trapezoidal rule and of Newton's tolerance, and shrinks with the steps.
    class(energies_type), intent(in) :: self
    real(wp) :: error

    error = 0
    if (self%largest_work > 0) error = (self%work - self%elastic - self%dissipated - self%penalty)/self%largest_work
  end function balance_error

  subroutine roll_back(eq)
    !! The step is rejected.
    type(equilibrium_type), intent(inout) :: eq
    integer :: i

    eq%u = eq%un
    eq%time = eq%time_n
    eq%energies = eq%energies_n
    eq%f = eq%f_n
    eq%fext = eq%fext_n
    call roll_back_bulk(eq%bulk)
    do i = 1, size(eq%interfaces)
      call roll_back_interface(eq%interfaces(i))
    end do
  end subroutine roll_back

  function place_text(model, e) result(text)
    !! An element by number and by the element sets that hold it.
    type(model_type), intent(in) :: model
    integer, intent(in) :: e
    character(:), allocatable :: text
    character(12) :: number
    integer :: s

    write (number, '(i0)') e
    text = 'element '//trim(number)
    do s = 1, size(model%sets)
      if (model%sets(s)%kind /= 2) cycle
      if (any(model%sets(s)%items == e)) then
        text = text//' of '//model%sets(s)%name
        return
      end if
    end do
  end function place_text
end module equilibrium
