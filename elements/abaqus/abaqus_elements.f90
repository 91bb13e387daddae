module abaqus_elements
  !! From the lists of UEL to the elements' own interface and back. Properties:
  !!
  !!     solid       law (1 neo-Hooke, 2 neo-Hooke with U = lambda/4 (J^2 - 1 - 2 ln J), 3 St. Venant, 4 small strain),
  !!                 E, nu, state (1 plane strain, 2 plane stress, 3 three-dimensional), Gauss points a direction (0: p + 1)
  !!     shell       law (3 St. Venant, 4 small strains and rotations), E, nu, thickness, Gauss points a direction (0: p + 1)
  !!     interface   penalty, p_max, G_Ic, g_max (the last three 0: contact alone)
  !!
  !! State variables of an interface, 8 for each Gauss point: largest opening, that at the start
  !! (both 0: bonded; g_u: not), master facet of the patch (0: none),
  !! its parameters, kinks on which the pair rests (1: s, 2: t, 3: both), gap, traction.
  use kinds, only: wp
  use status_codes, only: ok, bond_lost, outside_patch, status_text
  use user_element, only: element_type, element_geometry, element_state, element_energy, task_prepare, task_tangent, mirror
  use gauss_rules, only: tensor_rule
  use material_laws, only: define_solid_law
  use interface_law, only: contact_law, cohesive_law
  use shell_law, only: define_shell_law
  use solid_element, only: solid_element_type
  use shell_element, only: shell_element_type
  use gpts_element, only: gpts_element_type
  use contact_search, only: move_master
  use master_patch, only: pair_in_patch
  use abaqus_job, only: job_type, element_place, solid_kind, interface_kind, shell_kind
  implicit none (type, external)
  private
  public :: bulk_forces, interface_forces, call_fault, point_words

  integer, parameter :: point_words = 8, bulk_properties = 5, interface_properties = 4

contains

  subroutine call_fault(job, place, flag, jtype, mcrd, nnode, ndofel, nprops, nsvars, ndload, coords, numbers, fault)
    !! Whether the lists that Abaqus hands over are those of the element that the job file promises.
    type(job_type), intent(in) :: job
    type(element_place), intent(in) :: place
    integer, intent(in) :: flag, jtype, mcrd, nnode, ndofel, nprops, nsvars, ndload
    real(wp), intent(in) :: coords(mcrd, nnode)
    integer, intent(inout) :: numbers(2)                      !! what %I stands for
    character(:), allocatable, intent(out) :: fault           !! fact and remedy
    real(wp) :: extent
    integer :: i, ndm

    ndm = job%ndm
    numbers(1) = nprops
    if (all(flag /= [1, 2, 5])) then
      fault = 'has neither mass nor damping: use a static step'
    else if (jtype/1000 /= place%kind) then
      numbers = [jtype, 1000*place%kind + size(place%nodes)]
      fault = 'has the type U%I, but is of type U%I in the job file'
    else if (nnode /= size(place%nodes)) then
      numbers = [nnode, size(place%nodes)]
      fault = 'has %I nodes, in the mesh file %I: write the elements anew from the file with bezel_abaqus'
    else if (ndofel /= ndm*nnode .or. mcrd < ndm) then
      numbers = [ndofel, ndm*nnode]
      fault = 'has %I degrees of freedom instead of %I: *USER ELEMENT takes COORDINATES= and a line 1, 2 (3 in space: 1, 2, 3)'
    else if (place%kind == solid_kind .and. nprops /= bulk_properties) then
      fault = 'has %I properties; *UEL PROPERTY takes five: law, E, nu, state, Gauss points'
    else if (place%kind == shell_kind .and. nprops /= bulk_properties) then
      fault = 'has %I properties; *UEL PROPERTY takes five: law, E, nu, thickness, Gauss points'
    else if (place%kind == interface_kind .and. nprops /= interface_properties) then
      fault = 'has %I properties; *UEL PROPERTY takes four: penalty, p_max, G_Ic, g_max'
    else if (ndload > 0) then
      fault = 'has a distributed load: put loads on nodes'
    else if (nsvars < words_of(job, place)) then
      numbers = [nsvars, words_of(job, place)]
      fault = 'has %I state variables and needs %I: VARIABLES= of *USER ELEMENT'
    end if
    if (allocated(fault) .or. allocated(place%table)) return
    extent = maxval(abs(job%mesh%x(1:ndm, place%nodes)))
    do i = 1, nnode
      if (all(abs(coords(1:ndm, i) - job%mesh%x(1:ndm, place%nodes(i))) <= 1.0e-6_wp*extent)) cycle
      numbers = [i, place%nodes(i)]
      fault = 'does not fit the mesh file: its node %I lies elsewhere than node %I of the file; write nodes and elements '// &
        'anew from the file with bezel_abaqus'
      return
    end do
  end subroutine call_fault

  pure integer function words_of(job, place) result(words)
    !! State variables of an element.
    type(job_type), intent(in) :: job
    type(element_place), intent(in) :: place

    words = 0
    if (place%kind == interface_kind) words = point_words*job%interfaces(place%of)%gp**(job%ndm - 1)
  end function words_of

  subroutine bulk_forces(job, place, ndm, nnode, props, task, u, fe, ke, energy, fault, status)
    type(job_type), intent(in), target :: job
    type(element_place), intent(inout), target :: place
    integer, intent(in) :: ndm, nnode
    real(wp), intent(in) :: props(bulk_properties)
    integer, intent(in) :: task
    real(wp), intent(in), target :: u(ndm, nnode)
    real(wp), intent(inout) :: fe(ndm, nnode), ke(ndm, nnode, ndm, nnode)
    type(element_energy), intent(out) :: energy
    character(:), allocatable, intent(out) :: fault           !! of the data
    integer, intent(out) :: status                            !! of the state
    type(solid_element_type), target :: solid
    type(shell_element_type), target :: shell
    class(element_type), pointer :: element
    type(element_geometry) :: geo
    type(element_state) :: state
    real(wp), target :: xe(ndm, nnode)
    integer :: ntable, nhist

    if (place%kind == solid_kind) then
      element => solid
      solid%gp = nint(props(5))
      geo%dp = ndm
      call define_solid_law(nint(props(1)), nint(props(4)), props(2), props(3), solid%law, status)
      if (status /= ok .or. solid%law%ndm /= ndm) &
        fault = 'has properties outside their range; law 1 to 4, E > 0, -1 < nu < 0.5, state 1 or 2 in the plane, 3 in space'
    else
      element => shell
      shell%gp = nint(props(5))
      geo%dp = 2
      call define_shell_law(props(2), props(3), props(4), nint(props(1)) == 4, shell%law, status)
      if (status /= ok .or. all(nint(props(1)) /= [3, 4])) &
        fault = 'has properties outside their range; law 3 or 4, E > 0, -1 < nu < 0.5, thickness > 0'
    end if
    if (allocated(fault)) return
    element%ndm = ndm
    element%ndf = ndm
    geo%ndm = ndm
    geo%nen = nnode
    geo%degree = job%mesh%elements%degree(:, place%item)
    geo%ce => job%mesh%elements%operator(place%item)
    geo%we => place%we
    if (.not. allocated(place%table)) then
      call element%sizes(geo, ntable, nhist)
      allocate (place%table(ntable, 1))
      xe = job%mesh%x(1:ndm, place%nodes)
      geo%xe => xe
      geo%table => place%table(:, 1)
      call element%evaluate(task_prepare, geo, state, fe, ke, energy, status)
      if (status /= ok) then
        fault = 'is not proper at the start: '//status_text(status)
        return
      end if
    end if
    geo%table => place%table(:, 1)
    state%ue => u
    call element%evaluate(task, geo, state, fe, ke, energy, status)
    if (task == task_tangent .and. status == ok) call mirror(ke)
  end subroutine bulk_forces

  subroutine interface_forces(job, place, ndm, nnode, props, task, u, svars, fe, ke, energies, fault, status)
    type(job_type), intent(in), target :: job
    type(element_place), intent(inout), target :: place
    integer, intent(in) :: ndm, nnode
    real(wp), intent(in) :: props(interface_properties)
    integer, intent(in) :: task
    real(wp), intent(in) :: u(ndm, nnode)
    real(wp), intent(inout) :: svars(point_words, *)          !! of the increment's start, then of its end
    real(wp), intent(inout) :: fe(ndm, nnode), ke(ndm, nnode, ndm, nnode)
    type(element_energy), intent(out) :: energies             !! sums
    character(:), allocatable, intent(out) :: fault
    integer, intent(out) :: status
    type(gpts_element_type) :: element
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    real(wp), target :: x(ndm, nnode), ue(ndm, nnode), xe(ndm, nnode), wm(nnode), hist(2), hist_n(2)
    real(wp) :: fp(ndm, nnode), kp((ndm*nnode)**2), xs(ndm)
    logical :: bonded, left
    integer, pointer, contiguous :: ix(:)
    integer :: g, m, ns, nm, dp, nhist, ntable

    element%ndm = ndm
    element%ndf = ndm
    dp = ndm - 1
    if (all(props(2:4) <= 0)) then
      call contact_law(props(1), element%law, status)
    else
      call cohesive_law(props(1), props(2), props(3), props(4), element%law, status)
    end if
    if (status /= ok) then
      fault = 'has properties outside their range; penalty, p_max, G_Ic and g_max are positive, g_max < 2 G_Ic/p_max'
      return
    end if
    x = job%mesh%x(1:ndm, place%nodes)
    associate (it => job%interfaces(place%of))
      ns = it%slave%set%nen(place%item)
      geo%ndm = ndm
      geo%dp = dp
      geo%nes = ns
      geo%nen = ns
      geo%degree = it%slave%set%degree(:, place%item)
      geo%ce => it%slave%set%operator(place%item)
      geo%we => place%we(1:ns)
      geo%xe => x(:, 1:ns)
      call element%sizes(geo, ntable, nhist)
      if (.not. allocated(place%table)) call prepare_points(element, geo, it%gp, ntable, place, status)
      if (status /= ok) then
        fault = 'is not proper at the start: '//status_text(status)
        return
      end if
      geo%master%side = it%side
      geo%master%offset = it%offset
    end associate

    fe = 0
    if (task == task_tangent) ke = 0
    call move_master(place%patch%search, x + u)
    ue(:, 1:ns) = u(:, 1:ns)
    xe(:, 1:ns) = x(:, 1:ns)
    do g = 1, size(place%table, 2)
      hist_n = svars(1:2, g)
      hist = hist_n
      m = nint(svars(3, g))
      geo%master%xi(1:dp) = svars(4:3 + dp, g)
      geo%master%held(1:2) = [mod(nint(svars(6, g)), 2) == 1, nint(svars(6, g)) > 1]
      xs = matmul(x(:, 1:ns) + u(:, 1:ns), place%table(2:ns + 1, g))
      bonded = element%is_bonded(hist_n(1:nhist))
      call pair_in_patch(place%patch, place%we, xs, bonded, m, geo%master%xi(1:dp), geo%master%held(1:dp), left)
      if (left) status = outside_patch
      if (bonded .and. m == 0) status = bond_lost
      if (status /= ok) return
      svars(3:8, g) = [real(m, wp), geo%master%xi, real(count(geo%master%held(1:1)) + 2*count(geo%master%held(2:2)), wp), &
                       0.0_wp, 0.0_wp]
      if (m == 0) cycle
      ix => place%patch%surface%set%connectivity(m)
      nm = size(ix)
      ue(:, ns + 1:ns + nm) = u(:, ix)
      xe(:, ns + 1:ns + nm) = x(:, ix)
      wm(1:nm) = place%we(ix)
      geo%nen = ns + nm
      geo%xe => xe(:, 1:ns + nm)
      geo%table => place%table(:, g)
      geo%master%nen = nm
      geo%master%degree = place%patch%surface%set%degree(1:2, m)
      geo%master%we => wm(1:nm)
      geo%master%ce => place%patch%surface%set%operator(m)
      state%ue => ue(:, 1:ns + nm)
      state%hist_n => hist_n(1:nhist)
      state%hist => hist(1:nhist)
      call evaluate_point(ns, nm, fp, kp)
      if (status /= ok) return
      svars(1:2, g) = hist
      svars(7:8, g) = [energy%gap, energy%traction]
      energies%stored = energies%stored + energy%stored
      energies%penalty = energies%penalty + energy%penalty
      energies%dissipated = energies%dissipated + energy%dissipated
    end do

  contains

    subroutine evaluate_point(ns, nm, fp, kp)
      !! One Gauss point, added at the places of its nodes.
      integer, intent(in) :: ns, nm
      real(wp), intent(inout) :: fp(ndm, ns + nm), kp(ndm, ns + nm, ndm, ns + nm)
      integer :: a, b, at(ns + nm), k

      call element%evaluate(task, geo, state, fp, kp, energy, status)
      if (status /= ok) return
      at(1:ns) = [(a, a=1, ns)]
      at(ns + 1:) = ix
      do a = 1, ns + nm
        fe(:, at(a)) = fe(:, at(a)) + fp(:, a)
      end do
      if (task /= task_tangent .or. .not. energy%active) return
      call mirror(kp)
      do b = 1, ns + nm
        do k = 1, ndm
          do a = 1, ns + nm
            ke(:, at(a), k, at(b)) = ke(:, at(a), k, at(b)) + kp(:, a, k, b)
          end do
        end do
      end do
    end subroutine evaluate_point
  end subroutine interface_forces

  subroutine prepare_points(element, geo, gp, ntable, place, status)
    !! Tables of all Gauss points of a slave facet.
    type(gpts_element_type), intent(in) :: element
    type(element_geometry), intent(inout) :: geo
    integer, intent(in) :: gp, ntable
    type(element_place), intent(inout), target :: place
    integer, intent(out) :: status
    type(element_state) :: state
    type(element_energy) :: energy
    real(wp) :: xi(geo%dp, gp**geo%dp), wt(gp**geo%dp), fe(0, 0), ke(0, 0, 0, 0)
    integer :: g

    call tensor_rule(spread(gp, 1, geo%dp), xi, wt)
    allocate (place%table(ntable, size(wt)))
    do g = 1, size(wt)
      geo%xi(1:geo%dp) = xi(:, g)
      geo%wt = wt(g)
      geo%table => place%table(:, g)
      call element%evaluate(task_prepare, geo, state, fe, ke, energy, status)
      if (status /= ok) return
    end do
  end subroutine prepare_points
end module abaqus_elements
