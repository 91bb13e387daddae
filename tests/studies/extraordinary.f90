program study_extraordinary
  !! Extraordinary points, as comma-separated lines: bending of polygons with a point of any valence in the middle against
  !! the square that is regular; the largest turn of the normal on disturbed surfaces; time of extraction.
  use, intrinsic :: iso_fortran_env, only: output_unit, int64
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type
  use unstructured_spline, only: unstructured_spline_type, create_spline, spline_mesh
  use spline_controls, only: controls_from_vertices
  use spline_refinement, only: refine_spline
  use extraction_mesh, only: extraction_mesh_type
  use facet_samples, only: random_stream
  use quad_mesh_samples, only: star, half_star, l_shape, box, half_box, cap, finer
  use spline_checks, only: look_at_edges, disturb, column_error
  use plate_projection, only: plate_errors, waves, bubble, solve_plate
  implicit none (type, external)
  integer :: n

  write (output_unit, '(a)') 'problem,mesh,faces,dofs,l2,h1,h2'
  do n = 3, 8
    call bending('free', 'star', star(n, 2))
  end do
  do n = 3, 5
    call bending('free', 'half_star', half_star(n, 2))
  end do
  call bending('free', 'l_shape', l_shape(2))
  call bending('free', 'compact', flat(finer(cap())))
  do n = 3, 6
    call bending('clamped', 'star', star(n, 2))
  end do
  write (output_unit, '(a)') 'surface,faces,points,gap,turn,sums'
  do n = 3, 8
    call smoothness('star', star(n, 3))
  end do
  call smoothness('box', box())
  call smoothness('half_box', finer(half_box()))
  call smoothness('compact', finer(cap()))
  write (output_unit, '(a)') 'elements,points,seconds'
  call times(finer(box()))

contains

  function flat(mesh) result(plane)
    type(quad_mesh_type), intent(in) :: mesh
    type(quad_mesh_type) :: plane

    plane = mesh
    plane%x(3,:) = 0
  end function flat

  subroutine start(mesh, spline)
    type(quad_mesh_type), intent(in) :: mesh
    type(unstructured_spline_type), intent(out) :: spline
    character(:), allocatable :: message

    call create_spline(mesh, spline, message)
    if (len(message) > 0) error stop 'study_extraordinary: a mesh makes no spline'
    call controls_from_vertices(spline)
  end subroutine start

  subroutine refine(spline)
    type(unstructured_spline_type), intent(inout) :: spline
    type(unstructured_spline_type) :: next
    character(:), allocatable :: message

    call refine_spline(spline, next, message)
    spline = next
  end subroutine refine

  subroutine bending(problem, name, mesh)
    character(*), intent(in) :: problem, name
    type(quad_mesh_type), intent(in) :: mesh
    type(unstructured_spline_type) :: spline
    type(plate_errors) :: errors
    type(bubble) :: clamped
    integer, parameter :: most = 2800
    integer :: valence

    call start(mesh, spline)
    valence = mesh%faces(1)
    do
      if (problem == 'free') then
        call solve_plate(spline, waves(), errors)
      else
        clamped%is_clamped = .true.
        clamped%sides = valence
        call solve_plate(spline, clamped, errors)
      end if
      write (output_unit, '(a,",",a,2(",",i0),3(",",es10.3))') problem, name, valence, errors%unknowns, errors%l2, &
        errors%h1, errors%h2
      if (3*spline%slots%n > most) exit
      call refine(spline)
    end do
  end subroutine bending

  subroutine smoothness(name, mesh)
    !! Control points moved at random by a tenth of a face.
    character(*), intent(in) :: name
    type(quad_mesh_type), intent(in) :: mesh
    type(unstructured_spline_type) :: spline
    type(extraction_mesh_type) :: extracted
    type(random_stream) :: stream
    real(wp) :: gap, turn

    call start(mesh, spline)
    call disturb(spline, 0.03_wp, stream)
    call look_at_edges(spline, gap, turn)
    call spline_mesh(spline, extracted)
    write (output_unit, '(a,2(",",i0),3(",",es9.2))') name, mesh%faces(1), spline%slots%n, gap, turn, column_error(extracted)
  end subroutine smoothness

  subroutine times(mesh)
    type(quad_mesh_type), intent(in) :: mesh
    type(unstructured_spline_type) :: spline, again
    type(extraction_mesh_type) :: extracted
    character(:), allocatable :: message
    integer(int64) :: began, ended, rate
    integer :: level

    call start(mesh, spline)
    do level = 1, 5
      call refine(spline)
      call system_clock(began, rate)
      call create_spline(spline%mesh, again, message)
      call spline_mesh(again, extracted)
      call system_clock(ended)
      write (output_unit, '(i0,",",i0,",",f8.3)') spline%mesh%nf, spline%slots%n, real(ended - began, wp)/rate
    end do
  end subroutine times
end program study_extraordinary
