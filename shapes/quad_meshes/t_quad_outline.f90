module t_quad_outline
  !! The rings of faces around extraordinary points, cut out of a quadrilateral mesh with
  !! T-junctions as a mesh without: with one ring of further faces around, whose knot intervals are
  !! the distances to the next lines. Seams belong to the mesh as it was first: when that is
  !! divided, they keep their length.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use growing_arrays, only: make_room
  use quad_mesh, only: quad_mesh_type, create_quad_mesh, set_crease
  use seam_lines, only: find_short_seams
  use spline_refinement, only: split_faces
  use t_quad_mesh, only: t_quad_mesh_type
  use t_quad_rays, only: star_type, star_of, is_irregular, two_lines, nearby
  implicit none (type, external)
  private
  public :: ring_mesh_type, create_ring_mesh, split_ring_mesh, spread_over

  type :: ring_mesh_type
    type(quad_mesh_type) :: mesh
    logical, allocatable :: zone(:)          !! faces at extraordinary points (nf)
    integer, allocatable :: local_face(:)    !! of each face, 0: not in the rings (nf)
    integer, allocatable :: local_vertex(:)  !! of each vertex, 0: not in the rings (nv)
    integer, allocatable :: half_edge(:)     !! of each corner, 0: put around (4*mesh%nf)
  end type ring_mesh_type

  !> faces and vertices that are put around
  type :: outline_type
    integer :: nv = 0                        !! vertices so far, those of the rings first
    integer :: nf = 0                        !! faces so far
    integer, allocatable :: local(:)         !! vertices of the rings: themselves (nv of the T-mesh)
    real(wp), allocatable :: x(:,:)          !! (3,nv)
    integer, allocatable :: corner(:)        !! vertices of the faces (4*nf)
    integer, allocatable :: half_edge(:)     !! (4*nf)
    real(wp), allocatable :: interval(:)     !! (4*nf)
    integer, allocatable :: start(:)         !! vertex put beyond the start of an edge (nh)
    integer, allocatable :: finish(:)        !! and beyond its end (nh)
    real(wp), allocatable :: reach(:)        !! interval there (nh)
  end type outline_type

contains

  subroutine create_ring_mesh(mesh, ring_mesh, message)
    !! Empty without extraordinary points.
    type(t_quad_mesh_type), intent(in) :: mesh           !! corners and intervals are known
    type(ring_mesh_type), intent(out) :: ring_mesh
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong

    type(outline_type) :: outline
    type(star_type) :: star
    logical :: at_zone(mesh%nv), in_rings(mesh%nf)
    integer :: c, f, h, k, v

    message = ''
    allocate (ring_mesh%zone(mesh%nf), source=.false.)
    allocate (ring_mesh%local_face(mesh%nf), ring_mesh%local_vertex(mesh%nv), source=0)
    at_zone = .false.
    do h = 1, mesh%nh
      call star_of(mesh, mesh%vertex(h), star)
      if (is_irregular(star)) ring_mesh%zone(mesh%face(h)) = .true.
    end do
    if (.not. any(ring_mesh%zone)) return
    call spread_over(mesh, ring_mesh%zone, at_zone, in_rings)
    call close_rings(mesh, in_rings)
    call check_rings(mesh, in_rings, message)
    if (len(message) > 0) return
    allocate (outline%local(mesh%nv), outline%start(mesh%nh), outline%finish(mesh%nh), source=0)
    allocate (outline%reach(mesh%nh), source=0.0_wp)
    allocate (outline%corner(0), outline%half_edge(0), outline%interval(0))
    ! vertices keep their numbers, for messages; many are unused
    outline%nv = mesh%nv
    allocate (outline%x, source=mesh%x)
    do f = 1, mesh%nf
      if (.not. in_rings(f)) cycle
      h = mesh%first(f)
      do k = 1, 4
        v = mesh%vertex(h)
        outline%local(v) = v
        h = mesh%next(h)
      end do
      call add_face(outline, outline%local(mesh%vertex(h:h+3)), mesh%interval(h:h+3), &
        [(h + k, k = 0, 3)])
      ring_mesh%local_face(f) = outline%nf
    end do
    ring_mesh%local_vertex = outline%local
    call put_around(mesh, in_rings, outline, message)
    if (len(message) > 0) return
    call create_quad_mesh(outline%x(:,1:outline%nv), reshape(outline%corner(1:4*outline%nf), &
      [4, outline%nf]), ring_mesh%mesh, message)
    if (len(message) > 0) error stop 't_quad_outline: the rings are no mesh'
    ring_mesh%mesh%interval = outline%interval(1:4*outline%nf)
    ring_mesh%half_edge = outline%half_edge(1:4*outline%nf)
    do c = 1, 4*outline%nf
      h = ring_mesh%half_edge(c)
      if (h == 0) cycle
      if (mesh%crease(h)) call crease_on(mesh, outline, ring_mesh%mesh, c, h)
    end do
    call find_short_seams(ring_mesh%mesh)
  end subroutine create_ring_mesh

  subroutine spread_over(mesh, zone, at_zone, near)
    type(t_quad_mesh_type), intent(in) :: mesh
    logical, intent(in) :: zone(:)               !! faces (nf)
    logical, intent(out) :: at_zone(:)           !! vertices of these faces (nv)
    logical, intent(out) :: near(:)              !! faces at these vertices (nf)

    integer :: h

    at_zone = .false.
    do h = 1, mesh%nh
      if (zone(mesh%face(h))) at_zone(mesh%vertex(h)) = .true.
    end do
    near = .false.
    do h = 1, mesh%nh
      if (at_zone(mesh%vertex(h))) near(mesh%face(h)) = .true.
    end do
  end subroutine spread_over

  subroutine split_ring_mesh(mesh, finer, ring_mesh, message)
    !! Every face in four, as split_t_faces does.
    type(t_quad_mesh_type), intent(in) :: mesh
    type(t_quad_mesh_type), intent(in) :: finer          !! the mesh after
    type(ring_mesh_type), intent(inout) :: ring_mesh
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong

    type(quad_mesh_type) :: split
    integer, allocatable :: half_edge(:), local_face(:), local_vertex(:)
    logical, allocatable :: zone(:)
    integer :: c, child, f, i, k

    message = ''
    allocate (zone(finer%nf), source=.false.)
    allocate (local_face(finer%nf), local_vertex(finer%nv), source=0)
    if (any(ring_mesh%zone)) then
      call split_faces(ring_mesh%mesh, split, message)
      if (len(message) > 0) return
      allocate (half_edge(4*split%nf), source=0)
      do f = 1, mesh%nf
        if (ring_mesh%local_face(f) == 0) cycle
        do k = 1, 4
          child = 4*(f - 1) + k
          zone(child) = ring_mesh%zone(f)
          local_face(child) = 4*(ring_mesh%local_face(f) - 1) + k
          do i = 1, 4
            c = 4*(local_face(child) - 1) + i
            half_edge(c) = finer%first(child) + i - 1
            local_vertex(finer%vertex(half_edge(c))) = split%vertex(c)
          end do
        end do
      end do
      call check_rings(finer, local_face > 0, message)
      ring_mesh%mesh = split
      call move_alloc(half_edge, ring_mesh%half_edge)
    end if
    call move_alloc(zone, ring_mesh%zone)
    call move_alloc(local_face, ring_mesh%local_face)
    call move_alloc(local_vertex, ring_mesh%local_vertex)
  end subroutine split_ring_mesh

  subroutine crease_on(mesh, outline, local, c, h)
    !! A crease, and its way on beyond the outline.
    type(t_quad_mesh_type), intent(in) :: mesh
    type(outline_type), intent(in) :: outline
    type(quad_mesh_type), intent(inout) :: local
    integer, intent(in) :: c, h                          !! corner, its half-edge

    character(:), allocatable :: message
    integer :: after, k, way

    local%crease(c) = .true.
    if (local%twin(c) > 0) local%crease(local%twin(c)) = .true.
    if (mesh%twin(h) == 0) return
    ! at its ends, where both faces beside it are in the rings and the faces beyond are not
    do way = 1, 2
      k = h
      if (way == 2) k = mesh%twin(h)
      after = mesh%next(k)
      if (outline%start(after) == 0) cycle
      call set_crease(local, outline%local(mesh%vertex(after)), outline%start(after), message)
    end do
  end subroutine crease_on

  subroutine close_rings(mesh, in_rings)
    !! The outline turns neither inwards nor touches itself: faces are added where it would.
    type(t_quad_mesh_type), intent(in) :: mesh
    logical, intent(inout) :: in_rings(:)

    type(star_type) :: star
    integer :: fans, k, n, v
    logical :: changed

    do
      changed = .false.
      do v = 1, mesh%nv
        if (mesh%out(v) == 0) cycle
        call star_of(mesh, v, star)
        associate (inside => in_rings(mesh%face(star%half_edge)))
          n = count(inside)
          fans = 0
          do k = 1, star%n
            if (inside(k) .and. .not. inside(modulo(k - 2, star%n) + 1)) fans = fans + 1
          end do
          if (.not. star%closed .and. n > 0 .and. inside(1) .and. inside(star%n) .and. &
            n < star%n) fans = fans + 1
        end associate
        if (n == 0 .or. n == star%n) cycle
        if (fans == 1 .and. n < 3) cycle
        do k = 1, star%n
          in_rings(mesh%face(star%half_edge(k))) = .true.
        end do
        changed = .true.
      end do
      if (.not. changed) exit
    end do
  end subroutine close_rings

  subroutine check_rings(mesh, in_rings, message)
    type(t_quad_mesh_type), intent(in) :: mesh
    logical, intent(in) :: in_rings(:)
    character(:), allocatable, intent(out) :: message

    integer :: f, h

    message = ''
    do f = 1, mesh%nf
      if (.not. in_rings(f) .or. mesh%first(f+1) - mesh%first(f) == 4) cycle
      do h = mesh%first(f), mesh%first(f+1) - 1
        if (.not. mesh%is_corner(h)) exit
      end do
      message = 'face ' // whole_number(f) // ' has a T-junction (vertex ' // &
        whole_number(mesh%vertex(h)) // ') and is too near to extraordinary point ' // &
        whole_number(nearest_point(mesh, mesh%vertex(h))) // &
        ': the faces at such a point and the next ring must be free of T-junctions'
      return
    end do
  end subroutine check_rings

  integer function nearest_point(mesh, v) result(point)
    !! Extraordinary point at the fewest edges from a vertex.
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: v

    type(star_type) :: star
    logical :: next(mesh%nv), reached(mesh%nv)
    integer :: h, round

    reached = .false.
    reached(v) = .true.
    point = 0
    do round = 1, mesh%nv
      do point = 1, mesh%nv
        if (.not. reached(point)) cycle
        call star_of(mesh, point, star)
        if (is_irregular(star)) return
      end do
      next = reached
      do h = 1, mesh%nh
        if (reached(mesh%vertex(h))) next(mesh%vertex(mesh%next(h))) = .true.
        if (reached(mesh%vertex(mesh%next(h)))) next(mesh%vertex(h)) = .true.
      end do
      reached = next
    end do
  end function nearest_point

  subroutine put_around(mesh, in_rings, outline, message)
    type(t_quad_mesh_type), intent(in) :: mesh
    logical, intent(in) :: in_rings(:)
    type(outline_type), intent(inout) :: outline
    character(:), allocatable, intent(inout) :: message

    real(wp) :: end_reach(mesh%nh), x(3)
    integer :: a, between, h, id, last, quadrants, u

    end_reach = 0
    do h = 1, mesh%nh
      if (.not. is_outline(h)) cycle
      outline%reach(h) = distance(mesh%vertex(h), h, -1)
      end_reach(h) = distance(mesh%vertex(mesh%next(h)), -h, 1)
      if (abs(outline%reach(h) - end_reach(h)) > nearby*outline%reach(h)) then
        message = 'the lines beyond face ' // whole_number(mesh%face(h)) // &
          ' are at different distances from vertices ' // whole_number(mesh%vertex(h)) // ' and ' &
          // whole_number(mesh%vertex(mesh%next(h))) // ', and extraordinary point ' // &
          whole_number(nearest_point(mesh, mesh%vertex(h))) // ' is near: T-junctions must be ' // &
          'farther away'
        return
      end if
    end do
    ! vertices beyond the starts of edges, and beyond the ends unless they are the same
    do h = 1, mesh%nh
      if (.not. is_outline(h)) cycle
      call beyond(h, x)
      call add_vertex(outline, mesh%x(:,mesh%vertex(h)) + x, id)
      outline%start(h) = id
    end do
    do h = 1, mesh%nh
      if (.not. is_outline(h)) cycle
      call turn_to_outline(h, last, quadrants)
      if (.not. is_outline(last) .or. quadrants /= 2) cycle
      outline%finish(last) = outline%start(h)
    end do
    do h = 1, mesh%nh
      if (.not. is_outline(h)) cycle
      u = mesh%vertex(mesh%next(h))
      call beyond(h, x)
      if (outline%finish(h) == 0) then
        call add_vertex(outline, mesh%x(:,u) + x, id)
        outline%finish(h) = id
      end if
      call add_face(outline, [outline%local(u), outline%local(mesh%vertex(h)), outline%start(h), &
        outline%finish(h)], [mesh%interval(h), outline%reach(h), mesh%interval(h), &
        outline%reach(h)], [0, 0, 0, 0])
    end do
    ! at corners of the outline
    do h = 1, mesh%nh
      if (.not. is_outline(h)) cycle
      call turn_to_outline(h, last, quadrants)
      if (.not. is_outline(last) .or. quadrants /= 1) cycle
      a = outline%local(mesh%vertex(h))
      call add_vertex(outline, outline%x(:,outline%start(h)) + outline%x(:,outline%finish(last)) &
        - outline%x(:,a), between)
      call add_face(outline, [a, outline%finish(last), between, outline%start(h)], &
        [outline%reach(last), outline%reach(h), outline%reach(last), outline%reach(h)], &
        [0, 0, 0, 0])
    end do

  contains

    logical function is_outline(h)
      !! Whether a face is put beyond an edge.
      integer, intent(in) :: h

      is_outline = in_rings(mesh%face(h)) .and. .not. mesh%crease(h)
      if (is_outline) is_outline = .not. in_rings(mesh%face(mesh%twin(h)))
    end function is_outline

    subroutine turn_to_outline(h, last, quadrants)
      !! From a half-edge of the outline, about its start, to the edge that arrives there.
      integer, intent(in) :: h
      integer, intent(out) :: last, quadrants

      integer :: e

      quadrants = 1
      e = mesh%previous(h)
      do
        last = e
        if (mesh%twin(e) == 0) return
        if (.not. in_rings(mesh%face(mesh%twin(e)))) return
        e = mesh%previous(mesh%twin(e))
        quadrants = quadrants + 1
      end do
    end subroutine turn_to_outline

    real(wp) function distance(v, edge, shift)
      !! To the next line along the ray next to an edge.
      integer, intent(in) :: v
      integer, intent(in) :: edge                !! leaves (> 0) or arrives (< 0)
      integer, intent(in) :: shift               !! of the ray: 1: counter-clockwise, -1: clockwise

      type(star_type) :: star
      real(wp) :: lines(2)
      integer :: k, leaving

      call star_of(mesh, v, star)
      leaving = edge
      if (edge < 0) then
        if (mesh%twin(-edge) > 0) leaving = mesh%twin(-edge)
      end if
      do k = 1, size(star%edge)
        if (star%edge(k) == leaving) exit
      end do
      k = k + shift
      if (star%closed) k = modulo(k - 1, star%n) + 1
      call two_lines(mesh, v, k, lines)
      distance = lines(1)
    end function distance

    subroutine beyond(h, x)
      !! Somewhere outside.
      integer, intent(in) :: h
      real(wp), intent(out) :: x(3)

      x = mesh%x(:,mesh%vertex(h)) - mesh%x(:,mesh%vertex(mesh%previous(h)))
    end subroutine beyond
  end subroutine put_around

  subroutine add_vertex(outline, x, id)
    type(outline_type), intent(inout) :: outline
    real(wp), intent(in) :: x(3)
    integer, intent(out) :: id

    outline%nv = outline%nv + 1
    id = outline%nv
    call make_room(outline%x, id)
    outline%x(:,id) = x
  end subroutine add_vertex

  subroutine add_face(outline, corner, interval, half_edge)
    type(outline_type), intent(inout) :: outline
    integer, intent(in) :: corner(4), half_edge(4)
    real(wp), intent(in) :: interval(4)

    integer :: n

    outline%nf = outline%nf + 1
    n = 4*outline%nf
    call make_room(outline%corner, n)
    call make_room(outline%half_edge, n)
    call make_room(outline%interval, n)
    outline%corner(n-3:n) = corner
    outline%half_edge(n-3:n) = half_edge
    outline%interval(n-3:n) = interval
  end subroutine add_face
end module t_quad_outline
