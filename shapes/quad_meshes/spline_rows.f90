module spline_rows
  !! Bezier coefficients of an unstructured spline as combinations of its control points.
  !!
  !! A face between knot intervals has its four inner Bezier coefficients from the functions of its
  !! corners alone, by knot insertion in both directions: with the intervals h-, h, h+ before, in
  !! and beyond the face, b_1 = ((h + h+) V_0 + h- V_1)/(h- + h + h+). Coefficients on edges and at
  !! vertices then are the means of those beside them that make the surface C1; where the mesh
  !! is regular the same coefficients are C2. Beyond creases, seams and the boundary intervals are
  !! 0, as for open knot vectors. Next to seams inner coefficients are control points, or follow:
  !! functions of vertices are those of the regular spline without what belongs to these
  !! (truncated), so that all functions sum to one.
  !!
  !! Beside a short seam A is quadratic, and A f_,u a quartic. Its cubic with the same values and
  !! slopes at both ends of the edge stands in its place here (touching_gluing); the rest vanishes
  !! with its slopes at both ends (`quartic_rest`).
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type, next_corner, previous_corner
  use point_joint, only: plane_rows, boundary_plane_rows, twist_rows, alternating_rest
  use seam_lines, only: binds, touching_gluing
  use spline_slots, only: slots_type
  use sparse_row, only: row_type, clear, add_term, add_row, add_scaled_term
  implicit none (type, external)
  private
  public :: spline_space_type, cubic_coefficients, quartic_rest

  type :: spline_space_type
    type(quad_mesh_type) :: mesh
    type(slots_type) :: slots
  end type spline_space_type

contains

  pure subroutine cubic_coefficients(spline, c, b)
    !! Of a face as a bicubic.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner at the origin
    type(row_type), intent(inout) :: b(0:3,0:3)

    integer :: c2, c3, c4

    c2 = next_corner(c)
    c3 = next_corner(c2)
    c4 = next_corner(c3)
    call inner_row(spline, c, b(1,1))
    call inner_row(spline, c2, b(2,1))
    call inner_row(spline, c3, b(2,2))
    call inner_row(spline, c4, b(1,2))
    call vertex_row(spline, c, b(0,0))
    call vertex_row(spline, c2, b(3,0))
    call vertex_row(spline, c3, b(3,3))
    call vertex_row(spline, c4, b(0,3))
    call edge_rows(spline, c, b(1,0), b(2,0))
    call edge_rows(spline, c2, b(3,1), b(3,2))
    call edge_rows(spline, c3, b(2,3), b(1,3))
    call edge_rows(spline, c4, b(0,2), b(0,1))
  end subroutine cubic_coefficients

  pure subroutine quartic_rest(spline, c, s, row)
    !! What a short seam adds to its face f on one side: with A'' = 2 B and the trace's s''' the
    !! rest of A f_,u/d is B s'''/(2 d) u^2 (1-u)^2, of which each side takes half,
    !!
    !!     f := f + q B s'''/(4 d) u^2 (1-u)^2 v (1-v)^3,
    !!
    !! a multiple of one Bernstein polynomial of degree 4, which touches no other edge.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner that the seam's edge starts from
    type(row_type), intent(in) :: s(0:3)         !! Bezier coefficients of the trace
    type(row_type), intent(inout) :: row         !! the quartic coefficient in the edge's middle,
                                                 !! one row inside

    real(wp), parameter :: differences(0:3) = [-1.0_wp, 3.0_wp, -3.0_wp, 1.0_wp]
    real(wp) :: factor
    integer :: k

    associate (mesh => spline%mesh)
      ! u^2 (1-u)^2 v (1-v)^3 is the Bernstein polynomial over 6 and 4, s''' six third differences
      factor = mesh%interval(previous_corner(c))*mesh%bend(c)/(16*mesh%interval(c))
    end associate
    do k = 0, 3
      call add_row(row, factor*differences(k), s(k))
    end do
  end subroutine quartic_rest

  pure recursive subroutine inner_row(spline, c, row)
    !! Inner Bezier coefficient next to a corner.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner
    type(row_type), intent(inout) :: row

    type(row_type) :: other
    real(wp) :: far(2), h
    integer :: last, next, opposite

    call clear(row)
    if (spline%slots%inner(c) < 0) then
      call solved_inner_row(spline, c, row)
      return
    end if
    last = previous_corner(c)
    next = next_corner(c)
    opposite = next_corner(next)
    associate (mesh => spline%mesh, inner => spline%slots%inner)
      if (mesh%seam(c) .or. mesh%seam(last)) then
        if (inner(c) > 0) then
          call add_term(row, inner(c))
        else if (spline%slots%plane(mesh%vertex(c)) > 0) then
          call corner_row(spline, c, row)
        else
          call following_row(spline, c, row)
        end if
        return
      end if
      ! along the edge that starts here, then along the one that ends here
      h = mesh%interval(c)
      far(1) = mesh%across(last) / (mesh%across(last) + h + mesh%across(next))
      h = mesh%interval(last)
      far(2) = mesh%across(c) / (mesh%across(c) + h + mesh%across(opposite))
      call add_scaled_term(row, (1 - far(1))*(1 - far(2)), inner(c))
      if (mesh%seam(next)) then
        call inner_row(spline, next, other)
        call add_row(row, far(1), other)
      else if (far(1) > 0) then
        call add_scaled_term(row, far(1)*(1 - far(2)), inner(next))
      end if
      if (mesh%seam(opposite)) then
        call inner_row(spline, last, other)
        call add_row(row, far(2), other)
      else if (far(2) > 0) then
        call add_scaled_term(row, (1 - far(1))*far(2), inner(last))
      end if
      if (mesh%seam(next) .and. mesh%seam(opposite)) then
        call inner_row(spline, opposite, other)
        call add_row(row, -far(1)*far(2), other)
      else if (far(1)*far(2) > 0 .and. .not. (mesh%seam(next) .or. mesh%seam(opposite))) then
        call add_scaled_term(row, far(1)*far(2), inner(opposite))
      end if
    end associate
  end subroutine inner_row

  pure recursive subroutine solved_inner_row(spline, c, row)
    !! Inner coefficient where a short seam of one edge fades, from the trace's coefficient, the
    !! mean of those of both sides, which follows from the extraordinary point's condition.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner at the end of the seam's edge
    type(row_type), intent(inout) :: row

    type(row_type) :: mean, there
    real(wp) :: h(2)
    integer :: spoke, v

    v = -spline%slots%inner(c)
    spoke = spline%slots%solved(v)
    call solved_row(spline, v, mean)
    associate (mesh => spline%mesh, t => spline%mesh%twin(spoke))
      ! intervals on this side and on the other
      h = mesh%interval([previous_corner(spoke), next_corner(t)])
      if (c == t) h = h([2, 1])
      call inner_row(spline, merge(next_corner(spoke), t, c == t), there)
    end associate
    call add_row(row, sum(h)/h(2), mean)
    call add_row(row, -h(1)/h(2), there)
  end subroutine solved_inner_row

  pure recursive subroutine following_row(spline, c, row)
    !! Inner coefficient next to a seam on the side that follows: k = 1 or 2 of
    !! (f_k1 - s_k)/q + (g_k1 - s_k)/r = H_k/(3d), H the coefficients of A times the spoke's
    !! derivative.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner
    type(row_type), intent(inout) :: row

    type(row_type) :: lead, s(2), s_end
    real(wp) :: a(2), d, q, r
    integer :: edge, t

    associate (mesh => spline%mesh)
      edge = c
      if (.not. binds(mesh, c, 1)) edge = previous_corner(c)
      t = mesh%twin(edge)
      d = mesh%interval(edge)
      q = mesh%interval(previous_corner(edge))
      r = mesh%interval(next_corner(t))
      a = touching_gluing(mesh, edge, merge(1, 2, edge == c))
      call edge_rows(spline, edge, s(1), s(2))
      if (edge == c) then
        call inner_row(spline, next_corner(t), lead)
        call vertex_row(spline, edge, s_end)
        ! H_1 = a_1 (s_1 - s_0) + 2 a_0 (s_2 - s_1)
        call add_row(row, 1 + q/r + q/(3*d)*(a(2) - 2*a(1)), s(1))
        call add_row(row, q/(3*d)*2*a(1), s(2))
        call add_row(row, -q/(3*d)*a(2), s_end)
      else
        call inner_row(spline, t, lead)
        call vertex_row(spline, next_corner(edge), s_end)
        ! H_2 = 2 a_1 (s_2 - s_1) + a_0 (s_3 - s_2)
        call add_row(row, 1 + q/r + q/(3*d)*(2*a(2) - a(1)), s(2))
        call add_row(row, -q/(3*d)*2*a(2), s(1))
        call add_row(row, q/(3*d)*a(1), s_end)
      end if
      call add_row(row, -q/r, lead)
    end associate
  end subroutine following_row

  pure subroutine point_rows(spline, v, d, s0, s1)
    !! Position and tangents of an extraordinary point. On the boundary one more spoke than faces.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: v                                !! the point
    real(wp), allocatable, intent(out) :: d(:)              !! intervals of its n spokes
    type(row_type), intent(inout) :: s0
    type(row_type), allocatable, intent(out) :: s1(:)       !! first coefficients of the spokes (n)

    integer :: c, k, n

    n = spline%mesh%faces(v)
    if (spline%mesh%is_boundary(v)) n = n + 1
    allocate (d(n), s1(n))
    c = spline%mesh%corner(v)
    do k = 1, spline%mesh%faces(v)
      d(k) = spline%mesh%interval(c)
      d(n) = spline%mesh%interval(previous_corner(c))
      c = spline%mesh%turn(c)
    end do
    if (spline%mesh%is_boundary(v)) then
      call boundary_plane_rows(d, spline%mesh%angle(v), spline%slots%plane(v), s0, s1)
    else
      d(n) = spline%mesh%interval(next_corner(spline%mesh%twin(spline%mesh%corner(v))))
      call plane_rows(d, spline%mesh%angle(v), spline%slots%plane(v), s0, s1)
    end if
  end subroutine point_rows

  pure recursive subroutine twist_sums(spline, v, without, d, s0, s1, r)
    !! r of the spokes of an extraordinary point with seams: from k = 1 of the seam's condition,
    !! 3 d^2 r = 2 A_0 (s_2 - s_1) + (A_1 - 3 A_0)(s_1 - s_0).
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: v                                !! the point, of n faces
    integer, intent(in) :: without                          !! spoke whose r is not wanted, 0: none
    real(wp), allocatable, intent(out) :: d(:)              !! of its spokes
    type(row_type), intent(inout) :: s0
    type(row_type), allocatable, intent(out) :: s1(:)       !! of its spokes
    type(row_type), allocatable, intent(out) :: r(:)        !! (n), empty on the boundary

    type(row_type) :: s2, unused
    real(wp) :: a(2)
    integer :: c, k

    call point_rows(spline, v, d, s0, s1)
    allocate (r(spline%mesh%faces(v)))
    c = spline%mesh%corner(v)
    do k = 1, size(r)
      call clear(r(k))
      if (k /= without .and. spline%mesh%seam(c)) then
        a = touching_gluing(spline%mesh, c, 1) / (3*d(k)**2)
        call edge_rows(spline, c, unused, s2)
        call add_row(r(k), 2*a(1), s2)
        call add_row(r(k), a(2) - 5*a(1), s1(k))
        call add_row(r(k), 3*a(1) - a(2), s0)
      end if
      c = spline%mesh%turn(c)
    end do
  end subroutine twist_sums

  pure recursive subroutine corner_row(spline, corner, row)
    !! Inner coefficient of a face at an extraordinary point with seams.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: corner
    type(row_type), intent(inout) :: row

    type(row_type) :: s0
    type(row_type), allocatable :: s1(:), r(:), t(:)
    real(wp), allocatable :: d(:)
    integer :: after, c, k, n, v

    v = spline%mesh%vertex(corner)
    n = spline%mesh%faces(v)
    k = 1
    c = spline%mesh%corner(v)
    do while (c /= corner)
      c = spline%mesh%turn(c)
      k = k + 1
    end do
    if (spline%slots%twist(v) > 0 .and. k == 1) then
      call add_term(row, spline%slots%twist(v))
      return
    else if (has_two_twists(spline, v) .and. k == n) then
      call add_term(row, spline%slots%twist(v) + 1)
      return
    end if
    call twist_sums(spline, v, 0, d, s0, s1, r)
    allocate (t(n))
    call clear(t(1))
    if (spline%slots%twist(v) > 0) call given_twist(spline%slots%twist(v), 1, d, s0, s1, t(1))
    call twist_rows(r, spline%slots%twist(v) == 0, t)
    after = mod(k, size(d)) + 1
    call add_row(row, -1.0_wp, s0)
    call add_row(row, 1.0_wp, s1(k))
    call add_row(row, 1.0_wp, s1(after))
    call add_row(row, d(k)*d(after), t(k))
  end subroutine corner_row

  pure logical function has_two_twists(spline, v)
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: v                     !! extraordinary point

    has_two_twists = spline%slots%solved(v) > 0 .and. spline%mesh%is_boundary(v)
  end function has_two_twists

  pure subroutine given_twist(id, k, d, s0, s1, t)
    !! The twist of a face whose inner coefficient at the point is a control point.
    integer, intent(in) :: id, k                 !! control point; face, between spokes k and k+1
    real(wp), intent(in) :: d(:)                 !! intervals of the spokes
    type(row_type), intent(in) :: s0, s1(:)      !! see point_rows
    type(row_type), intent(inout) :: t

    real(wp) :: factor
    integer :: after

    after = mod(k, size(d)) + 1
    factor = 1/(d(k)*d(after))
    call add_scaled_term(t, factor, id)
    call add_row(t, -factor, s1(k))
    call add_row(t, -factor, s1(after))
    call add_row(t, factor, s0)
  end subroutine given_twist

  pure recursive subroutine curve_row(spline, c, k, row)
    !! Control point of a crease or seam at an end of an edge.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner that the edge starts from
    integer, intent(in) :: k                     !! 1: start, 2: end
    type(row_type), intent(inout) :: row

    type(row_type) :: s0
    type(row_type), allocatable :: s1(:)
    real(wp), allocatable :: d(:)
    integer :: id, other, spoke, v

    call clear(row)
    id = spline%slots%curve(k,c)
    if (id > 0) then
      call add_term(row, id)
    else if (id < 0) then
      call solved_row(spline, -id, row)
    else if (spline%mesh%fades(k,c)) then
      call mean_row(spline, c, k, row)
    else
      if (k == 1) then
        v = spline%mesh%vertex(c)
        spoke = c
      else
        v = spline%mesh%vertex(next_corner(c))
        spoke = spline%mesh%twin(c)
      end if
      call point_rows(spline, v, d, s0, s1)
      ! 0: the last spoke of the boundary, which only arrives
      other = spline%mesh%corner(v)
      id = 1
      do while (other /= spoke)
        other = spline%mesh%turn(other)
        id = id + 1
      end do
      call add_row(row, 1.0_wp, s1(id))
    end if
  end subroutine curve_row

  pure recursive subroutine solved_row(spline, v, row)
    !! Control point of a seam at the end of the edge that `solved` names, from the alternating
    !! sum of the twists' conditions: 0, on the boundary the first twist and, with sign, the last
    !! one.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: v                     !! the point
    type(row_type), intent(inout) :: row

    type(row_type) :: ends, rest, s0
    type(row_type), allocatable :: s1(:), r(:)
    real(wp), allocatable :: d(:)
    real(wp) :: a(2), factor, h_after, other
    integer :: c, k, n

    associate (mesh => spline%mesh)
      c = mesh%corner(v)
      k = 1
      do while (c /= spline%slots%solved(v))
        c = mesh%turn(c)
        k = k + 1
      end do
      call twist_sums(spline, v, k, d, s0, s1, r)
      call alternating_rest(r, k, rest)
      if (has_two_twists(spline, v)) then
        n = mesh%faces(v)
        call given_twist(spline%slots%twist(v) + 1, n, d, s0, s1, ends)
        if (mod(n, 2) == 1) ends%c = -ends%c
        call given_twist(spline%slots%twist(v), 1, d, s0, s1, ends)
        call add_row(rest, 1.0_wp*(-1)**k, ends)
      end if
      h_after = 0
      if (spline%slots%beyond(2,c) /= 0) h_after = mesh%interval(abs(spline%slots%beyond(2,c)))
      other = h_after/(d(k) + h_after)
      ! s_2 = (1 - other) row + other s_1 = s_1 + (3 d^2 r - (A_1 - 3 A_0)(s_1 - s_0))/(2 A_0)
      a = touching_gluing(mesh, c, 1)
      factor = 1/(1 - other)
      call add_row(row, factor*3*d(k)**2/(2*a(1)), rest)
      call add_row(row, factor*(1 - other - (a(2) - 3*a(1))/(2*a(1))), s1(k))
      call add_row(row, factor*(a(2) - 3*a(1))/(2*a(1)), s0)
    end associate
  end subroutine solved_row

  pure recursive subroutine edge_rows(spline, c, first, second)
    !! The two inner Bezier coefficients of an edge as a cubic. The one next to an extraordinary
    !! point has no meaning.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner that the edge starts from
    type(row_type), intent(inout) :: first, second

    type(row_type) :: here, there
    real(wp) :: h, h_after, h_before, own, other

    call clear(first)
    call clear(second)
    associate (mesh => spline%mesh, slots => spline%slots)
      h = mesh%interval(c)
      if (mesh%is_open(c)) then
        h_before = 0
        h_after = 0
        if (slots%beyond(1,c) /= 0) h_before = mesh%interval(abs(slots%beyond(1,c)))
        if (slots%beyond(2,c) /= 0) h_after = mesh%interval(abs(slots%beyond(2,c)))
        own = h_before / (h_before + h + h_after)
        other = h_after / (h_before + h + h_after)
        call curve_row(spline, c, 1, here)
        call curve_row(spline, c, 2, there)
        call add_row(first, 1 - own, here)
        if (own > 0) call add_row(first, own, there)
        call add_row(second, 1 - other, there)
        if (other > 0) call add_row(second, other, here)
        return
      end if
      call mean_row(spline, c, 1, first)
      call mean_row(spline, c, 2, second)
    end associate
  end subroutine edge_rows

  pure recursive subroutine mean_row(spline, c, k, row)
    !! Coefficient of an edge between the inner ones beside it, so that the surface is C1.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner that the edge starts from
    integer, intent(in) :: k                     !! 1: next to its start, 2: to its end
    type(row_type), intent(inout) :: row

    type(row_type) :: here, there
    real(wp) :: other, own
    integer :: t

    t = spline%mesh%twin(c)
    own = spline%mesh%interval(previous_corner(c))
    other = spline%mesh%interval(next_corner(t))
    call inner_row(spline, merge(c, next_corner(c), k == 1), here)
    call inner_row(spline, merge(next_corner(t), t, k == 1), there)
    call clear(row)
    call add_row(row, other/(own + other), here)
    call add_row(row, own/(own + other), there)
  end subroutine mean_row

  pure recursive subroutine vertex_row(spline, c, row)
    !! The Bezier coefficient at a vertex.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: c                     !! corner at the vertex
    type(row_type), intent(inout) :: row

    type(row_type) :: coefficient
    type(row_type), allocatable :: s1(:)
    real(wp), allocatable :: d_point(:)
    real(wp) :: d(4), weight
    integer :: at(4), edge, k, v

    call clear(row)
    v = spline%mesh%vertex(c)
    associate (mesh => spline%mesh, slots => spline%slots)
      if (slots%plane(v) > 0) then
        call point_rows(spline, v, d_point, row, s1)
      else if (slots%vertex(v) > 0) then
        call add_term(row, slots%vertex(v))
      else if (slots%curve_edge(v) /= 0) then
        ! between the two coefficients of a smooth crease
        edge = slots%curve_edge(v)
        k = slots%beyond(merge(1, 2, edge > 0), abs(edge))
        weight = 1 / (mesh%interval(abs(edge)) + mesh%interval(abs(k)))
        call near_coefficient(spline, k, coefficient)
        call add_row(row, weight*mesh%interval(abs(edge)), coefficient)
        call near_coefficient(spline, edge, coefficient)
        call add_row(row, weight*mesh%interval(abs(k)), coefficient)
      else
        at(1) = c
        do k = 2, 4
          at(k) = mesh%turn(at(k-1))
        end do
        d = mesh%interval(at)
        do k = 1, 4
          call inner_row(spline, at(k), coefficient)
          weight = d(mod(k + 1, 4) + 1)*d(mod(k + 2, 4) + 1)/((d(1) + d(3))*(d(2) + d(4)))
          call add_row(row, weight, coefficient)
        end do
      end if
    end associate
  end subroutine vertex_row

  pure recursive subroutine near_coefficient(spline, edge, row)
    !! Inner coefficient of a crease edge that is next to a vertex.
    class(spline_space_type), intent(in) :: spline
    integer, intent(in) :: edge                  !! edge that leaves (> 0) or meets (< 0) the vertex
    type(row_type), intent(inout) :: row

    type(row_type) :: other

    if (edge > 0) then
      call edge_rows(spline, edge, row, other)
    else
      call edge_rows(spline, -edge, other, row)
    end if
  end subroutine near_coefficient
end module spline_rows
