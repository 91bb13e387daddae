module spline_slots
  !! Which control points an unstructured bicubic spline has, and where in its mesh they belong.
  !!
  !! Every vertex is one function, but for these places:
  !! - Along creases and the boundary the spline is that of open knot vectors: a vertex carries a
  !!   point on the crease and one inside for each of its sides. Where the crease has a corner it
  !!   carries the corner itself, a point on each crease edge and one inside each corner.
  !! - A seam (seam_lines) has points like a crease, and inner Bezier coefficients on one of its
  !!   sides; those on the other side follow. Where a short seam fades, it has those of both sides,
  !!   and no point: the spline is once differentiable there.
  !! - An extraordinary point has three control points of a triangle in its tangent plane, and one
  !!   more (`twist`) when the number of its faces is even; one control point at the other end of
  !!   one of its edges then follows from the others (`solved`). A vertex of more than two faces on
  !!   the boundary has a plane and two twists, those of the faces at the boundary, so that slopes
  !!   across it are these and no others; where nothing can be solved for, the first twist only.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use quad_mesh, only: quad_mesh_type, next_corner, previous_corner, face_of
  use seam_lines, only: straight_on, binds
  implicit none (type, external)
  private
  public :: slots_type, number_slots

  type :: slots_type
    integer :: n = 0                         !! control points
    integer, allocatable :: inner(:)         !! control point inside at each corner; < 0: see
                                             !! solved; 0: an extraordinary point, or it follows
                                             !! from a seam (4*nf)
    integer, allocatable :: curve(:,:)       !! those of the edges of creases and seams at start and
                                             !! end; < 0: see solved; 0: an extraordinary point, or
                                             !! a short seam fades (2,4*nf)
    integer, allocatable :: beyond(:,:)      !! crease edge that goes on smoothly at start and end:
                                             !! > 0 away from it, < 0 towards it, 0: none (2,4*nf)
    integer, allocatable :: vertex(:)        !! corner of a crease (nv)
    integer, allocatable :: plane(:)         !! first of three at an extraordinary point (nv)
    integer, allocatable :: twist(:)         !! the first one (nv)
    integer, allocatable :: solved(:)        !! edge from each extraordinary point at whose end a
                                             !! control point follows from the point's condition,
                                             !! and bears its number with a minus; 0: none (nv)
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
    allocate (slots%inner(4*mesh%nf), source=0)
    allocate (slots%curve(2,4*mesh%nf), slots%beyond(2,4*mesh%nf), source=0)
    allocate (slots%vertex(mesh%nv), slots%plane(mesh%nv), slots%twist(mesh%nv), &
      slots%curve_edge(mesh%nv), slots%solved(mesh%nv), source=0)
    call find_solved(mesh, slots, message)
    if (len(message) > 0) return
    do v = 1, mesh%nv
      if (mesh%corner(v) == 0) cycle
      call number_vertex(mesh, v, slots, message)
      if (len(message) > 0) return
    end do
  end subroutine number_slots

  subroutine find_solved(mesh, slots, message)
    !! For points with an equation to solve: an edge at whose end a control point can follow without
    !! regard to other such points.
    type(quad_mesh_type), intent(in) :: mesh
    type(slots_type), intent(inout) :: slots
    character(:), allocatable, intent(inout) :: message

    integer :: c, k, t, v

    points: do v = 1, mesh%nv
      if (.not. has_equation(mesh, v)) cycle
      c = mesh%corner(v)
      do k = 1, mesh%faces(v)
        slots%solved(v) = c
        if (mesh%seam(c) .and. .not. mesh%fades(2,c)) then
          if (runs_on(mesh, c)) cycle points
        else if (mesh%seam(c)) then
          t = mesh%twin(c)
          if (is_free(mesh, next_corner(c))) slots%inner(next_corner(c)) = -v
          if (slots%inner(next_corner(c)) == -v) cycle points
          if (is_free(mesh, mesh%twin(previous_corner(t)))) slots%inner(t) = -v
          if (slots%inner(t) == -v) cycle points
        end if
        c = mesh%turn(c)
      end do
      slots%solved(v) = 0
      if (mesh%is_boundary(v)) cycle
      message = 'extraordinary point ' // whole_number(v) // ' has ' // &
        whole_number(mesh%faces(v)) // ' faces, and other extraordinary points at the distance ' &
        // 'of one or two edges along all of its edges: refine the mesh once or twice'
      return
    end do points
  end subroutine find_solved

  pure logical function has_equation(mesh, v)
    !! Points of an even number of faces, and those on the boundary unless their A is too small to
    !! solve for what it acts on.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: v                 !! vertex

    has_equation = mesh%is_star(v)
    if (.not. has_equation) return
    if (mesh%is_boundary(v)) then
      has_equation = abs(cos(mesh%angle(v))) > 0.05_wp
    else
      has_equation = mod(mesh%faces(v), 2) == 0
    end if
  end function has_equation

  pure logical function runs_on(mesh, c)
    !! Whether the control point of a seam at the end of its first edge belongs to no other point:
    !! it does where the seam ends there or one edge later.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                 !! corner that the edge starts from

    integer :: k, other, w

    w = mesh%vertex(next_corner(c))
    runs_on = .not. mesh%is_star(w)
    if (.not. runs_on .or. mesh%is_boundary(w)) return
    other = mesh%corner(w)
    do k = 1, mesh%faces(w)
      if (mesh%crease(other)) return
      other = mesh%turn(other)
    end do
    runs_on = .not. mesh%is_star(mesh%vertex(next_corner(straight_on(mesh, c))))
  end function runs_on

  pure logical function is_free(mesh, c)
    !! Whether an edge, at whose start a short seam fades, is on no other seam, but for one that
    !! fades as well and comes from a point without equation.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                 !! corner that the edge starts from

    is_free = .not. mesh%seam(c)
    if (mesh%seam(c) .and. mesh%fades(1,c)) &
      is_free = .not. has_equation(mesh, mesh%vertex(next_corner(c)))
  end function is_free

  pure logical function leads(mesh, c)
    !! Whether the inner coefficient at a corner is next to a seam and a control point: of the two
    !! sides of a seam's edge one leads and the other follows from the seam's condition, if this
    !! binds.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                 !! corner

    integer :: last

    last = previous_corner(c)
    leads = mesh%seam(c) .or. mesh%seam(last)
    if (binds(mesh, c, 1)) leads = c < mesh%twin(c)
    if (binds(mesh, last, 2)) leads = last < mesh%twin(last)
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
      slots%plane(v) = slots%n + 1
      slots%n = slots%n + 3
      if (mod(n, 2) == 0 .or. mesh%is_boundary(v)) then
        slots%twist(v) = slots%n + 1
        slots%n = slots%n + 1
        if (mesh%is_boundary(v) .and. slots%solved(v) > 0) slots%n = slots%n + 1
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
      integer :: from, i, k, through

      through = 0
      do i = 1, n
        if (.not. binds(mesh, fan(i), 1)) cycle
        if (through > 0 .and. nc == 0) then
          call set_curve(fan(i), curve_of(through))
          call set_beyond(fan(i), through)
          call set_beyond(through, fan(i))
          slots%curve_edge(v) = through
          cycle
        end if
        through = fan(i)
        from = 0
        do k = 1, n
          if (binds(mesh, fan(k), 1) .and. (k == i .or. nc == 0)) &
            from = max(from, solved_from(mesh%twin(fan(k))))
        end do
        if (from > 0) then
          call set_curve(fan(i), -from)
        else
          slots%n = slots%n + 1
          call set_curve(fan(i), slots%n)
        end if
      end do
    end subroutine number_seam

    integer function solved_from(edge)
      !! The extraordinary point whose condition the control point at the end of an edge follows
      !! from, 0: none.
      integer, intent(in) :: edge

      solved_from = 0
      if (slots%solved(mesh%vertex(edge)) == edge) solved_from = mesh%vertex(edge)
    end function solved_from

    subroutine number_inner(corners)
      !! One function of a smooth fan, and own coefficients beside seams.
      integer, intent(in) :: corners(:)

      integer :: i, shared

      shared = 0
      do i = 1, size(corners)
        if (slots%inner(corners(i)) < 0) cycle
        if (leads(mesh, corners(i))) then
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
end module spline_slots
