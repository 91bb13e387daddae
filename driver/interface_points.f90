module interface_points
  !! The interfaces of a model during a run: slave points with what they precomputed, their pairing and their history;
  !! pairing and assembly. The kernel is reached through the user-element interface, as every element is.
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type
  use gauss_rules, only: gauss_legendre, tensor_rule
  use facets, only: facet_surface, build_facets
  use contact_search, only: master_search, start_search, move_master, pair_point
  use equation_system, only: equation_system_type
  use bulk_elements, only: add_prescribed_force
  use user_element, only: element_geometry, element_state, element_energy, task_prepare, task_tangent
  implicit none (type, external)
  private
  public :: interface_points_type, prepare_interface, pair_interface, assemble_interface, commit_interface, &
    roll_back_interface, pair_lists, pairs_covered, forget_search

  integer, parameter :: margin = 2   !! facets around the present pair that the matrix pattern has room for

  type :: interface_points_type
    type(facet_surface) :: slave, master
    type(master_search) :: search
    integer :: np = 0                           !! points
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
      if (.not. reach > 0) reach = 2*max(largest_facet(model, points%slave), largest_facet(model, points%master))
    end associate
    call start_search(points%search, model%ndm, points%master, reach)
    points%search%side = real(model%interfaces(number)%side, wp)
  end subroutine prepare_interface

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
    integer, pointer, contiguous :: nodes(:)
    real(wp) :: xs(model%ndm)
    integer :: i, a, f
    logical :: forced

    if (allocated(points%search%x)) then
      if (all(abs(points%search%x - x) <= 0)) return  ! the pairs stand: pairing again could release a forced one
    end if
    points%forced = 0
    call move_master(points%search, x)
    do i = 1, points%np
      f = points%facet_of(i)
      nodes => points%slave%set%connectivity(f)
      xs = 0
      do a = 1, size(nodes)
        xs = xs + points%table(1 + a, i)*x(:, nodes(a))
      end do
      call pair_point(points%search, points%master, model%w, xs, points%facet(i), points%xi(:, i), points%held(:, i), &
                      forced)
      if (forced) points%forced = points%forced + 1
    end do
  end subroutine pair_interface

  subroutine assemble_interface(model, number, points, task, u, un, du, moves, time, dt, system, f, energies, status, &
                                place)
    !! Add the forces of all paired points to f and, in task_tangent, their tangents to the system.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: number                   !! index into model%interfaces
    type(interface_points_type), intent(inout), target :: points
    integer, intent(in) :: task
    real(wp), intent(in) :: u(:, :), un(:, :), du(:, :)
    logical, intent(in) :: moves(:)
    real(wp), intent(in) :: time, dt
    type(equation_system_type), intent(inout) :: system
    real(wp), intent(inout) :: f(:, :)
    type(element_energy), intent(inout) :: energies !! sums
    integer, intent(out) :: status, place           !! the first failure and its point
    real(wp), target :: xe(model%ndm, points%nen_max), we(points%nen_max), wm(points%nen_max)
    real(wp), target :: ue(model%ndf*points%nen_max), une(model%ndf*points%nen_max), fwork(model%ndf*points%nen_max)
    real(wp), target :: kwork((model%ndf*points%nen_max)**2)
    real(wp), pointer, contiguous :: fe(:, :), ke(:, :, :, :)
    integer :: nodes(points%nen_max)
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    integer :: i, a, n, ns, nm, ndf, s, m, dp

    status = ok
    place = 0
    dp = model%ndm - 1
    state%time = time
    state%dt = dt
    geo%ndm = model%ndm
    geo%dp = dp
    geo%master%side = real(model%interfaces(number)%side, wp)
    associate (el => model%interfaces(number)%element)
      ndf = el%ndf
      do i = 1, points%np
        points%gap(i) = 0
        points%traction(i) = 0
        points%active(i) = .false.
        m = points%facet(i)
        if (m == 0) then
          if (points%nhist > 0) points%hist(:, i) = points%hist_n(:, i)
          cycle
        end if
        s = points%facet_of(i)
        ns = points%slave%set%nen(s)
        nm = points%master%set%nen(m)
        n = ns + nm
        nodes(1:ns) = points%slave%set%connectivity(s)
        nodes(ns + 1:n) = points%master%set%connectivity(m)
        geo%nen = n
        geo%nes = ns
        geo%degree = points%slave%set%degree(:, s)
        geo%ce => points%slave%set%operator(s)
        state%ue(1:ndf, 1:n) => ue
        state%un(1:ndf, 1:n) => une
        do a = 1, n
          xe(:, a) = model%x(:, nodes(a))
          state%ue(:, a) = u(1:ndf, nodes(a))
          state%un(:, a) = un(1:ndf, nodes(a))
        end do
        we(1:ns) = model%w(nodes(1:ns))
        wm(1:nm) = model%w(nodes(ns + 1:n))
        geo%xe => xe(:, 1:n)
        geo%we => we(1:ns)
        geo%table => points%table(:, i)
        geo%master%nen = nm
        geo%master%degree = points%master%set%degree(1:2, m)
        geo%master%xi(1:dp) = points%xi(:, i)
        geo%master%held(1:dp) = points%held(:, i)
        geo%master%we => wm(1:nm)
        geo%master%ce => points%master%set%operator(m)
        state%hist => points%hist(:, i)
        state%hist_n => points%hist_n(:, i)
        fe(1:ndf, 1:n) => fwork
        if (task == task_tangent) then
          ke(1:ndf, 1:n, 1:ndf, 1:n) => kwork
        else
          ke(1:0, 1:0, 1:0, 1:0) => kwork
        end if
        call el%evaluate(task, geo, state, fe, ke, energy, status)
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
        if (task == task_tangent) then
          if (size(moves) > 0) then
            if (any(moves(nodes(1:n)))) call add_prescribed_force(ke, du(1:ndf, nodes(1:n)), el%symmetric, fe)
          end if
          call system%add_loose(nodes(1:n), ke, el%symmetric)
        end if
        do a = 1, n
          f(1:ndf, nodes(a)) = f(1:ndf, nodes(a)) + fe(:, a)
        end do
      end do
    end associate
  end subroutine assemble_interface

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

  function pairs_covered(points) result(covered)
    !! Whether the matrix pattern has room for every present pair.
    type(interface_points_type), intent(in) :: points
    logical :: covered
    integer :: i, near((1 + 2*margin)**2 + 1), n

    covered = .true.
    do i = 1, points%np
      if (points%facet(i) == 0 .or. points%facet(i) == points%room_for(i)) cycle
      covered = points%room_for(i) > 0
      if (.not. covered) return
      call facets_around(points%master, points%room_for(i), near, n)
      covered = any(near(1:n) == points%facet(i))
      if (.not. covered) return
    end do
  end function pairs_covered

  subroutine pair_lists(points, ptr, nodes)
    !! Lists of nodes that couple: each slave facet with the master facets around its points' pairs. Notes them as
    !! the pairs that the pattern has room for.
    type(interface_points_type), intent(inout), target :: points
    integer, allocatable, intent(inout) :: ptr(:), nodes(:)   !! lists so far, extended
    integer :: i, k, n, s, near((1 + 2*margin)**2 + 1), ns, first, lists, items
    integer, allocatable :: seen(:)
    integer, pointer, contiguous :: slave_nodes(:), master_nodes(:)

    points%room_for = points%facet
    allocate (seen(points%np*size(near)))
    lists = size(ptr) - 1
    items = size(nodes)
    ns = 0
    first = 1
    do i = 1, points%np
      s = points%facet_of(i)
      if (i > 1) then
        if (points%facet_of(i - 1) /= s) first = ns + 1
      end if
      if (points%facet(i) == 0) cycle
      slave_nodes => points%slave%set%connectivity(s)
      call facets_around(points%master, points%facet(i), near, n)
      do k = 1, n
        if (any(seen(first:ns) == near(k))) cycle
        ns = ns + 1
        seen(ns) = near(k)
        master_nodes => points%master%set%connectivity(near(k))
        call reserve(ptr, lists + 2)
        call reserve(nodes, items + size(slave_nodes) + size(master_nodes))
        nodes(items + 1:items + size(slave_nodes)) = slave_nodes
        items = items + size(slave_nodes)
        nodes(items + 1:items + size(master_nodes)) = master_nodes
        items = items + size(master_nodes)
        lists = lists + 1
        ptr(lists + 1) = items + 1
      end do
    end do
    call cut(ptr, lists + 1)
    call cut(nodes, items)
  end subroutine pair_lists

  pure subroutine cut(array, n)
    !! Keep the first n items; element by element, as the temporary of array(1:n) may be larger than the stack.
    integer, allocatable, intent(inout) :: array(:)
    integer, intent(in) :: n
    integer, allocatable :: smaller(:)
    integer :: i

    allocate (smaller(n))
    do i = 1, n
      smaller(i) = array(i)
    end do
    call move_alloc(smaller, array)
  end subroutine cut

  pure subroutine reserve(array, needed)
    !! Room for so many items; doubling, so that growth costs little.
    integer, allocatable, intent(inout) :: array(:)
    integer, intent(in) :: needed
    integer, allocatable :: larger(:)

    if (size(array) >= needed) return
    allocate (larger(2*needed))
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine reserve

  pure subroutine facets_around(surface, facet, near, n)
    !! A facet and its neighbours up to `margin` steps away.
    type(facet_surface), intent(in) :: surface
    integer, intent(in) :: facet
    integer, intent(out) :: near(:), n
    integer :: ring, first, last, k, s, f

    n = 1
    near(1) = facet
    first = 1
    do ring = 1, margin
      last = n
      do k = first, last
        do s = 1, size(surface%neighbour, 1)
          f = surface%neighbour(s, near(k))
          if (f == 0 .or. n == size(near)) cycle
          if (any(near(1:n) == f)) cycle
          n = n + 1
          near(n) = f
        end do
      end do
      first = last + 1
    end do
  end subroutine facets_around
end module interface_points
