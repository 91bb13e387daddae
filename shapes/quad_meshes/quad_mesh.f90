module quad_mesh
  !! Quadrilateral control meshes of any topology: which faces meet at edges and vertices, knot
  !! intervals, creases, and what is wrong with them.
  !!
  !! Face f has the corners 4(f-1)+1 ... 4(f-1)+4, counter-clockwise. A corner c stands for three
  !! things: the place of its face at a vertex, the vertex, and the edge that runs from it to the
  !! next corner of the face. `twin(c)` is the same edge seen from the other face, 0 on the
  !! boundary. Turning about a vertex counter-clockwise leads from c to twin(previous(c)).
  !!
  !! Every edge has a knot interval; opposite edges of a face have the same, so that intervals
  !! belong to strips of faces. Creases are edges across which the surface is only continuous;
  !! the boundary is treated alike.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use half_edges, only: pair_half_edges
  implicit none (type, external)
  private
  public :: quad_mesh_type, create_quad_mesh, set_interval, set_crease, find_edge, next_corner, &
    previous_corner, face_of

  real(wp), parameter :: pi = acos(-1.0_wp)

  type :: quad_mesh_type
    integer :: nv = 0                        !! vertices
    integer :: nf = 0                        !! faces
    real(wp), allocatable :: x(:,:)          !! vertices (3,nv) [length]
    integer, allocatable :: vertex(:)        !! of each corner (4*nf)
    integer, allocatable :: twin(:)          !! corner of the other face at the edge, 0: none
    real(wp), allocatable :: interval(:)     !! knot interval of the edge (4*nf)
    logical, allocatable :: crease(:)        !! edges not smooth, boundary edges among them (4*nf)
    logical :: has_seams = .false.           !! whether seams have been laid (see seam_lines)
    logical, allocatable :: seam(:)          !! edges on seams (4*nf)
    real(wp), allocatable :: gluing(:,:)     !! A of the seam at both ends of the edge (2,4*nf)
    real(wp), allocatable :: bend(:)         !! factor of the edge's parameter squared in A (4*nf)
    logical, allocatable :: fades(:,:)       !! whether a short seam ends at the start and the end
                                             !! of the edge (2,4*nf)
    real(wp), allocatable :: angle(:)        !! between neighbouring edges of an extraordinary point
                                             !! in its tangent plane (nv) [rad]
    integer, allocatable :: corner(:)        !! a corner at each vertex: on the boundary the first
                                             !! one counter-clockwise; 0: unused (nv)
    integer, allocatable :: faces(:)         !! faces at each vertex (nv)
  contains
    procedure :: across                      !! interval beyond an edge
    procedure :: is_open                     !! whether an edge is a crease or on a seam
    procedure :: turn                        !! next corner about a vertex
    procedure :: is_boundary
    procedure :: is_extraordinary
    procedure :: is_star
  end type quad_mesh_type

contains

  pure integer function next_corner(c)
    integer, intent(in) :: c        !! corner

    next_corner = merge(c - 3, c + 1, mod(c, 4) == 0)
  end function next_corner

  pure integer function previous_corner(c)
    integer, intent(in) :: c        !! corner

    previous_corner = merge(c + 3, c - 1, mod(c, 4) == 1)
  end function previous_corner

  pure integer function face_of(c)
    integer, intent(in) :: c        !! corner

    face_of = (c + 3) / 4
  end function face_of

  pure real(wp) function across(self, c)
    !! Length of the knot interval that follows beyond an edge; 0 at creases,
    !! seams and the boundary.
    class(quad_mesh_type), intent(in) :: self
    integer, intent(in) :: c        !! corner that the edge starts from

    across = 0
    if (.not. self%is_open(c)) across = self%interval(next_corner(self%twin(c)))
  end function across

  pure elemental logical function is_open(self, c)
    class(quad_mesh_type), intent(in) :: self
    integer, intent(in) :: c        !! corner that the edge starts from

    is_open = self%crease(c) .or. self%seam(c)
  end function is_open

  pure integer function turn(self, c)
    class(quad_mesh_type), intent(in) :: self
    integer, intent(in) :: c        !! corner

    turn = self%twin(previous_corner(c))   ! 0: the boundary
  end function turn

  pure logical function is_boundary(self, v)
    class(quad_mesh_type), intent(in) :: self
    integer, intent(in) :: v        !! vertex

    is_boundary = .false.
    if (self%corner(v) > 0) is_boundary = self%twin(self%corner(v)) == 0
  end function is_boundary

  pure logical function is_extraordinary(self, v)
    !! A smooth inner vertex of other than four faces.
    class(quad_mesh_type), intent(in) :: self
    integer, intent(in) :: v        !! vertex

    integer :: c, k

    is_extraordinary = .false.
    if (self%faces(v) == 0 .or. self%faces(v) == 4) return
    c = self%corner(v)
    do k = 1, self%faces(v)
      if (self%crease(c)) return
      c = self%turn(c)
      if (c == 0) return
    end do
    is_extraordinary = .true.
  end function is_extraordinary

  pure logical function is_star(self, v)
    !! An extraordinary point, or a vertex of more than two faces on the boundary without further
    !! creases.
    class(quad_mesh_type), intent(in) :: self
    integer, intent(in) :: v        !! vertex

    integer :: c, k

    is_star = self%is_extraordinary(v)
    if (is_star .or. self%faces(v) < 3 .or. .not. self%is_boundary(v)) return
    c = self%turn(self%corner(v))
    do k = 2, self%faces(v)
      if (self%crease(c)) return
      c = self%turn(c)
    end do
    is_star = .true.
  end function is_star

  pure subroutine create_quad_mesh(x, faces, mesh, message)
    !! All intervals 1, no creases but the boundary.
    real(wp), intent(in) :: x(:,:)                     !! vertices (3,nv) [length]
    integer, intent(in) :: faces(:,:)                  !! their vertices, counter-clockwise (4,nf)
    type(quad_mesh_type), intent(out) :: mesh
    character(:), allocatable, intent(out) :: message  !! what is wrong; empty: nothing

    integer :: f, k, v

    message = ''
    mesh%nv = size(x, 2)
    mesh%nf = size(faces, 2)
    allocate (mesh%x, source=x)
    allocate (mesh%vertex(4*mesh%nf), source=reshape(faces, [4*mesh%nf]))
    allocate (mesh%twin(4*mesh%nf), source=0)
    allocate (mesh%interval(4*mesh%nf), source=1.0_wp)
    allocate (mesh%crease(4*mesh%nf), mesh%seam(4*mesh%nf), mesh%fades(2,4*mesh%nf), source=.false.)
    allocate (mesh%gluing(2,4*mesh%nf), mesh%bend(4*mesh%nf), source=0.0_wp)
    allocate (mesh%corner(mesh%nv), mesh%faces(mesh%nv), source=0)
    allocate (mesh%angle(mesh%nv), source=0.0_wp)
    if (mesh%nf == 0) message = 'the mesh has no faces'
    do f = 1, mesh%nf
      do k = 1, 4
        v = faces(k,f)
        if (v < 1 .or. v > mesh%nv) then
          message = 'face ' // whole_number(f) // ' names vertex ' // whole_number(v) // &
            ', but vertices are numbered from 1 to ' // whole_number(mesh%nv)
        else if (any(faces(1:k-1,f) == v)) then
          message = 'face ' // whole_number(f) // ' names vertex ' // whole_number(v) // &
            ' twice: it is not a quadrilateral'
        end if
        if (len(message) > 0) return
      end do
    end do
    call find_twins(mesh, message)
    if (len(message) > 0) return
    mesh%crease = mesh%twin == 0
    call find_fans(mesh, message)
    if (len(message) > 0) return
    do v = 1, mesh%nv
      if (mesh%faces(v) == 0) cycle
      mesh%angle(v) = 2*pi/mesh%faces(v)
      if (mesh%is_boundary(v)) mesh%angle(v) = boundary_angle(mesh, v)/mesh%faces(v)
    end do
  end subroutine create_quad_mesh

  pure real(wp) function boundary_angle(mesh, v)
    !! Sum of the angles of the faces at a vertex of the boundary, which passes for straight unless
    !! it is clearly bent.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: v                     !! vertex

    real(wp), parameter :: nearly_straight = pi/6
    real(wp) :: a(3), b(3), cosine
    integer :: c, k

    boundary_angle = 0
    c = mesh%corner(v)
    do k = 1, mesh%faces(v)
      a = mesh%x(:,mesh%vertex(next_corner(c))) - mesh%x(:,v)
      b = mesh%x(:,mesh%vertex(previous_corner(c))) - mesh%x(:,v)
      cosine = 0
      if (norm2(a)*norm2(b) > 0) cosine = dot_product(a, b)/(norm2(a)*norm2(b))
      boundary_angle = boundary_angle + acos(min(max(cosine, -1.0_wp), 1.0_wp))
      c = mesh%turn(c)
    end do
    if (abs(boundary_angle - pi) < nearly_straight) boundary_angle = pi
  end function boundary_angle

  pure subroutine find_twins(mesh, message)
    type(quad_mesh_type), intent(inout) :: mesh
    character(:), allocatable, intent(inout) :: message

    integer :: c, face(4*mesh%nf), next(4*mesh%nf)

    do c = 1, 4*mesh%nf
      face(c) = face_of(c)
      next(c) = next_corner(c)
    end do
    call pair_half_edges(mesh%nv, mesh%vertex, next, face, mesh%twin, message)
  end subroutine find_twins

  pure subroutine find_fans(mesh, message)
    !! One fan of faces at each vertex, and enough of them.
    type(quad_mesh_type), intent(inout) :: mesh
    character(:), allocatable, intent(inout) :: message

    integer :: c, k, n, start, v

    do c = 1, 4*mesh%nf
      v = mesh%vertex(c)
      mesh%faces(v) = mesh%faces(v) + 1
      if (mesh%corner(v) == 0 .or. mesh%twin(c) == 0) mesh%corner(v) = c
    end do
    do v = 1, mesh%nv
      start = mesh%corner(v)
      if (start == 0) cycle
      n = 1
      c = start
      do k = 1, mesh%faces(v)
        c = mesh%turn(c)
        if (c == 0 .or. c == start) exit
        n = n + 1
      end do
      if (n < mesh%faces(v)) then
        message = 'the faces at vertex ' // whole_number(v) // &
          ' do not form one fan (face ' // whole_number(face_of(start)) // &
          ' is in one of them): the surface is not a manifold there. Give each fan its own vertex'
      else if (c == start .and. n < 3) then
        message = 'vertex ' // whole_number(v) // ' lies inside the surface and has ' // &
          whole_number(n) // ' faces (one of them is face ' // whole_number(face_of(start)) // &
          '): three at least are needed'
      end if
      if (len(message) > 0) return
    end do
  end subroutine find_fans

  pure integer function find_edge(mesh, a, b) result(corner)
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: a, b       !! vertices
    integer :: c, k                   ! the result: a corner that the edge starts from, 0: none

    corner = 0
    if (min(a, b) < 1 .or. max(a, b) > mesh%nv) return
    c = mesh%corner(a)
    if (c == 0) return
    do k = 1, mesh%faces(a)
      if (mesh%vertex(next_corner(c)) == b) corner = c
      if (mesh%vertex(previous_corner(c)) == b) corner = previous_corner(c)
      if (corner > 0) return
      c = mesh%turn(c)
      if (c == 0) return
    end do
  end function find_edge

  pure subroutine set_crease(mesh, a, b, message)
    type(quad_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: a, b                           !! vertices of the edge
    character(:), allocatable, intent(out) :: message     !! empty: nothing wrong

    integer :: c

    message = ''
    c = find_edge(mesh, a, b)
    if (c == 0) then
      message = 'vertices ' // whole_number(a) // ' and ' // whole_number(b) // ' have no edge'
      return
    end if
    mesh%crease(c) = .true.
    if (mesh%twin(c) > 0) mesh%crease(mesh%twin(c)) = .true.
  end subroutine set_crease

  pure subroutine set_interval(mesh, a, b, length, given, message)
    !! The interval of an edge and of all edges of its strip of faces.
    type(quad_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: a, b                          !! vertices of the edge
    real(wp), intent(in) :: length                       !! knot interval
    logical, intent(inout) :: given(:)                   !! edges whose intervals were set (4*nf)
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong

    integer :: c, k, start, way

    message = ''
    start = find_edge(mesh, a, b)
    if (start == 0) then
      message = 'vertices ' // whole_number(a) // ' and ' // whole_number(b) // ' have no edge'
      return
    else if (.not. length > 0) then
      message = 'the knot interval of the edge of vertices ' // whole_number(a) // ' and ' // &
        whole_number(b) // ' is not positive'
      return
    end if
    do way = 1, 2
      c = start
      if (way == 2) c = mesh%twin(start)
      do while (c > 0)
        do k = 1, 2
          if (given(c) .and. abs(mesh%interval(c) - length) > 0) then
            message = 'the edge of vertices ' // whole_number(mesh%vertex(c)) // ' and ' // &
              whole_number(mesh%vertex(next_corner(c))) // ' (face ' // &
              whole_number(face_of(c)) // ') has two different knot intervals: opposite edges ' &
              // 'of a face have the same one, and it lies on the strip of the edge of vertices ' &
              // whole_number(a) // ' and ' // whole_number(b)
            return
          end if
          mesh%interval(c) = length
          given(c) = .true.
          if (k == 1) c = next_corner(next_corner(c))
        end do
        c = mesh%twin(c)
        if (c == start) return
      end do
    end do
  end subroutine set_interval
end module quad_mesh
