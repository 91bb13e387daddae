program study_t_extraction
  !! Time of T-spline refinement and extraction, one mesh a call: study_t_extraction side|diagonal LEVELS.
  !! A rational ring of 16 x 16 cubic elements is halved LEVELS times each way along a side, or along the diagonal of its
  !! parameters. Prints functions, elements, different operators, and seconds of refinement, check of suitability, functions
  !! with control points, extraction.
  use, intrinsic :: iso_fortran_env, only: output_unit
  use kinds, only: wp
  use status_codes, only: ok
  use knot_vectors, only: open_knot_vector
  use nurbs_patch, only: nurbs_patch_type, create_patch
  use nurbs_refinement, only: elevate_degree, subdivide
  use grading, only: uniform_breaks
  use extraction_set, only: extraction_set_type
  use t_mesh, only: t_mesh_type, create_t_mesh
  use t_refinement, only: refine_cells, refine_box
  use t_suitability, only: check_suitability, crossing_type
  use t_spline, only: t_spline_type, t_elements_type, create_t_spline, t_spline_extraction
  implicit none (type, external)
  interface
    subroutine raise_stack_limit() bind(c, name='bezel_raise_stack_limit')
    end subroutine raise_stack_limit
  end interface
  type(nurbs_patch_type) :: patch
  type(t_mesh_type) :: mesh
  type(t_spline_type) :: spline
  type(t_elements_type) :: elements
  type(extraction_set_type) :: set
  type(crossing_type) :: crossing
  real(wp) :: began(5), w
  integer :: a, levels, status
  character(20) :: pattern, word

  call raise_stack_limit()     ! lists of a million functions pass over it
  call get_command_argument(1, pattern)
  call get_command_argument(2, word)
  read (word, *, iostat=status) levels
  if (status /= 0) error stop 'study_t_extraction side|diagonal LEVELS'

  w = sqrt(0.5_wp)
  call create_patch([open_knot_vector(1, [0.0_wp, 1.0_wp]), open_knot_vector(2, [0.0_wp, 1.0_wp])], reshape([ &
    1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, w, 2.0_wp, 2.0_wp, 0.0_wp, w, &
    0.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 1.0_wp], [4, 6]), patch, status)
  call elevate_degree(patch, 1, 2)
  call elevate_degree(patch, 2, 1)
  do a = 1, 2
    associate (breaks => uniform_breaks(0.0_wp, 1.0_wp, 16))
      call subdivide(patch, a, breaks(2:16), status)
    end associate
  end do
  call create_t_mesh(patch%knots(1:2), mesh, status)
  if (status /= ok) error stop 'the patch is bad'

  call cpu_time(began(1))
  if (pattern == 'side') then
    call refine_box(mesh, [0.0_wp, 0.0_wp], [1.0_wp, 1.0e-9_wp], levels, status)
  else
    call refine_diagonal(status)
  end if
  if (status /= ok) error stop 'the mesh cannot be refined'
  call cpu_time(began(2))
  call check_suitability(mesh, status, crossing)
  if (status /= ok) error stop 'the mesh is not suitable'
  call cpu_time(began(3))
  call create_t_spline(mesh, patch, spline, status)
  if (status /= ok) error stop 'the T-spline failed'
  call cpu_time(began(4))
  call t_spline_extraction(mesh, spline, [(a, a = 1, spline%n)], set, elements)
  call cpu_time(began(5))
  write (output_unit, '(3(i0,","),3(es11.4,","),es11.4)') spline%n, set%ne, set%nop, began(2:5) - began(1:4)

contains

  subroutine refine_diagonal(status)
    integer, intent(out) :: status
    integer, allocatable :: cells(:)
    real(wp) :: lo(2), hi(2)
    integer :: i, n, step

    status = ok
    do step = 1, 2*levels
      cells = mesh%leaves()
      n = 0
      do i = 1, size(cells)
        if (mesh%level(cells(i)) >= 2*levels) cycle
        call mesh%cell_box(cells(i), lo, hi)
        if (lo(1) >= hi(2) .or. lo(2) >= hi(1)) cycle
        n = n + 1
        cells(n) = cells(i)
      end do
      call refine_cells(mesh, cells(1:n), status)
      if (status /= ok) return
    end do
  end subroutine refine_diagonal
end program study_t_extraction
