module lagrange
  !! Lagrange polynomials as an extraction: rows of the operator are the Bernstein coefficients of
  !! the nodal basis L_a = prod_(b /= a) (x - x_b) / (x_a - x_b) on [0,1]. The product is formed
  !! factor by factor: multiplying a polynomial of order k with coefficients c by the linear one
  !! with end values l_0, l_1 gives ((k+1-i) l_0 c_i + i l_1 c_(i-1)) / (k+1), i = 0..k+1.
  use kinds, only: wp
  use gauss_rules, only: gauss_lobatto
  implicit none (type, external)
  private
  public :: lagrange_operator, lagrange_nodes, equispaced, lobatto

  ! kinds of nodes
  integer, parameter :: equispaced = 1   !! i/p
  integer, parameter :: lobatto = 2      !! Gauss-Lobatto points

contains

  pure subroutine lagrange_operator(p, nodes01, c)
    integer, intent(in) :: p                  !! order, >= 0
    real(wp), intent(in) :: nodes01(p+1)      !! nodes in [0,1], all different
    real(wp), intent(out) :: c(p+1,p+1)       !! row a: Bernstein coefficients of L_a

    real(wp) :: at_0, at_1, row(0:p)
    integer :: a, b, i, k

    do a = 1, p + 1
      row(0) = 1.0_wp
      k = 0
      do b = 1, p + 1
        if (b == a) cycle
        at_0 = -nodes01(b) / (nodes01(a) - nodes01(b))
        at_1 = (1.0_wp - nodes01(b)) / (nodes01(a) - nodes01(b))
        k = k + 1
        row(k) = at_1 * row(k-1)
        do i = k - 1, 1, -1
          row(i) = ((k - i) * at_0 * row(i) + i * at_1 * row(i-1)) / k
        end do
        row(0) = at_0 * row(0)
      end do
      c(a,:) = row
    end do
  end subroutine lagrange_operator

  pure subroutine lagrange_nodes(p, kind_of_nodes, x)
    integer, intent(in) :: p               !! order, >= 0; a single node lies in the middle
    integer, intent(in) :: kind_of_nodes   !! equispaced or lobatto
    real(wp), intent(out) :: x(p+1)        !! nodes in [0,1], increasing

    integer :: i

    select case (kind_of_nodes)
    case (lobatto)
      call gauss_lobatto(p + 1, x)
    case (equispaced)
      x = 0.5_wp
      if (p > 0) x = [(real(i, wp) / p, i = 0, p)]
    case default
      error stop 'lagrange_nodes: unknown kind of nodes'
    end select
  end subroutine lagrange_nodes
end module lagrange
