module c_shapes
  !! C interface of the shape functions, of sides and of the closest-point projection; see bezel.h for the arrays.
  !! Nothing is saved between calls: every routine may run in any number of threads.
  use, intrinsic :: iso_c_binding, only: c_int, c_double, c_char, c_null_char
  use status_codes, only: status_text
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use side_extraction, only: side_operator, side_functions
  use surface_frame, only: surface_frame_at, tangent_frame_at
  use closest_point, only: projection_report, find_closest_point, find_closest_point_global
  implicit none (type, external)
  private
  public :: bezel_shape_functions, bezel_tensor_rule, bezel_side_functions, bezel_side_operator, &
    bezel_tangent_frame, bezel_surface_frame, bezel_closest_point, bezel_status_text, c_projection

  type, bind(c) :: c_projection
    !! bezel_projection of the header.
    real(c_double) :: distance
    real(c_double) :: xi_free(2)
    integer(c_int) :: sides(2)
    integer(c_int) :: iterations
  end type c_projection

contains

  function bezel_shape_functions(dp, degree, nen, we, ce, xi, nd, shp, dshp, d2shp) result(status) bind(c)
    integer(c_int), value :: dp                           !! parametric directions
    integer(c_int), intent(in) :: degree(dp)
    integer(c_int), value :: nen                          !! functions
    real(c_double), intent(in) :: we(nen)                 !! control weights
    real(c_double), intent(in) :: ce(nen, product(degree + 1))  !! extraction operator
    real(c_double), intent(in) :: xi(dp)                  !! point in [0,1]^dp
    integer(c_int), value :: nd                           !! highest derivative: 0, 1 or 2
    real(c_double), intent(inout) :: shp(nen)
    real(c_double), intent(inout) :: dshp(dp, nen)        !! not touched for nd < 1
    real(c_double), intent(inout) :: d2shp(dp*(dp + 1)/2, nen)  !! not touched for nd < 2
    integer(c_int) :: status

    call shape_functions(degree, we, ce, xi, nd, shp, dshp, d2shp, status)
  end function bezel_shape_functions

  pure subroutine bezel_tensor_rule(dp, n, xi, wt) bind(c)
    integer(c_int), value :: dp
    integer(c_int), intent(in) :: n(dp)                   !! Gauss points of each direction
    real(c_double), intent(out) :: xi(dp, product(n))
    real(c_double), intent(out) :: wt(product(n))

    call tensor_rule(n, xi, wt)
  end subroutine bezel_tensor_rule

  function bezel_side_functions(dp, degree, side) result(nb) bind(c)
    integer(c_int), value :: dp
    integer(c_int), intent(in) :: degree(dp)
    integer(c_int), value :: side                         !! 1 .. 2 dp
    integer(c_int) :: nb                                  !! Bernstein functions on the side

    nb = side_functions(degree, side)
  end function bezel_side_functions

  function bezel_side_operator(dp, degree, nen, ce, side, side_degree, rows, ce_side) result(n) bind(c)
    integer(c_int), value :: dp
    integer(c_int), intent(in) :: degree(dp)
    integer(c_int), value :: nen
    real(c_double), intent(in) :: ce(nen, product(degree + 1))
    integer(c_int), value :: side                         !! 1 .. 2 dp
    integer(c_int), intent(out) :: side_degree(dp - 1)
    integer(c_int), intent(out) :: rows(nen)              !! the functions that live there, counted from 0, in rows(1:n)
    real(c_double), intent(out) :: ce_side(*)             !! (n,nb) of the side; room for nen rows is needed
    integer(c_int) :: n
    real(c_double) :: work(nen, side_functions(degree, side))
    integer :: k

    call side_operator(degree, ce, side, side_degree, n, rows, work)
    do k = 1, size(work, 2)
      ce_side(n*(k - 1) + 1:n*k) = work(1:n, k)
    end do
    rows(1:n) = rows(1:n) - 1
  end function bezel_side_operator

  function bezel_tangent_frame(ndm, nen, xm, shp, dshp, x, tau, nrm, area) result(status) bind(c)
    integer(c_int), value :: ndm, nen
    real(c_double), intent(in) :: xm(ndm, nen)            !! control points
    real(c_double), intent(in) :: shp(nen), dshp(ndm - 1, nen)
    real(c_double), intent(out) :: x(ndm), tau(ndm, ndm - 1), nrm(ndm), area
    integer(c_int) :: status

    call tangent_frame_at(xm, shp, dshp, x, tau, nrm, area, status)
  end function bezel_tangent_frame

  function bezel_surface_frame(ndm, nen, xm, shp, dshp, d2shp, x, tau, nrm, metric, metric_inv, curvature, area) &
    result(status) bind(c)
    integer(c_int), value :: ndm, nen
    real(c_double), intent(in) :: xm(ndm, nen)
    real(c_double), intent(in) :: shp(nen), dshp(ndm - 1, nen), d2shp((ndm - 1)*ndm/2, nen)
    real(c_double), intent(out) :: x(ndm), tau(ndm, ndm - 1), nrm(ndm), area
    real(c_double), dimension(ndm - 1, ndm - 1), intent(out) :: metric, metric_inv, curvature
    integer(c_int) :: status

    call surface_frame_at(xm, shp, dshp, d2shp, x, tau, nrm, metric, metric_inv, curvature, area, status)
  end function bezel_surface_frame

  function bezel_closest_point(ndm, degree, nen, we, ce, xm, xs, guess, xi, report) result(status) bind(c)
    integer(c_int), value :: ndm
    integer(c_int), intent(in) :: degree(ndm - 1)
    integer(c_int), value :: nen
    real(c_double), intent(in) :: we(nen)
    real(c_double), intent(in) :: ce(nen, product(degree + 1))
    real(c_double), intent(in) :: xm(ndm, nen)            !! current control points
    real(c_double), intent(in) :: xs(ndm)                 !! point to project
    integer(c_int), value :: guess                        !! 1: xi holds a first guess
    real(c_double), intent(inout) :: xi(ndm - 1)
    type(c_projection), intent(out) :: report
    integer(c_int) :: status
    type(projection_report) :: found

    if (guess /= 0) then
      call find_closest_point(degree, we, ce, xm, xs, xi, found, status)
    else
      call find_closest_point_global(degree, we, ce, xm, xs, xi, found, status)
    end if
    report%distance = found%distance
    report%xi_free = found%xi_free
    report%sides = found%sides
    report%iterations = found%iterations
  end function bezel_closest_point

  pure subroutine bezel_status_text(status, text, length) bind(c)
    integer(c_int), value :: status
    integer(c_int), value :: length                       !! of text, its end mark included
    character(kind=c_char), intent(inout) :: text(length)
    character(120) :: words
    integer :: i, n

    words = status_text(status)
    n = min(len_trim(words), length - 1)
    do i = 1, n
      text(i) = words(i:i)
    end do
    if (length > 0) text(n + 1) = c_null_char
  end subroutine bezel_status_text
end module c_shapes
