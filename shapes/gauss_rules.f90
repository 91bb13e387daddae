module gauss_rules
  !! Gauss-Legendre rules and Gauss-Lobatto nodes of any number of points on [0,1], and tensor
  !! products of rules. The nodes are zeros of Legendre polynomials P_n and of P'_(n-1), found by
  !! Newton's method from the usual asymptotic guesses (Chebyshev-like), the polynomials by their
  !! three-term recursion:
  !!
  !!   (k+1) P_(k+1) = (2k+1) z P_k - k P_(k-1),      (1-z^2) P'_n = n (P_(n-1) - z P_n)
  use kinds, only: wp
  implicit none (type, external)
  private
  public :: gauss_legendre, gauss_lobatto, tensor_rule

  real(wp), parameter :: pi = acos(-1.0_wp)
  integer, parameter :: most_steps = 20   !! Newton needs about 5

contains

  pure subroutine gauss_legendre(n, x, w)
    integer, intent(in) :: n          !! number of points, >= 1
    real(wp), intent(out) :: x(n)     !! points in (0,1), increasing
    real(wp), intent(out) :: w(n)     !! weights, their sum is 1

    real(wp) :: z, dz, p, dp
    integer :: i, step

    do i = 1, (n + 1) / 2
      z = -cos(pi * (i - 0.25_wp) / (n + 0.5_wp))
      if (2 * i == n + 1) z = 0.0_wp
      do step = 1, most_steps
        call legendre(n, z, p, dp)
        dz = p / dp
        z = z - dz
        if (abs(dz) <= epsilon(z)) exit
      end do
      if (2 * i == n + 1) z = 0.0_wp
      call legendre(n, z, p, dp)
      x(i) = 0.5_wp * (1.0_wp + z)
      x(n+1-i) = 0.5_wp * (1.0_wp - z)
      w(i) = 1.0_wp / ((1.0_wp - z) * (1.0_wp + z) * dp**2)
      w(n+1-i) = w(i)
    end do
  end subroutine gauss_legendre

  pure subroutine gauss_lobatto(n, x)
    integer, intent(in) :: n          !! number of nodes, >= 1; a single node lies in the middle
    real(wp), intent(out) :: x(n)     !! nodes in [0,1], increasing, the ends among them when n > 1

    real(wp) :: z, dz, p, dp, d2p
    integer :: i, m, step

    if (n == 1) then
      x = 0.5_wp
      return
    end if
    m = n - 1
    x(1) = 0.0_wp
    x(n) = 1.0_wp
    do i = 2, (n + 1) / 2
      z = -cos(pi * (i - 1) / m)
      if (2 * i == n + 1) z = 0.0_wp
      do step = 1, most_steps
        call legendre(m, z, p, dp)
        ! Legendre's equation gives the second derivative
        d2p = (2.0_wp * z * dp - m * (m + 1) * p) / ((1.0_wp - z) * (1.0_wp + z))
        dz = dp / d2p
        z = z - dz
        if (abs(dz) <= epsilon(z)) exit
      end do
      if (2 * i == n + 1) z = 0.0_wp
      x(i) = 0.5_wp * (1.0_wp + z)
      x(n+1-i) = 0.5_wp * (1.0_wp - z)
    end do
  end subroutine gauss_lobatto

  pure subroutine legendre(n, z, p, dp)
    integer, intent(in) :: n       !! order, >= 1
    real(wp), intent(in) :: z      !! point in (-1,1)
    real(wp), intent(out) :: p     !! P_n(z)
    real(wp), intent(out) :: dp    !! P'_n(z)

    real(wp) :: before, next
    integer :: k

    before = 1.0_wp
    p = z
    do k = 1, n - 1
      next = ((2 * k + 1) * z * p - k * before) / (k + 1)
      before = p
      p = next
    end do
    dp = n * (before - z * p) / ((1.0_wp - z) * (1.0_wp + z))
  end subroutine legendre

  pure subroutine tensor_rule(n, x, w)
    integer, intent(in) :: n(:)        !! points per direction (dp), dp = 1..3
    real(wp), intent(out) :: x(:,:)  !! points (dp,product(n)) in [0,1]^dp, first direction fastest
    real(wp), intent(out) :: w(:)      !! weights (product(n))

    real(wp) :: x1(maxval(n)), w1(maxval(n))
    integer :: d, g, i, stride

    w = 1.0_wp
    stride = 1
    do d = 1, size(n)
      call gauss_legendre(n(d), x1(1:n(d)), w1(1:n(d)))
      do g = 1, product(n)
        i = 1 + mod((g - 1) / stride, n(d))
        x(d,g) = x1(i)
        w(g) = w(g) * w1(i)
      end do
      stride = stride * n(d)
    end do
  end subroutine tensor_rule
end module gauss_rules
