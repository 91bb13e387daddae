module master_patch
  !! A fixed part of a master surface, for hosts whose elements keep their nodes: an interface element there has the
  !! nodes of its slave facet and of the master facets that are near at the start. A point whose nearest master point
  !! lies beyond such a part is told apart from one that has left the master.
  use kinds, only: wp
  use status_codes, only: outside_facet
  use surface_facets, only: facet_surface
  use rational_basis, only: shape_functions
  use surface_frame, only: tangent_frame_at
  use closest_point, only: projection_report, find_closest_point_global
  use contact_search, only: master_search, start_search, move_master, pair_point
  implicit none (type, external)
  private
  public :: master_patch_type, near_facets, cut_patch, pair_in_patch

  type :: master_patch_type
    type(facet_surface) :: surface               !! its facets; nodes are places in the element's list of nodes
    logical, allocatable :: open(:, :)           !! (2*dp,nf) the master goes on behind this side, the patch does not
    type(master_search) :: search
    integer :: dp = 0
  end type master_patch_type

contains

  subroutine near_facets(slave, f, master, x, distance, near)
    !! Master facets whose box of control points is no farther from that of slave facet f than `distance`.
    type(facet_surface), intent(in), target :: slave, master
    integer, intent(in) :: f
    real(wp), intent(in) :: x(:, :)              !! reference control points (ndm,nn) [length]
    real(wp), intent(in) :: distance             !! [length]
    integer, allocatable, intent(out) :: near(:)
    integer, pointer, contiguous :: nodes(:)
    real(wp) :: lo(size(x, 1)), hi(size(x, 1))
    integer :: m

    nodes => slave%set%connectivity(f)
    lo = minval(x(:, nodes), 2) - distance
    hi = maxval(x(:, nodes), 2) + distance
    allocate (near(0))
    do m = 1, master%set%ne
      nodes => master%set%connectivity(m)
      if (all(maxval(x(:, nodes), 2) >= lo) .and. all(minval(x(:, nodes), 2) <= hi)) near = [near, m]
    end do
  end subroutine near_facets

  subroutine cut_patch(master, near, ndm, reach, side, nodes, patch)
    !! The facets `near`; their nodes are appended to `nodes`, each once.
    type(facet_surface), intent(in), target :: master
    integer, intent(in) :: near(:)
    integer, intent(in) :: ndm
    real(wp), intent(in) :: reach                !! of the search [length]
    real(wp), intent(in) :: side                 !! +1 or -1: the outward normal is side*n
    integer, allocatable, intent(inout) :: nodes(:)
    type(master_patch_type), intent(out) :: patch
    integer, pointer, contiguous :: ix(:)
    integer, allocatable :: places(:)
    integer :: a, first, id, k, s

    patch%dp = ndm - 1
    first = size(nodes)
    call patch%surface%set%init()
    allocate (patch%surface%neighbour(2*patch%dp, size(near)), patch%open(2*patch%dp, size(near)))
    patch%surface%element = master%element(near)
    patch%surface%side = master%side(near)
    do k = 1, size(near)
      ix => master%set%connectivity(near(k))
      allocate (places(size(ix)))
      do a = 1, size(ix)
        places(a) = findloc(nodes(first + 1:), ix(a), 1)
        if (places(a) == 0) then
          nodes = [nodes, ix(a)]
          places(a) = size(nodes) - first
        end if
      end do
      call patch%surface%set%add_element(patch%dp, master%set%degree(:, near(k)), first + places, &
                                         master%set%operator(near(k)), id)
      deallocate (places)
      do s = 1, 2*patch%dp
        associate (other => master%neighbour(s, near(k)))
          patch%surface%neighbour(s, k) = findloc(near, other, 1)
          patch%open(s, k) = other > 0 .and. patch%surface%neighbour(s, k) == 0
        end associate
      end do
    end do
    call start_search(patch%search, ndm, patch%surface, reach)
    patch%search%side = side
  end subroutine cut_patch

  subroutine pair_in_patch(patch, w, xs, bonded, facet, xi, held, left)
    !! Pair a slave point; the patch's position is that of the last call of move_master.
    type(master_patch_type), intent(inout), target :: patch
    real(wp), intent(in) :: w(:)                 !! weights of the element's nodes
    real(wp), intent(in) :: xs(:)                !! slave point (ndm) [length]
    logical, intent(in) :: bonded                !! it keeps its facet beyond the master's edge
    integer, intent(inout) :: facet              !! of the patch; 0: unpaired
    real(wp), intent(inout) :: xi(:)
    logical, intent(inout) :: held(:)
    logical, intent(out) :: left                 !! the nearest master point may lie beyond the patch
    logical :: forced
    integer :: a

    call pair_point(patch%search, patch%surface, w, xs, bonded, facet, xi, held, forced)
    ! a host has no memory from one iteration to the next in which the point could rest on the kink
    if (forced) call pair_point(patch%search, patch%surface, w, xs, bonded, facet, xi, held, forced)
    if (facet == 0) then
      left = beyond_open_side(patch, w, xs)
    else
      left = .false.
      do a = 1, patch%dp
        if (held(a) .or. xi(a) < 0) left = left .or. (xi(a) <= 0 .and. patch%open(2*a - 1, facet))
        if (held(a) .or. xi(a) > 1) left = left .or. (xi(a) >= 1 .and. patch%open(2*a, facet))
      end do
    end if
  end subroutine pair_in_patch

  function beyond_open_side(patch, w, xs) result(left)
    !! Whether the nearest point of the patch rests on an open side of it, and the slave point lies within reach of the
    !! tangent plane there: the master, which goes on, may be near.
    type(master_patch_type), intent(in), target :: patch
    real(wp), intent(in) :: w(:), xs(:)
    logical :: left
    type(projection_report) :: report
    integer, pointer, contiguous :: nodes(:)
    real(wp) :: xi(patch%dp), nearest, nearest_xi(patch%dp)
    integer :: a, f, status, nearest_facet, sides(2)

    left = .false.
    nearest = huge(nearest)
    nearest_facet = 0
    do f = 1, patch%surface%set%ne
      nodes => patch%surface%set%connectivity(f)
      call find_closest_point_global(patch%surface%set%degree(1:patch%dp, f), w(nodes), patch%surface%set%operator(f), &
                                     patch%search%x(:, nodes), xs, xi, report, status)
      if (report%distance > nearest) cycle
      nearest = report%distance
      nearest_xi = xi
      nearest_facet = f
      sides = 0
      if (status == outside_facet) sides = report%sides
    end do
    if (nearest_facet == 0) return
    do a = 1, patch%dp
      if (sides(a) > 0) left = left .or. patch%open(sides(a), nearest_facet)
    end do
    if (left) left = height_over(patch, w, nearest_facet, nearest_xi, xs) <= patch%search%reach
  end function beyond_open_side

  function height_over(patch, w, f, xi, xs) result(height)
    !! Distance of a point from the tangent plane of a facet.
    type(master_patch_type), intent(in), target :: patch
    real(wp), intent(in) :: w(:), xi(:), xs(:)
    integer, intent(in) :: f
    real(wp) :: height
    integer, pointer, contiguous :: nodes(:)
    real(wp) :: shp(patch%surface%set%nen(f)), dshp(patch%dp, patch%surface%set%nen(f)), d2shp(0, 0)
    real(wp) :: x(patch%dp + 1), tau(patch%dp + 1, patch%dp), nrm(patch%dp + 1), area
    integer :: status

    nodes => patch%surface%set%connectivity(f)
    call shape_functions(patch%surface%set%degree(1:patch%dp, f), w(nodes), patch%surface%set%operator(f), xi, 1, shp, &
                         dshp, d2shp, status)
    call tangent_frame_at(patch%search%x(:, nodes), shp, dshp, x, tau, nrm, area, status)
    height = abs(dot_product(xs - x, nrm))
  end function height_over
end module master_patch
