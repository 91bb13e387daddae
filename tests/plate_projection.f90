module plate_projection
  !! Bending of flat splines: Galerkin's solution of the biharmonic problem, and its errors.
  !!
  !!     (D2 u, D2 v) + (u, v) = (D2 w, D2 v) + (w, v)      for all v: free edges, the best approximation of w in H2
  !!     (D2 u, D2 v) = (D2 w, D2 v)                        clamped edges, w and its slope vanish there
  use, intrinsic :: ieee_exceptions, only: ieee_all, ieee_set_halting_mode, ieee_get_halting_mode, ieee_set_flag
  use kinds, only: wp
  use status_codes, only: ok
  use quad_mesh, only: face_of
  use unstructured_spline, only: unstructured_spline_type, spline_mesh, side_of_edge
  use extraction_mesh, only: extraction_mesh_type
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use geometry_map, only: physical_hessian
  implicit none (type, external)
  private
  public :: plate_errors, plate_field, waves, bubble, parabola, plane, solve_plate, solve_on_mesh

  type :: plate_errors
    integer :: unknowns = 0
    real(wp) :: l2 = 0, h1 = 0, h2 = 0        !! seminorms of the difference
  end type plate_errors

  !> w with its derivatives x, y, xx, yy, xy
  type, abstract :: plate_field
    logical :: is_clamped = .false.
  contains
    procedure(field_value), deferred :: at
  end type plate_field

  abstract interface
    pure function field_value(self, x) result(w)
      import :: plate_field, wp
      class(plate_field), intent(in) :: self
      real(wp), intent(in) :: x(2)
      real(wp) :: w(6)
    end function field_value
  end interface

  type, extends(plate_field) :: waves
  contains
    procedure :: at => waves_at
  end type waves

  !> constant curvature
  type, extends(plate_field) :: parabola
  contains
    procedure :: at => parabola_at
  end type parabola

  !> no curvature
  type, extends(plate_field) :: plane
  contains
    procedure :: at => plane_at
  end type plane

  !> product of the squared distances from the sides of a regular polygon in the unit circle, as `star` makes it
  type, extends(plate_field) :: bubble
    integer :: sides = 3
  contains
    procedure :: at => bubble_at
  end type bubble

  interface
    subroutine dposv(uplo, n, nrhs, a, lda, b, ldb, info)
      import :: wp
      character, intent(in) :: uplo
      integer, intent(in) :: n, nrhs, lda, ldb
      real(wp), intent(inout) :: a(lda,*), b(ldb,*)
      integer, intent(out) :: info
    end subroutine dposv
  end interface

contains

  pure function waves_at(self, x) result(w)
    class(waves), intent(in) :: self
    real(wp), intent(in) :: x(2)
    real(wp) :: w(6)
    real(wp) :: c1, c2, s1, s2

    s1 = sin(2*x(1) + 0.3_wp)
    c1 = cos(2*x(1) + 0.3_wp)
    s2 = sin(1.5_wp*x(2))
    c2 = cos(1.5_wp*x(2))
    w = [s1*c2, 2*c1*c2, -1.5_wp*s1*s2, -4*s1*c2, -2.25_wp*s1*c2, -3*c1*s2]
    if (self%is_clamped) w = 0
  end function waves_at

  pure function parabola_at(self, x) result(w)
    class(parabola), intent(in) :: self
    real(wp), intent(in) :: x(2)
    real(wp) :: w(6)

    w = [x(1)**2 + x(1)*x(2) - 3*x(2)**2, 2*x(1) + x(2), x(1) - 6*x(2), 2.0_wp, -6.0_wp, 1.0_wp]
    if (self%is_clamped) w = 0
  end function parabola_at

  pure function plane_at(self, x) result(w)
    class(plane), intent(in) :: self
    real(wp), intent(in) :: x(2)
    real(wp) :: w(6)

    w = [1 + 2*x(1) - x(2), 2.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    if (self%is_clamped) w = 0
  end function plane_at

  pure function bubble_at(self, x) result(w)
    class(bubble), intent(in) :: self
    real(wp), intent(in) :: x(2)
    real(wp) :: w(6)
    real(wp) :: angle, f(6), g(6), l, n(2)
    integer :: k

    f = [1.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp]
    do k = 1, self%sides
      angle = 8*atan(1.0_wp)*(k - 1)/self%sides
      n = [cos(angle), sin(angle)]
      l = cos(4*atan(1.0_wp)/self%sides) - dot_product(n, x)
      l = l/cos(4*atan(1.0_wp)/self%sides)
      n = -n/cos(4*atan(1.0_wp)/self%sides)
      ! times l**2
      g = [l**2, 2*l*n(1), 2*l*n(2), 2*n(1)**2, 2*n(2)**2, 2*n(1)*n(2)]
      f = [f(1)*g(1), f(1)*g(2) + f(2)*g(1), f(1)*g(3) + f(3)*g(1), &
        f(1)*g(4) + 2*f(2)*g(2) + f(4)*g(1), f(1)*g(5) + 2*f(3)*g(3) + f(5)*g(1), &
        f(1)*g(6) + f(2)*g(3) + f(3)*g(2) + f(6)*g(1)]
    end do
    w = f
  end function bubble_at

  subroutine solve_plate(spline, field, errors)
    type(unstructured_spline_type), intent(in) :: spline
    class(plate_field), intent(in) :: field
    type(plate_errors), intent(out) :: errors
    type(extraction_mesh_type), target :: mesh
    logical, allocatable :: fixed(:)

    call spline_mesh(spline, mesh)
    allocate (fixed(mesh%nn), source=.false.)
    if (field%is_clamped) call find_clamped(spline, mesh, fixed)
    call solve_on_mesh(mesh, fixed, field, errors)
  end subroutine solve_plate

  subroutine solve_on_mesh(mesh, fixed, field, errors)
    type(extraction_mesh_type), intent(in), target :: mesh
    logical, intent(in) :: fixed(:)              !! control points
    class(plate_field), intent(in) :: field
    type(plate_errors), intent(out) :: errors
    real(wp), allocatable :: a(:,:), b(:,:)
    logical :: halting(size(ieee_all))
    integer :: e, info, k

    allocate (a(mesh%nn,mesh%nn), b(mesh%nn,1), source=0.0_wp)
    do e = 1, mesh%elements%ne
      call element(e, .true.)
    end do
    do k = 1, mesh%nn
      if (.not. fixed(k)) cycle
      a(k,:) = 0
      a(:,k) = 0
      a(k,k) = 1
      b(k,1) = 0
    end do
    call ieee_get_halting_mode(ieee_all, halting)
    call ieee_set_halting_mode(ieee_all, .false.)
    call dposv('L', mesh%nn, 1, a, mesh%nn, b, mesh%nn, info)
    call ieee_set_flag(ieee_all, .false.)
    call ieee_set_halting_mode(ieee_all, halting)
    if (info /= 0) error stop 'plate_projection: the matrix is not positive definite'
    errors%unknowns = count(.not. fixed)
    do e = 1, mesh%elements%ne
      call element(e, .false.)
    end do
    errors%l2 = sqrt(errors%l2)
    errors%h1 = sqrt(errors%h1)
    errors%h2 = sqrt(errors%h2)

  contains

    subroutine element(e, is_assembly)
      integer, intent(in) :: e
      logical, intent(in) :: is_assembly
      integer, pointer, contiguous :: ix(:)
      real(wp), pointer, contiguous :: ce(:,:)
      real(wp), allocatable :: d2shp(:,:), d2shpx(:,:), dshp(:,:), dshpx(:,:), shp(:), we(:), wt(:), xe(:,:), xi(:,:)
      real(wp) :: d(6), dv, jacobian(2,2), mass, w(6)
      integer :: degree(2), g, i, status

      ix => mesh%elements%connectivity(e)
      ce => mesh%elements%operator(e)
      degree = mesh%elements%degree(1:2,e)
      allocate (shp(size(ix)), dshp(2,size(ix)), dshpx(2,size(ix)), d2shp(3,size(ix)), d2shpx(3,size(ix)))
      allocate (xi(2,product(degree+3)), wt(product(degree+3)))
      call tensor_rule(degree + 3, xi, wt)
      we = mesh%w(ix)
      xe = mesh%x(1:2,ix)
      mass = merge(0, 1, field%is_clamped)
      do g = 1, size(wt)
        call shape_functions(degree, we, ce, xi(:,g), 2, shp, dshp, d2shp, status)
        if (status == ok) call physical_hessian(xe, dshp, d2shp, dshpx, d2shpx, status)
        if (status /= ok) error stop 'plate_projection: an element is inverted'
        jacobian = matmul(xe, transpose(dshp))
        dv = wt(g)*(jacobian(1,1)*jacobian(2,2) - jacobian(1,2)*jacobian(2,1))
        w = field%at(matmul(xe, shp))
        if (is_assembly) then
          do i = 1, size(ix)
            b(ix(i),1) = b(ix(i),1) + dv*(mass*shp(i)*w(1) + d2shpx(1,i)*w(4) + d2shpx(2,i)*w(5) + 2*d2shpx(3,i)*w(6))
            a(ix,ix(i)) = a(ix,ix(i)) + dv*(mass*shp*shp(i) + d2shpx(1,:)*d2shpx(1,i) + d2shpx(2,:)*d2shpx(2,i) &
              + 2*d2shpx(3,:)*d2shpx(3,i))
          end do
        else
          d = w - [dot_product(shp, b(ix,1)), matmul(dshpx, b(ix,1)), matmul(d2shpx, b(ix,1))]
          errors%l2 = errors%l2 + dv*d(1)**2
          errors%h1 = errors%h1 + dv*sum(d(2:3)**2)
          errors%h2 = errors%h2 + dv*(d(4)**2 + d(5)**2 + 2*d(6)**2)
        end if
      end do
    end subroutine element
  end subroutine solve_on_mesh

  subroutine find_clamped(spline, mesh, fixed)
    !! Functions with value or slope on the boundary.
    type(unstructured_spline_type), intent(in) :: spline
    type(extraction_mesh_type), intent(in), target :: mesh
    logical, intent(inout) :: fixed(:)
    integer, pointer, contiguous :: ix(:)
    real(wp), pointer, contiguous :: ce(:,:)
    integer :: a, c, e, i, j, p, place(2)

    do c = 1, 4*spline%mesh%nf
      if (spline%mesh%twin(c) > 0) cycle
      e = face_of(c)
      ix => mesh%elements%connectivity(e)
      ce => mesh%elements%operator(e)
      p = mesh%elements%degree(1,e)
      do a = 1, size(ix)
        do i = 0, p
          do j = 0, 1
            select case (side_of_edge(c))
            case (1);     place = [j, i]
            case (2);     place = [p - j, i]
            case (3);     place = [i, j]
            case default; place = [i, p - j]
            end select
            if (abs(ce(a,1+place(1)+(p+1)*place(2))) > 1e-13_wp) fixed(ix(a)) = .true.
          end do
        end do
      end do
    end do
  end subroutine find_clamped
end module plate_projection
