module contact_search
  !! Which master facet does a slave point project on, and where (Tables 1-3 of the paper)?
  !!
  !! Local: from the last facet and xi; a projection that leaves a facet goes on to its neighbour. Global, for points
  !! without a facet: a tree of bounding boxes gives the facets nearby, nearest box first; the nearest valid
  !! projection wins. Where two facets meet in a kink there may be no valid projection: then the nearest point of the
  !! kink is the pair, and `held` says in which directions xi rests there.
  !!
  !! Beyond the master's edge a point is unpaired, unless it is bonded: then it is projected on the smooth extension of
  !! its facet, by one more facet's length in xi, so that gap, traction and energy go on without a jump; neither is it
  !! lost beyond the search distance. Where the extension ends too it is unpaired, which the caller has to refuse.
  !!
  !! The cone of a kink in which this holds is narrow, (gap) x (angle), and stiff: Newton would leap over it to and fro.
  !! So a penetrating point goes from one facet to the next only by way of the kink: when it has crossed one it is
  !! `forced` to it for one evaluation, whose linearisation tells whether it stays there.
  use kinds, only: wp
  use status_codes, only: ok, outside_facet
  use surface_facets, only: facet_surface
  use rational_basis, only: shape_functions
  use surface_frame, only: tangent_frame_at
  use box_tree, only: box_tree_type
  use bezier_extension, only: extend_bezier
  use closest_point, only: projection_report, homogeneous_points, closest_point_of_bezier, find_closest_point_global
  implicit none (type, external)
  private
  public :: master_search, start_search, move_master, pair_point

  real(wp), parameter :: near_side = 0.05_wp  !! so near to a side, in xi, the neighbour may be nearer
  integer, parameter :: most_hops = 64        !! facets a point may cross in one iteration before the tree is asked
  real(wp), parameter :: extension = 1.0_wp   !! of a facet beyond the master's edge, in xi
  integer, parameter :: most_candidates = 16  !! facets that a global search looks at

  type :: master_search
    !! The master surface in its current position.
    integer :: ndm = 0, dp = 0
    real(wp) :: reach = 0                       !! points farther away stay unpaired [length]
    real(wp) :: side = 1                        !! +1 or -1: the outward normal is side*n
    real(wp) :: offset = 0                      !! distance of the surfaces at which they touch [length]
    integer :: moved = 0                        !! counts the positions of the master
    integer :: searches = 0                     !! global searches since the start
    real(wp), allocatable :: x(:, :)            !! current position of every node (ndm,nn) [length]
    integer, allocatable :: q_ptr(:)            !! (nf+1) first homogeneous Bezier point of each facet, from 1
    real(wp), allocatable :: q(:, :)            !! homogeneous Bezier points (ndm+1,:)
    integer, allocatable :: q_moved(:)          !! (nf) position for which q holds
    type(box_tree_type) :: tree
    real(wp), allocatable :: lo(:, :), hi(:, :) !! boxes of the facets (ndm,nf) [length]
    integer :: boxes_moved = -1                 !! position for which the boxes hold
  end type master_search

contains

  subroutine start_search(search, ndm, surface, reach)
    type(master_search), intent(out) :: search
    integer, intent(in) :: ndm
    type(facet_surface), intent(in) :: surface   !! master
    real(wp), intent(in) :: reach                !! [length]
    integer :: f, nf

    nf = surface%set%ne
    search%ndm = ndm
    search%dp = ndm - 1
    search%reach = reach
    allocate (search%q_ptr(nf + 1), search%q_moved(nf), search%lo(ndm, nf), search%hi(ndm, nf))
    search%q_moved = -1
    search%q_ptr(1) = 1
    do f = 1, nf
      search%q_ptr(f + 1) = search%q_ptr(f) + surface%set%nb(f)
    end do
    allocate (search%q(ndm + 1, search%q_ptr(nf + 1) - 1))
  end subroutine start_search

  subroutine move_master(search, x)
    !! New current positions; what depends on them is renewed when it is needed.
    type(master_search), intent(inout) :: search
    real(wp), intent(in) :: x(:, :)              !! (ndm,nn) [length]

    search%moved = search%moved + 1
    search%x = x
  end subroutine move_master

  subroutine form_facet(search, surface, w, f)
    !! Homogeneous Bezier points of facet f in the current position.
    type(master_search), intent(inout) :: search
    type(facet_surface), intent(in), target :: surface
    real(wp), intent(in) :: w(:)
    integer, intent(in) :: f
    integer, pointer, contiguous :: nodes(:)

    if (search%q_moved(f) == search%moved) return
    nodes => surface%set%connectivity(f)
    call homogeneous_points(w(nodes), surface%set%operator(f), search%x(:, nodes), &
                            search%q(:, search%q_ptr(f):search%q_ptr(f + 1) - 1))
    search%q_moved(f) = search%moved
  end subroutine form_facet

  subroutine form_boxes(search, surface, w)
    !! Boxes of all facets: those of their Bezier points, which contain the facet when the weights are positive.
    type(master_search), intent(inout) :: search
    type(facet_surface), intent(in) :: surface
    real(wp), intent(in) :: w(:)
    integer :: f, b, n

    if (search%boxes_moved == search%moved) return
    n = search%ndm
    do f = 1, surface%set%ne
      call form_facet(search, surface, w, f)
      search%lo(:, f) = huge(1.0_wp)
      search%hi(:, f) = -huge(1.0_wp)
      do b = search%q_ptr(f), search%q_ptr(f + 1) - 1
        search%lo(:, f) = min(search%lo(:, f), search%q(1:n, b)/search%q(n + 1, b))
        search%hi(:, f) = max(search%hi(:, f), search%q(1:n, b)/search%q(n + 1, b))
      end do
    end do
    if (search%tree%nnodes == 0) then
      call search%tree%build(search%lo, search%hi)
    else
      call search%tree%refit(search%lo, search%hi)
    end if
    search%boxes_moved = search%moved
  end subroutine form_boxes

  subroutine pair_point(search, surface, w, xs, bonded, facet, xi, held, forced)
    !! Pair a slave point. On entry facet, xi and held are the last pairing (facet 0: none); on return the new one.
    type(master_search), intent(inout) :: search
    type(facet_surface), intent(in), target :: surface
    real(wp), intent(in) :: w(:)                 !! weights of all nodes
    real(wp), intent(in) :: xs(:)                !! slave point (ndm) [length]
    logical, intent(in) :: bonded                !! it keeps its facet beyond the master's edge and the search distance
    integer, intent(inout) :: facet
    real(wp), intent(inout) :: xi(:)             !! (dp)
    logical, intent(inout) :: held(:)            !! xi rests on a kink in this direction (dp)
    logical, intent(out) :: forced               !! the pair is the kink that the point has just crossed
    type(projection_report) :: report, left
    integer :: hop, f, status, last, previous, side
    real(wp) :: trial(size(xi)), left_xi(size(xi))
    logical :: was_held

    was_held = any(held)
    held = .false.
    forced = .false.

    if (facet > 0) then
      f = facet
      trial = xi
      last = 0
      do hop = 1, most_hops
        call form_facet(search, surface, w, f)
        call closest_point_of_bezier(surface%set%degree(1:search%dp, f), &
          search%q(:, search%q_ptr(f):search%q_ptr(f + 1) - 1), xs, trial, report, status)
        if (status == outside_facet .and. bonded) call project_beyond_edge(search, surface, f, xs, trial, report, status)
        if (status == ok) then
          if (hop == 2 .and. .not. was_held) then
            if (crosses_kink(search, surface, w, xs, last, left_xi, f, trial)) then
              facet = last
              xi = left_xi
              held = left%sides(1:search%dp) /= 0
              forced = .true.
              return
            end if
          end if
          facet = f
          xi = trial
          if (report%distance > search%reach .and. .not. bonded) then
            facet = 0
          else if (any(xi < near_side .or. xi > 1 - near_side)) then
            call try_neighbours(search, surface, w, xs, report%distance, facet, xi)
          end if
          return
        end if
        if (status /= outside_facet) exit
        side = report%sides(1)
        if (side == 0) side = report%sides(2)
        previous = last
        last = f
        left = report
        left_xi = trial
        f = surface%neighbour(side, f)
        if (f == 0) exit
        if (f == previous) then
          ! to and fro across a kink: neither facet holds the projection, the kink itself is nearest
          if (report%distance <= search%reach .or. bonded) then
            facet = last
            xi = trial
            held = report%sides(1:search%dp) /= 0
          else
            facet = 0
          end if
          return
        end if
        call carry_over(surface, last, f, side, trial)
      end do
      facet = 0
      if (bonded) return                         ! another facet would not be the one that it is bonded to
    end if
    call pair_globally(search, surface, w, xs, facet, xi, held)
  end subroutine pair_point

  subroutine project_beyond_edge(search, surface, f, xs, xi, report, status)
    !! Projection on the extension of a facet over those of its sides that are the master's edge.
    type(master_search), intent(in) :: search
    type(facet_surface), intent(in) :: surface
    integer, intent(in) :: f
    real(wp), intent(in) :: xs(:)
    real(wp), intent(inout) :: xi(:)             !! nearest point of the facet; projection
    type(projection_report), intent(inout) :: report
    integer, intent(inout) :: status
    real(wp) :: q(search%ndm + 1, search%q_ptr(f):search%q_ptr(f + 1) - 1), low(size(xi)), high(size(xi))
    integer :: a

    low = 0
    high = 1
    do a = 1, search%dp
      if (report%sides(a) == 0) cycle
      if (surface%neighbour(report%sides(a), f) /= 0) cycle
      if (mod(report%sides(a), 2) == 1) then
        low(a) = -extension
      else
        high(a) = 1 + extension
      end if
    end do
    if (all(low >= 0 .and. high <= 1)) return
    q = search%q(:, search%q_ptr(f):search%q_ptr(f + 1) - 1)
    do a = 1, search%dp
      if (low(a) < 0) call extend_bezier(surface%set%degree(1:search%dp, f), a, low(a), q)
      if (high(a) > 1) call extend_bezier(surface%set%degree(1:search%dp, f), a, high(a), q)
    end do
    xi = (xi - low)/(high - low)
    call closest_point_of_bezier(surface%set%degree(1:search%dp, f), q, xs, xi, report, status)
    xi = low + (high - low)*xi
  end subroutine project_beyond_edge

  function crosses_kink(search, surface, w, xs, from, xi_from, to, xi_to) result(crosses)
    !! Whether a penetrating point has passed a kink between two facets: their normals differ at the common side.
    type(master_search), intent(in) :: search
    type(facet_surface), intent(in), target :: surface
    real(wp), intent(in) :: w(:), xs(:)
    integer, intent(in) :: from, to
    real(wp), intent(in) :: xi_from(:)           !! on the side of `from` that was left
    real(wp), intent(in) :: xi_to(:)             !! projection on `to`
    logical :: crosses
    real(wp) :: at(size(xi_to)), x(search%ndm), nrm(search%ndm), nrm_to(search%ndm)
    integer :: s

    crosses = .false.
    call normal_at(from, xi_from, x, nrm)
    if (search%side*dot_product(xs - x, nrm) >= search%offset) return
    at = xi_to
    do s = 1, size(surface%neighbour, 1)
      if (surface%neighbour(s, to) == from) at((s + 1)/2) = merge(0.0_wp, 1.0_wp, mod(s, 2) == 1)
    end do
    call normal_at(to, at, x, nrm_to)
    crosses = dot_product(nrm, nrm_to) < 1 - 1.0e-8_wp

  contains

    subroutine normal_at(f, xi, x, nrm)
      integer, intent(in) :: f
      real(wp), intent(in) :: xi(:)
      real(wp), intent(out) :: x(:), nrm(:)
      real(wp) :: shp(surface%set%nen(f)), dshp(search%dp, surface%set%nen(f)), d2shp(0, 0)
      real(wp) :: tau(search%ndm, search%dp), area
      integer, pointer, contiguous :: nodes(:)
      integer :: status

      nodes => surface%set%connectivity(f)
      call shape_functions(surface%set%degree(1:search%dp, f), w(nodes), surface%set%operator(f), xi, 1, shp, dshp, &
                           d2shp, status)
      call tangent_frame_at(search%x(:, nodes), shp, dshp, x, tau, nrm, area, status)
    end subroutine normal_at
  end function crosses_kink

  pure subroutine carry_over(surface, from, to, side, xi)
    !! A first guess on the next facet, just inside the common side.
    type(facet_surface), intent(in) :: surface
    integer, intent(in) :: from, to, side
    real(wp), intent(inout) :: xi(:)
    integer :: s

    s = side + merge(1, -1, mod(side, 2) == 1)  ! facets of one patch run alike; in a ring of two both sides would fit
    if (surface%neighbour(s, to) /= from) s = findloc(surface%neighbour(:, to), from, 1)
    if (s == 0) s = side
    if (size(xi) == 1) then
      xi(1) = merge(0.0_wp, 1.0_wp, s == 1)
    else
      ! neighbouring facets of one patch run alike; where they do not, the middle of the side is a safe start
      if ((s + 1)/2 /= (side + 1)/2) xi = 0.5_wp
      xi((s + 1)/2) = merge(0.0_wp, 1.0_wp, mod(s, 2) == 1)
    end if
  end subroutine carry_over

  subroutine pair_globally(search, surface, w, xs, facet, xi, held)
    type(master_search), intent(inout) :: search
    type(facet_surface), intent(in), target :: surface
    real(wp), intent(in) :: w(:)
    real(wp), intent(in) :: xs(:)
    integer, intent(out) :: facet
    real(wp), intent(inout) :: xi(:)
    logical, intent(out) :: held(:)
    integer :: near(most_candidates), n, c, f, status, edge, edge_sides(size(xi))
    integer, pointer, contiguous :: nodes(:)
    real(wp) :: trial(size(xi)), best, edge_best, edge_xi(size(xi))
    type(projection_report) :: report

    held = .false.
    call form_boxes(search, surface, w)
    call search%tree%candidates(search%lo, search%hi, xs, search%reach, near, n)
    search%searches = search%searches + 1
    facet = 0
    edge = 0
    best = search%reach
    edge_best = search%reach
    do c = 1, n
      f = near(c)
      if (sum(max(search%lo(:, f) - xs, 0.0_wp, xs - search%hi(:, f))**2) > best**2) exit
      nodes => surface%set%connectivity(f)
      call find_closest_point_global(surface%set%degree(1:search%dp, f), w(nodes), surface%set%operator(f), &
                                     search%x(:, nodes), xs, trial, report, status)
      if (status == ok .and. report%distance < best) then
        best = report%distance
        facet = f
        xi = trial
      else if (status == outside_facet .and. report%distance < edge_best) then
        edge_best = report%distance
        edge = f
        edge_xi = trial
        edge_sides = report%sides(1:search%dp)
      end if
    end do
    if (edge == 0 .or. (facet > 0 .and. best <= edge_best)) return
    do c = 1, search%dp  ! on the master's own edge the point is unpaired, on a kink it is paired with it
      if (edge_sides(c) == 0) cycle
      if (surface%neighbour(edge_sides(c), edge) == 0) return
    end do
    facet = edge
    xi = edge_xi
    held = edge_sides /= 0
  end subroutine pair_globally

  subroutine try_neighbours(search, surface, w, xs, distance, facet, xi)
    !! Near a kink that bends towards the point both facets hold a projection: the nearer one counts.
    type(master_search), intent(inout) :: search
    type(facet_surface), intent(in), target :: surface
    real(wp), intent(in) :: w(:)
    real(wp), intent(in) :: xs(:)
    real(wp), intent(in) :: distance             !! to the present facet [length]
    integer, intent(inout) :: facet
    real(wp), intent(inout) :: xi(:)
    type(projection_report) :: report
    real(wp) :: trial(size(xi)), best, best_xi(size(xi))
    integer :: a, side, f, status, best_facet

    best = distance - 1.0e-12_wp*search%reach
    best_facet = facet
    best_xi = xi
    do a = 1, search%dp
      if (xi(a) >= near_side .and. xi(a) <= 1 - near_side) cycle
      side = 2*a - merge(1, 0, xi(a) < near_side)
      f = surface%neighbour(side, facet)
      if (f == 0) cycle
      trial = xi
      call carry_over(surface, facet, f, side, trial)
      call form_facet(search, surface, w, f)
      call closest_point_of_bezier(surface%set%degree(1:search%dp, f), &
        search%q(:, search%q_ptr(f):search%q_ptr(f + 1) - 1), xs, trial, report, status)
      if (status /= ok .or. report%distance >= best) cycle
      best = report%distance
      best_facet = f
      best_xi = trial
    end do
    facet = best_facet
    xi = best_xi
  end subroutine try_neighbours
end module contact_search
