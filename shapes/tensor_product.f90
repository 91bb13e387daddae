module tensor_product
  !! Extraction operators of tensor-product elements: ce = c2 x c1 or c3 x c2 x c1 (Kronecker
  !! products), rows and columns with the first direction fastest.
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: tensor_operator

  interface tensor_operator
    procedure :: tensor_operator_2, tensor_operator_3
  end interface tensor_operator

contains

  pure subroutine tensor_operator_2(c1, c2, ce)
    real(wp), intent(in) :: c1(:,:), c2(:,:)   !! operators of the directions (n_d,m_d)
    real(wp), intent(out) :: ce(:,:)           !! their product (n1 n2, m1 m2)

    integer :: i, j, m, n

    n = size(c1, 1)
    m = size(c1, 2)
    do j = 1, size(c2, 2)
      do i = 1, size(c2, 1)
        ce(1+(i-1)*n:i*n,1+(j-1)*m:j*m) = c2(i,j) * c1
      end do
    end do
  end subroutine tensor_operator_2

  pure subroutine tensor_operator_3(c1, c2, c3, ce)
    real(wp), intent(in) :: c1(:,:), c2(:,:), c3(:,:)   !! operators of the directions (n_d,m_d)
    real(wp), intent(out) :: ce(:,:)                    !! their product (n1 n2 n3, m1 m2 m3)

    real(wp) :: c21(size(c1,1)*size(c2,1),size(c1,2)*size(c2,2))

    call tensor_operator_2(c1, c2, c21)
    call tensor_operator_2(c21, c3, ce)
  end subroutine tensor_operator_3
end module tensor_product
