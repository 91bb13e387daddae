module geometry_map
  !! Map from the parent element to space and derivatives in space, for elements that fill it (dp
  !! = ndm = 1, 2, 3):
  !!
  !!   J_iK = x_i,K = sum_a x_a,i R_a,K
  !!   R_,i  = R_,K xi_K,i
  !!   R_,ij = (R_,KL - R_,k x_k,KL) xi_K,i xi_L,j
  !!
  !! Second derivatives are packed as 11 | 11,22,12 | 11,22,33,12,23,13.
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use kinds, only: wp
  use status_codes, only: ok, inverted_element
  use packed_pairs, only: pair_i, pair_j, packed
  implicit none (type, external)
  private
  public :: physical_gradient, physical_hessian

contains

  pure subroutine physical_gradient(xe, dshp, dshpx, detj, status)
    real(wp), contiguous, intent(in) :: xe(:,:)       !! control points (ndm,nen) [length]
    real(wp), contiguous, intent(in) :: dshp(:,:)     !! parametric derivatives (ndm,nen)
    real(wp), contiguous, intent(out) :: dshpx(:,:)   !! R_,i (ndm,nen) [1/length], zero if inverted
    real(wp), intent(out) :: detj                     !! Jacobian determinant [length^ndm]
    integer, intent(out) :: status                    !! ok or inverted_element

    real(wp) :: inv(size(xe,1),size(xe,1))

    call inverse_jacobian(xe, dshp, inv, detj, status)
    if (status == ok) then
      call chain_rule(inv, dshp, dshpx)
    else
      dshpx = 0.0_wp
    end if
  end subroutine physical_gradient

  pure subroutine physical_hessian(xe, dshp, d2shp, dshpx, d2shpx, status)
    real(wp), contiguous, intent(in) :: xe(:,:)        !! control points (ndm,nen) [length]
    real(wp), contiguous, intent(in) :: dshp(:,:)      !! parametric derivatives (ndm,nen)
    real(wp), contiguous, intent(in) :: d2shp(:,:)     !! second ones (ndm(ndm+1)/2,nen)
    real(wp), contiguous, intent(out) :: dshpx(:,:)    !! R_,i (ndm,nen) [1/length]
    real(wp), contiguous, intent(out) :: d2shpx(:,:)   !! R_,ij (ndm(ndm+1)/2,nen) [1/length^2]
    integer, intent(out) :: status                     !! ok or inverted_element

    real(wp) :: inv(size(xe,1),size(xe,1)), detj
    real(wp) :: x2(size(xe,1),size(d2shp,1))    ! x_k,KL
    real(wp) :: turn(size(d2shp,1),size(d2shp,1))   ! xi_K,i xi_L,j in packed form
    real(wp) :: h(size(d2shp,1))
    integer :: a, i, j, k, l, m, n, ndm

    ndm = size(xe, 1)
    call inverse_jacobian(xe, dshp, inv, detj, status)
    if (status /= ok) then
      dshpx = 0.0_wp
      d2shpx = 0.0_wp
      return
    end if
    call chain_rule(inv, dshp, dshpx)

    x2 = 0.0_wp
    do a = 1, size(xe, 2)
      do m = 1, size(d2shp, 1)
        x2(:,m) = x2(:,m) + xe(:,a) * d2shp(m,a)
      end do
    end do

    turn = 0.0_wp
    do m = 1, size(d2shp, 1)
      i = pair_i(m,ndm)
      j = pair_j(m,ndm)
      do l = 1, ndm
        do k = 1, ndm
          n = packed(k,l,ndm)
          turn(n,m) = turn(n,m) + inv(k,i) * inv(l,j)
        end do
      end do
    end do

    do a = 1, size(xe, 2)
      do n = 1, size(d2shp, 1)
        h(n) = d2shp(n,a) - dot_product(dshpx(:,a), x2(:,n))
      end do
      do m = 1, size(d2shp, 1)
        d2shpx(m,a) = dot_product(h, turn(:,m))
      end do
    end do
  end subroutine physical_hessian

  pure subroutine chain_rule(inv, dshp, dshpx)
    !! R_,i = R_,K xi_K,i
    real(wp), intent(in) :: inv(:,:)      !! xi_K,i
    real(wp), contiguous, intent(in) :: dshp(:,:)     !! parametric derivatives (ndm,nen)
    real(wp), contiguous, intent(out) :: dshpx(:,:)   !! derivatives in space (ndm,nen)

    integer :: a

    select case (size(inv, 1))
    case (1)
      do a = 1, size(dshp, 2)
        dshpx(1,a) = dshp(1,a) * inv(1,1)
      end do
    case (2)
      do a = 1, size(dshp, 2)
        dshpx(1,a) = dshp(1,a) * inv(1,1) + dshp(2,a) * inv(2,1)
        dshpx(2,a) = dshp(1,a) * inv(1,2) + dshp(2,a) * inv(2,2)
      end do
    case (3)
      do a = 1, size(dshp, 2)
        dshpx(1,a) = dshp(1,a) * inv(1,1) + dshp(2,a) * inv(2,1) + dshp(3,a) * inv(3,1)
        dshpx(2,a) = dshp(1,a) * inv(1,2) + dshp(2,a) * inv(2,2) + dshp(3,a) * inv(3,2)
        dshpx(3,a) = dshp(1,a) * inv(1,3) + dshp(2,a) * inv(2,3) + dshp(3,a) * inv(3,3)
      end do
    end select
  end subroutine chain_rule

  pure subroutine inverse_jacobian(xe, dshp, inv, detj, status)
    real(wp), contiguous, intent(in) :: xe(:,:)           !! control points (ndm,nen)
    real(wp), contiguous, intent(in) :: dshp(:,:)         !! parametric derivatives (ndm,nen)
    real(wp), intent(out) :: inv(size(xe,1),size(xe,1))   !! xi_K,i
    real(wp), intent(out) :: detj                         !! determinant of x_i,K
    integer, intent(out) :: status                        !! ok or inverted_element

    real(wp) :: jac(size(xe,1),size(xe,1))
    integer :: a

    jac = 0.0_wp
    select case (size(xe, 1))
    case (1)
      do a = 1, size(xe, 2)
        jac(1,1) = jac(1,1) + xe(1,a) * dshp(1,a)
      end do
      inv(1,1) = 1.0_wp
      detj = jac(1,1)
    case (2)
      do a = 1, size(xe, 2)
        jac(1,1) = jac(1,1) + xe(1,a) * dshp(1,a)
        jac(2,1) = jac(2,1) + xe(2,a) * dshp(1,a)
        jac(1,2) = jac(1,2) + xe(1,a) * dshp(2,a)
        jac(2,2) = jac(2,2) + xe(2,a) * dshp(2,a)
      end do
      inv(1,1) =  jac(2,2)
      inv(1,2) = -jac(1,2)
      inv(2,1) = -jac(2,1)
      inv(2,2) =  jac(1,1)
      detj = jac(1,1) * jac(2,2) - jac(1,2) * jac(2,1)
    case (3)
      do a = 1, size(xe, 2)
        jac(1:3,1) = jac(1:3,1) + xe(1:3,a) * dshp(1,a)
        jac(1:3,2) = jac(1:3,2) + xe(1:3,a) * dshp(2,a)
        jac(1:3,3) = jac(1:3,3) + xe(1:3,a) * dshp(3,a)
      end do
      inv(1,1) = jac(2,2) * jac(3,3) - jac(2,3) * jac(3,2)
      inv(1,2) = jac(1,3) * jac(3,2) - jac(1,2) * jac(3,3)
      inv(1,3) = jac(1,2) * jac(2,3) - jac(1,3) * jac(2,2)
      inv(2,1) = jac(2,3) * jac(3,1) - jac(2,1) * jac(3,3)
      inv(2,2) = jac(1,1) * jac(3,3) - jac(1,3) * jac(3,1)
      inv(2,3) = jac(1,3) * jac(2,1) - jac(1,1) * jac(2,3)
      inv(3,1) = jac(2,1) * jac(3,2) - jac(2,2) * jac(3,1)
      inv(3,2) = jac(1,2) * jac(3,1) - jac(1,1) * jac(3,2)
      inv(3,3) = jac(1,1) * jac(2,2) - jac(1,2) * jac(2,1)
      detj = jac(1,1) * inv(1,1) + jac(1,2) * inv(2,1) + jac(1,3) * inv(3,1)
    case default
      error stop 'geometry_map: the space dimension is 1, 2 or 3'
    end select

    status = inverted_element
    if (.not. ieee_is_finite(detj)) return
    if (detj <= 0.0_wp) return
    status = ok
    inv = inv / detj
  end subroutine inverse_jacobian
end module geometry_map
