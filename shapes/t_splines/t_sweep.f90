module t_sweep
  !! Solids swept by a surface of any kind, T-splines among them. With S the surface,
  !!
  !!   x(s,t,u) = M(u) S(s,t) + c(u),     M = sum_l w_l N_l M_l / sum_l w_l N_l, c likewise,
  !!
  !! where the N_l are B-splines of u and each l has a 3 x 3 matrix, an offset and a weight:
  !! straight and curved translations, revolution (exact circles), scaling, twist. In homogeneous
  !! coordinates this is a tensor product: control points M_l P_a + c_l with weights w_a w_l, and
  !! the extraction operator of an element is the Kronecker product of that of the span of u and
  !! that of the element of the surface.
  use kinds, only: wp
  use status_codes, only: ok, bad_knots, bad_extraction
  use knot_vectors, only: knot_vector, open_knot_vector, extraction_operators, insertion_operator, &
    elevation_operator
  use nurbs_patch, only: nurbs_patch_type
  use tensor_product, only: tensor_operator
  use extraction_set, only: extraction_set_type
  implicit none (type, external)
  private
  public :: sweep_type, straight_sweep, curve_sweep, revolution
  public :: elevate_sweep, refine_sweep, swept_points, swept_extraction

  integer, parameter :: items = 13   !! of a control value: matrix 9, offset 3, weight

  type :: sweep_type
    type(knot_vector) :: knots               !! of the direction u
    real(wp), allocatable :: value(:,:)      !! homogeneous control values: w M (9, by columns),
                                             !! w c (3), w (13,n)
  end type sweep_type

contains

  pure function straight_sweep(vector) result(sweep)
    !! Translation along a straight line, of degree 1 and one element, u from 0 to 1.
    real(wp), intent(in) :: vector(3)     !! from the start to the end [length]
    type(sweep_type) :: sweep

    sweep%knots = open_knot_vector(1, [0.0_wp, 1.0_wp])
    allocate (sweep%value(items,2), source=0.0_wp)
    sweep%value([1, 5, 9, items],:) = 1.0_wp
    sweep%value(10:12,2) = vector
  end function straight_sweep

  pure subroutine curve_sweep(curve, sweep, status)
    !! Translation along a curve, from its first control point: the surface keeps its orientation.
    type(nurbs_patch_type), intent(in) :: curve     !! dp = 1, open knots
    type(sweep_type), intent(out) :: sweep
    integer, intent(out) :: status                  !! ok, bad_knots (no curve, knots not open)

    integer :: l

    status = bad_knots
    if (curve%dp /= 1) return
    if (.not. curve%knots(1)%is_open()) return
    sweep%knots = curve%knots(1)
    allocate (sweep%value(items,size(curve%cp, 2)), source=0.0_wp)
    do l = 1, size(curve%cp, 2)
      sweep%value([1, 5, 9, items],l) = curve%cp(4,l)
      sweep%value(10:12,l) = curve%cp(4,l) * (curve%cp(1:3,l) - curve%cp(1:3,1))
    end do
    status = ok
  end subroutine curve_sweep

  pure function revolution(point, axis, angle) result(sweep)
    !! Rotation about an axis, of degree 2, by arcs of at most 90 degrees, u from 0 to 1.
    real(wp), intent(in) :: point(3)      !! on the axis [length]
    real(wp), intent(in) :: axis(3)       !! its direction, of any length but 0
    real(wp), intent(in) :: angle         !! of the rotation, right-handed, not 0 [rad]
    type(sweep_type) :: sweep

    real(wp), parameter :: quarter = 2 * atan(1.0_wp)
    real(wp) :: along(3,3), across(3,3), turned(3,3), e(3), half, matrix(3,3), weight
    integer :: arcs, i, l

    e = axis / norm2(axis)
    arcs = max(1, ceiling(abs(angle) / quarter - 1.0e-9_wp))
    half = angle / (2 * arcs)
    along = spread(e, 2, 3) * spread(e, 1, 3)
    across = -along
    do i = 1, 3
      across(i,i) = across(i,i) + 1.0_wp
    end do
    turned = reshape([0.0_wp, e(3), -e(2), -e(3), 0.0_wp, e(1), e(2), -e(1), 0.0_wp], [3, 3])

    sweep%knots%p = 2
    sweep%knots%u = [0.0_wp, [(real(i / 2, wp) / arcs, i = 0, 2 * arcs + 1)], 1.0_wp]
    allocate (sweep%value(items,2*arcs+1))
    do l = 1, 2 * arcs + 1
      weight = 1.0_wp
      if (mod(l, 2) == 0) weight = cos(half)
      ! the weight cancels across the axis: inner control points lie farther out by its inverse
      matrix = weight * along + cos((l - 1) * half) * across + sin((l - 1) * half) * turned
      sweep%value(1:9,l) = reshape(matrix, [9])
      sweep%value(10:12,l) = weight * point - matmul(matrix, point)
      sweep%value(items,l) = weight
    end do
  end function revolution

  pure subroutine elevate_sweep(sweep, times)
    type(sweep_type), intent(inout) :: sweep
    integer, intent(in) :: times              !! by how many degrees, >= 0

    type(knot_vector) :: elevated
    real(wp), allocatable :: a(:,:)
    integer :: k

    do k = 1, times
      call elevation_operator(sweep%knots, elevated, a)
      sweep%knots = elevated
      call apply(sweep, a)
    end do
  end subroutine elevate_sweep

  pure subroutine refine_sweep(sweep, new, status)
    !! Knot insertion; graded breaks make graded elements.
    type(sweep_type), intent(inout) :: sweep    !! unchanged unless ok
    real(wp), intent(in) :: new(:)              !! knots strictly inside the domain, also repeated
    integer, intent(out) :: status              !! ok or bad_knots

    type(knot_vector) :: refined
    real(wp), allocatable :: a(:,:)

    call insertion_operator(sweep%knots, new, refined, a, status)
    if (status /= ok) return
    sweep%knots = refined
    call apply(sweep, a)
  end subroutine refine_sweep

  pure subroutine apply(sweep, a)
    type(sweep_type), intent(inout) :: sweep
    real(wp), intent(in) :: a(:,:)       !! operator (new functions, functions)

    real(wp), allocatable :: value(:,:)

    allocate (value(items,size(a, 1)))
    value(:,:) = matmul(sweep%value, transpose(a))
    call move_alloc(value, sweep%value)
  end subroutine apply

  pure subroutine swept_points(sweep, flat, solid)
    type(sweep_type), intent(in) :: sweep
    real(wp), intent(in) :: flat(:,:)        !! control points of the surface x,y,z,w (4,n)
    real(wp), intent(out) :: solid(:,:)      !! of the solid, those of the surface fastest
                                             !! (4,n m), m functions of u

    real(wp) :: matrix(3,3)
    integer :: a, l, n

    n = size(flat, 2)
    do l = 1, size(sweep%value, 2)
      associate (v => sweep%value(:,l))
        matrix = reshape(v(1:9) / v(items), [3, 3])
        do a = 1, n
          solid(1:3,a+n*(l-1)) = matmul(matrix, flat(1:3,a)) + v(10:12) / v(items)
          solid(4,a+n*(l-1)) = flat(4,a) * v(items)
        end do
      end associate
    end do
  end subroutine swept_points

  subroutine swept_extraction(sweep, flat, functions, node_ids, set, first, status)
    !! Appends the solid's elements to a set: span after span, each with the surface's elements in
    !! their order, so that the element over element e in span k is first - 1 + e + flat%ne (k-1).
    !! Sides 1 to 4 of an element are over those of the surface's element; 5 and 6 lie on the first
    !! and last span's ends.
    type(sweep_type), intent(in) :: sweep
    type(extraction_set_type), intent(in), target :: flat  !! surface; nodes are its functions
    integer, intent(in) :: functions                   !! number n of functions of the surface
    integer, intent(in) :: node_ids(:)                 !! nodes in the order of `swept_points` (n m)
    type(extraction_set_type), intent(inout) :: set    !! another one than `flat`
    integer, intent(out) :: first                      !! number of the first new element
    integer, intent(out) :: status                     !! ok, bad_extraction (no surface, or the
                                                       !! number of nodes is wrong)

    real(wp), allocatable :: c(:,:,:), ce(:,:)
    integer, allocatable :: known(:), line(:), nodes(:)
    integer, pointer, contiguous :: ix(:)
    integer :: degree(3), e, id, k, l, nen, op, p

    first = set%ne + 1
    status = bad_extraction
    if (size(node_ids) /= functions * sweep%knots%functions()) return
    if (any(flat%dp(1:flat%ne) /= 2)) return
    call extraction_operators(sweep%knots, c, line)
    p = sweep%knots%p
    allocate (known(flat%nop))
    do k = 1, size(c, 3)
      known = 0
      do e = 1, flat%ne
        ix => flat%connectivity(e)
        nen = size(ix)
        op = flat%operator_of(e)
        if (known(op) == 0) then
          if (allocated(ce)) deallocate (ce)
          allocate (ce(nen*(p+1),flat%nb(e)*(p+1)))
          call tensor_operator(flat%operator(e), c(:,:,k), ce)
          call set%add_operator(ce, known(op))
        end if
        nodes = [(node_ids(ix + functions * (line(k) + l - 1)), l = 0, p)]
        degree = [flat%degree(1:2,e), p]
        call set%add_element_with_operator(3, degree, nodes, known(op), id)
      end do
    end do
    status = ok
  end subroutine swept_extraction
end module t_sweep
