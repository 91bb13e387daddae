module element_benchmarks
  !! Solid, shell and interface kernel and shape functions on single elements. Bases are not told apart: to the kernels an
  !! element of Lagrange, NURBS or T-splines is the same.
  use kinds, only: wp
  use status_codes, only: ok
  use solid_samples, only: element, distorted_element, wave
  use material_laws, only: solid_law, define_solid_law, neo_hooke, plane_strain, three_dimensional
  use solid_kernel, only: solid_tangent, solid_force
  use shell_law, only: shell_law_type, define_shell_law
  use shell_kernel, only: shell_tangent, shell_force, shell_points, n_derivatives, n_frame
  use shell_samples, only: shell, curved_shell
  use rational_basis, only: shape_functions
  use interface_law, only: gap_law, gap_response, contact_law
  use gpts_kernel, only: gpts_point
  use closest_point, only: projection_report, find_closest_point_global, homogeneous_points, &
    closest_point_of_bezier
  use facet_samples, only: facet, random_stream, bent_facet, facet_functions
  use surface_frame, only: tangent_frame_at
  use stopwatch, only: stopwatch_type
  use report, only: put, text
  implicit none (type, external)
  private
  public :: measure_solid_kernel, measure_shell_kernel, measure_layered_shell, measure_shape_functions, measure_interface_kernel, &
    measure_projection

contains

  pure function name_of(dimension, p) result(name)
    integer, intent(in) :: dimension, p
    character(:), allocatable :: name

    name = text(dimension)//'D p = '//text(p)
  end function name_of

  subroutine measure_solid_kernel(ndm, p)
    !! Neo-Hookean, p + 1 Gauss points a direction.
    integer, intent(in) :: ndm, p
    type(element) :: sample
    type(solid_law) :: law
    type(stopwatch_type) :: watch
    real(wp), allocatable :: ue(:, :), fe(:, :), ke(:, :, :, :)
    real(wp) :: energy
    integer :: a, i, nen, status

    sample = distorted_element(ndm, p, p + 1)
    nen = size(sample%we)
    call define_solid_law(neo_hooke, merge(plane_strain, three_dimensional, ndm == 2), 1.0_wp, 0.3_wp, law, status)
    allocate (ue(ndm, nen), fe(ndm, nen), ke(ndm, nen, ndm, nen))
    do a = 1, nen
      do i = 1, ndm
        ue(i, a) = 0.02_wp*wave(a, 5*i)/p
      end do
    end do
    call watch%begin()
    do while (watch%goes_on())
      call solid_force(sample%dshp, sample%dvol, ue, law, fe, energy, status)
    end do
    if (status /= ok) error stop 'element_benchmarks: the sample fails'
    call put('element', name_of(ndm, p), 'residual, kernel [us]', 1.0e6_wp*watch%best)
    call watch%begin()
    do while (watch%goes_on())
      call solid_tangent(sample%dshp, sample%dvol, ue, law, fe, ke, energy, status)
    end do
    call put('element', name_of(ndm, p), 'residual and tangent, kernel [us]', 1.0e6_wp*watch%best)
  end subroutine measure_solid_kernel

  subroutine measure_layered_shell(p)
    !! The tangent with three points over the thickness.
    integer, intent(in) :: p
    type(shell) :: sample
    type(shell_law_type) :: law
    type(stopwatch_type) :: watch
    real(wp), allocatable :: ue(:, :), fe(:, :), ke(:, :, :, :)
    real(wp) :: energy
    integer :: nen, status

    sample = curved_shell(p, p + 1)
    nen = size(sample%we)
    call define_shell_law(1.0_wp, 0.3_wp, 0.01_wp, .false., law, status)
    call law%integrate_by_points(3)
    allocate (ue(3, nen), fe(3, nen), ke(3, nen, 3, nen))
    ue = 0
    call watch%begin()
    do while (watch%goes_on())
      call shell_tangent(sample%dshp, sample%frame, sample%area, ue, law, fe, ke, energy, status)
    end do
    if (status /= ok) error stop 'element_benchmarks: the sample is too thick'
    call put('shell element', 'p = '//text(p), 'the same, 3 points over the thickness [us]', 1.0e6_wp*watch%best)
  end subroutine measure_layered_shell

  subroutine measure_shell_kernel(p)
    !! St. Venant-Kirchhoff, p + 1 Gauss points a direction.
    integer, intent(in) :: p
    type(shell) :: sample
    type(shell_law_type) :: law
    type(stopwatch_type) :: watch
    real(wp), allocatable :: ue(:, :), fe(:, :), ke(:, :, :, :)
    real(wp) :: energy, wt((p + 1)**2)
    integer :: a, i, nen, status
    character(*), parameter :: group = 'shell element'

    sample = curved_shell(p, p + 1)
    nen = size(sample%we)
    call define_shell_law(1.0_wp, 0.3_wp, 0.01_wp, .false., law, status)
    allocate (ue(3, nen), fe(3, nen), ke(3, nen, 3, nen))
    do a = 1, nen
      do i = 1, 3
        ue(i, a) = 0.02_wp*wave(a, 5*i)/p
      end do
    end do
    call watch%begin()
    do while (watch%goes_on())
      call shell_force(sample%dshp, sample%frame, sample%area, ue, law, fe, energy, status)
    end do
    if (status /= ok) error stop 'element_benchmarks: the sample fails'
    call put(group, 'p = '//text(p), 'residual, kernel [us]', 1.0e6_wp*watch%best)
    call watch%begin()
    do while (watch%goes_on())
      call shell_tangent(sample%dshp, sample%frame, sample%area, ue, law, fe, ke, energy, status)
    end do
    call put(group, 'p = '//text(p), 'residual and tangent, kernel [us]', 1.0e6_wp*watch%best)
    wt = 1
    call watch%begin()
    do while (watch%goes_on())
      call shell_points(sample%degree, sample%xe, sample%we, sample%ce, sample%xi, wt, sample%shp, sample%dshp, &
                        sample%frame, sample%area, status)
    end do
    call put(group, 'p = '//text(p), 'preparation, once [us]', 1.0e6_wp*watch%best)
    call put(group, 'p = '//text(p), 'memory of the table [kB]', 8e-3_wp*(p + 1)**2*(n_derivatives*nen + n_frame + 1))
  end subroutine measure_shell_kernel

  subroutine measure_shape_functions(dp, p)
    !! One point: Bernstein values, extraction, weights.
    integer, intent(in) :: dp, p
    type(element) :: sample
    type(stopwatch_type) :: watch
    real(wp), allocatable :: shp(:), dshp(:, :), d2shp(:, :)
    real(wp) :: xi(dp)
    integer :: nd, nen, status
    character(*), parameter :: columns(0:2) = [character(30) :: 'values [us]', 'and gradients [us]', &
      'and second derivatives [us]']

    sample = distorted_element(dp, p, 1)
    nen = size(sample%we)
    allocate (shp(nen), dshp(dp, nen), d2shp(dp*(dp + 1)/2, nen))
    xi = 0.3_wp
    do nd = 0, 2
      call watch%begin()
      do while (watch%goes_on())
        call shape_functions(sample%degree, sample%we, sample%ce, xi, nd, shp, dshp, d2shp, status)
      end do
      if (status /= ok) error stop 'element_benchmarks: no functions at a point'
      call put('shape functions', name_of(dp, p), trim(columns(nd)), 1.0e6_wp*watch%best)
    end do
  end subroutine measure_shape_functions

  subroutine closed_pair(ndm, p, sample, shp, dshp, d2shp, xs)
    !! A bent facet and a point a little below it.
    integer, intent(in) :: ndm, p
    type(facet), intent(out) :: sample
    real(wp), allocatable, intent(out) :: shp(:), dshp(:, :), d2shp(:, :)
    real(wp), intent(out) :: xs(:)
    type(random_stream) :: stream
    real(wp) :: x(ndm), tau(ndm, ndm - 1), nrm(ndm), xi(ndm - 1), area
    integer :: i, status

    sample = bent_facet([(p, i=1, ndm - 1)], 0.1_wp, stream)
    xi = 0.4_wp
    call facet_functions(sample, xi, shp, dshp, d2shp)
    call tangent_frame_at(sample%xm, shp, dshp, x, tau, nrm, area, status)
    if (status /= ok) error stop 'element_benchmarks: no frame'
    xs = x - 0.01_wp*nrm
  end subroutine closed_pair

  subroutine measure_interface_kernel(ndm, p)
    !! One closed point, facets of the same kind on both sides.
    integer, intent(in) :: ndm, p
    type(facet) :: sample
    type(gap_law) :: law
    type(gap_response) :: response
    type(stopwatch_type) :: watch
    real(wp), allocatable :: shp(:), dshp(:, :), d2shp(:, :), xs(:, :), fe(:, :), ke(:, :, :, :)
    real(wp) :: place(ndm)
    integer :: a, n, status, pass

    call closed_pair(ndm, p, sample, shp, dshp, d2shp, place)
    call contact_law(1.0e3_wp, law, status)
    n = size(shp)
    allocate (xs(ndm, n), fe(ndm, 2*n), ke(ndm, 2*n, ndm, 2*n))
    do a = 1, n
      xs(:, a) = place
    end do
    do pass = 1, 2
      call watch%begin()
      do while (watch%goes_on())
        call gpts_point(shp, xs, shp, dshp, d2shp, sample%xm, 1.0_wp, law, 0.0_wp, 1.0_wp, pass == 2, response, fe, ke, &
                        status)
      end do
      if (status /= ok .or. .not. response%gap < 0) error stop 'element_benchmarks: the pair is not closed'
      if (pass == 1) call put('interface point', name_of(ndm, p), 'residual [us]', 1.0e6_wp*watch%best)
      if (pass == 2) call put('interface point', name_of(ndm, p), 'residual and tangent [us]', 1.0e6_wp*watch%best)
    end do
  end subroutine measure_interface_kernel

  subroutine measure_projection(ndm, p)
    !! Closest point of one facet: from a first guess near by, and from none.
    integer, intent(in) :: ndm, p
    type(facet) :: sample
    type(stopwatch_type) :: watch
    type(projection_report) :: report
    real(wp), allocatable :: shp(:), dshp(:, :), d2shp(:, :), q(:, :)
    real(wp) :: xs(ndm), xi(ndm - 1)
    integer :: status

    call closed_pair(ndm, p, sample, shp, dshp, d2shp, xs)
    allocate (q(ndm + 1, size(sample%ce, 2)))
    call homogeneous_points(sample%we, sample%ce, sample%xm, q)
    call watch%begin()
    do while (watch%goes_on())
      xi = 0.41_wp
      call closest_point_of_bezier(sample%degree, q, xs, xi, report, status)
    end do
    if (status /= ok) error stop 'element_benchmarks: no projection'
    call put('interface point', name_of(ndm, p), 'projection, first guess at hand [us]', 1.0e6_wp*watch%best)
    call watch%begin()
    do while (watch%goes_on())
      call find_closest_point_global(sample%degree, sample%we, sample%ce, sample%xm, xs, xi, report, status)
    end do
    if (status /= ok) error stop 'element_benchmarks: no projection'
    call put('interface point', name_of(ndm, p), 'projection, none [us]', 1.0e6_wp*watch%best)
  end subroutine measure_projection
end module element_benchmarks
