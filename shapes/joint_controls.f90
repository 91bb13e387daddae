module joint_controls
  !! Control points of extraordinary points and along seams, from Bezier coefficients that are
  !! wanted
  !! but need not satisfy the conditions there: the nearest in a simple sense.
  use kinds, only: wp
  use quad_mesh, only: next_corner, previous_corner, face_of
  use extraordinary_ring, only: spoke_cosine
  use unstructured_spline, only: unstructured_spline_type, first_corner, coefficient
  implicit none (type, external)
  private
  public :: set_rings, set_seams

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
        if (slots%plane(v) > 0 .and. .not. mesh%compact(v)) &
          call set_point(spline, v, inner, point(:,v), spoke, arriving)
      end do
      do c = 1, 4*mesh%nf
        if (.not. mesh%seam(c)) cycle
        t = mesh%twin(c)
        if (c > t) cycle
        s = edge_values(spline, c)
        do k = 1, 2
          if (k == 1) call share_defect(c, next_corner(t))
          if (k == 2) call share_defect(next_corner(c), t)
        end do
      end do
    end associate

  contains

    subroutine share_defect(lead, follow)
      integer, intent(in) :: lead, follow         !! corners

      real(wp) :: a(2), defect(3), h(3), q, r

      if (spline%slots%inner(lead) == 0) return
      associate (mesh => spline%mesh)
        q = mesh%interval(previous_corner(c))
        r = mesh%interval(next_corner(t))
        a = mesh%gluing(:,c)
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

    integer, parameter :: place(4,4) = reshape([1, 2, 3, 4, 4, 8, 12, 16, 16, 15, 14, 13, &
      13, 9, 5, 1], [4, 4])
    integer :: k, m

    m = modulo(c - first_corner(spline, face_of(c)), 4) + 1
    do k = 0, 3
      s(:,k) = coefficient(spline, face_of(c), place(k+1,m))
    end do
  end function edge_values

  subroutine set_point(spline, v, inner, s0, spoke, arriving)
    type(unstructured_spline_type), intent(inout) :: spline
    integer, intent(in) :: v                      !! extraordinary point with seams
    real(wp), intent(in) :: inner(:,:), s0(3), spoke(:,:), arriving(:,:)   !! what is wanted

    real(wp) :: angle, d(spline%mesh%faces(v)+1), gradient(3,2), matrix(2,2), mean, rhs(3,2), &
      s1(3,spline%mesh%faces(v)+1)
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
      matrix = 0
      rhs = 0
      do i = 1, merge(n + 1, n, mesh%is_boundary(v))
        angle = (i - 1)*mesh%angle(v)
        matrix = matrix + reshape([cos(angle)**2, cos(angle)*sin(angle), cos(angle)*sin(angle), &
          sin(angle)**2], [2, 2])
        rhs(:,1) = rhs(:,1) + cos(angle)*(s1(:,i) - s0)/d(i)
        rhs(:,2) = rhs(:,2) + sin(angle)*(s1(:,i) - s0)/d(i)
      end do
      gradient(:,1) = matrix(2,2)*rhs(:,1) - matrix(1,2)*rhs(:,2)
      gradient(:,2) = matrix(1,1)*rhs(:,2) - matrix(2,1)*rhs(:,1)
      gradient = gradient/(matrix(1,1)*matrix(2,2) - matrix(1,2)*matrix(2,1))
      mean = sum(d(1:n))/n
      if (mesh%is_boundary(v)) mean = sum(d)/(n + 1)
      do i = 0, 2
        angle = 2*pi*i/3
        cp(:,plane+i) = s0 + 2*mean*(cos(angle)*gradient(:,1) + sin(angle)*gradient(:,2))
      end do
      do i = 1, n + 1
        angle = (i - 1)*mesh%angle(v)
        s1(:,i) = s0 + d(i)*(cos(angle)*gradient(:,1) + sin(angle)*gradient(:,2))
      end do
    end associate
    if (spline%slots%twist(v) > 0) call set_free_twist(spline, v, fan, d, s0, s1, inner, spoke)
  end subroutine set_point

  subroutine set_free_twist(spline, v, fan, d, s0, s1, inner, spoke)
    !! The free twist so that all come near to what is wanted. Before, for points inside, control
    !! points of the seams so that the alternating sum of r vanishes.
    type(unstructured_spline_type), intent(inout) :: spline
    integer, intent(in) :: v                      !! the point
    integer, intent(in) :: fan(:)                 !! its corners (n)
    real(wp), intent(in) :: d(:), s0(3), s1(:,:)  !! spokes (n+1), (3,n+1)
    real(wp), intent(in) :: inner(:,:), spoke(:,:)   !! what is wanted

    real(wp) :: a(2), beyond, difference(3), part(size(fan)), r(3,size(fan)), s2(3), total(3), &
      twist(3)
    integer :: c, i, n

    n = size(fan)
    associate (mesh => spline%mesh, slots => spline%slots, cp => spline%cp)
      total = 0
      r = 0
      do i = 1, n
        if (.not. mesh%seam(fan(i))) cycle
        a = mesh%gluing(:,fan(i))
        beyond = 0
        if (slots%beyond(2,fan(i)) /= 0) beyond = mesh%interval(abs(slots%beyond(2,fan(i))))
        part(i) = d(i)/(d(i) + beyond)
        c = slots%curve(2,fan(i))
        s2 = spoke(:,mesh%twin(fan(i)))
        if (c > 0) s2 = cp(:,c)
        s2 = (1 - part(i))*s1(:,i) + part(i)*s2
        r(:,i) = (2*a(1)*(s2 - s1(:,i)) + (a(2) - 3*a(1))*(s1(:,i) - s0))/(3*d(i)**2)
        total = total + (-1)**i*r(:,i)/n
      end do
      if (.not. mesh%is_boundary(v)) then
        do i = 1, n
          r(:,i) = r(:,i) - (-1)**i*total
          c = slots%curve(2,fan(i))
          if (c > 0) cp(:,c) = cp(:,c) &
            - (-1)**i*total*3*d(i)**2/(2*mesh%gluing(1,fan(i))*part(i))
        end do
      end if
      twist = 0
      difference = 0
      do i = 1, n
        if (i > 1) twist = r(:,i) - twist
        difference = difference + (-1)**(i-1) * ((inner(:,fan(i)) - s1(:,i) - s1(:,i+1) + s0) &
          /(d(i)*d(i+1)) - twist)/n
      end do
      cp(:,slots%twist(v)) = s1(:,1) + s1(:,2) - s0 + d(1)*d(2)*difference
    end associate
  end subroutine set_free_twist

  subroutine set_rings(spline, inner, target_at)
    !! Control points of the extraordinary points from quartics that need not satisfy the
    !! conditions.
    type(unstructured_spline_type), intent(inout) :: spline
    real(wp), intent(in) :: inner(:,:)            !! inner coefficients of irregular faces (3,4*nf)
    real(wp), intent(in) :: target_at(:,0:,0:,:)  !! quartics from the point (3,0:4,0:4,nf)

    integer :: v

    do v = 1, spline%mesh%nv
      if (spline%mesh%compact(v)) call set_ring(spline, v, inner, target_at)
    end do
  end subroutine set_rings

  subroutine set_ring(spline, v, inner, target_at)
    type(unstructured_spline_type), intent(inout) :: spline
    integer, intent(in) :: v                      !! extraordinary point
    real(wp), intent(in) :: inner(:,:)            !! (3,4*nf)
    real(wp), intent(in) :: target_at(:,0:,0:,:)  !! (3,0:4,0:4,nf)

    real(wp) :: angle, d(spline%mesh%faces(v)), e1(3), e2(3), gradient(3,2), here(3), mean, s0(3), &
      s1(3,spline%mesh%faces(v)), s2(3,spline%mesh%faces(v)), s3(3), there(3), total(3)
    integer :: after, before, c, fan(spline%mesh%faces(v)), i, n

    n = spline%mesh%faces(v)
    fan(1) = spline%mesh%corner(v)
    do i = 2, n
      fan(i) = spline%mesh%turn(fan(i-1))
    end do
    associate (mesh => spline%mesh, slots => spline%slots, cp => spline%cp)
      d = mesh%interval(fan)
      mean = sum(d)/n
      s0 = 0
      do i = 1, n
        s0 = s0 + target_at(:,0,0,face_of(fan(i)))/n
      end do
      gradient = 0
      do i = 1, n
        angle = 2*pi*(i - 1)/n
        here = 4*(target_at(:,1,0,face_of(fan(i))) - s0)/(3*d(i)*n)
        gradient(:,1) = gradient(:,1) + 2*cos(angle)*here
        gradient(:,2) = gradient(:,2) + 2*sin(angle)*here
      end do
      do i = 0, 2
        angle = 2*pi*i/3
        cp(:,slots%plane(v)+i) = s0 + 2*mean*(cos(angle)*gradient(:,1) + sin(angle)*gradient(:,2))
      end do
      total = 0
      do i = 1, n
        angle = 2*pi*(i - 1)/n
        before = modulo(i - 2, n) + 1
        after = modulo(i, n) + 1
        s1(:,i) = s0 + d(i)*(cos(angle)*gradient(:,1) + sin(angle)*gradient(:,2))
        s2(:,i) = (d(before)*inner(:,next_corner(fan(i))) &
          + d(after)*inner(:,previous_corner(fan(before))))/(d(before) + d(after))
        total = total + (-1)**i*(s2(:,i) - 3*s1(:,i) + 2*s0)/d(i)**2
      end do
      if (mod(n, 2) == 0) then
        ! the alternating sum has to vanish
        do i = 1, n
          here = -(-1)**i*d(i)**2*total/n
          s2(:,i) = s2(:,i) + here
          c = slots%inner(next_corner(fan(i)))
          if (c > 0) cp(:,c) = cp(:,c) + here
          c = slots%inner(previous_corner(fan(modulo(i-2,n)+1)))
          if (c > 0) cp(:,c) = cp(:,c) + here
        end do
        call set_twist()
      end if
      do i = 1, n
        before = modulo(i - 2, n) + 1
        after = modulo(i, n) + 1
        c = next_corner(fan(i))
        cp(:,slots%centre(face_of(c))) = target_at(:,2,2,face_of(c))
        s3 = coefficient(spline, face_of(c), 5)
        e2 = (s1(:,i) + s2(:,i))/2
        here = (target_at(:,2,1,face_of(c)) - target_at(:,2,0,face_of(c)))/d(after)
        there = (target_at(:,1,2,face_of(fan(before))) - target_at(:,2,0,face_of(c)))/d(before)
        total = 0.25_wp*spoke_cosine(n)*(s3 - s2(:,i))/d(i)
        cp(:,slots%middle(fan(i))) = e2 + d(after)*(total + here - there)/2
      end do
    end associate

  contains

    subroutine set_twist()
      !! The twist of face 1 so that the twists come near to those of the target.
      real(wp) :: difference(3), twist(3)
      integer :: i

      twist = 0
      difference = 0
      do i = 1, n
        ! t of face i by k = 1 if that of face 1 is 0, against the target's
        if (i > 1) twist = 0.75_wp*spoke_cosine(n)*(s2(:,i) - 3*s1(:,i) + 2*s0)/d(i)**2 - twist
        c = face_of(fan(i))
        difference = difference + (-1)**(i-1) * ((target_at(:,1,1,c) - target_at(:,1,0,c) &
          - target_at(:,0,1,c) + target_at(:,0,0,c))/(d(i)*d(modulo(i,n)+1)) - twist)/n
      end do
      e1 = s0 + 0.75_wp*(s1(:,1) - s0)
      e2 = s0 + 0.75_wp*(s1(:,2) - s0)
      spline%cp(:,spline%slots%twist(v)) = e1 + e2 - s0 + d(1)*d(2)*difference
    end subroutine set_twist
  end subroutine set_ring
end module joint_controls
