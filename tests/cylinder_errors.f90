module cylinder_errors
  !! The deck inputs/verify/thick_cylinder.inp against Lame's solution (plane strain, small strains):
  !!     u = (A + B/r^2) x,  A = c (1 - 2 nu),  B = c b^2,  c = (1 + nu)/E p a^2/(b^2 - a^2)
  !! Errors relative to the exact field: energy norm, from 2 psi(grad u_h - grad u), and L2 norm of the displacement, with
  !! degree + 3 Gauss points per direction.
  use kinds, only: wp, i8
  use status_codes, only: ok
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use geometry_map, only: physical_gradient
  use material_laws, only: solid_law, define_solid_law, stress, small_strain, plane_strain
  use deck_runs, only: deck_run, project_file
  implicit none (type, external)
  private
  public :: cylinder_result, solve_cylinder

  real(wp), parameter :: inner = 1, outer = 2, load = 1, modulus = 1000, ratio = 0.3_wp   ! the deck's defaults

  type :: cylinder_result
    integer :: dofs = 0              !! free control values
    real(wp) :: energy = 0, l2 = 0   !! relative errors
    real(wp) :: seconds = 0          !! preparation and solution
    logical :: solved = .false.
  end type cylinder_result

contains

  subroutine solve_cylinder(basis, p, mesh, found)
    character(1), intent(in) :: basis        !! N or L
    integer, intent(in) :: p, mesh           !! degree, elements in each direction
    type(cylinder_result), intent(out) :: found
    type(deck_run), target :: run
    character(12) :: settings(3)
    integer(i8) :: began, ended, rate
    integer :: status

    settings(1) = 'basis='//basis
    write (settings(2), '(a,i0)') 'p=', p
    write (settings(3), '(a,i0)') 'mesh=', mesh
    call system_clock(began, rate)
    call run%open_file(project_file('inputs/verify/thick_cylinder.inp'), settings)
    if (run%deck_errors > 0) return
    call run%solve_to(1.0_wp, status)
    call system_clock(ended)
    if (status /= ok) return
    found%seconds = real(ended - began, wp)/real(rate, wp)
    found%dofs = run%eq%system%map%neq
    call integrate_errors(run, found)
    found%solved = .true.
  end subroutine solve_cylinder

  pure subroutine lame(x, u, grad)
    real(wp), intent(in) :: x(2)
    real(wp), intent(out) :: u(2), grad(2, 2)     !! displacement, grad(i,j) = du_i/dx_j
    real(wp) :: a, b, c, r2
    integer :: i

    c = (1 + ratio)/modulus*load*inner**2/(outer**2 - inner**2)
    a = c*(1 - 2*ratio)
    b = c*outer**2
    r2 = sum(x**2)
    u = (a + b/r2)*x
    grad = -2*b/r2**2*spread(x, 2, 2)*spread(x, 1, 2)
    do i = 1, 2
      grad(i, i) = grad(i, i) + a + b/r2
    end do
  end subroutine lame

  subroutine integrate_errors(run, found)
    type(deck_run), intent(in), target :: run
    type(cylinder_result), intent(inout) :: found
    type(solid_law) :: law
    integer, pointer, contiguous :: nodes(:)
    real(wp), allocatable :: xi(:, :), wt(:), shp(:), dshp(:, :), dx(:, :), ue(:, :)
    real(wp) :: d2shp(0, 0), detj, u(2), grad(2, 2), psi, p(2, 2), f(2, 2), sums(4)
    real(wp), parameter :: identity(2, 2) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])
    integer :: e, g, n, degree(2), status

    call define_solid_law(small_strain, plane_strain, modulus, ratio, law, status)
    sums = 0
    do e = 1, run%model%mesh%ne
      nodes => run%model%mesh%connectivity(e)
      degree = run%model%mesh%degree(1:2, e)
      n = product(degree + 3)
      allocate (xi(2, n), wt(n), shp(size(nodes)), dshp(2, size(nodes)), dx(2, size(nodes)))
      ue = run%eq%u(:, nodes)
      call tensor_rule(degree + 3, xi, wt)
      do g = 1, n
        call shape_functions(degree, run%model%w(nodes), run%model%mesh%operator(e), xi(:, g), 1, shp, dshp, d2shp, status)
        call physical_gradient(run%model%x(:, nodes), dshp, dx, detj, status)
        call lame(matmul(run%model%x(:, nodes), shp), u, grad)
        f = identity + grad
        call stress(law, f, psi, p, status)
        sums(2) = sums(2) + wt(g)*detj*psi
        f = identity + (matmul(ue, transpose(dx)) - grad)
        call stress(law, f, psi, p, status)
        sums(1) = sums(1) + wt(g)*detj*psi
        sums(3) = sums(3) + wt(g)*detj*sum((matmul(ue, shp) - u)**2)
        sums(4) = sums(4) + wt(g)*detj*sum(u**2)
      end do
      deallocate (xi, wt, shp, dshp, dx)
    end do
    found%energy = sqrt(sums(1)/sums(2))
    found%l2 = sqrt(sums(3)/sums(4))
  end subroutine integrate_errors
end module cylinder_errors
