module t_merge
  !! Two patches with a common edge and different knots along it as one T-spline, C^0 to C^(p-1)
  !! across the edge.
  !!
  !! Both are turned so that the edge is s = 1 of the first and s = 0 of the second one. One index
  !! domain holds both: across the edge the knots of the first patch, the seam p - k times for C^k,
  !! the knots of the second one; along it the knots of both, but each patch keeps only its own
  !! lines. They end in T-junctions on the seam, whose functions know the knots of both sides. All
  !! T-junctions belong to lines of one direction: the mesh is analysis-suitable.
  !!
  !! Control points by polar forms: those of functions without inner knots beyond the seam come from
  !! their own patch. Other functions, of which there are none if C^0 is asked, take the polar forms
  !! of both patches, continued over the seam, weighted by the number of inner knots on either side.
  !! Thus C^0 keeps both surfaces; a smooth seam keeps them where they are pieces of one polynomial,
  !! and away from the seam, and rounds off what is not smooth.
  use kinds, only: wp, i8
  use status_codes, only: ok, bad_t_mesh, edges_differ
  use knot_vectors, only: knot_vector, insertion_operator, basis_values
  use nurbs_patch, only: nurbs_patch_type
  use t_mesh, only: t_mesh_type, line_family, bay, create_t_mesh, create_t_mesh_on_lines
  use t_spline, only: t_spline_type, create_t_functions, homogeneous_polar_point
  implicit none (type, external)
  private
  public :: merge_patches, turned_patch, side_before

  !> knots of both patches closer than this part of the edge's interval are one
  real(wp), parameter :: same_knot = 1.0e-10_wp
  !> quarters of a turn that bring a side to s = 1
  integer, parameter :: turns(4) = [2, 0, 1, 3]

contains

  subroutine merge_patches(a, side_a, b, side_b, continuity, tolerance, mesh, spline, seam, gap, &
    status)
    type(nurbs_patch_type), intent(in) :: a       !! first surface, open knots, odd degrees
    integer, intent(in) :: side_a                 !! its edge: 1: s=0, 2: s=1, 3: t=0, 4: t=1
    type(nurbs_patch_type), intent(in) :: b       !! second surface, as seen after turning of the
                                                  !! same degrees and orientation
    integer, intent(in) :: side_b                 !! its edge
    integer, intent(in) :: continuity             !! k of C^k across the seam, 0 .. p-1
    real(wp), intent(in) :: tolerance             !! allowed distance of the edges [length]
    type(t_mesh_type), intent(out) :: mesh        !! of both; s runs from the first to the second
    type(t_spline_type), intent(out) :: spline    !! with control points
    real(wp), intent(out) :: seam                 !! parameter s of the seam
    real(wp), intent(out) :: gap                  !! largest distance of the edges' control points
                                                  !! [length]
    integer, intent(out) :: status                !! ok, bad_t_mesh (degrees or knots), edges_differ

    type(nurbs_patch_type) :: left, right
    type(line_family) :: lines(2)
    integer :: i, seam_at(2)
    real(wp) :: from_left(4), from_right(4), part
    real(wp), allocatable :: inner(:)

    seam = 0.0_wp
    gap = 0.0_wp
    status = bad_t_mesh
    if (a%dp /= 2 .or. b%dp /= 2) return
    left = turned_patch(a, side_a)
    right = turned_patch(b, opposite(side_b))
    if (any(left%knots(1:2)%p /= right%knots(1:2)%p)) return
    if (continuity < 0 .or. continuity > left%knots(1)%p - 1) return
    call create_t_mesh(left%knots(1:2), mesh, status)
    if (status == ok) call create_t_mesh(right%knots(1:2), mesh, status)
    if (status /= ok) return
    call align(left, right)
    call compare_edges(left, right, gap, status)
    if (status == ok .and. gap > tolerance) status = edges_differ
    if (status /= ok) return

    call common_lines(left, right, continuity, lines, seam_at)
    call create_t_mesh_on_lines(left%knots(1:2)%p, lines, mesh)
    mesh%regular = .false.
    call draw_lines(mesh, left, right, seam_at)
    seam = lines(1)%x(seam_at(1))

    call create_t_functions(mesh, spline)
    do i = 1, spline%n
      associate (knots => spline%knots(:,:,i))
        inner = knots(2:mesh%degree(1)+1,1)
        part = count(inner > seam) / real(max(1, count(inner > seam .or. inner < seam)), wp)
        from_left = 0.0_wp
        from_right = 0.0_wp
        if (part < 1.0_wp) call homogeneous_polar_point(left, mesh%degree, knots, from_left)
        if (part > 0.0_wp) call homogeneous_polar_point(right, mesh%degree, knots, from_right)
        spline%cp(:,i) = (1.0_wp - part) * from_left + part * from_right
        spline%cp(1:3,i) = spline%cp(1:3,i) / spline%cp(4,i)
      end associate
    end do
  end subroutine merge_patches

  pure integer function opposite(side)
    integer, intent(in) :: side     !! 1..4

    opposite = side - 1 + 2 * mod(side, 2)
  end function opposite

  pure integer function side_before(side, turned_side)
    !! Which side of a patch is a side of the patch turned so that turned_side becomes s = 1.
    integer, intent(in) :: side            !! 1..4 of the turned patch
    integer, intent(in) :: turned_side     !! 1..4 of the patch

    integer, parameter :: quarter(4) = [4, 3, 1, 2]
    integer :: k

    side_before = side
    do k = 1, turns(turned_side)
      side_before = quarter(side_before)
    end do
  end function side_before

  pure function turned_patch(patch, side) result(turned)
    !! The same surface with parameters turned by quarters, so that a side becomes s = 1.
    type(nurbs_patch_type), intent(in) :: patch     !! surface
    integer, intent(in) :: side                     !! 1..4
    type(nurbs_patch_type) :: turned

    type(nurbs_patch_type) :: before
    integer :: i, j, k, n(3)

    turned = patch
    do k = 1, turns(side)
      ! (s,t) -> (-t,s)
      before = turned
      n = before%functions()
      turned%knots(1)%p = before%knots(2)%p
      turned%knots(1)%u = -before%knots(2)%u(size(before%knots(2)%u):1:-1)
      turned%knots(2) = before%knots(1)
      do j = 1, n(2)
        do i = 1, n(1)
          turned%cp(:,n(2)+1-j+n(2)*(i-1)) = before%cp(:,i+n(1)*(j-1))
        end do
      end do
    end do
  end function turned_patch

  pure subroutine align(left, right)
    !! Gives the second patch the parameters of the first one along the edge, a parameter across it
    !! that continues the first one's at about the same speed, and the same weight at the edge.
    type(nurbs_patch_type), intent(in) :: left
    type(nurbs_patch_type), intent(inout) :: right

    real(wp) :: from, stretch, x0
    integer :: i, k, m

    associate (u => right%knots(2)%u, v => left%knots(2)%u)
      x0 = u(1)
      stretch = (v(size(v)) - v(1)) / (u(size(u)) - u(1))
      u = v(1) + (u - x0) * stretch
      do i = 1, size(u)
        k = minloc(abs(v - u(i)), 1)
        if (abs(v(k) - u(i)) <= same_knot * (v(size(v)) - v(1))) u(i) = v(k)
      end do
    end associate
    associate (u => right%knots(1)%u, v => left%knots(1)%u)
      m = size(v)
      stretch = mean_speed(right, 1) / mean_speed(left, 2)
      from = u(1)
      u = v(m) + (u - from) * stretch
    end associate
    i = left%knots(1)%functions()
    right%cp(4,:) = right%cp(4,:) * (left%cp(4,i) / right%cp(4,1))
  end subroutine align

  pure real(wp) function mean_speed(patch, side) result(speed)
    !! Mean length of the derivative across an edge, at points that depend on its interval only.
    type(nurbs_patch_type), intent(in) :: patch
    integer, intent(in) :: side                  !! 1 or 2

    integer, parameter :: samples = 16
    real(wp) :: edge(4), next(4), b(patch%knots(2)%p+1), span
    integer :: first, i, j, k, n, p

    n = patch%knots(1)%functions()
    p = patch%knots(1)%p
    speed = 0.0_wp
    associate (u => patch%knots(1)%u, v => patch%knots(2)%u)
      span = merge(u(p+2) - u(p+1), u(n+1) - u(n), side == 1)
      do k = 1, samples
        call basis_values(patch%knots(2), v(1) + (v(size(v)) - v(1)) * (2 * k - 1) &
          / (2.0_wp * samples), first, b)
        edge = 0.0_wp
        next = 0.0_wp
        do j = 1, size(b)
          i = merge(1, n, side == 1) + n * (first + j - 2)
          edge = edge + b(j) * patch%cp(4,i) * [patch%cp(1:3,i), 1.0_wp]
          i = merge(i + 1, i - 1, side == 1)
          next = next + b(j) * patch%cp(4,i) * [patch%cp(1:3,i), 1.0_wp]
        end do
        speed = speed + norm2(next(1:3) - next(4) / edge(4) * edge(1:3)) / edge(4) * p / span
      end do
    end associate
    speed = max(speed / samples, tiny(speed))
  end function mean_speed

  pure subroutine compare_edges(left, right, gap, status)
    type(nurbs_patch_type), intent(in) :: left, right   !! with aligned parameters
    real(wp), intent(out) :: gap      !! largest distance of the edges' control points on all knots,
                                      !! differing weights measured by the edge's size [length]
    integer, intent(out) :: status    !! ok, bad_knots

    real(wp), allocatable :: to_left(:,:), to_right(:,:), points_left(:,:), points_right(:,:)
    type(knot_vector) :: refined
    integer :: i, n(3)
    real(wp) :: extent

    gap = 0.0_wp
    call insertion_operator(left%knots(2), missing(left%knots(2), right%knots(2)), refined, &
      to_left, status)
    if (status /= ok) return
    call insertion_operator(right%knots(2), missing(right%knots(2), left%knots(2)), refined, &
      to_right, status)
    if (status /= ok) return
    n = left%functions()
    points_left = edge_points(left%cp(:,n(1)::n(1)), to_left)
    n = right%functions()
    points_right = edge_points(right%cp(:,1::n(1)), to_right)
    extent = norm2(maxval(points_left(1:3,:), 2) - minval(points_left(1:3,:), 2))
    do i = 1, size(points_left, 2)
      gap = max(gap, norm2(points_left(1:3,i) - points_right(1:3,i)), &
        extent * abs(points_left(4,i) / points_right(4,i) - 1.0_wp))
    end do
  end subroutine compare_edges

  pure function edge_points(cp, operator) result(points)
    real(wp), intent(in) :: cp(:,:)            !! control points x,y,z,w (4,n)
    real(wp), intent(in) :: operator(:,:)      !! knot insertion (m,n)
    real(wp), allocatable :: points(:,:)       !! control points x,y,z,w (4,m)

    real(wp) :: homogeneous(4,size(cp,2))
    integer :: i

    do i = 1, size(cp, 2)
      homogeneous(:,i) = cp(4,i) * [cp(1:3,i), 1.0_wp]
    end do
    allocate (points(4,size(operator, 1)))
    points(:,:) = matmul(homogeneous, transpose(operator))
    do i = 1, size(points, 2)
      points(1:3,i) = points(1:3,i) / points(4,i)
    end do
  end function edge_points

  pure function missing(kv, other) result(new)
    !! Knots that another knot vector has more often.
    type(knot_vector), intent(in) :: kv, other
    real(wp), allocatable :: new(:)

    real(wp), allocatable :: breaks(:)
    integer :: i, k

    allocate (new(0))
    breaks = other%breaks()
    do i = 2, size(breaks) - 1
      do k = times(kv, breaks(i)) + 1, times(other, breaks(i))
        new = [new, breaks(i)]
      end do
    end do
  end function missing

  pure integer function times(kv, x)
    !! Multiplicity of a knot.
    type(knot_vector), intent(in) :: kv
    real(wp), intent(in) :: x

    times = count(kv%u >= x .and. kv%u <= x)
  end function times

  pure subroutine common_lines(left, right, continuity, lines, seam_at)
    type(nurbs_patch_type), intent(in) :: left, right    !! with aligned parameters
    integer, intent(in) :: continuity                    !! across the seam
    type(line_family), intent(out) :: lines(2)           !! of both patches
    integer, intent(out) :: seam_at(2)                   !! first and last knot of the seam

    real(wp), allocatable :: x(:)
    integer, allocatable :: root(:)
    integer :: i, j, k, multiplicity, n(3), p

    p = left%knots(1)%p
    multiplicity = p - continuity
    n = left%functions()
    seam_at = n(1) - p + [0, multiplicity - 1]
    x = [left%knots(1)%u(p+1:n(1)+1), spread(left%knots(1)%u(n(1)+1), 1, multiplicity - 1), &
      right%knots(1)%u(p+2:right%knots(1)%functions()+1)]
    allocate (lines(1)%x(0:size(x)-1), source=x)
    allocate (lines(1)%root(0:size(x)-1), source=[(i, i = 0, size(x) - 1)])

    ! along the edge: merge both lists; knots of both patches bound roots
    p = left%knots(2)%p
    deallocate (x)
    allocate (x(0), root(0))
    associate (u => left%knots(2)%u(p+1:n(2)+1), &
      v => right%knots(2)%u(p+1:size(right%knots(2)%u)-p))
      i = 1
      j = 1
      k = 0
      do while (i <= size(u) .or. j <= size(v))
        if (i > size(u)) then
          x = [x, v(j)]
          j = j + 1
        else if (j > size(v)) then
          x = [x, u(i)]
          i = i + 1
        else if (u(i) < v(j)) then
          x = [x, u(i)]
          i = i + 1
        else if (v(j) < u(i)) then
          x = [x, v(j)]
          j = j + 1
        else
          x = [x, u(i)]
          root = [root, k]
          i = i + 1
          j = j + 1
        end if
        k = k + 1
      end do
    end associate
    allocate (lines(2)%x(0:size(x)-1), source=x)
    allocate (lines(2)%root(0:size(root)-1), source=root)
  end subroutine common_lines

  pure subroutine draw_lines(mesh, left, right, seam_at)
    !! Splits the roots of each patch at its own knots, those between the seam's knots at all.
    type(t_mesh_type), intent(inout) :: mesh
    type(nurbs_patch_type), intent(in) :: left, right
    integer, intent(in) :: seam_at(2)

    integer :: root, roots
    integer, allocatable :: all_knots(:), of_left(:), of_right(:)
    integer :: i

    all_knots = [(i, i = 0, ubound(mesh%lines(2)%x, 1))]
    of_left = places(mesh%lines(2)%x, left%knots(2))
    of_right = places(mesh%lines(2)%x, right%knots(2))
    roots = mesh%n
    do root = 1, roots
      if (mesh%hi(1,root) <= seam_at(1) * bay) then
        call split_at_knots(mesh, root, of_left)
      else if (mesh%lo(1,root) >= seam_at(2) * bay) then
        call split_at_knots(mesh, root, of_right)
      else
        call split_at_knots(mesh, root, all_knots)
      end if
    end do
  end subroutine draw_lines

  pure function places(x, kv) result(at)
    !! Which of all knots a patch has. Of a knot that one patch repeats more often, the other one
    !! has the first ones.
    real(wp), intent(in) :: x(0:)              !! knots of both patches
    type(knot_vector), intent(in) :: kv        !! of the patch
    integer, allocatable :: at(:)

    integer :: i, k

    allocate (at(0))
    i = kv%p + 1
    do k = 0, ubound(x, 1)
      if (i > size(kv%u) - kv%p) exit
      if (x(k) < kv%u(i)) cycle
      at = [at, k]
      i = i + 1
    end do
  end function places

  pure recursive subroutine split_at_knots(mesh, cell, knots)
    type(t_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: cell               !! a leaf
    integer, intent(in) :: knots(:)           !! of direction 2, increasing

    integer, allocatable :: inside(:)
    integer(i8) :: at
    logical :: done
    integer :: first

    inside = pack(knots, knots * bay > mesh%lo(2,cell) .and. knots * bay < mesh%hi(2,cell))
    if (size(inside) == 0) return
    at = inside((size(inside) + 1) / 2) * bay
    call mesh%split_cell(cell, 2, at, done)
    if (.not. done) return
    first = mesh%child(cell)
    call split_at_knots(mesh, first, inside)
    call split_at_knots(mesh, first + 1, inside)
  end subroutine split_at_knots
end module t_merge
