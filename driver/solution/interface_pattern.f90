module interface_pattern
  !! Room in the matrix for the pairs of an interface, and for those that points come to by sliding a little.
  use surface_facets, only: facet_surface
  use interface_points, only: interface_points_type
  implicit none (type, external)
  private
  public :: pair_lists, pairs_covered

  integer, parameter :: margin = 2   !! facets around the present pair that the matrix pattern has room for

contains

  function pairs_covered(points) result(covered)
    !! Whether the matrix pattern has room for every present pair.
    type(interface_points_type), intent(in) :: points
    logical :: covered
    integer :: i, near((1 + 2*margin)**2 + 1), n

    covered = .true.
    do i = 1, points%np
      if (points%facet(i) == 0 .or. points%facet(i) == points%room_for(i)) cycle
      covered = points%room_for(i) > 0
      if (.not. covered) return
      call facets_around(points%master, points%room_for(i), near, n)
      covered = any(near(1:n) == points%facet(i))
      if (.not. covered) return
    end do
  end function pairs_covered

  subroutine pair_lists(points, ptr, nodes)
    !! Lists of nodes that couple: each slave facet with the master facets around its points' pairs. Notes them as
    !! the pairs that the pattern has room for.
    type(interface_points_type), intent(inout), target :: points
    integer, allocatable, intent(inout) :: ptr(:), nodes(:)   !! lists so far, extended
    integer :: i, k, n, s, near((1 + 2*margin)**2 + 1), ns, first, lists, items
    integer, allocatable :: seen(:)
    integer, pointer, contiguous :: slave_nodes(:), master_nodes(:)

    points%room_for = points%facet
    allocate (seen(points%np*size(near)))
    lists = size(ptr) - 1
    items = size(nodes)
    ns = 0
    first = 1
    do i = 1, points%np
      s = points%facet_of(i)
      if (i > 1) then
        if (points%facet_of(i - 1) /= s) first = ns + 1
      end if
      if (points%facet(i) == 0) cycle
      slave_nodes => points%slave%set%connectivity(s)
      call facets_around(points%master, points%facet(i), near, n)
      do k = 1, n
        if (any(seen(first:ns) == near(k))) cycle
        ns = ns + 1
        seen(ns) = near(k)
        master_nodes => points%master%set%connectivity(near(k))
        call reserve(ptr, lists + 2)
        call reserve(nodes, items + size(slave_nodes) + size(master_nodes))
        nodes(items + 1:items + size(slave_nodes)) = slave_nodes
        items = items + size(slave_nodes)
        nodes(items + 1:items + size(master_nodes)) = master_nodes
        items = items + size(master_nodes)
        lists = lists + 1
        ptr(lists + 1) = items + 1
      end do
    end do
    call cut(ptr, lists + 1)
    call cut(nodes, items)
  end subroutine pair_lists

  pure subroutine cut(array, n)
    !! Keep the first n items; element by element, as the temporary of array(1:n) may be larger than the stack.
    integer, allocatable, intent(inout) :: array(:)
    integer, intent(in) :: n
    integer, allocatable :: smaller(:)
    integer :: i

    allocate (smaller(n))
    do i = 1, n
      smaller(i) = array(i)
    end do
    call move_alloc(smaller, array)
  end subroutine cut

  pure subroutine reserve(array, needed)
    !! Room for so many items; doubling, so that growth costs little.
    integer, allocatable, intent(inout) :: array(:)
    integer, intent(in) :: needed
    integer, allocatable :: larger(:)

    if (size(array) >= needed) return
    allocate (larger(2*needed))
    larger(1:size(array)) = array
    call move_alloc(larger, array)
  end subroutine reserve

  pure subroutine facets_around(surface, facet, near, n)
    !! A facet and its neighbours up to `margin` steps away.
    type(facet_surface), intent(in) :: surface
    integer, intent(in) :: facet
    integer, intent(out) :: near(:), n
    integer :: ring, first, last, k, s, f

    n = 1
    near(1) = facet
    first = 1
    do ring = 1, margin
      last = n
      do k = first, last
        do s = 1, size(surface%neighbour, 1)
          f = surface%neighbour(s, near(k))
          if (f == 0 .or. n == size(near)) cycle
          if (any(near(1:n) == f)) cycle
          n = n + 1
          near(n) = f
        end do
      end do
      first = last + 1
    end do
  end subroutine facets_around
end module interface_pattern
