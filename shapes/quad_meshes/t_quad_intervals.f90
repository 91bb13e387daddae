module t_quad_intervals
  !! Knot intervals of a quadrilateral mesh with T-junctions: on opposite sides of every face they
  !! have the same sum.
  !!
  !! Edges that are whole opposite sides of a face have the same interval; so intervals belong to
  !! strips of edges. A face with T-junctions demands that sums of strips are equal. Strips have the
  !! interval 1 unless it is given, or unless they are pieces of a side whose opposite side is one
  !! edge: these divide its interval evenly. Where such numbers do not meet all demands, the nearest
  !! ones (by the sum of the squares of relative changes) that do are taken.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use t_quad_mesh, only: t_quad_mesh_type
  implicit none (type, external)
  private
  public :: given_interval, find_intervals

  type :: given_interval
    integer :: h = 0                     !! half-edge
    real(wp) :: length = 0               !! its knot interval
  end type given_interval

  !> a demand: the sum over the strips of one side less that of the opposite side is zero
  type :: demand_type
    integer :: face = 0
    integer :: n(2) = 0                  !! edges of the two sides
    integer, allocatable :: strip(:)     !! strips of the first side, then of the second
  end type demand_type

  real(wp), parameter :: same = 1e-10_wp

contains

  subroutine find_intervals(mesh, given, message)
    type(t_quad_mesh_type), intent(inout) :: mesh        !! corners are known
    type(given_interval), intent(in) :: given(:)
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong

    type(demand_type), allocatable :: demands(:)
    integer, allocatable :: strip(:)
    logical, allocatable :: is_fixed(:)
    real(wp), allocatable :: length(:)
    integer :: h, k, n

    message = ''
    call mesh%place_sides()       ! numbers of the sides
    call find_strips(mesh, strip, n)
    allocate (length(n), source=1.0_wp)
    allocate (is_fixed(n), source=.false.)
    do k = 1, size(given)
      associate (a => strip(given(k)%h))
        if (is_fixed(a) .and. abs(length(a) - given(k)%length) > same*length(a)) then
          h = given(k)%h
          message = 'the edge of vertices ' // whole_number(mesh%vertex(h)) // ' and ' // &
            whole_number(mesh%vertex(mesh%next(h))) // ' (face ' // whole_number(mesh%face(h)) &
            // ') has two different knot intervals: undivided opposite edges of a face have the ' &
            // 'same one'
          return
        end if
        is_fixed(a) = .true.
        length(a) = given(k)%length
      end associate
    end do
    call list_demands(mesh, strip, demands)
    call divide_evenly(demands, is_fixed, length)
    call correct(demands, is_fixed, length)
    call judge(mesh, strip, demands, length, message)
    if (len(message) > 0) return
    mesh%interval = length(strip)
    call mesh%place_sides()
  end subroutine find_intervals

  subroutine find_strips(mesh, strip, n)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, allocatable, intent(out) :: strip(:)        !! of each half-edge
    integer, intent(out) :: n                            !! strips

    integer, allocatable :: root(:)
    integer :: f, h, k, side(0:3)

    allocate (root(mesh%nh))
    do h = 1, mesh%nh
      root(h) = h
    end do
    do h = 1, mesh%nh
      if (mesh%twin(h) > 0) call join(h, mesh%twin(h))
    end do
    do f = 1, mesh%nf
      side = 0
      do h = mesh%first(f), mesh%first(f+1) - 1
        k = mesh%side(h)
        side(k) = merge(h, -1, side(k) == 0)
      end do
      do k = 0, 1
        if (side(k) > 0 .and. side(k+2) > 0) call join(side(k), side(k+2))
      end do
    end do
    allocate (strip(mesh%nh), source=0)
    n = 0
    do h = 1, mesh%nh
      k = root_of(h)
      if (strip(k) == 0) then
        n = n + 1
        strip(k) = n
      end if
      strip(h) = strip(k)
    end do

  contains

    pure integer function root_of(h)
      integer, intent(in) :: h

      root_of = h
      do while (root(root_of) /= root_of)
        root_of = root(root_of)
      end do
    end function root_of

    subroutine join(a, b)
      integer, intent(in) :: a, b

      integer :: first, second

      ! the smaller one is the root, so that strips are numbered in the order of the half-edges
      first = min(root_of(a), root_of(b))
      second = max(root_of(a), root_of(b))
      root(second) = first
    end subroutine join
  end subroutine find_strips

  subroutine list_demands(mesh, strip, demands)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: strip(:)
    type(demand_type), allocatable, intent(out) :: demands(:)

    integer :: f, k, m, n(0:3)

    m = 0
    do f = 1, mesh%nf
      call count_sides()
      if (n(0) + n(2) > 2) m = m + 1
      if (n(1) + n(3) > 2) m = m + 1
    end do
    allocate (demands(m))
    m = 0
    do f = 1, mesh%nf
      call count_sides()
      do k = 0, 1
        if (n(k) + n(k+2) == 2) cycle
        m = m + 1
        demands(m)%face = f
        demands(m)%n = [n(k), n(k+2)]
        demands(m)%strip = [strips_of(k), strips_of(k+2)]
      end do
    end do

  contains

    subroutine count_sides()
      integer :: i

      do i = 0, 3
        n(i) = count(mesh%side(mesh%first(f):mesh%first(f+1)-1) == i)
      end do
    end subroutine count_sides

    pure function strips_of(side) result(list)
      integer, intent(in) :: side
      integer :: list(n(side))

      list = pack(strip(mesh%first(f):mesh%first(f+1)-1), &
        mesh%side(mesh%first(f):mesh%first(f+1)-1) == side)
    end function strips_of
  end subroutine list_demands

  subroutine divide_evenly(demands, is_fixed, length)
    !! Pieces of a side opposite to one edge. What is divided may be a piece itself.
    type(demand_type), intent(in) :: demands(:)
    logical, intent(in) :: is_fixed(:)
    real(wp), intent(inout) :: length(:)

    real(wp) :: rest, whole
    integer :: k, m, pass
    logical :: changed

    do pass = 1, size(demands)
      changed = .false.
      do k = 1, size(demands)
        do m = 1, 2
          associate (d => demands(k))
            if (d%n(m) > 1 .or. d%n(3-m) < 2) cycle
            if (m == 1) then
              call share_out(d%strip(1), d%strip(2:))
            else
              call share_out(d%strip(d%n(1)+1), d%strip(1:d%n(1)))
            end if
          end associate
        end do
      end do
      if (.not. changed) exit
    end do

  contains

    subroutine share_out(a, pieces)
      integer, intent(in) :: a, pieces(:)

      integer :: i, free

      free = count(.not. is_fixed(pieces))
      if (free == 0) return
      whole = length(a)
      rest = whole - sum(length(pieces), mask=is_fixed(pieces))
      if (rest <= 0) return
      do i = 1, size(pieces)
        if (is_fixed(pieces(i)) .or. length(pieces(i)) <= (1 + same)*rest/free) cycle
        length(pieces(i)) = rest/free
        changed = .true.
      end do
    end subroutine share_out
  end subroutine divide_evenly

  pure function residual(d, length) result(r)
    type(demand_type), intent(in) :: d
    real(wp), intent(in) :: length(:)
    real(wp) :: r

    r = sum(length(d%strip(1:d%n(1)))) - sum(length(d%strip(d%n(1)+1:)))
  end function residual

  pure subroutine correct(demands, is_fixed, length)
    !! length := length + W E^T y with E W E^T y = -E length, W = length^2, 0 for given ones:
    !! conjugate gradients, which also solve where demands depend on one another.
    type(demand_type), intent(in) :: demands(:)
    logical, intent(in) :: is_fixed(:)
    real(wp), intent(inout) :: length(:)

    real(wp) :: p(size(demands)), q(size(demands)), r(size(demands)), y(size(demands))
    real(wp) :: change(size(length)), weight(size(length)), old, new, step
    integer :: k, round

    do k = 1, size(demands)
      r(k) = -residual(demands(k), length)
    end do
    if (size(demands) == 0) return
    if (maxval(abs(r)) <= same*maxval(length)) return
    weight = merge(0.0_wp, length**2, is_fixed)
    y = 0
    p = r
    old = dot_product(r, r)
    do round = 1, 4*size(demands) + 20
      call spread_out(p, change)
      do k = 1, size(demands)
        q(k) = residual(demands(k), change)
      end do
      step = dot_product(p, q)
      if (step <= 0) exit
      step = old/step
      y = y + step*p
      r = r - step*q
      new = dot_product(r, r)
      if (new <= (1e-15_wp*maxval(length))**2) exit
      p = r + (new/old)*p
      old = new
    end do
    call spread_out(y, change)
    length = length + change

  contains

    pure subroutine spread_out(v, x)
      real(wp), intent(in) :: v(:)             !! of each demand
      real(wp), intent(out) :: x(:)            !! W E^T v

      integer :: i, j

      x = 0
      do i = 1, size(demands)
        do j = 1, size(demands(i)%strip)
          associate (a => demands(i)%strip(j))
            x(a) = x(a) + merge(1, -1, j <= demands(i)%n(1))*v(i)
          end associate
        end do
      end do
      x = weight*x
    end subroutine spread_out
  end subroutine correct

  subroutine judge(mesh, strip, demands, length, message)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: strip(:)
    type(demand_type), intent(in) :: demands(:)
    real(wp), intent(in) :: length(:)
    character(:), allocatable, intent(inout) :: message

    character(12) :: sums(2)
    integer :: h, k, worst

    worst = 0
    do k = 1, size(demands)
      if (abs(residual(demands(k), length)) <= same*maxval(length)) cycle
      if (worst > 0) then
        if (abs(residual(demands(k), length)) <= abs(residual(demands(worst), length))) cycle
      end if
      worst = k
    end do
    if (worst > 0) then
      associate (d => demands(worst))
        write (sums(1), '(g0.6)') sum(length(d%strip(1:d%n(1))))
        write (sums(2), '(g0.6)') sum(length(d%strip(d%n(1)+1:)))
        message = 'the knot intervals of face ' // whole_number(d%face) // &
          ' do not fit: on two opposite sides they sum up to ' // trim(sums(1)) // ' and ' // &
          trim(sums(2))
      end associate
      return
    end if
    h = 0
    do k = 1, mesh%nh
      if (length(strip(k)) > 1e-6_wp*maxval(length)) cycle
      h = k
      exit
    end do
    if (h > 0) message = 'no positive knot intervals fit the faces: the edge of vertices ' // &
      whole_number(mesh%vertex(h)) // ' and ' // whole_number(mesh%vertex(mesh%next(h))) // &
      ' (face ' // whole_number(mesh%face(h)) // ') is left none. Look for a T-junction too ' &
      // 'many, or give intervals with INTErval'
  end subroutine judge
end module t_quad_intervals
