module surface_fit
  !! Moves the control points of a surface so that it follows another one, known by its
  !! closest points: least squares of the distances to the closest points at Gauss points, which
  !! are then found again. Normal equations by conjugate gradients.
  use kinds, only: wp
  use status_codes, only: ok
  use extraction_mesh, only: extraction_mesh_type
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use linear_rows, only: linear_rows_type
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

  !> the matrix of the normal equations, row by row
  type :: normal_matrix
    integer, allocatable :: ptr(:)                 !! where a row begins (nn+1)
    integer, allocatable :: column(:)
    real(wp), allocatable :: value(:), diagonal(:)
  end type normal_matrix

  real(wp), parameter :: negligible = 1e-13_wp     !! part of a step, relative to the size of all

contains

  subroutine fit_surface(mesh, surface, held, rows, rounds)
    type(extraction_mesh_type), intent(inout), target :: mesh   !! surfaces; weights stay
    class(target_surface), intent(in) :: surface
    logical, intent(in) :: held(:,:)               !! coordinates that stay (3,nn)
    type(linear_rows_type), intent(in) :: rows(3)  !! that the steps of each coordinate obey
    integer, intent(in) :: rounds                  !! times that closest points are looked for

    type(samples_type), allocatable :: samples(:)
    type(normal_matrix) :: matrix
    real(wp), allocatable :: rhs(:,:), step(:,:)
    real(wp) :: enough
    integer, pointer, contiguous :: ix(:)
    integer :: e, k

    call take_samples(mesh, 1, samples)
    call form_matrix(mesh, samples, matrix)
    allocate (rhs(3,mesh%nn), step(3,mesh%nn))
    enough = (negligible*maxval(abs(mesh%x)))**2*sum(matrix%diagonal)
    do k = 1, rounds
      rhs = 0
      do e = 1, mesh%elements%ne
        ix => mesh%elements%connectivity(e)
        call add_differences(samples(e), mesh%x(:,ix), ix)
      end do
      where (held) rhs = 0
      call project(rows, rhs)
      call solve(matrix, held, rows, rhs, enough, step)
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

  subroutine project(rows, x)
    type(linear_rows_type), intent(in) :: rows(3)
    real(wp), intent(inout) :: x(:,:)

    real(wp) :: values(size(x, 2))
    integer :: i

    do i = 1, 3
      if (rows(i)%n == 0) cycle
      values = x(i,:)
      call rows(i)%project(values)
      x(i,:) = values
    end do
  end subroutine project

  subroutine form_matrix(mesh, samples, matrix)
    !! sum_g w_g R_a R_b, row by row from the elements of each node.
    type(extraction_mesh_type), intent(in), target :: mesh
    type(samples_type), intent(in) :: samples(:)
    type(normal_matrix), intent(out) :: matrix

    integer, pointer, contiguous :: ix(:)
    integer, allocatable :: elements_of(:), ptr(:), next(:), place(:)
    real(wp), allocatable :: row(:)
    integer :: a, b, e, i, own, length

    allocate (elements_of(mesh%elements%node_ptr(mesh%elements%ne+1)-1), next(mesh%nn), row(mesh%nn))
    allocate (ptr(mesh%nn+1), place(mesh%nn), source=0)
    do e = 1, mesh%elements%ne
      ix => mesh%elements%connectivity(e)
      ptr(ix+1) = ptr(ix+1) + 1
    end do
    ptr(1) = 1
    do a = 1, mesh%nn
      ptr(a+1) = ptr(a) + ptr(a+1)
    end do
    next = ptr(1:mesh%nn)
    do e = 1, mesh%elements%ne
      ix => mesh%elements%connectivity(e)
      elements_of(next(ix)) = e
      next(ix) = next(ix) + 1
    end do

    allocate (matrix%ptr(mesh%nn+1), matrix%column(0), matrix%value(0), matrix%diagonal(mesh%nn))
    matrix%ptr(1) = 1
    do a = 1, mesh%nn
      length = 0
      do i = ptr(a), ptr(a+1) - 1
        e = elements_of(i)
        ix => mesh%elements%connectivity(e)
        own = findloc(ix, a, dim=1)
        do b = 1, size(ix)
          if (place(ix(b)) == 0) then
            length = length + 1
            next(length) = ix(b)
            place(ix(b)) = length
            row(length) = 0
          end if
          row(place(ix(b))) = row(place(ix(b))) + sum(samples(e)%wt*samples(e)%shp(own,:)*samples(e)%shp(b,:))
        end do
      end do
      matrix%ptr(a+1) = matrix%ptr(a) + length
      call make_room(matrix, matrix%ptr(a+1) - 1)
      matrix%column(matrix%ptr(a):matrix%ptr(a+1)-1) = next(1:length)
      matrix%value(matrix%ptr(a):matrix%ptr(a+1)-1) = row(1:length)
      matrix%diagonal(a) = 0
      if (length > 0) matrix%diagonal(a) = row(place(a))
      place(next(1:length)) = 0
    end do
    where (.not. matrix%diagonal > 0) matrix%diagonal = 1
  end subroutine form_matrix

  pure subroutine make_room(matrix, n)
    type(normal_matrix), intent(inout) :: matrix
    integer, intent(in) :: n                       !! entries that must fit

    integer, allocatable :: column(:)
    real(wp), allocatable :: value(:)
    integer :: old

    old = size(matrix%column)
    if (n <= old) return
    allocate (column(2*n), value(2*n))
    column(1:old) = matrix%column
    value(1:old) = matrix%value
    call move_alloc(column, matrix%column)
    call move_alloc(value, matrix%value)
  end subroutine make_room

  subroutine solve(matrix, held, rows, rhs, enough, x)
    !! Conjugate gradients with the diagonal for the three coordinates at once.
    type(normal_matrix), intent(in) :: matrix
    logical, intent(in) :: held(:,:)
    type(linear_rows_type), intent(in) :: rows(3)
    real(wp), intent(in) :: rhs(:,:)
    real(wp), intent(in) :: enough                 !! r^T (diagonal)^-1 r that may be left [length^2]
    real(wp), intent(out) :: x(:,:)

    integer, parameter :: most_steps = 1000
    real(wp), allocatable :: p(:,:), q(:,:), r(:,:), z(:,:)
    real(wp) :: alpha, rz, rz_old
    integer :: k

    x = 0
    allocate (r, source=rhs)
    allocate (z, mold=r)
    allocate (q, mold=r)
    call precondition(matrix, rows, r, z)
    allocate (p, source=z)
    rz = sum(r*z)
    do k = 1, most_steps
      if (.not. rz > enough) exit
      call multiply(matrix, p, q)
      where (held) q = 0
      call project(rows, q)
      alpha = rz/sum(p*q)
      x = x + alpha*p
      r = r - alpha*q
      call precondition(matrix, rows, r, z)
      rz_old = rz
      rz = sum(r*z)
      p = z + rz/rz_old*p
    end do
  end subroutine solve

  subroutine precondition(matrix, rows, r, z)
    type(normal_matrix), intent(in) :: matrix
    type(linear_rows_type), intent(in) :: rows(3)
    real(wp), intent(in) :: r(:,:)
    real(wp), intent(out) :: z(:,:)

    integer :: a

    do a = 1, size(matrix%diagonal)
      z(:,a) = r(:,a)/matrix%diagonal(a)
    end do
    call project(rows, z)
  end subroutine precondition

  pure subroutine multiply(matrix, p, q)
    type(normal_matrix), intent(in) :: matrix
    real(wp), intent(in) :: p(:,:)
    real(wp), intent(out) :: q(:,:)

    real(wp) :: s(3)
    integer :: a, k

    do a = 1, size(q, 2)
      s = 0
      do k = matrix%ptr(a), matrix%ptr(a+1) - 1
        s = s + matrix%value(k)*p(:,matrix%column(k))
      end do
      q(:,a) = s
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
