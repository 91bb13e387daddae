module sparse_pattern
  !! Which entries of the global matrix exist, and where the blocks of an element lie in it.
  !!
  !! Equations are numbered node by node. The equations of one node are a block: their columns have the same rows, so
  !! that one number, the offset of row block a within the first column of block b, places a whole block of an element
  !! matrix. Equations that belong to no node (globals, multipliers) are blocks of one equation.
  !! A symmetric pattern holds the lower triangle with the diagonal, a full one both triangles. Columns are
  !! compressed, rows ascend within a column, and colptr and rowind count from 0, as the C solvers want them.
  !!
  !! Building marks the neighbours of each block and sorts them by transposing twice: the work is proportional to
  !! the pairs of nodes in the lists plus the entries of the matrix.
  use kinds, only: i8
  use status_codes, only: ok, stale_pattern, out_of_memory
  implicit none (type, external)
  private
  public :: sparse_pattern_type, pattern_builder, block_positions
  public :: begin_pattern, add_node_lists, add_equation_lists, finish_pattern, locate_blocks, locate_lists

  integer, parameter, public :: other_triangle = -1  !! offset: stored as its transpose, or a node without equations
  integer, parameter, public :: not_in_pattern = -2  !! offset: the pattern lacks this block

  type :: sparse_pattern_type
    integer :: n = 0                        !! equations
    integer :: nnz = 0                      !! stored entries
    logical :: symmetric = .true.           !! lower triangle only
    integer :: epoch = 0                    !! counts the builds; offsets and factors of another epoch are void
    integer, allocatable :: colptr(:)       !! (n+1) start of each column in rowind, from 0
    integer, allocatable :: rowind(:)       !! (nnz) rows, from 0
    integer :: nblocks = 0
    integer, allocatable :: first(:)        !! (nblocks+1) first equation of each block, from 1
    integer, allocatable :: block_of(:)     !! (nodes) block of a node, 0: it has no equations
    integer, allocatable :: adj_ptr(:)      !! (nblocks+1) start of the row blocks of each block, from 1
    integer, allocatable :: adj(:)          !! row blocks, ascending; a symmetric pattern begins with the diagonal one
    integer, allocatable :: adj_offset(:)   !! rows before that block in the first column
  end type sparse_pattern_type

  type :: pattern_builder
    !! Lists of blocks that couple. A copy taken after the bulk elements serves each new set of contact pairs.
    private
    integer :: n = 0, nlists = 0, nitems = 0
    integer, allocatable :: first(:), block_of(:), block_of_equation(:)
    integer, allocatable :: ptr(:), item(:)
  end type pattern_builder

  type :: block_positions
    !! Offsets of long-lived lists: those of list l are offset(start(l) : start(l+1)-1), an array (nen,nen).
    integer :: epoch = -1                   !! of the pattern that they belong to
    integer(i8), allocatable :: start(:)    !! (lists+1)
    integer, allocatable :: offset(:)
  end type block_positions

contains

  subroutine begin_pattern(builder, n, eq1, neq)
    !! Take the numbering of the equations; nothing is coupled yet.
    type(pattern_builder), intent(out) :: builder
    integer, intent(in) :: n       !! equations
    integer, intent(in) :: eq1(:)  !! first equation of each node
    integer, intent(in) :: neq(:)  !! equations of each node, 0: all prescribed
    integer, allocatable :: size_at(:)
    integer :: node, e, nb

    allocate (size_at(n), source=0)
    do node = 1, size(eq1)
      if (neq(node) <= 0) cycle
      if (eq1(node) < 1 .or. eq1(node) + neq(node) - 1 > n) error stop 'begin_pattern: equation out of range'
      size_at(eq1(node)) = neq(node)
    end do
    builder%n = n
    allocate (builder%first(n + 1), builder%block_of_equation(n), builder%block_of(size(eq1)))
    nb = 0
    e = 1
    do while (e <= n)
      nb = nb + 1
      builder%first(nb) = e
      size_at(e) = max(1, size_at(e))
      builder%block_of_equation(e:e + size_at(e) - 1) = nb
      e = e + size_at(e)
    end do
    builder%first(nb + 1) = n + 1
    builder%first = builder%first(1:nb + 1)
    do node = 1, size(eq1)
      builder%block_of(node) = 0
      if (neq(node) <= 0) cycle
      nb = builder%block_of_equation(eq1(node))
      if (builder%first(nb) /= eq1(node) .or. builder%first(nb + 1) - eq1(node) /= neq(node)) &
        error stop 'begin_pattern: the equations of two nodes overlap'
      builder%block_of(node) = nb
    end do
    allocate (builder%ptr(1), source=1)
    allocate (builder%item(0))
  end subroutine begin_pattern

  subroutine add_node_lists(builder, ptr, nodes)
    !! Every node of a list couples with every other of the same list: elements, contact pairs.
    type(pattern_builder), intent(inout) :: builder
    integer, intent(in) :: ptr(:)    !! (lists+1) start of each list in nodes, from 1
    integer, intent(in) :: nodes(:)  !! node numbers

    call add_lists(builder, ptr, nodes, builder%block_of)
  end subroutine add_node_lists

  subroutine add_equation_lists(builder, ptr, equations)
    !! Every equation of a list couples with every other of the same list: elements with linked dofs, globals. A
    !! node's equations couple together: naming one of them brings in its whole block.
    type(pattern_builder), intent(inout) :: builder
    integer, intent(in) :: ptr(:)        !! (lists+1) start of each list in equations, from 1
    integer, intent(in) :: equations(:)  !! equations from 1; zero or less is skipped

    call add_lists(builder, ptr, equations, builder%block_of_equation)
  end subroutine add_equation_lists

  subroutine add_lists(builder, ptr, items, block_of)
    type(pattern_builder), intent(inout) :: builder
    integer, intent(in) :: ptr(:), items(:)
    integer, intent(in) :: block_of(:)
    integer :: l, j, b, nl

    nl = max(0, size(ptr) - 1)
    if (nl == 0) return
    call reserve(builder%ptr, builder%nlists + nl + 1)
    call reserve(builder%item, builder%nitems + ptr(nl + 1) - ptr(1))
    do l = 1, nl
      do j = ptr(l), ptr(l + 1) - 1
        if (items(j) <= 0) cycle
        b = block_of(items(j))
        if (b == 0) cycle
        builder%nitems = builder%nitems + 1
        builder%item(builder%nitems) = b
      end do
      builder%nlists = builder%nlists + 1
      builder%ptr(builder%nlists + 1) = builder%nitems + 1
    end do
  end subroutine add_lists

  subroutine finish_pattern(builder, symmetric, pattern, status)
    !! Build the pattern from all lists. A pattern that existed is replaced, its epoch moves on.
    type(pattern_builder), intent(in) :: builder
    logical, intent(in) :: symmetric                 !! lower triangle only
    type(sparse_pattern_type), intent(inout) :: pattern
    integer, intent(out) :: status                   !! ok, out_of_memory (2**31 entries or more)
    integer, allocatable :: lower_ptr(:), lower(:), upper_ptr(:), upper(:), length(:)
    integer(i8) :: nnz, nadj
    integer :: nb, b, j, k, m, p, r, e, width

    status = ok
    nb = size(builder%first) - 1
    call mark_lower(builder, nb, lower_ptr, lower)
    call transpose_lists(nb, lower_ptr, lower, upper_ptr, upper)
    call transpose_lists(nb, upper_ptr, upper, lower_ptr, lower)

    pattern%epoch = pattern%epoch + 1
    pattern%n = builder%n
    pattern%symmetric = symmetric
    pattern%nblocks = nb
    pattern%first = builder%first
    pattern%block_of = builder%block_of

    nadj = int(size(lower), i8) + nb
    if (.not. symmetric) nadj = nadj + size(upper)
    if (nadj > huge(j)) then
      status = out_of_memory
      return
    end if
    pattern%adj_ptr = [(0, b=1, nb + 1)]
    if (allocated(pattern%adj)) deallocate (pattern%adj, pattern%adj_offset)
    allocate (pattern%adj(nadj), pattern%adj_offset(nadj), length(nb))
    p = 0
    nnz = 0
    do b = 1, nb
      pattern%adj_ptr(b) = p + 1
      if (.not. symmetric) then
        k = upper_ptr(b + 1) - upper_ptr(b)
        pattern%adj(p + 1:p + k) = upper(upper_ptr(b):upper_ptr(b + 1) - 1)
        p = p + k
      end if
      pattern%adj(p + 1) = b
      k = lower_ptr(b + 1) - lower_ptr(b)
      pattern%adj(p + 2:p + 1 + k) = lower(lower_ptr(b):lower_ptr(b + 1) - 1)
      p = p + 1 + k
      r = 0
      do j = pattern%adj_ptr(b), p
        pattern%adj_offset(j) = r
        r = r + builder%first(pattern%adj(j) + 1) - builder%first(pattern%adj(j))
      end do
      length(b) = r
      m = builder%first(b + 1) - builder%first(b)
      nnz = nnz + int(r, i8)*m
      if (symmetric) nnz = nnz - (m*(m - 1))/2
    end do
    pattern%adj_ptr(nb + 1) = p + 1
    if (nnz >= huge(j)) then
      status = out_of_memory
      return
    end if

    pattern%nnz = int(nnz)
    if (allocated(pattern%colptr)) deallocate (pattern%colptr, pattern%rowind)
    allocate (pattern%colptr(pattern%n + 1), pattern%rowind(pattern%nnz))
    p = 0
    do b = 1, nb
      e = builder%first(b)
      m = builder%first(b + 1) - e
      pattern%colptr(e) = p
      do j = pattern%adj_ptr(b), pattern%adj_ptr(b + 1) - 1
        r = builder%first(pattern%adj(j))
        width = builder%first(pattern%adj(j) + 1) - r
        do k = 0, width - 1
          p = p + 1
          pattern%rowind(p) = r - 1 + k
        end do
      end do
      do k = 1, m - 1
        width = length(b)
        if (symmetric) width = width - k
        pattern%colptr(e + k) = p
        j = pattern%colptr(e) + length(b)
        pattern%rowind(p + 1:p + width) = pattern%rowind(j - width + 1:j)
        p = p + width
      end do
    end do
    pattern%colptr(pattern%n + 1) = p
  end subroutine finish_pattern

  subroutine mark_lower(builder, nb, ptr, list)
    !! For each block the blocks after it that share a list with it, in the order found.
    type(pattern_builder), intent(in) :: builder
    integer, intent(in) :: nb
    integer, allocatable, intent(out) :: ptr(:), list(:)
    integer, allocatable :: list_ptr(:), list_of(:), mark(:)
    integer :: a, b, l, j, i, count

    call transpose_lists(nb, builder%ptr(1:builder%nlists + 1), builder%item(1:builder%nitems), list_ptr, list_of)
    allocate (ptr(nb + 1), list(max(16, 4*builder%nitems)))
    allocate (mark(nb), source=0)
    count = 0
    do b = 1, nb
      ptr(b) = count + 1
      do i = list_ptr(b), list_ptr(b + 1) - 1
        l = list_of(i)
        call reserve(list, count + 1 + builder%ptr(l + 1) - builder%ptr(l))
        do j = builder%ptr(l), builder%ptr(l + 1) - 1
          a = builder%item(j)
          list(count + 1) = a  ! kept only if counted
          if (a > b .and. mark(a) /= b) then
            count = count + 1
            mark(a) = b
          end if
        end do
      end do
    end do
    ptr(nb + 1) = count + 1
    list = list(1:count)
  end subroutine mark_lower

  pure subroutine transpose_lists(n, ptr, item, tptr, titem)
    !! From the items of each list to the lists of each item, ascending.
    integer, intent(in) :: n                              !! items are 1..n
    integer, intent(in) :: ptr(:), item(:)
    integer, allocatable, intent(inout) :: tptr(:), titem(:)
    integer, allocatable :: next(:), last(:)
    integer :: l, j

    allocate (next(n + 1), source=0)
    do j = 1, size(item)
      next(item(j) + 1) = next(item(j) + 1) + 1
    end do
    next(1) = 1
    do j = 2, n + 1
      next(j) = next(j) + next(j - 1)
    end do
    last = [(0, j=1, size(item))]
    tptr = next
    do l = 1, size(ptr) - 1
      do j = ptr(l), ptr(l + 1) - 1
        last(next(item(j))) = l
        next(item(j)) = next(item(j)) + 1
      end do
    end do
    call move_alloc(last, titem)
  end subroutine transpose_lists

  pure subroutine locate_blocks(pattern, nodes, offset, status)
    !! Offsets of one list by search: for lists that do not live long, such as contact points.
    type(sparse_pattern_type), intent(in) :: pattern
    integer, intent(in) :: nodes(:)      !! (nen)
    integer, intent(out) :: offset(:, :) !! (nen,nen): row block a in the first column of block b, or a code < 0
    integer, intent(out) :: status       !! ok, stale_pattern
    integer :: a, b, block_a, block_b, low, high, middle

    status = ok
    do b = 1, size(nodes)
      block_b = pattern%block_of(nodes(b))
      do a = 1, size(nodes)
        offset(a, b) = other_triangle
        block_a = pattern%block_of(nodes(a))
        if (block_a == 0 .or. block_b == 0) cycle
        if (pattern%symmetric .and. block_a < block_b) cycle
        low = pattern%adj_ptr(block_b)
        high = pattern%adj_ptr(block_b + 1)
        do while (high - low > 1)
          middle = (low + high)/2
          if (pattern%adj(middle) <= block_a) then
            low = middle
          else
            high = middle
          end if
        end do
        if (pattern%adj(low) == block_a) then
          offset(a, b) = pattern%adj_offset(low)
        else
          offset(a, b) = not_in_pattern
          status = stale_pattern
        end if
      end do
    end do
  end subroutine locate_blocks

  subroutine locate_lists(pattern, ptr, nodes, positions, status)
    !! Offsets of many lists at once, column block by column block: for the elements of the mesh.
    type(sparse_pattern_type), intent(in) :: pattern
    integer, intent(in) :: ptr(:)                   !! (lists+1) start of each list in nodes, from 1
    integer, intent(in) :: nodes(:)
    type(block_positions), intent(inout) :: positions
    integer, intent(out) :: status                  !! ok, stale_pattern
    integer, allocatable :: item(:), place_ptr(:), place(:), where_(:), list_of(:), one(:)
    integer(i8) :: k
    integer :: l, j, i, b, nl, nen

    status = ok
    nl = size(ptr) - 1
    positions%epoch = pattern%epoch
    if (allocated(positions%start)) deallocate (positions%start)
    allocate (positions%start(nl + 1))
    allocate (item(ptr(nl + 1) - 1), list_of(ptr(nl + 1) - 1))
    positions%start(1) = 1
    do l = 1, nl
      positions%start(l + 1) = positions%start(l) + int(ptr(l + 1) - ptr(l), i8)**2
      do j = ptr(l), ptr(l + 1) - 1
        list_of(j) = l
        item(j) = pattern%block_of(nodes(j)) + 1  ! 1: without equations
      end do
    end do
    if (allocated(positions%offset)) then
      if (size(positions%offset, kind=i8) /= positions%start(nl + 1) - 1) deallocate (positions%offset)
    end if
    if (.not. allocated(positions%offset)) allocate (positions%offset(positions%start(nl + 1) - 1))

    one = [(j, j=1, size(item) + 1)]
    call transpose_lists(pattern%nblocks + 1, one, item, place_ptr, place)
    allocate (where_(0:pattern%nblocks), source=not_in_pattern)
    where_(0) = other_triangle
    do b = 0, pattern%nblocks
      if (b > 0) then
        do i = pattern%adj_ptr(b), pattern%adj_ptr(b + 1) - 1
          where_(pattern%adj(i)) = pattern%adj_offset(i)
        end do
      end if
      do i = place_ptr(b + 1), place_ptr(b + 2) - 1
        j = place(i)
        l = list_of(j)
        nen = ptr(l + 1) - ptr(l)
        k = positions%start(l) + int(j - ptr(l), i8)*nen
        if (b == 0) then
          positions%offset(k:k + nen - 1) = other_triangle
        else
          positions%offset(k:k + nen - 1) = where_(item(ptr(l):ptr(l + 1) - 1) - 1)
          if (any(positions%offset(k:k + nen - 1) == not_in_pattern)) status = stale_pattern
        end if
      end do
      if (b > 0) then
        do i = pattern%adj_ptr(b), pattern%adj_ptr(b + 1) - 1
          where_(pattern%adj(i)) = not_in_pattern
        end do
        if (pattern%symmetric) where_(b) = other_triangle  ! for all columns after this one
      end if
    end do
  end subroutine locate_lists

  pure subroutine reserve(array, needed)
    !! Let the array hold at least so many items, doubling it.
    integer, allocatable, intent(inout) :: array(:)
    integer, intent(in) :: needed
    integer, allocatable :: larger(:)

    if (size(array) >= needed) return
    allocate (larger(max(needed, 2*size(array))))
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine reserve
end module sparse_pattern
