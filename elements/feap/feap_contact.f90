module feap_contact
  !! Interfaces in FEAP: each Gauss point of the slave surface is an element, whose nodes are those of its slave facet and
  !! of the master facet that it is paired with at present. Pairing rewrites the master nodes. History stays with the
  !! point, in FEAP's arrays; who was paired with whom is kept here.
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use extraction_mesh, only: whole_number
  use gauss_rules, only: tensor_rule
  use surface_facets, only: facet_surface, build_surface_facets
  use contact_search, only: master_search, start_search, move_master, pair_point
  use user_element, only: element_geometry, element_state, element_energy, mirror, task_prepare, task_tangent
  use feap_host, only: fail
  use feap_arrays, only: space_dimension
  use feap_materials, only: of_material
  use feap_mesh, only: pass, mesh, find_surface, weights_of
  implicit none (type, external)
  private
  public :: add_interface, largest_pair, interface_count, point_range, pair_nodes
  public :: begin_interfaces, pair_interfaces, point_forces, history_size, first_history, note_history

  type :: bond_box
    logical :: bonded = .true.
    real(wp) :: low(3) = 0, high(3) = 0      !! bounds [length]
  end type bond_box
  public :: bond_box

  type :: interface_type
    integer :: first = 0                     !! FEAP's element number of the first point
    integer :: np = 0, gp = 0                !! points; per direction of a facet
    integer :: material = 0
    real(wp) :: side = 1, reach = 0
    real(wp) :: offset = 0                   !! distance of mid-surfaces whose shells touch [length]
    type(facet_surface) :: slave, master
    type(master_search) :: search
    type(bond_box), allocatable :: boxes(:)
    integer, allocatable :: facet_of(:)      !! (np) slave facet
    real(wp), allocatable :: table(:, :)     !! (:,np) what the element precomputed: w_g j_g, slave functions
    integer, allocatable :: facet(:)         !! (np) master facet, 0: unpaired
    real(wp), allocatable :: xi(:, :)        !! (dp,np) projection
    logical, allocatable :: held(:, :)       !! (dp,np) it rests on a kink
    logical, allocatable :: bonded(:)        !! (np) the committed history can still pull
  end type interface_type

  type(interface_type), allocatable, target, save :: interfaces(:)
  integer, save :: of_pass = 0               !! pass over the deck that they belong to
  real(wp), allocatable, save :: w(:)        !! weights of all nodes

contains

  subroutine add_interface(slave, master, gp, side, reach, offset, material, first, boxes, np)
    character(*), intent(in) :: slave, master    !! names of surfaces
    integer, intent(in) :: gp                    !! Gauss points per direction
    real(wp), intent(in) :: side                 !! +1 or -1: the master's outward normal is side*n
    real(wp), intent(in) :: reach                !! search distance, 0: offset and twice the longest facet [length]
    real(wp), intent(in) :: offset               !! distance of the surfaces at which the gap is 0 [length]
    integer, intent(in) :: material, first       !! of its elements; number of the first
    type(bond_box), intent(in) :: boxes(:)
    integer, intent(out) :: np                   !! points, each an element
    type(interface_type), allocatable :: longer(:)
    integer, allocatable :: elements(:), sides(:)
    integer :: dp, i, n

    if (of_pass /= pass) then
      if (allocated(interfaces)) deallocate (interfaces)
      allocate (interfaces(0))
      of_pass = pass
    end if
    n = size(interfaces)
    allocate (longer(n + 1))
    longer(1:n) = interfaces
    call move_alloc(longer, interfaces)
    associate (it => interfaces(n + 1))
      call find_surface(slave, elements, sides)
      call build_surface_facets(mesh, elements, sides, it%slave)
      call find_surface(master, elements, sides)
      call build_surface_facets(mesh, elements, sides, it%master)
      if (it%slave%set%ne == 0 .or. it%master%set%ne == 0) &
        call fail('CONTact: surface "'//slave//'" or "'//master//'" has no elements')
      dp = space_dimension() - 1
      if (any(it%slave%set%dp(1:it%slave%set%ne) /= dp) .or. any(it%master%set%dp(1:it%master%set%ne) /= dp)) &
        call fail('CONTact: "'//slave//'" or "'//master//'" is no surface (of solids their sides, of shells the elements)')
      it%gp = gp
      it%side = side
      it%reach = reach
      it%offset = offset
      it%material = material
      it%first = first
      it%np = it%slave%set%ne*gp**dp
      it%boxes = boxes
      it%facet_of = [(1 + (i - 1)/gp**dp, i=1, it%np)]
      allocate (it%facet(it%np), source=0)
      allocate (it%xi(dp, it%np), source=0.5_wp)
      allocate (it%held(dp, it%np), it%bonded(it%np), source=.false.)
      np = it%np
    end associate
  end subroutine add_interface

  integer function interface_count()
    interface_count = 0                          ! a problem may have none, though the one before had some
    if (allocated(interfaces) .and. of_pass == pass) interface_count = size(interfaces)
  end function interface_count

  integer function largest_pair()
    !! Nodes of a point's element at most.
    integer :: i, f, ns, nm

    largest_pair = 0
    do i = 1, size(interfaces)
      ns = 0
      nm = 0
      do f = 1, interfaces(i)%slave%set%ne
        ns = max(ns, interfaces(i)%slave%set%nen(f))
      end do
      do f = 1, interfaces(i)%master%set%ne
        nm = max(nm, interfaces(i)%master%set%nen(f))
      end do
      largest_pair = max(largest_pair, ns + nm)
    end do
  end function largest_pair

  subroutine pair_nodes(element, nodes)
    !! Nodes of a point's element now: of its slave facet, then of its master facet.
    integer, intent(in) :: element               !! FEAP's number
    integer, allocatable, intent(out) :: nodes(:)
    integer, pointer, contiguous :: slave(:), master(:)
    integer :: n, i

    call find_point(element, n, i)
    slave => interfaces(n)%slave%set%connectivity(interfaces(n)%facet_of(i))
    nodes = slave
    if (interfaces(n)%facet(i) == 0) return
    master => interfaces(n)%master%set%connectivity(interfaces(n)%facet(i))
    nodes = [slave, master]
  end subroutine pair_nodes

  subroutine find_point(element, n, i)
    integer, intent(in) :: element               !! FEAP's number
    integer, intent(out) :: n, i                 !! interface and its point

    do n = 1, interface_count()
      i = element - interfaces(n)%first + 1
      if (i >= 1 .and. i <= interfaces(n)%np) return
    end do
    n = 0
    call fail('element '//whole_number(element)// &
      ' is no point of an interface. Elements of this material are made by CONTact, not by ELEMents')
  end subroutine find_point

  subroutine begin_interfaces(x)
    !! What the points precompute, the search, the first pairs, and which points are bonded.
    real(wp), intent(in) :: x(:, :)              !! reference positions (ndm,numnp) [length]
    type(interface_type), pointer :: it
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    real(wp), allocatable :: rule(:, :), wt(:)
    real(wp), allocatable, target :: xe(:, :), we(:)
    integer, pointer, contiguous :: nodes(:)
    real(wp) :: fe(0, 0), ke(0, 0, 0, 0), reach
    integer :: n, i, g, k, nt, nhist, most, status

    w = spread(1.0_wp, 1, size(x, 2))
    call weights_of([(i, i=1, size(x, 2))], w)
    geo%ndm = size(x, 1)
    geo%dp = geo%ndm - 1
    do n = 1, size(interfaces)
      it => interfaces(n)
      if (allocated(rule)) deallocate (rule, wt)
      allocate (rule(geo%dp, it%gp**geo%dp), wt(it%gp**geo%dp))
      call tensor_rule([(it%gp, i=1, geo%dp)], rule, wt)
      most = 0
      do k = 1, it%slave%set%ne
        most = max(most, it%slave%set%nen(k))
      end do
      if (allocated(it%table)) deallocate (it%table)
      allocate (it%table(most + 1, it%np))
      do i = 1, it%np
        k = it%facet_of(i)
        g = i - (k - 1)*size(wt)
        nodes => it%slave%set%connectivity(k)
        geo%nen = size(nodes)
        geo%nes = geo%nen
        geo%degree = it%slave%set%degree(:, k)
        geo%ce => it%slave%set%operator(k)
        xe = x(:, nodes)
        we = w(nodes)
        geo%xe => xe
        geo%we => we
        geo%xi(1:geo%dp) = rule(:, g)
        geo%wt = wt(g)
        geo%table => it%table(:, i)
        call of_material(it%material)%element%sizes(geo, nt, nhist)
        call of_material(it%material)%element%evaluate(task_prepare, geo, state, fe, ke, energy, status)
        if (status /= ok) call fail('slave facet '//whole_number(k)//' of an interface: '//status_text(status))
      end do
      reach = it%reach
      if (.not. reach > 0) reach = it%offset + 2*max(longest_facet(it%slave, x), longest_facet(it%master, x))
      call start_search(it%search, geo%ndm, it%master, reach)
      it%search%side = it%side
      it%search%offset = it%offset
      it%facet = 0
      it%xi = 0.5_wp
      it%held = .false.
      it%bonded = .false.
    end do
    call pair_interfaces(x)
    do n = 1, size(interfaces)
      call begin_bonds(interfaces(n), x)
    end do
  end subroutine begin_interfaces

  function longest_facet(surface, x) result(length)
    !! Longest diagonal of the facets' control polygons [length].
    type(facet_surface), intent(in), target :: surface
    real(wp), intent(in) :: x(:, :)
    real(wp) :: length
    integer, pointer, contiguous :: nodes(:)
    integer :: f

    length = 0
    do f = 1, surface%set%ne
      nodes => surface%set%connectivity(f)
      length = max(length, norm2(maxval(x(:, nodes), 2) - minval(x(:, nodes), 2)))
    end do
  end function longest_facet

  subroutine begin_bonds(it, x)
    !! Bonded: in a BONDed box, if there is one, in no UNBOnded one, and with a partner.
    type(interface_type), intent(inout) :: it
    real(wp), intent(in) :: x(:, :)
    real(wp) :: xs(size(x, 1))
    real(wp), allocatable :: hist(:)
    logical :: inside
    integer :: i, b, nt, nhist

    call history_size(it%material, nt, nhist)
    allocate (hist(nhist))
    do i = 1, it%np
      xs = slave_place(it, i, x)
      it%bonded(i) = it%facet(i) > 0
      if (it%bonded(i) .and. any(it%boxes%bonded)) it%bonded(i) = .false.
      do b = 1, size(it%boxes)
        inside = all(xs >= it%boxes(b)%low(1:size(xs)) .and. xs <= it%boxes(b)%high(1:size(xs)))
        if (inside .and. it%boxes(b)%bonded .and. it%facet(i) > 0) it%bonded(i) = .true.
      end do
      do b = 1, size(it%boxes)
        inside = all(xs >= it%boxes(b)%low(1:size(xs)) .and. xs <= it%boxes(b)%high(1:size(xs)))
        if (inside .and. .not. it%boxes(b)%bonded) it%bonded(i) = .false.
      end do
      call of_material(it%material)%element%begin_history(it%bonded(i), hist)
      it%bonded(i) = of_material(it%material)%element%is_bonded(hist)
    end do
  end subroutine begin_bonds

  subroutine history_size(material, ntable, nhist)
    integer, intent(in) :: material
    integer, intent(out) :: ntable, nhist
    type(element_geometry) :: geo

    call of_material(material)%element%sizes(geo, ntable, nhist)
  end subroutine history_size

  pure function slave_place(it, i, x) result(xs)
    type(interface_type), intent(in) :: it
    integer, intent(in) :: i
    real(wp), intent(in) :: x(:, :)              !! (ndm,numnp) [length]
    real(wp) :: xs(size(x, 1))
    integer :: a, k

    k = it%slave%set%node_ptr(it%facet_of(i))
    xs = 0
    do a = 1, it%slave%set%nen(it%facet_of(i))
      xs = xs + it%table(1 + a, i)*x(:, it%slave%set%nodes(k + a - 1))
    end do
  end function slave_place

  subroutine pair_interfaces(x)
    !! Pair every point in the present position.
    real(wp), intent(in) :: x(:, :)              !! (ndm,numnp) [length]
    logical :: forced
    integer :: n, i

    do n = 1, size(interfaces)
      associate (it => interfaces(n))
        if (allocated(it%search%x)) then
          if (all(abs(it%search%x - x) <= 0)) cycle   ! the pairs stand: a new search could release a forced one
        end if
        call move_master(it%search, x)
        do i = 1, it%np
          call pair_point(it%search, it%master, w, slave_place(it, i, x), it%bonded(i), it%facet(i), it%xi(:, i), &
                          it%held(:, i), forced)
          if (it%bonded(i) .and. it%facet(i) == 0) call fail('element '//whole_number(it%first + i - 1)// &
            ': a bonded point has lost its partner. Take smaller steps (DT)')
        end do
      end associate
    end do
  end subroutine pair_interfaces

  subroutine point_range(n, first, last)
    integer, intent(in) :: n                     !! interface
    integer, intent(out) :: first, last          !! its elements in FEAP

    first = interfaces(n)%first
    last = first + interfaces(n)%np - 1
  end subroutine point_range

  subroutine point_forces(element, material, task, ndf, ndm, nel, nst, xl, ul, hist_n, hist, s, p, energy)
    !! FEAP's p = -fe and s = ke of one point.
    integer, intent(in) :: element, material     !! FEAP's numbers
    integer, intent(in) :: task                  !! task_residual, task_tangent
    integer, intent(in) :: ndf, ndm, nel, nst
    real(wp), intent(in), target :: xl(ndm, nel)
    real(wp), intent(in) :: ul(ndf, nel)
    real(wp), intent(in), target :: hist_n(:)
    real(wp), intent(inout), target, contiguous :: hist(:)
    real(wp), intent(inout) :: s(nst, nst), p(nst)
    type(element_energy), intent(out) :: energy
    real(wp), target :: ue(ndm, nel), we(nel), committed(size(hist_n))
    real(wp) :: fe(ndm, nel), ke(ndm, nel, ndm, nel)
    type(interface_type), pointer :: it
    type(element_geometry) :: geo
    type(element_state) :: state
    integer :: n, i, k, ns, nm, a, b, j, status

    call find_point(element, n, i)
    it => interfaces(n)
    k = it%facet_of(i)
    ns = it%slave%set%nen(k)
    nm = 0
    if (it%facet(i) > 0) nm = it%master%set%nen(it%facet(i))
    if (nel /= ns + nm) call fail('element '//whole_number(element)//' has '//whole_number(nel)// &
      ' nodes, its pair '//whole_number(ns + nm)//'. Renew the pairs by PAIR, and do not TIE across the interface')
    ue = ul(1:ndm, :)
    committed = hist_n
    we(1:ns) = w(it%slave%set%connectivity(k))
    geo%ndm = ndm
    geo%dp = ndm - 1
    geo%nen = nel
    geo%nes = ns
    geo%degree = it%slave%set%degree(:, k)
    geo%ce => it%slave%set%operator(k)
    geo%xe => xl
    geo%we => we(1:ns)
    geo%table => it%table(:, i)
    geo%master%nen = nm
    geo%master%side = it%side
    geo%master%offset = it%offset
    if (nm > 0) then
      we(ns + 1:nel) = w(it%master%set%connectivity(it%facet(i)))
      geo%master%degree = it%master%set%degree(1:2, it%facet(i))
      geo%master%xi(1:ndm - 1) = it%xi(:, i)
      geo%master%held(1:ndm - 1) = it%held(:, i)
      geo%master%we => we(ns + 1:nel)
      geo%master%ce => it%master%set%operator(it%facet(i))
    end if
    state%ue => ue
    state%un => ue
    state%hist_n => committed
    state%hist => hist
    call of_material(material)%element%evaluate(task, geo, state, fe, ke, energy, status)
    it%bonded(i) = of_material(material)%element%is_bonded(committed)
    if (status /= ok) call fail('element '//whole_number(element)//': '//status_text(status)//'. Take smaller steps (DT)')
    if (.not. energy%active) return
    do a = 1, nel
      p(ndf*(a - 1) + 1:ndf*(a - 1) + ndm) = -fe(:, a)
    end do
    if (task /= task_tangent) return
    if (of_material(material)%element%symmetric) call mirror(ke)
    do b = 1, nel
      do j = 1, ndm
        do a = 1, nel
          s(ndf*(a - 1) + 1:ndf*(a - 1) + ndm, ndf*(b - 1) + j) = ke(:, a, j, b)
        end do
      end do
    end do
  end subroutine point_forces

  subroutine first_history(element, material, hist)
    !! History before the first step.
    integer, intent(in) :: element, material
    real(wp), intent(out) :: hist(:)
    integer :: n, i

    call find_point(element, n, i)
    call of_material(material)%element%begin_history(interfaces(n)%bonded(i), hist)
  end subroutine first_history

  subroutine note_history(element, material, hist)
    !! The step is accepted: this history becomes the committed one.
    integer, intent(in) :: element, material
    real(wp), intent(in) :: hist(:)
    integer :: n, i

    call find_point(element, n, i)
    interfaces(n)%bonded(i) = of_material(material)%element%is_bonded(hist)
  end subroutine note_history
end module feap_contact
