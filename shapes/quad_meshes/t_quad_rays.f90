module t_quad_rays
  !! Rays in a quadrilateral mesh with T-junctions: which lines of the mesh they meet, at what
  !! distances by the knot intervals.
  !!
  !! The faces at a vertex form its star: quadrants, counter-clockwise, one in a face that has a
  !! corner there and two in one that has a T-junction. Ray k runs along the first axis of quadrant
  !! k: along an edge, or through a face where a line ends at a T-junction. A ray goes straight on
  !! at regular vertices, and along creases where these do. It ends on the boundary, on a crease and
  !! at an extraordinary point.
  use kinds, only: wp
  use t_quad_mesh, only: t_quad_mesh_type
  implicit none (type, external)
  private
  public :: star_type, ray_type, star_of, start_ray, step_ray, two_lines, smooth_mate, &
    is_irregular, is_plain, side_point, turned

  real(wp), parameter, public :: nearby = 1e-8_wp     !! of two places, relative to an interval

  type :: star_type
    integer :: v = 0
    integer :: n = 0                         !! quadrants
    logical :: closed = .false.              !! the vertex lies inside the surface
    integer, allocatable :: half_edge(:)     !! that starts at the vertex, of each quadrant (n)
    integer, allocatable :: axis(:)          !! direction of the first axis in the face (n)
    integer, allocatable :: edge(:)          !! of each ray: half-edge that leaves (> 0) or arrives
                                             !! (< 0, the last one on the boundary), 0: a line ends
                                             !! here (n, on the boundary n+1)
    logical, allocatable :: crease(:)        !! of each ray
  end type star_type

  type :: ray_type
    logical :: goes_on = .false.             !! whether it can be followed
    integer :: v = 0                         !! vertex where it is, 0: between vertices
    integer :: k = 0                         !! there, its number in the star
    integer :: edge = 0                      !! half-edge on which it is between vertices, or whose
                                             !! start it has come to, of the face behind
    integer :: face = 0                      !! between vertices: face that lies ahead
    integer :: axis = 0                      !! and the direction there
    real(wp) :: p(2) = 0                     !! and the place
  end type ray_type

contains

  pure subroutine star_of(mesh, v, star)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: v
    type(star_type), intent(out) :: star

    integer :: h, k, last

    star%v = v
    star%closed = mesh%twin(mesh%out(v)) > 0
    h = mesh%out(v)
    do k = 1, mesh%faces(v)
      star%n = star%n + merge(1, 2, mesh%is_corner(h))
      h = mesh%turn(h)
    end do
    last = star%n + merge(0, 1, star%closed)
    allocate (star%half_edge(star%n), star%axis(star%n), star%edge(last), source=0)
    allocate (star%crease(last), source=.false.)
    h = mesh%out(v)
    last = h
    star%n = 0
    do k = 1, mesh%faces(v)
      star%n = star%n + 1
      star%edge(star%n) = h
      star%crease(star%n) = mesh%crease(h)
      star%half_edge(star%n) = h
      star%axis(star%n) = mesh%side(h)
      if (.not. mesh%is_corner(h)) then
        star%n = star%n + 1
        star%half_edge(star%n) = h
        star%axis(star%n) = modulo(mesh%side(h) + 1, 4)
      end if
      last = h
      h = mesh%turn(h)
    end do
    if (star%closed) return
    star%edge(star%n+1) = -mesh%previous(last)
    star%crease(star%n+1) = .true.
  end subroutine star_of

  pure logical function is_plain(star)
    !! Inside, four quadrants, no creases.
    type(star_type), intent(in) :: star

    is_plain = star%closed .and. star%n == 4 .and. .not. any(star%crease)
  end function is_plain

  pure logical function is_irregular(star)
    !! An extraordinary point, or a vertex of the boundary of more than two quadrants and without
    !! further creases.
    type(star_type), intent(in) :: star

    if (star%closed) then
      is_irregular = star%n /= 4 .and. .not. any(star%crease)
    else
      is_irregular = star%n > 2 .and. .not. any(star%crease(2:star%n))
    end if
  end function is_irregular

  pure integer function smooth_mate(star, k) result(mate)
    !! Ray into which a crease goes on smoothly: there are two quadrants between them. 0: none.
    type(star_type), intent(in) :: star
    integer, intent(in) :: k                 !! ray, a crease

    integer :: i, j, way

    mate = 0
    do way = -1, 1, 2
      do i = 1, 2
        j = neighbour(star, k, way*i)
        if (j == 0) exit
        if (.not. star%crease(j)) cycle
        if (i == 2) mate = j
        exit
      end do
      if (mate > 0) return
    end do
  end function smooth_mate

  pure integer function neighbour(star, k, shift) result(j)
    type(star_type), intent(in) :: star
    integer, intent(in) :: k, shift          !! ray, quadrants to it
                                             ! the result: a ray, 0: beyond the boundary
    j = k + shift
    if (star%closed) then
      j = modulo(j - 1, star%n) + 1
    else if (j < 1 .or. j > star%n + 1) then
      j = 0
    end if
  end function neighbour

  pure function side_point(mesh, h, at) result(p)
    !! Place on the side of a half-edge in the parameters of its face.
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: h
    real(wp), intent(in) :: at               !! along the side
    real(wp) :: p(2)

    associate (size_of => mesh%size(:,mesh%face(h)))
      select case (mesh%side(h))
      case (0);     p = [at, 0.0_wp]
      case (1);     p = [size_of(1), at]
      case (2);     p = [size_of(1) - at, size_of(2)]
      case default; p = [0.0_wp, size_of(2) - at]
      end select
    end associate
  end function side_point

  pure function turned(p, quarters) result(q)
    real(wp), intent(in) :: p(2)
    integer, intent(in) :: quarters          !! counter-clockwise
    real(wp) :: q(2)

    select case (modulo(quarters, 4))
    case (0);     q = p
    case (1);     q = [-p(2), p(1)]
    case (2);     q = -p
    case default; q = [p(2), -p(1)]
    end select
  end function turned

  pure subroutine start_ray(v, k, ray)
    integer, intent(in) :: v, k              !! vertex, ray of its star
    type(ray_type), intent(out) :: ray

    ray%goes_on = .true.
    ray%v = v
    ray%k = k
  end subroutine start_ray

  subroutine step_ray(mesh, ray, length)
    !! To the next line.
    type(t_quad_mesh_type), intent(in) :: mesh
    type(ray_type), intent(inout) :: ray
    real(wp), intent(out) :: length          !! way there, 0: the ray has ended

    type(star_type) :: star
    integer :: e

    length = 0
    if (.not. ray%goes_on) return
    if (ray%v > 0) then
      call star_of(mesh, ray%v, star)
      e = star%edge(ray%k)
      if (e > 0) then
        length = mesh%interval(e)
        call arrive(mesh, mesh%next(e), modulo(mesh%side(e) + 2, 4), ray)
        return
      else if (e < 0) then
        length = mesh%interval(-e)
        call arrive(mesh, -e, mesh%side(-e), ray)
        return
      end if
      ray%face = mesh%face(star%half_edge(ray%k))
      ray%axis = star%axis(ray%k)
      ray%p = side_point(mesh, star%half_edge(ray%k), mesh%at(star%half_edge(ray%k)))
    end if
    call pass_face(mesh, ray, length)
  end subroutine step_ray

  subroutine pass_face(mesh, ray, length)
    type(t_quad_mesh_type), intent(in) :: mesh
    type(ray_type), intent(inout) :: ray
    real(wp), intent(out) :: length

    real(wp) :: at
    integer :: h, side, t

    associate (size_of => mesh%size(:,ray%face), p => ray%p)
      side = modulo(ray%axis + 1, 4)
      select case (side)
      case (0)
        length = p(2)
        at = p(1)
      case (1)
        length = size_of(1) - p(1)
        at = p(2)
      case (2)
        length = size_of(2) - p(2)
        at = size_of(1) - p(1)
      case default
        length = p(1)
        at = size_of(2) - p(2)
      end select
    end associate
    do h = mesh%first(ray%face), mesh%first(ray%face+1) - 1
      if (mesh%side(h) /= side) cycle
      if (at < mesh%at(h) + (1 - nearby)*mesh%interval(h) .and. &
        at > mesh%at(h) - nearby*mesh%interval(h)) exit
    end do
    if (h == mesh%first(ray%face+1)) error stop 't_quad_rays: a ray leaves its face nowhere'
    if (at < mesh%at(h) + nearby*mesh%interval(h)) then
      call arrive(mesh, h, modulo(ray%axis + 2, 4), ray)
      return
    end if
    ray%v = 0
    ray%edge = h
    ray%goes_on = .not. mesh%crease(h)
    if (.not. ray%goes_on) return
    t = mesh%twin(h)
    ray%face = mesh%face(t)
    ray%axis = modulo(mesh%side(t) + 1, 4)
    ray%p = side_point(mesh, t, mesh%at(t) + mesh%interval(t) - (at - mesh%at(h)))
  end subroutine pass_face

  subroutine arrive(mesh, h, back, ray)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: h                 !! half-edge that starts at the vertex, face behind
    integer, intent(in) :: back              !! direction back in that face
    type(ray_type), intent(inout) :: ray

    type(star_type) :: star
    integer :: from, q

    call star_of(mesh, mesh%vertex(h), star)
    from = 0
    do q = 1, star%n
      if (star%half_edge(q) /= h) cycle
      if (star%axis(q) == back) from = q
      if (modulo(star%axis(q) + 1, 4) == back .and. from == 0) from = neighbour(star, q, 1)
    end do
    if (from == 0) error stop 't_quad_rays: a ray comes from nowhere'
    ray%v = star%v
    ray%edge = h
    ray%k = 0
    if (is_plain(star)) then
      ray%k = neighbour(star, from, 2)
    else if (star%crease(from)) then
      ray%k = smooth_mate(star, from)
    end if
    ray%goes_on = ray%k > 0
  end subroutine arrive

  subroutine two_lines(mesh, v, k, distance)
    !! Distances to the next two lines along a ray; a line on which it ends counts twice.
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: v, k              !! vertex, ray of its star
    real(wp), intent(out) :: distance(2)

    type(ray_type) :: ray
    real(wp) :: length

    call start_ray(v, k, ray)
    call step_ray(mesh, ray, distance(1))
    call step_ray(mesh, ray, length)
    distance(2) = distance(1) + length
  end subroutine two_lines
end module t_quad_rays
