module t_quad_supports
  !! On which faces of a quadrilateral mesh with T-junctions the pieces of functions live.
  !!
  !! The faces under a piece are unfolded into its quadrant one after the other across their edges:
  !! place p of a face is X = turned(p - p0, -quarters) there. Faces around extraordinary points
  !! (`zone`) are left out; the functions there come from elsewhere.
  use kinds, only: wp
  use extraction_mesh, only: whole_number
  use t_quad_mesh, only: t_quad_mesh_type
  use t_quad_rays, only: star_type, star_of, is_plain, side_point, turned, nearby
  use t_quad_functions, only: piece_type
  implicit none (type, external)
  private
  public :: hit_type, unfold, chart_box

  !> a face under a piece
  type :: hit_type
    integer :: piece = 0
    integer :: face = 0
    integer :: quarters = 0
    real(wp) :: p0(2) = 0
  end type hit_type

contains

  subroutine unfold(mesh, piece, number, zone, hits, n, message)
    type(t_quad_mesh_type), intent(in) :: mesh
    type(piece_type), intent(in) :: piece
    integer, intent(in) :: number                          !! of the piece
    logical, intent(in) :: zone(:)                         !! (nf)
    type(hit_type), allocatable, intent(inout) :: hits(:)  !! of all pieces so far
    integer, intent(inout) :: n                            !! hits in use
    character(:), allocatable, intent(inout) :: message    !! empty: nothing wrong

    type(hit_type), allocatable :: more(:)
    type(hit_type) :: here, other
    real(wp) :: ends(2,2), high(2), small
    integer :: first, h, i, k

    if (zone(mesh%face(piece%half_edge))) return
    high = piece%knots(5,:)
    small = nearby*minval(high)
    first = n + 1
    other%piece = number
    other%face = mesh%face(piece%half_edge)
    other%quarters = piece%axis
    other%p0 = side_point(mesh, piece%half_edge, mesh%at(piece%half_edge))
    call take()
    k = first
    do while (k <= n)
      ! a copy: the list may move while it grows
      here = hits(k)
      associate (f => here%face)
        do h = mesh%first(f), mesh%first(f+1) - 1
          call edge_ends(mesh, h, here, ends)
          if (is_inside(ends(:,1))) call check_vertex(h)
          if (len(message) > 0) return
          if (.not. crosses(ends)) cycle
          if (mesh%crease(h)) then
            message = 'the function of vertex ' // whole_number(piece%v) // &
              ' reaches over the end of a crease or of the boundary at the edge of vertices ' // &
              whole_number(mesh%vertex(h)) // ' and ' // whole_number(mesh%vertex(mesh%next(h))) &
              // ': lead more lines through there'
            return
          end if
          call step_over(mesh, h, here, ends(:,1), other)
          if (zone(other%face)) then
            call check_zone()
            if (len(message) > 0) return
            cycle
          end if
          if (.not. known()) call take()
        end do
      end associate
      k = k + 1
    end do

  contains

    subroutine take()
      if (n == size(hits)) then
        allocate (more(2*n + 64))
        more(1:n) = hits
        call move_alloc(more, hits)
      end if
      n = n + 1
      hits(n) = other
    end subroutine take

    logical function known()
      known = .false.
      do i = first, n
        if (hits(i)%face /= other%face .or. hits(i)%quarters /= other%quarters) cycle
        known = maxval(abs(hits(i)%p0 - other%p0)) < small
        if (known) return
      end do
    end function known

    logical function is_inside(x)
      real(wp), intent(in) :: x(2)

      is_inside = all(x > small .and. x < high - small)
    end function is_inside

    logical function crosses(ends)
      real(wp), intent(in) :: ends(2,2)

      ! along one axis the edge is a line strictly inside, along the other it overlaps
      crosses = all(max(ends(:,1), ends(:,2)) > small .and. min(ends(:,1), ends(:,2)) &
        < high - small)
    end function crosses

    subroutine check_vertex(h)
      integer, intent(in) :: h

      type(star_type) :: star

      call star_of(mesh, mesh%vertex(h), star)
      if (.not. is_plain(star)) call refuse(star%v)
    end subroutine check_vertex

    subroutine check_zone()
      !! Extraordinary points do not lie inside the support.
      real(wp) :: box(2,2)
      type(star_type) :: star
      integer :: j

      do j = mesh%first(other%face), mesh%first(other%face+1) - 1
        call edge_ends(mesh, j, other, box)
        if (.not. is_inside(box(:,1))) cycle
        call star_of(mesh, mesh%vertex(j), star)
        if (.not. is_plain(star)) call refuse(star%v)
      end do
    end subroutine check_zone

    subroutine refuse(v)
      integer, intent(in) :: v

      message = 'the function of vertex ' // whole_number(piece%v) // &
        ' reaches around vertex ' // whole_number(v) // ' (a face there: ' // &
        whole_number(mesh%face(mesh%out(v))) // '), where lines do not go straight on: put more ' &
        // 'lines between them'
    end subroutine refuse
  end subroutine unfold

  pure subroutine edge_ends(mesh, h, hit, ends)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: h
    type(hit_type), intent(in) :: hit
    real(wp), intent(out) :: ends(2,2)           !! in the quadrant

    ends(:,1) = turned(side_point(mesh, h, mesh%at(h)) - hit%p0, -hit%quarters)
    ends(:,2) = turned(side_point(mesh, h, mesh%at(h) + mesh%interval(h)) - hit%p0, -hit%quarters)
  end subroutine edge_ends

  pure subroutine step_over(mesh, h, hit, start, other)
    type(t_quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: h                     !! half-edge of the face of the hit
    type(hit_type), intent(in) :: hit
    real(wp), intent(in) :: start(2)             !! of the edge in the quadrant
    type(hit_type), intent(inout) :: other       !! face beyond

    integer :: t

    t = mesh%twin(h)
    other%piece = hit%piece
    other%face = mesh%face(t)
    other%quarters = modulo(hit%quarters + mesh%side(t) - mesh%side(h) + 2, 4)
    other%p0 = side_point(mesh, t, mesh%at(t) + mesh%interval(t)) - turned(start, other%quarters)
  end subroutine step_over

  pure subroutine chart_box(hit, lo, hi, low, high)
    !! A rectangle of the face, in the quadrant.
    type(hit_type), intent(in) :: hit
    real(wp), intent(in) :: lo(2), hi(2)         !! corners in the face
    real(wp), intent(out) :: low(2), high(2)

    real(wp) :: a(2), b(2)

    a = turned(lo - hit%p0, -hit%quarters)
    b = turned(hi - hit%p0, -hit%quarters)
    low = min(a, b)
    high = max(a, b)
  end subroutine chart_box
end module t_quad_supports
