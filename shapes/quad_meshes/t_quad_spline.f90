module t_quad_spline
  !! T-splines over quadrilateral control meshes of any topology with T-junctions, as elements with
  !! extraction operators.
  !!
  !! Away from extraordinary points the functions are the bicubic ones of T-splines (Sederberg and
  !! others, 2003; Scott and others, CMAME 254, 2013), from the knots that rays meet
  !! (t_quad_functions): C2 across all lines, sums of one where the mesh is suitable for analysis
  !! (t_quad_suitability). Elements are faces, cut by the knots of all functions that live on them.
  !! In the faces around an extraordinary point, which has two rings of faces without T-junctions,
  !! the spline is that of these rings alone (t_quad_rings), whose functions are continuous with
  !! their derivative beyond. So T-junctions stop where they are: lines run on over two faces at
  !! most.
  !!
  !! Linear independence: the inner Bezier coefficients of the elements at a vertex, which are
  !! values of polar forms, tell the functions of suitable meshes apart; those of the rings do as in
  !! unstructured_spline.
  use kinds, only: wp
  use extraction_mesh, only: extraction_mesh_type, whole_number
  use knot_vectors, only: polar_row, relative_knots
  use sparse_row, only: row_type, clear, add_scaled_term, add_term
  use t_quad_mesh, only: t_quad_mesh_type
  use t_quad_rays, only: nearby
  use t_quad_functions, only: t_functions_type, list_functions
  use t_quad_supports, only: hit_type, unfold, chart_box
  use t_quad_outline, only: ring_mesh_type
  use t_quad_rings, only: t_rings_type, create_rings
  implicit none (type, external)
  private
  public :: t_quad_spline_type, create_t_quad_spline, t_quad_elements, elements_on_edge

  type :: t_quad_spline_type
    type(t_quad_mesh_type) :: mesh
    type(t_functions_type) :: functions
    type(t_rings_type) :: rings
    integer :: n = 0                         !! control points
    real(wp), allocatable :: cp(:,:)         !! their places (3,n) [length]
    integer :: ne = 0                        !! elements
    integer, allocatable :: face(:)          !! of each element (ne)
    real(wp), allocatable :: lo(:,:)         !! its corners in the face's parameters (2,ne)
    real(wp), allocatable :: hi(:,:)         !! (2,ne)
    integer, allocatable :: degree(:)        !! (ne)
    type(row_type), allocatable :: b(:,:)    !! Bezier coefficients of each element (25,ne)
  end type t_quad_spline_type

contains

  subroutine create_t_quad_spline(mesh, ring_mesh, spline, message)
    !! Functions and elements. Control points are left at the origin.
    type(t_quad_mesh_type), intent(in) :: mesh
    type(ring_mesh_type), intent(in) :: ring_mesh
    type(t_quad_spline_type), intent(out) :: spline
    character(:), allocatable, intent(out) :: message    !! what is not supported; empty: nothing

    type(hit_type), allocatable :: hits(:)
    integer :: e, k, n

    spline%mesh = mesh
    call list_functions(mesh, spline%functions, message)
    if (len(message) > 0) return
    call create_rings(mesh, spline%functions, ring_mesh, spline%rings, message)
    if (len(message) > 0) return
    allocate (hits(16*mesh%nh))
    n = 0
    do k = 1, spline%functions%np
      call unfold(mesh, spline%functions%pieces(k), k, spline%rings%zone, hits, n, message)
      if (len(message) > 0) return
    end do
    call cut_faces(spline, hits(1:n))
    allocate (spline%degree(spline%ne), source=3)
    allocate (spline%b(25,spline%ne))
    do e = 1, spline%ne
      do k = 1, 25
        call clear(spline%b(k,e))
      end do
    end do
    call add_pieces(spline, hits(1:n))
    call join_rings(spline, message)
    if (len(message) > 0) return
    call check_sums(spline, message)
    if (len(message) > 0) return
    call drop_unused(spline)
    allocate (spline%cp(3,spline%n), source=0.0_wp)
  end subroutine create_t_quad_spline

  subroutine cut_faces(spline, hits)
    type(t_quad_spline_type), intent(inout) :: spline
    type(hit_type), intent(in) :: hits(:)

    type :: cut_list
      real(wp), allocatable :: at(:)
    end type cut_list
    type(cut_list), allocatable :: cuts(:,:)
    real(wp) :: cut(2), high(2), low(2), x(2)
    integer :: d, f, i, j, k, m

    associate (mesh => spline%mesh)
      allocate (cuts(2,mesh%nf))
      do f = 1, mesh%nf
        do d = 1, 2
          cuts(d,f)%at = [0.0_wp, mesh%size(d,f)]
        end do
      end do
      do k = 1, size(hits)
        associate (piece => spline%functions%pieces(hits(k)%piece))
          f = hits(k)%face
          call chart_box(hits(k), [0.0_wp, 0.0_wp], mesh%size(:,f), low, high)
          do d = 1, 2
            do m = 3, 5
              associate (knot => piece%knots(m,d), room => nearby*minval(mesh%size(:,f)))
                if (knot < low(d) + room .or. knot > high(d) - room) cycle
                ! back into the face: only the coordinate across the cut has a meaning
                x = 0
                x(d) = knot
                cut = hits(k)%p0 + from_chart(x, hits(k)%quarters)
                i = d
                if (mod(hits(k)%quarters, 2) == 1) i = 3 - d
                call insert(cuts(i,f)%at, cut(i), room)
              end associate
            end do
          end do
        end associate
      end do
      spline%ne = 0
      do f = 1, mesh%nf
        spline%ne = spline%ne + (size(cuts(1,f)%at) - 1)*(size(cuts(2,f)%at) - 1)
      end do
      allocate (spline%face(spline%ne), spline%lo(2,spline%ne), spline%hi(2,spline%ne))
      k = 0
      do f = 1, mesh%nf
        do j = 1, size(cuts(2,f)%at) - 1
          do i = 1, size(cuts(1,f)%at) - 1
            k = k + 1
            spline%face(k) = f
            spline%lo(:,k) = [cuts(1,f)%at(i), cuts(2,f)%at(j)]
            spline%hi(:,k) = [cuts(1,f)%at(i+1), cuts(2,f)%at(j+1)]
          end do
        end do
      end do
    end associate

  contains

    pure function from_chart(x, quarters) result(p)
      real(wp), intent(in) :: x(2)
      integer, intent(in) :: quarters
      real(wp) :: p(2)

      select case (modulo(quarters, 4))
      case (0);     p = x
      case (1);     p = [-x(2), x(1)]
      case (2);     p = -x
      case default; p = [x(2), -x(1)]
      end select
    end function from_chart

    pure subroutine insert(list, at, room)
      real(wp), allocatable, intent(inout) :: list(:)
      real(wp), intent(in) :: at, room

      integer :: i

      if (minval(abs(list - at)) < room) return
      i = count(list < at)
      list = [list(1:i), at, list(i+1:)]
    end subroutine insert
  end subroutine cut_faces

  subroutine add_pieces(spline, hits)
    type(t_quad_spline_type), intent(inout) :: spline
    type(hit_type), intent(in) :: hits(:)

    real(wp) :: bx(0:3), by(0:3), high(2), low(2)
    integer, allocatable :: first(:)
    integer :: e, i, j, k, p(2)

    allocate (first(spline%mesh%nf+1), source=0)
    do e = spline%ne, 1, -1
      first(spline%face(e)) = e
    end do
    first(spline%mesh%nf+1) = spline%ne + 1
    do k = 1, size(hits)
      associate (piece => spline%functions%pieces(hits(k)%piece), f => hits(k)%face)
        do e = first(f), first(f+1) - 1
          call chart_box(hits(k), spline%lo(:,e), spline%hi(:,e), low, high)
          ! the other half of a face with a T-junction belongs to another quadrant
          if (any(low < -nearby*high)) cycle
          call b_spline(piece%knots(:,1), low(1), high(1), bx)
          call b_spline(piece%knots(:,2), low(2), high(2), by)
          bx = piece%factor*bx
          do j = 0, 3
            do i = 0, 3
              if (.not. abs(bx(i)*by(j)) > 0) cycle
              p = place_in_face(i, j, hits(k)%quarters)
              call add_scaled_term(spline%b(1+p(1)+4*p(2),e), bx(i)*by(j), piece%id)
            end do
          end do
        end do
      end associate
    end do

  contains

    pure function place_in_face(i, j, quarters) result(p)
      !! Number of a Bezier coefficient along the axes of the face.
      integer, intent(in) :: i, j, quarters
      integer :: p(2)

      select case (modulo(quarters, 4))
      case (0);     p = [i, j]
      case (1);     p = [3 - j, i]
      case (2);     p = [3 - i, 3 - j]
      case default; p = [j, 3 - i]
      end select
    end function place_in_face
  end subroutine add_pieces

  pure subroutine b_spline(knots, low, high, b)
    !! Bezier coefficients of a cubic B-spline on an interval between knots, 0 outside its support.
    real(wp), intent(in) :: knots(5)
    real(wp), intent(in) :: low, high
    real(wp), intent(out) :: b(0:3)

    real(wp) :: c(4), local(-2:3), t(3), u(5)
    integer :: i, k, m

    b = 0
    u = relative_knots(knots, low, high, 3)
    where (abs(u) < 10*nearby) u = 0
    where (abs(u - 1) < 10*nearby) u = 1
    m = count(u <= 0)
    if (m < 1 .or. m > 4) return
    do i = -2, 3
      local(i) = u(min(max(m + i, 1), 5))
    end do
    do k = 0, 3
      t(1:3-k) = 0
      t(4-k:3) = 1
      call polar_row(3, local, t, c)
      b(k) = c(5-m)
    end do
  end subroutine b_spline

  subroutine join_rings(spline, message)
    !! Faces around extraordinary points, and the coefficients that others share with them.
    type(t_quad_spline_type), intent(inout) :: spline
    character(:), allocatable, intent(inout) :: message

    integer :: e, f, k
    logical :: is_whole

    do e = 1, spline%ne
      f = spline%face(e)
      if (spline%rings%zone(f)) then
        spline%degree(e) = spline%rings%degree_of(f)
        do k = 1, (spline%degree(e) + 1)**2
          call spline%rings%coefficient(f, k, spline%b(k,e))
        end do
      else if (spline%rings%touches(f)) then
        is_whole = all(spline%hi(:,e) - spline%lo(:,e) > (1 - nearby)*spline%mesh%size(:,f))
        call spline%rings%join_face(spline%mesh, f, is_whole, spline%b(1:16,e), message)
        if (len(message) > 0) return
      end if
    end do
  end subroutine join_rings

  subroutine check_sums(spline, message)
    !! Functions of suitable meshes sum to one.
    type(t_quad_spline_type), intent(in) :: spline
    character(:), allocatable, intent(inout) :: message

    integer :: e, k

    do e = 1, spline%ne
      do k = 1, (spline%degree(e) + 1)**2
        associate (row => spline%b(k,e))
          if (abs(sum(row%c(1:row%n)) - 1) < 1e-9_wp) cycle
        end associate
        message = 'the functions do not sum to one in face ' // whole_number(spline%face(e)) // &
          ': the lines around it are not those of a T-mesh suitable for analysis'
        return
      end do
    end do
  end subroutine check_sums

  subroutine drop_unused(spline)
    !! Numbers control points anew.
    type(t_quad_spline_type), intent(inout) :: spline

    integer, allocatable :: new(:)
    integer :: e, i, k

    allocate (new(spline%rings%n), source=0)
    spline%n = 0
    do e = 1, spline%ne
      do k = 1, (spline%degree(e) + 1)**2
        associate (row => spline%b(k,e))
          new(row%id(1:row%n)) = 1
        end associate
      end do
    end do
    do i = 1, size(new)
      if (new(i) == 0) cycle
      spline%n = spline%n + 1
      new(i) = spline%n
    end do
    do e = 1, spline%ne
      do k = 1, (spline%degree(e) + 1)**2
        associate (row => spline%b(k,e))
          row%id(1:row%n) = new(row%id(1:row%n))
        end associate
      end do
    end do
    call renumber(spline%functions%inner)
    call renumber(spline%functions%curve(1,:))
    call renumber(spline%functions%curve(2,:))
    call renumber(spline%functions%vertex)
    do i = 1, spline%functions%np
      associate (piece => spline%functions%pieces(i))
        piece%id = new(piece%id)
      end associate
    end do
    call spline%rings%renumber(new)

  contains

    subroutine renumber(ids)
      integer, intent(inout) :: ids(:)

      integer :: j

      do j = 1, size(ids)
        if (ids(j) > 0) ids(j) = new(ids(j))
      end do
    end subroutine renumber
  end subroutine drop_unused

  subroutine t_quad_elements(spline, mesh)
    !! Control points and elements; no sets.
    type(t_quad_spline_type), intent(in) :: spline
    type(extraction_mesh_type), intent(inout) :: mesh

    real(wp), parameter :: rounding = 1e-14_wp           ! what cancels is zero
    type(row_type) :: all_points
    real(wp), allocatable :: ce(:,:)
    integer :: a, e, j, k, nb

    call mesh%start('')
    do a = 1, spline%n
      call mesh%add_node(spline%cp(:,a), 1.0_wp, 0)
    end do
    do e = 1, spline%ne
      nb = (spline%degree(e) + 1)**2
      call clear(all_points)
      do k = 1, nb
        associate (row => spline%b(k,e))
          do j = 1, row%n
            if (abs(row%c(j)) > rounding) call add_term(all_points, row%id(j))
          end do
        end associate
      end do
      allocate (ce(all_points%n,nb), source=0.0_wp)
      do k = 1, nb
        associate (row => spline%b(k,e))
          do j = 1, row%n
            if (abs(row%c(j)) > rounding) &
              ce(findloc(all_points%id(1:all_points%n), row%id(j), dim=1),k) = row%c(j)
          end do
        end associate
      end do
      call mesh%add_element(spread(spline%degree(e), 1, 2), all_points%id(1:all_points%n), ce, 0)
      deallocate (ce)
    end do
    call mesh%finish()
  end subroutine t_quad_elements

  subroutine elements_on_edge(spline, h, elements, sides)
    !! The elements and their sides that lie on an edge.
    type(t_quad_spline_type), intent(in) :: spline
    integer, intent(in) :: h                            !! half-edge
    integer, allocatable, intent(out) :: elements(:)    !! in the direction of the edge
    integer, allocatable, intent(out) :: sides(:)       !! 1: s=0, 2: s=1, 3: t=0, 4: t=1

    integer, parameter :: side_of(0:3) = [3, 2, 4, 1]
    real(wp) :: ends(2), level, room
    integer :: across, along, e, f, side

    f = spline%mesh%face(h)
    side = spline%mesh%side(h)
    along = 1 + mod(side, 2)
    across = 3 - along
    associate (size_of => spline%mesh%size(:,f))
      room = nearby*minval(size_of)
      level = merge(0.0_wp, size_of(across), side == 0 .or. side == 3)
      ends = spline%mesh%at(h) + [0.0_wp, spline%mesh%interval(h)]
      if (side > 1) ends = size_of(along) - ends([2, 1])
    end associate
    allocate (elements(0), sides(0))
    do e = 1, spline%ne
      if (spline%face(e) /= f) cycle
      if (min(abs(spline%lo(across,e) - level), abs(spline%hi(across,e) - level)) > room) cycle
      if (spline%hi(along,e) < ends(1) + room .or. spline%lo(along,e) > ends(2) - room) cycle
      if (side > 1) then
        elements = [e, elements]
      else
        elements = [elements, e]
      end if
      sides = [sides, side_of(side)]
    end do
  end subroutine elements_on_edge
end module t_quad_spline
