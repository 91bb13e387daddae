module quad_mesh_commands
  !! QUADmesh: a smooth surface over a mesh of quadrilaterals of any topology, with extraordinary
  !! points (see unstructured_spline).
  !!
  !!     QUADmesh name [FILE="name.obj"] [MATErial=m] [BODY=b]
  !!       VERTices n                   then n lines x y [z]
  !!       FACEs n                      then n lines v1 v2 v3 v4 ..., counter-clockwise
  !!       CREAse v1 v2 [v3 ...]        the edges v1-v2, v2-v3 ... are not smooth
  !!       INTErval v1 v2 d             knot interval of the edge v1-v2 and of all edges of its strip of faces (1)
  !!       TRANslate dx dy [dz]         moves the vertices
  !!       ROTAte angle [ax ay az]      turns them about an axis through the origin (z), in degrees
  !!       SCALe s                      multiplies their coordinates
  !!       REFIne n                     every face becomes four, n times
  !!       REFIne BOX x1 x2 y1 y2 [z1 z2] LEVEls=n      elements that reach into a box in space, n times more
  !!       REFIne VERTex v DISTance=d LEVEls=n          elements nearer than d to a vertex
  !!       SPHEre x y z r [SYMMetric]   control points move so that the surface follows this sphere
  !!       SWEEp vx vy vz DEGRee=r ELEMents=n [RATIo=q]   the surface becomes a solid along a vector
  !!
  !! The mesh is in the file or in VERTices and FACEs, which come first; a blank line ends the data set. Faces of more than
  !! four vertices have T-junctions (see t_quad_corners, t_quad_intervals, t_quad_spline); with them REFIne divides the
  !! faces of the control mesh, and there is no local refinement. Vertices are the
  !! control points where the mesh is regular; on the boundary and on creases the surface's curves have the vertices as
  !! control points and run through corners. REFIne leaves bicubic parts as they are; a mesh that has to be refined before
  !! it makes a surface (two extraordinary points in one face) is refined between its vertices first. BOX and VERTex refine
  !! locally what the other lines made (see local_refinement), also several of them. The sphere is approached on
  !! every one of the meshes; boundary curves whose control points agree in a coordinate keep it.
  !!
  !! One element a face, or a part of it. Sets made: elements NAME, surfaces NAME.boundary (all open edges) and NAME.edge1,
  !! NAME.edge2, ...: pieces of the boundary between its corners, in the direction that has the surface on its left; the
  !! first begins at the corner of the lowest number (without corners: at the lowest vertex). A solid has these sides, NAME.back
  !! (the surface) and NAME.front (where it ends).
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use messages, only: message_log, quoted, in_place, whole_text
  use deck_record, only: record
  use deck_reader, only: deck_type => deck
  use model_data, only: model_type, set_elements, set_surface
  use model_sets, only: add_set, find_set
  use mesh_draft, only: draft_type
  use data_lines, only: next_line
  use element_commands, only: begin_origin
  use quad_bodies, only: quad_body, add_quad_body
  use quad_mesh_draft, only: quad_draft
  use quad_mesh_lines, only: read_quad_file, carry_out_quad_line
  use t_quad_surface, only: build_t_surface
  use extraction_mesh, only: extraction_mesh_type
  use quad_mesh, only: quad_mesh_type, next_corner
  use unstructured_spline, only: unstructured_spline_type, create_spline
  use spline_controls, only: controls_from_vertices
  use spline_refinement, only: split_faces, refine_spline
  use local_refinement, only: local_spline_type, refine_locally, local_mesh, local_sides
  use refinement_zones, only: zones_type
  use side_extraction, only: side_operator, side_functions
  use surface_fit, only: fit_surface
  use linear_rows, only: linear_rows_type
  use right_angles, only: add_right_angle
  use sphere_target, only: sphere_type
  use t_sweep, only: sweep_type
  use tie_nodes, only: coinciding_nodes
  implicit none (type, external)
  private
  public :: read_quad_mesh

  integer, parameter :: fit_rounds = 8

contains

  subroutine read_quad_mesh(deck, command, model, draft, log)
    type(deck_type), intent(inout) :: deck
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(quad_draft) :: new
    type(record) :: rec
    type(extraction_mesh_type), target :: mesh
    character(:), allocatable :: file, message, name
    integer, allocatable :: elements(:), first(:), sides(:)
    integer :: body, error_count, material, old
    logical :: more

    error_count = log%error_count()
    material = 1
    body = 1
    file = ''
    call command%text(2, name, log, 'name of the mesh')
    call command%text_option('file', file, log)
    call command%integer_option('material', material, log)
    call command%integer_option('body', body, log)
    call command%check_options([character(8) :: 'file', 'material', 'body'], log)
    if (body < 1) call command%add_error(log, 'bodies are numbered from 1', '')
    old = find_set(model, name)
    if (old > 0) call command%add_error(log, 'the name ' // quoted(name) // ' is taken', 'See ' // model%sets(old)%place)
    if (len(file) > 0 .and. log%error_count() == error_count) call read_quad_file(command, file, model%ndm, new, log)
    do
      call next_line(deck, rec, log, more)
      if (.not. more) exit
      if (rec%is_damaged) cycle
      if (log%error_count() == error_count) call carry_out_quad_line(deck, rec, model%ndm, new, log)
      if (log%error_count() == error_count) cycle
      call deck%skip_set(rec, log)
      exit
    end do
    if (log%error_count() == error_count .and. .not. new%is_built) call command%add_error(log, &
      'the mesh has no faces', 'Give FILE="name.obj", or VERTices and FACEs')
    if (log%error_count() == error_count) then
      if (.not. new%has_t_junctions) call warn_of_doubled_vertices(new%mesh, command, log)
      if (new%has_t_junctions) then
        call build_t_surface(new, mesh, elements, sides, first, message)
      else
        call build_surface(new, mesh, elements, sides, first, message)
      end if
      if (len(message) > 0) call command%add_error(log, message, '')
    end if
    if (log%error_count() > error_count) then
      ! its sets are known all the same, so that there is no second message for each use of them
      if (old == 0) call add_set(model, name, in_place(command%at), set_elements, [integer ::], [integer ::])
      draft%has_lost_sets = .true.
      return
    end if
    if (new%on_sphere) call fit(new%sphere, new%is_symmetric, elements, sides, first, mesh)
    call begin_origin(draft, command, 'QUADmesh', name)
    call add_to_mesh(mesh, elements, sides, first, new%sweep, name, material, body, command, model, draft, log)
  end subroutine read_quad_mesh

  subroutine warn_of_doubled_vertices(mesh, command, log)
    !! Two boundary vertices at one place: files that give each face its own vertices make a surface of loose parts.
    type(quad_mesh_type), intent(in) :: mesh
    type(record), intent(in) :: command
    type(message_log), intent(inout) :: log
    real(wp), parameter :: rounding = 1e-9_wp      !! of the mesh's size
    integer, allocatable :: group(:), map(:)
    integer :: different, v
    character(40) :: numbers

    allocate (group(mesh%nv), map(mesh%nv))
    do v = 1, mesh%nv
      group(v) = merge(1, 0, mesh%is_boundary(v))
    end do
    call coinciding_nodes(mesh%x, [(1.0_wp, v=1, mesh%nv)], group, rounding*maxval(abs(mesh%x)), map, different)
    do v = 1, mesh%nv
      if (map(v) == v) cycle
      write (numbers, '(i0,a,i0)') map(v), ' and ', v
      call command%add_warning(log, 'vertices ' // trim(numbers) // ' lie on each other on the boundary: the surface is '// &
        'open between them', 'Where it should go on, let the faces name the same vertex')
      return
    end do
  end subroutine warn_of_doubled_vertices

  subroutine build_surface(new, mesh, elements, sides, first, message)
    type(quad_draft), intent(inout) :: new
    type(extraction_mesh_type), intent(inout) :: mesh    !! without sets
    integer, allocatable, intent(out) :: elements(:)     !! along the boundary, piece by piece
    integer, allocatable, intent(out) :: sides(:)        !! theirs on the boundary
    integer, allocatable, intent(out) :: first(:)        !! of each piece, and one behind the last
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong
    type(unstructured_spline_type) :: spline
    type(local_spline_type) :: local

    call build(new, spline, message)
    if (len(message) == 0) call refine_locally(spline, new%zones, new%zones%most_levels(), local, message)
    if (len(message) > 0) return
    call local_mesh(local, mesh)
    call elements_on_boundary(local, elements, sides, first)
  end subroutine build_surface

  subroutine elements_on_boundary(local, elements, sides, first)
    type(local_spline_type), intent(in) :: local
    integer, allocatable, intent(out) :: elements(:), sides(:), first(:)
    integer, allocatable :: edge_elements(:), edge_sides(:), edges(:), starts(:)
    integer :: k, m

    call boundary_pieces(local%levels(1)%spline, edges, starts)
    allocate (elements(0), sides(0), first(0))
    do k = 1, size(starts) - 1
      first = [first, size(elements) + 1]
      do m = starts(k), starts(k + 1) - 1
        call local_sides(local, edges(m), edge_elements, edge_sides)
        elements = [elements, edge_elements]
        sides = [sides, edge_sides]
      end do
    end do
    first = [first, size(elements) + 1]
  end subroutine elements_on_boundary

  subroutine build(new, spline, message)
    type(quad_draft), intent(inout) :: new
    type(unstructured_spline_type), intent(out) :: spline
    character(:), allocatable, intent(out) :: message
    type(unstructured_spline_type) :: finer
    type(quad_mesh_type) :: split
    integer :: left

    left = new%refinements
    do
      call create_spline(new%mesh, spline, message)
      if (len(message) == 0 .or. left == 0) exit
      call split_faces(new%mesh, split, message)
      new%mesh = split
      left = left - 1
    end do
    if (len(message) > 0) return
    call controls_from_vertices(spline)
    do
      if (new%on_sphere) call fit_spline(new%sphere, new%is_symmetric, spline, message)
      if (left == 0 .or. len(message) > 0) exit
      call refine_spline(spline, finer, message)
      if (len(message) > 0) return
      spline = finer
      left = left - 1
    end do
  end subroutine build

  subroutine fit_spline(sphere, is_symmetric, spline, message)
    type(sphere_type), intent(in) :: sphere
    logical, intent(in) :: is_symmetric
    type(unstructured_spline_type), intent(inout) :: spline
    character(:), allocatable, intent(inout) :: message
    type(local_spline_type) :: local
    type(extraction_mesh_type), target :: mesh
    type(zones_type) :: nowhere
    integer, allocatable :: elements(:), first(:), sides(:)

    call refine_locally(spline, nowhere, 0, local, message)
    if (len(message) > 0) return
    call local_mesh(local, mesh)
    call elements_on_boundary(local, elements, sides, first)
    call fit(sphere, is_symmetric, elements, sides, first, mesh)
    spline%cp = mesh%x
  end subroutine fit_spline

  subroutine fit(sphere, is_symmetric, elements, sides, first, mesh)
    type(sphere_type), intent(in) :: sphere
    logical, intent(in) :: is_symmetric               !! pieces in coordinate planes through the centre meet these at right angles
    integer, intent(in) :: elements(:), sides(:), first(:)   !! pieces of the boundary
    type(extraction_mesh_type), intent(inout), target :: mesh
    logical, allocatable :: held(:, :), on_piece(:)
    type(linear_rows_type) :: rows(3)
    real(wp) :: size_of, x(mesh%nn)
    integer :: i, k, m

    allocate (held(3, mesh%nn), source=.false.)
    allocate (on_piece(mesh%nn))
    size_of = maxval(abs(mesh%x))
    do k = 1, size(first) - 1
      on_piece = .false.
      do m = first(k), first(k+1) - 1
        call mark_side(mesh, elements(m), sides(m), on_piece)
      end do
      do i = 1, 3
        if (maxval(mesh%x(i, :), mask=on_piece) - minval(mesh%x(i, :), mask=on_piece) < 1e-9_wp*size_of) &
          held(i, :) = held(i, :) .or. on_piece
      end do
    end do
    on_piece = .false.
    do m = 1, size(elements)
      on_piece(mesh%elements%connectivity(elements(m))) = .true.
    end do
    do i = 1, 3
      call rows(i)%start(.not. held(i, :) .and. on_piece)
    end do
    if (is_symmetric) then
      do m = 1, size(elements)
        on_piece = .false.
        call mark_side(mesh, elements(m), sides(m), on_piece)
        do i = 1, 3
          if (maxval(abs(mesh%x(i, :) - sphere%centre(i)), mask=on_piece) < 1e-9_wp*size_of) &
            call add_right_angle(mesh, elements(m), sides(m), i, rows)
        end do
      end do
      do i = 1, 3
        x = mesh%x(i, :) - sphere%centre(i)
        call rows(i)%finish()
        call rows(i)%project(x)
        mesh%x(i, :) = x + sphere%centre(i)
      end do
    end if
    call fit_surface(mesh, sphere, held, rows, fit_rounds)
  end subroutine fit

  subroutine mark_side(mesh, e, side, marked)
    type(extraction_mesh_type), intent(in), target :: mesh
    integer, intent(in) :: e, side
    logical, intent(inout) :: marked(:)            !! nodes whose functions do not vanish on the side, and others before
    integer, pointer, contiguous :: ix(:)
    real(wp), pointer, contiguous :: ce(:, :)
    real(wp), allocatable :: ce_side(:, :)
    integer, allocatable :: rows(:)
    integer :: n, side_degree(1)

    ix => mesh%elements%connectivity(e)
    ce => mesh%elements%operator(e)
    allocate (rows(size(ix)), ce_side(size(ix), side_functions(mesh%elements%degree(1:2, e), side)))
    call side_operator(mesh%elements%degree(1:2, e), ce, side, side_degree, n, rows, ce_side)
    marked(ix(rows(1:n))) = .true.
  end subroutine mark_side

  subroutine boundary_pieces(spline, edges, first)
    type(unstructured_spline_type), intent(in) :: spline
    integer, allocatable, intent(out) :: edges(:)     !! corners that open edges start from, piece by piece
    integer, allocatable, intent(out) :: first(:)     !! of each piece, and one behind the last
    logical, allocatable :: seen(:)
    integer :: c, v, pass

    allocate (edges(0), first(0), seen(4*spline%mesh%nf))
    seen = spline%mesh%twin > 0
    ! pieces that begin at corners, then closed curves
    do pass = 1, 2
      do v = 1, spline%mesh%nv
        if (.not. spline%mesh%is_boundary(v)) cycle
        if (pass == 1 .and. .not. is_corner(v)) cycle
        c = spline%mesh%corner(v)
        if (seen(c)) cycle
        do
          first = [first, size(edges) + 1]
          do
            seen(c) = .true.
            edges = [edges, c]
            c = spline%mesh%corner(spline%mesh%vertex(next_corner(c)))
            if (seen(c)) exit
            if (is_corner(spline%mesh%vertex(c))) exit
          end do
          if (seen(c)) exit
        end do
      end do
    end do
    first = [first, size(edges) + 1]

  contains

    logical function is_corner(v)
      integer, intent(in) :: v                        !! vertex of the boundary
      real(wp) :: bend

      bend = abs(spline%mesh%angle(v)*spline%mesh%faces(v) - acos(-1.0_wp))
      is_corner = spline%slots%vertex(v) > 0 .or. (spline%slots%plane(v) > 0 .and. bend > 1e-6_wp)
    end function is_corner
  end subroutine boundary_pieces

  subroutine add_to_mesh(mesh, elements, sides, first, sweep, name, material, body, command, model, draft, log)
    type(extraction_mesh_type), intent(in), target :: mesh
    integer, intent(in) :: elements(:), sides(:), first(:)   !! pieces of the boundary
    type(sweep_type), allocatable, intent(in) :: sweep
    character(*), intent(in) :: name
    integer, intent(in) :: material, body
    type(record), intent(in) :: command
    type(model_type), intent(inout) :: model
    type(draft_type), intent(inout) :: draft
    type(message_log), intent(inout) :: log
    type(quad_body) :: added
    integer :: e, k, status

    call add_quad_body(mesh, sweep, model, draft, added, status)
    if (status /= ok) call command%add_error(log, status_text(status), 'Sweep fewer elements')
    call draft%note_elements(added%first, added%last, material, body, command%at)
    call add_set(model, name, in_place(command%at), set_elements, [(e, e = added%first, added%last)], [integer ::])
    call add_edges('.boundary', 1, size(elements))
    do k = 1, size(first) - 1
      call add_edges('.edge' // whole_text(k), first(k), first(k+1) - 1)
    end do
    if (.not. allocated(sweep)) return
    call add_set(model, name // '.back', in_place(command%at), set_surface, added%layer(1), spread(5, 1, added%flat))
    call add_set(model, name // '.front', in_place(command%at), set_surface, added%layer(added%layers), &
      spread(6, 1, added%flat))

  contains

    subroutine add_edges(ending, from, to)
      character(*), intent(in) :: ending
      integer, intent(in) :: from, to                 !! in the list of the boundary
      integer :: i

      call add_set(model, name // ending, in_place(command%at), set_surface, added%through_layers(elements(from:to)), &
        [(sides(from:to), i = 1, added%layers)])
    end subroutine add_edges
  end subroutine add_to_mesh
end module quad_mesh_commands
