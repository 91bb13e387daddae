module nurbs_patch
  !! A NURBS curve, surface or solid: degrees and knots in each direction, Cartesian control
  !! points with weights, first direction fastest. Unused directions have degree 0 and the knots
  !! 0, 1, so that one code serves all three.
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: wp
  use status_codes, only: ok, bad_knots, bad_weight, bad_extraction, not_finite
  use knot_vectors, only: knot_vector, open_knot_vector, knot_status, basis_values, &
    extraction_operators
  use tensor_product, only: tensor_operator
  use extraction_set, only: extraction_set_type
  implicit none (type, external)
  private
  public :: nurbs_patch_type, create_patch, evaluate, evaluate_grid
  public :: patch_extraction, patch_side, side_of_grid

  type :: nurbs_patch_type
    integer :: dp = 0                    !! parametric dimension, 1..3
    type(knot_vector) :: knots(3)        !! of each direction
    real(wp), allocatable :: cp(:,:)     !! control points x,y,z and weight w (4,n1 n2 n3)
  contains
    procedure :: functions               !! number of functions per direction (3)
    procedure :: elements                !! number of elements per direction (3)
  end type nurbs_patch_type

  !> the different operators of one direction and who uses them
  type :: direction_operators
    integer, allocatable :: first(:)       !! first function of each element (ne)
    integer, allocatable :: which(:)       !! operator of each element (ne)
    real(wp), allocatable :: c(:,:,:)      !! different operators (p+1,p+1,n)
  end type direction_operators

contains

  pure subroutine create_patch(knots, cp, patch, status)
    type(knot_vector), intent(in) :: knots(:)     !! of each direction (dp)
    real(wp), intent(in) :: cp(:,:)               !! control points x,y,z,w (4,n1 n2 n3)
    type(nurbs_patch_type), intent(out) :: patch
    integer, intent(out) :: status  !! ok, bad_knots, bad_extraction (number of points), not_finite,
                                     !! bad_weight (zero or negative)

    integer :: d

    patch%dp = size(knots)
    do d = 1, 3
      if (d <= size(knots)) then
        patch%knots(d) = knots(d)
      else
        patch%knots(d) = open_knot_vector(0, [0.0_wp, 1.0_wp])
      end if
    end do
    allocate (patch%cp, source=cp)

    status = bad_knots
    do d = 1, size(knots)
      if (knot_status(knots(d)) /= ok) return
    end do
    status = bad_extraction
    if (size(cp, 1) /= 4 .or. size(cp, 2) /= product(patch%functions())) return
    status = not_finite
    if (.not. all(ieee_is_finite(cp))) return
    status = bad_weight
    if (any(cp(4,:) <= 0.0_wp)) return
    status = ok
  end subroutine create_patch

  pure function functions(self) result(n)
    class(nurbs_patch_type), intent(in) :: self
    integer :: n(3)

    integer :: d

    do d = 1, 3
      n(d) = self%knots(d)%functions()
    end do
  end function functions

  pure function elements(self) result(n)
    class(nurbs_patch_type), intent(in) :: self
    integer :: n(3)

    integer :: d

    do d = 1, 3
      n(d) = self%knots(d)%elements()
    end do
  end function elements

  pure subroutine evaluate(patch, xi, x)
    type(nurbs_patch_type), intent(in) :: patch
    real(wp), intent(in) :: xi(:)    !! point in the knots' parameters (dp)
    real(wp), intent(out) :: x(3)    !! its place

    real(wp) :: at(3), place(3,1)

    at = 0.5_wp
    at(1:patch%dp) = xi(1:patch%dp)
    call evaluate_grid(patch, at(1:1), at(2:2), at(3:3), place)
    x = place(:,1)
  end subroutine evaluate

  pure subroutine evaluate_grid(patch, s, t, u, x)
    !! Places of a grid of points.
    type(nurbs_patch_type), intent(in) :: patch
    real(wp), intent(in) :: s(:), t(:), u(:)   !! parameters; one value in unused directions
    real(wp), intent(out) :: x(:,:)            !! places (3,points), first direction fastest

    real(wp) :: b1(patch%knots(1)%p+1,size(s)), b2(patch%knots(2)%p+1,size(t))
    real(wp) :: b3(patch%knots(3)%p+1,size(u)), sum_wx(3), sum_w, part
    integer :: f1(size(s)), f2(size(t)), f3(size(u)), n(3)
    integer :: a, i, j, k, l1, l2, l3, point

    n = patch%functions()
    call values_at(patch%knots(1), s, f1, b1)
    call values_at(patch%knots(2), t, f2, b2)
    call values_at(patch%knots(3), u, f3, b3)

    point = 0
    do k = 1, size(u)
      do j = 1, size(t)
        do i = 1, size(s)
          sum_wx = 0.0_wp
          sum_w = 0.0_wp
          do l3 = 1, size(b3, 1)
            do l2 = 1, size(b2, 1)
              a = f1(i) - 1 + n(1) * (f2(j) + l2 - 2 + n(2) * (f3(k) + l3 - 2))
              do l1 = 1, size(b1, 1)
                part = b1(l1,i) * b2(l2,j) * b3(l3,k) * patch%cp(4,a+l1)
                sum_wx = sum_wx + part * patch%cp(1:3,a+l1)
                sum_w = sum_w + part
              end do
            end do
          end do
          point = point + 1
          x(:,point) = sum_wx / sum_w
        end do
      end do
    end do
  end subroutine evaluate_grid

  pure subroutine values_at(kv, x, first, b)
    type(knot_vector), intent(in) :: kv
    real(wp), intent(in) :: x(:)          !! points
    integer, intent(out) :: first(:)      !! first function at each
    real(wp), intent(out) :: b(:,:)       !! values (p+1,points)

    integer :: i

    do i = 1, size(x)
      call basis_values(kv, x(i), first(i), b(:,i))
    end do
  end subroutine values_at

  pure function side_of_grid(n, side) result(ids)
    !! Members of a grid n1 x n2 x n3 (functions of open knots, elements) on one of its sides.
    integer, intent(in) :: n(3)      !! size of the grid
    integer, intent(in) :: side      !! 1..6
    integer, allocatable :: ids(:)   !! in grid order, first direction fastest

    integer :: first(3), last(3), across

    first = 1
    last = n
    across = (side + 1) / 2
    if (mod(side, 2) == 0) then
      first(across) = n(across)
    else
      last(across) = 1
    end if
    ids = box_of_grid(n, first, last)
  end function side_of_grid

  pure function box_of_grid(n, first, last) result(ids)
    integer, intent(in) :: n(3)                !! size of the grid
    integer, intent(in) :: first(3), last(3)   !! corners of a box in it
    integer, allocatable :: ids(:)             !! members of the box in grid order

    integer :: i, j, k

    ids = [(((i + n(1) * (j - 1 + n(2) * (k - 1)), i = first(1), last(1)), j = first(2), last(2)), &
      k = first(3), last(3))]
  end function box_of_grid

  pure function patch_side(patch, side) result(ids)
    !! Functions that do not vanish on a side: one layer where the knots are open there, up to p+1
    !! layers otherwise.
    type(nurbs_patch_type), intent(in) :: patch
    integer, intent(in) :: side      !! 1 .. 2 dp
    integer, allocatable :: ids(:)   !! in grid order, first direction fastest

    integer :: across, end_of_domain, f, n(3), first(3), last(3)
    logical, allocatable :: lives(:)
    real(wp), allocatable :: values(:)

    n = patch%functions()
    first = 1
    last = n
    across = (side + 1) / 2
    associate (kv => patch%knots(across))
      end_of_domain = kv%p + 1
      if (mod(side, 2) == 0) end_of_domain = n(across) + 1
      allocate (values(kv%p+1))
      call basis_values(kv, kv%u(end_of_domain), f, values)
    end associate
    lives = values > 0.0_wp
    first(across) = f - 1 + findloc(lives, .true., dim=1)
    last(across) = f - 1 + findloc(lives, .true., dim=1, back=.true.)
    ids = box_of_grid(n, first, last)
  end function patch_side

  subroutine patch_extraction(patch, node_ids, set)
    !! Appends the patch's elements to a set, first direction fastest.
    type(nurbs_patch_type), intent(in) :: patch
    integer, intent(in) :: node_ids(:)               !! node of each function
    type(extraction_set_type), intent(inout) :: set

    type(direction_operators) :: op(3)
    integer, allocatable :: known(:,:,:)
    real(wp), allocatable :: ce(:,:)
    integer, allocatable :: nodes(:)
    integer :: degree(3), n(3), ne(3), a, d, i, id, j, k, l, l2, l3, w(3)

    n = patch%functions()
    ne = patch%elements()
    do d = 1, 3
      degree(d) = patch%knots(d)%p
      call different_operators(patch%knots(d), op(d))
    end do
    allocate (known(size(op(1)%c, 3),size(op(2)%c, 3),size(op(3)%c, 3)), source=0)
    allocate (ce(product(degree+1),product(degree+1)), nodes(product(degree+1)))

    do k = 1, ne(3)
      do j = 1, ne(2)
        do i = 1, ne(1)
          w = [op(1)%which(i), op(2)%which(j), op(3)%which(k)]
          if (known(w(1),w(2),w(3)) == 0) then
            call tensor_operator(op(1)%c(:,:,w(1)), op(2)%c(:,:,w(2)), op(3)%c(:,:,w(3)), ce)
            call set%add_operator(ce, known(w(1),w(2),w(3)))
          end if
          l = 0
          do l3 = 0, degree(3)
            do l2 = 0, degree(2)
              a = op(1)%first(i) + n(1) * (op(2)%first(j) + l2 - 1 &
                + n(2) * (op(3)%first(k) + l3 - 1))
              nodes(l+1:l+degree(1)+1) = node_ids(a:a+degree(1))
              l = l + degree(1) + 1
            end do
          end do
          call set%add_element_with_operator(patch%dp, degree, nodes, known(w(1),w(2),w(3)), id)
        end do
      end do
    end do
  end subroutine patch_extraction

  pure subroutine different_operators(kv, op)
    type(knot_vector), intent(in) :: kv
    type(direction_operators), intent(out) :: op

    real(wp), allocatable :: c(:,:,:)
    integer :: e, k, n

    call extraction_operators(kv, c, op%first)
    allocate (op%which(size(c, 3)))
    n = 0
    do e = 1, size(c, 3)
      do k = 1, n
        if (all(abs(c(:,:,k) - c(:,:,e)) <= 0.0_wp)) exit
      end do
      op%which(e) = k
      if (k > n) then
        n = k
        c(:,:,n) = c(:,:,e)
      end if
    end do
    allocate (op%c, source=c(:,:,1:n))
  end subroutine different_operators
end module nurbs_patch
