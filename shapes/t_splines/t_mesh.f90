module t_mesh
  !! T-meshes of two directions: a grid of roots, each a binary tree of cells that are split by a
  !! line in direction 1 or 2. Splitting a cell completely leaves crossings and T-junctions, never
  !! a loose end or a corner.
  !!
  !! Lines are addressed by integers, so that they are equal exactly or not at all. Index 0 is the
  !! lower end of the domain; neighbouring knots of the patch lie one `bay` (2^32) apart, also
  !! repeated knots; new lines halve. The parameter of an index follows by linear interpolation
  !! between the knots: halving is exact there too. The repeated knots of the domain's ends are the
  !! indices -1, -2, ... and last+1, last+2, ...: they carry anchors but bound no cell.
  use kinds, only: wp, i8
  use status_codes, only: ok, bad_knots, bad_t_mesh
  use knot_vectors, only: knot_vector, knot_status
  implicit none (type, external)
  private
  public :: t_mesh_type, line_family, cell_list, bay, create_t_mesh, create_t_mesh_on_lines, append

  integer(i8), parameter :: bay = 2_i8**32   !! between neighbouring knots

  !> knots of one direction and those of them that bound the roots
  type :: line_family
    real(wp), allocatable :: x(:)          !! parameters of the knots, not decreasing (0:n)
    integer, allocatable :: root(:)        !! knots that bound the roots, increasing (0:roots)
    integer, allocatable :: root_of(:)     !! root that holds each bay (0:n-1)
  end type line_family

  !> list that grows
  type :: cell_list
    integer :: n = 0                       !! items in use
    integer, allocatable :: id(:)          !! the items
  end type cell_list

  type :: t_mesh_type
    integer :: degree(2) = 0                  !! odd
    type(line_family) :: lines(2)             !! of each direction
    integer(i8) :: last(2) = 0                !! index of the domain's upper ends
    integer :: n = 0                          !! cells, split ones included; the roots come first
    integer(i8), allocatable :: lo(:,:)       !! lower ends of the cells (2,n)
    integer(i8), allocatable :: hi(:,:)       !! upper ends (2,n)
    integer, allocatable :: split(:)          !! direction in which a cell is halved, 0: leaf
    integer, allocatable :: child(:)          !! first child; the second follows it
    integer, allocatable :: level(:)          !! number of splits above a cell
    logical :: regular = .true.  !! whether all splits were made by `refine_cells` and all roots are
                                 !! single bays that are not empty
  contains
    procedure :: parameter_of        !! parameter of an index
    procedure :: split_cell          !! halves a leaf
    procedure :: middle              !! index at which a cell is halved
    procedure :: locate              !! leaf that holds a point
    procedure :: next_line           !! next line along a ray
    procedure :: cells_over          !! leaves that overlap a rectangle
    procedure :: leaves              !! all leaves, root by root
    procedure :: vertices            !! all corners of leaves
    procedure :: is_empty            !! whether a cell has no area
    procedure :: cell_box            !! parameters of a cell's corners
  end type t_mesh_type

contains

  pure subroutine create_t_mesh(knots, mesh, status)
    !! The mesh of a tensor-product patch: one root for each pair of knots, also repeated ones.
    type(knot_vector), intent(in) :: knots(:)     !! open, of odd degrees, inner knots repeated at
                                                  !! most p times (2)
    type(t_mesh_type), intent(out) :: mesh
    integer, intent(out) :: status                !! ok, bad_knots, bad_t_mesh (not supported)

    type(line_family) :: lines(2)
    integer :: d, i, n

    status = bad_t_mesh
    if (size(knots) /= 2) return
    do d = 1, 2
      associate (kv => knots(d))
        status = knot_status(kv)
        if (status /= ok) return
        status = bad_t_mesh
        if (mod(kv%p, 2) == 0 .or. .not. kv%is_open()) return
        n = kv%functions() - kv%p
        do i = kv%p + 2, size(kv%u) - 2 * kv%p - 1
          if (kv%u(i) >= kv%u(i+kv%p)) return
        end do
        allocate (lines(d)%x(0:n), source=kv%u(kv%p+1:kv%p+1+n))
        allocate (lines(d)%root(0:n), source=[(i, i = 0, n)])
      end associate
    end do
    call create_t_mesh_on_lines(knots%p, lines, mesh)
    status = ok
  end subroutine create_t_mesh

  pure subroutine create_t_mesh_on_lines(degree, lines, mesh)
    !! Roots may span several knots: these are then no lines until a cell is split there.
    integer, intent(in) :: degree(2)              !! odd
    type(line_family), intent(in) :: lines(2)     !! x and root of each direction
    type(t_mesh_type), intent(out) :: mesh

    integer :: d, i, j, k, roots(2)

    mesh%degree = degree
    do d = 1, 2
      allocate (mesh%lines(d)%x(0:ubound(lines(d)%x, 1)), source=lines(d)%x)
      allocate (mesh%lines(d)%root(0:ubound(lines(d)%root, 1)), source=lines(d)%root)
      associate (line => mesh%lines(d))
        roots(d) = ubound(line%root, 1)
        mesh%last(d) = ubound(line%x, 1) * bay
        allocate (line%root_of(0:ubound(line%x, 1)-1))
        do i = 1, roots(d)
          line%root_of(line%root(i-1):line%root(i)-1) = i - 1
          mesh%regular = mesh%regular .and. line%root(i) == line%root(i-1) + 1
        end do
        do i = 1, ubound(line%x, 1)
          mesh%regular = mesh%regular .and. line%x(i) > line%x(i-1)
        end do
      end associate
    end do

    mesh%n = product(roots)
    allocate (mesh%lo(2,mesh%n), mesh%hi(2,mesh%n))
    allocate (mesh%split(mesh%n), mesh%child(mesh%n), mesh%level(mesh%n), source=0)
    k = 0
    do j = 1, roots(2)
      do i = 1, roots(1)
        k = k + 1
        mesh%lo(:,k) = [mesh%lines(1)%root(i-1), mesh%lines(2)%root(j-1)] * bay
        mesh%hi(:,k) = [mesh%lines(1)%root(i), mesh%lines(2)%root(j)] * bay
      end do
    end do
  end subroutine create_t_mesh_on_lines

  pure elemental real(wp) function parameter_of(self, d, index) result(x)
    class(t_mesh_type), intent(in) :: self
    integer, intent(in) :: d               !! direction
    integer(i8), intent(in) :: index       !! of a line; those beyond the domain repeat its ends

    integer(i8) :: at
    integer :: i

    at = min(max(index, 0_i8), self%last(d))
    i = int(at / bay)
    x = self%lines(d)%x(i)
    at = at - i * bay
    if (at > 0) x = x + (self%lines(d)%x(i+1) - x) * (real(at, wp) / real(bay, wp))
  end function parameter_of

  pure integer(i8) function middle(self, cell, d)
    class(t_mesh_type), intent(in) :: self
    integer, intent(in) :: cell        !! a cell
    integer, intent(in) :: d           !! direction across the new line

    middle = (self%lo(d,cell) + self%hi(d,cell)) / 2
    if (self%hi(d,cell) - self%lo(d,cell) > bay) middle = ((middle + bay / 2) / bay) * bay
  end function middle

  pure logical function is_empty(self, cell)
    class(t_mesh_type), intent(in) :: self
    integer, intent(in) :: cell        !! a cell

    is_empty = any(self%parameter_of([1, 2], self%lo(:,cell)) &
      >= self%parameter_of([1, 2], self%hi(:,cell)))
  end function is_empty

  pure subroutine cell_box(self, cell, lo, hi)
    class(t_mesh_type), intent(in) :: self
    integer, intent(in) :: cell               !! a cell
    real(wp), intent(out) :: lo(2), hi(2)     !! parameters of its corners

    lo = self%parameter_of([1, 2], self%lo(:,cell))
    hi = self%parameter_of([1, 2], self%hi(:,cell))
  end subroutine cell_box

  pure subroutine split_cell(self, cell, d, at, done)
    !! Halves a leaf, unless there is no room in floating point for a line between its ends. A line
    !! at a repeated knot has room.
    class(t_mesh_type), intent(inout) :: self
    integer, intent(in) :: cell           !! a leaf
    integer, intent(in) :: d              !! direction across the new line
    integer(i8), intent(in) :: at         !! index of the new line
    logical, intent(out) :: done

    integer(i8), allocatable :: lo(:,:), hi(:,:)
    integer :: first, capacity

    done = self%split(cell) == 0 .and. at > self%lo(d,cell) .and. at < self%hi(d,cell)
    if (.not. done) return
    if (mod(at, bay) /= 0) done = self%parameter_of(d, at) > self%parameter_of(d, self%lo(d,cell)) &
      .and. self%parameter_of(d, at) < self%parameter_of(d, self%hi(d,cell))
    if (.not. done) return

    capacity = size(self%split)
    if (self%n + 2 > capacity) then
      allocate (lo(2,2*capacity+2), hi(2,2*capacity+2), source=0_i8)
      lo(:,1:capacity) = self%lo
      hi(:,1:capacity) = self%hi
      call move_alloc(lo, self%lo)
      call move_alloc(hi, self%hi)
      call grow(self%split, 2 * capacity + 2)
      call grow(self%child, 2 * capacity + 2)
      call grow(self%level, 2 * capacity + 2)
    end if
    first = self%n + 1
    self%n = self%n + 2
    self%lo(:,first) = self%lo(:,cell)
    self%hi(:,first) = self%hi(:,cell)
    self%lo(:,first+1) = self%lo(:,cell)
    self%hi(:,first+1) = self%hi(:,cell)
    self%hi(d,first) = at
    self%lo(d,first+1) = at
    self%level(first:first+1) = self%level(cell) + 1
    self%split(first:first+1) = 0
    self%split(cell) = d
    self%child(cell) = first
  end subroutine split_cell

  pure subroutine grow(array, n)
    integer, allocatable, intent(inout) :: array(:)    !! keeps its content
    integer, intent(in) :: n                           !! new size

    integer, allocatable :: larger(:)

    allocate (larger(n), source=0)
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine grow

  pure integer function locate(self, at, side) result(cell)
    class(t_mesh_type), intent(in) :: self
    integer(i8), intent(in) :: at(2)      !! indices of a point of the domain
    integer, intent(in) :: side(2)        !! where a line passes through the point: 1 for the cell
                                          !! behind the line, -1 for the one before it

    integer :: d, root(2)

    do d = 1, 2
      root(d) = int(at(d) / bay)
      if (mod(at(d), bay) == 0 .and. side(d) < 0) root(d) = root(d) - 1
      root(d) = self%lines(d)%root_of(root(d))
    end do
    cell = 1 + root(1) + ubound(self%lines(1)%root, 1) * root(2)
    do while (self%split(cell) > 0)
      d = self%split(cell)
      cell = self%child(cell)
      if (at(d) > self%hi(d,cell) .or. (at(d) == self%hi(d,cell) .and. side(d) > 0)) cell = cell + 1
    end do
  end function locate

  pure integer(i8) function next_line(self, at, d, way) result(line)
    !! The next line that a ray along direction d meets. A ray along an edge meets the lines that
    !! end on it from either side. Beyond the domain the repeated knots follow.
    class(t_mesh_type), intent(in) :: self
    integer(i8), intent(in) :: at(2)      !! indices of a point
    integer, intent(in) :: d              !! direction of the ray
    integer, intent(in) :: way            !! 1: up, -1: down

    integer(i8) :: place(2)
    integer :: cell, half, side(2)

    line = at(d) + way
    if (at(d) < 0 .or. at(d) > self%last(d)) return
    if (way > 0 .and. at(d) == self%last(d)) return
    if (way < 0 .and. at(d) == 0) return

    place = min(max(at, 0_i8), self%last)
    side(d) = way
    line = merge(self%last(d), 0_i8, way > 0)
    do half = -1, 1, 2
      if (half < 0 .and. place(3-d) == 0) cycle
      if (half > 0 .and. place(3-d) == self%last(3-d)) cycle
      side(3-d) = half
      cell = self%locate(place, side)
      if (way > 0) then
        line = min(line, self%hi(d,cell))
      else
        line = max(line, self%lo(d,cell))
      end if
    end do
  end function next_line

  pure subroutine cells_over(self, lo, hi, found)
    !! Leaves that overlap a rectangle by more than an edge, root by root.
    class(t_mesh_type), intent(in) :: self
    integer(i8), intent(in) :: lo(2), hi(2)       !! indices of its corners
    type(cell_list), intent(inout) :: found       !! its memory is used again

    type(cell_list) :: stack
    integer(i8) :: from(2), to(2)
    integer :: cell, d, first(2), i, j, last(2)

    found%n = 0
    from = max(lo, 0_i8)
    to = min(hi, self%last)
    if (any(to <= from)) return
    do d = 1, 2
      first(d) = self%lines(d)%root_of(int(from(d) / bay))
      last(d) = self%lines(d)%root_of(int((to(d) - 1) / bay))
    end do
    do j = first(2), last(2)
      do i = first(1), last(1)
        call append(stack, 1 + i + ubound(self%lines(1)%root, 1) * j)
        do while (stack%n > 0)
          cell = stack%id(stack%n)
          stack%n = stack%n - 1
          if (any(self%lo(:,cell) >= to .or. self%hi(:,cell) <= from)) cycle
          if (self%split(cell) == 0) then
            call append(found, cell)
          else
            call append(stack, self%child(cell) + 1)
            call append(stack, self%child(cell))
          end if
        end do
      end do
    end do
  end subroutine cells_over

  pure subroutine append(list, item)
    type(cell_list), intent(inout) :: list
    integer, intent(in) :: item

    if (.not. allocated(list%id)) allocate (list%id(64))
    if (list%n == size(list%id)) call grow(list%id, 2 * list%n)
    list%n = list%n + 1
    list%id(list%n) = item
  end subroutine append

  pure function leaves(self) result(cells)
    class(t_mesh_type), intent(in) :: self
    integer, allocatable :: cells(:)   !! all leaves, root by root

    type(cell_list) :: found

    call self%cells_over([0_i8, 0_i8], self%last, found)
    allocate (cells(found%n), source=found%id(1:found%n))
  end function leaves

  pure subroutine vertices(self, points)
    class(t_mesh_type), intent(in) :: self
    integer(i8), allocatable, intent(out) :: points(:,:)  !! indices, by rows from below (2,number)

    integer(i8), allocatable :: corner(:,:)
    integer, allocatable :: cells(:)
    integer :: i, k, n

    cells = self%leaves()
    n = size(cells)
    allocate (corner(2,4*n))
    do i = 1, n
      k = cells(i)
      corner(:,4*i-3) = self%lo(:,k)
      corner(:,4*i-2) = [self%hi(1,k), self%lo(2,k)]
      corner(:,4*i-1) = [self%lo(1,k), self%hi(2,k)]
      corner(:,4*i) = self%hi(:,k)
    end do
    call sort_points(corner)
    n = 0
    do i = 1, size(corner, 2)
      if (n > 0) then
        if (all(corner(:,i) == corner(:,n))) cycle
      end if
      n = n + 1
      corner(:,n) = corner(:,i)
    end do
    allocate (points(2,n))
    points(:,:) = corner(:,1:n)
  end subroutine vertices

  pure subroutine sort_points(points)
    !! By the second coordinate, then by the first: merging of runs that double.
    integer(i8), allocatable, intent(inout) :: points(:,:)   !! (2,number)

    integer(i8), allocatable :: from(:,:), to(:,:)
    integer :: finish, i, j, k, n, start, step
    logical :: left

    call move_alloc(points, from)
    n = size(from, 2)
    allocate (to(2,n))
    step = 1
    do while (step < n)
      do start = 1, n, 2 * step
        i = start
        j = min(start + step, n + 1)
        finish = min(start + 2 * step, n + 1)
        do k = start, finish - 1
          left = j >= finish
          if (i < min(start + step, n + 1) .and. .not. left) left = from(2,i) < from(2,j) &
            .or. (from(2,i) == from(2,j) .and. from(1,i) <= from(1,j))
          if (left) then
            to(:,k) = from(:,i)
            i = i + 1
          else
            to(:,k) = from(:,j)
            j = j + 1
          end if
        end do
      end do
      call move_alloc(from, points)
      call move_alloc(to, from)
      call move_alloc(points, to)
      step = 2 * step
    end do
    call move_alloc(from, points)
  end subroutine sort_points
end module t_mesh
