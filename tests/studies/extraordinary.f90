program study_extraordinary
  !! Extraordinary points, as comma-separated lines: bending of polygons with a point of any valence in the middle against
  !! the square that is regular, and of meshes whose seams cross; the largest turn of the normal on disturbed surfaces;
  !! time of extraction.
  use, intrinsic :: iso_fortran_env, only: output_unit
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type
  use seam_lines, only: find_short_seams
  use unstructured_spline, only: unstructured_spline_type, create_spline, spline_mesh
  use spline_controls, only: controls_from_vertices
  use spline_refinement, only: refine_spline
  use extraction_mesh, only: extraction_mesh_type
  use facet_samples, only: random_stream
  use quad_mesh_samples, only: star, half_star, l_shape, box, half_box, cap, patchwork, framed, finer
  use spline_checks, only: look_at_edges, disturb, column_error
  use plate_projection, only: plate_errors, waves, bubble, parabola, solve_plate
  implicit none (type, external)
  character(*), parameter :: times_header = 'mesh,elements,points,seconds,bytes'
  type(quad_mesh_type) :: square
  type(random_stream) :: stream
  integer :: n

  square = patchwork(3, stream)
  select case (argument(1))
  case ('', 'bending')
    call all_bending()
  end select
  select case (argument(1))
  case ('', 'smoothness')
    call all_smoothness()
  end select
  select case (argument(1))
  case ('')
    write (output_unit, '(a)') times_header
    do n = 1, 5
      call times('box', finer(box()), n)
      call times('patchwork', square, n)
    end do
  case ('extraction')
    write (output_unit, '(a)') times_header
    call times('box', finer(box()), ichar(argument(2)) - ichar('0'))
  end select

contains

  function argument(i) result(word)
    !! Of the command line: which part (all: none), and how many refinements the extraction has.
    integer, intent(in) :: i
    character(16) :: word

    call get_command_argument(i, word)
  end function argument

  subroutine all_bending()
    write (output_unit, '(a)') 'problem,mesh,faces,dofs,l2,h1,h2'
    do n = 3, 8
      call bending('free', 'star', n, star(n, 2))
    end do
    do n = 3, 5
      call bending('free', 'half_star', n, half_star(n, 2))
    end do
    call bending('free', 'l_shape', 3, l_shape(2))
    do n = 3, 8
      if (n /= 4) call bending('free', 'short_star', n, with_short_seams(star(n, 2)))
    end do
    call bending('free', 'cap', 3, flat(finer(cap())))
    call bending('free', 'patchwork', maxval(square%faces), square)
    do n = 3, 6
      call bending('clamped', 'star', n, star(n, 2))
    end do
    call bending('clamped', 'framed', 6, framed(scaled(patchwork(2, stream), 2/3.0_wp), sqrt(0.5_wp)))
    call bending('clamped', 'patchwork', maxval(square%faces), square)
    call bending('curvature', 'star', 5, star(5, 2))
    call bending('curvature', 'short_star', 5, with_short_seams(star(5, 2)))
    call bending('curvature', 'cap', 3, flat(finer(cap())))
    call bending('curvature', 'patchwork', maxval(square%faces), square)
  end subroutine all_bending

  subroutine all_smoothness()
    write (output_unit, '(a)') 'surface,faces,points,gap,turn,sums'
    do n = 3, 8
      call smoothness('star', star(n, 3))
    end do
    call smoothness('box', box())
    call smoothness('half_box', finer(half_box()))
    call smoothness('cap', finer(cap()))
    call smoothness('patchwork', square)
  end subroutine all_smoothness

  function with_short_seams(mesh) result(local)
    type(quad_mesh_type), intent(in) :: mesh
    type(quad_mesh_type) :: local

    local = mesh
    call find_short_seams(local)
  end function with_short_seams

  function scaled(mesh, factor) result(smaller)
    type(quad_mesh_type), intent(in) :: mesh
    real(wp), intent(in) :: factor
    type(quad_mesh_type) :: smaller

    smaller = mesh
    smaller%x = factor*mesh%x
  end function scaled

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

  subroutine bending(problem, name, faces, mesh)
    character(*), intent(in) :: problem, name
    integer, intent(in) :: faces              !! at the point; the most of several
    type(quad_mesh_type), intent(in) :: mesh
    type(unstructured_spline_type) :: spline
    type(plate_errors) :: errors
    type(bubble) :: clamped
    integer :: level

    call start(mesh, spline)
    clamped%is_clamped = .true.
    clamped%sides = merge(faces, 4, name == 'star')
    do level = 1, 4
      select case (problem)
      case ('free');    call solve_plate(spline, waves(), errors)
      case ('clamped'); call solve_plate(spline, clamped, errors)
      case default;     call solve_plate(spline, parabola(), errors)
      end select
      write (output_unit, '(a,",",a,2(",",i0),3(",",es10.3))') problem, name, faces, errors%unknowns, errors%l2, &
        errors%h1, errors%h2
      if (level < 4) call refine(spline)
    end do
  end subroutine bending

  subroutine smoothness(name, mesh)
    !! Control points moved at random by a tenth of a face.
    character(*), intent(in) :: name
    type(quad_mesh_type), intent(in) :: mesh
    type(unstructured_spline_type) :: spline
    type(extraction_mesh_type) :: extracted
    real(wp) :: gap, turn

    call start(mesh, spline)
    call disturb(spline, 0.03_wp, stream)
    call look_at_edges(spline, gap, turn)
    call spline_mesh(spline, extracted)
    write (output_unit, '(a,2(",",i0),3(",",es9.2))') name, maxval(mesh%faces), spline%slots%n, gap, turn, &
      column_error(extracted)
  end subroutine smoothness

  subroutine times(name, mesh, levels)
    !! CPU time (the system's part included) from a control mesh, refined some times, to its extraction operators; their
    !! memory.
    character(*), intent(in) :: name
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: levels
    type(quad_mesh_type) :: fine
    type(unstructured_spline_type) :: spline
    type(extraction_mesh_type) :: extracted
    character(:), allocatable :: message
    real(wp) :: began, ended
    integer :: level

    fine = mesh
    do level = 1, levels
      fine = finer(fine)
    end do
    call cpu_time(began)
    call create_spline(fine, spline, message)
    call spline_mesh(spline, extracted)
    call cpu_time(ended)
    write (output_unit, '(a,2(",",i0),",",f0.3,",",i0)') name, fine%nf, spline%slots%n, ended - began, &
      extracted%elements%bytes()
  end subroutine times
end program study_extraordinary
