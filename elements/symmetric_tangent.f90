module symmetric_tangent
  !! Tangents of which one triangle is filled.
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: mirror

contains

  pure subroutine mirror(ke)
    !! Complete a symmetric tangent of which the blocks a >= b are filled.
    real(wp), contiguous, intent(inout) :: ke(:, :, :, :)  !! (ndf,nen,ndf,nen)

    call mirror_square(size(ke, 1)*size(ke, 2), ke)
  end subroutine mirror

  pure subroutine mirror_square(n, k)
    !! The lower triangle into the upper one by squares of 4 x 4: row by row it would cost a sixth of a kernel.
    integer, intent(in) :: n
    real(wp), intent(inout) :: k(n, n)
    real(wp) :: square(4, 4)
    integer :: c, j, m, r

    m = n - mod(n, 4)
    do c = 1, m, 4
      do r = 1, c - 4, 4
        do j = 1, 4
          square(:, j) = k(c:c + 3, r + j - 1)
        end do
        do j = 1, 4
          k(r:r + 3, c + j - 1) = square(j, :)
        end do
      end do
      do j = c + 1, c + 3
        k(c:j - 1, j) = k(j, c:j - 1)
      end do
    end do
    do c = m + 1, n
      k(1:c - 1, c) = k(c, 1:c - 1)
    end do
  end subroutine mirror_square
end module symmetric_tangent
