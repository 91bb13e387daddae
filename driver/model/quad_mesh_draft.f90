module quad_mesh_draft
  !! What the lines of a QUADmesh data set say, before the surface is made: a mesh without T-junctions (quad_mesh), or with
  !! them (t_quad_mesh).
  use kinds, only: wp
  use messages, only: whole_text
  use quad_mesh, only: quad_mesh_type, create_quad_mesh, set_crease, set_interval
  use t_quad_mesh, only: t_quad_mesh_type, create_t_quad_mesh, find_half_edge, set_t_crease
  use t_quad_corners, only: find_corners
  use t_quad_intervals, only: given_interval
  use refinement_zones, only: zones_type
  use sphere_target, only: sphere_type
  use t_sweep, only: sweep_type
  implicit none (type, external)
  private
  public :: quad_draft

  type :: quad_draft
    type(quad_mesh_type) :: mesh
    type(t_quad_mesh_type) :: t_mesh                         !! instead, if faces have T-junctions
    logical :: has_t_junctions = .false.
    logical :: is_built = .false.
    real(wp), allocatable :: x(:, :)                         !! vertices that wait for their faces (3,nv)
    logical, allocatable :: given(:)                         !! edges with intervals
    type(given_interval), allocatable :: t_given(:)          !! intervals given with T-junctions
    integer :: refinements = 0
    type(zones_type) :: zones                                !! of local refinement
    logical :: on_sphere = .false., is_symmetric = .false.
    type(sphere_type) :: sphere
    type(sweep_type), allocatable :: sweep                   !! into a solid
  contains
    procedure :: set_faces
    procedure :: set_crease_edge
    procedure :: set_edge_interval
    procedure :: find_vertex
  end type quad_draft

contains

  subroutine set_faces(self, x, first, vertex, message)
    class(quad_draft), intent(inout) :: self
    real(wp), intent(in) :: x(:, :)                          !! vertices (3,nv)
    integer, intent(in) :: first(:)                          !! vertex of each face in the list (nf+1)
    integer, intent(in) :: vertex(:)                         !! vertices of the faces
    character(:), allocatable, intent(out) :: message        !! what is wrong; empty: nothing
    integer :: nf

    nf = size(first) - 1
    self%has_t_junctions = any(first(2:) - first(:nf) /= 4)
    if (self%has_t_junctions) then
      call create_t_quad_mesh(x, first, vertex, self%t_mesh, message)
      if (len(message) == 0) call find_corners(self%t_mesh, message)
      allocate (self%t_given(0))
    else
      call create_quad_mesh(x, reshape(vertex, [4, nf]), self%mesh, message)
      allocate (self%given(4*nf), source=.false.)
    end if
    self%is_built = len(message) == 0
  end subroutine set_faces

  subroutine set_crease_edge(self, a, b, message)
    class(quad_draft), intent(inout) :: self
    integer, intent(in) :: a, b                              !! vertices of the edge
    character(:), allocatable, intent(out) :: message        !! empty: nothing wrong

    if (self%has_t_junctions) then
      call set_t_crease(self%t_mesh, a, b, message)
    else
      call set_crease(self%mesh, a, b, message)
    end if
  end subroutine set_crease_edge

  subroutine set_edge_interval(self, a, b, length, message)
    class(quad_draft), intent(inout) :: self
    integer, intent(in) :: a, b                              !! vertices of the edge
    real(wp), intent(in) :: length                           !! knot interval
    character(:), allocatable, intent(out) :: message        !! empty: nothing wrong
    integer :: h

    if (.not. self%has_t_junctions) then
      call set_interval(self%mesh, a, b, length, self%given, message)
      return
    end if
    message = ''
    h = find_half_edge(self%t_mesh, a, b)
    if (h == 0) then
      message = 'vertices ' // whole_text(a) // ' and ' // whole_text(b) // ' have no edge'
    else if (.not. length > 0) then
      message = 'the knot interval of the edge of vertices ' // whole_text(a) // ' and ' // whole_text(b) // ' is not positive'
    else
      ! whether they fit is known when all are given
      self%t_given = [self%t_given, given_interval(h, length)]
    end if
  end subroutine set_edge_interval

  subroutine find_vertex(self, v, x, message)
    class(quad_draft), intent(in) :: self
    integer, intent(in) :: v
    real(wp), intent(out) :: x(3)                            !! its place
    character(:), allocatable, intent(inout) :: message      !! if there is none
    integer :: nv

    nv = self%mesh%nv
    if (self%has_t_junctions) nv = self%t_mesh%nv
    x = 0
    if (v < 1 .or. v > nv) then
      message = 'there is no vertex ' // whole_text(v)
    else if (self%has_t_junctions) then
      x = self%t_mesh%x(:, v)
    else
      x = self%mesh%x(:, v)
    end if
  end subroutine find_vertex
end module quad_mesh_draft
