module t_quad_samples
  !! Quadrilateral meshes with T-junctions to test: stars of sectors, each divided into rectangles;
  !! and checks of their splines.
  use kinds, only: wp
  use t_quad_mesh, only: t_quad_mesh_type, create_t_quad_mesh
  use t_quad_corners, only: find_corners
  use t_quad_intervals, only: find_intervals, given_interval
  use t_quad_spline, only: t_quad_spline_type, create_t_quad_spline, t_quad_elements
  use t_quad_rays, only: side_point
  use t_quad_outline, only: ring_mesh_type, create_ring_mesh
  use t_quad_controls, only: t_controls_from_vertices
  use extraction_mesh, only: extraction_mesh_type
  use spline_checks, only: surface_jet
  use facet_samples, only: random_stream, uniform
  implicit none (type, external)
  private
  public :: t_middle, t_fine_star, t_corner_star, t_half_fine, t_star, t_rectangle, cells, joined, finish_mesh, &
    build_spline, look_at_lines, shake, t_point

  real(wp), parameter :: pi = acos(-1.0_wp)

contains

  function cells(x0, y0, x1, y1, dx, dy) result(boxes)
    !! A rectangle divided evenly.
    integer, intent(in) :: x0, y0, x1, y1, dx, dy
    integer, allocatable :: boxes(:,:)
    integer :: i, j, k

    allocate (boxes(4,((x1-x0)/dx)*((y1-y0)/dy)))
    k = 0
    do j = y0, y1 - dy, dy
      do i = x0, x1 - dx, dx
        k = k + 1
        boxes(:,k) = [i, j, i + dx, j + dy]
      end do
    end do
  end function cells

  function joined(a, b, c, d, e, f) result(boxes)
    integer, intent(in) :: a(:,:), b(:,:)
    integer, intent(in), optional :: c(:,:), d(:,:), e(:,:), f(:,:)
    integer, allocatable :: boxes(:,:)

    boxes = reshape([a, b], [4, size(a, 2) + size(b, 2)])
    if (present(c)) boxes = reshape([boxes, c], [4, size(boxes, 2) + size(c, 2)])
    if (present(d)) boxes = reshape([boxes, d], [4, size(boxes, 2) + size(d, 2)])
    if (present(e)) boxes = reshape([boxes, e], [4, size(boxes, 2) + size(e, 2)])
    if (present(f)) boxes = reshape([boxes, f], [4, size(boxes, 2) + size(f, 2)])
  end function joined

  function fine_middle() result(boxes)
    !! Eight by eight squares of side 2; those in the middle are divided in four, and lines along x
    !! go on over one more square, so that extensions do not cross.
    integer, allocatable :: boxes(:,:)

    boxes = joined(joined(cells(0, 0, 16, 4, 2, 2), cells(0, 12, 16, 16, 2, 2)), &
      cells(0, 4, 2, 12, 2, 2), cells(2, 4, 4, 12, 2, 1), cells(4, 4, 12, 12, 1, 1), &
      cells(12, 4, 14, 12, 2, 1), cells(14, 4, 16, 12, 2, 2))
  end function fine_middle

  subroutine t_middle(mesh)
    type(t_quad_mesh_type), intent(out) :: mesh

    call t_rectangle(fine_middle(), mesh)
  end subroutine t_middle

  subroutine t_half_fine(mesh)
    !! Four by two squares of side 2, above them eight by four of side 1.
    type(t_quad_mesh_type), intent(out) :: mesh

    call t_rectangle(joined(cells(0, 0, 8, 4, 2, 2), cells(0, 4, 8, 8, 1, 1)), mesh)
  end subroutine t_half_fine

  subroutine t_fine_star(n, sectors, near, mesh)
    !! Sectors of a star of n, ten by ten faces each and finer in the middle.
    integer, intent(in) :: n
    integer, intent(in) :: sectors               !! how many of the n
    integer, intent(in) :: near                  !! squares before those of fine_middle
    type(t_quad_mesh_type), intent(out) :: mesh
    integer, allocatable :: all_boxes(:,:), boxes(:,:), sector(:)
    integer :: k, m, size_of

    m = 2*near
    size_of = 16 + m
    boxes = joined(cells(0, 0, size_of, m, 2, 2), cells(0, m, m, size_of, 2, 2), fine_middle() + m)
    allocate (all_boxes(4,0), sector(0))
    do k = 1, sectors
      all_boxes = joined(all_boxes, boxes)
      sector = [sector, spread(k, 1, size(boxes, 2))]
    end do
    call t_star(n, size_of, all_boxes, sector, mesh)
  end subroutine t_fine_star

  subroutine t_corner_star(n, mesh)
    !! Sectors of six by six faces; in the first one the nine at the outer corner are divided.
    integer, intent(in) :: n
    type(t_quad_mesh_type), intent(out) :: mesh
    integer, allocatable :: boxes(:,:), sector(:)
    integer :: k

    boxes = joined(cells(0, 0, 12, 6, 2, 2), cells(0, 6, 4, 12, 2, 2), cells(4, 6, 6, 12, 2, 1), cells(6, 6, 12, 12, 1, 1))
    sector = spread(1, 1, size(boxes, 2))
    do k = 2, n
      boxes = joined(boxes, cells(0, 0, 12, 12, 2, 2))
      sector = [sector, spread(k, 1, 36)]
    end do
    call t_star(n, 12, boxes, sector, mesh)
  end subroutine t_corner_star

  subroutine build_spline(mesh, rings, spline, message)
    !! With default intervals.
    type(t_quad_mesh_type), intent(inout) :: mesh
    type(ring_mesh_type), intent(out) :: rings
    type(t_quad_spline_type), intent(out) :: spline
    character(:), allocatable, intent(out) :: message

    call finish_mesh(mesh, message)
    if (len(message) == 0) call create_ring_mesh(mesh, rings, message)
    if (len(message) == 0) call create_t_quad_spline(mesh, rings, spline, message)
    if (len(message) == 0) call t_controls_from_vertices(spline)
  end subroutine build_spline

  subroutine t_rectangle(boxes, mesh)
    !! Rectangles in the plane that fill a rectangle.
    integer, intent(in) :: boxes(:,:)            !! x0,y0,x1,y1 (4,:)
    type(t_quad_mesh_type), intent(out) :: mesh

    call assemble(0, 1, boxes, spread(1, 1, size(boxes, 2)), mesh)
  end subroutine t_rectangle

  subroutine t_star(n, m, boxes, sector, mesh)
    !! A regular polygon of n corners, its centre joined to the middles of its sides: n sectors of
    !! rectangles in [0,m] x [0,m], bilinear.
    integer, intent(in) :: n, m
    integer, intent(in) :: boxes(:,:)            !! x0,y0,x1,y1 (4,:)
    integer, intent(in) :: sector(:)             !! in which each one lies, 0: in all of them
    type(t_quad_mesh_type), intent(out) :: mesh
    integer, allocatable :: all_boxes(:,:), all_sectors(:)
    integer :: b, k

    allocate (all_boxes(4,0), all_sectors(0))
    do k = 1, n
      do b = 1, size(sector)
        if (sector(b) /= k .and. sector(b) /= 0) cycle
        all_boxes = reshape([all_boxes, boxes(:,b)], [4, size(all_sectors) + 1])
        all_sectors = [all_sectors, k]
      end do
    end do
    call assemble(n, m, all_boxes, all_sectors, mesh)
  end subroutine t_star

  subroutine assemble(n, m, boxes, sector, mesh)
    !! n = 0: one rectangle.
    integer, intent(in) :: n, m, boxes(:,:), sector(:)
    type(t_quad_mesh_type), intent(out) :: mesh
    character(:), allocatable :: message
    integer, allocatable :: first(:), key(:,:), vertex(:)
    real(wp), allocatable :: x(:,:)
    integer :: b, c, corner(3,4), k, nk, p(3), step(2)

    ! vertices: all corners
    nk = 0
    allocate (key(3,4*size(sector)))
    do b = 1, size(sector)
      corner = corners_of(b)
      do c = 1, 4
        p = same(corner(:,c))
        if (.not. is_known(p)) then
          nk = nk + 1
          key(:,nk) = p
        end if
      end do
    end do
    allocate (x(3,nk), source=0.0_wp)
    do k = 1, nk
      x(1:2,k) = place(key(:,k))
    end do
    allocate (first(1), source=1)
    allocate (vertex(0))
    do b = 1, size(sector)
      corner = corners_of(b)
      do c = 1, 4
        p = corner(:,c)
        step = sign(1, corner(2:3,mod(c, 4)+1) - p(2:3))*merge(1, 0, corner(2:3,mod(c, 4)+1) /= p(2:3))
        do while (any(p /= corner(:,mod(c, 4)+1)))
          if (is_known(same(p))) vertex = [vertex, number(same(p))]
          p(2:3) = p(2:3) + step
        end do
      end do
      first = [first, size(vertex) + 1]
    end do
    call create_t_quad_mesh(x, first, vertex, mesh, message)
    if (len(message) > 0) error stop 't_quad_samples: the sample has a fault'

  contains

    function corners_of(b) result(corner)
      integer, intent(in) :: b
      integer :: corner(3,4)

      corner(1,:) = sector(b)
      corner(2,:) = boxes([1, 3, 3, 1],b)
      corner(3,:) = boxes([2, 2, 4, 4],b)
    end function corners_of

    function same(p) result(q)
      !! The second spoke of a sector is the first one of the next.
      integer, intent(in) :: p(3)
      integer :: q(3)

      q = p
      if (n == 0 .or. p(2) > 0) return
      q = [mod(p(1), n) + 1, p(3), 0]
      if (p(3) == 0) q = [1, 0, 0]
    end function same

    logical function is_known(p)
      integer, intent(in) :: p(3)

      is_known = number(p) > 0
    end function is_known

    integer function number(p)
      integer, intent(in) :: p(3)

      do number = 1, nk
        if (all(key(:,number) == p)) return
      end do
      number = 0
    end function number

    function place(p) result(y)
      integer, intent(in) :: p(3)
      real(wp) :: y(2), first_end(2), second_end(2), far(2), u, v

      y = real(p(2:3), wp)
      if (n == 0) return
      u = real(p(2), wp)/m
      v = real(p(3), wp)/m
      first_end = cos(pi/n)*[cos(2*pi*(p(1)-1)/n), sin(2*pi*(p(1)-1)/n)]
      second_end = cos(pi/n)*[cos(2*pi*p(1)/n), sin(2*pi*p(1)/n)]
      far = [cos(2*pi*(p(1)-0.5_wp)/n), sin(2*pi*(p(1)-0.5_wp)/n)]
      y = u*(1 - v)*first_end + (1 - u)*v*second_end + u*v*far
    end function place
  end subroutine assemble

  subroutine finish_mesh(mesh, message)
    !! Corners and default intervals.
    type(t_quad_mesh_type), intent(inout) :: mesh
    character(:), allocatable, intent(out) :: message
    type(given_interval) :: none(0)

    call find_corners(mesh, message)
    if (len(message) == 0) call find_intervals(mesh, none, message)
  end subroutine finish_mesh

  subroutine shake(spline, size_of, stream)
    !! Moves all control points at random.
    type(t_quad_spline_type), intent(inout) :: spline
    real(wp), intent(in) :: size_of
    type(random_stream), intent(inout) :: stream
    integer :: a, i

    do a = 1, spline%n
      do i = 1, 3
        spline%cp(i,a) = spline%cp(i,a) + uniform(stream, -size_of, size_of)
      end do
    end do
  end subroutine shake

  subroutine t_point(spline, elements, f, p, way, x, dx, d2x)
    !! Place and derivatives by the knots in a face; of several elements the one in a direction.
    type(t_quad_spline_type), intent(in) :: spline
    type(extraction_mesh_type), intent(in) :: elements
    integer, intent(in) :: f
    real(wp), intent(in) :: p(2), way(2)
    real(wp), intent(out) :: x(3), dx(3,2), d2x(3,3)
    real(wp) :: q(2), h(2)
    integer :: e

    q = p + 1e-7_wp*way
    do e = 1, spline%ne
      if (spline%face(e) == f .and. all(q >= spline%lo(:,e)) .and. all(q <= spline%hi(:,e))) exit
    end do
    if (e > spline%ne) error stop 't_point: no element'
    h = spline%hi(:,e) - spline%lo(:,e)
    call surface_jet(elements, e, min(max((p - spline%lo(:,e))/h, 0.0_wp), 1.0_wp), x, dx, d2x)
    dx(:,1) = dx(:,1)/h(1)
    dx(:,2) = dx(:,2)/h(2)
    d2x(:,1) = d2x(:,1)/h(1)**2
    d2x(:,2) = d2x(:,2)/h(2)**2
    d2x(:,3) = d2x(:,3)/product(h)
  end subroutine t_point

  subroutine look_at_lines(spline, gap, turn, bend)
    !! Along all smooth edges and all cuts of faces, the quarter points of the cells around.
    type(t_quad_spline_type), intent(in) :: spline
    real(wp), intent(out) :: gap         !! largest distance between the two sides
    real(wp), intent(out) :: turn        !! largest angle between their normals [rad]
    real(wp), intent(out) :: bend        !! largest jump of second derivatives by the knots, away
                                         !! from extraordinary points
    type(extraction_mesh_type) :: elements
    real(wp) :: at, middle(2), p(2), q(2), way(2)
    integer :: e, h, k, t

    call t_quad_elements(spline, elements)
    gap = 0
    turn = 0
    bend = 0
    associate (mesh => spline%mesh)
      do h = 1, mesh%nh
        t = mesh%twin(h)
        if (mesh%crease(h) .or. t < h) cycle
        do k = 0, 12
          at = min(max(k/12.0_wp, 1e-5_wp), 1 - 1e-5_wp)*mesh%interval(h)
          p = side_point(mesh, h, mesh%at(h) + at)
          q = side_point(mesh, t, mesh%at(t) + mesh%interval(t) - at)
          call compare(mesh%face(h), p, mesh%size(:,mesh%face(h))/2 - p, mesh%face(t), q, &
            mesh%size(:,mesh%face(t))/2 - q, mesh%side(h), mesh%side(t))
        end do
      end do
      do e = 1, spline%ne
        middle = (spline%lo(:,e) + spline%hi(:,e))/2
        do k = 0, 12
          if (spline%lo(1,e) > 0) then
            p = [spline%lo(1,e), spline%lo(2,e) + (k + 0.01_wp)/12.1_wp*(spline%hi(2,e) - spline%lo(2,e))]
            way = [1, 0]
            call compare(spline%face(e), p, way, spline%face(e), p, -way, 1, 3)
          end if
          if (spline%lo(2,e) > 0) then
            p = [spline%lo(1,e) + (k + 0.01_wp)/12.1_wp*(spline%hi(1,e) - spline%lo(1,e)), spline%lo(2,e)]
            way = [0, 1]
            call compare(spline%face(e), p, way, spline%face(e), p, -way, 0, 2)
          end if
        end do
      end do
    end associate

  contains

    subroutine compare(f, p, way, g, q, other_way, side, other_side)
      integer, intent(in) :: f, g, side, other_side
      real(wp), intent(in) :: p(2), way(2), q(2), other_way(2)
      real(wp) :: dx(3,2,2), d2x(3,3,2), normal(3,2), x(3,2)
      integer :: m

      call t_point(spline, elements, f, p, way/norm2(way), x(:,1), dx(:,:,1), d2x(:,:,1))
      call t_point(spline, elements, g, q, other_way/norm2(other_way), x(:,2), dx(:,:,2), d2x(:,:,2))
      do m = 1, 2
        normal(:,m) = cross(dx(:,1,m), dx(:,2,m))
        normal(:,m) = normal(:,m)/norm2(normal(:,m))
      end do
      gap = max(gap, norm2(x(:,1) - x(:,2)))
      turn = max(turn, norm2(cross(normal(:,1), normal(:,2))))
      if (dot_product(normal(:,1), normal(:,2)) < 0) turn = 2
      if (spline%rings%zone(f) .or. spline%rings%zone(g)) return
      if (spline%rings%touches(f) .or. spline%rings%touches(g)) return
      ! across: sides 0 and 2 have it along the second parameter
      bend = max(bend, norm2(d2x(:,2-mod(side, 2),1) - d2x(:,2-mod(other_side, 2),2)))
    end subroutine compare
  end subroutine look_at_lines

  pure function cross(a, b)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: cross(3)

    cross = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross
end module t_quad_samples
