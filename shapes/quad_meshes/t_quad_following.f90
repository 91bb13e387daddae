module t_quad_following
  !! Control points of a T-spline whose mesh was divided (t_quad_refinement) so that it follows the
  !! spline before. A control point is the polar form of the coarse bicubic at the inner knots of
  !! its function, the mean over the quadrants of its vertex: where the finer space contains the
  !! coarse surface, that stays as it is. Around extraordinary points the rings follow as in
  !! spline_refinement.
  use kinds, only: wp
  use t_quad_rays, only: side_point, turned
  use t_quad_functions, only: piece_type
  use t_quad_spline, only: t_quad_spline_type
  use spline_refinement, only: follow_spline
  implicit none (type, external)
  private
  public :: follow_t_spline

contains

  subroutine follow_t_spline(coarse, finer)
    type(t_quad_spline_type), intent(inout) :: coarse
    type(t_quad_spline_type), intent(inout) :: finer

    integer, allocatable :: first(:), times(:)
    real(wp) :: x(3)
    integer :: a, e, k

    allocate (first(coarse%mesh%nf), times(finer%n), source=0)
    do e = coarse%ne, 1, -1
      first(coarse%face(e)) = e
    end do
    finer%cp = 0
    do k = 1, finer%functions%np
      associate (piece => finer%functions%pieces(k))
        if (piece%id == 0) cycle
        if (finer%rings%zone(finer%mesh%face(piece%half_edge))) cycle
        call polar_form(piece, x)
        finer%cp(:,piece%id) = finer%cp(:,piece%id) + x
        times(piece%id) = times(piece%id) + 1
      end associate
    end do
    do a = 1, finer%n
      if (times(a) > 0) finer%cp(:,a) = finer%cp(:,a)/times(a)
    end do
    if (.not. any(coarse%rings%zone)) return
    do a = 1, size(coarse%rings%id)
      if (coarse%rings%id(a) > 0) coarse%rings%spline%cp(:,a) = coarse%cp(:,coarse%rings%id(a))
    end do
    call follow_spline(coarse%rings%spline, finer%rings%spline)
    do a = 1, size(finer%rings%id)
      if (finer%rings%own(a) .and. finer%rings%id(a) > 0) &
        finer%cp(:,finer%rings%id(a)) = finer%rings%spline%cp(:,a)
    end do

  contains

    subroutine polar_form(piece, x)
      type(piece_type), intent(in) :: piece
      real(wp), intent(out) :: x(3)

      real(wp) :: near(2), p(2), p0(2), u(3,2), weight(4,2)
      integer :: axis, d, f, i, j, l, m

      ! the quadrant in the coarse face: corner k of it is the origin of its quarter
      f = (finer%mesh%face(piece%half_edge) + 3)/4
      m = finer%mesh%face(piece%half_edge) - 4*(f - 1) - 1
      p = side_point(finer%mesh, piece%half_edge, finer%mesh%at(piece%half_edge))
      p0 = corner_of(f, m) + turned(p, m)
      axis = modulo(piece%axis + m, 4)
      near = p0 + turned(1e-6_wp*piece%knots(5,:), axis)
      l = first(f)
      do while (any(near > coarse%hi(:,l)) .or. any(near < coarse%lo(:,l)))
        l = l + 1
        if (l > coarse%ne) error stop 't_quad_following: no element of the coarse spline'
      end do
      ! inner knots along the axes of the element, which is [0,1]^2
      do i = 1, 3
        p = p0 + turned(piece%knots(1+i,:), axis)
        u(i,:) = (p - coarse%lo(:,l))/(coarse%hi(:,l) - coarse%lo(:,l))
      end do
      do d = 1, 2
        weight(:,d) = blossom(u(:,d))
      end do
      x = 0
      do j = 1, 4
        do i = 1, 4
          associate (row => coarse%b(i+4*(j-1),l))
            x = x + weight(i,1)*weight(j,2)*matmul(coarse%cp(:,row%id(1:row%n)), row%c(1:row%n))
          end associate
        end do
      end do
    end subroutine polar_form

    pure function corner_of(f, k) result(p)
      integer, intent(in) :: f, k
      real(wp) :: p(2)

      p = 0
      if (k == 1 .or. k == 2) p(1) = coarse%mesh%size(1,f)
      if (k == 2 .or. k == 3) p(2) = coarse%mesh%size(2,f)
    end function corner_of
  end subroutine follow_t_spline

  pure function blossom(u) result(weight)
    !! Of the Bezier coefficients of a cubic on [0,1] in its polar form.
    real(wp), intent(in) :: u(3)
    real(wp) :: weight(4)

    real(wp) :: old(4)
    integer :: k

    weight = [1, 0, 0, 0]
    do k = 1, 3
      old = weight
      weight(1) = (1 - u(k))*old(1)
      weight(2:4) = (1 - u(k))*old(2:4) + u(k)*old(1:3)
    end do
  end function blossom
end module t_quad_following
