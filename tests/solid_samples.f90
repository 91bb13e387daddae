module solid_samples
  !! Distorted rational elements of any order in two and three dimensions, and their sides, for the
  !! tests of solids and surface loads.
  use kinds, only: wp
  use status_codes, only: ok
  use gauss_rules, only: tensor_rule
  use lagrange, only: lagrange_operator
  use tensor_product, only: tensor_operator
  use rational_basis, only: rational_basis_1
  use side_extraction, only: side_operator, side_functions
  use solid_kernel, only: bernstein_table, solid_points
  implicit none (type, external)
  private
  public :: element, side, distorted_element, element_side, wave, rotation, identity

  type :: element
    integer, allocatable :: degree(:)
    real(wp), allocatable :: we(:), ce(:,:), xe(:,:)
    real(wp), allocatable :: shp(:,:), dshp(:,:,:), dvol(:)  !! at Gauss points
  end type element

  type :: side
    integer, allocatable :: rows(:)                          !! its functions in the element
    real(wp), allocatable :: xe(:,:)                         !! their control points
    real(wp), allocatable :: shp(:,:), dshp(:,:,:), wt(:)    !! at Gauss points
  end type side

contains

  type(element) function distorted_element(ndm, p, n) result(sample)
    !! Rational Lagrange functions on a disturbed grid in a sheared unit cube.
    integer, intent(in) :: ndm      !! dimension
    integer, intent(in) :: p        !! order
    integer, intent(in) :: n        !! Gauss points per direction
    real(wp), allocatable :: xi(:,:), wt(:), bez(:,:), dbez(:,:,:), shape_matrix(:,:)
    real(wp) :: c(p+1,p+1), nodes(p+1)
    integer :: a, i, nen, ng, status, at(3)

    nen = (p + 1)**ndm
    ng = n**ndm
    allocate (sample%we(nen), sample%ce(nen,nen), sample%xe(ndm,nen))
    allocate (sample%shp(nen,ng), sample%dshp(ndm,nen,ng), sample%dvol(ng))
    allocate (xi(ndm,ng), wt(ng), bez(nen,ng), dbez(ndm,nen,ng), shape_matrix(ndm,ndm))
    sample%degree = spread(p, 1, ndm)
    nodes = [(real(i, wp)/p, i = 0, p)]
    call lagrange_operator(p, nodes, c)
    if (ndm == 2) then
      call tensor_operator(c, c, sample%ce)
    else
      call tensor_operator(c, c, c, sample%ce)
    end if
    shape_matrix = 0.15_wp
    do i = 1, ndm
      shape_matrix(i,i) = 1 + 0.2_wp*i
    end do
    do a = 1, nen
      at = [mod(a - 1, p + 1), mod((a - 1)/(p + 1), p + 1), (a - 1)/(p + 1)**2]
      sample%we(a) = 1 + 0.1_wp*wave(a, 1)
      do i = 1, ndm
        sample%xe(i,a) = (at(i) + 0.15_wp*wave(a, 2*i))/p
      end do
      sample%xe(:,a) = matmul(shape_matrix, sample%xe(:,a))
    end do
    call tensor_rule(spread(n, 1, ndm), xi, wt)
    call bernstein_table(sample%degree, xi, bez, dbez)
    call solid_points(sample%xe, sample%we, sample%ce, bez, dbez, wt, sample%shp, sample%dshp, &
      sample%dvol, status)
    if (status /= ok) error stop 'solid_samples: bad sample'
  end function distorted_element

  type(side) function element_side(sample, number, n) result(part)
    type(element), intent(in) :: sample    !! an element
    integer, intent(in) :: number          !! 1 .. 2 ndm
    integer, intent(in) :: n               !! Gauss points per direction
    integer :: degree(size(sample%degree)-1), rows(size(sample%we)), kept, g, status
    real(wp) :: xi(size(sample%degree)-1,n**(size(sample%degree)-1))
    real(wp), allocatable :: ce(:,:), bez(:,:), dbez(:,:,:), c(:,:), w(:)

    allocate (ce(size(sample%we),side_functions(sample%degree, number)))
    call side_operator(sample%degree, sample%ce, number, degree, kept, rows, ce)
    part%rows = rows(:kept)
    part%xe = sample%xe(:,part%rows)
    c = ce(:kept,:)
    w = sample%we(part%rows)
    allocate (part%wt(size(xi, 2)), bez(size(ce, 2),size(xi, 2)))
    allocate (dbez(size(xi, 1),size(ce, 2),size(xi, 2)))
    allocate (part%shp(kept,size(xi, 2)), part%dshp(size(xi, 1),kept,size(xi, 2)))
    call tensor_rule(spread(n, 1, size(xi, 1)), xi, part%wt)
    call bernstein_table(degree, xi, bez, dbez)
    do g = 1, size(xi, 2)
      call rational_basis_1(w, c, bez(:,g), dbez(:,:,g), part%shp(:,g), part%dshp(:,:,g), status)
      if (status /= ok) error stop 'solid_samples: bad side'
    end do
  end function element_side

  pure elemental real(wp) function wave(i, seed)
    !! Numbers in [-1,1] without pattern, the same on every machine.
    integer, intent(in) :: i, seed

    wave = sin(12.9898_wp*i + 78.233_wp*seed + 3.7_wp*i*seed)
  end function wave

  pure function rotation(n, angle) result(r)
    integer, intent(in) :: n
    real(wp), intent(in) :: angle
    real(wp) :: r(n,n), s(n,n)

    r = identity(n)
    r(1:2,1) = [cos(angle), sin(angle)]
    r(1:2,2) = [-sin(angle), cos(angle)]
    if (n == 2) return
    s = identity(n)
    s(2:3,2) = [cos(2*angle), sin(2*angle)]
    s(2:3,3) = [-sin(2*angle), cos(2*angle)]
    r = matmul(r, s)
  end function rotation

  pure function identity(n) result(unit)
    integer, intent(in) :: n
    real(wp) :: unit(n,n)
    integer :: i

    unit = 0
    do i = 1, n
      unit(i,i) = 1
    end do
  end function identity

end module solid_samples
