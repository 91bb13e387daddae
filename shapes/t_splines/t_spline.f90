module t_spline
  !! Functions of a T-mesh of odd degrees (p,q), their control points and their extraction.
  !!
  !! Each vertex of the mesh carries a function, the product of two B-splines whose p+2 and q+2
  !! knots are found by rays from the vertex (Sederberg et al. 2003): (p+1)/2 lines to either side.
  !! Vertices on the boundary carry (p+1)/2 functions across it, for p = 3 with the knots
  !! 0,0,0,0,a and 0,0,0,a,b. A tensor mesh has exactly the functions of its patch, in the same
  !! order.
  !!
  !! Control points follow without a linear system. On a suitable mesh the functional dual to a
  !! function is the polar form of a spline at the function's inner knots, in both directions, of
  !! whichever of its pieces meets the support. That of the patch, in homogeneous coordinates, gives
  !! control points and weights; geometry and weight function stay as they are.
  !!
  !! A row of an extraction operator is the product of the Bezier coefficients of the function's two
  !! B-splines on the element. Elements are the leaves, cut by the knots of all functions that live
  !! on them (on a suitable mesh these cuts are the extensions of the T-junctions).
  use kinds, only: wp, i8
  use status_codes, only: ok, bad_t_mesh
  use knot_vectors, only: knot_vector, polar_row, relative_knots
  use nurbs_patch, only: nurbs_patch_type
  use t_mesh, only: t_mesh_type, cell_list, append
  use extraction_set, only: extraction_set_type
  implicit none (type, external)
  private
  public :: t_spline_type, t_elements_type, create_t_functions, create_t_spline
  public :: polar_point, homogeneous_polar_point, t_spline_extraction, t_spline_side

  type :: t_spline_type
    integer :: degree(2) = 0                   !! odd
    integer :: n = 0                           !! number of functions
    integer(i8), allocatable :: anchor(:,:)    !! indices of their vertices (2,n)
    integer(i8), allocatable :: line(:,:,:)    !! indices of their knots (max degree+2,2,n);
                                               !! direction d uses the first degree(d)+2
    real(wp), allocatable :: knots(:,:,:)      !! their parameters
    real(wp), allocatable :: cp(:,:)           !! control points x,y,z and weight w (4,n)
  end type t_spline_type

  !> where the elements of a T-spline lie
  type :: t_elements_type
    integer :: first = 0                       !! number of the first one in the extraction set
    integer :: ne = 0                          !! how many
    integer, allocatable :: cell(:)            !! leaf that an element is part of (ne)
    real(wp), allocatable :: lo(:,:)           !! parameters of the lower corner (2,ne)
    real(wp), allocatable :: hi(:,:)           !! and of the upper one
    type(cell_list) :: side(4)                 !! elements on s=0, s=1, t=0, t=1, numbers in the set
  end type t_elements_type

contains

  pure subroutine create_t_spline(mesh, patch, spline, status)
    !! The T-spline of a refined patch: the same surface.
    type(t_mesh_type), intent(in) :: mesh          !! made by `create_t_mesh` from the patch's knots
    type(nurbs_patch_type), intent(in) :: patch    !! surface
    type(t_spline_type), intent(out) :: spline
    integer, intent(out) :: status                 !! ok, bad_t_mesh: not a mesh of this patch

    integer :: a, d

    status = bad_t_mesh
    if (patch%dp /= 2) return
    do d = 1, 2
      associate (kv => patch%knots(d), x => mesh%lines(d)%x)
        if (kv%p /= mesh%degree(d)) return
        if (size(x) /= size(kv%u) - 2 * kv%p) return
        if (any(abs(x - kv%u(kv%p+1:size(kv%u)-kv%p)) > 0.0_wp)) return
      end associate
    end do
    call create_t_functions(mesh, spline)
    do a = 1, spline%n
      call polar_point(patch, spline, a, spline%cp(:,a))
    end do
    status = ok
  end subroutine create_t_spline

  pure subroutine create_t_functions(mesh, spline)
    !! Anchors and knots; control points are left at the origin with weight 1. Functions are
    !! numbered by rows of vertices from below, as those of a patch.
    type(t_mesh_type), intent(in) :: mesh
    type(t_spline_type), intent(out) :: spline

    integer(i8), allocatable :: points(:,:)
    integer(i8) :: at(2)
    integer :: a, d, ends1(2), ends2(2), half(2), i, j, k, k1, k2, low, n, row, row_end

    spline%degree = mesh%degree
    half = (mesh%degree - 1) / 2
    call mesh%vertices(points)
    n = size(points, 2)
    do d = 1, 2
      n = n + half(d) * count(points(d,:) == 0 .or. points(d,:) == mesh%last(d))
    end do
    spline%n = n + 4 * product(half)
    k = maxval(mesh%degree) + 2
    allocate (spline%anchor(2,spline%n), spline%line(k,2,spline%n), source=0_i8)
    allocate (spline%knots(k,2,spline%n), spline%cp(4,spline%n), source=0.0_wp)
    spline%cp(4,:) = 1.0_wp

    a = 0
    row = 1
    do while (row <= size(points, 2))
      row_end = row
      do while (row_end < size(points, 2))
        if (points(2,row_end+1) /= points(2,row)) exit
        row_end = row_end + 1
      end do
      ends2 = half(2) * [merge(-1, 0, points(2,row) == 0), &
        merge(1, 0, points(2,row) == mesh%last(2))]
      do k2 = ends2(1), ends2(2)
        do i = row, row_end
          ends1 = half(1) * [merge(-1, 0, points(1,i) == 0), &
            merge(1, 0, points(1,i) == mesh%last(1))]
          do k1 = ends1(1), ends1(2)
            a = a + 1
            spline%anchor(:,a) = points(:,i) + [k1, k2]
          end do
        end do
      end do
      row = row_end + 1
    end do

    do a = 1, spline%n
      do d = 1, 2
        low = half(d) + 2
        spline%line(low,d,a) = spline%anchor(d,a)
        do j = 1, half(d) + 1
          at = spline%anchor(:,a)
          at(d) = spline%line(low+j-1,d,a)
          spline%line(low+j,d,a) = mesh%next_line(at, d, 1)
          at(d) = spline%line(low-j+1,d,a)
          spline%line(low-j,d,a) = mesh%next_line(at, d, -1)
        end do
        k = mesh%degree(d) + 2
        spline%knots(1:k,d,a) = mesh%parameter_of(d, spline%line(1:k,d,a))
      end do
    end do
  end subroutine create_t_functions

  pure subroutine polar_point(patch, spline, a, cp)
    type(nurbs_patch_type), intent(in) :: patch   !! surface that the T-spline describes
    type(t_spline_type), intent(in) :: spline
    integer, intent(in) :: a                      !! a function
    real(wp), intent(out) :: cp(4)                !! its control point x,y,z and weight

    call homogeneous_polar_point(patch, spline%degree, spline%knots(:,:,a), cp)
    cp(1:3) = cp(1:3) / cp(4)
  end subroutine polar_point

  pure subroutine homogeneous_polar_point(patch, degree, knots, cp)
    type(nurbs_patch_type), intent(in) :: patch   !! surface
    integer, intent(in) :: degree(2)              !! its degrees
    real(wp), intent(in) :: knots(:,:)            !! of a function, in both directions
    real(wp), intent(out) :: cp(4)                !! its control value w x, w y, w z, w

    real(wp) :: c1(degree(1)+1), c2(degree(2)+1), c
    integer :: b, first(2), i, j

    call coefficients(patch%knots(1), knots(1:degree(1)+2,1), first(1), c1)
    call coefficients(patch%knots(2), knots(1:degree(2)+2,2), first(2), c2)
    cp = 0.0_wp
    do j = 1, size(c2)
      b = patch%knots(1)%functions() * (first(2) + j - 2) + first(1) - 1
      do i = 1, size(c1)
        c = c1(i) * c2(j) * patch%cp(4,b+i)
        cp(1:3) = cp(1:3) + c * patch%cp(1:3,b+i)
        cp(4) = cp(4) + c
      end do
    end do
  end subroutine homogeneous_polar_point

  pure subroutine coefficients(kv, knots, first, c)
    !! Polar form at the inner knots of a function, of the piece in the middle of its support: any
    !! would do, this one asks for least extrapolation.
    type(knot_vector), intent(in) :: kv
    real(wp), intent(in) :: knots(:)     !! of the function (p+2)
    integer, intent(out) :: first        !! first control value that contributes
    real(wp), intent(out) :: c(:)        !! coefficients of p+1 control values

    integer :: p, s

    p = kv%p
    s = kv%span(knots(1) + 0.5_wp * (knots(p+2) - knots(1)))
    first = s - p
    call polar_row(p, kv%u(s-p+1:s+p), knots(2:p+1), c)
  end subroutine coefficients

  subroutine t_spline_extraction(mesh, spline, node_ids, set, elements)
    !! Appends the elements to a set, root by root.
    type(t_mesh_type), intent(in) :: mesh
    type(t_spline_type), intent(in) :: spline
    integer, intent(in) :: node_ids(:)                 !! node of each function (n)
    type(extraction_set_type), intent(inout) :: set
    type(t_elements_type), intent(out) :: elements     !! where they lie

    type(cell_list) :: over
    integer, allocatable :: cells(:), first(:), functions(:)
    integer :: a, i, k

    cells = mesh%leaves()

    ! functions on each cell, in increasing order
    allocate (first(mesh%n+1), source=0)
    do a = 1, spline%n
      call support_cells(a)
      do i = 1, over%n
        k = over%id(i) + 1
        first(k) = first(k) + 1
      end do
    end do
    first(1) = 1
    do k = 1, mesh%n
      first(k+1) = first(k) + first(k+1)
    end do
    allocate (functions(first(mesh%n+1)-1))
    do a = 1, spline%n
      call support_cells(a)
      do i = 1, over%n
        k = over%id(i)
        functions(first(k)) = a
        first(k) = first(k) + 1
      end do
    end do
    do k = mesh%n, 2, -1
      first(k) = first(k-1)
    end do
    first(1) = 1

    elements%first = 0
    do i = 1, size(cells)
      k = cells(i)
      if (mesh%is_empty(k)) cycle
      call cell_elements(mesh, spline, k, functions(first(k):first(k+1)-1), node_ids, set, elements)
    end do
    call resize(elements, elements%ne)

  contains

    subroutine support_cells(b)
      integer, intent(in) :: b   !! a function

      integer :: d
      integer(i8) :: hi(2), lo(2)

      do d = 1, 2
        lo(d) = spline%line(1,d,b)
        hi(d) = spline%line(spline%degree(d)+2,d,b)
      end do
      call mesh%cells_over(lo, hi, over)
    end subroutine support_cells
  end subroutine t_spline_extraction

  subroutine cell_elements(mesh, spline, cell, functions, node_ids, set, elements)
    !! Elements of one leaf.
    type(t_mesh_type), intent(in) :: mesh
    type(t_spline_type), intent(in) :: spline
    integer, intent(in) :: cell                          !! leaf
    integer, intent(in) :: functions(:)                  !! functions that overlap it
    integer, intent(in) :: node_ids(:)                   !! node of each function (n)
    type(extraction_set_type), intent(inout) :: set
    type(t_elements_type), intent(inout) :: elements

    integer(i8), allocatable :: cuts1(:), cuts2(:)
    real(wp), allocatable :: b1(:,:,:), b2(:,:)
    real(wp) :: ce(size(functions),product(spline%degree+1))
    real(wp) :: lo(2), hi(2)
    integer :: nodes(size(functions))
    logical, allocatable :: lives1(:,:), lives2(:)
    integer :: f, i, id, j, k, l, n1, nen

    call cut(mesh, spline, cell, functions, 1, cuts1)
    call cut(mesh, spline, cell, functions, 2, cuts2)
    n1 = spline%degree(1) + 1
    allocate (b1(n1,size(functions),size(cuts1)-1), lives1(size(functions),size(cuts1)-1))
    allocate (b2(spline%degree(2)+1,size(functions)), lives2(size(functions)))
    do i = 1, size(cuts1) - 1
      call bezier_coefficients(mesh, spline, functions, 1, cuts1(i:i+1), lives1(:,i), b1(:,:,i))
    end do
    do j = 1, size(cuts2) - 1
      lo(2) = mesh%parameter_of(2, cuts2(j))
      hi(2) = mesh%parameter_of(2, cuts2(j+1))
      if (lo(2) >= hi(2)) cycle
      call bezier_coefficients(mesh, spline, functions, 2, cuts2(j:j+1), lives2, b2)
      do i = 1, size(cuts1) - 1
        lo(1) = mesh%parameter_of(1, cuts1(i))
        hi(1) = mesh%parameter_of(1, cuts1(i+1))
        if (lo(1) >= hi(1)) cycle
        nen = 0
        do f = 1, size(functions)
          if (.not. (lives1(f,i) .and. lives2(f))) cycle
          nen = nen + 1
          nodes(nen) = node_ids(functions(f))
          do l = 1, size(b2, 1)
            do k = 1, n1
              ce(nen,k+n1*(l-1)) = b2(l,f) * b1(k,f,i)
            end do
          end do
        end do
        call set%add_element(2, spline%degree, nodes(1:nen), ce(1:nen,:), id)
        call place(elements, id, cell, lo, hi)
        if (cuts1(i) == 0) call append(elements%side(1), id)
        if (cuts1(i+1) == mesh%last(1)) call append(elements%side(2), id)
        if (cuts2(j) == 0) call append(elements%side(3), id)
        if (cuts2(j+1) == mesh%last(2)) call append(elements%side(4), id)
      end do
    end do
  end subroutine cell_elements

  pure subroutine place(elements, id, cell, lo, hi)
    !! Notes where an element lies.
    type(t_elements_type), intent(inout) :: elements
    integer, intent(in) :: id               !! its number in the extraction set
    integer, intent(in) :: cell             !! its leaf
    real(wp), intent(in) :: lo(2), hi(2)    !! its corners

    integer :: n

    n = elements%ne
    if (n == 0) then
      elements%first = id
      allocate (elements%cell(0), elements%lo(2,0), elements%hi(2,0))
    end if
    if (n == size(elements%cell)) call resize(elements, 2 * n + 64)
    elements%ne = n + 1
    elements%cell(n+1) = cell
    elements%lo(:,n+1) = lo
    elements%hi(:,n+1) = hi
  end subroutine place

  pure subroutine resize(elements, capacity)
    type(t_elements_type), intent(inout) :: elements   !! keeps its content
    integer, intent(in) :: capacity

    integer, allocatable :: cell(:)
    real(wp), allocatable :: hi(:,:), lo(:,:)
    integer :: k

    allocate (cell(capacity), lo(2,capacity), hi(2,capacity))
    do k = 1, elements%ne
      cell(k) = elements%cell(k)
      lo(:,k) = elements%lo(:,k)
      hi(:,k) = elements%hi(:,k)
    end do
    call move_alloc(cell, elements%cell)
    call move_alloc(lo, elements%lo)
    call move_alloc(hi, elements%hi)
  end subroutine resize

  pure subroutine cut(mesh, spline, cell, functions, d, cuts)
    !! Ends of a leaf in one direction, and the knots of its functions between them.
    type(t_mesh_type), intent(in) :: mesh
    type(t_spline_type), intent(in) :: spline
    integer, intent(in) :: cell                            !! leaf
    integer, intent(in) :: functions(:)                    !! functions that overlap it
    integer, intent(in) :: d                               !! direction
    integer(i8), allocatable, intent(out) :: cuts(:)       !! increasing

    integer(i8) :: knot
    integer :: f, i, k

    cuts = [mesh%lo(d,cell), mesh%hi(d,cell)]
    do f = 1, size(functions)
      do i = 1, spline%degree(d) + 2
        knot = spline%line(i,d,functions(f))
        if (knot <= cuts(1) .or. knot >= cuts(size(cuts))) cycle
        k = count(cuts < knot)
        if (cuts(k+1) > knot) cuts = [cuts(1:k), knot, cuts(k+1:)]
      end do
    end do
  end subroutine cut

  pure subroutine bezier_coefficients(mesh, spline, functions, d, ends, lives, b)
    !! Coefficients of the functions' B-splines of one direction on an interval between knots.
    type(t_mesh_type), intent(in) :: mesh
    type(t_spline_type), intent(in) :: spline
    integer, intent(in) :: functions(:)      !! functions
    integer, intent(in) :: d                 !! direction
    integer(i8), intent(in) :: ends(2)       !! indices of the interval
    logical, intent(out) :: lives(:)         !! whether a function has it in its support
    real(wp), intent(out) :: b(:,:)          !! coefficients (degree+1,functions), 0 without support

    real(wp) :: c(spline%degree(d)+1), from, t(spline%degree(d)), to
    real(wp) :: local(1-spline%degree(d):spline%degree(d)), u(spline%degree(d)+2)
    integer :: a, f, i, k, m, p

    p = spline%degree(d)
    b = 0.0_wp
    lives = .false.
    from = mesh%parameter_of(d, ends(1))
    to = mesh%parameter_of(d, ends(2))
    if (from >= to) return
    do f = 1, size(functions)
      a = functions(f)
      m = count(spline%line(1:p+2,d,a) <= ends(1))
      lives(f) = m >= 1 .and. m < p + 2
      if (.not. lives(f)) cycle
      u = relative_knots(spline%knots(1:p+2,d,a), from, to, p)
      ! knots beyond the function's own have no influence on it
      do i = 1 - p, p
        local(i) = u(min(max(m + i, 1), p + 2))
      end do
      do k = 0, p
        t(1:p-k) = 0.0_wp
        t(p-k+1:p) = 1.0_wp
        call polar_row(p, local, t, c)
        b(k+1,f) = c(p+2-m)
      end do
    end do
  end subroutine bezier_coefficients

  pure function t_spline_side(mesh, spline, side) result(ids)
    !! Functions that do not vanish on a side, in order along it.
    type(t_mesh_type), intent(in) :: mesh
    type(t_spline_type), intent(in) :: spline
    integer, intent(in) :: side          !! 1: s=0, 2: s=1, 3: t=0, 4: t=1
    integer, allocatable :: ids(:)

    integer(i8) :: outermost
    integer :: a, across, n

    across = (side + 1) / 2
    outermost = (spline%degree(across) - 1) / 2
    if (mod(side, 2) == 0) then
      outermost = mesh%last(across) + outermost
    else
      outermost = -outermost
    end if
    allocate (ids(count(spline%anchor(across,:) == outermost)))
    n = 0
    do a = 1, spline%n
      if (spline%anchor(across,a) /= outermost) cycle
      n = n + 1
      ids(n) = a
    end do
  end function t_spline_side
end module t_spline
