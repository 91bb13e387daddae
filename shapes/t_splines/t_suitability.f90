module t_suitability
  !! Analysis-suitability of T-meshes of odd degrees: no extension of a T-junction in direction 1
  !! meets one in direction 2, both taken with their ends. Where a line of direction d ends at a
  !! T-junction, its extension runs on over (p+1)/2 bays (to the next lines along the ray) and back
  !! over (p-1)/2 bays. Suitable meshes have linearly independent functions that sum to one, dual
  !! functionals, and the spline space that their lines promise. (Li, Zheng, Sederberg, Hughes,
  !! Scott, CAGD 29, 2012; Beirao da Veiga, Buffa, Sangalli, Vazquez, M3AS 23, 2013.)
  use kinds, only: wp, i8
  use status_codes, only: ok, not_suitable, bad_t_mesh
  use t_mesh, only: t_mesh_type, cell_list, append
  implicit none (type, external)
  private
  public :: t_junction_type, crossing_type, find_t_junctions, check_suitability, make_suitable

  type :: t_junction_type
    integer(i8) :: at(2) = 0      !! indices of the T-junction
    integer :: d = 0              !! direction of the line that ends
    integer :: way = 0            !! where it is missing: 1 upward, -1 downward
    integer(i8) :: from = 0       !! ends of the extension along d
    integer(i8) :: to = 0
  end type t_junction_type

  !> two T-junctions whose extensions cross, in parameters
  type :: crossing_type
    real(wp) :: first(2) = 0      !! T-junction of a line along direction 1
    real(wp) :: second(2) = 0     !! T-junction of a line along direction 2
    real(wp) :: at(2) = 0         !! where they cross
  end type crossing_type

  type :: crossing_pair
    integer :: first = 0, second = 0      !! T-junctions along direction 1 and 2
  end type crossing_pair

contains

  pure subroutine find_t_junctions(mesh, junctions)
    type(t_mesh_type), intent(in) :: mesh
    type(t_junction_type), allocatable, intent(out) :: junctions(:)   !! with their extensions

    integer(i8), allocatable :: points(:,:)
    type(t_junction_type), allocatable :: found(:)
    integer :: cell(-1:1,-1:1), d, i, n, way

    call mesh%vertices(points)
    allocate (found(size(points, 2)))
    n = 0
    do i = 1, size(points, 2)
      if (any(points(:,i) <= 0 .or. points(:,i) >= mesh%last)) cycle
      cell(-1,-1) = mesh%locate(points(:,i), [-1, -1])
      cell(1,-1) = mesh%locate(points(:,i), [1, -1])
      cell(-1,1) = mesh%locate(points(:,i), [-1, 1])
      cell(1,1) = mesh%locate(points(:,i), [1, 1])
      d = 0
      do way = -1, 1, 2
        if (cell(way,-1) == cell(way,1)) d = 1
        if (cell(-1,way) == cell(1,way)) d = 2
        if (d > 0) exit
      end do
      if (d == 0) cycle
      n = n + 1
      found(n)%at = points(:,i)
      found(n)%d = d
      found(n)%way = way
      call extend(mesh, found(n))
    end do
    allocate (junctions(n))
    junctions(:) = found(1:n)
  end subroutine find_t_junctions

  pure subroutine extend(mesh, junction)
    type(t_mesh_type), intent(in) :: mesh
    type(t_junction_type), intent(inout) :: junction   !! its extension is filled in

    integer(i8) :: ahead, back
    integer :: d

    d = junction%d
    ahead = end_of_ray((mesh%degree(d) + 1) / 2, junction%way)
    back = end_of_ray((mesh%degree(d) - 1) / 2, -junction%way)
    junction%from = min(ahead, back)
    junction%to = max(ahead, back)

  contains

    pure integer(i8) function end_of_ray(bays, way)
      integer, intent(in) :: bays, way

      integer(i8) :: place(2)
      integer :: k

      place = junction%at
      do k = 1, bays
        place(d) = mesh%next_line(place, d, way)
      end do
      end_of_ray = min(max(place(d), 0_i8), mesh%last(d))
    end function end_of_ray
  end subroutine extend

  pure subroutine check_suitability(mesh, status, crossing)
    type(t_mesh_type), intent(in) :: mesh
    integer, intent(out) :: status                   !! ok or not_suitable
    type(crossing_type), intent(out) :: crossing     !! one of the crossings, if there is any

    type(t_junction_type), allocatable :: junctions(:)
    type(crossing_pair), allocatable :: pairs(:)

    call find_t_junctions(mesh, junctions)
    call find_crossings(mesh, junctions, 1, pairs)
    status = ok
    if (size(pairs) == 0) return
    status = not_suitable
    associate (a => junctions(pairs(1)%first), b => junctions(pairs(1)%second))
      crossing%first = mesh%parameter_of([1, 2], a%at)
      crossing%second = mesh%parameter_of([1, 2], b%at)
      crossing%at = mesh%parameter_of([1, 2], [b%at(1), a%at(2)])
    end associate
  end subroutine check_suitability

  pure subroutine find_crossings(mesh, junctions, most, pairs)
    !! Pairs of crossing extensions. An extension is compared with those that touch the same leaves.
    type(t_mesh_type), intent(in) :: mesh
    type(t_junction_type), intent(in) :: junctions(:)
    integer, intent(in) :: most                            !! how many to look for
    type(crossing_pair), allocatable, intent(out) :: pairs(:)

    type(crossing_pair), allocatable :: larger(:)
    type(cell_list) :: touched, next, item
    integer, allocatable :: head(:), seen(:)
    integer :: i, j, k, m, n

    n = 0
    allocate (pairs(16))
    allocate (head(mesh%n), seen(size(junctions)), source=0)
    do j = 1, size(junctions)
      if (junctions(j)%d /= 1) cycle
      call touched_leaves(mesh, junctions(j), touched)
      do k = 1, touched%n
        call append(item, j)
        call append(next, head(touched%id(k)))
        head(touched%id(k)) = item%n
      end do
    end do
    search: do j = 1, size(junctions)
      if (junctions(j)%d /= 2) cycle
      call touched_leaves(mesh, junctions(j), touched)
      do k = 1, touched%n
        m = head(touched%id(k))
        do while (m > 0)
          i = item%id(m)
          m = next%id(m)
          if (seen(i) == j) cycle
          seen(i) = j
          if (junctions(i)%at(2) < junctions(j)%from) cycle
          if (junctions(i)%at(2) > junctions(j)%to) cycle
          if (junctions(j)%at(1) < junctions(i)%from) cycle
          if (junctions(j)%at(1) > junctions(i)%to) cycle
          if (n == size(pairs)) then
            allocate (larger(2*n))
            larger(1:n) = pairs
            call move_alloc(larger, pairs)
          end if
          n = n + 1
          pairs(n) = crossing_pair(i, j)
          if (n == most) exit search
        end do
      end do
    end do search
    allocate (larger(n))
    larger(:) = pairs(1:n)
    call move_alloc(larger, pairs)
  end subroutine find_crossings

  pure subroutine touched_leaves(mesh, junction, found)
    type(t_mesh_type), intent(in) :: mesh
    type(t_junction_type), intent(in) :: junction
    type(cell_list), intent(inout) :: found        !! leaves that its extension touches

    integer(i8) :: lo(2), hi(2)

    lo = junction%at - 1
    hi = junction%at + 1
    lo(junction%d) = junction%from - 1
    hi(junction%d) = junction%to + 1
    call mesh%cells_over(lo, hi, found)
  end subroutine touched_leaves

  pure subroutine make_suitable(mesh, added, status)
    !! Lengthens lines that end in T-junctions until no extensions cross: of two that cross, the
    !! line that crosses more often goes on by one leaf, among equals the one with the smaller leaf.
    !! Ends at the latest when all lines run through.
    type(t_mesh_type), intent(inout) :: mesh      !! no longer regular if cells were split
    integer, intent(out) :: added                 !! number of leaves that were split
    integer, intent(out) :: status                !! ok, or bad_t_mesh (no room for a line)

    type(t_junction_type), allocatable :: junctions(:)
    type(crossing_pair), allocatable :: pairs(:)
    integer, allocatable :: crossings(:)
    integer(i8) :: size_i, size_j
    integer :: before, cell, i, j, k
    logical, allocatable :: longer(:)
    logical :: done

    added = 0
    status = ok
    do
      call find_t_junctions(mesh, junctions)
      call find_crossings(mesh, junctions, huge(1), pairs)
      if (size(pairs) == 0) return
      before = added
      if (allocated(crossings)) deallocate (crossings, longer)
      allocate (crossings(size(junctions)), source=0)
      allocate (longer(size(junctions)), source=.false.)
      do k = 1, size(pairs)
        i = pairs(k)%first
        j = pairs(k)%second
        crossings([i, j]) = crossings([i, j]) + 1
      end do
      do k = 1, size(pairs)
        i = pairs(k)%first
        j = pairs(k)%second
        size_i = leaf_ahead(junctions(i))
        size_j = leaf_ahead(junctions(j))
        if (crossings(i) > crossings(j) .or. &
          (crossings(i) == crossings(j) .and. size_i <= size_j)) then
          longer(i) = .true.
        else
          longer(j) = .true.
        end if
      end do
      do j = 1, size(junctions)
        if (.not. longer(j)) cycle
        cell = face_cell(mesh, junctions(j))
        ! two lines may have met in this leaf: the second one finds a crossing at its end
        call mesh%split_cell(cell, 3 - junctions(j)%d, junctions(j)%at(3-junctions(j)%d), done)
        if (done) added = added + 1
      end do
      if (added > before) mesh%regular = .false.
      status = bad_t_mesh
      if (added == before) return
      status = ok
    end do

  contains

    pure integer(i8) function leaf_ahead(junction)
      type(t_junction_type), intent(in) :: junction

      integer :: c

      c = face_cell(mesh, junction)
      leaf_ahead = mesh%hi(junction%d,c) - mesh%lo(junction%d,c)
    end function leaf_ahead
  end subroutine make_suitable

  pure integer function face_cell(mesh, junction) result(cell)
    !! Leaf into which the missing line would run.
    type(t_mesh_type), intent(in) :: mesh
    type(t_junction_type), intent(in) :: junction

    integer :: side(2)

    side = 1
    side(junction%d) = junction%way
    cell = mesh%locate(junction%at, side)
  end function face_cell
end module t_suitability
