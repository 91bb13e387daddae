module cholesky_factor
  !! Cholesky factorisation of a symmetric positive definite matrix by CHOLMOD, through our C shim.
  use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_double, c_null_ptr, c_associated
  use kinds, only: wp
  use status_codes, only: ok, not_positive_definite, singular_matrix, out_of_memory
  implicit none (type, external)
  private
  public :: cholesky_factor_type, fill_reducing_order

  integer, parameter, public :: order_amd = 1, order_metis = 2                     !! as in the shim
  integer, parameter, public :: variant_auto = 0, variant_simplicial = 1, variant_supernodal = 2

  real(wp), parameter :: lost_pivot = 50*epsilon(1.0_wp)
    !! A pivot that is this part of its diagonal entry is round-off: each of the updates subtracted from the entry is
    !! wrong by epsilon/2 of it at most, and some tens of them are comparable to it.

  type :: cholesky_factor_type
    private
    type(c_ptr) :: handle = c_null_ptr
    integer :: n = 0
    logical, public :: analysed = .false.
    logical, public :: supernodal = .false.
    real(wp), public :: nonzeros = 0     !! entries of L
    real(wp), public :: flops = 0        !! of one factorisation
    real(wp), public :: rcond = 0        !! estimate of the reciprocal condition number, from the pivots
  contains
    procedure :: analyse
    procedure :: factorise
    procedure :: solve
    procedure :: release
    procedure, private :: refuse_copy
    generic :: assignment(=) => refuse_copy
    final :: finalise
  end type cholesky_factor_type

  interface
    function bezel_cholmod_open() bind(c) result(handle)
      import :: c_ptr
      type(c_ptr) :: handle
    end function bezel_cholmod_open

    subroutine bezel_cholmod_close(handle) bind(c)
      import :: c_ptr
      type(c_ptr), value :: handle
    end subroutine bezel_cholmod_close

    function bezel_cholmod_order(handle, n, ptr, ind, method, perm, flops) bind(c) result(code)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: n, method
      integer(c_int), intent(in) :: ptr(*), ind(*)
      integer(c_int), intent(out) :: perm(*)
      real(c_double), intent(out) :: flops
      integer(c_int) :: code
    end function bezel_cholmod_order

    function bezel_cholmod_analyse(handle, n, ptr, ind, perm, variant, info) bind(c) result(code)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: n, variant
      integer(c_int), intent(in) :: ptr(*), ind(*), perm(*)
      real(c_double), intent(out) :: info(3)
      integer(c_int) :: code
    end function bezel_cholmod_analyse

    function bezel_cholmod_factorise(handle, n, ptr, ind, val, info) bind(c) result(code)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: n
      integer(c_int), intent(in) :: ptr(*), ind(*)
      real(c_double), intent(in) :: val(*)
      real(c_double), intent(out) :: info(2)
      integer(c_int) :: code
    end function bezel_cholmod_factorise

    function bezel_cholmod_solve(handle, n, nrhs, rhs, x) bind(c) result(code)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: handle
      integer(c_int), value :: n, nrhs
      real(c_double), intent(in) :: rhs(*)
      real(c_double), intent(out) :: x(*)
      integer(c_int) :: code
    end function bezel_cholmod_solve
  end interface

contains

  subroutine fill_reducing_order(ptr, ind, method, perm, flops, status)
    !! Elimination order of a graph that keeps the factor sparse. The same graph gives the same order: METIS seeds its
    !! own generator at each call.
    integer, intent(in) :: ptr(:)     !! (n+1) columns of the lower triangle, from 0
    integer, intent(in) :: ind(:)     !! rows, from 0
    integer, intent(in) :: method     !! order_amd, order_metis
    integer, intent(out) :: perm(:)   !! (n) perm(k) is eliminated k-th, from 0
    real(wp), intent(out) :: flops    !! of a Cholesky factorisation with one equation per vertex
    integer, intent(out) :: status    !! ok, out_of_memory
    type(c_ptr) :: handle

    handle = bezel_cholmod_open()
    status = out_of_memory
    flops = 0
    if (.not. c_associated(handle)) return
    status = status_of(bezel_cholmod_order(handle, size(ptr) - 1, ptr, ind, method, perm, flops))
    call bezel_cholmod_close(handle)
  end subroutine fill_reducing_order

  subroutine analyse(self, ptr, ind, perm, variant, status)
    !! Symbolic factorisation; serves all matrices of this pattern.
    class(cholesky_factor_type), intent(inout) :: self
    integer, intent(in) :: ptr(:)    !! (n+1) columns of the lower triangle, from 0
    integer, intent(in) :: ind(:)    !! rows, from 0
    integer, intent(in) :: perm(:)   !! elimination order, from 0; refined by a postorder of the elimination tree
    integer, intent(in) :: variant   !! variant_auto, variant_simplicial, variant_supernodal
    integer, intent(out) :: status   !! ok, out_of_memory
    real(c_double) :: info(3)

    self%analysed = .false.
    status = out_of_memory
    if (.not. c_associated(self%handle)) self%handle = bezel_cholmod_open()
    if (.not. c_associated(self%handle)) return
    self%n = size(ptr) - 1
    status = status_of(bezel_cholmod_analyse(self%handle, self%n, ptr, ind, perm, variant, info))
    if (status /= ok) return
    self%nonzeros = info(1)
    self%flops = info(2)
    self%supernodal = info(3) > 0.5_wp
    self%analysed = .true.
  end subroutine analyse

  subroutine factorise(self, ptr, ind, values, status)
    !! L L^T = P A P^T
    class(cholesky_factor_type), intent(inout) :: self
    integer, intent(in) :: ptr(:), ind(:)  !! the pattern that was analysed
    real(wp), intent(in) :: values(:)      !! lower triangle
    integer, intent(out) :: status         !! ok, not_positive_definite, singular_matrix, out_of_memory
    real(c_double) :: info(2)

    status = status_of(bezel_cholmod_factorise(self%handle, self%n, ptr, ind, values, info))
    if (status /= ok) return
    self%rcond = info(1)
    if (.not. info(2) > lost_pivot) status = singular_matrix
  end subroutine factorise

  subroutine solve(self, rhs, x, status)
    class(cholesky_factor_type), intent(inout) :: self
    real(wp), contiguous, intent(in) :: rhs(:, :)  !! (n,nrhs)
    real(wp), contiguous, intent(out) :: x(:, :)   !! (n,nrhs)
    integer, intent(out) :: status                 !! ok, out_of_memory

    status = status_of(bezel_cholmod_solve(self%handle, self%n, size(rhs, 2), rhs, x))
  end subroutine solve

  pure function status_of(code) result(status)
    integer(c_int), intent(in) :: code
    integer :: status

    select case (code)
    case (0);     status = ok
    case (1);     status = not_positive_definite
    case (2);     status = out_of_memory
    case default; error stop 'cholesky_factor: CHOLMOD refused its arguments'
    end select
  end function status_of

  subroutine release(self)
    !! Give the memory back; the next use starts with an analysis.
    class(cholesky_factor_type), intent(inout) :: self

    if (c_associated(self%handle)) call bezel_cholmod_close(self%handle)
    self%handle = c_null_ptr
    self%analysed = .false.
  end subroutine release

  impure elemental subroutine finalise(self)
    type(cholesky_factor_type), intent(inout) :: self
    call self%release()
  end subroutine finalise

  subroutine refuse_copy(self, other)
    class(cholesky_factor_type), intent(inout) :: self
    class(cholesky_factor_type), intent(in) :: other
    if (c_associated(self%handle) .or. c_associated(other%handle)) error stop 'cholesky_factor: a factor is not copied'
  end subroutine refuse_copy
end module cholesky_factor
