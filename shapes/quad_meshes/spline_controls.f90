module spline_controls
  !! Control points of an unstructured spline: from the vertices of its mesh, or so that it follows
  !! a given surface.
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type, next_corner, previous_corner
  use unstructured_spline, only: unstructured_spline_type, corner_point
  use joint_controls, only: set_seams, mean_over
  implicit none (type, external)
  private
  public :: controls_from_vertices, controls_from_jets

contains

  subroutine controls_from_vertices(spline)
    !! The vertices of the mesh are control points where it is regular. Points on creases and long
    !! seams are the vertices on them (the crease runs through its corners), those inside beside
    !! them lie where straight and even meshes stay so. Extraordinary points with short seams and
    !! their edges follow the bicubic surface of the vertices.
    type(unstructured_spline_type), intent(inout) :: spline

    real(wp), allocatable :: arriving(:,:), inner(:,:), point(:,:), spoke(:,:)
    type(quad_mesh_type) :: smooth
    integer :: c, v

    allocate (inner(3,4*spline%mesh%nf), spoke(3,4*spline%mesh%nf), source=0.0_wp)
    allocate (arriving, source=spoke)
    smooth = without_short_seams(spline%mesh)
    associate (mesh => spline%mesh, slots => spline%slots, cp => spline%cp)
      allocate (point, source=mesh%x)
      do v = 1, mesh%nv
        if (slots%vertex(v) > 0) cp(:,slots%vertex(v)) = mesh%x(:,v)
      end do
      do c = 1, 4*mesh%nf
        inner(:,c) = inner_coefficient(smooth, c)
      end do
      do c = 1, 4*mesh%nf
        if (slots%inner(c) > 0) then
          cp(:,slots%inner(c)) = inner(:,c)
          if (.not. (mesh%seam(c) .or. mesh%seam(previous_corner(c)))) &
            cp(:,slots%inner(c)) = inside(mesh, c)
        end if
        if (mesh%crease(c)) call set_curve()
      end do
      do c = 1, 4*mesh%nf
        if (mesh%seam(c)) call set_curve()
      end do
      do v = 1, mesh%nv
        if (slots%plane(v) > 0 .and. .not. mesh%is_boundary(v)) then
          if (is_smooth(v)) point(:,v) = mean_about(mesh, v, inner)
        end if
      end do
    end associate
    call set_seams(spline, inner, point, spoke, arriving)

  contains

    subroutine set_curve()
      !! Control points of edge c of a crease or seam.
      real(wp) :: ends(3,2), near(3,2)
      integer :: k, v(2)

      v = spline%mesh%vertex([c, next_corner(c)])
      ends = spline%mesh%x(:,v)
      associate (slots => spline%slots)
        do k = 1, 2
          near(:,k) = ends(:,k)
          if (slots%beyond(k,c) == 0) then
            if (smooth%is_open(c)) then
              near(:,k) = ends(:,k) + share(spline%mesh, slots%beyond(3-k,c), c) &
                * (ends(:,3-k) - ends(:,k))
              if (spline%mesh%seam(c) .and. slots%curve_edge(v(k)) /= 0) &
                call keep_off_crease(merge(c, next_corner(c), k == 1), ends(:,3-k), near(:,k))
            else
              near(:,k) = mean_over(spline%mesh, c, k, inner)
            end if
          end if
          if (slots%curve(k,c) > 0) spline%cp(:,slots%curve(k,c)) = near(:,k)
        end do
      end associate
      spoke(:,c) = near(:,1)
      arriving(:,c) = near(:,2)
    end subroutine set_curve

    subroutine keep_off_crease(corner, other, near)
      !! A smooth crease does not run through its vertices: the seam's control point next to it must
      !! be clearly inside of it.
      integer, intent(in) :: corner             !! on the crease
      real(wp), intent(in) :: other(3)          !! vertex at the other end of the seam's edge
      real(wp), intent(inout) :: near(3)

      real(wp) :: inward(3), x(3)

      x = corner_point(spline, corner)
      inward = other - x
      if (dot_product(near - x, inward) < dot_product(inward, inward)/6) near = x + inward/3
    end subroutine keep_off_crease

    logical function is_smooth(v)
      !! Whether all edges of an extraordinary point are taken for smooth.
      integer, intent(in) :: v                  !! the point

      integer :: c, k

      is_smooth = .true.
      c = smooth%corner(v)
      do k = 1, smooth%faces(v)
        is_smooth = is_smooth .and. .not. smooth%seam(c)
        c = smooth%turn(c)
      end do
    end function is_smooth
  end subroutine controls_from_vertices

  pure function without_short_seams(mesh) result(smooth)
    !! A mesh with the first edges of long seams only from points that have no short ones.
    type(quad_mesh_type), intent(in) :: mesh
    type(quad_mesh_type) :: smooth

    logical :: has_short(mesh%nv)
    integer :: c

    has_short = .false.
    do c = 1, 4*mesh%nf
      if (abs(mesh%bend(c)) > 0 .and. mesh%is_star(mesh%vertex(c))) &
        has_short(mesh%vertex(c)) = .true.
    end do
    smooth = mesh
    do c = 1, 4*mesh%nf
      if (has_short(mesh%vertex(c)) .or. has_short(mesh%vertex(next_corner(c)))) &
        smooth%seam(c) = .false.
    end do
  end function without_short_seams

  pure function mean_about(mesh, v, inner) result(x)
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: v                    !! vertex
    real(wp), intent(in) :: inner(:,:)          !! (3,4*nf)
    real(wp) :: x(3)

    integer :: c, k

    x = 0
    c = mesh%corner(v)
    do k = 1, mesh%faces(v)
      x = x + inner(:,c)/mesh%faces(v)
      c = mesh%turn(c)
    end do
  end function mean_about

  pure real(wp) function share(mesh, goes_on, c)
    !! Where the second point of a crease lies between its corner and the next vertex: knots
    !! 0,0,0,h,h+ against 0,h,h+, or 0,0,0,h,h.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: goes_on              !! edge that follows, 0: none
    integer, intent(in) :: c                    !! edge at the corner

    share = 1.0_wp/3
    if (goes_on == 0) return
    associate (h => mesh%interval(c), h_next => mesh%interval(abs(goes_on)))
      share = h/(2*h + h_next)
    end associate
  end function share

  pure function inside(mesh, c) result(x)
    !! The point inside at a corner: the vertex, moved off those of its two edges that are creases.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                    !! corner
    real(wp) :: x(3)

    real(wp) :: part(2)
    integer :: last, opposite

    last = previous_corner(c)
    opposite = next_corner(next_corner(c))
    part = 0
    if (mesh%is_open(last)) part(1) = share_across(c, next_corner(c))
    if (mesh%is_open(c)) part(2) = share_across(last, opposite)
    x = (1 - part(1))*(1 - part(2))*mesh%x(:,mesh%vertex(c)) &
      + part(1)*(1 - part(2))*mesh%x(:,mesh%vertex(next_corner(c))) &
      + (1 - part(1))*part(2)*mesh%x(:,mesh%vertex(last)) &
      + part(1)*part(2)*mesh%x(:,mesh%vertex(opposite))

  contains

    pure real(wp) function share_across(edge, end_edge)
      integer, intent(in) :: edge, end_edge     !! edge away from the crease, edge at its other end

      share_across = 1.0_wp/3
      if (mesh%is_open(end_edge)) return
      share_across = mesh%interval(edge)/(2*mesh%interval(edge) + mesh%across(end_edge))
    end function share_across
  end function inside

  pure function inner_coefficient(mesh, c) result(x)
    !! Of the bicubic surface of the vertices.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                    !! corner that it is next to
    real(wp) :: x(3)

    real(wp) :: far(2)
    integer :: last, opposite

    last = previous_corner(c)
    opposite = next_corner(next_corner(c))
    far(1) = part(mesh%across(last), mesh%interval(c), mesh%across(next_corner(c)))
    far(2) = part(mesh%across(c), mesh%interval(last), mesh%across(opposite))
    x = (1 - far(1))*(1 - far(2))*inside(mesh, c) &
      + far(1)*(1 - far(2))*inside(mesh, next_corner(c)) &
      + (1 - far(1))*far(2)*inside(mesh, last) + far(1)*far(2)*inside(mesh, opposite)

  contains

    pure real(wp) function part(before, h, after)
      real(wp), intent(in) :: before, h, after  !! knot intervals

      part = before/(before + h + after)
    end function part
  end function inner_coefficient

  subroutine controls_from_jets(spline, jet)
    !! A spline that follows a smooth surface. Bicubic parts with the continuity of the spline are
    !! reproduced: the control point of a cubic B-spline with the inner knots t-h, t, t+h+ is
    !! f + (h+ - h)/3 f' - h h+/6 f'' at t, and so in two directions.
    type(unstructured_spline_type), intent(inout) :: spline
    real(wp), intent(in) :: jet(:,0:,0:,:)      !! derivatives at each corner along the edge that
                                                !! starts there and against the one that ends there,
                                                !! by the knots (3,0:2,0:2,4*nf)

    real(wp), allocatable :: arriving(:,:), inner(:,:), point(:,:), spoke(:,:)
    integer, allocatable :: times(:)
    integer :: a, c, e

    allocate (inner(3,4*spline%mesh%nf), point(3,spline%mesh%nv), spoke(3,4*spline%mesh%nf), &
      source=0.0_wp)
    allocate (arriving, source=spoke)
    allocate (times(spline%slots%n), source=0)
    associate (mesh => spline%mesh, slots => spline%slots, cp => spline%cp)
      cp = 0
      do c = 1, 4*mesh%nf
        inner(:,c) = tensor(jet(:,:,:,c), [0.0_wp, mesh%interval(c)], &
          [0.0_wp, mesh%interval(previous_corner(c))])
        if (mesh%seam(c) .or. mesh%seam(previous_corner(c))) then
          if (slots%inner(c) > 0) call take(slots%inner(c), inner(:,c))
        else
          call take(slots%inner(c), tensor(jet(:,:,:,c), &
            [-mesh%across(previous_corner(c)), mesh%interval(c)], &
            [-mesh%across(c), mesh%interval(previous_corner(c))]))
        end if
        if (slots%vertex(mesh%vertex(c)) > 0) call take(slots%vertex(mesh%vertex(c)), jet(:,0,0,c))
        point(:,mesh%vertex(c)) = point(:,mesh%vertex(c)) + jet(:,0,0,c)/mesh%faces(mesh%vertex(c))
        if (mesh%is_open(c)) then
          spoke(:,c) = tensor(jet(:,:,:,c), [-length_beyond(1, c), mesh%interval(c)], &
            [0.0_wp, 0.0_wp])
          if (slots%curve(1,c) > 0) call take(slots%curve(1,c), spoke(:,c))
        end if
        e = previous_corner(c)
        if (mesh%is_open(e)) then
          arriving(:,e) = tensor(jet(:,:,:,c), [0.0_wp, 0.0_wp], [-length_beyond(2, e), &
            mesh%interval(e)])
          if (slots%curve(2,e) > 0) call take(slots%curve(2,e), arriving(:,e))
        end if
      end do
      do a = 1, slots%n
        if (times(a) > 0) cp(:,a) = cp(:,a)/times(a)
      end do
    end associate
    call set_seams(spline, inner, point, spoke, arriving)

  contains

    subroutine take(id, x)
      integer, intent(in) :: id                 !! control point
      real(wp), intent(in) :: x(3)              !! its place seen from one of the corners

      spline%cp(:,id) = spline%cp(:,id) + x
      times(id) = times(id) + 1
    end subroutine take

    pure real(wp) function length_beyond(k, edge)
      integer, intent(in) :: k, edge            !! 1: start, 2: end of the edge

      length_beyond = 0
      if (spline%slots%beyond(k,edge) /= 0) &
        length_beyond = spline%mesh%interval(abs(spline%slots%beyond(k,edge)))
    end function length_beyond
  end subroutine controls_from_jets

  pure function tensor(jet, a, b) result(x)
    !! Polar form at (t+a1, t, t+a2) in the first and (t+b1, t, t+b2) in the second direction.
    real(wp), intent(in) :: jet(:,0:,0:)        !! derivatives (3,0:2,0:2)
    real(wp), intent(in) :: a(2), b(2)
    real(wp) :: x(3)

    real(wp) :: factor(0:2,2)
    integer :: i, j

    factor(:,1) = [1.0_wp, sum(a)/3, product(a)/6]
    factor(:,2) = [1.0_wp, sum(b)/3, product(b)/6]
    x = 0
    do j = 0, 2
      do i = 0, 2
        x = x + factor(i,1)*factor(j,2)*jet(:,i,j)
      end do
    end do
  end function tensor

end module spline_controls
