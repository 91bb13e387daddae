module box_tree
  !! A tree of bounding boxes over facets: building costs N log N, moving the boxes costs N, a nearest-facet query
  !! about log N. Boxes are stored by node of a complete recursion; leaves hold a few facets.
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: box_tree_type

  integer, parameter :: leaf_size = 4

  type :: box_tree_type
    integer :: ndm = 0, nnodes = 0
    integer, allocatable :: order(:)           !! facets in leaf order
    integer, allocatable :: first(:), last(:)  !! range of `order` below a node
    integer, allocatable :: left(:)            !! left child (right child = left + 1), 0 for a leaf
    real(wp), allocatable :: lo(:, :), hi(:, :) !! boxes of the nodes (ndm,nnodes)
  contains
    procedure :: build
    procedure :: refit
    procedure :: candidates
  end type box_tree_type

contains

  subroutine build(self, lo, hi)
    !! Build over given boxes.
    class(box_tree_type), intent(inout) :: self
    real(wp), intent(in) :: lo(:, :), hi(:, :)   !! corners of the facets' boxes (ndm,nf) [length]
    integer :: nf, i, node, axis, mid
    real(wp) :: width(size(lo, 1))
    real(wp), allocatable :: centre(:, :)        ! twice (nf,ndm)

    nf = size(lo, 2)
    self%ndm = size(lo, 1)
    if (allocated(self%order)) deallocate (self%order, self%first, self%last, self%left, self%lo, self%hi)
    allocate (self%order(nf), self%first(2*nf + 1), self%last(2*nf + 1), self%left(2*nf + 1))
    self%order = [(i, i=1, nf)]
    allocate (centre(size(lo, 2), size(lo, 1)))
    centre(:, :) = transpose(lo + hi)
    self%nnodes = 1
    self%first(1) = 1
    self%last(1) = nf
    self%left = 0
    node = 0
    do while (node < self%nnodes)  ! breadth first: children come after their parent
      node = node + 1
      associate (a => self%first(node), b => self%last(node))
        if (b - a + 1 <= leaf_size) cycle
        do i = 1, self%ndm
          width(i) = maxval(centre(self%order(a:b), i)) - minval(centre(self%order(a:b), i))
        end do
        axis = maxloc(width, 1)
        mid = (a + b)/2
        call split_at(self%order(a:b), centre(:, axis), mid - a + 1)
        self%left(node) = self%nnodes + 1
        self%first(self%nnodes + 1) = a
        self%last(self%nnodes + 1) = mid
        self%first(self%nnodes + 2) = mid + 1
        self%last(self%nnodes + 2) = b
        self%nnodes = self%nnodes + 2
      end associate
    end do
    allocate (self%lo(self%ndm, self%nnodes), self%hi(self%ndm, self%nnodes))
    call self%refit(lo, hi)
  end subroutine build

  pure subroutine split_at(items, key, k)
    !! Reorder items so that those with the k smallest keys come first (quickselect).
    integer, intent(inout) :: items(:)
    real(wp), intent(in) :: key(:)
    integer, intent(in) :: k
    integer :: a, b, i, j, swap
    real(wp) :: pivot

    a = 1
    b = size(items)
    do while (a < b)
      pivot = key(items((a + b)/2))
      i = a
      j = b
      do
        do while (key(items(i)) < pivot)
          i = i + 1
        end do
        do while (key(items(j)) > pivot)
          j = j - 1
        end do
        if (i <= j) then
          swap = items(i)
          items(i) = items(j)
          items(j) = swap
          i = i + 1
          j = j - 1
        end if
        if (i > j) exit
      end do
      if (k <= j) then
        b = j
      else if (k >= i) then
        a = i
      else
        exit
      end if
    end do
  end subroutine split_at

  pure subroutine refit(self, lo, hi)
    !! Move the boxes with the facets; the tree keeps its shape.
    class(box_tree_type), intent(inout) :: self
    real(wp), intent(in) :: lo(:, :), hi(:, :)   !! (ndm,nf) [length]
    integer :: node, i

    do node = self%nnodes, 1, -1
      if (self%left(node) == 0) then
        self%lo(:, node) = huge(1.0_wp)
        self%hi(:, node) = -huge(1.0_wp)
        do i = self%first(node), self%last(node)
          self%lo(:, node) = min(self%lo(:, node), lo(:, self%order(i)))
          self%hi(:, node) = max(self%hi(:, node), hi(:, self%order(i)))
        end do
      else
        self%lo(:, node) = min(self%lo(:, self%left(node)), self%lo(:, self%left(node) + 1))
        self%hi(:, node) = max(self%hi(:, self%left(node)), self%hi(:, self%left(node) + 1))
      end if
    end do
  end subroutine refit

  pure subroutine candidates(self, lo, hi, x, radius, found, n)
    !! The facets whose box comes within a radius of a point, nearest box first (at most size(found) of them).
    class(box_tree_type), intent(in) :: self
    real(wp), intent(in) :: lo(:, :), hi(:, :)   !! the facets' boxes, as last given (ndm,nf) [length]
    real(wp), intent(in) :: x(:)                 !! point (ndm) [length]
    real(wp), intent(in) :: radius               !! [length]
    integer, intent(out) :: found(:)             !! facets
    integer, intent(out) :: n                    !! how many
    real(wp) :: distance(size(found)), d2, limit
    integer :: stack(2*64), depth, node, i, j

    n = 0
    limit = radius**2
    if (self%nnodes == 0) return
    depth = 1
    stack(1) = 1
    do while (depth > 0)
      node = stack(depth)
      depth = depth - 1
      if (box_distance(self%lo(:, node), self%hi(:, node), x) > limit) cycle
      if (self%left(node) > 0) then
        ! the nearer child is looked at first, so that the list fills with near facets and the limit shrinks
        if (box_distance(self%lo(:, self%left(node)), self%hi(:, self%left(node)), x) &
            <= box_distance(self%lo(:, self%left(node) + 1), self%hi(:, self%left(node) + 1), x)) then
          stack(depth + 1) = self%left(node) + 1
          stack(depth + 2) = self%left(node)
        else
          stack(depth + 1) = self%left(node)
          stack(depth + 2) = self%left(node) + 1
        end if
        depth = depth + 2
        cycle
      end if
      do i = self%first(node), self%last(node)
        d2 = box_distance(lo(:, self%order(i)), hi(:, self%order(i)), x)
        if (d2 > limit) cycle
        if (n < size(found)) n = n + 1
        j = n
        do while (j > 1)
          if (distance(j - 1) <= d2) exit
          distance(j) = distance(j - 1)
          found(j) = found(j - 1)
          j = j - 1
        end do
        distance(j) = d2
        found(j) = self%order(i)
        if (n == size(found)) limit = min(limit, distance(n))
      end do
    end do
  end subroutine candidates

  pure function box_distance(lo, hi, x) result(d2)
    real(wp), intent(in) :: lo(:), hi(:), x(:)
    real(wp) :: d2   !! squared distance [length^2]
    d2 = sum(max(lo - x, 0.0_wp, x - hi)**2)
  end function box_distance
end module box_tree
