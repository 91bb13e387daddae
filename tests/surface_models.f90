module surface_models
  !! Models that are nothing but a surface (set 1, side 0: the elements themselves), for tests of facets and search.
  use kinds, only: wp
  use status_codes, only: ok
  use model_data, only: model_type, set_surface
  use knot_vectors, only: open_knot_vector
  use nurbs_patch, only: nurbs_patch_type, create_patch, patch_extraction
  use facets, only: facet_surface
  use closest_point, only: projection_report, find_closest_point_global
  use rational_basis, only: shape_functions
  implicit none (type, external)
  private
  public :: polygon, bezier_facets, spline_surface, nearest_of_all, point_on

contains

  subroutine polygon(points, model)
    !! Straight facets from point to point.
    real(wp), intent(in) :: points(:, :)             !! (2,n) [length]
    type(model_type), intent(out), target :: model
    integer :: i

    call bezier_facets([1], reshape([([i, i + 1], i=1, size(points, 2) - 1)], [2, size(points, 2) - 1]), points, model)
  end subroutine polygon

  subroutine bezier_facets(degree, nodes, points, model)
    !! Bezier facets with all weights 1.
    integer, intent(in) :: degree(:)                 !! (dp)
    integer, intent(in) :: nodes(:, :)               !! of each facet (nb,nf)
    real(wp), intent(in) :: points(:, :)             !! (ndm,nn) [length]
    type(model_type), intent(out), target :: model
    real(wp) :: unit(size(nodes, 1), size(nodes, 1))
    integer :: f, id, a

    unit = 0
    do a = 1, size(nodes, 1)
      unit(a, a) = 1
    end do
    call model%mesh%init()
    do f = 1, size(nodes, 2)
      call model%mesh%add_element(size(degree), degree, nodes(:, f), unit, id)
    end do
    call finish(points, spread(1.0_wp, 1, size(points, 2)), model)
  end subroutine bezier_facets

  subroutine spline_surface(p, n, points, model)
    !! A line or a sheet of uniform B-splines of degree p, n elements a direction.
    integer, intent(in) :: p
    integer, intent(in) :: n(:)                      !! (dp)
    real(wp), intent(in) :: points(:, :)             !! (ndm,product(n+p)), first direction fastest [length]
    type(model_type), intent(out), target :: model
    type(nurbs_patch_type) :: patch
    real(wp) :: cp(4, size(points, 2))
    integer :: i, status

    cp = 0
    cp(1:size(points, 1), :) = points
    cp(4, :) = 1
    if (size(n) == 1) then
      call create_patch([open_knot_vector(p, [(real(i, wp), i=0, n(1))])], cp, patch, status)
    else
      call create_patch([open_knot_vector(p, [(real(i, wp), i=0, n(1))]), open_knot_vector(p, [(real(i, wp), i=0, n(2))])], &
                        cp, patch, status)
    end if
    if (status /= ok) error stop 'spline_surface: number of points'
    call model%mesh%init()
    call patch_extraction(patch, [(i, i=1, size(points, 2))], model%mesh)
    call finish(points, cp(4, :), model)
  end subroutine spline_surface

  subroutine finish(points, w, model)
    real(wp), intent(in) :: points(:, :), w(:)
    type(model_type), intent(inout) :: model
    integer :: i

    model%ndm = size(points, 1)
    model%ndf = model%ndm
    model%nn = size(points, 2)
    model%x = points
    model%w = w
    allocate (model%sets(1))
    model%sets(1)%name = 'surface'
    model%sets(1)%kind = set_surface
    model%sets(1)%items = [(i, i=1, model%mesh%ne)]
    model%sets(1)%sides = [(0, i=1, model%mesh%ne)]
  end subroutine finish

  subroutine nearest_of_all(model, surface, xs, facet, distance)
    !! By trying every facet: the nearest proper projection, facet 0 if there is none.
    type(model_type), intent(in) :: model
    type(facet_surface), intent(in), target :: surface
    real(wp), intent(in) :: xs(:)
    integer, intent(out) :: facet
    real(wp), intent(out) :: distance
    integer, pointer, contiguous :: nodes(:)
    real(wp), pointer, contiguous :: ce(:, :)
    real(wp) :: xi(size(xs) - 1)
    type(projection_report) :: report
    integer :: f, status, dp

    dp = size(xs) - 1
    facet = 0
    distance = huge(1.0_wp)
    do f = 1, surface%set%ne
      nodes => surface%set%connectivity(f)
      ce => surface%set%operator(f)
      call find_closest_point_global(surface%set%degree(1:dp, f), model%w(nodes), ce, model%x(:, nodes), xs, xi, report, &
                                     status)
      if (status /= ok .or. report%distance >= distance) cycle
      facet = f
      distance = report%distance
    end do
  end subroutine nearest_of_all

  function point_on(model, surface, facet, xi) result(x)
    type(model_type), intent(in) :: model
    type(facet_surface), intent(in), target :: surface
    integer, intent(in) :: facet
    real(wp), intent(in) :: xi(:)
    real(wp) :: x(size(xi) + 1)
    integer, pointer, contiguous :: nodes(:)
    real(wp), pointer, contiguous :: ce(:, :)
    real(wp), allocatable :: shp(:), dshp(:, :)
    real(wp) :: none(0, 0)
    integer :: status

    nodes => surface%set%connectivity(facet)
    ce => surface%set%operator(facet)
    allocate (shp(size(nodes)), dshp(size(xi), size(nodes)))
    call shape_functions(surface%set%degree(1:size(xi), facet), model%w(nodes), ce, xi, 1, shp, dshp, none, status)
    if (status /= ok) error stop 'point_on: facet without positive weight'
    x = matmul(model%x(:, nodes), shp)
  end function point_on
end module surface_models
