module search_benchmarks
  !! Contact search over growing master surfaces: a wavy uniform quadratic B-spline curve or surface of n facets, and
  !! slave points a little above it.
  use kinds, only: wp, i8
  use extraction_set, only: extraction_set_type
  use tensor_product, only: tensor_operator
  use facets, only: facet_surface
  use contact_search, only: master_search, start_search, move_master, pair_point
  use stopwatch, only: stopwatch_type
  use report, only: put, text
  implicit none (type, external)
  private
  public :: measure_search

  real(wp), parameter :: spline(3, 3) = reshape([1, 1, 0, 0, 2, 0, 0, 1, 1], [3, 3])/2.0_wp
  integer, parameter :: points = 1000

contains

  subroutine measure_search(ndm, n)
    !! Per Gauss point: first search after the master moved, its boxes included; later ones; local search.
    integer, intent(in) :: ndm, n           !! dimension; facets in each direction
    type(facet_surface) :: surface
    type(master_search) :: search
    type(stopwatch_type) :: watch
    real(wp), allocatable :: x(:, :), w(:), xs(:, :), xi(:, :)
    integer, allocatable :: facet(:)
    logical :: held(ndm - 1)
    logical :: forced
    character(:), allocatable :: row
    integer :: i, nf

    if (ndm == 2) then
      call wavy_curve(n, surface, x)
    else
      call wavy_surface(n, surface, x)
    end if
    nf = surface%set%ne
    allocate (w(size(x, 2)), source=1.0_wp)
    allocate (xs(ndm, points), xi(ndm - 1, points), facet(points))
    xi = 0.5_wp
    do i = 1, points
      xs(1, i) = 2 + (n - 4)*modulo(i*0.6180339887_wp, 1.0_wp)
      if (ndm == 3) xs(2, i) = 2 + (n - 4)*modulo(i*0.7548776662_wp, 1.0_wp)
      xs(ndm, i) = height(xs(1, i)) + 0.02_wp
    end do
    call start_search(search, ndm, surface, 2.0_wp)
    row = text(ndm)//'D, '//text(nf)//' facets'

    call watch%begin()
    do while (watch%goes_on())
      call move_master(search, x)
      search%tree%nnodes = 0
      facet(1) = 0
      held = .false.
      call pair_point(search, surface, w, xs(:, 1), .false., facet(1), xi(:, 1), held, forced)
    end do
    call put('search', row, 'tree, a facet [us]', 1.0e6_wp*watch%best/nf)
    call watch%begin()
    do while (watch%goes_on())
      facet = 0
      do i = 1, points
        call pair_point(search, surface, w, xs(:, i), .false., facet(i), xi(:, i), held, forced)
      end do
    end do
    if (any(facet == 0)) error stop 'search_benchmarks: a point without a pair'
    call put('search', row, 'global, a point [us]', 1.0e6_wp*watch%best/points)
    xs(1, :) = xs(1, :) + 0.001_wp
    call watch%begin()
    do while (watch%goes_on())
      xs(1, :) = xs(1, :) + merge(0.05_wp, -0.05_wp, mod(watch%calls, 2_i8) == 0)
      call move_master(search, x)
      do i = 1, points
        call pair_point(search, surface, w, xs(:, i), .false., facet(i), xi(:, i), held, forced)
      end do
    end do
    if (any(facet == 0)) error stop 'search_benchmarks: a point lost its pair'
    call put('search', row, 'local, a point [us]', 1.0e6_wp*watch%best/points)
  end subroutine measure_search

  pure elemental real(wp) function height(x)
    real(wp), intent(in) :: x
    height = 0.1_wp*sin(x)
  end function height

  subroutine wavy_curve(n, surface, x)
    integer, intent(in) :: n
    type(facet_surface), intent(out) :: surface
    real(wp), allocatable, intent(out) :: x(:, :)
    integer :: a, f, id

    allocate (x(2, n + 2), surface%neighbour(2, n))
    x(1, :) = [(a - 1.5_wp, a=1, n + 2)]
    x(2, :) = height(x(1, :))
    call surface%set%init()
    do f = 1, n
      call surface%set%add_element(1, [2], [f, f + 1, f + 2], spline, id)
      surface%neighbour(:, f) = [f - 1, merge(f + 1, 0, f < n)]
    end do
  end subroutine wavy_curve

  subroutine wavy_surface(n, surface, x)
    integer, intent(in) :: n
    type(facet_surface), intent(out) :: surface
    real(wp), allocatable, intent(out) :: x(:, :)
    real(wp) :: ce(9, 9)
    integer :: a, b, f, id, k, l, m

    m = n + 2
    allocate (x(3, m*m), surface%neighbour(4, n*n))
    do b = 1, m
      do a = 1, m
        x(:, a + m*(b - 1)) = [a - 1.5_wp, b - 1.5_wp, height(a - 1.5_wp)]
      end do
    end do
    call tensor_operator(spline, spline, ce)
    call surface%set%init()
    do b = 1, n
      do a = 1, n
        f = a + n*(b - 1)
        call surface%set%add_element(2, [2, 2], [((a + k + m*(b + l - 1), k=0, 2), l=0, 2)], ce, id)
        surface%neighbour(:, f) = [merge(f - 1, 0, a > 1), merge(f + 1, 0, a < n), merge(f - n, 0, b > 1), &
          merge(f + n, 0, b < n)]
      end do
    end do
  end subroutine wavy_surface
end module search_benchmarks
