module spline_controls
  !! Control points of an unstructured spline: from the vertices of its mesh, or so that it follows
  !! a given surface.
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type, next_corner, previous_corner, face_of
  use unstructured_spline, only: unstructured_spline_type
  use joint_controls, only: set_rings, set_seams
  implicit none (type, external)
  private
  public :: controls_from_vertices, controls_from_jets

contains

  subroutine controls_from_vertices(spline)
    !! The vertices of the mesh are control points where it is regular. Points on creases are the
    !! vertices on them (the crease runs through its corners), those inside beside them lie where
    !! straight and even meshes stay so. Around extraordinary points the control points follow the
    !! bicubic surface of the vertices.
    type(unstructured_spline_type), intent(inout) :: spline

    real(wp), allocatable :: arriving(:,:), inner(:,:), spoke(:,:), target_at(:,:,:,:)
    real(wp) :: near(3,2)
    integer :: c, k, v

    allocate (inner(3,4*spline%mesh%nf), spoke(3,4*spline%mesh%nf), source=0.0_wp)
    allocate (arriving, source=spoke)
    associate (mesh => spline%mesh, slots => spline%slots, cp => spline%cp)
      do v = 1, mesh%nv
        if (slots%vertex(v) > 0) cp(:,slots%vertex(v)) = mesh%x(:,v)
      end do
      do c = 1, 4*mesh%nf
        if (mesh%is_open(c)) then
          do k = 1, 2
            near(:,k) = curve_point(mesh, slots%beyond(:,c), c, k)
            if (slots%curve(k,c) > 0) cp(:,slots%curve(k,c)) = near(:,k)
          end do
          spoke(:,c) = near(:,1)
          arriving(:,c) = near(:,2)
        end if
        inner(:,c) = inner_coefficient(mesh, c)
        if (slots%inner(c) == 0) cycle
        if (slots%irregular(face_of(c)) > 0 .or. mesh%seam(c) .or. &
          mesh%seam(previous_corner(c))) then
          cp(:,slots%inner(c)) = inner(:,c)
        else
          cp(:,slots%inner(c)) = inside(mesh, c)
        end if
      end do
      allocate (target_at(3,0:4,0:4,mesh%nf), source=0.0_wp)
      do c = 1, 4*mesh%nf
        if (c /= slots%irregular(face_of(c))) cycle
        call raised_corner(mesh, c, inner, target_at(:,:,:,face_of(c)))
      end do
    end associate
    call set_rings(spline, inner, target_at)
    call set_seams(spline, inner, spline%mesh%x, spoke, arriving)
  end subroutine controls_from_vertices

  pure function curve_point(mesh, beyond, c, k) result(x)
    !! Control point of a crease or seam.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: beyond(2)            !! edges that go on at the ends
    integer, intent(in) :: c                    !! edge
    integer, intent(in) :: k                    !! 1: at its start, 2: at its end
    real(wp) :: x(3)

    integer :: v(2)

    v = mesh%vertex([c, next_corner(c)])
    x = mesh%x(:,v(k))
    if (beyond(k) == 0) x = x + share(mesh, beyond(3-k), c)*(mesh%x(:,v(3-k)) - x)
  end function curve_point

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

  pure subroutine raised_corner(mesh, c, inner, f)
    !! The bicubic at an extraordinary point, the coefficients that set_rings looks at, in degree 4.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                    !! corner at the point
    real(wp), intent(in) :: inner(:,:)          !! inner coefficients (3,4*nf)
    real(wp), intent(out) :: f(:,0:,0:)         !! (3,0:4,0:4)

    real(wp) :: b(3,0:2,0:2)
    integer :: k, other

    b(:,1,1) = inner(:,c)
    b(:,2,1) = inner(:,next_corner(c))
    b(:,1,2) = inner(:,previous_corner(c))
    b(:,2,2) = inner(:,next_corner(next_corner(c)))
    b(:,1,0) = mean_over(c, inner(:,c), inner(:,next_corner(mesh%twin(c))))
    b(:,2,0) = mean_over(c, b(:,2,1), inner(:,mesh%twin(c)))
    k = previous_corner(c)
    b(:,0,1) = mean_over(k, inner(:,c), inner(:,mesh%twin(k)))
    b(:,0,2) = mean_over(k, b(:,1,2), inner(:,next_corner(mesh%twin(k))))
    b(:,0,0) = 0
    other = c
    do k = 1, mesh%faces(mesh%vertex(c))
      b(:,0,0) = b(:,0,0) + inner(:,other)/mesh%faces(mesh%vertex(c))
      other = mesh%turn(other)
    end do
    f = 0
    f(:,0,0) = b(:,0,0)
    f(:,1,0) = (b(:,0,0) + 3*b(:,1,0))/4
    f(:,0,1) = (b(:,0,0) + 3*b(:,0,1))/4
    f(:,1,1) = (b(:,0,0) + 3*b(:,1,0) + 3*b(:,0,1) + 9*b(:,1,1))/16
    f(:,2,0) = (b(:,1,0) + b(:,2,0))/2
    f(:,0,2) = (b(:,0,1) + b(:,0,2))/2
    f(:,2,1) = (b(:,1,0) + b(:,2,0) + 3*b(:,1,1) + 3*b(:,2,1))/8
    f(:,1,2) = (b(:,0,1) + b(:,0,2) + 3*b(:,1,1) + 3*b(:,1,2))/8
    f(:,2,2) = (b(:,1,1) + b(:,2,1) + b(:,1,2) + b(:,2,2))/4

  contains

    pure function mean_over(edge, here, there) result(x)
      integer, intent(in) :: edge               !! seen from the face of `here`
      real(wp), intent(in) :: here(3), there(3)
      real(wp) :: x(3)

      associate (h => mesh%interval(previous_corner(edge)))
        x = (mesh%across(edge)*here + h*there)/(h + mesh%across(edge))
      end associate
    end function mean_over
  end subroutine raised_corner

  subroutine controls_from_jets(spline, jet, target_at)
    !! A spline that follows a smooth surface. Bicubic parts with the continuity of the spline are
    !! reproduced: the control point of a cubic B-spline with the inner knots t-h, t, t+h+ is
    !! f + (h+ - h)/3 f' - h h+/6 f'' at t, and so in two directions.
    type(unstructured_spline_type), intent(inout) :: spline
    real(wp), intent(in) :: jet(:,0:,0:,:)      !! derivatives at each corner along the edge that
                                                !! starts there and against the one that ends there,
                                                !! by the knots (3,0:2,0:2,4*nf)
    real(wp), intent(in) :: target_at(:,0:,0:,:)   !! quartic Bezier coefficients of irregular faces
                                                   !! from the extraordinary point (3,0:4,0:4,nf)

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
        if (slots%irregular(face_of(c)) > 0 .or. mesh%seam(c) .or. &
          mesh%seam(previous_corner(c))) then
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
    call set_rings(spline, inner, target_at)
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
