module interface_points
  !! The interfaces of a model during a run: slave points with what they precomputed, their pairing and their history;
  !! pairing and assembly. The kernel is reached through the user-element interface, as every element is.
  !!
  !! History belongs to the slave point, wherever it slides. A point that is bonded (its element says so by the committed
  !! history) and whose projection leaves the master's edge keeps its facet's smooth extension, until it is spent; then,
  !! and without cohesion, it is unpaired beyond the edge. What an unpaired point has dissipated stays in the sum.
  !!
  !! The sign of a master's normal is that of the deck; where it has none, solids have their outside, and a shell's normal
  !! points to where the slave is at the start.
  !!
  !! Bonded from the start are the points that the deck bonds, if in the reference position they have a partner on the
  !! master and are not already open by as much as spends them.
  use kinds, only: wp
  use status_codes, only: ok, bond_lost, nothing_bonded, side_unknown
  use model_data, only: model_type
  use gauss_rules, only: gauss_legendre, tensor_rule
  use rational_basis, only: shape_functions
  use surface_frame, only: tangent_frame_at
  use facets, only: facet_surface, build_facets
  use contact_search, only: master_search, start_search, move_master, pair_point
  use equation_system, only: equation_system_type
  use bulk_elements, only: add_moved_force
  use bond_regions, only: is_bonded_at
  use user_element, only: element_type, element_geometry, element_state, element_energy, task_prepare, task_residual, &
    task_tangent, task_dissipation_gradient
  implicit none (type, external)
  private
  public :: interface_points_type, prepare_interface, pair_interface, assemble_interface, commit_interface, &
    add_dissipation_gradient, roll_back_interface, place_of_slave, &
    height_above_master, forget_search

  type :: interface_points_type
    type(facet_surface) :: slave, master
    type(master_search) :: search
    class(element_type), allocatable :: element !! a copy, which judges histories
    integer :: np = 0                           !! points
    integer :: np_bonded = 0                    !! those that are bonded at the start
    integer :: nen_max = 0                      !! largest number of functions of a pair
    integer :: nhist = 0                        !! history words of a point
    integer :: ntable = 0                       !! table words kept for each point (its stride)
    integer, allocatable :: facet_of(:)         !! (np) slave facet
    real(wp), allocatable :: point(:, :)        !! (dp,np) place on it
    real(wp), allocatable :: table(:, :)        !! (ntable,np) what the element precomputed
    integer, allocatable :: facet(:), facet_n(:)     !! (np) master facet, 0: unpaired; committed
    real(wp), allocatable :: xi(:, :), xi_n(:, :)    !! (dp,np) projection; committed
    logical, allocatable :: held(:, :)          !! (dp,np) the projection rests on a kink in this direction
    logical, allocatable :: held_n(:, :)        !! committed
    integer :: forced = 0                       !! points held on a kink that they have just crossed
    real(wp), allocatable :: hist(:, :), hist_n(:, :) !! (nhist,np)
    real(wp), allocatable :: gap(:), traction(:)     !! (np) of the last assembly
    logical, allocatable :: active(:)           !! (np) it carried traction
    integer, allocatable :: room_for(:)         !! (np) master facet around which the pattern was made
  end type interface_points_type

  type :: pair_work
    !! One pair: nodes of the slave, then of the master facet; the element's arguments.
    integer, allocatable :: nodes(:)
    real(wp), allocatable :: xe(:, :), we(:), wm(:), u(:), un(:), f(:), k(:)
    real(wp), pointer, contiguous :: fe(:, :) => null(), ke(:, :, :, :) => null()   !! shaped for the pair
  end type pair_work

contains

  subroutine prepare_interface(model, number, points, status, place)
    !! Facets, Gauss points and their tables.
    type(model_type), intent(inout), target :: model
    integer, intent(in) :: number                  !! index into model%interfaces
    type(interface_points_type), intent(out), target :: points
    integer, intent(out) :: status
    integer, intent(out) :: place                  !! slave facet at fault
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    real(wp), allocatable :: rule(:, :), wt(:)
    real(wp), allocatable, target :: xe(:, :), we(:)
    integer, pointer, contiguous :: nodes(:)
    real(wp) :: fe(0, 0), ke(0, 0, 0, 0), reach
    integer :: dp, f, g, i, nt, gp, f_max

    status = ok
    place = 0
    dp = model%ndm - 1
    associate (it => model%interfaces(number))
      call build_facets(model, it%slave, points%slave)
      call build_facets(model, it%master, points%master)
      gp = it%gp
      allocate (rule(dp, gp**dp), wt(gp**dp))
      call tensor_rule([(gp, i=1, dp)], rule, wt)
      points%np = points%slave%set%ne*gp**dp
      points%nen_max = 0
      points%ntable = 0
      do f = 1, points%slave%set%ne
        geo%nen = points%slave%set%nen(f)
        call it%element%sizes(geo, nt, points%nhist)
        points%ntable = max(points%ntable, nt)
        points%nen_max = max(points%nen_max, geo%nen)
      end do
      f_max = 0
      do f = 1, points%master%set%ne
        f_max = max(f_max, points%master%set%nen(f))
      end do
      allocate (xe(model%ndm, points%nen_max), we(points%nen_max))
      points%nen_max = points%nen_max + f_max
      allocate (points%facet_of(points%np), points%point(dp, points%np), points%table(points%ntable, points%np))
      allocate (points%facet(points%np), points%facet_n(points%np), points%room_for(points%np), source=0)
      allocate (points%xi(dp, points%np), points%xi_n(dp, points%np), source=0.5_wp)
      allocate (points%held(dp, points%np), points%held_n(dp, points%np), source=.false.)
      allocate (points%hist(points%nhist, points%np), points%hist_n(points%nhist, points%np), source=0.0_wp)
      allocate (points%gap(points%np), points%traction(points%np), source=0.0_wp)
      allocate (points%active(points%np), source=.false.)
      geo%ndm = model%ndm
      geo%dp = dp
      i = 0
      do f = 1, points%slave%set%ne
        nodes => points%slave%set%connectivity(f)
        geo%nen = size(nodes)
        geo%nes = geo%nen
        geo%degree = points%slave%set%degree(:, f)
        geo%ce => points%slave%set%operator(f)
        xe(:, 1:geo%nen) = model%x(:, nodes)
        we(1:geo%nen) = model%w(nodes)
        geo%xe => xe(:, 1:geo%nen)
        geo%we => we(1:geo%nen)
        do g = 1, size(wt)
          i = i + 1
          points%facet_of(i) = f
          points%point(:, i) = rule(:, g)
          geo%xi(1:dp) = rule(:, g)
          geo%wt = wt(g)
          geo%table => points%table(:, i)
          call it%element%evaluate(task_prepare, geo, state, fe, ke, energy, status)
          if (status /= ok) then
            place = f
            return
          end if
        end do
      end do
      reach = it%reach
      if (.not. reach > 0) reach = it%offset &
        + 2*max(largest_facet(model, points%slave), largest_facet(model, points%master))
    end associate
    call start_search(points%search, model%ndm, points%master, reach)
    points%search%offset = model%interfaces(number)%offset
    allocate (points%element, source=model%interfaces(number)%element)
    if (model%interfaces(number)%side == 0) call find_side(model, points, model%interfaces(number)%side, status)
    if (status /= ok) return
    points%search%side = real(model%interfaces(number)%side, wp)
    if (points%nhist == 0) return
    call begin_histories(model, number, points, status)
    if (status == ok .and. points%np_bonded == 0) status = nothing_bonded
  end subroutine prepare_interface

  subroutine find_side(model, points, side, status)
    !! The sign with which the master's normal points to the slave's points in the reference position, however far away.
    type(model_type), intent(in) :: model
    type(interface_points_type), intent(inout), target :: points
    integer, intent(out) :: side                    !! 1 for a solid's surface, which has an outside
    integer, intent(out) :: status                  !! ok, side_unknown
    real(wp), parameter :: rounding = 1.0e-10_wp    !! of the model's size
    real(wp) :: reach, size_, height, least, most
    integer :: i

    side = 1
    status = ok
    if (all(points%master%side > 0)) return
    reach = points%search%reach
    size_ = norm2(maxval(model%x, 2) - minval(model%x, 2))
    points%search%reach = max(reach, 2*size_)
    call pair_interface(model, points, model%x)
    least = 0
    most = 0
    do i = 1, points%np
      if (points%facet(i) == 0) cycle
      call height_above_master(model, points, model%x, i, points%facet(i), points%xi(:, i), height, status)
      if (status /= ok) return
      least = min(least, height)
      most = max(most, height)
    end do
    if (-least > most) side = -1
    if (min(-least, most) > rounding*size_ .or. max(-least, most) <= rounding*size_) status = side_unknown
    points%search%reach = reach
    points%facet = 0
    points%xi = 0.5_wp
    points%held = .false.
    points%forced = 0
    call forget_search(points)
  end subroutine find_side

  subroutine height_above_master(model, points, x, i, m, xi, height, status)
    !! (x_s - x_m) . n of a slave point over a place of the master, with the normal t_1 x t_2.
    type(model_type), intent(in) :: model
    type(interface_points_type), intent(in), target :: points
    real(wp), intent(in) :: x(:, :)    !! positions of the nodes (ndm,nn) [length]
    integer, intent(in) :: i           !! point
    integer, intent(in) :: m           !! master facet
    real(wp), intent(in) :: xi(:)      !! place on it (dp)
    real(wp), intent(out) :: height    !! [length]
    integer, intent(out) :: status
    real(wp), dimension(model%ndm) :: xs, xm, nrm
    real(wp) :: shp(points%nen_max), dshp(model%ndm - 1, points%nen_max), d2shp(0, 0), tau(model%ndm, model%ndm - 1), area
    integer, pointer, contiguous :: nodes(:)
    integer :: n

    nodes => points%master%set%connectivity(m)
    n = size(nodes)
    height = 0
    call place_of_slave(x, points, i, xs)
    call shape_functions(points%master%set%degree(1:model%ndm - 1, m), model%w(nodes), points%master%set%operator(m), xi, 1, &
                         shp(1:n), dshp(:, 1:n), d2shp, status)
    if (status /= ok) return
    call tangent_frame_at(x(:, nodes), shp(1:n), dshp(:, 1:n), xm, tau, nrm, area, status)
    if (status == ok) height = dot_product(xs - xm, nrm)
  end subroutine height_above_master

  subroutine begin_histories(model, number, points, status)
    !! Bond the points that the deck says and that have a partner in the reference position.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: number
    type(interface_points_type), intent(inout), target :: points
    integer, intent(out) :: status
    type(pair_work), target :: work
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    real(wp) :: xs(model%ndm), u(model%ndf, model%nn)
    integer :: i, s
    logical :: bonded

    status = ok
    u = 0
    call start_work(model, number, points, 0.0_wp, 0.0_wp, work, geo, state)
    associate (el => points%element)
      do i = 1, points%np
        s = points%facet_of(i)
        call place_of_slave(model%x, points, i, xs)
        bonded = is_bonded_at(model, model%interfaces(number)%regions, xs, points%slave%element(s), points%slave%side(s))
        call el%begin_history(bonded, points%hist_n(:, i))
      end do
      call pair_interface(model, points, model%x)
      do i = 1, points%np
        if (.not. el%is_bonded(points%hist_n(:, i))) cycle
        bonded = points%facet(i) > 0
        if (bonded) then
          call gather_pair(model, points, i, u, u, el%ndf, .false., work, geo, state)
          call el%evaluate(task_residual, geo, state, work%fe, work%ke, energy, status)
          if (status /= ok) return
          bonded = el%is_bonded(points%hist(:, i))
        end if
        if (.not. bonded) call el%begin_history(.false., points%hist_n(:, i))
        if (bonded) points%np_bonded = points%np_bonded + 1
      end do
    end associate
    points%hist = points%hist_n
    call commit_interface(points)
    call forget_search(points)
  end subroutine begin_histories

  pure subroutine place_of_slave(x, points, i, xs)
    !! Position of a slave point.
    real(wp), intent(in) :: x(:, :)                 !! of the nodes (ndm,nn) [length]
    type(interface_points_type), intent(in) :: points
    integer, intent(in) :: i
    real(wp), intent(out) :: xs(:)                  !! (ndm) [length]
    integer :: a, first

    associate (set => points%slave%set)
      first = set%node_ptr(points%facet_of(i)) - 1
      xs = 0
      do a = 1, set%nen(points%facet_of(i))
        xs = xs + points%table(1 + a, i)*x(:, set%nodes(first + a))
      end do
    end associate
  end subroutine place_of_slave

  function largest_facet(model, surface) result(size_)
    !! Longest diagonal of the facets' control polygons [length].
    type(model_type), intent(in) :: model
    type(facet_surface), intent(in), target :: surface
    real(wp) :: size_
    integer, pointer, contiguous :: nodes(:)
    integer :: f

    size_ = 0
    do f = 1, surface%set%ne
      nodes => surface%set%connectivity(f)
      size_ = max(size_, norm2(maxval(model%x(:, nodes), 2) - minval(model%x(:, nodes), 2)))
    end do
  end function largest_facet

  subroutine pair_interface(model, points, x)
    !! Pair every slave point in the current position.
    type(model_type), intent(in) :: model
    type(interface_points_type), intent(inout), target :: points
    real(wp), intent(in) :: x(:, :)                 !! current positions (ndm,nn) [length]
    real(wp) :: xs(model%ndm)
    integer :: i
    logical :: forced, bonded

    if (allocated(points%search%x)) then
      if (all(abs(points%search%x - x) <= 0)) return  ! the pairs stand: pairing again could release a forced one
    end if
    points%forced = 0
    call move_master(points%search, x)
    do i = 1, points%np
      call place_of_slave(x, points, i, xs)
      bonded = .false.
      if (points%nhist > 0) bonded = points%element%is_bonded(points%hist_n(:, i))
      call pair_point(points%search, points%master, model%w, xs, bonded, points%facet(i), points%xi(:, i), &
                      points%held(:, i), forced)
      if (forced) points%forced = points%forced + 1
    end do
  end subroutine pair_interface

  subroutine assemble_interface(model, number, points, task, u, un, du, moves, time, dt, system, f, f_moved, &
                                energies, status, place)
    !! Add the forces of all paired points to f and, in task_tangent, their tangents to the system. Pairs of which a node
    !! `moves` with a prescribed increment or rate du add ke du to f_moved.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: number                   !! index into model%interfaces
    type(interface_points_type), intent(inout), target :: points
    integer, intent(in) :: task
    real(wp), intent(in) :: u(:, :), un(:, :), du(:, :)
    logical, intent(in) :: moves(:)
    real(wp), intent(in) :: time, dt
    type(equation_system_type), intent(inout) :: system
    real(wp), intent(inout) :: f(:, :)              !! nodal forces (ndf,nn)
    real(wp), intent(inout) :: f_moved(:, :)        !! their first-order change by du (ndf,nn)
    type(element_energy), intent(inout) :: energies !! sums
    integer, intent(out) :: status, place           !! the first failure and its point
    type(pair_work), target :: work
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    integer :: i, a

    status = ok
    place = 0
    call start_work(model, number, points, time, dt, work, geo, state)
    associate (el => model%interfaces(number)%element)
      do i = 1, points%np
        points%gap(i) = 0
        points%traction(i) = 0
        points%active(i) = .false.
        if (points%facet(i) == 0) then
          if (points%nhist == 0) cycle
          if (el%is_bonded(points%hist_n(:, i))) then
            status = bond_lost
            place = i
            return
          end if
        end if
        call gather_pair(model, points, i, u, un, el%ndf, task == task_tangent, work, geo, state)
        call el%evaluate(task, geo, state, work%fe, work%ke, energy, status)
        if (status /= ok) then
          place = i
          return
        end if
        points%gap(i) = energy%gap
        energies%stored = energies%stored + energy%stored
        energies%dissipated = energies%dissipated + energy%dissipated
        if (.not. energy%active) cycle
        points%traction(i) = energy%traction
        points%active(i) = .true.
        energies%penalty = energies%penalty + energy%penalty
        energies%gap = min(energies%gap, energy%gap)
        associate (nodes => work%nodes(1:geo%nen))
          if (task == task_tangent) then
            if (size(moves) > 0) then
              if (any(moves(nodes))) call add_moved_force(work%ke, du, nodes, el%symmetric, f_moved)
            end if
            call system%add_loose(nodes, work%ke, el%symmetric)
          end if
          do a = 1, geo%nen
            f(1:el%ndf, nodes(a)) = f(1:el%ndf, nodes(a)) + work%fe(:, a)
          end do
        end associate
      end do
    end associate
  end subroutine assemble_interface

  subroutine add_dissipation_gradient(model, number, points, u, un, time, dt, g)
    !! Add the gradient of the interface's dissipated energy with respect to all control values, at the pairs of the
    !! last search. History is left alone.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: number                   !! index into model%interfaces
    type(interface_points_type), intent(inout), target :: points
    real(wp), intent(in) :: u(:, :), un(:, :)
    real(wp), intent(in) :: time, dt
    real(wp), intent(inout) :: g(:, :)              !! (ndf,nn) [force]
    type(pair_work), target :: work
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    integer :: i, a, status

    if (points%nhist == 0) return
    call start_work(model, number, points, time, dt, work, geo, state)
    associate (el => model%interfaces(number)%element)
      do i = 1, points%np
        if (points%facet(i) == 0) cycle
        call gather_pair(model, points, i, u, un, el%ndf, .false., work, geo, state)
        call el%evaluate(task_dissipation_gradient, geo, state, work%fe, work%ke, energy, status)
        if (status /= ok) cycle                     ! the residual at the same state has said so
        do a = 1, geo%nen
          g(1:el%ndf, work%nodes(a)) = g(1:el%ndf, work%nodes(a)) + work%fe(:, a)
        end do
      end do
    end associate
  end subroutine add_dissipation_gradient

  subroutine start_work(model, number, points, time, dt, work, geo, state)
    !! Memory for one pair at a time, and what all pairs of an interface share.
    type(model_type), intent(in) :: model
    integer, intent(in) :: number
    type(interface_points_type), intent(in) :: points
    real(wp), intent(in) :: time, dt
    type(pair_work), intent(out) :: work
    type(element_geometry), intent(inout) :: geo
    type(element_state), intent(inout) :: state

    associate (n => points%nen_max)
      allocate (work%nodes(n), work%xe(model%ndm, n), work%we(n), work%wm(n), work%u(model%ndf*n), work%un(model%ndf*n), &
        work%f(model%ndf*n), work%k((model%ndf*n)**2))
    end associate
    geo%ndm = model%ndm
    geo%dp = model%ndm - 1
    geo%master%side = real(model%interfaces(number)%side, wp)
    geo%master%offset = model%interfaces(number)%offset
    state%time = time
    state%dt = dt
  end subroutine start_work

  subroutine gather_pair(model, points, i, u, un, ndf, want_tangent, work, geo, state)
    !! Geometry and state of point i with its master facet, or alone if it is unpaired.
    type(model_type), intent(in), target :: model
    type(interface_points_type), intent(inout), target :: points
    integer, intent(in) :: i
    real(wp), intent(in) :: u(:, :), un(:, :)
    integer, intent(in) :: ndf
    logical, intent(in) :: want_tangent
    type(pair_work), intent(inout), target :: work
    type(element_geometry), intent(inout) :: geo
    type(element_state), intent(inout) :: state
    integer :: a, n, ns, nm, s, m

    s = points%facet_of(i)
    m = points%facet(i)
    ns = points%slave%set%nen(s)
    nm = 0
    if (m > 0) nm = points%master%set%nen(m)
    n = ns + nm
    work%nodes(1:ns) = points%slave%set%connectivity(s)
    if (m > 0) work%nodes(ns + 1:n) = points%master%set%connectivity(m)
    geo%nen = n
    geo%nes = ns
    geo%degree = points%slave%set%degree(:, s)
    geo%ce => points%slave%set%operator(s)
    state%ue(1:ndf, 1:n) => work%u
    state%un(1:ndf, 1:n) => work%un
    do a = 1, n
      work%xe(:, a) = model%x(:, work%nodes(a))
      state%ue(:, a) = u(1:ndf, work%nodes(a))
      state%un(:, a) = un(1:ndf, work%nodes(a))
    end do
    work%we(1:ns) = model%w(work%nodes(1:ns))
    work%wm(1:nm) = model%w(work%nodes(ns + 1:n))
    geo%xe => work%xe(:, 1:n)
    geo%we => work%we(1:ns)
    geo%table => points%table(:, i)
    geo%master%nen = nm
    if (m > 0) then
      geo%master%degree = points%master%set%degree(1:2, m)
      geo%master%xi(1:geo%dp) = points%xi(:, i)
      geo%master%held(1:geo%dp) = points%held(:, i)
      geo%master%we => work%wm(1:nm)
      geo%master%ce => points%master%set%operator(m)
    end if
    state%hist => points%hist(:, i)
    state%hist_n => points%hist_n(:, i)
    work%fe(1:ndf, 1:n) => work%f
    if (want_tangent) then
      work%ke(1:ndf, 1:n, 1:ndf, 1:n) => work%k
    else
      work%ke(1:0, 1:0, 1:0, 1:0) => work%k
    end if
  end subroutine gather_pair

  subroutine commit_interface(points)
    type(interface_points_type), intent(inout) :: points
    points%facet_n = points%facet
    points%xi_n = points%xi
    points%held_n = points%held
    points%hist_n = points%hist
  end subroutine commit_interface

  subroutine roll_back_interface(points)
    type(interface_points_type), intent(inout) :: points
    points%facet = points%facet_n
    points%xi = points%xi_n
    points%held = points%held_n
    points%hist = points%hist_n
    ! the pairs are no longer those of the position searched last, even if the next attempt begins there
    if (allocated(points%search%x)) deallocate (points%search%x)
  end subroutine roll_back_interface

  subroutine forget_search(points)
    !! Let the next search begin as a restarted run does.
    type(interface_points_type), intent(inout) :: points
    points%search%tree%nnodes = 0
    points%search%boxes_moved = -1
    if (allocated(points%search%x)) deallocate (points%search%x)
  end subroutine forget_search
end module interface_points
