module knot_vectors
  !! Knot vectors of B-splines: non-uniform, repeated knots up to multiplicity p+1, open or not.
  !!
  !! Everything rests on the polar form (blossom) of a polynomial piece. On the span [u_s,
  !! u_(s+1)] the spline with control values d has the polar form F(t_1, ..., t_p) = sum_i c_i(t)
  !! d_i over i = s-p..s, with c from the triangle of de Boor and Cox, one argument t_k a level
  !! (`polar_row`). Then
  !!
  !!   F(x, ..., x)                     is the value at x,
  !!   F(a, .., a, b, .., b)            are the Bezier coefficients on [a,b]: extraction,
  !!   1/(p+1) sum_k F(.. without t_k)  is the polar form one degree higher: elevation,
  !!
  !! and knot insertion is Boehm's. Extraction by polar form equals repeated knot insertion
  !! (Borden et al. 2011, Scott et al. 2011), each element for itself: all steps are convex
  !! combinations. (L. Ramshaw, Blossoms are polar forms, CAGD 6, 1989.)
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: wp
  use status_codes, only: ok, bad_knots
  implicit none (type, external)
  private
  public :: knot_vector, open_knot_vector, knot_status, basis_values, basis_function
  public :: extraction_operators, insertion_operator, elevation_operator
  public :: polar_row, relative_knots

  type :: knot_vector
    integer :: p = 0                     !! degree
    real(wp), allocatable :: u(:)        !! knots, not decreasing
  contains
    procedure :: functions               !! number of basis functions
    procedure :: elements                !! number of non-empty spans of the domain
    procedure :: breaks                  !! ends of the non-empty spans (elements + 1)
    procedure :: is_open                 !! whether both ends are repeated p+1 times
    procedure :: span                    !! index of the non-empty span that holds a point
  end type knot_vector

contains

  pure function open_knot_vector(p, breaks) result(kv)
    !! Knots with p+1 equal ones at the ends and single ones between: functions are C^(p-1).
    integer, intent(in) :: p            !! degree
    real(wp), intent(in) :: breaks(:)   !! ends of the spans, increasing
    type(knot_vector) :: kv

    integer :: m

    m = size(breaks)
    kv%p = p
    allocate (kv%u, source=[spread(breaks(1), 1, p), breaks, spread(breaks(m), 1, p)])
  end function open_knot_vector

  pure integer function functions(self)
    class(knot_vector), intent(in) :: self

    functions = size(self%u) - self%p - 1
  end function functions

  pure integer function elements(self)
    class(knot_vector), intent(in) :: self

    integer :: n, p

    p = self%p
    n = self%functions()
    elements = count(self%u(p+2:n+1) > self%u(p+1:n))
  end function elements

  pure function breaks(self) result(x)
    class(knot_vector), intent(in) :: self
    real(wp), allocatable :: x(:)   !! distinct knots of the domain (elements + 1)

    integer :: n, p

    p = self%p
    n = self%functions()
    x = [self%u(p+1), pack(self%u(p+2:n+1), self%u(p+2:n+1) > self%u(p+1:n))]
  end function breaks

  pure logical function is_open(self)
    class(knot_vector), intent(in) :: self

    integer :: n

    n = self%functions()
    is_open = self%u(1) >= self%u(self%p+1) .and. self%u(size(self%u)) <= self%u(n+1)
  end function is_open

  pure integer function span(self, x)
    !! Index s with u_s <= x < u_(s+1), the last non-empty span at the end of the domain. Points
    !! beyond the domain belong to its first or last span.
    class(knot_vector), intent(in) :: self
    real(wp), intent(in) :: x   !! parametric point

    integer :: high, low, middle

    low = self%p + 1
    high = self%functions() + 1
    if (x >= self%u(high)) then
      span = high - 1
      do while (self%u(span) >= self%u(high))
        span = span - 1
      end do
      return
    end if
    do while (high - low > 1)
      middle = (low + high) / 2
      if (x < self%u(middle)) then
        high = middle
      else
        low = middle
      end if
    end do
    span = low
  end function span

  pure integer function knot_status(kv) result(status)
    !! bad_knots when knots decrease, are too few, not finite, or repeated more than p+1 times, or
    !! when the first or last function vanishes on the domain; otherwise ok.
    type(knot_vector), intent(in) :: kv

    integer :: i, m, n, p

    status = bad_knots
    p = kv%p
    if (p < 0 .or. .not. allocated(kv%u)) return
    m = size(kv%u)
    n = m - p - 1
    if (n < p + 1) return
    if (.not. all(ieee_is_finite(kv%u))) return
    do i = 2, m
      if (kv%u(i) < kv%u(i-1)) return
    end do
    do i = 1, n
      if (kv%u(i) >= kv%u(i+p+1)) return
    end do
    if (kv%u(p+1) >= kv%u(p+2)) return
    if (kv%u(n) >= kv%u(n+1)) return
    status = ok
  end function knot_status

  pure subroutine polar_row(p, local, t, c)
    !! Coefficients of the p+1 control values in the polar form of the piece on a span.
    integer, intent(in) :: p                 !! degree
    real(wp), intent(in) :: local(1-p:p)     !! p knots up to the span's start, p from its end
    real(wp), intent(in) :: t(p)             !! arguments, their order has no influence
    real(wp), intent(out) :: c(0:p)          !! coefficients, first function first

    real(wp) :: from_left, part
    integer :: i, k

    c(0) = 1.0_wp
    do k = 1, p
      from_left = 0.0_wp
      do i = 0, k - 1
        part = c(i) / (local(i+1) - local(i+1-k))
        c(i) = from_left + (local(i+1) - t(k)) * part
        from_left = (t(k) - local(i+1-k)) * part
      end do
      c(k) = from_left
    end do
  end subroutine polar_row

  pure subroutine basis_values(kv, x, first, values)
    !! The p+1 functions that can differ from zero at a point; the others vanish there.
    type(knot_vector), intent(in) :: kv
    real(wp), intent(in) :: x                  !! parametric point of the domain
    integer, intent(out) :: first              !! number of the first of them
    real(wp), intent(out) :: values(kv%p+1)    !! their values

    integer :: s

    s = kv%span(x)
    first = s - kv%p
    call polar_row(kv%p, kv%u(s-kv%p+1:s+kv%p), spread(x, 1, kv%p), values)
  end subroutine basis_values

  pure recursive function basis_function(kv, i, x, order) result(value)
    !! One function or its derivative by the recursion that defines it (de Boor, Cox), 0/0 = 0.
    !! Slow and independent of the above: the yardstick of the tests.
    type(knot_vector), intent(in) :: kv
    integer, intent(in) :: i        !! number of the function
    real(wp), intent(in) :: x       !! parametric point of the domain
    integer, intent(in) :: order    !! order of the derivative, 0 for the value
    real(wp) :: value

    value = degree_down(kv%p, i, order)

  contains

    pure recursive function degree_down(p, a, d) result(r)
      integer, intent(in) :: p   !! degree
      integer, intent(in) :: a   !! function of that degree
      integer, intent(in) :: d   !! order of the derivative
      real(wp) :: r

      real(wp) :: left, right

      r = 0.0_wp
      if (p == 0) then
        if (d == 0 .and. a == kv%span(x)) r = 1.0_wp
        return
      end if
      left = kv%u(a+p) - kv%u(a)
      right = kv%u(a+p+1) - kv%u(a+1)
      if (d > 0) then
        if (left > 0.0_wp) r = r + p / left * degree_down(p - 1, a, d - 1)
        if (right > 0.0_wp) r = r - p / right * degree_down(p - 1, a + 1, d - 1)
      else
        if (left > 0.0_wp) r = r + (x - kv%u(a)) / left * degree_down(p - 1, a, 0)
        if (right > 0.0_wp) r = r + (kv%u(a+p+1) - x) / right * degree_down(p - 1, a + 1, 0)
      end if
    end function degree_down
  end function basis_function

  pure function relative_knots(u, a, b, p) result(local)
    !! Knots relative to an element, [a,b] -> [0,1]. Where one lies at a multiple of 1/1024 but for
    !! the uncertainty that it carries in floating point, about (p+1) eps max|u| / (b-a), it is
    !! moved there, so that elements of a uniform mesh have bit by bit the same operator (and an
    !! extraction set stores it once).
    real(wp), intent(in) :: u(:)        !! knots
    real(wp), intent(in) :: a, b        !! ends of the element, a < b
    integer, intent(in) :: p            !! degree
    real(wp) :: local(size(u))

    real(wp), parameter :: grid = 2.0_wp**(-10)
    real(wp) :: uncertainty

    local = (u - a) / (b - a)
    if (size(u) == 0) return
    uncertainty = 4 * (p + 1) * epsilon(a) * maxval(abs(u)) / (b - a)
    where (abs(local - anint(local / grid) * grid) <= min(uncertainty, grid / 4)) &
      local = anint(local / grid) * grid
  end function relative_knots

  pure subroutine extraction_operators(kv, c, first)
    !! Bezier extraction operators of all elements: N_a = sum_k c(a,k,e) B_k on element e, where
    !! function a of the element is function first(e)+a-1 of the patch.
    type(knot_vector), intent(in) :: kv
    real(wp), allocatable, intent(out) :: c(:,:,:)   !! operators (p+1,p+1,elements)
    integer, allocatable, intent(out) :: first(:)    !! first function of each element (elements)

    real(wp) :: local(1-kv%p:kv%p), t(kv%p)
    integer :: e, k, p, s

    p = kv%p
    allocate (c(p+1,p+1,kv%elements()), first(kv%elements()))
    e = 0
    do s = p + 1, kv%functions()
      if (kv%u(s+1) <= kv%u(s)) cycle
      e = e + 1
      first(e) = s - p
      local = relative_knots(kv%u(s-p+1:s+p), kv%u(s), kv%u(s+1), p)
      do k = 0, p
        t(1:p-k) = 0.0_wp
        t(p-k+1:p) = 1.0_wp
        call polar_row(p, local, t, c(:,k+1,e))
      end do
    end do
  end subroutine extraction_operators

  pure subroutine insertion_operator(kv, new, refined, a, status)
    !! Boehm's knot insertion, d_refined = A d for homogeneous control values d.
    type(knot_vector), intent(in) :: kv
    real(wp), intent(in) :: new(:)                  !! knots to insert, inside the domain, any order
    type(knot_vector), intent(out) :: refined       !! with the new knots
    real(wp), allocatable, intent(out) :: a(:,:)    !! operator (new functions, old functions)
    integer, intent(out) :: status                  !! ok or bad_knots

    real(wp), allocatable :: u(:)
    real(wp) :: weight
    integer :: i, k, m, n, n_old, p

    p = kv%p
    n_old = kv%functions()
    refined = kv
    allocate (a(n_old+size(new),n_old), source=0.0_wp)
    do i = 1, n_old
      a(i,i) = 1.0_wp
    end do

    status = bad_knots
    if (.not. all(ieee_is_finite(new))) return
    do k = 1, size(new)
      n = refined%functions()
      if (new(k) <= refined%u(p+1) .or. new(k) >= refined%u(n+1)) return
      if (count(refined%u >= new(k) .and. refined%u <= new(k)) > p) return
      m = refined%span(new(k))
      a(m+1:n+1,:) = a(m:n,:)
      do i = m, m - p + 1, -1
        weight = (new(k) - refined%u(i)) / (refined%u(i+p) - refined%u(i))
        a(i,:) = weight * a(i,:) + (1.0_wp - weight) * a(i-1,:)
      end do
      u = [refined%u(1:m), new(k), refined%u(m+1:)]
      call move_alloc(u, refined%u)
    end do
    status = ok
  end subroutine insertion_operator

  pure subroutine elevation_operator(kv, elevated, a)
    !! One degree more, the same curve: d_elevated = A d for homogeneous control values d. Every
    !! knot gains one multiplicity, but those outside the domain that are no longer needed.
    type(knot_vector), intent(in) :: kv
    type(knot_vector), intent(out) :: elevated      !! of degree p+1
    real(wp), allocatable, intent(out) :: a(:,:)    !! operator (new functions, old functions)

    real(wp), allocatable :: twice(:)
    real(wp) :: c(kv%p+1), t(kv%p+1)
    integer :: i, j, k, n, p, s, start, finish

    p = kv%p
    n = kv%functions()

    allocate (twice(0))
    do j = 1, size(kv%u)
      twice = [twice, kv%u(j)]
      if (j == size(kv%u)) then
        twice = [twice, kv%u(j)]
      else if (kv%u(j+1) > kv%u(j)) then
        twice = [twice, kv%u(j)]
      end if
    end do
    start = findloc(twice <= kv%u(p+1), .true., dim=1, back=.true.)
    finish = findloc(twice >= kv%u(n+1), .true., dim=1)
    elevated%p = p + 1
    elevated%u = twice(start-p-1:finish+p+1)

    allocate (a(elevated%functions(),n), source=0.0_wp)
    do i = 1, elevated%functions()
      ! any piece in the support of function i will do; the middle one asks for least extrapolation
      s = middle_span(kv, elevated%u(i), elevated%u(i+p+2))
      t = elevated%u(i+1:i+p+1)
      do k = 1, p + 1
        call polar_row(p, kv%u(s-p+1:s+p), [t(1:k-1), t(k+1:p+1)], c)
        a(i,s-p:s) = a(i,s-p:s) + c / (p + 1)
      end do
    end do
  end subroutine elevation_operator

  pure integer function middle_span(kv, from, to) result(s)
    type(knot_vector), intent(in) :: kv
    real(wp), intent(in) :: from, to   !! ends of a support

    real(wp) :: low, high

    low = max(from, kv%u(kv%p+1))
    high = min(to, kv%u(kv%functions()+1))
    s = kv%span(low + 0.5_wp * (high - low))
  end function middle_span
end module knot_vectors
