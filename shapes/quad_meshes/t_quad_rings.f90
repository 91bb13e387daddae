module t_quad_rings
  !! Extraordinary points of quadrilateral meshes with T-junctions. The faces at such a point (its
  !! zone) and the next ring around them have no T-junctions; from these rings alone, with one more
  !! ring of faces put around for the knot intervals, the spline of unstructured_spline is made,
  !! with seams of one edge. Its functions that belong to vertices are those of the T-mesh; the others
  !! live in the zone and come to an end on its outline.
  !!
  !! So elements of the zone have the coefficients of that spline, elements around it those on the
  !! outline, and all others do not know of extraordinary points.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use unstructured_spline, only: unstructured_spline_type, create_spline
  use sparse_row, only: row_type, clear, add_scaled_term
  use t_quad_mesh, only: t_quad_mesh_type
  use t_quad_rays, only: star_type, star_of, is_irregular
  use t_quad_functions, only: t_functions_type
  use t_quad_outline, only: ring_mesh_type, spread_over
  implicit none (type, external)
  private
  public :: t_rings_type, create_rings

  type :: t_rings_type
    integer :: n = 0                         !! functions: those of vertices, then those of zones
    logical, allocatable :: zone(:)          !! faces at extraordinary points (nf)
    logical, allocatable :: touches(:)       !! further faces that have a vertex with these (nf)
    logical, allocatable :: at_zone(:)       !! vertices of zones (nv)
    integer, allocatable :: local_face(:)    !! in the spline of the rings (nf)
    integer, allocatable :: local_vertex(:)  !! in the spline of the rings (nv)
    integer, allocatable :: id(:)            !! function of each control point of that spline
    logical, allocatable :: own(:)           !! whether it is one of a zone
    type(unstructured_spline_type) :: spline
  contains
    procedure :: degree_of
    procedure :: coefficient
    procedure :: join_face
    procedure :: renumber
  end type t_rings_type

contains

  subroutine create_rings(mesh, functions, ring_mesh, rings, message)
    type(t_quad_mesh_type), intent(in) :: mesh
    type(t_functions_type), intent(in) :: functions
    type(ring_mesh_type), intent(in) :: ring_mesh
    type(t_rings_type), intent(out) :: rings
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong

    message = ''
    rings%n = functions%n
    allocate (rings%touches(mesh%nf), rings%at_zone(mesh%nv), source=.false.)
    allocate (rings%zone, source=ring_mesh%zone)
    allocate (rings%local_face, source=ring_mesh%local_face)
    allocate (rings%local_vertex, source=ring_mesh%local_vertex)
    allocate (rings%id(0), rings%own(0))
    if (.not. any(rings%zone)) return
    call spread_over(mesh, rings%zone, rings%at_zone, rings%touches)
    rings%touches = rings%touches .and. .not. rings%zone
    call create_spline(ring_mesh%mesh, rings%spline, message)
    if (len(message) > 0) return
    call match_functions(mesh, functions, ring_mesh, rings)
  end subroutine create_rings

  subroutine match_functions(mesh, functions, ring_mesh, rings)
    type(t_quad_mesh_type), intent(in) :: mesh
    type(t_functions_type), intent(in) :: functions
    type(ring_mesh_type), intent(in) :: ring_mesh
    type(t_rings_type), intent(inout) :: rings

    integer :: a, c, f, h, i, k, l

    deallocate (rings%id, rings%own)
    associate (slots => rings%spline%slots)
      allocate (rings%id(slots%n), source=0)
      allocate (rings%own(slots%n), source=.false.)
      do f = 1, mesh%nf
        l = rings%local_face(f)
        if (l == 0) cycle
        do k = 1, 4
          c = 4*(l - 1) + k
          h = ring_mesh%half_edge(c)
          a = slots%inner(c)
          if (a > 0 .and. .not. rings%zone(f)) rings%id(a) = functions%inner(h)
          a = slots%vertex(ring_mesh%mesh%vertex(c))
          if (a > 0) rings%id(a) = functions%vertex(mesh%vertex(h))
          if (.not. mesh%crease(h)) cycle
          do i = 1, 2
            a = slots%curve(i,c)
            if (a > 0) rings%id(a) = functions%curve(i,h)
          end do
        end do
      end do
      do f = 1, mesh%nf
        if (.not. rings%zone(f)) cycle
        l = rings%local_face(f)
        do k = 1, (rings%spline%degree(l) + 1)**2
          associate (row => rings%spline%b(k,l))
            do i = 1, row%n
              a = row%id(i)
              if (rings%id(a) > 0) cycle
              rings%n = rings%n + 1
              rings%id(a) = rings%n
              rings%own(a) = .true.
            end do
          end associate
        end do
      end do
    end associate
  end subroutine match_functions

  pure integer function degree_of(self, f)
    class(t_rings_type), intent(in) :: self
    integer, intent(in) :: f                     !! face of a zone

    degree_of = self%spline%degree(self%local_face(f))
  end function degree_of

  subroutine coefficient(self, f, k, row)
    class(t_rings_type), intent(in) :: self
    integer, intent(in) :: f, k                  !! face, number of the Bezier coefficient
    type(row_type), intent(inout) :: row

    integer :: i

    call clear(row)
    associate (local => self%spline%b(k,self%local_face(f)))
      do i = 1, local%n
        call add_scaled_term(row, local%c(i), self%id(local%id(i)))
      end do
    end associate
  end subroutine coefficient

  subroutine join_face(self, mesh, f, is_whole, b, message)
    !! The coefficients of a face around a zone that it shares with the zone. The others must be
    !! those of the rings.
    class(t_rings_type), intent(in) :: self
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: f
    logical, intent(in) :: is_whole                      !! the face is one element
    type(row_type), intent(inout) :: b(0:)               !! (0:15)
    character(:), allocatable, intent(inout) :: message

    integer, parameter :: inner(4) = [5, 6, 9, 10], corner(0:3) = [0, 3, 15, 12]
    integer, parameter :: on_side(2,0:3) = reshape([1, 2, 7, 11, 13, 14, 4, 8], [2, 4])
    type(row_type) :: row
    integer :: h, k
    logical :: good

    good = is_whole .and. self%degree_of(f) == 3
    do k = 1, 4
      if (.not. good) exit
      if (any(self%id(ids(inner(k))) == 0)) then
        good = .false.
        exit
      end if
      call self%coefficient(f, 1 + inner(k), row)
      call add_negative(b(inner(k)), row)
      good = all(abs(row%c(1:row%n)) < 1e-9_wp)
    end do
    if (.not. good) then
      message = 'face ' // whole_number(f) // ' is next to the faces around an extraordinary ' // &
        'point (vertex ' // whole_number(point_near(f)) // '), and the line of a T-junction ends ' &
        // 'within the two faces beyond: T-junctions need four faces between them and the point'
      return
    end if
    do h = mesh%first(f), mesh%first(f+1) - 1
      k = mesh%side(h)
      if (self%at_zone(mesh%vertex(h))) call self%coefficient(f, 1 + corner(k), b(corner(k)))
      if (mesh%twin(h) == 0) cycle
      if (.not. self%zone(mesh%face(mesh%twin(h)))) cycle
      call self%coefficient(f, 1 + on_side(1,k), b(on_side(1,k)))
      call self%coefficient(f, 1 + on_side(2,k), b(on_side(2,k)))
    end do

  contains

    function ids(k) result(list)
      integer, intent(in) :: k
      integer, allocatable :: list(:)

      associate (local => self%spline%b(1+k,self%local_face(f)))
        list = local%id(1:local%n)
      end associate
    end function ids

    integer function point_near(f)
      integer, intent(in) :: f

      type(star_type) :: star
      integer :: i, j, other

      point_near = 0
      do i = mesh%first(f), mesh%first(f+1) - 1
        other = mesh%out(mesh%vertex(i))
        do while (other > 0)
          if (self%zone(mesh%face(other))) then
            do j = mesh%first(mesh%face(other)), mesh%first(mesh%face(other)+1) - 1
              call star_of(mesh, mesh%vertex(j), star)
              if (is_irregular(star)) point_near = mesh%vertex(j)
            end do
          end if
          if (point_near > 0) return
          other = mesh%turn(other)
          if (other == mesh%out(mesh%vertex(i))) exit
        end do
      end do
    end function point_near
  end subroutine join_face

  subroutine add_negative(b, row)
    type(row_type), intent(in) :: b
    type(row_type), intent(inout) :: row         !! less b

    integer :: i

    do i = 1, b%n
      call add_scaled_term(row, -b%c(i), b%id(i))
    end do
  end subroutine add_negative

  subroutine renumber(self, new)
    class(t_rings_type), intent(inout) :: self
    integer, intent(in) :: new(:)                !! number of each function, 0: dropped

    where (self%id > 0) self%id = new(max(self%id, 1))
  end subroutine renumber
end module t_quad_rings
