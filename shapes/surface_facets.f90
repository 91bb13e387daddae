module surface_facets
  !! Surfaces as extraction elements one dimension lower, and which facet lies across each of their sides.
  use kinds, only: wp, i8
  use extraction_set, only: extraction_set_type
  use side_extraction, only: side_operator, side_functions
  implicit none (type, external)
  private
  public :: facet_surface, build_surface_facets

  type :: facet_surface
    type(extraction_set_type) :: set             !! facets: degrees, nodes, operators
    integer, allocatable :: element(:), side(:)  !! where each comes from; side 0: the element itself (a shell)
    integer, allocatable :: neighbour(:, :)      !! (2*dp,nf) facet across s=0, s=1, t=0, t=1; 0: none
  end type facet_surface

contains

  subroutine build_surface_facets(mesh, elements, sides, surface)
    !! Facets of a list of sides, in its order.
    type(extraction_set_type), intent(in), target :: mesh
    integer, intent(in) :: elements(:)           !! of the mesh
    integer, intent(in) :: sides(:)              !! side of each; 0: the element itself (a shell)
    type(facet_surface), intent(out) :: surface
    integer :: f, e, s, dp, n, id
    integer, allocatable :: rows(:), side_degree(:)
    real(wp), allocatable :: ce_side(:, :)
    integer, pointer, contiguous :: nodes(:)
    real(wp), pointer, contiguous :: ce(:, :)

    surface%element = elements
    surface%side = sides
    call surface%set%init()
    do f = 1, size(elements)
      e = surface%element(f)
      s = surface%side(f)
      dp = mesh%dp(e)
      nodes => mesh%connectivity(e)
      ce => mesh%operator(e)
      if (s == 0) then
        call surface%set%add_element(dp, mesh%degree(:, e), nodes, ce, id)
        cycle
      end if
      allocate (rows(size(nodes)), side_degree(max(dp - 1, 1)))
      allocate (ce_side(size(nodes), side_functions(mesh%degree(1:dp, e), s)))
      call side_operator(mesh%degree(1:dp, e), ce, s, side_degree, n, rows, ce_side)
      call surface%set%add_element(dp - 1, side_degree, nodes(rows(1:n)), ce_side(1:n, :), id)
      deallocate (rows, side_degree, ce_side)
    end do
    call find_neighbours(surface)
  end subroutine build_surface_facets

  subroutine find_neighbours(surface)
    !! Two facets are neighbours across the side on which the same functions live.
    type(facet_surface), intent(inout), target :: surface
    integer :: nf, f, s, dp, i, j, n, other
    integer(i8), allocatable :: key(:)
    integer, allocatable :: order(:), na(:), nb(:)

    nf = surface%set%ne
    dp = 0
    if (nf > 0) dp = maxval(surface%set%dp(1:nf))
    allocate (surface%neighbour(2*dp, nf), source=0)
    if (dp == 0) return
    allocate (key(2*dp*nf), order(2*dp*nf))
    do f = 1, nf
      do s = 1, 2*dp
        i = s + 2*dp*(f - 1)
        key(i) = 0
        call side_nodes(surface%set, f, s, na)
        do j = 1, size(na)
          key(i) = key(i) + mixed(int(na(j), i8))  ! a sum: the order of nodes does not matter
        end do
      end do
    end do
    call sort_by_key(key, order)
    i = 1
    do while (i <= size(order))
      n = 1
      do while (i + n <= size(order))
        if (key(order(i + n)) /= key(order(i))) exit
        n = n + 1
      end do
      if (n == 2) then
        f = (order(i) - 1)/(2*dp) + 1
        other = (order(i + 1) - 1)/(2*dp) + 1
        call side_nodes(surface%set, f, order(i) - 2*dp*(f - 1), na)
        call side_nodes(surface%set, other, order(i + 1) - 2*dp*(other - 1), nb)
        if (f /= other .and. same_nodes(na, nb)) then
          surface%neighbour(order(i) - 2*dp*(f - 1), f) = other
          surface%neighbour(order(i + 1) - 2*dp*(other - 1), other) = f
        end if
      end if
      i = i + n
    end do
  end subroutine find_neighbours

  subroutine side_nodes(set, f, s, list)
    !! Nodes whose functions live on side s of facet f.
    type(extraction_set_type), intent(in), target :: set
    integer, intent(in) :: f, s
    integer, allocatable, intent(out) :: list(:)
    integer :: dp, n
    integer, pointer, contiguous :: nodes(:)
    real(wp), pointer, contiguous :: ce(:, :)
    integer, allocatable :: rows(:), side_degree(:)
    real(wp), allocatable :: ce_side(:, :)

    dp = set%dp(f)
    nodes => set%connectivity(f)
    ce => set%operator(f)
    allocate (rows(size(nodes)), side_degree(max(dp - 1, 1)))
    allocate (ce_side(size(nodes), side_functions(set%degree(1:dp, f), s)))
    call side_operator(set%degree(1:dp, f), ce, s, side_degree, n, rows, ce_side)
    list = nodes(rows(1:n))
  end subroutine side_nodes

  pure function same_nodes(a, b) result(same)
    integer, intent(in) :: a(:), b(:)
    logical :: same
    integer :: i

    same = size(a) == size(b)
    do i = 1, size(a)
      if (.not. same) return
      same = any(b == a(i))
    end do
  end function same_nodes

  elemental function mixed(i) result(code)
    !! A well-mixed 63-bit code of a node number (xorshift; sums of codes rarely coincide).
    integer(i8), intent(in) :: i
    integer(i8) :: code
    integer :: round

    code = ieor(i, ishft(i, 21))
    do round = 1, 3
      code = ieor(code, ishft(code, 13))
      code = ieor(code, ishft(code, -7))
      code = ieor(code, ishft(code, 17))
    end do
    code = shiftr(code, 8)  ! sums of a few hundred codes stay in range
  end function mixed

  pure subroutine sort_by_key(key, order)
    !! Merge sort of indices.
    integer(i8), intent(in) :: key(:)
    integer, intent(out) :: order(:)
    integer :: work(size(order)), n, width, lo, mid, hi, i, j, k

    n = size(order)
    order = [(i, i=1, n)]
    width = 1
    do while (width < n)
      do lo = 1, n, 2*width
        mid = min(lo + width, n + 1)
        hi = min(lo + 2*width, n + 1)
        i = lo
        j = mid
        do k = lo, hi - 1
          if (i < mid .and. (j >= hi)) then
            work(k) = order(i)
            i = i + 1
          else if (i >= mid) then
            work(k) = order(j)
            j = j + 1
          else if (key(order(i)) <= key(order(j))) then
            work(k) = order(i)
            i = i + 1
          else
            work(k) = order(j)
            j = j + 1
          end if
        end do
      end do
      order = work
      width = 2*width
    end do
  end subroutine sort_by_key
end module surface_facets
