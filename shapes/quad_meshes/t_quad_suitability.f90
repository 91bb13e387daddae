module t_quad_suitability
  !! Analysis-suitability of quadrilateral meshes with T-junctions (see t_suitability): no extension
  !! of a T-junction meets one that runs across it. Where a line ends at a T-junction, its extension
  !! runs on to the second line ahead and back to the line before.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use t_quad_mesh, only: t_quad_mesh_type
  use t_quad_rays, only: star_type, ray_type, star_of, start_ray, step_ray, is_plain
  implicit none (type, external)
  private
  public :: check_t_suitability

  integer, parameter :: at_vertex = 1, through_face = 2, on_edge = 3, along_edge = 4

  !> what an extension touches
  type :: trace_type
    integer :: kind = 0
    integer :: place = 0                     !! vertex, face or edge
    integer :: axis = 0                      !! 0 or 1: of the star of a vertex, of a face
  end type trace_type

  type :: extension_type
    integer :: v = 0                         !! T-junction
    integer :: n = 0                         !! traces
    type(trace_type) :: traces(16)
  end type extension_type

contains

  subroutine check_t_suitability(mesh, message)
    type(t_quad_mesh_type), intent(in) :: mesh
    character(:), allocatable, intent(out) :: message    !! empty: suitable

    type(extension_type), allocatable :: extensions(:)
    integer :: h, i, j, n, trace

    message = ''
    allocate (extensions(count(.not. mesh%is_corner)))
    n = 0
    do h = 1, mesh%nh
      if (mesh%is_corner(h)) cycle
      n = n + 1
      call extend(mesh, mesh%vertex(h), extensions(n))
    end do
    do i = 1, n
      do j = i + 1, n
        trace = crossing(extensions(i), extensions(j))
        if (trace == 0) cycle
        message = 'the extensions of the T-junctions at vertices ' // &
          whole_number(extensions(i)%v) // ' and ' // whole_number(extensions(j)%v) // &
          ' cross ' // where_is(extensions(i)%traces(trace)) // &
          ': lead one of the two lines on over the next face'
        return
      end do
    end do

  contains

    function where_is(t) result(text)
      type(trace_type), intent(in) :: t
      character(:), allocatable :: text

      select case (t%kind)
      case (at_vertex)
        text = 'at vertex ' // whole_number(t%place)
      case (through_face)
        text = 'in face ' // whole_number(t%place)
      case default
        text = 'on the edge of vertices ' // whole_number(mesh%vertex(t%place)) // ' and ' // &
          whole_number(mesh%vertex(mesh%next(t%place)))
      end select
    end function where_is
  end subroutine check_t_suitability

  subroutine extend(mesh, v, extension)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: v                     !! T-junction
    type(extension_type), intent(out) :: extension

    type(star_type) :: star
    integer :: ahead

    extension%v = v
    call star_of(mesh, v, star)
    if (star%n /= 4) return
    ahead = findloc(star%edge, 0, dim=1)
    call note(at_vertex, v, mod(ahead, 2))
    call follow(ahead, 2)
    call follow(modulo(ahead + 1, 4) + 1, 1)

  contains

    subroutine follow(k, bays)
      integer, intent(in) :: k, bays

      type(ray_type) :: ray
      type(star_type) :: from
      real(wp) :: length
      integer :: bay, edge

      call start_ray(v, k, ray)
      do bay = 1, bays
        if (.not. ray%goes_on) return
        if (ray%v > 0) then
          call star_of(mesh, ray%v, from)
          edge = abs(from%edge(ray%k))
          if (edge > 0) then
            call note(along_edge, the_edge(edge), 0)
          else
            call note(through_face, mesh%face(from%half_edge(ray%k)), mod(from%axis(ray%k), 2))
          end if
        else
          call note(through_face, ray%face, mod(ray%axis, 2))
        end if
        call step_ray(mesh, ray, length)
        if (ray%v == 0) then
          call note(on_edge, the_edge(ray%edge), 0)
        else
          call star_of(mesh, ray%v, from)
          if (is_plain(from)) call note(at_vertex, ray%v, mod(ray%k, 2))
        end if
      end do
    end subroutine follow

    pure integer function the_edge(h)
      integer, intent(in) :: h

      the_edge = h
      if (mesh%twin(h) > 0) the_edge = min(h, mesh%twin(h))
    end function the_edge

    subroutine note(kind, place, axis)
      integer, intent(in) :: kind, place, axis

      extension%n = extension%n + 1
      extension%traces(extension%n)%kind = kind
      extension%traces(extension%n)%place = place
      extension%traces(extension%n)%axis = axis
    end subroutine note
  end subroutine extend

  pure integer function crossing(a, b) result(trace)
    !! A trace of a that b crosses, 0: none.
    type(extension_type), intent(in) :: a, b

    integer :: i, j

    do i = 1, a%n
      do j = 1, b%n
        associate (s => a%traces(i), t => b%traces(j))
          trace = i
          if (s%place /= t%place) cycle
          if (s%kind == t%kind .and. s%kind <= through_face .and. s%axis /= t%axis) return
          if (s%kind == on_edge .and. t%kind == along_edge) return
          if (s%kind == along_edge .and. t%kind == on_edge) return
        end associate
      end do
    end do
    trace = 0
  end function crossing
end module t_quad_suitability
