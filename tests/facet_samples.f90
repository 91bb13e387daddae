module facet_samples
  !! Facets for the tests of surfaces, projection and interface: arcs, a sphere's octant, and bent
  !! rational facets with more functions than Bernstein polynomials, from reproducible random
  !! numbers.
  use kinds, only: wp, i8
  use rational_basis, only: shape_functions
  implicit none (type, external)
  private
  public :: facet, random_stream, uniform, unit_arc, unit_octant, bent_facet, facet_functions, &
    random_rotation

  type :: facet
    integer, allocatable :: degree(:)
    real(wp), allocatable :: we(:), ce(:,:), xm(:,:)
  end type facet

  type :: random_stream
    integer(i8) :: state = 1   !! set it to begin another sequence
  end type random_stream

contains

  real(wp) function uniform(stream, low, high) result(value)
    !! Park and Miller's generator.
    type(random_stream), intent(inout) :: stream
    real(wp), intent(in) :: low, high

    stream%state = modulo(16807_i8 * stream%state, 2147483647_i8)
    value = low + (high - low) * real(stream%state, wp) / 2147483647.0_wp
  end function uniform

  type(facet) function unit_arc(clockwise) result(sample)
    !! Quarter of the unit circle from (1,0) to (0,1), or back.
    logical, intent(in) :: clockwise

    sample%degree = [2]
    sample%we = [1.0_wp, sqrt(0.5_wp), 1.0_wp]
    sample%ce = identity(3)
    sample%xm = reshape([1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], [2, 3])
    if (clockwise) sample%xm = sample%xm(:, 3:1:-1)
  end function unit_arc

  type(facet) function unit_octant() result(sample)
    !! Octant of the unit sphere with outward normal: s round the z axis, t from the equator to the
    !! pole, where it is collapsed.
    real(wp), parameter :: corner(2,3) = reshape([1.0_wp, 0.0_wp, 1.0_wp, 1.0_wp, 0.0_wp, 1.0_wp], &
      [2, 3])
    real(wp) :: w(3)
    integer :: i, j, k

    w = [1.0_wp, sqrt(0.5_wp), 1.0_wp]
    sample%degree = [2, 2]
    allocate (sample%we(9), sample%xm(3,9))
    do j = 1, 3
      do i = 1, 3
        k = i + 3 * (j - 1)
        sample%we(k) = w(i) * w(j)
        sample%xm(:,k) = [corner(1,j) * corner(:,i), corner(2,j)]
      end do
    end do
    sample%ce = identity(9)
  end function unit_octant

  type(facet) function bent_facet(degree, bend, stream) result(sample)
    !! About the unit square (or interval): control points over it are moved by up to `bend`,
    !! weights lie between 1/2 and 2, quadratic and cubic directions are uniform B-splines, and the
    !! first function is split in two.
    integer, intent(in) :: degree(:)
    real(wp), intent(in) :: bend
    type(random_stream), intent(inout) :: stream
    real(wp), allocatable :: tensor(:,:)
    integer :: a, i, j, k, nb, ndm

    ndm = size(degree) + 1
    tensor = spline_operator(degree(1))
    if (size(degree) == 2) tensor = kronecker(tensor, spline_operator(degree(2)))
    nb = size(tensor, 2)
    sample%degree = degree
    allocate (sample%ce(nb+1,nb), sample%we(nb+1), sample%xm(ndm,nb+1))
    sample%ce(:nb,:) = tensor
    sample%ce(nb+1,:) = 0.375_wp * tensor(1,:)
    sample%ce(1,:) = 0.625_wp * tensor(1,:)
    do a = 1, nb + 1
      k = modulo(a - 1, nb)
      i = modulo(k, degree(1) + 1)
      j = k / (degree(1) + 1)
      sample%xm(1,a) = 0.5_wp + (i - degree(1) / 2.0_wp) * spacing_of(degree(1))
      if (ndm == 3) sample%xm(2,a) = 0.5_wp + (j - degree(2) / 2.0_wp) * spacing_of(degree(2))
      sample%xm(ndm,a) = 0
      do i = 1, ndm
        sample%xm(i,a) = sample%xm(i,a) + bend * uniform(stream, -1.0_wp, 1.0_wp)
      end do
      sample%we(a) = 2.0_wp**uniform(stream, -1.0_wp, 1.0_wp)
    end do
  end function bent_facet

  subroutine facet_functions(sample, xi, shp, dshp, d2shp)
    !! Basis of a facet with both derivatives.
    type(facet), intent(in) :: sample
    real(wp), intent(in) :: xi(:)
    real(wp), allocatable, intent(out) :: shp(:), dshp(:,:), d2shp(:,:)
    integer :: dp, nen, status

    dp = size(sample%degree)
    nen = size(sample%we)
    allocate (shp(nen), dshp(dp,nen), d2shp(dp * (dp + 1) / 2,nen))
    call shape_functions(sample%degree, sample%we, sample%ce, xi, 2, shp, dshp, d2shp, status)
    if (status /= 0) error stop 'facet_functions: sample facet without positive weight'
  end subroutine facet_functions

  function random_rotation(ndm, stream) result(q)
    !! Rotation from a random unit complex number or quaternion.
    integer, intent(in) :: ndm
    type(random_stream), intent(inout) :: stream
    real(wp) :: q(ndm,ndm), e(4)
    integer :: i

    do i = 1, 4
      e(i) = uniform(stream, -1.0_wp, 1.0_wp)
    end do
    if (ndm == 2) then
      e(1:2) = e(1:2) / norm2(e(1:2))
      q = reshape([e(1), e(2), -e(2), e(1)], [2, 2])
    else
      e = e / norm2(e)
      q(:,1) = [e(1)**2 + e(2)**2 - e(3)**2 - e(4)**2, 2 * (e(2)*e(3) + e(1)*e(4)), 2 * (e(2)*e(4) &
        - e(1)*e(3))]
      q(:,2) = [2 * (e(2)*e(3) - e(1)*e(4)), e(1)**2 - e(2)**2 + e(3)**2 - e(4)**2, 2 * (e(3)*e(4) &
        + e(1)*e(2))]
      q(:,3) = [2 * (e(2)*e(4) + e(1)*e(3)), 2 * (e(3)*e(4) - e(1)*e(2)), e(1)**2 - e(2)**2 &
        - e(3)**2 + e(4)**2]
    end if
  end function random_rotation

  pure function spline_operator(p) result(c)
    !! Extraction of an element amid a uniform B-spline; Bernstein itself but for p = 2 and 3.
    integer, intent(in) :: p
    real(wp) :: c(p+1,p+1)

    select case (p)
    case (2)
      c = reshape([1, 1, 0, 0, 2, 0, 0, 1, 1], [3, 3]) / 2.0_wp
    case (3)
      c = reshape([1, 4, 1, 0, 0, 4, 2, 0, 0, 2, 4, 0, 0, 1, 4, 1], [4, 4]) / 6.0_wp
    case default
      c = identity(p + 1)
    end select
  end function spline_operator

  pure real(wp) function spacing_of(p) result(spacing)
    !! Distance of Greville points, so that the facet has about unit length.
    integer, intent(in) :: p

    spacing = merge(1.0_wp, 1.0_wp / max(p, 1), p == 2 .or. p == 3)
  end function spacing_of

  pure function identity(n) result(c)
    integer, intent(in) :: n
    real(wp) :: c(n,n)
    integer :: i

    c = 0
    do i = 1, n
      c(i,i) = 1
    end do
  end function identity

  pure function kronecker(c1, c2) result(c)
    !! Tensor product, first direction fastest.
    real(wp), intent(in) :: c1(:,:), c2(:,:)
    real(wp) :: c(size(c1,1)*size(c2,1), size(c1,2)*size(c2,2))
    integer :: j, l, n, m

    n = size(c1, 1)
    m = size(c1, 2)
    do l = 1, size(c2, 2)
      do j = 1, size(c2, 1)
        c((j-1)*n+1:j*n, (l-1)*m+1:l*m) = c1 * c2(j,l)
      end do
    end do
  end function kronecker
end module facet_samples
