module surface_orientation
  !! Whether the shells of a surface agree on which side of it is up, also where they only touch.
  !!
  !! Seen from the tip of its normal n, the edge of a shell runs around it counter-clockwise along t = n x nu, with nu the
  !! outward conormal. Of two shells with an edge in common, at whatever angle, one sees it run forward and the other
  !! backward if they agree: t_1 . t_2 < 0. Where more than two meet, they cannot all agree, and nothing is asked.
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type
  use surface_facets, only: facet_surface, build_surface_facets
  use edge_rows, only: edge_point, edge_point_at
  implicit none (type, external)
  private
  public :: find_turned_pair

  integer, parameter :: samples = 3
  real(wp), parameter :: eta(samples) = [0.53_wp, 0.17_wp, 0.86_wp]   !! not where elements of the other mesh begin
  real(wp), parameter :: same_place = 1e-6_wp      !! relative to the model's size

  type :: open_edge
    integer :: element, side, part
    real(wp) :: low(3), high(3)                    !! a box around it [length]
  end type open_edge

contains

  subroutine find_turned_pair(model, elements, part, pair, x)
    !! The first two elements of different parts that touch and do not agree; 0: there are none.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: elements(:)             !! shells of one surface
    integer, intent(in) :: part(:)                 !! of each: within one nothing is compared
    integer, intent(out) :: pair(2)
    real(wp), intent(out) :: x(3)                  !! where they touch [length]
    type(open_edge), allocatable :: edges(:)
    type(edge_point) :: here, there
    real(wp) :: tolerance
    integer :: i, j, k, met, other, status
    logical :: turned

    pair = 0
    x = 0
    if (size(elements) == 0) return
    if (all(part == part(1))) return
    tolerance = same_place*maxval(maxval(model%x, 2) - minval(model%x, 2))
    call collect_edges(model, elements, part, edges)
    do i = 1, size(edges)
      do k = 1, samples
        call edge_point_at(model, edges(i)%element, edges(i)%side, eta(k), here, status)
        if (status /= ok) cycle
        met = 0
        other = 0
        turned = .false.
        do j = 1, size(edges)
          if (j == i) cycle
          if (any(here%x < edges(j)%low - tolerance) .or. any(here%x > edges(j)%high + tolerance)) cycle
          call nearest_point(model, edges(j), here%x, there, status)
          if (status /= ok) cycle
          if (norm2(there%x - here%x) > tolerance) cycle
          met = met + 1
          if (edges(j)%part == edges(i)%part) cycle
          other = j
          turned = dot_product(direction(here), direction(there)) > 0
        end do
        if (met /= 1 .or. .not. turned) cycle
        pair = [edges(i)%element, edges(other)%element]
        x = here%x
        return
      end do
    end do
  end subroutine find_turned_pair

  subroutine collect_edges(model, elements, part, edges)
    !! Sides across which no other element has the same functions.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: elements(:), part(:)
    type(open_edge), allocatable, intent(out) :: edges(:)
    type(facet_surface) :: surface
    type(edge_point) :: point
    real(wp) :: low(3), high(3), margin
    integer :: f, k, n, s, status
    integer, parameter :: pieces = 4

    call build_surface_facets(model%mesh, elements, 0*elements, surface)
    allocate (edges(count(surface%neighbour(1:4, :) == 0)))
    n = 0
    do f = 1, size(elements)
      do s = 1, 4
        if (surface%neighbour(s, f) /= 0) cycle
        low = huge(low)
        high = -huge(high)
        do k = 0, pieces
          call edge_point_at(model, elements(f), s, real(k, wp)/pieces, point, status)
          if (status /= ok) exit
          low = min(low, point%x)
          high = max(high, point%x)
        end do
        if (status /= ok) cycle                    ! a collapsed side, a pole
        margin = norm2(high - low)/pieces          ! the curve between the points
        n = n + 1
        edges(n) = open_edge(elements(f), s, part(f), low - margin, high + margin)
      end do
    end do
    edges = edges(1:n)
  end subroutine collect_edges

  subroutine nearest_point(model, edge, x, point, status)
    !! Of a side, to a place: Gauss-Newton from the best of some points.
    type(model_type), intent(in), target :: model
    type(open_edge), intent(in) :: edge
    real(wp), intent(in) :: x(3)
    type(edge_point), intent(out) :: point
    integer, intent(out) :: status
    real(wp) :: at, best, next
    integer :: k
    integer, parameter :: pieces = 8, most_steps = 30

    best = huge(best)
    at = 0
    do k = 0, pieces
      call edge_point_at(model, edge%element, edge%side, real(k, wp)/pieces, point, status)
      if (status /= ok) return
      if (norm2(point%x - x) >= best) cycle
      best = norm2(point%x - x)
      at = real(k, wp)/pieces
    end do
    do k = 1, most_steps
      call edge_point_at(model, edge%element, edge%side, at, point, status)
      if (status /= ok) return
      next = at + dot_product(x - point%x, point%tau)/dot_product(point%tau, point%tau)
      next = min(max(next, 0.0_wp), 1.0_wp)
      if (abs(next - at) < 1e-12_wp) return
      at = next
    end do
  end subroutine nearest_point

  pure function direction(point) result(t)
    !! n x nu
    type(edge_point), intent(in) :: point
    real(wp) :: t(3)

    t(1) = point%nrm(2)*point%nu(3) - point%nrm(3)*point%nu(2)
    t(2) = point%nrm(3)*point%nu(1) - point%nrm(1)*point%nu(3)
    t(3) = point%nrm(1)*point%nu(2) - point%nrm(2)*point%nu(1)
  end function direction
end module surface_orientation
