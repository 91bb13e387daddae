module t_quad_functions
  !! The functions of a quadrilateral mesh with T-junctions away from extraordinary points: products
  !! of two cubic B-splines whose knots are found by rays from a vertex (see t_spline).
  !!
  !! As in spline_slots, a vertex carries one function where it is plain; on creases and the
  !! boundary one on the crease and one inside on each side, with knots as at the ends of open knot
  !! vectors; at a corner of a crease that of the corner itself, one on each crease edge and one
  !! inside each quadrant. Extraordinary points carry none: see t_quad_rings.
  !!
  !! Each function consists of pieces, one a quadrant of its vertex: the product for positive
  !! parameters along the two rays that bound the quadrant.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use t_quad_mesh, only: t_quad_mesh_type
  use t_quad_rays, only: star_type, star_of, two_lines, smooth_mate, is_irregular
  implicit none (type, external)
  private
  public :: t_functions_type, piece_type, list_functions

  type :: piece_type
    integer :: id = 0                        !! function
    integer :: v = 0                         !! its vertex
    integer :: half_edge = 0                 !! that starts there, of the quadrant's face
    integer :: axis = 0                      !! direction of its first axis in the face
    real(wp) :: knots(5,2) = 0               !! along the quadrant's rays, the vertex at 0
    real(wp) :: factor = 1
  end type piece_type

  type :: t_functions_type
    integer :: n = 0                         !! functions
    integer :: np = 0                        !! pieces
    type(piece_type), allocatable :: pieces(:)
    integer, allocatable :: inner(:)         !! function inside at the start of a half-edge (nh)
    integer, allocatable :: curve(:,:)       !! of a crease at start and end of an edge (2,nh)
    integer, allocatable :: vertex(:)        !! corner of a crease (nv)
  end type t_functions_type

contains

  subroutine list_functions(mesh, functions, message)
    type(t_quad_mesh_type), intent(in) :: mesh
    type(t_functions_type), intent(out) :: functions
    character(:), allocatable, intent(out) :: message    !! what is not supported; empty: nothing

    type(star_type) :: star
    integer :: v

    message = ''
    allocate (functions%inner(mesh%nh), functions%curve(2,mesh%nh), functions%vertex(mesh%nv), &
      source=0)
    allocate (functions%pieces(4*mesh%nh + 16))
    do v = 1, mesh%nv
      if (mesh%out(v) == 0) cycle
      call star_of(mesh, v, star)
      if (is_irregular(star)) cycle
      call list_vertex(mesh, star, functions, message)
      if (len(message) > 0) return
    end do
  end subroutine list_functions

  subroutine list_vertex(mesh, star, functions, message)
    type(t_quad_mesh_type), intent(in) :: mesh
    type(star_type), intent(in) :: star
    type(t_functions_type), intent(inout) :: functions
    character(:), allocatable, intent(inout) :: message

    real(wp) :: lines(2,size(star%edge))     !! distances along the rays
    integer :: creases(size(star%edge)), mate(size(star%edge))
    integer :: i, j, k, m, nc, q

    nc = 0
    do k = 1, size(star%edge)
      call two_lines(mesh, star%v, k, lines(:,k))
      mate(k) = 0
      if (.not. star%crease(k)) cycle
      nc = nc + 1
      creases(nc) = k
      mate(k) = smooth_mate(star, k)
    end do
    if (nc == 0) then
      functions%n = functions%n + 1
      do q = 1, 4
        call add_piece(functions%n, q, through(q, opposite(q)), through(after(q), &
          opposite(after(q))), 1.0_wp)
        functions%inner(star%half_edge(q)) = functions%n
      end do
      return
    else if (nc == 1) then
      message = 'the crease at vertex ' // whole_number(star%v) // &
        ' ends inside the surface: lead it to the boundary or close it'
      return
    end if
    do k = 1, size(star%edge)
      if (mate(k) == 0) cycle
      if (mate(mate(k)) /= k .or. count(mate > 0) > 2) then
        message = 'two creases cross at vertex ' // whole_number(star%v) // &
          ' and both would have to be smooth there'
        return
      end if
    end do

    ! inside each sector
    do i = 1, nc
      if (i == nc .and. .not. star%closed) exit
      k = creases(i)
      j = creases(mod(i, nc) + 1)
      m = j - k
      if (j <= k) m = m + star%n
      functions%n = functions%n + 1
      select case (m)
      case (1)
        call add_piece(functions%n, k, inside(k), inside(j), 1.0_wp)
      case (2)
        call add_piece(functions%n, k, through(k, j), inside(after(k)), 1.0_wp)
        call add_piece(functions%n, after(k), inside(after(k)), through(j, k), 1.0_wp)
      case default
        message = 'vertex ' // whole_number(star%v) // ' has ' // whole_number(m) // &
          ' faces (one of them is face ' // whole_number(mesh%face(star%half_edge(k))) // &
          ') on one side of the boundary or of a crease: one or two are supported'
        return
      end select
      q = k
      do while (q /= j)
        functions%inner(star%half_edge(q)) = functions%n
        q = after(q)
      end do
    end do

    ! on the corner and the creases
    if (all(mate == 0)) then
      functions%n = functions%n + 1
      functions%vertex(star%v) = functions%n
      do q = 1, star%n
        call add_piece(functions%n, q, first_only(q), first_only(after(q)), 1.0_wp)
      end do
    end if
    do i = 1, nc
      k = creases(i)
      if (mate(k) > 0 .and. mate(k) < k) then
        call set_curve(k, curve_of(mate(k)))
        cycle
      end if
      functions%n = functions%n + 1
      call set_curve(k, functions%n)
      do q = 1, star%n
        if (q == k) then
          call add_piece(functions%n, q, along(k), first_only(after(q)), 1.0_wp)
        else if (after(q) == k) then
          call add_piece(functions%n, q, first_only(q), along(k), 1.0_wp)
        else if (mate(k) == 0) then
          cycle
        else if (q == mate(k)) then
          call add_piece(functions%n, q, through(mate(k), k), first_only(after(q)), 1.0_wp)
        else if (after(q) == mate(k)) then
          call add_piece(functions%n, q, first_only(q), through(mate(k), k), 1.0_wp)
        else
          ! no edge of the quadrant is on the crease, but its corner is
          call add_piece(functions%n, q, first_only(q), first_only(after(q)), &
            value_at_vertex(through(k, mate(k))))
        end if
      end do
    end do

  contains

    integer function after(k)
      integer, intent(in) :: k               !! ray

      after = k + 1
      if (star%closed .and. k == star%n) after = 1
    end function after

    integer function opposite(k)
      integer, intent(in) :: k               !! ray of a plain vertex

      opposite = modulo(k + 1, 4) + 1
    end function opposite

    function through(k, other) result(knots)
      integer, intent(in) :: k, other        !! ray, the ray that goes on behind the vertex
      real(wp) :: knots(5)

      knots = [-lines(2,other), -lines(1,other), 0.0_wp, lines(1,k), lines(2,k)]
    end function through

    function inside(k) result(knots)
      !! The second function of an open knot vector.
      integer, intent(in) :: k
      real(wp) :: knots(5)

      knots = [0.0_wp, 0.0_wp, 0.0_wp, lines(1,k), lines(2,k)]
    end function inside

    function first_only(k) result(knots)
      !! The first function of an open knot vector.
      integer, intent(in) :: k
      real(wp) :: knots(5)

      knots = [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, lines(1,k)]
    end function first_only

    function along(k) result(knots)
      integer, intent(in) :: k               !! a crease
      real(wp) :: knots(5)

      knots = inside(k)
      if (mate(k) > 0) knots = through(k, mate(k))
    end function along

    subroutine add_piece(id, q, first, second, factor)
      integer, intent(in) :: id, q           !! function, quadrant
      real(wp), intent(in) :: first(5), second(5), factor

      type(piece_type), allocatable :: more(:)

      if (functions%np == size(functions%pieces)) then
        allocate (more(2*functions%np))
        more(1:functions%np) = functions%pieces
        call move_alloc(more, functions%pieces)
      end if
      functions%np = functions%np + 1
      associate (piece => functions%pieces(functions%np))
        piece%id = id
        piece%v = star%v
        piece%half_edge = star%half_edge(q)
        piece%axis = star%axis(q)
        piece%knots(:,1) = first
        piece%knots(:,2) = second
        piece%factor = factor
      end associate
    end subroutine add_piece

    integer function curve_of(k)
      integer, intent(in) :: k               !! ray, a crease

      curve_of = functions%curve(merge(1, 2, star%edge(k) > 0),abs(star%edge(k)))
    end function curve_of

    subroutine set_curve(k, id)
      integer, intent(in) :: k, id

      integer :: end_of, h

      h = abs(star%edge(k))
      end_of = merge(1, 2, star%edge(k) > 0)
      functions%curve(end_of,h) = id
      if (mesh%twin(h) > 0) functions%curve(3-end_of,mesh%twin(h)) = id
    end subroutine set_curve
  end subroutine list_vertex

  pure real(wp) function value_at_vertex(knots)
    !! Of a B-spline at its middle knot.
    real(wp), intent(in) :: knots(5)

    value_at_vertex = ((knots(3) - knots(1))*(knots(4) - knots(3))/(knots(4) - knots(1)) &
      + (knots(5) - knots(3))*(knots(3) - knots(2))/(knots(5) - knots(2))) / (knots(4) - knots(2))
  end function value_at_vertex
end module t_quad_functions
