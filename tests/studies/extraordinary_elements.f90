program study_extraordinary_elements
  !! Shell elements around extraordinary points, as comma-separated lines: how many functions they have, and what their
  !! forces and tangents cost beside those of regular elements (CPU time, best of many calls, geometry prepared before).
  use, intrinsic :: iso_fortran_env, only: output_unit
  use kinds, only: wp
  use status_codes, only: ok
  use gauss_rules, only: tensor_rule
  use quad_mesh, only: quad_mesh_type
  use unstructured_spline, only: unstructured_spline_type, create_spline, spline_mesh
  use spline_controls, only: controls_from_vertices
  use extraction_mesh, only: extraction_mesh_type
  use shell_law, only: shell_law_type, define_shell_law
  use shell_kernel, only: shell_points, shell_force, shell_tangent, n_derivatives, n_frame
  use quad_mesh_samples, only: star, box, finer
  use facet_samples, only: random_stream, uniform
  use stopwatch, only: stopwatch_type
  implicit none (type, external)
  integer, parameter :: most = 200     !! functions of an element

  write (output_unit, '(a)') 'mesh,functions,degree,elements,preparation,residual,tangent'
  call measure('triangle', star(3, 8))
  call measure('pentagon', star(5, 8))
  call measure('hexagon', star(6, 8))
  call measure('octagon', star(8, 8))
  call measure('cube', finer(finer(finer(box()))))

contains

  subroutine measure(name, mesh)
    !! One element of each number of functions and degree.
    character(*), intent(in) :: name
    type(quad_mesh_type), intent(in) :: mesh
    type(unstructured_spline_type) :: spline
    type(extraction_mesh_type), target :: extracted
    character(:), allocatable :: message
    integer :: count(most), degree, e, n, sample(most)

    call create_spline(mesh, spline, message)
    if (len(message) > 0) error stop 'study_extraordinary_elements: a mesh makes no spline'
    call controls_from_vertices(spline)
    call spline_mesh(spline, extracted)
    do degree = 3, 4
      count = 0
      do e = 1, extracted%elements%ne
        if (maxval(extracted%elements%degree(1:2, e)) /= degree) cycle
        n = extracted%elements%nen(e)
        count(n) = count(n) + 1
        sample(n) = e
      end do
      do n = 1, most
        if (count(n) > 0) call measure_element(name, extracted, sample(n), count(n))
      end do
    end do
  end subroutine measure

  subroutine measure_element(name, mesh, e, count)
    !! St. Venant-Kirchhoff, degree + 1 Gauss points a direction.
    character(*), intent(in) :: name
    type(extraction_mesh_type), intent(in), target :: mesh
    integer, intent(in) :: e, count              !! element, how many are like it
    type(shell_law_type) :: law
    type(random_stream) :: stream
    type(stopwatch_type) :: watch
    real(wp), allocatable :: area(:), dshp(:, :, :), fe(:, :), frame(:, :), ke(:, :, :, :), shp(:, :), ue(:, :), we(:), &
      wt(:), xe(:, :), xi(:, :)
    integer, pointer, contiguous :: ix(:)
    real(wp), pointer, contiguous :: ce(:, :)
    real(wp) :: energy, preparation, residual, thickness
    integer :: a, degree(2), i, nen, ng, status

    ix => mesh%elements%connectivity(e)
    ce => mesh%elements%operator(e)
    degree = mesh%elements%degree(1:2, e)
    nen = size(ix)
    ng = product(degree + 1)
    allocate (area(ng), dshp(n_derivatives, nen, ng), frame(n_frame, ng), shp(nen, ng), wt(ng), xi(2, ng))
    allocate (fe(3, nen), ke(3, nen, 3, nen), ue(3, nen), we(nen), xe(3, nen))
    xe = mesh%x(:, ix)
    we = mesh%w(ix)
    call tensor_rule(degree + 1, xi, wt)
    watch%budget = 0.1_wp
    call watch%begin()
    do while (watch%goes_on())
      call shell_points(degree, xe, we, ce, xi, wt, shp, dshp, frame, area, status)
    end do
    preparation = watch%best
    if (status /= ok) error stop 'study_extraordinary_elements: a mesh has a fault'
    thickness = sqrt(sum(area))/10
    do a = 1, nen
      do i = 1, 3
        ue(i, a) = uniform(stream, -0.1_wp, 0.1_wp)*thickness
      end do
    end do
    call define_shell_law(1.0_wp, 0.3_wp, thickness, .false., law, status)
    call watch%begin()
    do while (watch%goes_on())
      call shell_force(dshp, frame, area, ue, law, fe, energy, status)
    end do
    residual = watch%best
    call watch%begin()
    do while (watch%goes_on())
      call shell_tangent(dshp, frame, area, ue, law, fe, ke, energy, status)
    end do
    if (status /= ok) error stop 'study_extraordinary_elements: an element fails'
    write (output_unit, '(a,3(",",i0),3(",",f0.3))') name, nen, maxval(degree), count, 1e6_wp*preparation, &
      1e6_wp*residual, 1e6_wp*watch%best
  end subroutine measure_element
end program study_extraordinary_elements
