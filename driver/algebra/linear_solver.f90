module linear_solver
  !! Direct solution of A x = b. A symmetric matrix goes to CHOLMOD; where it turns out not to be positive definite, and
  !! where the matrix is unsymmetric, UMFPACK takes it. The failed Cholesky is tried again at each factorisation: it
  !! costs a part of the LU that follows, and nothing has to be remembered across a restart. It is left out where the
  !! matrix is known to be `indefinite`.
  !!
  !! The fill-reducing order is computed on the graph of the node blocks, which is smaller than the matrix by the square
  !! of the components per node, and serves both solvers. Orders and symbolic factors are kept while the epoch of the
  !! pattern stays. Equal patterns and values give equal bits.
  use, intrinsic :: iso_fortran_env, only: int64
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: wp
  use status_codes, only: ok, not_positive_definite, not_finite
  use sparse_pattern, only: sparse_pattern_type
  use sparse_matrix, only: sparse_matrix_type, multiply
  use cholesky_factor, only: cholesky_factor_type, fill_reducing_order, order_amd, order_metis, variant_auto
  use lu_factor, only: lu_factor_type, inertia_unknown
  implicit none (type, external)
  private
  public :: linear_solver_type, solver_statistics, backend_name, ordering_name
  public :: order_amd, order_metis, inertia_unknown

  integer, parameter, public :: backend_auto = 0, backend_cholmod = 1, backend_umfpack = 2
  integer, parameter, public :: order_auto = 0
  real(wp), parameter :: worth_metis = 1.0e9_wp
    !! Operations of a factorisation with AMD from which METIS is tried too. Two-dimensional problems of 10^4 equations
    !! are below: there both orders give the same time, and METIS takes longer than the factorisation itself. Solids
    !! above gain up to a factor of three from it.

  type :: solver_statistics
    integer :: backend = backend_auto         !! that made the last factor
    integer :: ordering = order_auto          !! of the last analysis
    logical :: supernodal = .false.           !! CHOLMOD's last factor
    integer :: orderings = 0, analyses = 0, factorisations = 0, fallbacks = 0, solves = 0
    real(wp) :: nonzeros = 0                  !! entries of the factor (L, or L and U)
    real(wp) :: flops = 0                     !! of one factorisation
    real(wp) :: rcond = 0                     !! estimate of the reciprocal condition number, from the pivots
    integer :: determinant_sign = 0           !! -1, 0 (singular or no factor), 1
    integer :: negative_pivots = inertia_unknown
    real(wp) :: seconds_analyse = 0, seconds_factorise = 0, seconds_solve = 0  !! sums of wall clock
  end type solver_statistics

  type :: linear_solver_type
    integer :: backend = backend_auto         !! requested
    integer :: ordering = order_auto          !! requested
    integer :: variant = variant_auto         !! of CHOLMOD
    logical :: indefinite = .false.           !! expected not to be positive definite (multipliers): no Cholesky first
    logical :: wide_integers = .false.        !! UMFPACK with 64-bit integers from the start
    type(solver_statistics) :: statistics
    type(cholesky_factor_type), private :: cholesky
    type(lu_factor_type), private :: lu
    integer, private :: epoch = -1, n = -1, nnz = -1, ordered_by = -1
    integer, allocatable, private :: perm(:)
    integer, allocatable, private :: full_ptr(:), full_ind(:), source(:)  !! both triangles of a symmetric matrix
    real(wp), allocatable, private :: full_values(:)
  contains
    procedure :: analyse
    procedure :: factorise
    procedure :: solve_one
    procedure :: solve_many
    generic :: solve => solve_one, solve_many
    procedure :: refine
    procedure :: release
    procedure, private :: order
    procedure, private :: analyse_lu
    procedure, private :: factorise_lu
  end type linear_solver_type

contains

  subroutine analyse(self, pattern, status)
    !! Order and analyse if that has not been done for this pattern.
    class(linear_solver_type), intent(inout) :: self
    type(sparse_pattern_type), intent(in) :: pattern
    integer, intent(out) :: status                    !! ok, out_of_memory
    real(wp) :: start

    status = ok
    if (pattern%n == 0) return
    start = seconds()
    if (self%epoch /= pattern%epoch .or. self%n /= pattern%n .or. self%nnz /= pattern%nnz .or. &
      self%ordered_by /= self%ordering) then
      call self%release()
      call self%order(pattern, status)
      if (status /= ok) return
      self%epoch = pattern%epoch
      self%n = pattern%n
      self%nnz = pattern%nnz
      self%ordered_by = self%ordering
    end if
    if (uses_cholesky(self%backend, self%indefinite, pattern)) then
      if (.not. self%cholesky%analysed) then
        self%statistics%analyses = self%statistics%analyses + 1
        call self%cholesky%analyse(pattern%colptr, pattern%rowind, self%perm, self%variant, status)
      end if
    else if (.not. self%lu%analysed) then
      call self%analyse_lu(pattern, status)
    end if
    self%statistics%seconds_analyse = self%statistics%seconds_analyse + seconds() - start
  end subroutine analyse

  pure function uses_cholesky(backend, indefinite, pattern) result(yes)
    integer, intent(in) :: backend
    logical, intent(in) :: indefinite
    type(sparse_pattern_type), intent(in) :: pattern
    logical :: yes

    if (backend == backend_cholmod .and. .not. pattern%symmetric) &
      error stop 'linear_solver: CHOLMOD was requested for an unsymmetric matrix'
    yes = pattern%symmetric .and. (backend == backend_cholmod .or. backend == backend_auto .and. .not. indefinite)
  end function uses_cholesky

  subroutine order(self, pattern, status)
    !! Order the blocks, then the equations of each block one after another.
    class(linear_solver_type), intent(inout) :: self
    type(sparse_pattern_type), intent(in) :: pattern
    integer, intent(out) :: status
    integer, allocatable :: perm(:), other(:), ptr(:), ind(:)
    real(wp) :: flops, other_flops
    integer :: b, k, e

    self%statistics%orderings = self%statistics%orderings + 1
    self%statistics%ordering = merge(order_amd, self%ordering, self%ordering == order_auto)
    allocate (perm(pattern%nblocks))
    ptr = pattern%adj_ptr - 1
    ind = pattern%adj - 1
    call fill_reducing_order(ptr, ind, self%statistics%ordering, perm, flops, status)
    if (status /= ok) return
    if (self%ordering == order_auto .and. &
      flops*(real(pattern%n, wp)/max(1, pattern%nblocks))**3 > worth_metis) then
      allocate (other(pattern%nblocks))
      call fill_reducing_order(ptr, ind, order_metis, other, other_flops, status)
      if (status /= ok) return
      if (other_flops < flops) then
        call move_alloc(other, perm)
        self%statistics%ordering = order_metis
      end if
    end if
    if (allocated(self%perm)) deallocate (self%perm)
    allocate (self%perm(pattern%n))
    k = 0
    do b = 1, pattern%nblocks
      do e = pattern%first(perm(b) + 1), pattern%first(perm(b) + 2) - 1
        k = k + 1
        self%perm(k) = e - 1
      end do
    end do
  end subroutine order

  subroutine analyse_lu(self, pattern, status)
    class(linear_solver_type), intent(inout) :: self
    type(sparse_pattern_type), intent(in) :: pattern
    integer, intent(out) :: status

    self%statistics%analyses = self%statistics%analyses + 1
    if (pattern%symmetric) then
      if (.not. allocated(self%source)) call expand_lower(pattern, self%full_ptr, self%full_ind, self%source)
      call self%lu%analyse(self%full_ptr, self%full_ind, self%perm, self%wide_integers, status)
    else
      call self%lu%analyse(pattern%colptr, pattern%rowind, self%perm, self%wide_integers, status)
    end if
  end subroutine analyse_lu

  pure subroutine expand_lower(pattern, ptr, ind, source)
    !! Both triangles from the lower one, and where each entry comes from.
    type(sparse_pattern_type), intent(in) :: pattern
    integer, allocatable, intent(inout) :: ptr(:), ind(:)  !! from 0
    integer, allocatable, intent(inout) :: source(:)       !! place in the lower triangle, from 1
    integer, allocatable :: next(:)
    integer :: j, p, r, n

    n = pattern%n
    if (allocated(ptr)) deallocate (ptr)
    if (allocated(ind)) deallocate (ind)
    allocate (ptr(n + 1), next(n), ind(2*pattern%nnz - n), source(2*pattern%nnz - n))
    next = 0
    do j = 1, n
      next(j) = next(j) + pattern%colptr(j + 1) - pattern%colptr(j)
      do p = pattern%colptr(j) + 2, pattern%colptr(j + 1)
        r = pattern%rowind(p) + 1
        next(r) = next(r) + 1
      end do
    end do
    ptr(1) = 0
    do j = 1, n
      ptr(j + 1) = ptr(j) + next(j)
      next(j) = ptr(j)
    end do
    do j = 1, n  ! the entries above the diagonal of column j were placed by the columns before
      do p = pattern%colptr(j) + 1, pattern%colptr(j + 1)
        next(j) = next(j) + 1
        ind(next(j)) = pattern%rowind(p)
        source(next(j)) = p
        r = pattern%rowind(p) + 1
        if (r == j) cycle
        next(r) = next(r) + 1
        ind(next(r)) = j - 1
        source(next(r)) = p
      end do
    end do
  end subroutine expand_lower

  subroutine factorise(self, matrix, status)
    !! Factorise, after an analysis if the pattern is new.
    class(linear_solver_type), intent(inout) :: self
    type(sparse_matrix_type), intent(in) :: matrix
    integer, intent(out) :: status  !! ok, singular_matrix, not_positive_definite (CHOLMOD requested), out_of_memory,
                                    !! not_finite
    real(wp) :: start

    self%statistics%determinant_sign = 0
    self%statistics%negative_pivots = inertia_unknown
    self%statistics%rcond = 0
    status = not_finite
    if (.not. ieee_is_finite(sum(matrix%values))) return
    call self%analyse(matrix%pattern, status)
    if (status /= ok) return
    if (matrix%pattern%n == 0) then  ! everything is prescribed
      self%statistics%determinant_sign = 1
      return
    end if
    start = seconds()
    self%statistics%factorisations = self%statistics%factorisations + 1
    associate (statistics => self%statistics)
      if (uses_cholesky(self%backend, self%indefinite, matrix%pattern)) then
        statistics%backend = backend_cholmod
        call self%cholesky%factorise(matrix%pattern%colptr, matrix%pattern%rowind, matrix%values, status)
        statistics%nonzeros = self%cholesky%nonzeros
        statistics%flops = self%cholesky%flops
        statistics%supernodal = self%cholesky%supernodal
        if (status == ok) then
          statistics%rcond = self%cholesky%rcond
          statistics%determinant_sign = 1
          statistics%negative_pivots = 0
        else if (status == not_positive_definite .and. self%backend == backend_auto) then
          statistics%fallbacks = statistics%fallbacks + 1
          call self%factorise_lu(matrix, status)
        end if
      else
        call self%factorise_lu(matrix, status)
      end if
      statistics%seconds_factorise = statistics%seconds_factorise + seconds() - start
    end associate
  end subroutine factorise

  subroutine factorise_lu(self, matrix, status)
    class(linear_solver_type), intent(inout) :: self
    type(sparse_matrix_type), intent(in) :: matrix
    integer, intent(out) :: status
    integer :: k

    status = ok
    self%statistics%backend = backend_umfpack
    if (.not. self%lu%analysed) call self%analyse_lu(matrix%pattern, status)
    if (status /= ok) return
    if (matrix%pattern%symmetric) then
      if (.not. allocated(self%full_values)) allocate (self%full_values(size(self%source)))
      do k = 1, size(self%source)
        self%full_values(k) = matrix%values(self%source(k))
      end do
      call self%lu%factorise(self%full_ptr, self%full_ind, self%full_values, status)
    else
      call self%lu%factorise(matrix%pattern%colptr, matrix%pattern%rowind, matrix%values, status)
    end if
    self%statistics%nonzeros = self%lu%nonzeros
    self%statistics%flops = self%lu%flops
    self%statistics%rcond = self%lu%rcond
    self%statistics%determinant_sign = self%lu%determinant_sign
    if (matrix%pattern%symmetric) self%statistics%negative_pivots = self%lu%negative_pivots
  end subroutine factorise_lu

  subroutine solve_one(self, rhs, x, status)
    !! x = A^-1 rhs with the last factor.
    class(linear_solver_type), intent(inout) :: self
    real(wp), contiguous, target, intent(in) :: rhs(:)   !! (n)
    real(wp), contiguous, target, intent(inout) :: x(:)  !! (n)
    integer, intent(out) :: status                       !! ok, singular_matrix, out_of_memory
    real(wp), pointer, contiguous :: rhs_columns(:, :), x_columns(:, :)

    rhs_columns(1:size(rhs), 1:1) => rhs
    x_columns(1:size(x), 1:1) => x
    call self%solve_many(rhs_columns, x_columns, status)
  end subroutine solve_one

  subroutine solve_many(self, rhs, x, status)
    !! The same for several right-hand sides at once.
    class(linear_solver_type), intent(inout) :: self
    real(wp), contiguous, intent(in) :: rhs(:, :)    !! (n,nrhs)
    real(wp), contiguous, intent(inout) :: x(:, :)   !! (n,nrhs)
    integer, intent(out) :: status                   !! ok, singular_matrix, out_of_memory
    real(wp) :: start

    if (self%statistics%determinant_sign == 0) error stop 'linear_solver: solve without a valid factor'
    status = ok
    if (size(rhs) == 0) return
    start = seconds()
    if (self%statistics%backend == backend_cholmod) then
      call self%cholesky%solve(rhs, x, status)
    else
      call self%lu%solve(rhs, x, status)
    end if
    self%statistics%solves = self%statistics%solves + size(rhs, 2)
    self%statistics%seconds_solve = self%statistics%seconds_solve + seconds() - start
  end subroutine solve_many

  subroutine refine(self, matrix, rhs, x, status)
    !! One step of iterative refinement, x := x + A^-1 (rhs - A x).
    class(linear_solver_type), intent(inout) :: self
    type(sparse_matrix_type), intent(in) :: matrix
    real(wp), intent(in) :: rhs(:)                   !! (n)
    real(wp), intent(inout) :: x(:)                  !! (n)
    integer, intent(out) :: status
    real(wp), allocatable :: residual(:), correction(:)

    allocate (residual(size(x)), correction(size(x)))
    call multiply(matrix, x, residual)
    residual = rhs - residual
    call self%solve_one(residual, correction, status)
    if (status == ok) x = x + correction
  end subroutine refine

  subroutine release(self)
    !! Forget factors and orders, keep the statistics: the next factorisation starts anew, as after a restart.
    class(linear_solver_type), intent(inout) :: self

    call self%cholesky%release()
    call self%lu%release()
    if (allocated(self%perm)) deallocate (self%perm)
    if (allocated(self%source)) deallocate (self%full_ptr, self%full_ind, self%source)
    if (allocated(self%full_values)) deallocate (self%full_values)
    self%epoch = -1
    self%statistics%determinant_sign = 0
  end subroutine release

  pure function backend_name(backend) result(name)
    integer, intent(in) :: backend
    character(:), allocatable :: name

    select case (backend)
    case (backend_cholmod); name = 'CHOLMOD'
    case (backend_umfpack); name = 'UMFPACK'
    case default;           name = 'auto'
    end select
  end function backend_name

  pure function ordering_name(ordering) result(name)
    integer, intent(in) :: ordering
    character(:), allocatable :: name

    select case (ordering)
    case (order_amd);   name = 'AMD'
    case (order_metis); name = 'METIS'
    case default;       name = 'auto'
    end select
  end function ordering_name

  function seconds() result(time)
    real(wp) :: time
    integer(int64) :: ticks, rate

    call system_clock(ticks, rate)
    time = real(ticks, wp)/real(rate, wp)
  end function seconds
end module linear_solver
