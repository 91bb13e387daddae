module mesh_facts
  !! What a mesh of extraction elements holds, in numbers: sizes, sums of columns of C, coefficients
  !! below zero, unused nodes, repeated elements, length, area or volume.
  use kinds, only: wp, i8
  use status_codes, only: ok
  use extraction_mesh, only: extraction_mesh_type, mesh_set, used_by_elements, repeated_elements, &
    names_a_node_twice, set_of_sides
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use side_extraction, only: side_operator, side_functions
  implicit none (type, external)
  private
  public :: facts_type, gather_facts, element_size, set_size

  integer, parameter :: extra_points = 4      !! Gauss points per direction beyond the degree
  integer, parameter :: rational_points = 10  !! at least, on curves and surfaces with weights

  type :: facts_type
    integer :: unused = 0              !! nodes that no element names
    integer :: repeated = 0            !! elements that repeat an earlier one exactly
    integer :: double_nodes = 0        !! elements that name a node twice
    integer :: nen_min = 0, nen_max = 0     !! functions per element
    real(wp) :: column_error = 0       !! largest |sum of a column of C - 1|
    real(wp) :: smallest = 0           !! coefficient
    integer(i8) :: negative = 0        !! coefficients below zero, of all elements
    integer :: negative_elements = 0   !! elements that have some
    integer :: dp = 0                  !! largest parametric dimension
    logical :: is_plane = .false.      !! all used nodes have z = 0
    real(wp) :: total = 0              !! length, area or volume of the elements of dimension dp,
                                       !! repeated ones once
    integer :: inverted = 0            !! elements with det J <= 0 at a Gauss point, or without
                                       !! a positive weight function
    integer :: first_inverted = 0
  end type facts_type

contains

  subroutine gather_facts(mesh, facts)
    type(extraction_mesh_type), intent(in), target :: mesh
    type(facts_type), intent(out) :: facts

    integer, allocatable :: same_as(:), times(:)
    logical, allocatable :: used(:)
    real(wp), pointer, contiguous :: ce(:,:)
    real(wp) :: part
    integer :: b, e, n, op
    logical :: is_good

    call used_by_elements(mesh, used)
    call repeated_elements(mesh%elements, same_as)
    facts%unused = count(.not. used)
    facts%repeated = count(same_as > 0)
    if (mesh%elements%ne == 0) return
    facts%is_plane = all(.not. abs(mesh%x(3,:)) > 0 .or. .not. used)
    facts%dp = maxval(mesh%elements%dp(1:mesh%elements%ne))
    allocate (times(mesh%elements%nop), source=0)
    facts%nen_min = huge(n)
    do e = 1, mesh%elements%ne
      n = mesh%elements%nen(e)
      facts%nen_min = min(facts%nen_min, n)
      facts%nen_max = max(facts%nen_max, n)
      if (names_a_node_twice(mesh%elements%connectivity(e))) &
        facts%double_nodes = facts%double_nodes + 1
      op = mesh%elements%operator_of(e)
      times(op) = times(op) + 1
      if (times(op) > 1) cycle
      ce => mesh%elements%operator(e)
      do b = 1, size(ce, 2)
        facts%column_error = max(facts%column_error, abs(sum(ce(:,b)) - 1))
      end do
      if (op == 1) facts%smallest = ce(1,1)
      facts%smallest = min(facts%smallest, minval(ce))
    end do
    do e = 1, mesh%elements%ne
      op = mesh%elements%operator_of(e)
      if (times(op) == 0) cycle
      n = count(mesh%elements%operator(e) < 0)
      facts%negative = facts%negative + int(n, i8)*times(op)
      if (n > 0) facts%negative_elements = facts%negative_elements + times(op)
      times(op) = 0
    end do
    do e = 1, mesh%elements%ne
      if (same_as(e) > 0) cycle
      call element_size(mesh, e, facts%is_plane, part, is_good)
      if (mesh%elements%dp(e) == facts%dp) facts%total = facts%total + part
      if (is_good) cycle
      facts%inverted = facts%inverted + 1
      if (facts%inverted == 1) facts%first_inverted = e
    end do
  end subroutine gather_facts

  subroutine element_size(mesh, e, is_plane, total, is_good)
    !! Length, area or volume of an element, int sqrt(det(J^T J)) dxi. The rule is exact for
    !! polynomial planes and solids.
    type(extraction_mesh_type), intent(in), target :: mesh
    integer, intent(in) :: e
    logical, intent(in) :: is_plane            !! then the sign of det J counts on surfaces too
    real(wp), intent(out) :: total
    logical, intent(out) :: is_good            !! det J > 0 where it has a sign

    integer, pointer, contiguous :: ix(:)
    real(wp), pointer, contiguous :: ce(:,:)

    ix => mesh%elements%connectivity(e)
    ce => mesh%elements%operator(e)
    call size_of(mesh%elements%degree(1:mesh%elements%dp(e),e), mesh%x(:,ix), mesh%w(ix), ce, &
      is_plane, total, is_good)
  end subroutine element_size

  subroutine size_of(degree, xe, we, ce, is_plane, total, is_good)
    integer, intent(in) :: degree(:)                 !! (dp)
    real(wp), contiguous, intent(in) :: xe(:,:), we(:), ce(:,:)   !! (3,nen), (nen), (nen,nb)
    logical, intent(in) :: is_plane
    real(wp), intent(out) :: total
    logical, intent(out) :: is_good

    integer :: points(size(degree))

    points = degree + extra_points
    if (size(degree) < 3 .and. any(abs(we - we(1)) > 0)) points = max(points, rational_points)
    call integrate_size(degree, points, xe, we, ce, is_plane, total, is_good)
  end subroutine size_of

  subroutine integrate_size(degree, points, xe, we, ce, is_plane, total, is_good)
    integer, intent(in) :: degree(:), points(:)      !! (dp)
    real(wp), contiguous, intent(in) :: xe(:,:), we(:), ce(:,:)
    logical, intent(in) :: is_plane
    real(wp), intent(out) :: total
    logical, intent(out) :: is_good

    real(wp) :: shp(size(we)), dshp(size(degree),size(we)), d2shp(6,size(we))
    real(wp) :: jac(3,size(degree)), xi(size(degree),product(points)), normal(3)
    real(wp) :: wt(product(points)), detj
    integer :: a, dp, g, i, j, status

    dp = size(degree)
    call tensor_rule(points, xi, wt)
    total = 0
    is_good = .true.
    do g = 1, size(wt)
      call shape_functions(degree, we, ce, xi(:,g), 1, shp, dshp, d2shp, status)
      if (status /= ok) then
        is_good = .false.
        return
      end if
      jac = 0
      do a = 1, size(we)
        do j = 1, dp
          do i = 1, 3
            jac(i,j) = jac(i,j) + xe(i,a)*dshp(j,a)
          end do
        end do
      end do
      select case (dp)
      case (1)
        detj = norm2(jac(:,1))
      case (2)
        normal = cross(jac(:,1), jac(:,2))
        detj = norm2(normal)
        if (is_plane) detj = normal(3)
      case default
        detj = dot_product(cross(jac(:,1), jac(:,2)), jac(:,3))
      end select
      if (.not. detj > 0) is_good = .false.
      total = total + wt(g)*detj
    end do
  end subroutine integrate_size

  subroutine set_size(mesh, set, total)
    !! Length or area of the sides of a set.
    type(extraction_mesh_type), intent(in), target :: mesh
    type(mesh_set), intent(in) :: set                !! a set of sides
    real(wp), intent(out) :: total

    integer, pointer, contiguous :: ix(:)
    real(wp), pointer, contiguous :: ce(:,:)
    real(wp), allocatable :: ce_side(:,:)
    integer, allocatable :: rows(:)
    integer :: degree(3), dp, k, n, side_degree(2)
    real(wp) :: part
    logical :: is_good

    total = 0
    if (set%kind /= set_of_sides) return
    do k = 1, size(set%items)
      associate (e => set%items(k))
        if (set%sides(k) == 0) then
          call element_size(mesh, e, .false., part, is_good)
          total = total + part
          cycle
        end if
        dp = mesh%elements%dp(e)
        if (dp < 2) cycle
        ix => mesh%elements%connectivity(e)
        ce => mesh%elements%operator(e)
        degree = mesh%elements%degree(:,e)
        allocate (rows(size(ix)), ce_side(size(ix),side_functions(degree(1:dp), set%sides(k))))
        call side_operator(degree(1:dp), ce, set%sides(k), side_degree(1:dp-1), n, rows, ce_side)
        call size_of(side_degree(1:dp-1), mesh%x(:,ix(rows(1:n))), mesh%w(ix(rows(1:n))), &
          ce_side(1:n,:), .false., part, is_good)
        total = total + part
        deallocate (rows, ce_side)
      end associate
    end do
  end subroutine set_size

  pure function cross(a, b)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: cross(3)

    cross = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross
end module mesh_facts
