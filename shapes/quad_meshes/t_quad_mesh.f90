module t_quad_mesh
  !! Quadrilateral control meshes of any topology with T-junctions: faces of four corners, on whose
  !! sides further vertices may lie. Such a vertex is a T-junction: one edge leaves it to the other
  !! side, and the line of this edge ends there.
  !!
  !! A half-edge is an edge seen from one of its faces, counter-clockwise. Side k = 0 ... 3 of a
  !! face begins at its corner k, the first corner in the order of its vertices being corner 0. In
  !! the parameters of a face, (x,y) in [0,size(1)] x [0,size(2)], side 0 is y = 0 with x growing,
  !! side 1 is x = size(1) with y growing, and so on. Directions are numbered as the sides: 0 is
  !! +x, 1 +y, 2 -x, 3 -y.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use half_edges, only: pair_half_edges
  implicit none (type, external)
  private
  public :: t_quad_mesh_type, create_t_quad_mesh, find_half_edge, set_t_crease

  type :: t_quad_mesh_type
    integer :: nv = 0                        !! vertices
    integer :: nf = 0                        !! faces
    integer :: nh = 0                        !! half-edges
    real(wp), allocatable :: x(:,:)          !! vertices (3,nv) [length]
    integer, allocatable :: first(:)         !! half-edge of each face, one behind the last (nf+1)
    integer, allocatable :: vertex(:)        !! that a half-edge starts from (nh)
    integer, allocatable :: face(:)          !! of a half-edge (nh)
    integer, allocatable :: next(:)          !! in the same face (nh)
    integer, allocatable :: previous(:)      !! in the same face (nh)
    integer, allocatable :: twin(:)          !! the edge from the other face, 0: boundary (nh)
    logical, allocatable :: is_corner(:)     !! whether the start is a corner of the face (nh)
    logical, allocatable :: crease(:)        !! edges not smooth, the boundary among them (nh)
    integer, allocatable :: side(:)          !! of its face (nh)
    real(wp), allocatable :: interval(:)     !! knot interval (nh)
    real(wp), allocatable :: at(:)           !! where it starts on its side (nh)
    real(wp), allocatable :: size(:,:)       !! knot intervals of the faces (2,nf)
    integer, allocatable :: out(:)           !! a half-edge that leaves each vertex: on the boundary
                                             !! the first one counter-clockwise; 0: unused (nv)
    integer, allocatable :: faces(:)         !! faces at each vertex (nv)
  contains
    procedure :: turn                        !! next half-edge about its vertex, 0: boundary
    procedure :: place_sides                 !! at and size from the intervals
  end type t_quad_mesh_type

contains

  pure integer function turn(self, h)
    class(t_quad_mesh_type), intent(in) :: self
    integer, intent(in) :: h        !! half-edge

    turn = self%twin(self%previous(h))
  end function turn

  subroutine create_t_quad_mesh(x, first, vertex, mesh, message)
    !! Faces and edges; corners are not known yet, all intervals are 1.
    real(wp), intent(in) :: x(:,:)                     !! vertices (3,nv) [length]
    integer, intent(in) :: first(:)                    !! vertex of each face in the list (nf+1)
    integer, intent(in) :: vertex(:)                   !! vertices of the faces, counter-clockwise
    type(t_quad_mesh_type), intent(out) :: mesh
    character(:), allocatable, intent(out) :: message  !! what is wrong; empty: nothing

    integer :: f, h

    message = ''
    mesh%nv = size(x, 2)
    mesh%nf = size(first) - 1
    mesh%nh = size(vertex)
    allocate (mesh%x, source=x)
    allocate (mesh%first, source=first)
    allocate (mesh%vertex, source=vertex)
    allocate (mesh%face(mesh%nh), mesh%next(mesh%nh), mesh%previous(mesh%nh), mesh%twin(mesh%nh), &
      mesh%side(mesh%nh), source=0)
    allocate (mesh%crease(mesh%nh), source=.false.)
    allocate (mesh%is_corner(mesh%nh), source=.true.)
    allocate (mesh%interval(mesh%nh), source=1.0_wp)
    allocate (mesh%at(mesh%nh), mesh%size(2,mesh%nf), source=0.0_wp)
    allocate (mesh%out(mesh%nv), mesh%faces(mesh%nv), source=0)
    if (mesh%nf == 0) message = 'the mesh has no faces'
    do f = 1, mesh%nf
      call check_face(f)
      if (len(message) > 0) return
      do h = first(f), first(f+1) - 1
        mesh%face(h) = f
        mesh%next(h) = merge(first(f), h + 1, h == first(f+1) - 1)
        mesh%previous(mesh%next(h)) = h
      end do
    end do
    call pair_half_edges(mesh%nv, mesh%vertex, mesh%next, mesh%face, mesh%twin, message)
    if (len(message) > 0) return
    mesh%crease = mesh%twin == 0
    call find_fans(mesh, message)

  contains

    subroutine check_face(f)
      integer, intent(in) :: f

      integer :: h, v

      if (first(f+1) - first(f) < 4) message = 'face ' // whole_number(f) // ' has ' // &
        whole_number(first(f+1) - first(f)) // ' vertices: it is not a quadrilateral'
      do h = first(f), first(f+1) - 1
        v = vertex(h)
        if (v < 1 .or. v > mesh%nv) then
          message = 'face ' // whole_number(f) // ' names vertex ' // whole_number(v) // &
            ', but vertices are numbered from 1 to ' // whole_number(mesh%nv)
        else if (any(vertex(first(f):h-1) == v)) then
          message = 'face ' // whole_number(f) // ' names vertex ' // whole_number(v) // &
            ' twice: it is not a quadrilateral'
        end if
        if (len(message) > 0) return
      end do
    end subroutine check_face
  end subroutine create_t_quad_mesh

  pure subroutine find_fans(mesh, message)
    !! One fan of faces at each vertex, and enough of them.
    type(t_quad_mesh_type), intent(inout) :: mesh
    character(:), allocatable, intent(inout) :: message

    integer :: h, k, n, start, v

    do h = 1, mesh%nh
      v = mesh%vertex(h)
      mesh%faces(v) = mesh%faces(v) + 1
      if (mesh%out(v) == 0 .or. mesh%twin(h) == 0) mesh%out(v) = h
    end do
    do v = 1, mesh%nv
      start = mesh%out(v)
      if (start == 0) cycle
      n = 1
      h = start
      do k = 1, mesh%faces(v)
        h = mesh%turn(h)
        if (h == 0 .or. h == start) exit
        n = n + 1
      end do
      if (n < mesh%faces(v)) then
        message = 'the faces at vertex ' // whole_number(v) // &
          ' do not form one fan (face ' // whole_number(mesh%face(start)) // &
          ' is in one of them): the surface is not a manifold there. Give each fan its own vertex'
      else if (h == start .and. n < 3) then
        message = 'vertex ' // whole_number(v) // ' lies inside the surface and has ' // &
          whole_number(n) // ' faces (one of them is face ' // whole_number(mesh%face(start)) // &
          '): three at least are needed'
      end if
      if (len(message) > 0) return
    end do
  end subroutine find_fans

  pure integer function find_half_edge(mesh, a, b) result(found)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: a, b       !! vertices
    integer :: h, k                   ! the result: a half-edge of the edge, 0: none

    found = 0
    if (min(a, b) < 1 .or. max(a, b) > mesh%nv) return
    h = mesh%out(a)
    if (h == 0) return
    do k = 1, mesh%faces(a)
      if (mesh%vertex(mesh%next(h)) == b) found = h
      if (mesh%vertex(mesh%previous(h)) == b) found = mesh%previous(h)
      if (found > 0) return
      h = mesh%turn(h)
      if (h == 0) return
    end do
  end function find_half_edge

  pure subroutine set_t_crease(mesh, a, b, message)
    type(t_quad_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: a, b                           !! vertices of the edge
    character(:), allocatable, intent(out) :: message     !! empty: nothing wrong

    integer :: h

    message = ''
    h = find_half_edge(mesh, a, b)
    if (h == 0) then
      message = 'vertices ' // whole_number(a) // ' and ' // whole_number(b) // ' have no edge'
      return
    end if
    mesh%crease(h) = .true.
    if (mesh%twin(h) > 0) mesh%crease(mesh%twin(h)) = .true.
  end subroutine set_t_crease

  pure subroutine place_sides(self)
    !! Sides are numbered from the first corner of a face.
    class(t_quad_mesh_type), intent(inout) :: self

    real(wp) :: at
    integer :: f, h, k, side, start

    do f = 1, self%nf
      start = self%first(f)
      do while (.not. self%is_corner(start))
        start = self%next(start)
      end do
      h = start
      side = -1
      at = 0
      do k = self%first(f), self%first(f+1) - 1
        if (self%is_corner(h)) then
          side = side + 1
          at = 0
        end if
        self%side(h) = side
        self%at(h) = at
        at = at + self%interval(h)
        if (side < 2) self%size(side+1,f) = at
        h = self%next(h)
      end do
      ! opposite sides are of the same length but for rounding: what ends at a corner ends there
      do k = self%first(f), self%first(f+1) - 1
        if (self%side(k) < 2 .or. self%is_corner(k)) cycle
        self%at(k) = self%at(k) * (self%size(self%side(k)-1,f) / length_of(k))
      end do
    end do

  contains

    pure real(wp) function length_of(k)
      !! Of the side of a half-edge.
      integer, intent(in) :: k

      integer :: j

      length_of = 0
      do j = self%first(self%face(k)), self%first(self%face(k)+1) - 1
        if (self%side(j) == self%side(k)) length_of = length_of + self%interval(j)
      end do
    end function length_of
  end subroutine place_sides
end module t_quad_mesh
