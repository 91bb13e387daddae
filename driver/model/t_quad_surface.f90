module t_quad_surface
  !! The surface of a QUADmesh with T-junctions: its elements and the pieces of its boundary.
  use kinds, only: wp
  use extraction_mesh, only: extraction_mesh_type
  use quad_mesh_draft, only: quad_draft
  use t_quad_mesh, only: t_quad_mesh_type
  use t_quad_rays, only: star_type, star_of, is_irregular
  use t_quad_intervals, only: find_intervals
  use t_quad_refinement, only: split_t_faces
  use t_quad_suitability, only: check_t_suitability
  use t_quad_outline, only: ring_mesh_type, create_ring_mesh, split_ring_mesh
  use t_quad_spline, only: t_quad_spline_type, create_t_quad_spline, t_quad_elements, elements_on_edge
  use t_quad_controls, only: t_controls_from_vertices
  use t_quad_following, only: follow_t_spline
  implicit none (type, external)
  private
  public :: build_t_surface

contains

  subroutine build_t_surface(new, mesh, elements, sides, first, message)
    type(quad_draft), intent(in) :: new
    type(extraction_mesh_type), intent(inout) :: mesh    !! without sets
    integer, allocatable, intent(out) :: elements(:)     !! along the boundary, piece by piece
    integer, allocatable, intent(out) :: sides(:)        !! theirs on the boundary
    integer, allocatable, intent(out) :: first(:)        !! of each piece, and one behind the last
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong
    type(t_quad_mesh_type) :: control, finer
    type(ring_mesh_type) :: rings
    type(t_quad_spline_type) :: finer_spline, spline
    integer, allocatable :: edge_elements(:), edge_sides(:), edges(:), starts(:)
    integer :: k, m

    control = new%t_mesh
    call find_intervals(control, new%t_given, message)
    if (len(message) > 0) return
    call create_ring_mesh(control, rings, message)
    if (len(message) > 0) return
    call check_t_suitability(control, message)
    if (len(message) > 0) return
    call create_t_quad_spline(control, rings, spline, message)
    if (len(message) > 0) return
    call t_controls_from_vertices(spline)
    do k = 1, new%refinements
      call split_t_faces(control, finer)
      call split_ring_mesh(control, finer, rings, message)
      if (len(message) > 0) return
      control = finer
      call create_t_quad_spline(control, rings, finer_spline, message)
      if (len(message) > 0) return
      call follow_t_spline(spline, finer_spline)
      spline = finer_spline
    end do
    call t_quad_elements(spline, mesh)
    call boundary_pieces(spline, edges, starts)
    allocate (elements(0), sides(0), first(0))
    do k = 1, size(starts) - 1
      first = [first, size(elements) + 1]
      do m = starts(k), starts(k + 1) - 1
        call elements_on_edge(spline, edges(m), edge_elements, edge_sides)
        elements = [elements, edge_elements]
        sides = [sides, edge_sides]
      end do
    end do
    first = [first, size(elements) + 1]
  end subroutine build_t_surface

  subroutine boundary_pieces(spline, edges, first)
    type(t_quad_spline_type), intent(in) :: spline
    integer, allocatable, intent(out) :: edges(:)     !! half-edges of the boundary, piece by piece
    integer, allocatable, intent(out) :: first(:)     !! of each piece, and one behind the last
    logical, allocatable :: seen(:)
    integer :: h, pass, v

    allocate (edges(0), first(0), seen(spline%mesh%nh))
    seen = spline%mesh%twin > 0
    ! pieces that begin at corners, then closed curves
    do pass = 1, 2
      do v = 1, spline%mesh%nv
        h = spline%mesh%out(v)
        if (h == 0) cycle
        if (seen(h)) cycle
        if (pass == 1 .and. .not. is_corner(v)) cycle
        do
          first = [first, size(edges) + 1]
          do
            seen(h) = .true.
            edges = [edges, h]
            h = spline%mesh%out(spline%mesh%vertex(spline%mesh%next(h)))
            if (seen(h)) exit
            if (is_corner(spline%mesh%vertex(h))) exit
          end do
          if (seen(h)) exit
        end do
      end do
    end do
    first = [first, size(edges) + 1]

  contains

    pure logical function is_corner(v)
      integer, intent(in) :: v                        !! vertex of the boundary
      real(wp), parameter :: bent = 1e-6_wp
      type(star_type) :: star
      integer :: local

      is_corner = spline%functions%vertex(v) > 0
      if (is_corner) return
      call star_of(spline%mesh, v, star)
      if (.not. is_irregular(star)) return
      local = spline%rings%local_vertex(v)
      associate (rings => spline%rings%spline%mesh)
        is_corner = abs(rings%angle(local)*rings%faces(local) - acos(-1.0_wp)) > bent
      end associate
    end function is_corner
  end subroutine boundary_pieces
end module t_quad_surface
