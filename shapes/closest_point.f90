module closest_point
  !! Closest point of a rational Bezier facet (dp = 1 in the plane, dp = 2 in space) to a given
  !! point x_s, Tables 1-2 of the paper: the minimum of |x_s - x(xi)|^2 / 2 over [0,1]^dp by Newton
  !! with the full derivative,
  !!
  !!     f_a = tau_a . d = 0,     d = x_s - x,     -f_a,b = A_ab = tau_a . tau_b - d . x_,ab
  !!
  !! Where A is not positive definite the step takes the metric tau_a . tau_b instead (Gauss-Newton)
  !! in the directions to blame; coordinates that press against a bound rest there; a step that does
  !! not reduce the distance is halved. A maximum or saddle is left along the negative curvature, a
  !! collapsed edge (the pole of a sphere) along the side on which the distance falls.
  !!
  !! x is rational in homogeneous Bezier points q = C^T (w P, w), which are formed once a facet: an
  !! iteration never touches the extraction operator.
  !!
  !! On return xi is always inside the bounds and `distance` is that of its point. Status:
  !!   ok                   f = 0 inside, or on a bound that the minimum oversteps by no more than
  !!                        `boundary_tolerance`
  !!   outside_facet        the minimum is on a bound: `sides` says through which the projection
  !!                        leaves, `xi_free` where Newton expects it beyond
  !!   singular_projection  A is singular at the solution: x_s is at a centre of curvature
  !!   no_convergence, bad_weight
  !! At a pole (and within 1e-7 of it) the status is ok: the distance is right, xi along the
  !! collapsed edge is arbitrary, and it is the frame there that has no normal.
  use kinds, only: wp
  use status_codes, only: ok, outside_facet, singular_projection, no_convergence, bad_weight
  use bernstein, only: bernstein_basis
  implicit none (type, external)
  private
  public :: projection_report, boundary_tolerance
  public :: find_closest_point, find_closest_point_global, homogeneous_points, &
    closest_point_of_bezier

  type :: projection_report
    real(wp) :: distance = huge(1.0_wp)   !! |x_s - x(xi)| [length]
    real(wp) :: xi_free(2) = 0            !! xi, and beyond an overstepped bound Newton's estimate
    integer :: sides(2) = 0               !! side left in s and in t, numbered
                                          !! 1: s=0, 2: s=1, 3: t=0, 4: t=1; 0: none
    integer :: iterations = 0             !! evaluations of the facet with second derivatives
  end type projection_report

  type :: facet_point
    !! The objective and its derivatives at one xi; in the plane the second direction is unused.
    real(wp) :: half_square = 0           !! |d|^2 / 2
    real(wp) :: f(2) = 0                  !! tau_a . d, the descent
    real(wp) :: m(3) = 0                  !! metric 11, 22, 12
    real(wp) :: h(3) = 0                  !! A 11, 22, 12
    real(wp) :: noise = 0                 !! rounding error of d [length]
  end type facet_point

  ! In xi: points on a common edge belong to both facets.
  real(wp), parameter :: boundary_tolerance = 1.0e-10_wp
  ! det A over det m below which A is singular
  real(wp), parameter :: singular_ratio = 1.0e-10_wp
  ! A tangent vanishes if it is shorter than this times the rounding error of d, or times the other.
  real(wp), parameter :: lost_in_noise = 1.0e3_wp
  real(wp), parameter :: collapsed = 1.0e-7_wp
  integer, parameter :: most_iterations = 100
  integer, parameter :: most_escapes = 3

contains

  pure subroutine find_closest_point(degree, we, ce, xm, xs, xi, report, status)
    !! From the first guess xi to the minimum that it belongs to.
    integer, intent(in) :: degree(:)                !! Bernstein degrees (dp)
    real(wp), contiguous, intent(in) :: we(:)       !! control weights (nem)
    real(wp), contiguous, intent(in) :: ce(:,:)     !! extraction operator (nem,nb)
    real(wp), contiguous, intent(in) :: xm(:,:)     !! current control points (ndm,nem) [length]
    real(wp), intent(in) :: xs(:)                   !! point to project (ndm) [length]
    real(wp), intent(inout) :: xi(:)                !! first guess, projection (dp) in [0,1]
    type(projection_report), intent(out) :: report
    integer, intent(out) :: status
    real(wp) :: q(size(xm,1)+1, size(ce,2))

    call homogeneous_points(we, ce, xm, q)
    call closest_point_of_bezier(degree, q, xs, xi, report, status)
  end subroutine find_closest_point

  pure subroutine find_closest_point_global(degree, we, ce, xm, xs, xi, report, status)
    !! Without a first guess: Newton from every local minimum over a grid of 2 p + 1 points a
    !! direction. The nearest proper projection wins; without any, the nearest point of the bounds.
    integer, intent(in) :: degree(:)                !! Bernstein degrees (dp)
    real(wp), contiguous, intent(in) :: we(:)       !! control weights (nem)
    real(wp), contiguous, intent(in) :: ce(:,:)     !! extraction operator (nem,nb)
    real(wp), contiguous, intent(in) :: xm(:,:)     !! current control points (ndm,nem) [length]
    real(wp), intent(in) :: xs(:)                   !! point to project (ndm) [length]
    real(wp), intent(out) :: xi(:)                  !! projection (dp) in [0,1]
    type(projection_report), intent(out) :: report
    integer, intent(out) :: status
    real(wp) :: q(size(xm,1)+1, size(ce,2))
    real(wp) :: half_square(0:2*degree(1), 0:2*degree(size(degree))*(size(degree)-1))
    real(wp) :: trial(size(xi))
    type(projection_report) :: trial_report
    integer :: i, j, n1, n2, trial_status
    logical :: better

    call homogeneous_points(we, ce, xm, q)
    n1 = ubound(half_square, 1)
    n2 = ubound(half_square, 2)
    xi = 0
    do j = 0, n2
      do i = 0, n1
        call grid_point(i, j, trial)
        call half_squared_distance(degree, q, xs, trial, half_square(i,j), status)
        if (status /= ok) return
      end do
    end do

    status = no_convergence
    do j = 0, n2
      do i = 0, n1
        if (any(half_square(max(i-1,0):min(i+1,n1), max(j-1,0):min(j+1,n2)) &
          < half_square(i,j))) cycle
        call grid_point(i, j, trial)
        call closest_point_of_bezier(degree, q, xs, trial, trial_report, trial_status)
        trial_report%iterations = trial_report%iterations + report%iterations
        if (rank_of(trial_status) == rank_of(status)) then
          better = trial_report%distance < report%distance
        else
          better = rank_of(trial_status) < rank_of(status)
        end if
        if (better) then
          xi = trial
          report = trial_report
          status = trial_status
        end if
        report%iterations = trial_report%iterations
      end do
    end do

  contains

    pure subroutine grid_point(i, j, point)
      integer, intent(in) :: i, j
      real(wp), intent(out) :: point(:)

      point(1) = real(i, wp) / max(n1, 1)
      if (size(point) > 1) point(2) = real(j, wp) / max(n2, 1)
    end subroutine grid_point

    pure integer function rank_of(status) result(rank)
      integer, intent(in) :: status

      select case (status)
      case (ok);                  rank = 1
      case (singular_projection); rank = 2
      case (outside_facet);       rank = 3
      case default;               rank = 4
      end select
    end function rank_of
  end subroutine find_closest_point_global

  pure subroutine homogeneous_points(we, ce, xm, q)
    !! Bezier points of the facet in homogeneous form. With positive weights the facet lies in the
    !! convex hull of q(1:ndm,:) / q(ndm+1,:), which bounding boxes may use.
    real(wp), contiguous, intent(in) :: we(:)       !! control weights (nem)
    real(wp), contiguous, intent(in) :: ce(:,:)     !! extraction operator (nem,nb)
    real(wp), contiguous, intent(in) :: xm(:,:)     !! control points (ndm,nem) [length]
    real(wp), contiguous, intent(out) :: q(:,:)     !! w x and w (ndm+1,nb)
    real(wp) :: wc
    integer :: a, b, ndm

    ndm = size(xm, 1)
    do b = 1, size(ce, 2)
      q(:,b) = 0
      do a = 1, size(we)
        wc = we(a) * ce(a,b)
        q(1:ndm,b) = q(1:ndm,b) + wc * xm(:,a)
        q(ndm+1,b) = q(ndm+1,b) + wc
      end do
    end do
  end subroutine homogeneous_points

  pure subroutine closest_point_of_bezier(degree, q, xs, xi, report, status)
    !! `find_closest_point` for a facet whose homogeneous points are at hand: many points
    !! on one facet.
    integer, intent(in) :: degree(:)                !! Bernstein degrees (dp)
    real(wp), contiguous, intent(in) :: q(:,:)      !! homogeneous Bezier points (ndm+1,nb)
    real(wp), intent(in) :: xs(:)                   !! point to project (ndm) [length]
    real(wp), intent(inout) :: xi(:)                !! first guess, projection (dp) in [0,1]
    type(projection_report), intent(out) :: report
    integer, intent(out) :: status
    type(facet_point) :: here, there
    real(wp) :: step(2), trial(size(xi)), fraction, descent
    logical :: rests(2)                             ! the coordinate presses against its bound
    logical :: escaped
    integer :: dp, iteration, escapes, stalls

    dp = size(degree)
    xi = min(max(xi, 0.0_wp), 1.0_wp)
    escapes = 0
    stalls = 0
    call evaluate(degree, q, xs, xi, here, status)
    report%iterations = 1
    if (status /= ok) return

    iterations: do iteration = 1, most_iterations
      rests = .true.
      rests(1:dp) = (xi <= 0 .and. here%f(1:dp) < 0) .or. (xi >= 1 .and. here%f(1:dp) > 0)
      rests(1:dp) = rests(1:dp) .and. has_tangent(here, dp)

      if (all(rests .or. is_stationary(here)) .or. stalls >= 3) then
        call leave_stationary_point(degree, q, xs, rests, escapes, xi, here, escaped, &
          report%iterations, status)
        if (status /= ok) return
        stalls = 0
        if (escaped) cycle iterations
        call classify(xi, here, rests, report, status)
        return
      end if

      call descent_step(here, rests, step)
      fraction = 1
      do
        trial = min(max(xi + fraction * step(1:dp), 0.0_wp), 1.0_wp)
        call evaluate(degree, q, xs, trial, there, status)
        report%iterations = report%iterations + 1
        if (status /= ok) return
        descent = sum(here%f(1:dp) * (trial - xi))
        ! the last term lets rounding pass: the distance is blind where f still tells
        if (there%half_square <= here%half_square - 1.0e-4_wp * descent &
          + here%noise * sqrt(2 * here%half_square) + here%noise**2) exit
        fraction = fraction / 2
        if (fraction < 1.0e-9_wp) then
          report%distance = sqrt(2 * here%half_square)
          status = no_convergence
          return
        end if
      end do
      ! rounding can be larger than its estimate: f is small and shrinks no more
      if (all(rests .or. is_nearly_stationary(there))) then
        if (any(.not. (rests .or. is_stationary(there)) &
          .and. abs(there%f) >= abs(here%f) / 2)) stalls = stalls + 1
      end if
      xi = trial
      here = there
    end do iterations

    report%distance = sqrt(2 * here%half_square)
    status = no_convergence
  end subroutine closest_point_of_bezier

  pure function is_stationary(here) result(stationary)
    !! f_a is zero within the rounding error of d, or says nothing.
    type(facet_point), intent(in) :: here
    logical :: stationary(2)

    stationary = abs(here%f) <= here%noise * sqrt(here%m(1:2)) .or. .not. has_tangent(here, 2)
  end function is_stationary

  pure function is_nearly_stationary(here) result(stationary)
    !! f_a is zero within a generous estimate of the rounding errors of d and tau.
    type(facet_point), intent(in) :: here
    logical :: stationary(2)

    stationary = abs(here%f) &
      <= 1.0e3_wp * here%noise * (sqrt(here%m(1:2)) + sqrt(2 * here%half_square))
  end function is_nearly_stationary

  pure function has_tangent(here, dp) result(there_is)
    !! The tangent does not vanish, as it does where an edge is collapsed. Nearer to a pole than the
    !! square root of rounding, the direction in which the edge is collapsed says nothing any more.
    type(facet_point), intent(in) :: here
    integer, intent(in) :: dp
    logical :: there_is(dp)

    there_is = here%m(1:dp) > (lost_in_noise * here%noise)**2
    if (dp == 2) there_is = there_is .and. here%m(1:dp) > collapsed**2 * here%m(dp:1:-1)
  end function has_tangent

  pure subroutine descent_step(here, rests, step)
    !! Newton's step in the coordinates that are free to move; along an eigenvector of A (in units
    !! of |tau_a|) that is not curved upward the metric's step, lengthened where the curvature is
    !! small: an eigenvalue of 1/10 or more.
    type(facet_point), intent(in) :: here
    logical, intent(in) :: rests(2)         !! coordinates that stay
    real(wp), intent(out) :: step(2)
    real(wp) :: scale(2), eigenvalue(2), eigenvector(2), along, across, det
    logical :: moves(2)

    step = 0
    moves = .not. rests .and. has_tangent(here, 2)
    if (all(moves)) then
      if (is_definite(here)) then
        det = here%h(1) * here%h(2) - here%h(3)**2
        step(1) = (here%h(2) * here%f(1) - here%h(3) * here%f(2)) / det
        step(2) = (here%h(1) * here%f(2) - here%h(3) * here%f(1)) / det
      else
        scale = sqrt(here%m(1:2))
        call scaled_eigenpairs(here, eigenvalue, eigenvector)
        where (eigenvalue <= singular_ratio) eigenvalue = max(-eigenvalue, 0.1_wp)
        along = dot_product(eigenvector, here%f / scale) / eigenvalue(1)
        across = (eigenvector(1) * here%f(2) / scale(2) - eigenvector(2) * here%f(1) / scale(1)) &
          / eigenvalue(2)
        step(1) = (eigenvector(1) * along - eigenvector(2) * across) / scale(1)
        step(2) = (eigenvector(2) * along + eigenvector(1) * across) / scale(2)
      end if
    else if (moves(1)) then
      step(1) = here%f(1) / merge(here%h(1), here%m(1), here%h(1) > singular_ratio * here%m(1))
    else if (moves(2)) then
      step(2) = here%f(2) / merge(here%h(2), here%m(2), here%h(2) > singular_ratio * here%m(2))
    end if
  end subroutine descent_step

  pure subroutine scaled_eigenpairs(here, eigenvalue, eigenvector)
    !! Of A_ab / (|tau_a| |tau_b|), smaller one first; both tangents are there.
    type(facet_point), intent(in) :: here
    real(wp), intent(out) :: eigenvalue(2)
    real(wp), intent(out) :: eigenvector(2)     !! of the first, unit; the second is perpendicular
    real(wp) :: s(3), root

    s = here%h / [here%m(1), here%m(2), sqrt(here%m(1)) * sqrt(here%m(2))]
    root = hypot((s(1) - s(2)) / 2, s(3))
    eigenvalue = (s(1) + s(2)) / 2 + [-root, root]
    eigenvector = [s(3), (s(2) - s(1)) / 2 - root]
    if (s(1) < s(2)) eigenvector = [(s(1) - s(2)) / 2 - root, s(3)]
    if (root <= 0) eigenvector = [1.0_wp, 0.0_wp]
    eigenvector = eigenvector / norm2(eigenvector)
  end subroutine scaled_eigenpairs

  pure function is_definite(here) result(definite)
    !! A is positive definite, and not just so, measured by the metric.
    type(facet_point), intent(in) :: here
    logical :: definite

    definite = here%h(1) > singular_ratio * here%m(1) .and. here%h(2) > singular_ratio * here%m(2) &
      .and. here%h(1) * here%h(2) - here%h(3)**2 &
      > singular_ratio * (here%m(1) * here%m(2) - here%m(3)**2)
  end function is_definite

  pure subroutine leave_stationary_point(degree, q, xs, rests, escapes, xi, here, escaped, &
    iterations, status)
    !! f vanishes where it may: is it a minimum? If not, go on from a point with a smaller distance.
    integer, intent(in) :: degree(:)                !! Bernstein degrees (dp)
    real(wp), contiguous, intent(in) :: q(:,:)      !! homogeneous Bezier points (ndm+1,nb)
    real(wp), intent(in) :: xs(:)                   !! point to project (ndm)
    logical, intent(in) :: rests(2)                 !! coordinates pressed against their bounds
    integer, intent(inout) :: escapes               !! how often this was done
    real(wp), intent(inout) :: xi(:)              !! stationary point, or the one to go on from (dp)
    type(facet_point), intent(inout) :: here        !! at xi
    logical, intent(out) :: escaped
    integer, intent(inout) :: iterations
    integer, intent(out) :: status
    type(facet_point) :: there
    real(wp) :: trial(size(xi)), direction(2), eigenvalue(2), pull, best, length
    integer :: a, b, k, sign
    logical :: vanishes(2)

    status = ok
    escaped = .false.
    if (escapes >= most_escapes) return
    vanishes = .false.
    vanishes(1:size(xi)) = .not. has_tangent(here, size(xi))

    if (any(vanishes)) then
      ! A collapsed edge: look round the pole for the side on which the distance falls fastest.
      if (all(vanishes) .or. size(xi) == 1) return
      a = merge(1, 2, vanishes(1))
      b = 3 - a
      if (abs(xi(b) - anint(xi(b))) > 1.0e-9_wp) return
      best = 0
      direction = 0
      do k = 0, 16
        trial(b) = anint(xi(b))
        trial(a) = k / 16.0_wp
        call evaluate(degree, q, xs, trial, there, status)
        iterations = iterations + 1
        if (status /= ok) return
        pull = merge(there%f(b), -there%f(b), trial(b) <= 0)
        if (pull <= 10 * there%noise * sqrt(there%m(b))) cycle
        pull = pull / sqrt(there%m(b))
        if (pull > best) then
          best = pull
          direction(1:2) = trial
          here = there
        end if
      end do
      if (best <= 0) return
      xi = direction
      escaped = .true.
      escapes = escapes + 1
      return
    end if

    ! Direction of the smallest curvature of the distance, in lengths: A_ab / (|tau_a| |tau_b|).
    direction = 0
    if (.not. any(rests)) then
      call scaled_eigenpairs(here, eigenvalue, direction)
      if (eigenvalue(1) >= -singular_ratio) return
      direction = direction / sqrt(here%m(1:2))
    else
      do a = 1, size(xi)
        if (.not. rests(a) .and. here%h(a) < -singular_ratio * here%m(a)) direction(a) = 1
      end do
    end if
    if (all(abs(direction) <= 0)) return
    direction = direction / maxval(abs(direction))

    length = 0.125_wp
    do k = 1, 20
      do sign = 1, -1, -2
        trial = min(max(xi + sign * length * direction(1:size(xi)), 0.0_wp), 1.0_wp)
        call evaluate(degree, q, xs, trial, there, status)
        iterations = iterations + 1
        if (status /= ok) return
        if (there%half_square < here%half_square) then
          xi = trial
          here = there
          escaped = .true.
          escapes = escapes + 1
          return
        end if
      end do
      length = length / 2
    end do
  end subroutine leave_stationary_point

  pure subroutine classify(xi, here, rests, report, status)
    !! What kind of point Newton has ended on.
    real(wp), intent(in) :: xi(:)                     !! solution (dp)
    type(facet_point), intent(in) :: here             !! at xi
    logical, intent(in) :: rests(2)                   !! coordinates pressed against their bounds
    type(projection_report), intent(inout) :: report
    integer, intent(out) :: status                    !! ok, outside_facet, singular_projection
    real(wp) :: beyond(2)
    integer :: a, dp
    logical :: singular

    dp = size(xi)
    report%distance = sqrt(2 * here%half_square)
    report%xi_free(1:dp) = xi
    status = ok

    if (any(rests(1:dp))) then
      if (dp == 2 .and. is_definite(here)) then
        call descent_step(here, [.false., .false.], beyond)
      else
        call descent_step(here, [.false., dp == 1], beyond)
      end if
      do a = 1, dp
        if (.not. rests(a)) cycle
        ! a bent facet's estimate may point inward; the coordinate alone says how f pushes
        if (beyond(a) * here%f(a) <= 0) beyond(a) = here%f(a) / here%m(a)
        if (abs(beyond(a)) <= boundary_tolerance) cycle
        report%xi_free(a) = xi(a) + beyond(a)
        report%sides(a) = 2 * a - merge(1, 0, xi(a) <= 0)
        status = outside_facet
      end do
      if (status /= ok) return
    end if

    singular = .false.
    if (dp == 2 .and. .not. any(rests)) then
      if (all(has_tangent(here, 2))) singular = .not. is_definite(here)
    else
      singular = any(.not. rests(1:dp) .and. has_tangent(here, dp) &
        .and. here%h(1:dp) <= singular_ratio * here%m(1:dp))
    end if
    if (singular) status = singular_projection
  end subroutine classify

  pure subroutine evaluate(degree, q, xs, xi, here, status)
    !! Distance, f, metric and A at xi.
    integer, intent(in) :: degree(:)                !! Bernstein degrees (dp)
    real(wp), contiguous, intent(in) :: q(:,:)      !! homogeneous Bezier points (ndm+1,nb)
    real(wp), intent(in) :: xs(:)                   !! point to project (ndm)
    real(wp), intent(in) :: xi(:)                   !! parametric point (dp)
    type(facet_point), intent(out) :: here
    integer, intent(out) :: status                  !! ok, bad_weight
    real(wp) :: bez(size(q,2)), dbez(size(degree),size(q,2)), &
      d2bez(size(degree)*(size(degree)+1)/2,size(q,2))
    real(wp) :: h0(4), h1(4,2), h2(4,3)             ! homogeneous point and its derivatives
    real(wp) :: x(3), tau(3,2), x2(3), d(3), over_w
    integer :: b, k, ndm, dp

    dp = size(degree)
    ndm = size(xs)
    call bernstein_basis(degree, xi, 2, bez, dbez, d2bez)
    h0 = 0
    h1 = 0
    h2 = 0
    if (dp == 1) then
      do b = 1, size(q, 2)
        h0(1:3) = h0(1:3) + bez(b) * q(1:3,b)
        h1(1:3,1) = h1(1:3,1) + dbez(1,b) * q(1:3,b)
        h2(1:3,1) = h2(1:3,1) + d2bez(1,b) * q(1:3,b)
      end do
    else
      do b = 1, size(q, 2)
        h0 = h0 + bez(b) * q(1:4,b)
        h1(:,1) = h1(:,1) + dbez(1,b) * q(1:4,b)
        h1(:,2) = h1(:,2) + dbez(2,b) * q(1:4,b)
        h2(:,1) = h2(:,1) + d2bez(1,b) * q(1:4,b)
        h2(:,2) = h2(:,2) + d2bez(2,b) * q(1:4,b)
        h2(:,3) = h2(:,3) + d2bez(3,b) * q(1:4,b)
      end do
    end if

    status = bad_weight
    if (.not. h0(ndm+1) > 0) return
    status = ok
    over_w = 1 / h0(ndm+1)
    x = 0
    d = 0
    tau = 0
    x(1:ndm) = h0(1:ndm) * over_w
    d(1:ndm) = xs - x(1:ndm)
    do k = 1, dp
      tau(1:ndm,k) = (h1(1:ndm,k) - x(1:ndm) * h1(ndm+1,k)) * over_w
      here%f(k) = dot_product(tau(:,k), d)
      here%m(k) = dot_product(tau(:,k), tau(:,k))
      x2(1:ndm) = (h2(1:ndm,k) - 2 * tau(1:ndm,k) * h1(ndm+1,k) - x(1:ndm) * h2(ndm+1,k)) * over_w
      here%h(k) = here%m(k) - dot_product(d(1:ndm), x2(1:ndm))
    end do
    if (dp == 2) then
      here%m(3) = dot_product(tau(:,1), tau(:,2))
      x2 = (h2(1:3,3) - tau(:,1) * h1(4,2) - tau(:,2) * h1(4,1) - x * h2(4,3)) * over_w
      here%h(3) = here%m(3) - dot_product(d, x2)
    end if
    here%half_square = dot_product(d, d) / 2
    here%noise = 4 * epsilon(1.0_wp) * (maxval(abs(xs)) + maxval(abs(x(1:ndm))))
  end subroutine evaluate

  pure subroutine half_squared_distance(degree, q, xs, xi, half_square, status)
    integer, intent(in) :: degree(:)                !! Bernstein degrees (dp)
    real(wp), contiguous, intent(in) :: q(:,:)      !! homogeneous Bezier points (ndm+1,nb)
    real(wp), intent(in) :: xs(:)                   !! point to project (ndm)
    real(wp), intent(in) :: xi(:)                   !! parametric point (dp)
    real(wp), intent(out) :: half_square            !! |x_s - x(xi)|^2 / 2
    integer, intent(out) :: status                  !! ok, bad_weight
    real(wp) :: bez(size(q,2)), unused_1(size(degree),0), unused_2(size(degree),0)
    real(wp) :: h0(size(q,1))
    integer :: b, ndm

    ndm = size(xs)
    call bernstein_basis(degree, xi, 0, bez, unused_1, unused_2)
    h0 = 0
    do b = 1, size(q, 2)
      h0 = h0 + bez(b) * q(:,b)
    end do
    status = bad_weight
    half_square = huge(1.0_wp)
    if (.not. h0(ndm+1) > 0) return
    status = ok
    half_square = sum((xs - h0(1:ndm) / h0(ndm+1))**2) / 2
  end subroutine half_squared_distance
end module closest_point
