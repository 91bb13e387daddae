module spline_slots
  !! Which control points an unstructured bicubic spline has, and where in its mesh they belong.
  !!
  !! Every vertex is one function, but for these places:
  !! - Along creases and the boundary the spline is that of open knot vectors: a vertex carries a
  !!   point on the crease and one inside for each of its sides. Where the crease has a corner it
  !!   carries the corner itself, a point on each crease edge and one inside each corner.
  !! - A seam (seam_lines) has points like a crease, and inner Bezier coefficients on one of its
  !!   sides; those on the other side follow.
  !! - The faces of a compact extraordinary point have, but for the corner at the point itself,
  !! their
  !!   inner Bezier coefficients as control points: the spline is once differentiable around them.
  !!   A vertex that has no other faces has no function then. Each of these faces has two more
  !!   (`middle`, beside the edge at whose corner it is stored, and `centre`).
  !! - An extraordinary point has three control points of a triangle in its tangent plane, and one
  !!   more (`twist`) when the number of its faces is even; one inner coefficient of a compact
  !!   point or one point of a seam then follows from the others (`dependent`, `solved`). A vertex
  !!   of more than two faces on the boundary has a plane and a twist.
  use extraction_mesh, only: whole_number
  use quad_mesh, only: quad_mesh_type, next_corner, previous_corner, face_of
  use seam_lines, only: straight_on
  implicit none (type, external)
  private
  public :: slots_type, number_slots

  type :: slots_type
    integer :: n = 0                         !! control points
    integer, allocatable :: irregular(:)     !! corner at the extraordinary point of each face, 0:
                                             !! there is none (nf)
    integer, allocatable :: inner(:)         !! control point inside at each corner; of irregular
                                             !! faces their own ones, 0 at the point itself (4*nf)
    integer, allocatable :: curve(:,:)       !! those of the edges of creases and seams at start and
                                             !! end; < 0: see solved; 0: an extraordinary point
                                             !! (2,4*nf)
    integer, allocatable :: beyond(:,:)      !! crease edge that goes on smoothly at start and end:
                                             !! > 0 away from it, < 0 towards it, 0: none (2,4*nf)
    integer, allocatable :: vertex(:)        !! corner of a crease (nv)
    integer, allocatable :: plane(:)         !! first of three at an extraordinary point (nv)
    integer, allocatable :: middle(:)        !! (4*nf)
    integer, allocatable :: centre(:)        !! (nf)
    integer, allocatable :: twist(:)         !! (nv)
    integer, allocatable :: dependent(:)     !! extraordinary point from whose ring the inner
                                             !! coefficient at a corner follows (4*nf)
    integer, allocatable :: solved(:)        !! extraordinary point from whose condition the control
                                             !! point of a seam at a vertex follows (nv)
    integer, allocatable :: curve_edge(:)    !! a smooth crease edge that leaves (> 0) or meets
                                             !! (< 0) each vertex, 0: none (nv)
  end type slots_type

contains

  subroutine number_slots(mesh, slots, message)
    type(quad_mesh_type), intent(in) :: mesh
    type(slots_type), intent(out) :: slots
    character(:), allocatable, intent(out) :: message    !! what is not supported; empty: nothing

    integer :: v

    message = ''
    allocate (slots%irregular(mesh%nf), slots%centre(mesh%nf), source=0)
    allocate (slots%inner(4*mesh%nf), slots%middle(4*mesh%nf), slots%dependent(4*mesh%nf), source=0)
    allocate (slots%curve(2,4*mesh%nf), slots%beyond(2,4*mesh%nf), source=0)
    allocate (slots%vertex(mesh%nv), slots%plane(mesh%nv), slots%twist(mesh%nv), &
      slots%curve_edge(mesh%nv), slots%solved(mesh%nv), source=0)
    call find_irregular_faces(mesh, slots, message)
    if (len(message) > 0) return
    call find_solved(mesh, slots, message)
    if (len(message) > 0) return
    do v = 1, mesh%nv
      if (mesh%corner(v) == 0) cycle
      call number_vertex(mesh, v, slots, message)
      if (len(message) > 0) return
    end do
  end subroutine number_slots

  pure subroutine find_irregular_faces(mesh, slots, message)
    type(quad_mesh_type), intent(in) :: mesh
    type(slots_type), intent(inout) :: slots
    character(:), allocatable, intent(inout) :: message

    integer :: c, f, v

    do c = 1, 4*mesh%nf
      if (.not. mesh%compact(mesh%vertex(c)) .or. mesh%is_boundary(mesh%vertex(c))) cycle
      f = face_of(c)
      if (slots%irregular(f) > 0) then
        message = 'face ' // whole_number(f) // ' has two extraordinary points, vertices ' // &
          whole_number(mesh%vertex(slots%irregular(f))) // ' and ' // &
          whole_number(mesh%vertex(c)) // ': refine the mesh once, so that they lie in different ' &
          // 'faces'
        return
      end if
      slots%irregular(f) = c
    end do
    ! the last face's coefficient at the far end of its first edge
    do v = 1, mesh%nv
      if (.not. mesh%compact(v) .or. mod(mesh%faces(v), 2) == 1 .or. mesh%is_boundary(v)) cycle
      c = next_corner(mesh%twin(mesh%corner(v)))
      slots%dependent(next_corner(c)) = v
    end do
  end subroutine find_irregular_faces

  subroutine find_solved(mesh, slots, message)
    !! For points of an even number of faces with seams: a seam's control point two edges at least
    !! away from other extraordinary points.
    type(quad_mesh_type), intent(in) :: mesh
    type(slots_type), intent(inout) :: slots
    character(:), allocatable, intent(inout) :: message

    integer :: c, k, v, w

    points: do v = 1, mesh%nv
      if (.not. mesh%is_extraordinary(v) .or. mesh%compact(v) .or. mod(mesh%faces(v), 2) == 1) cycle
      c = mesh%corner(v)
      do k = 1, mesh%faces(v)
        w = mesh%vertex(next_corner(c))
        if (.not. mesh%is_star(w)) then
          if (.not. any_crease(w)) then
            if (mesh%is_star(mesh%vertex(next_corner(straight_on(mesh, c))))) w = 0
          end if
          if (w > 0) then
            slots%solved(w) = v
            cycle points
          end if
        end if
        c = mesh%turn(c)
      end do
      message = 'extraordinary point ' // whole_number(v) // ' has ' // &
        whole_number(mesh%faces(v)) // ' faces, and other extraordinary points at the distance ' &
        // 'of one or two edges along all of its edges: refine the mesh once'
      return
    end do points

  contains

    logical function any_crease(w)
      integer, intent(in) :: w               !! vertex

      integer :: k, other

      any_crease = mesh%is_boundary(w)
      other = mesh%corner(w)
      do k = 1, mesh%faces(w)
        if (any_crease) return
        any_crease = mesh%crease(other)
        other = mesh%turn(other)
      end do
    end function any_crease
  end subroutine find_solved

  pure logical function leads(mesh, c)
    !! Whether the inner coefficient at a corner is next to a seam and a control point: of the two
    !! sides of a seam's edge one leads and the other follows from the seam's condition.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                 !! corner

    leads = .false.
    if (mesh%seam(c) .eqv. mesh%seam(previous_corner(c))) return
    if (mesh%seam(c)) then
      leads = c < mesh%twin(c)
    else
      leads = previous_corner(c) < mesh%twin(previous_corner(c))
    end if
  end function leads

  subroutine number_vertex(mesh, v, slots, message)
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: v
    type(slots_type), intent(inout) :: slots
    character(:), allocatable, intent(inout) :: message

    integer :: fan(mesh%faces(v)), spoke(mesh%faces(v)+1), creases(mesh%faces(v)+1)
    integer :: k, n, nc, ns

    n = mesh%faces(v)
    fan(1) = mesh%corner(v)
    do k = 2, n
      fan(k) = mesh%turn(fan(k-1))
    end do
    if (mesh%is_star(v)) then
      if (mesh%compact(v) .and. mesh%is_boundary(v)) then
        message = 'vertex ' // whole_number(v) // ' of the boundary has ' // whole_number(n) // &
          ' faces, and lines of edges from there cross those of other such vertices: one or two ' &
          // 'faces are supported there'
        return
      end if
      slots%plane(v) = slots%n + 1
      slots%n = slots%n + 3
      if (mesh%compact(v)) call number_ring(fan, slots)
      if (mod(n, 2) == 0 .or. mesh%is_boundary(v)) then
        slots%n = slots%n + 1
        slots%twist(v) = slots%n
      end if
      return
    end if

    ! spokes: edges that leave (> 0), or the last one of the boundary, which arrives (< 0)
    spoke(1:n) = fan
    ns = n
    if (mesh%is_boundary(v)) then
      ns = n + 1
      spoke(ns) = -previous_corner(fan(n))
    end if
    nc = 0
    do k = 1, ns
      if (.not. mesh%crease(abs(spoke(k)))) cycle
      nc = nc + 1
      creases(nc) = k
    end do
    call number_seam()
    select case (nc)
    case (0)
      call number_inner(fan)
    case (1)
      message = 'the crease at vertex ' // whole_number(v) // &
        ' ends inside the surface: lead it to the boundary or close it'
    case default
      call number_creases(creases(1:nc))
    end select

  contains

    subroutine number_seam()
      !! The trace of a seam that runs through or ends here.
      integer :: i, through

      through = 0
      do i = 1, n
        if (.not. mesh%seam(fan(i))) cycle
        if (through > 0 .and. nc == 0) then
          call set_curve(fan(i), curve_of(through))
          call set_beyond(fan(i), through)
          call set_beyond(through, fan(i))
          slots%curve_edge(v) = through
          cycle
        end if
        through = fan(i)
        if (slots%solved(v) > 0) then
          call set_curve(fan(i), -slots%solved(v))
        else
          slots%n = slots%n + 1
          call set_curve(fan(i), slots%n)
        end if
      end do
    end subroutine number_seam

    subroutine number_inner(corners)
      !! One function of a smooth fan, and own coefficients in its irregular faces.
      integer, intent(in) :: corners(:)

      integer :: i, shared

      shared = 0
      do i = 1, size(corners)
        if (slots%dependent(corners(i)) > 0) cycle
        if (slots%irregular(face_of(corners(i))) > 0 .or. leads(mesh, corners(i))) then
          slots%n = slots%n + 1
          slots%inner(corners(i)) = slots%n
        else if (mesh%seam(corners(i)) .or. mesh%seam(previous_corner(corners(i)))) then
          cycle
        else
          if (shared == 0) then
            slots%n = slots%n + 1
            shared = slots%n
          end if
          slots%inner(corners(i)) = shared
        end if
      end do
    end subroutine number_inner

    subroutine number_creases(place)
      integer, intent(in) :: place(:)      !! of the creases among the spokes

      integer :: faces(n), first, i, j, last, m, mate(size(place)), sectors

      sectors = size(place)
      if (ns > n) sectors = sectors - 1
      mate = 0
      do i = 1, sectors
        first = place(i)
        j = mod(i, size(place)) + 1
        last = place(j)
        if (last <= first) last = last + n
        m = last - first
        if (m > 2) then
          message = 'vertex ' // whole_number(v) // ' has ' // whole_number(m) // &
            ' faces (one of them is face ' // whole_number(face_of(fan(first))) // &
            ') on one side of the boundary or of a crease: one or two are supported'
          return
        end if
        faces(1:m) = fan([(mod(k - 1, n) + 1, k = first, last - 1)])
        call number_inner(faces(1:m))
        if (m < 2) cycle
        if ((mate(i) > 0 .and. mate(i) /= j) .or. (mate(j) > 0 .and. mate(j) /= i)) then
          message = 'more than two creases at vertex ' // whole_number(v) // &
            ' would have to go on smoothly into one another'
          return
        end if
        mate(i) = j
        mate(j) = i
      end do
      if (count(mate > 0) > 2) then
        message = 'two creases cross at vertex ' // whole_number(v) // &
          ' and both would have to be smooth there'
        return
      end if
      if (all(mate == 0)) then
        slots%n = slots%n + 1
        slots%vertex(v) = slots%n
      end if
      do i = 1, size(place)
        if (mate(i) > 0 .and. mate(i) < i) then
          call set_curve(spoke(place(i)), curve_of(spoke(place(mate(i)))))
        else
          slots%n = slots%n + 1
          call set_curve(spoke(place(i)), slots%n)
        end if
        if (mate(i) == 0) cycle
        call set_beyond(spoke(place(i)), spoke(place(mate(i))))
        slots%curve_edge(v) = spoke(place(i))
      end do
    end subroutine number_creases

    integer function curve_of(edge)
      integer, intent(in) :: edge          !! spoke

      curve_of = slots%curve(merge(1, 2, edge > 0), abs(edge))
    end function curve_of

    subroutine set_curve(edge, id)
      integer, intent(in) :: edge, id      !! spoke, its control point at v

      slots%curve(merge(1, 2, edge > 0),abs(edge)) = id
      if (mesh%twin(abs(edge)) > 0) slots%curve(merge(2, 1, edge > 0),mesh%twin(abs(edge))) = id
    end subroutine set_curve

    subroutine set_beyond(edge, other)
      integer, intent(in) :: edge, other   !! spokes

      slots%beyond(merge(1, 2, edge > 0),abs(edge)) = other
      if (mesh%twin(abs(edge)) > 0) slots%beyond(merge(2, 1, edge > 0),mesh%twin(abs(edge))) = other
    end subroutine set_beyond
  end subroutine number_vertex

  pure subroutine number_ring(fan, slots)
    !! What belongs to the faces of a compact point.
    integer, intent(in) :: fan(:)            !! its corners, counter-clockwise
    type(slots_type), intent(inout) :: slots

    integer :: k

    do k = 1, size(fan)
      slots%middle(fan(k)) = slots%n + 1
      slots%centre(face_of(fan(k))) = slots%n + 2
      slots%n = slots%n + 2
    end do
  end subroutine number_ring
end module spline_slots
