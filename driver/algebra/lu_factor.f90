module lu_factor
  !! LU factorisation with pivoting by UMFPACK, L U = P R A Q (R: its row scaling), for matrices that are unsymmetric
  !! or not positive definite. 32-bit integers are used until the factor needs the 64-bit ones.
  use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_int64_t, c_double, c_null_ptr, c_associated
  use kinds, only: wp
  use status_codes, only: ok, singular_matrix, out_of_memory
  use umfpack_binding, only: umfpack_qsymbolic, umfpack_numeric, umfpack_wsolve, umfpack_get_numeric, &
    umfpack_di_defaults, umfpack_di_free_symbolic, umfpack_dl_free_symbolic, umfpack_di_free_numeric, &
    umfpack_dl_free_numeric, umfpack_control, umfpack_info, control_prl, control_strategy, control_irstep, &
    control_ordering, strategy_symmetric, ordering_given, info_numeric_size_estimate, info_flops, info_lnz, info_unz, &
    info_rcond, info_noff_diag, umfpack_ok, umfpack_singular, umfpack_no_memory, system_a
  implicit none (type, external)
  private
  public :: lu_factor_type

  real(wp), parameter :: lost_pivot = 50*epsilon(1.0_wp)
    !! A pivot that is this part of the largest entry of its column is round-off (see cholesky_factor).
  integer, parameter, public :: inertia_unknown = -1

  type :: lu_factor_type
    private
    type(c_ptr) :: symbolic = c_null_ptr, numeric = c_null_ptr
    logical :: wide = .false.                            !! 64-bit integers
    integer :: n = 0
    integer(c_int64_t), allocatable :: ptr(:), ind(:)    !! 64-bit copy of the pattern
    integer(c_int64_t), allocatable :: qinit(:)
    logical, public :: analysed = .false.
    real(wp), public :: nonzeros = 0                     !! entries of L and U
    real(wp), public :: flops = 0
    real(wp), public :: rcond = 0                        !! estimate of the reciprocal condition number
    integer, public :: determinant_sign = 0
    integer, public :: negative_pivots = inertia_unknown !! known where all pivots lie on the diagonal
  contains
    procedure :: analyse
    procedure :: factorise
    procedure :: solve
    procedure :: release
    procedure, private :: factorise_once
    procedure, private :: inspect
    procedure, private :: widen
    procedure, private :: refuse_copy
    generic :: assignment(=) => refuse_copy
    final :: finalise
  end type lu_factor_type

contains

  subroutine control_values(control)
    real(c_double), intent(out) :: control(umfpack_control)

    control = 0
    call umfpack_di_defaults(control)
    control(control_prl) = 0
    control(control_irstep) = 0
    control(control_strategy) = strategy_symmetric  ! the pattern always is, even if the values are not
    control(control_ordering) = ordering_given
  end subroutine control_values

  subroutine analyse(self, ptr, ind, perm, wide, status)
    !! Symbolic factorisation; serves all matrices of this pattern.
    class(lu_factor_type), intent(inout) :: self
    integer, intent(in) :: ptr(:)     !! (n+1) columns of both triangles, from 0
    integer, intent(in) :: ind(:)     !! rows, from 0
    integer, intent(in) :: perm(:)    !! elimination order, from 0
    logical, intent(in) :: wide       !! 64-bit integers from the start
    integer, intent(out) :: status    !! ok, out_of_memory
    real(c_double) :: control(umfpack_control), info(umfpack_info)
    real(wp), allocatable :: pattern_only(:)
    integer :: code

    call self%release()
    self%n = size(ptr) - 1
    self%qinit = perm
    if (wide) then
      call self%widen(ptr, ind, code)
    else
      call control_values(control)
      info = 0
      allocate (pattern_only(size(ind)), source=1.0_wp)
      code = umfpack_qsymbolic(self%n, self%n, ptr, ind, pattern_only, perm, self%symbolic, control, info)
      if (code == umfpack_ok .and. info(info_numeric_size_estimate) > huge(ptr)) call self%widen(ptr, ind, code)
    end if
    status = merge(ok, out_of_memory, code == umfpack_ok)
    self%analysed = status == ok
  end subroutine analyse

  subroutine widen(self, ptr, ind, code)
    !! Analyse anew with 64-bit integers.
    class(lu_factor_type), intent(inout) :: self
    integer, intent(in) :: ptr(:), ind(:)
    integer, intent(out) :: code
    real(c_double) :: control(umfpack_control), info(umfpack_info)
    real(wp), allocatable :: pattern_only(:)

    if (c_associated(self%symbolic)) call umfpack_di_free_symbolic(self%symbolic)
    self%wide = .true.
    self%ptr = ptr
    self%ind = ind
    call control_values(control)
    info = 0
    allocate (pattern_only(size(ind)), source=1.0_wp)
    code = int(umfpack_qsymbolic(int(self%n, c_int64_t), int(self%n, c_int64_t), self%ptr, self%ind, pattern_only, &
      self%qinit, self%symbolic, control, info))
  end subroutine widen

  subroutine factorise(self, ptr, ind, values, status)
    class(lu_factor_type), intent(inout) :: self
    integer, intent(in) :: ptr(:), ind(:)  !! the pattern that was analysed
    real(wp), intent(in) :: values(:)      !! both triangles
    integer, intent(out) :: status         !! ok, singular_matrix, out_of_memory
    integer :: code

    call self%factorise_once(ptr, ind, values, code)
    if (code == umfpack_no_memory .and. .not. self%wide) then
      call self%widen(ptr, ind, code)
      if (code == umfpack_ok) call self%factorise_once(ptr, ind, values, code)
    end if
    select case (code)
    case (umfpack_ok);        status = ok
    case (umfpack_singular);  status = singular_matrix
    case (umfpack_no_memory); status = out_of_memory
    case default;             error stop 'lu_factor: UMFPACK refused its arguments'
    end select
    if (status == ok) call self%inspect(ptr, ind, values, status)
  end subroutine factorise

  subroutine factorise_once(self, ptr, ind, values, code)
    class(lu_factor_type), intent(inout) :: self
    integer, intent(in) :: ptr(:), ind(:)
    real(wp), intent(in) :: values(:)
    integer, intent(out) :: code
    real(c_double) :: control(umfpack_control), info(umfpack_info)

    call control_values(control)
    info = 0
    if (self%wide) then
      if (c_associated(self%numeric)) call umfpack_dl_free_numeric(self%numeric)
      code = int(umfpack_numeric(self%ptr, self%ind, values, self%symbolic, self%numeric, control, info))
    else
      if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
      code = umfpack_numeric(ptr, ind, values, self%symbolic, self%numeric, control, info)
    end if
    self%nonzeros = info(info_lnz) + info(info_unz)
    self%flops = info(info_flops)
    self%rcond = info(info_rcond)
    self%determinant_sign = 0
    self%negative_pivots = inertia_unknown
    if (info(info_noff_diag) <= 0) self%negative_pivots = 0
  end subroutine factorise_once

  subroutine inspect(self, ptr, ind, values, status)
    !! From the pivots: the sign of the determinant, the number of negative ones, whether one was lost to round-off.
    class(lu_factor_type), intent(inout) :: self
    integer, intent(in) :: ptr(:), ind(:)
    real(wp), intent(in) :: values(:)
    integer, intent(out) :: status           !! ok, singular_matrix
    integer(c_int), allocatable :: p(:), q(:)
    integer(c_int64_t), allocatable :: p8(:), q8(:)
    real(wp), allocatable :: pivot(:), scale(:)
    real(wp) :: largest
    integer(c_int64_t) :: reciprocal8
    integer(c_int) :: reciprocal
    integer :: code, k, j, i

    allocate (p(self%n), q(self%n), pivot(self%n), scale(self%n))
    if (self%wide) then
      allocate (p8(self%n), q8(self%n))
      code = int(umfpack_get_numeric(c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, p8, q8, &
        pivot, reciprocal8, scale, self%numeric))
      p = int(p8)
      q = int(q8)
      reciprocal = int(reciprocal8)
    else
      code = umfpack_get_numeric(c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, p, q, pivot, &
        reciprocal, scale, self%numeric)
    end if
    status = out_of_memory
    if (code /= umfpack_ok) return
    status = ok
    if (reciprocal == 0) scale = 1/scale
    do k = 1, self%n
      j = q(k) + 1
      largest = 0
      do i = ptr(j) + 1, ptr(j + 1)
        largest = max(largest, abs(values(i))*scale(ind(i) + 1))
      end do
      if (.not. abs(pivot(k)) > lost_pivot*largest) status = singular_matrix
    end do
    self%determinant_sign = permutation_sign(p)*permutation_sign(q)*merge(-1, 1, mod(count(pivot < 0), 2) == 1)
    if (status /= ok) self%determinant_sign = 0
    if (any(p /= q)) self%negative_pivots = inertia_unknown
    if (self%negative_pivots /= inertia_unknown) self%negative_pivots = count(pivot < 0)
  end subroutine inspect

  pure function permutation_sign(perm) result(sign)
    integer, intent(in) :: perm(:)  !! from 0
    integer :: sign
    logical :: seen(size(perm))
    integer :: k, j

    sign = 1
    seen = .false.
    do k = 1, size(perm)
      j = k
      do while (.not. seen(j))  ! a cycle of even length changes the sign
        seen(j) = .true.
        j = perm(j) + 1
        if (j /= k) sign = -sign
      end do
    end do
  end function permutation_sign

  subroutine solve(self, rhs, x, status)
    class(lu_factor_type), intent(inout) :: self
    real(wp), contiguous, intent(in) :: rhs(:, :)    !! (n,nrhs)
    real(wp), contiguous, intent(inout) :: x(:, :)   !! (n,nrhs)
    integer, intent(out) :: status                   !! ok, singular_matrix
    real(c_double) :: control(umfpack_control), info(umfpack_info)
    real(wp), allocatable :: w(:)
    integer(c_int64_t), allocatable :: wi8(:)
    integer(c_int), allocatable :: wi(:)
    integer :: r, code

    call control_values(control)
    info = 0
    status = ok
    allocate (w(5*self%n))
    if (self%wide) then
      allocate (wi8(self%n))
    else
      allocate (wi(self%n))
    end if
    do r = 1, size(rhs, 2)
      if (self%wide) then
        code = int(umfpack_wsolve(int(system_a, c_int64_t), c_null_ptr, c_null_ptr, c_null_ptr, x(:, r), rhs(:, r), &
          self%numeric, control, info, wi8, w))
      else
        code = umfpack_wsolve(system_a, c_null_ptr, c_null_ptr, c_null_ptr, x(:, r), rhs(:, r), self%numeric, control, &
          info, wi, w)
      end if
      if (code == umfpack_singular) status = singular_matrix
      if (code < 0) error stop 'lu_factor: UMFPACK refused its arguments'
    end do
  end subroutine solve

  subroutine release(self)
    !! Give the memory back; the next use starts with an analysis.
    class(lu_factor_type), intent(inout) :: self

    if (self%wide) then
      if (c_associated(self%numeric)) call umfpack_dl_free_numeric(self%numeric)
      if (c_associated(self%symbolic)) call umfpack_dl_free_symbolic(self%symbolic)
    else
      if (c_associated(self%numeric)) call umfpack_di_free_numeric(self%numeric)
      if (c_associated(self%symbolic)) call umfpack_di_free_symbolic(self%symbolic)
    end if
    self%numeric = c_null_ptr
    self%symbolic = c_null_ptr
    self%wide = .false.
    self%analysed = .false.
    if (allocated(self%ptr)) deallocate (self%ptr, self%ind)
  end subroutine release

  impure elemental subroutine finalise(self)
    type(lu_factor_type), intent(inout) :: self
    call self%release()
  end subroutine finalise

  subroutine refuse_copy(self, other)
    class(lu_factor_type), intent(inout) :: self
    class(lu_factor_type), intent(in) :: other
    if (c_associated(self%symbolic) .or. c_associated(other%symbolic)) error stop 'lu_factor: a factor is not copied'
  end subroutine refuse_copy
end module lu_factor
