module tie_nodes
  !! Nodes at the same place with the same weight become one (TIE). Candidates are found by sorting
  !! along a direction that no mesh is aligned with, so that only coinciding points are neighbours
  !! in that order.
  use kinds, only: wp
  use extraction_set, only: extraction_set_type
  implicit none (type, external)
  private
  public :: coinciding_nodes, renumber_mesh

  !> unit vector without simple ratios between its components
  real(wp), parameter :: sweep(3) = [0.5377203_wp, 0.6543811_wp, 0.5316079_wp]

contains

  subroutine coinciding_nodes(x, w, group, tol, map, different_weight)
    real(wp), intent(in) :: x(:, :)             !! control points (ndm,nn) [length]
    real(wp), intent(in) :: w(:)                !! weights (nn)
    integer, intent(in) :: group(:)             !! nodes of one group may be tied (nn); 0: never
    real(wp), intent(in) :: tol                 !! of places [length]
    integer, intent(out) :: map(:)              !! lowest node that each is tied to, or itself (nn)
    integer, intent(out) :: different_weight    !! pairs that differ in weight, not tied
    real(wp), parameter :: weight_tolerance = 1e-9_wp  !! relative
    real(wp) :: s(size(w)), reach
    integer, allocatable :: order(:)
    integer :: a, b, i, j

    different_weight = 0
    do a = 1, size(w)
      map(a) = a
      s(a) = dot_product(sweep(1:size(x, 1)), x(:, a))
    end do
    call sort_by_value(s, order)
    reach = tol*sqrt(real(size(x, 1), wp))
    do i = 1, size(w)
      a = order(i)
      if (group(a) == 0) cycle
      do j = i + 1, size(w)
        b = order(j)
        if (s(b) - s(a) > reach) exit
        if (group(b) /= group(a)) cycle
        if (any(abs(x(:, a) - x(:, b)) > tol)) cycle
        if (abs(w(a) - w(b)) > weight_tolerance*max(abs(w(a)), abs(w(b)))) then
          different_weight = different_weight + 1
          cycle
        end if
        call join(map, a, b)
      end do
    end do
    do a = 1, size(w)
      map(a) = root(map, a)
    end do
  end subroutine coinciding_nodes

  pure subroutine join(map, a, b)
    !! The trees of a and b become one; the lowest node is the root.
    integer, intent(inout) :: map(:)
    integer, intent(in) :: a, b
    integer :: ra, rb

    ra = root(map, a)
    rb = root(map, b)
    map(max(ra, rb)) = min(ra, rb)
  end subroutine join

  pure integer function root(map, a)
    integer, intent(in) :: map(:)
    integer, intent(in) :: a

    root = a
    do while (map(root) /= root)
      root = map(root)
    end do
  end function root

  subroutine renumber_mesh(mesh, map)
    !! Replace nodes by those they are tied to. Functions of one element that now share a node
    !! become one, their sum: as their weights agree, w N_a + w N_b = w (N_a + N_b).
    type(extraction_set_type), intent(inout), target :: mesh
    integer, intent(in) :: map(:)                   !! new node of each node (nn)
    type(extraction_set_type) :: merged
    integer, allocatable :: nodes(:), place(:)
    real(wp), allocatable :: ce(:, :)
    real(wp), pointer, contiguous :: old(:, :)
    integer, pointer, contiguous :: ix(:)
    integer :: a, e, id, k, n, op
    logical :: double

    if (mesh%ne == 0) return
    do k = 1, mesh%node_ptr(mesh%ne + 1) - 1
      mesh%nodes(k) = map(mesh%nodes(k))
    end do

    allocate (place(size(map)), source=0)
    double = .false.
    do e = 1, mesh%ne
      ix => mesh%connectivity(e)
      if (repeated(ix, place)) double = .true.
    end do
    if (.not. double) return

    call merged%init()
    do e = 1, mesh%ne
      ix => mesh%connectivity(e)
      old => mesh%operator(e)
      if (.not. repeated(ix, place)) then
        call merged%add_operator(old, op)
        call merged%add_element_with_operator(mesh%dp(e), mesh%degree(:, e), ix, op, id)
        cycle
      end if
      allocate (nodes(size(ix)), ce(size(old, 1), size(old, 2)))
      n = 0
      do a = 1, size(ix)
        if (place(ix(a)) == 0) then
          n = n + 1
          nodes(n) = ix(a)
          place(ix(a)) = n
          ce(n, :) = old(a, :)
        else
          ce(place(ix(a)), :) = ce(place(ix(a)), :) + old(a, :)
        end if
      end do
      place(nodes(1:n)) = 0
      call merged%add_element(mesh%dp(e), mesh%degree(:, e), nodes(1:n), ce(1:n, :), id)
      deallocate (nodes, ce)
    end do
    mesh = merged
  end subroutine renumber_mesh

  logical function repeated(ix, mark)
    !! Does a list name a node twice?
    integer, intent(in) :: ix(:)
    integer, intent(inout) :: mark(:)   !! zero before and after
    integer :: a

    repeated = .false.
    do a = 1, size(ix)
      if (mark(ix(a)) /= 0) repeated = .true.
      mark(ix(a)) = 1
    end do
    mark(ix) = 0
  end function repeated

  pure subroutine sort_by_value(s, order)
    !! Merge sort, bottom up.
    real(wp), intent(in) :: s(:)
    integer, allocatable, intent(out) :: order(:)   !! s(order) does not decrease
    integer :: other(size(s)), i, j, k, left, middle, right, width

    order = [(i, i = 1, size(s))]
    width = 1
    do while (width < size(s))
      do left = 1, size(s), 2*width
        middle = min(left + width, size(s) + 1)
        right = min(left + 2*width, size(s) + 1)
        i = left
        j = middle
        do k = left, right - 1
          if (i < middle) then
            if (j >= right) then
              other(k) = order(i)
              i = i + 1
              cycle
            else if (s(order(i)) <= s(order(j))) then
              other(k) = order(i)
              i = i + 1
              cycle
            end if
          end if
          other(k) = order(j)
          j = j + 1
        end do
      end do
      order = other
      width = 2*width
    end do
  end subroutine sort_by_value
end module tie_nodes
