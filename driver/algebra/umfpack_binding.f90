module umfpack_binding
  !! The part of UMFPACK 5 that we call: 32-bit (di) and 64-bit (dl) integers under one generic name each, and the
  !! places in its Control and Info arrays (umfpack.h; here counted from 1).
  use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_int64_t, c_double
  implicit none (type, external)
  private
  public :: umfpack_qsymbolic, umfpack_numeric, umfpack_wsolve, umfpack_get_numeric
  public :: umfpack_di_defaults, umfpack_di_free_symbolic, umfpack_dl_free_symbolic, umfpack_di_free_numeric, &
    umfpack_dl_free_numeric

  integer, parameter, public :: umfpack_control = 20, umfpack_info = 90      !! sizes of the two arrays
  integer, parameter, public :: control_prl = 1, control_strategy = 6, control_irstep = 8, control_ordering = 11
  integer, parameter, public :: strategy_symmetric = 3, ordering_given = 2
  integer, parameter, public :: info_numeric_size_estimate = 21, info_flops = 43, info_lnz = 44, info_unz = 45, &
    info_rcond = 68, info_noff_diag = 77
  integer, parameter, public :: umfpack_ok = 0, umfpack_singular = 1, umfpack_no_memory = -1
  integer, parameter, public :: system_a = 0  !! A x = b

  interface umfpack_qsymbolic
    function umfpack_di_qsymbolic(nrow, ncol, ap, ai, ax, qinit, symbolic, control, info) bind(c) result(code)
      import :: c_ptr, c_int, c_double
      integer(c_int), value :: nrow, ncol
      integer(c_int), intent(in) :: ap(*), ai(*), qinit(*)
      real(c_double), intent(in) :: ax(*), control(*)
      type(c_ptr), intent(inout) :: symbolic
      real(c_double), intent(inout) :: info(*)
      integer(c_int) :: code
    end function umfpack_di_qsymbolic

    function umfpack_dl_qsymbolic(nrow, ncol, ap, ai, ax, qinit, symbolic, control, info) bind(c) result(code)
      import :: c_ptr, c_int64_t, c_double
      integer(c_int64_t), value :: nrow, ncol
      integer(c_int64_t), intent(in) :: ap(*), ai(*), qinit(*)
      real(c_double), intent(in) :: ax(*), control(*)
      type(c_ptr), intent(inout) :: symbolic
      real(c_double), intent(inout) :: info(*)
      integer(c_int64_t) :: code
    end function umfpack_dl_qsymbolic
  end interface umfpack_qsymbolic

  interface umfpack_numeric
    function umfpack_di_numeric(ap, ai, ax, symbolic, numeric, control, info) bind(c) result(code)
      import :: c_ptr, c_int, c_double
      integer(c_int), intent(in) :: ap(*), ai(*)
      real(c_double), intent(in) :: ax(*), control(*)
      type(c_ptr), value :: symbolic
      type(c_ptr), intent(inout) :: numeric
      real(c_double), intent(inout) :: info(*)
      integer(c_int) :: code
    end function umfpack_di_numeric

    function umfpack_dl_numeric(ap, ai, ax, symbolic, numeric, control, info) bind(c) result(code)
      import :: c_ptr, c_int64_t, c_double
      integer(c_int64_t), intent(in) :: ap(*), ai(*)
      real(c_double), intent(in) :: ax(*), control(*)
      type(c_ptr), value :: symbolic
      type(c_ptr), intent(inout) :: numeric
      real(c_double), intent(inout) :: info(*)
      integer(c_int64_t) :: code
    end function umfpack_dl_numeric
  end interface umfpack_numeric

  interface umfpack_wsolve
    function umfpack_di_wsolve(sys, ap, ai, ax, x, b, numeric, control, info, wi, w) bind(c) result(code)
      import :: c_ptr, c_int, c_double
      integer(c_int), value :: sys
      type(c_ptr), value :: ap, ai, ax  !! read only for its own iterative refinement; null
      real(c_double), intent(inout) :: x(*)
      real(c_double), intent(in) :: b(*), control(*)
      type(c_ptr), value :: numeric
      real(c_double), intent(inout) :: info(*), w(*)
      integer(c_int), intent(inout) :: wi(*)
      integer(c_int) :: code
    end function umfpack_di_wsolve

    function umfpack_dl_wsolve(sys, ap, ai, ax, x, b, numeric, control, info, wi, w) bind(c) result(code)
      import :: c_ptr, c_int64_t, c_double
      integer(c_int64_t), value :: sys
      type(c_ptr), value :: ap, ai, ax
      real(c_double), intent(inout) :: x(*)
      real(c_double), intent(in) :: b(*), control(*)
      type(c_ptr), value :: numeric
      real(c_double), intent(inout) :: info(*), w(*)
      integer(c_int64_t), intent(inout) :: wi(*)
      integer(c_int64_t) :: code
    end function umfpack_dl_wsolve
  end interface umfpack_wsolve

  interface umfpack_get_numeric
    function umfpack_di_get_numeric(lp, lj, lx, up, ui, ux, p, q, dx, do_recip, rs, numeric) bind(c) result(code)
      import :: c_ptr, c_int, c_double
      type(c_ptr), value :: lp, lj, lx, up, ui, ux  !! null: the factors stay where they are
      integer(c_int), intent(inout) :: p(*), q(*), do_recip
      real(c_double), intent(inout) :: dx(*), rs(*)
      type(c_ptr), value :: numeric
      integer(c_int) :: code
    end function umfpack_di_get_numeric

    function umfpack_dl_get_numeric(lp, lj, lx, up, ui, ux, p, q, dx, do_recip, rs, numeric) bind(c) result(code)
      import :: c_ptr, c_int64_t, c_double
      type(c_ptr), value :: lp, lj, lx, up, ui, ux
      integer(c_int64_t), intent(inout) :: p(*), q(*), do_recip
      real(c_double), intent(inout) :: dx(*), rs(*)
      type(c_ptr), value :: numeric
      integer(c_int64_t) :: code
    end function umfpack_dl_get_numeric
  end interface umfpack_get_numeric

  interface
    subroutine umfpack_di_defaults(control) bind(c)
      import :: c_double
      real(c_double), intent(inout) :: control(*)
    end subroutine umfpack_di_defaults

    subroutine umfpack_di_free_symbolic(symbolic) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout) :: symbolic
    end subroutine umfpack_di_free_symbolic

    subroutine umfpack_dl_free_symbolic(symbolic) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout) :: symbolic
    end subroutine umfpack_dl_free_symbolic

    subroutine umfpack_di_free_numeric(numeric) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout) :: numeric
    end subroutine umfpack_di_free_numeric

    subroutine umfpack_dl_free_numeric(numeric) bind(c)
      import :: c_ptr
      type(c_ptr), intent(inout) :: numeric
    end subroutine umfpack_dl_free_numeric
  end interface
end module umfpack_binding
