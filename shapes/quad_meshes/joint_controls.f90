module joint_controls
  !! Control points of extraordinary points and along seams, from Bezier coefficients that are
  !! wanted but need not satisfy the conditions there: the nearest in a simple sense.
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type, next_corner, previous_corner, face_of
  use seam_lines, only: binds, touching_gluing
  use point_joint, only: boundary_plane_points, is_bent
  use unstructured_spline, only: unstructured_spline_type, coefficient
  implicit none (type, external)
  private
  public :: set_seams, mean_over

  real(wp), parameter :: pi = acos(-1.0_wp)

contains

  subroutine set_seams(spline, inner, point, spoke, arriving)
    !! Points with seams, and what leads along seams, so that both sides deviate alike.
    type(unstructured_spline_type), intent(inout) :: spline
    real(wp), intent(in) :: inner(:,:)            !! inner coefficients wanted (3,4*nf)
    real(wp), intent(in) :: point(:,:)            !! places of extraordinary points (3,nv)
    real(wp), intent(in) :: spoke(:,:)            !! control points of seams at the starts of edges,
                                                  !! first coefficients of spokes (3,4*nf)
    real(wp), intent(in) :: arriving(:,:)         !! and at their ends (3,4*nf)

    real(wp) :: s(3,0:3)
    integer :: c, k, t, v

    associate (mesh => spline%mesh, slots => spline%slots, cp => spline%cp)
      do v = 1, mesh%nv
        if (slots%plane(v) > 0) call set_point(spline, v, inner, point(:,v), spoke, arriving)
      end do
      do c = 1, 4*mesh%nf
        if (.not. mesh%seam(c)) cycle
        t = mesh%twin(c)
        if (c > t) cycle
        s = edge_values(spline, c)
        do k = 1, 2
          if (.not. binds(mesh, c, k)) cycle
          if (k == 1) call share_defect(c, next_corner(t))
          if (k == 2) call share_defect(next_corner(c), t)
        end do
      end do
    end associate

  contains

    subroutine share_defect(lead, follow)
      integer, intent(in) :: lead, follow         !! corners

      real(wp) :: a(2), defect(3), h(3), q, r

      if (spline%slots%inner(lead) <= 0) return
      associate (mesh => spline%mesh)
        q = mesh%interval(previous_corner(c))
        r = mesh%interval(next_corner(t))
        a = touching_gluing(mesh, c, k)
        if (k == 1) h = a(2)*(s(:,1) - s(:,0)) + 2*a(1)*(s(:,2) - s(:,1))
        if (k == 2) h = 2*a(2)*(s(:,2) - s(:,1)) + a(1)*(s(:,3) - s(:,2))
        defect = (inner(:,lead) - s(:,k))/q + (inner(:,follow) - s(:,k))/r - h/(3*mesh%interval(c))
        spline%cp(:,spline%slots%inner(lead)) = inner(:,lead) - q*defect/2
      end associate
    end subroutine share_defect
  end subroutine set_seams

  function edge_values(spline, c) result(s)
    !! Bezier coefficients of an edge.
    type(unstructured_spline_type), intent(in) :: spline
    integer, intent(in) :: c                      !! corner that it starts from
    real(wp) :: s(3,0:3)

    ! of a cubic; of a quartic the outer two at each end
    integer, parameter :: cubic(4,4) = reshape([1, 2, 3, 4, 4, 8, 12, 16, 16, 15, 14, 13, &
      13, 9, 5, 1], [4, 4])
    integer, parameter :: quartic(4,4) = reshape([1, 2, 4, 5, 5, 10, 20, 25, 25, 24, 22, 21, &
      21, 16, 6, 1], [4, 4])
    integer :: f, k, m

    f = face_of(c)
    m = c - 4*f + 4
    do k = 0, 3
      s(:,k) = coefficient(spline, f, merge(cubic(k+1,m), quartic(k+1,m), spline%degree(f) == 3))
    end do
    if (spline%degree(f) == 3) return
    s(:,1) = (4*s(:,1) - s(:,0))/3
    s(:,2) = (4*s(:,2) - s(:,3))/3
  end function edge_values

  subroutine set_point(spline, v, inner, s0, spoke, arriving)
    type(unstructured_spline_type), intent(inout) :: spline
    integer, intent(in) :: v                      !! extraordinary point with seams
    real(wp), intent(in) :: inner(:,:), s0(3), spoke(:,:), arriving(:,:)   !! what is wanted

    real(wp) :: angle, d(spline%mesh%faces(v)+1), gradient(3,2), &
      s1(3,spline%mesh%faces(v)+1), slope(3,spline%mesh%faces(v)+1)
    integer :: fan(spline%mesh%faces(v)), i, n

    n = spline%mesh%faces(v)
    fan(1) = spline%mesh%corner(v)
    do i = 2, n
      fan(i) = spline%mesh%turn(fan(i-1))
    end do
    associate (mesh => spline%mesh, plane => spline%slots%plane(v), cp => spline%cp)
      ! spokes, the last one again the first unless the point is on the boundary
      do i = 1, n
        d(i) = mesh%interval(fan(i))
        s1(:,i) = spoke(:,fan(i))
      end do
      d(n+1) = mesh%interval(previous_corner(fan(n)))
      s1(:,n+1) = s1(:,1)
      if (mesh%is_boundary(v)) s1(:,n+1) = arriving(:,previous_corner(fan(n)))
      do i = 1, n + 1
        slope(:,i) = (s1(:,i) - s0)/d(i)
      end do
      if (mesh%is_boundary(v)) then
        gradient = boundary_gradient(slope, mesh%angle(v))
      else
        gradient = point_gradient(slope(:,1:n), mesh%angle(v))
      end if
      if (mesh%is_boundary(v)) then
        cp(:,plane:plane+2) = boundary_plane_points(d, mesh%angle(v), s0, gradient)
      else
        do i = 0, 2
          angle = 2*pi*i/3
          cp(:,plane+i) = s0 + 2*sum(d(1:n))/n*(cos(angle)*gradient(:,1) + sin(angle)*gradient(:,2))
        end do
      end if
      do i = 1, n + 1
        angle = (i - 1)*mesh%angle(v)
        s1(:,i) = s0 + d(i)*(cos(angle)*gradient(:,1) + sin(angle)*gradient(:,2))
      end do
    end associate
    if (spline%slots%twist(v) > 0) call set_free_twist(spline, v, fan, d, s0, s1, inner, spoke)
  end subroutine set_point

  pure function point_gradient(slope, step) result(gradient)
    !! Least squares of slope(i) = gradient . (cos, sin) over all around.
    real(wp), intent(in) :: slope(:,:)            !! along the spokes (3,n)
    real(wp), intent(in) :: step                  !! angle from spoke to spoke [rad]
    real(wp) :: gradient(3,2)

    integer :: i

    gradient = 0
    do i = 1, size(slope, 2)
      gradient(:,1) = gradient(:,1) + 2*cos((i - 1)*step)*slope(:,i)/size(slope, 2)
      gradient(:,2) = gradient(:,2) + 2*sin((i - 1)*step)*slope(:,i)/size(slope, 2)
    end do
  end function point_gradient

  pure function boundary_gradient(slope, step) result(gradient)
    !! That of the boundary where it has a corner; else the tangent from the boundary, so that it
    !! stays as straight as it is, and what leads inside from the other spokes.
    real(wp), intent(in) :: slope(:,:)            !! along the spokes, two of the boundary (3,n+1)
    real(wp), intent(in) :: step                  !! angle from spoke to spoke [rad]
    real(wp) :: gradient(3,2)

    real(wp) :: last, weight
    integer :: i, n

    n = size(slope, 2) - 1
    last = n*step
    if (is_bent(last)) then
      gradient(:,1) = slope(:,1)
      gradient(:,2) = (slope(:,n+1) - cos(last)*slope(:,1))/sin(last)
      return
    end if
    gradient(:,1) = (slope(:,1) - slope(:,n+1))/2
    gradient(:,2) = 0
    weight = 0
    do i = 2, n
      weight = weight + sin((i - 1)*step)**2
      gradient(:,2) = gradient(:,2) + sin((i - 1)*step)*(slope(:,i) - cos((i - 1)*step) &
        * gradient(:,1))
    end do
    gradient(:,2) = gradient(:,2)/weight
  end function boundary_gradient

  subroutine set_free_twist(spline, v, fan, d, s0, s1, inner, spoke)
    !! The free twists so that all come near to what is wanted. Before, control points of the
    !! seams so that the alternating sum of r is what it must be: 0, or that of the first and last
    !! twist on the boundary.
    type(unstructured_spline_type), intent(inout) :: spline
    integer, intent(in) :: v                      !! the point
    integer, intent(in) :: fan(:)                 !! its corners (n)
    real(wp), intent(in) :: d(:), s0(3), s1(:,:)  !! spokes (n+1), (3,n+1)
    real(wp), intent(in) :: inner(:,:), spoke(:,:)   !! what is wanted

    real(wp) :: a(2), beyond, difference(3), part(size(fan)), r(3,size(fan)), s2(3), total(3)
    real(wp), dimension(3,size(fan)) :: twist, wanted
    integer :: c, i, n
    logical :: has_ends

    n = size(fan)
    associate (mesh => spline%mesh, slots => spline%slots, cp => spline%cp)
      do i = 1, n
        wanted(:,i) = (inner(:,fan(i)) - s1(:,i) - s1(:,i+1) + s0)/(d(i)*d(i+1))
      end do
      total = 0
      has_ends = mesh%is_boundary(v) .and. slots%solved(v) > 0
      if (has_ends) total = -wanted(:,1) - (-1)**n*wanted(:,n)
      r = 0
      do i = 1, n
        if (.not. mesh%seam(fan(i))) cycle
        a = touching_gluing(mesh, fan(i), 1)
        beyond = 0
        if (slots%beyond(2,fan(i)) /= 0) beyond = mesh%interval(abs(slots%beyond(2,fan(i))))
        part(i) = d(i)/(d(i) + beyond)
        c = slots%curve(2,fan(i))
        s2 = spoke(:,mesh%twin(fan(i)))
        if (c > 0) s2 = cp(:,c)
        if (mesh%fades(2,fan(i))) s2 = mean_over(mesh, fan(i), 2, inner)
        s2 = (1 - part(i))*s1(:,i) + part(i)*s2
        r(:,i) = (2*a(1)*(s2 - s1(:,i)) + (a(2) - 3*a(1))*(s1(:,i) - s0))/(3*d(i)**2)
        total = total + (-1)**i*r(:,i)
      end do
      if (slots%solved(v) > 0) then
        total = total/merge(n + 1, n, has_ends)
        do i = merge(2, 1, has_ends), n
          r(:,i) = r(:,i) - (-1)**i*total
          call move(fan(i), -(-1)**i*total*3*d(i)**2/(2*mesh%gluing(1,fan(i))*part(i)))
        end do
      end if
      if (has_ends) wanted(:,1) = wanted(:,1) + total
      ! all from the first
      twist(:,1) = wanted(:,1)
      difference = 0
      do i = 2, n
        twist(:,i) = r(:,i) - twist(:,i-1)
        difference = difference + (-1)**(i-1)*(wanted(:,i) - twist(:,i))/n
      end do
      cp(:,slots%twist(v)) = control_of(1)
      if (has_ends) cp(:,slots%twist(v)+1) = control_of(n)
    end associate

  contains

    pure function control_of(k) result(x)
      !! The inner coefficient of face k at the point.
      integer, intent(in) :: k
      real(wp) :: x(3)

      x = s1(:,k) + s1(:,k+1) - s0 + d(k)*d(k+1)*(twist(:,k) - (-1)**k*difference)
    end function control_of

    subroutine move(edge, step)
      !! What determines the second coefficient of a spoke.
      integer, intent(in) :: edge                 !! corner that the spoke starts from
      real(wp), intent(in) :: step(3)

      integer :: ids(3), k

      associate (mesh => spline%mesh, slots => spline%slots)
        ids = [slots%curve(2,edge), 0, 0]
        if (mesh%fades(2,edge)) ids(2:3) = slots%inner([next_corner(edge), mesh%twin(edge)])
      end associate
      do k = 1, 3
        if (ids(k) > 0) spline%cp(:,ids(k)) = spline%cp(:,ids(k)) + step
      end do
    end subroutine move
  end subroutine set_free_twist

  pure function mean_over(mesh, c, k, inner) result(x)
    !! Coefficient of a smooth edge between the inner ones beside it.
    type(quad_mesh_type), intent(in) :: mesh
    integer, intent(in) :: c                    !! corner that the edge starts from
    integer, intent(in) :: k                    !! 1: next to its start, 2: to its end
    real(wp), intent(in) :: inner(:,:)          !! (3,4*nf)
    real(wp) :: x(3)

    real(wp) :: other, own
    integer :: t

    t = mesh%twin(c)
    own = mesh%interval(previous_corner(c))
    other = mesh%interval(next_corner(t))
    x = (other*inner(:,merge(c, next_corner(c), k == 1)) &
      + own*inner(:,merge(next_corner(t), t, k == 1)))/(own + other)
  end function mean_over
end module joint_controls
