module t_quad_refinement
  !! Every face of a quadrilateral mesh with T-junctions in four, by the middles of its sides by the
  !! knot intervals. A T-junction in the middle of a side becomes a vertex of four faces; where its
  !! pieces are halved in turn, new ones arise.
  use kinds, only: wp
  use t_quad_mesh, only: t_quad_mesh_type, create_t_quad_mesh
  use t_quad_rays, only: nearby
  implicit none (type, external)
  private
  public :: split_t_faces

  !> vertices along the outline of a face, new ones among them
  type :: outline_type
    integer :: n = 0
    integer, allocatable :: vertex(:)
    integer, allocatable :: half_edge(:)         !! old one that the way to the next vertex is on
    real(wp), allocatable :: at(:)               !! on its side
    logical, allocatable :: is_corner(:)
  end type outline_type

contains

  subroutine split_t_faces(mesh, finer)
    !! Vertices 1 ... nv stay. New vertices lie on straight edges, and in faces where their four
    !! half-sides meet.
    type(t_quad_mesh_type), intent(in) :: mesh   !! corners and intervals are known
    type(t_quad_mesh_type), intent(out) :: finer

    real(wp), allocatable :: interval(:), x(:,:)
    integer, allocatable :: first(:), vertex(:)
    logical, allocatable :: crease(:), is_corner(:)
    integer, allocatable :: middle(:,:)          ! new vertices on each edge, of which the first one
                                                 ! comes first on the half-edge of the lower number
    real(wp), allocatable :: part(:,:)           ! where they are on that half-edge, 0: none
    type(outline_type) :: outline
    character(:), allocatable :: message
    integer :: f, h, k, n, nv

    allocate (part(2,mesh%nh))
    call find_middles(mesh, part)
    nv = mesh%nv
    allocate (middle(2,mesh%nh), source=0)
    allocate (x(3,mesh%nv + 2*mesh%nh + mesh%nf))
    x(:,1:nv) = mesh%x
    do h = 1, mesh%nh
      do k = 1, 2
        if (.not. part(k,h) > 0) cycle
        nv = nv + 1
        middle(k,h) = nv
        x(:,nv) = (1 - part(k,h))*mesh%x(:,mesh%vertex(h)) &
          + part(k,h)*mesh%x(:,mesh%vertex(mesh%next(h)))
      end do
    end do
    n = 4*(3*mesh%nh + 4*mesh%nf)
    allocate (first(4*mesh%nf+1), vertex(n), crease(n), is_corner(n), interval(n))
    n = 0
    first(1) = 1
    do f = 1, mesh%nf
      call walk_around(mesh, f, middle, part, outline)
      nv = nv + 1
      call place_centre(mesh, f, x, outline, x(:,nv))
      do k = 0, 3
        call add_quarter(mesh, f, k, outline, nv, vertex, is_corner, crease, interval, n)
        first(4*f-3+k+1) = n + 1
      end do
    end do
    call create_t_quad_mesh(x(:,1:nv), first, vertex(1:n), finer, message)
    if (len(message) > 0) error stop 't_quad_refinement: the finer mesh has a fault'
    finer%is_corner = is_corner(1:n)
    finer%crease = finer%twin == 0 .or. crease(1:n)
    finer%interval = interval(1:n)
    call finer%place_sides()
  end subroutine split_t_faces

  subroutine find_middles(mesh, part)
    !! Where the middles of sides are on edges, if not at vertices.
    type(t_quad_mesh_type), intent(in) :: mesh
    real(wp), intent(out) :: part(:,:)           !! of the half-edge of the lower number (2,nh)

    real(wp) :: at, place
    integer :: h, low

    part = 0
    do h = 1, mesh%nh
      at = mesh%size(1+mod(mesh%side(h), 2),mesh%face(h))/2 - mesh%at(h)
      place = at/mesh%interval(h)
      if (place < nearby .or. place > 1 - nearby) cycle
      low = h
      if (mesh%twin(h) > 0) low = min(h, mesh%twin(h))
      if (low /= h) place = 1 - place
      if (.not. part(1,low) > 0) then
        part(1,low) = place
      else if (abs(part(1,low) - place) > nearby) then
        part(:,low) = [min(part(1,low), place), max(part(1,low), place)]
      end if
    end do
  end subroutine find_middles

  subroutine walk_around(mesh, f, middle, part, outline)
    !! From corner 0.
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: f
    integer, intent(in) :: middle(:,:)
    real(wp), intent(in) :: part(:,:)
    type(outline_type), intent(out) :: outline

    real(wp) :: place
    integer :: h, i, k, low, m, room

    room = 3*(mesh%first(f+1) - mesh%first(f))
    allocate (outline%vertex(room), outline%half_edge(room), outline%at(room), &
      outline%is_corner(room))
    h = mesh%first(f)
    do while (.not. (mesh%is_corner(h) .and. mesh%side(h) == 0))
      h = mesh%next(h)
    end do
    do k = mesh%first(f), mesh%first(f+1) - 1
      call take(mesh%vertex(h), mesh%at(h), mesh%is_corner(h))
      low = h
      if (mesh%twin(h) > 0) low = min(h, mesh%twin(h))
      do i = 1, 2
        m = merge(i, 3 - i, low == h)
        if (middle(m,low) == 0) cycle
        place = part(m,low)
        if (low /= h) place = 1 - place
        call take(middle(m,low), mesh%at(h) + place*mesh%interval(h), .false.)
      end do
      h = mesh%next(h)
    end do

  contains

    subroutine take(v, at, is_corner)
      integer, intent(in) :: v
      real(wp), intent(in) :: at
      logical, intent(in) :: is_corner

      outline%n = outline%n + 1
      outline%vertex(outline%n) = v
      outline%half_edge(outline%n) = h
      outline%at(outline%n) = at
      outline%is_corner(outline%n) = is_corner
    end subroutine take
  end subroutine walk_around

  pure logical function is_middle(mesh, outline, i)
    type(t_quad_mesh_type), intent(in) :: mesh
    type(outline_type), intent(in) :: outline
    integer, intent(in) :: i

    real(wp) :: whole

    associate (h => outline%half_edge(i))
      whole = mesh%size(1+mod(mesh%side(h), 2),mesh%face(h))
    end associate
    is_middle = abs(outline%at(i) - whole/2) < nearby*whole
  end function is_middle

  subroutine place_centre(mesh, f, x, outline, centre)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: f
    real(wp), intent(in) :: x(:,:)
    type(outline_type), intent(in) :: outline
    real(wp), intent(out) :: centre(3)

    real(wp) :: sum_of(3)
    integer :: i

    sum_of = 0
    do i = 1, outline%n
      if (is_middle(mesh, outline, i)) sum_of = sum_of + x(:,outline%vertex(i))/2
      if (outline%is_corner(i)) sum_of = sum_of - x(:,outline%vertex(i))/4
    end do
    centre = sum_of
    if (mesh%first(f+1) - mesh%first(f) == 4) centre = sum(mesh%x(:,mesh%vertex( &
      mesh%first(f):mesh%first(f)+3)), 2)/4
  end subroutine place_centre

  subroutine add_quarter(mesh, f, k, outline, centre, vertex, is_corner, crease, interval, n)
    !! At corner k of a face, its first corner.
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: f, k
    type(outline_type), intent(in) :: outline
    integer, intent(in) :: centre                !! vertex
    integer, intent(inout) :: vertex(:)
    logical, intent(inout) :: is_corner(:), crease(:)
    real(wp), intent(inout) :: interval(:)
    integer, intent(inout) :: n                  !! half-edges so far

    integer :: at_corner, before, i, j
    real(wp) :: half(0:1)

    half = mesh%size(:,f)/2
    at_corner = 0
    j = -1
    do i = 1, outline%n
      if (outline%is_corner(i)) j = j + 1
      if (outline%is_corner(i) .and. j == k) at_corner = i
    end do
    ! the corner and on to the middle of its side
    i = at_corner
    do
      if (is_middle(mesh, outline, i) .and. i /= at_corner) exit
      call take(outline%vertex(i), i == at_corner, mesh%crease(outline%half_edge(i)), way_on(i))
      i = mod(i, outline%n) + 1
    end do
    call take(outline%vertex(i), .true., .false., half(1-mod(k, 2)))
    call take(centre, .true., .false., half(mod(k, 2)))
    ! from the middle of the side before, back to the corner
    before = at_corner
    do
      before = modulo(before - 2, outline%n) + 1
      if (is_middle(mesh, outline, before)) exit
    end do
    i = before
    do while (i /= at_corner)
      call take(outline%vertex(i), i == before, mesh%crease(outline%half_edge(i)), way_on(i))
      i = mod(i, outline%n) + 1
    end do

  contains

    real(wp) function way_on(i)
      !! To the next vertex.
      integer, intent(in) :: i

      integer :: next

      next = mod(i, outline%n) + 1
      if (outline%is_corner(next)) then
        way_on = mesh%size(1+mod(mesh%side(outline%half_edge(i)), 2),f) - outline%at(i)
      else
        way_on = outline%at(next) - outline%at(i)
      end if
    end function way_on

    subroutine take(v, corner, is_crease, length)
      integer, intent(in) :: v
      logical, intent(in) :: corner, is_crease
      real(wp), intent(in) :: length

      n = n + 1
      vertex(n) = v
      is_corner(n) = corner
      crease(n) = is_crease
      interval(n) = length
    end subroutine take
  end subroutine add_quarter
end module t_quad_refinement
