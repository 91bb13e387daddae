module surface_fit
  !! Moves the control points of a surface so that it follows another one, known by its
  !! closest points: least squares of the distances to the closest points at Gauss points, which
  !! are then found again. Normal equations by conjugate gradients, element by element.
  use kinds, only: wp
  use status_codes, only: ok
  use extraction_mesh, only: extraction_mesh_type
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  implicit none (type, external)
  private
  public :: target_surface, fit_surface, distance_to

  type, abstract :: target_surface
  contains
    procedure(closest), deferred :: closest_to
  end type target_surface

  abstract interface
    pure function closest(self, x) result(y)
      import :: target_surface, wp
      class(target_surface), intent(in) :: self
      real(wp), intent(in) :: x(3)                 !! a place near the surface
      real(wp) :: y(3)                             !! its closest point on it
    end function closest
  end interface

  !> functions of one element at its points
  type :: samples_type
    real(wp), allocatable :: shp(:,:)              !! (nen,ng)
    real(wp), allocatable :: wt(:)                 !! (ng)
  end type samples_type

contains

  subroutine fit_surface(mesh, surface, held, rounds)
    type(extraction_mesh_type), intent(inout), target :: mesh   !! surfaces; weights stay
    class(target_surface), intent(in) :: surface
    logical, intent(in) :: held(:,:)               !! coordinates that stay (3,nn)
    integer, intent(in) :: rounds                  !! times that closest points are looked for

    type(samples_type), allocatable :: samples(:)
    real(wp), allocatable :: diagonal(:), rhs(:,:), step(:,:)
    integer, pointer, contiguous :: ix(:)
    integer :: e, g, k

    call take_samples(mesh, 1, samples)
    allocate (diagonal(mesh%nn), source=0.0_wp)
    do e = 1, mesh%elements%ne
      ix => mesh%elements%connectivity(e)
      do g = 1, size(samples(e)%wt)
        diagonal(ix) = diagonal(ix) + samples(e)%wt(g)*samples(e)%shp(:,g)**2
      end do
    end do
    where (.not. diagonal > 0) diagonal = 1
    allocate (rhs(3,mesh%nn), step(3,mesh%nn))
    do k = 1, rounds
      rhs = 0
      do e = 1, mesh%elements%ne
        ix => mesh%elements%connectivity(e)
        call add_differences(samples(e), mesh%x(:,ix), ix)
      end do
      where (held) rhs = 0
      call solve(mesh, samples, diagonal, held, rhs, step)
      mesh%x = mesh%x + step
    end do

  contains

    subroutine add_differences(sample, xe, ix)
      type(samples_type), intent(in) :: sample
      real(wp), intent(in) :: xe(:,:)
      integer, intent(in) :: ix(:)

      real(wp) :: x(3), difference(3)
      integer :: a, g

      do g = 1, size(sample%wt)
        x = matmul(xe, sample%shp(:,g))
        difference = sample%wt(g)*(surface%closest_to(x) - x)
        do a = 1, size(ix)
          rhs(:,ix(a)) = rhs(:,ix(a)) + sample%shp(a,g)*difference
        end do
      end do
    end subroutine add_differences
  end subroutine fit_surface

  subroutine solve(mesh, samples, diagonal, held, rhs, x)
    !! Conjugate gradients with the diagonal for the three coordinates at once.
    type(extraction_mesh_type), intent(in), target :: mesh
    type(samples_type), intent(in) :: samples(:)
    real(wp), intent(in) :: diagonal(:)
    logical, intent(in) :: held(:,:)
    real(wp), intent(in) :: rhs(:,:)
    real(wp), intent(out) :: x(:,:)

    integer, parameter :: most_steps = 1000
    real(wp), parameter :: small = 1e-14_wp
    real(wp), allocatable :: p(:,:), q(:,:), r(:,:), z(:,:)
    real(wp) :: alpha, first, rz, rz_old
    integer :: k

    x = 0
    allocate (r, source=rhs)
    allocate (z, mold=r)
    allocate (q, mold=r)
    call precondition()
    allocate (p, source=z)
    rz = sum(r*z)
    first = rz
    do k = 1, most_steps
      if (.not. rz > small**2*first) exit
      call multiply(mesh, samples, p, q)
      where (held) q = 0
      alpha = rz/sum(p*q)
      x = x + alpha*p
      r = r - alpha*q
      call precondition()
      rz_old = rz
      rz = sum(r*z)
      p = z + rz/rz_old*p
    end do

  contains

    subroutine precondition()
      integer :: a

      do a = 1, size(diagonal)
        z(:,a) = r(:,a)/diagonal(a)
      end do
    end subroutine precondition
  end subroutine solve

  subroutine multiply(mesh, samples, p, q)
    type(extraction_mesh_type), intent(in), target :: mesh
    type(samples_type), intent(in) :: samples(:)
    real(wp), intent(in) :: p(:,:)
    real(wp), intent(out) :: q(:,:)

    integer, pointer, contiguous :: ix(:)
    real(wp) :: value_at(3)
    integer :: a, e, g

    q = 0
    do e = 1, mesh%elements%ne
      ix => mesh%elements%connectivity(e)
      do g = 1, size(samples(e)%wt)
        value_at = 0
        do a = 1, size(ix)
          value_at = value_at + samples(e)%shp(a,g)*p(:,ix(a))
        end do
        value_at = samples(e)%wt(g)*value_at
        do a = 1, size(ix)
          q(:,ix(a)) = q(:,ix(a)) + samples(e)%shp(a,g)*value_at
        end do
      end do
    end do
  end subroutine multiply

  subroutine take_samples(mesh, extra, samples)
    !! At Gauss points of p + extra in both directions.
    type(extraction_mesh_type), intent(in), target :: mesh
    integer, intent(in) :: extra
    type(samples_type), allocatable, intent(out) :: samples(:)

    integer, pointer, contiguous :: ix(:)
    real(wp), pointer, contiguous :: ce(:,:)
    integer :: e

    allocate (samples(mesh%elements%ne))
    do e = 1, mesh%elements%ne
      ix => mesh%elements%connectivity(e)
      ce => mesh%elements%operator(e)
      call take_sample(mesh%elements%degree(1:2,e), mesh%w(ix), ce, extra, samples(e))
    end do
  end subroutine take_samples

  subroutine take_sample(degree, we, ce, extra, sample)
    integer, intent(in) :: degree(2), extra
    real(wp), contiguous, intent(in) :: we(:), ce(:,:)
    type(samples_type), intent(out) :: sample

    real(wp) :: dshp(2,size(we)), d2shp(3,size(we)), xi(2,product(degree+extra))
    integer :: g, status

    allocate (sample%wt(size(xi, 2)), sample%shp(size(we),size(xi, 2)))
    call tensor_rule(degree + extra, xi, sample%wt)
    do g = 1, size(xi, 2)
      call shape_functions(degree, we, ce, xi(:,g), 0, sample%shp(:,g), dshp, d2shp, status)
      if (status /= ok) error stop 'surface_fit: a weight function is not positive'
    end do
  end subroutine take_sample

  real(wp) function distance_to(mesh, surface)
    !! The largest distance of the surface's points from the other one, at points that the fit has
    !! not seen.
    type(extraction_mesh_type), intent(in), target :: mesh
    class(target_surface), intent(in) :: surface

    type(samples_type), allocatable :: samples(:)
    integer, pointer, contiguous :: ix(:)
    real(wp) :: x(3)
    integer :: e, g

    call take_samples(mesh, 4, samples)
    distance_to = 0
    do e = 1, mesh%elements%ne
      ix => mesh%elements%connectivity(e)
      do g = 1, size(samples(e)%wt)
        x = matmul(mesh%x(:,ix), samples(e)%shp(:,g))
        distance_to = max(distance_to, norm2(surface%closest_to(x) - x))
      end do
    end do
  end function distance_to
end module surface_fit
