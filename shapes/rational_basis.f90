module rational_basis
  !! Rational shape functions of an extraction element, for any number of functions (eqs. 22-28 of
  !! the paper):
  !!
  !!   N = C B,     W = w . N,     R_a = w_a N_a / W
  !!   R_a,i  = (w_a N_a,i - R_a W_,i) / W
  !!   R_a,ij = (w_a N_a,ij - R_a,i W_,j - R_a,j W_,i - R_a W_,ij) / W
  !!
  !! One routine per highest derivative, so that nothing is computed that its caller does not
  !! need; `shape_functions` starts from a parametric point. When W is not positive and finite the
  !! status is `bad_weight` and the results are zero.
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: wp
  use status_codes, only: ok, bad_weight
  use packed_pairs, only: pair_i, pair_j
  use bernstein, only: bernstein_basis
  implicit none (type, external)
  private
  public :: rational_basis_0, rational_basis_1, rational_basis_2, shape_functions

contains

  pure subroutine rational_basis_0(we, ce, bez, shp, status)
    real(wp), contiguous, intent(in) :: we(:)      !! control weights (nen)
    real(wp), contiguous, intent(in) :: ce(:,:)    !! extraction operator (nen,nb)
    real(wp), contiguous, intent(in) :: bez(:)     !! Bernstein values (nb)
    real(wp), contiguous, intent(out) :: shp(:)    !! R (nen)
    integer, intent(out) :: status                 !! ok or bad_weight

    real(wp) :: w(1)

    call weighted_functions(size(we), size(bez), 1, we, ce, bez, shp, w)
    status = weight_status(w(1))
    if (status == ok) then
      shp = shp / w(1)
    else
      shp = 0.0_wp
    end if
  end subroutine rational_basis_0

  pure subroutine rational_basis_1(we, ce, bez, dbez, shp, dshp, status)
    real(wp), contiguous, intent(in) :: we(:)       !! control weights (nen)
    real(wp), contiguous, intent(in) :: ce(:,:)     !! extraction operator (nen,nb)
    real(wp), contiguous, intent(in) :: bez(:)      !! Bernstein values (nb)
    real(wp), contiguous, intent(in) :: dbez(:,:)   !! Bernstein derivatives (dp,nb)
    real(wp), contiguous, intent(out) :: shp(:)     !! R (nen)
    real(wp), contiguous, intent(out) :: dshp(:,:)  !! R_,i (dp,nen)
    integer, intent(out) :: status                  !! ok or bad_weight

    real(wp) :: wn(size(we),size(dbez,1)), w(1), dw(size(dbez,1)), over_w
    integer :: a, i, dp

    dp = size(dbez, 1)
    call weighted_functions(size(we), size(bez), 1, we, ce, bez, shp, w)
    status = weight_status(w(1))
    if (status /= ok) then
      shp = 0.0_wp
      dshp = 0.0_wp
      return
    end if
    call weighted_functions(size(we), size(bez), dp, we, ce, dbez, wn, dw)

    over_w = 1.0_wp / w(1)
    shp = shp * over_w
    do a = 1, size(we)
      do i = 1, dp
        dshp(i,a) = (wn(a,i) - shp(a) * dw(i)) * over_w
      end do
    end do
  end subroutine rational_basis_1

  pure subroutine rational_basis_2(we, ce, bez, dbez, d2bez, shp, dshp, d2shp, status)
    real(wp), contiguous, intent(in) :: we(:)        !! control weights (nen)
    real(wp), contiguous, intent(in) :: ce(:,:)      !! extraction operator (nen,nb)
    real(wp), contiguous, intent(in) :: bez(:)       !! Bernstein values (nb)
    real(wp), contiguous, intent(in) :: dbez(:,:)    !! Bernstein derivatives (dp,nb)
    real(wp), contiguous, intent(in) :: d2bez(:,:)   !! second Bernstein derivatives (dp(dp+1)/2,nb)
    real(wp), contiguous, intent(out) :: shp(:)      !! R (nen)
    real(wp), contiguous, intent(out) :: dshp(:,:)   !! R_,i (dp,nen)
    real(wp), contiguous, intent(out) :: d2shp(:,:)  !! R_,ij (dp(dp+1)/2,nen)
    integer, intent(out) :: status                   !! ok or bad_weight

    real(wp) :: wn(size(we),size(dbez,1)), wn2(size(we),size(d2bez,1))
    real(wp) :: w(1), dw(size(dbez,1)), d2w(size(d2bez,1)), over_w
    integer :: a, i, j, m, dp, n2

    dp = size(dbez, 1)
    n2 = size(d2bez, 1)
    call weighted_functions(size(we), size(bez), 1, we, ce, bez, shp, w)
    status = weight_status(w(1))
    if (status /= ok) then
      shp = 0.0_wp
      dshp = 0.0_wp
      d2shp = 0.0_wp
      return
    end if
    call weighted_functions(size(we), size(bez), dp, we, ce, dbez, wn, dw)
    call weighted_functions(size(we), size(bez), n2, we, ce, d2bez, wn2, d2w)

    over_w = 1.0_wp / w(1)
    shp = shp * over_w
    do i = 1, dp
      wn(:,i) = (wn(:,i) - shp * dw(i)) * over_w
    end do
    do m = 1, n2
      i = pair_i(m,dp)
      j = pair_j(m,dp)
      wn2(:,m) = (wn2(:,m) - wn(:,i) * dw(j) - wn(:,j) * dw(i) - shp * d2w(m)) * over_w
    end do
    do a = 1, size(we)
      dshp(:,a) = wn(a,:)
      d2shp(:,a) = wn2(a,:)
    end do
  end subroutine rational_basis_2

  pure subroutine weighted_functions(nen, nb, n, we, ce, bez, wn, w)
    !! w_a N_a or derivatives of it, and their sums over a. Four columns of C are taken at a time,
    !! so that the results are loaded and stored a quarter as often.
    integer, intent(in) :: nen                !! functions of the element
    integer, intent(in) :: nb                 !! Bernstein functions
    integer, intent(in) :: n                  !! quantities: 1 for values, dp for gradients, ...
    real(wp), intent(in) :: we(nen)           !! control weights
    real(wp), intent(in) :: ce(nen,nb)        !! extraction operator
    real(wp), intent(in) :: bez(n,nb)         !! Bernstein values or derivatives
    real(wp), intent(out) :: wn(nen,n)        !! weighted functions
    real(wp), intent(out) :: w(n)             !! their sums

    integer :: a, i, k

    do i = 1, n
      wn(:,i) = 0.0_wp
      do k = 1, nb - 3, 4
        do a = 1, nen
          wn(a,i) = wn(a,i) + ce(a,k) * bez(i,k) + ce(a,k+1) * bez(i,k+1) &
            + ce(a,k+2) * bez(i,k+2) + ce(a,k+3) * bez(i,k+3)
        end do
      end do
      do k = nb - mod(nb, 4) + 1, nb
        do a = 1, nen
          wn(a,i) = wn(a,i) + ce(a,k) * bez(i,k)
        end do
      end do
      wn(:,i) = we * wn(:,i)
      w(i) = sum(wn(:,i))
    end do
  end subroutine weighted_functions

  pure function weight_status(w) result(status)
    real(wp), intent(in) :: w   !! weight function at the point
    integer :: status           !! ok or bad_weight

    status = bad_weight
    if (.not. ieee_is_finite(w)) return
    if (w > 0.0_wp) status = ok
  end function weight_status

  pure subroutine shape_functions(degree, we, ce, xi, nd, shp, dshp, d2shp, status)
    integer, intent(in) :: degree(:)                   !! orders (dp)
    real(wp), contiguous, intent(in) :: we(:)          !! control weights (nen)
    real(wp), contiguous, intent(in) :: ce(:,:)        !! extraction operator (nen,nb)
    real(wp), intent(in) :: xi(:)                      !! parametric point (dp) in [0,1]^dp
    integer, intent(in) :: nd                          !! highest derivative wanted: 0, 1 or 2
    real(wp), contiguous, intent(inout) :: shp(:)      !! R (nen)
    real(wp), contiguous, intent(inout) :: dshp(:,:)   !! R_,i (dp,nen), untouched when nd < 1
    real(wp), contiguous, intent(inout) :: d2shp(:,:)  !! R_,ij (dp(dp+1)/2,nen), untouched when
                                                       !! nd < 2
    integer, intent(out) :: status                     !! ok or bad_weight

    real(wp) :: bez(size(ce,2))
    real(wp) :: dbez(size(degree),size(ce,2)), d2bez(size(degree)*(size(degree)+1)/2,size(ce,2))

    call bernstein_basis(degree, xi, nd, bez, dbez, d2bez)
    select case (nd)
    case (0)
      call rational_basis_0(we, ce, bez, shp, status)
    case (1)
      call rational_basis_1(we, ce, bez, dbez, shp, dshp, status)
    case default
      call rational_basis_2(we, ce, bez, dbez, d2bez, shp, dshp, d2shp, status)
    end select
  end subroutine shape_functions
end module rational_basis
