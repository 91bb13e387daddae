module spline_refinement
  !! Uniform refinement of unstructured splines: every face becomes four, knot intervals are halved.
  !! The surface stays exactly as it is where it is bicubic and C2 (knot insertion). Beside seams,
  !! where C1 becomes C2, it is followed by quasi-interpolation: the limit under refinement is not
  !! the first surface, but near to it. Seams keep their lengths and factors.
  use kinds, only: wp
  use quad_mesh, only: quad_mesh_type, create_quad_mesh, next_corner, previous_corner, face_of
  use seam_lines, only: halve_seams
  use unstructured_spline, only: unstructured_spline_type, create_spline, coefficients_of
  use spline_controls, only: controls_from_jets
  use bernstein, only: bernstein_1d
  implicit none (type, external)
  private
  public :: split_faces, refine_spline, follow_spline, quarter_place

contains

  subroutine split_faces(mesh, finer, message)
    !! Vertices 1 ... nv stay, then come the middles of edges and faces, at the means of their
    !! vertices. Faces 4f-3 ... 4f hold the corners of face f, each as their first corner.
    type(quad_mesh_type), intent(in) :: mesh
    type(quad_mesh_type), intent(out) :: finer
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong

    real(wp), allocatable :: x(:,:)
    integer, allocatable :: faces(:,:), middle(:)
    integer :: c, n

    allocate (middle(4*mesh%nf), source=0)
    allocate (x(3,mesh%nv+5*mesh%nf), source=0.0_wp)
    x(:,1:mesh%nv) = mesh%x
    n = mesh%nv
    do c = 1, 4*mesh%nf
      if (middle(c) > 0) cycle
      n = n + 1
      middle(c) = n
      if (mesh%twin(c) > 0) middle(mesh%twin(c)) = n
      x(:,n) = (mesh%x(:,mesh%vertex(c)) + mesh%x(:,mesh%vertex(next_corner(c))))/2
    end do
    allocate (faces(4,4*mesh%nf))
    do c = 1, 4*mesh%nf
      x(:,n+face_of(c)) = x(:,n+face_of(c)) + mesh%x(:,mesh%vertex(c))/4
      faces(:,c) = [mesh%vertex(c), middle(c), n + face_of(c), middle(previous_corner(c))]
    end do
    call create_quad_mesh(x(:,1:n+mesh%nf), faces, finer, message)
    if (len(message) > 0) return
    finer%angle(1:mesh%nv) = mesh%angle
    do c = 1, 4*mesh%nf
      ! the new face of corner c: its edges 1 and 4 lie on old ones
      finer%interval(4*c-3) = mesh%interval(c)/2
      finer%interval(4*c-1) = mesh%interval(c)/2
      finer%interval(4*c-2) = mesh%interval(previous_corner(c))/2
      finer%interval(4*c) = mesh%interval(previous_corner(c))/2
      finer%crease(4*c-3) = mesh%crease(c)
      finer%crease(4*c) = mesh%crease(previous_corner(c))
    end do
    call halve_seams(mesh, finer)
  end subroutine split_faces

  subroutine refine_spline(spline, finer, message)
    type(unstructured_spline_type), intent(in) :: spline
    type(unstructured_spline_type), intent(out) :: finer
    character(:), allocatable, intent(out) :: message    !! empty: nothing wrong

    type(quad_mesh_type) :: mesh

    call split_faces(spline%mesh, mesh, message)
    if (len(message) > 0) return
    call create_spline(mesh, finer, message)
    if (len(message) > 0) return
    call follow_spline(spline, finer)
  end subroutine refine_spline

  subroutine follow_spline(spline, finer)
    !! The control points of the refinement, linear in those of the spline.
    type(unstructured_spline_type), intent(in) :: spline
    type(unstructured_spline_type), intent(inout) :: finer

    real(wp), allocatable :: b(:,:), jet(:,:,:,:)
    integer :: c, f, k

    allocate (jet(3,0:2,0:2,4*finer%mesh%nf), source=0.0_wp)
    do f = 1, spline%mesh%nf
      call coefficients_of(spline, f, b)
      do k = 0, 3
        c = 4*f - 3 + k
        call child_jets(b, spline%degree(f), k, spline%mesh%interval([c, previous_corner(c)])/2, &
          jet(:,:,:,4*c-3:4*c))
      end do
    end do
    do k = 1, finer%mesh%nv
      if (finer%mesh%corner(k) > 0) finer%mesh%x(:,k) = jet(:,0,0,finer%mesh%corner(k))
    end do
    call controls_from_jets(finer, jet)
  end subroutine follow_spline

  pure function quarter_place(k, xi) result(place)
    !! Parameters in an element of a point of its quarter at corner k, which is turned with it.
    integer, intent(in) :: k                    !! 0 ... 3 from the origin counter-clockwise
    real(wp), intent(in) :: xi(2)               !! in the quarter, whose origin is that corner
    real(wp) :: place(2)

    select case (k)
    case (0);     place = xi/2
    case (1);     place = [1 - xi(2)/2, xi(1)/2]
    case (2);     place = 1 - xi/2
    case default; place = [xi(2)/2, 1 - xi(1)/2]
    end select
  end function quarter_place

  subroutine child_jets(b, p, k, h, jet)
    !! Derivatives at the corners of the quarter of an element that holds its corner k, seen from
    !! each corner of that quarter.
    real(wp), intent(in) :: b(:,:)              !! Bezier coefficients (3,(p+1)**2)
    integer, intent(in) :: p                    !! degree
    integer, intent(in) :: k                    !! corner of the element, 0 ... 3 counter-clockwise
    real(wp), intent(in) :: h(2)                !! intervals of the quarter along the edge that
                                                !! starts at corner k and the one that ends there
    real(wp), intent(inout) :: jet(:,0:,0:,:)   !! (3,0:2,0:2,4)

    integer, parameter :: corner(2,0:3) = reshape([0, 0, 1, 0, 1, 1, 0, 1], [2, 4])
    integer, parameter :: along(2,0:3) = reshape([1, 0, 0, 1, -1, 0, 0, -1], [2, 4])
    integer, parameter :: up(2,0:3) = reshape([0, 1, -1, 0, 0, -1, 1, 0], [2, 4])
    real(wp) :: d(3,0:2,0:2), step(2), xi(2)
    integer :: first(2), i, j, m, second(2)

    do m = 0, 3
      ! place: corner k, then half an edge along the sides of the quarter
      xi = corner(:,k) + 0.5_wp*(corner(1,m)*along(:,k) + corner(2,m)*up(:,k))
      call derivatives(b, p, xi, d)
      ! directions of the quarter's corner m, in the element's parameters
      if (mod(m, 2) == 0) then
        step = [h(1), h(2)]
      else
        step = [h(2), h(1)]
      end if
      first = direction(m)
      second = direction(m + 1)
      do j = 0, 2
        do i = 0, 2
          jet(:,i,j,m+1) = mixed(d, first, i, second, j) * (0.5_wp/step(1))**i * (0.5_wp/step(2))**j
        end do
      end do
    end do

  contains

    pure function direction(m) result(e)
      !! Of the edge that starts at corner m of the quarter; m + 1 gives the other edge at corner m,
      !! away from it.
      integer, intent(in) :: m
      integer :: e(2)

      select case (modulo(m, 4))
      case (0); e = along(:,k)
      case (1); e = up(:,k)
      case (2); e = -along(:,k)
      case default; e = -up(:,k)
      end select
    end function direction
  end subroutine child_jets

  pure function mixed(d, first, i, second, j) result(x)
    !! Derivative, i times along `first` and j times along `second`, which are axes up to sign.
    real(wp), intent(in) :: d(:,0:,0:)          !! derivatives by s and t (3,0:2,0:2)
    integer, intent(in) :: first(2), i, second(2), j
    real(wp) :: x(3)

    if (first(1) /= 0) then
      x = d(:,i,j) * first(1)**i * second(2)**j
    else
      x = d(:,j,i) * first(2)**i * second(1)**j
    end if
  end function mixed

  subroutine derivatives(b, p, xi, d)
    real(wp), intent(in) :: b(:,:)              !! (3,(p+1)**2)
    integer, intent(in) :: p
    real(wp), intent(in) :: xi(2)
    real(wp), intent(out) :: d(3,0:2,0:2)       !! by s and t

    real(wp) :: values(0:p,0:2,2)
    integer :: i, j, k, l

    do k = 1, 2
      call basis(p, xi(k), values(:,:,k))
    end do
    d = 0
    do j = 0, 2
      do i = 0, 2
        do l = 0, p
          do k = 0, p
            d(:,i,j) = d(:,i,j) + values(k,i,1)*values(l,j,2)*b(:,1+k+(p+1)*l)
          end do
        end do
      end do
    end do
  end subroutine derivatives

  subroutine basis(p, x, values)
    !! Bernstein polynomials and two derivatives.
    integer, intent(in) :: p
    real(wp), intent(in) :: x
    real(wp), intent(out) :: values(0:p,0:2)

    real(wp) :: lower(0:p)
    integer :: k

    values = 0
    call bernstein_1d(p, x, values(:,0))
    call bernstein_1d(p - 1, x, lower(0:p-1))
    do k = 0, p - 1
      values(k,1) = values(k,1) - p*lower(k)
      values(k+1,1) = values(k+1,1) + p*lower(k)
    end do
    call bernstein_1d(p - 2, x, lower(0:p-2))
    do k = 0, p - 2
      values(k,2) = values(k,2) + p*(p - 1)*lower(k)
      values(k+1,2) = values(k+1,2) - 2*p*(p - 1)*lower(k)
      values(k+2,2) = values(k+2,2) + p*(p - 1)*lower(k)
    end do
  end subroutine basis
end module spline_refinement
