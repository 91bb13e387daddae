module shell_samples
  !! Curved, distorted rational elements of any order for the tests of shells.
  use kinds, only: wp
  use status_codes, only: ok
  use gauss_rules, only: tensor_rule
  use lagrange, only: lagrange_operator
  use tensor_product, only: tensor_operator
  use rational_basis, only: shape_functions
  use shell_kernel, only: shell_points, n_derivatives, n_frame
  use solid_samples, only: wave
  implicit none (type, external)
  private
  public :: shell, curved_shell, mapped_shell, displaced, cross_product

  type :: shell
    integer :: degree(2) = 0
    real(wp), allocatable :: we(:), ce(:,:), xe(:,:)
    real(wp), allocatable :: nodes(:,:)                             !! parameters of the nodes (2,nen)
    real(wp), allocatable :: shp(:,:), dshp(:,:,:), frame(:,:), area(:)  !! at Gauss points
    real(wp), allocatable :: xi(:,:)                                !! these
  end type shell

  abstract interface
    pure function surface_map(s) result(x)
      import :: wp
      real(wp), intent(in) :: s(2)
      real(wp) :: x(3)
    end function surface_map
  end interface

contains

  type(shell) function curved_shell(p, n) result(sample)
    !! Rational Lagrange functions on a disturbed, doubly curved grid of about unit size.
    integer, intent(in) :: p        !! order
    integer, intent(in) :: n        !! Gauss points per direction
    integer :: a

    call place_nodes(p, sample)
    do a = 1, size(sample%we)
      sample%we(a) = 1 + 0.1_wp*wave(a, 1)
      associate (s => sample%nodes(:,a))
        sample%xe(:,a) = [1.2_wp*s(1) + 0.3_wp*s(2), 0.9_wp*s(2) - 0.2_wp*s(1), 0.5_wp*s(1)**2 + 0.3_wp*s(1)*s(2)]
      end associate
      sample%xe(:,a) = sample%xe(:,a) + 0.05_wp/p*[wave(a, 2), wave(a, 3), wave(a, 4)]
    end do
    call finish(n, sample)
  end function curved_shell

  type(shell) function mapped_shell(p, n, map) result(sample)
    !! Lagrange functions of order p that interpolate a map of the unit square.
    integer, intent(in) :: p        !! order
    integer, intent(in) :: n        !! Gauss points per direction
    procedure(surface_map) :: map
    integer :: a

    call place_nodes(p, sample)
    sample%we = 1
    do a = 1, size(sample%we)
      sample%xe(:,a) = map(sample%nodes(:,a))
    end do
    call finish(n, sample)
  end function mapped_shell

  function displaced(sample, map) result(ue)
    !! Displacement that takes the nodes of a mapped shell to another map.
    type(shell), intent(in) :: sample
    procedure(surface_map) :: map
    real(wp) :: ue(3,size(sample%we))
    integer :: a

    do a = 1, size(sample%we)
      ue(:,a) = map(sample%nodes(:,a)) - sample%xe(:,a)
    end do
  end function displaced

  subroutine place_nodes(p, sample)
    integer, intent(in) :: p
    type(shell), intent(out) :: sample
    real(wp) :: c(p+1,p+1), nodes(p+1)
    integer :: a, i

    sample%degree = p
    nodes = [(real(i, wp)/p, i = 0, p)]
    allocate (sample%we((p + 1)**2), sample%ce((p + 1)**2,(p + 1)**2))
    allocate (sample%xe(3,(p + 1)**2), sample%nodes(2,(p + 1)**2))
    call lagrange_operator(p, nodes, c)
    call tensor_operator(c, c, sample%ce)
    do a = 1, (p + 1)**2
      sample%nodes(:,a) = nodes(1 + [mod(a - 1, p + 1), (a - 1)/(p + 1)])
    end do
  end subroutine place_nodes

  subroutine finish(n, sample)
    integer, intent(in) :: n
    type(shell), intent(inout) :: sample
    real(wp) :: wt(n**2)
    integer :: nen, status

    nen = size(sample%we)
    allocate (sample%xi(2,n**2), sample%shp(nen,n**2), sample%dshp(n_derivatives,nen,n**2))
    allocate (sample%frame(n_frame,n**2), sample%area(n**2))
    call tensor_rule([n, n], sample%xi, wt)
    call shell_points(sample%degree, sample%xe, sample%we, sample%ce, sample%xi, wt, sample%shp, sample%dshp, &
      sample%frame, sample%area, status)
    if (status /= ok) error stop 'shell_samples: bad sample'
  end subroutine finish

  pure function cross_product(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross_product
end module shell_samples
