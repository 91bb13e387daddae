module lagrange_mesh
  !! Lagrange elements mapped on the geometry of a NURBS patch: nodes are places of the patch,
  !! weights are 1, neighbours share their nodes. Made in two steps, so that a host can number the
  !! nodes (and join patches) in between.
  use kinds, only: wp
  use lagrange, only: lagrange_operator, lagrange_nodes
  use tensor_product, only: tensor_operator
  use nurbs_patch, only: nurbs_patch_type, evaluate_grid
  use extraction_set, only: extraction_set_type
  implicit none (type, external)
  private
  public :: break_list, patch_breaks, lagrange_grid, lagrange_mesh_nodes, lagrange_mesh_elements

  type :: break_list
    real(wp), allocatable :: at(:)   !! ends of the elements in one direction, increasing
  end type break_list

contains

  pure function patch_breaks(patch) result(breaks)
    !! One element a span.
    type(nurbs_patch_type), intent(in) :: patch
    type(break_list) :: breaks(3)

    integer :: d

    do d = 1, 3
      breaks(d)%at = patch%knots(d)%breaks()
    end do
  end function patch_breaks

  pure function lagrange_grid(degree, breaks) result(n)
    integer, intent(in) :: degree(3)             !! degrees, >= 1, 0 in unused directions
    type(break_list), intent(in) :: breaks(3)    !! elements; one in unused directions
    integer :: n(3)                              !! nodes per direction

    integer :: d

    do d = 1, 3
      n(d) = max(1, degree(d) * (size(breaks(d)%at) - 1) + 1)
    end do
  end function lagrange_grid

  pure subroutine lagrange_mesh_nodes(patch, degree, breaks, kind_of_nodes, x)
    type(nurbs_patch_type), intent(in) :: patch
    integer, intent(in) :: degree(3)             !! degrees, >= 1, 0 in unused directions
    type(break_list), intent(in) :: breaks(3)    !! elements in the knots' parameters
    integer, intent(in) :: kind_of_nodes         !! equispaced or lobatto (in parameters)
    real(wp), allocatable, intent(out) :: x(:,:) !! places of the nodes (3,n), first direction
                                                 !! fastest

    type(break_list) :: at(3)
    integer :: d

    do d = 1, 3
      at(d)%at = line_nodes(degree(d), breaks(d)%at, kind_of_nodes)
    end do
    allocate (x(3,product(lagrange_grid(degree, breaks))))
    call evaluate_grid(patch, at(1)%at, at(2)%at, at(3)%at, x)
  end subroutine lagrange_mesh_nodes

  pure function line_nodes(p, breaks, kind_of_nodes) result(x)
    integer, intent(in) :: p                !! degree, 0 in unused directions
    real(wp), intent(in) :: breaks(:)       !! ends of the elements
    integer, intent(in) :: kind_of_nodes    !! equispaced or lobatto
    real(wp), allocatable :: x(:)           !! parameters of the nodes along one direction

    real(wp) :: in_element(p+1)
    integer :: e, ne

    call lagrange_nodes(p, kind_of_nodes, in_element)
    if (p == 0) then
      x = breaks(1) + (breaks(2) - breaks(1)) * in_element
      return
    end if
    ne = size(breaks) - 1
    allocate (x(p*ne+1))
    do e = 1, ne
      x((e-1)*p+1:e*p) = breaks(e) + (breaks(e+1) - breaks(e)) * in_element(1:p)
    end do
    x(p*ne+1) = breaks(ne+1)
  end function line_nodes

  subroutine lagrange_mesh_elements(dp, degree, breaks, kind_of_nodes, node_ids, set)
    !! Appends the elements to a set, first direction fastest.
    integer, intent(in) :: dp                    !! parametric dimension, 1..3
    integer, intent(in) :: degree(3)             !! degrees, >= 1, 0 in unused directions
    type(break_list), intent(in) :: breaks(3)    !! elements; one in unused directions
    integer, intent(in) :: kind_of_nodes         !! equispaced or lobatto
    integer, intent(in) :: node_ids(:)           !! node of each point of the grid
    type(extraction_set_type), intent(inout) :: set

    real(wp) :: c1(degree(1)+1,degree(1)+1), c2(degree(2)+1,degree(2)+1)
    real(wp) :: c3(degree(3)+1,degree(3)+1), in_element(maxval(degree)+1)
    real(wp), allocatable :: ce(:,:)
    integer, allocatable :: nodes(:)
    integer :: a, i, id, j, k, l, l2, l3, n(3), ne(3), op

    call lagrange_nodes(degree(1), kind_of_nodes, in_element(1:degree(1)+1))
    call lagrange_operator(degree(1), in_element(1:degree(1)+1), c1)
    call lagrange_nodes(degree(2), kind_of_nodes, in_element(1:degree(2)+1))
    call lagrange_operator(degree(2), in_element(1:degree(2)+1), c2)
    call lagrange_nodes(degree(3), kind_of_nodes, in_element(1:degree(3)+1))
    call lagrange_operator(degree(3), in_element(1:degree(3)+1), c3)
    allocate (ce(product(degree+1),product(degree+1)), nodes(product(degree+1)))
    call tensor_operator(c1, c2, c3, ce)
    call set%add_operator(ce, op)

    n = lagrange_grid(degree, breaks)
    ne = [size(breaks(1)%at), size(breaks(2)%at), size(breaks(3)%at)] - 1
    do k = 0, ne(3) - 1
      do j = 0, ne(2) - 1
        do i = 0, ne(1) - 1
          l = 0
          do l3 = 0, degree(3)
            do l2 = 0, degree(2)
              a = 1 + i * degree(1) + n(1) * (j * degree(2) + l2 + n(2) * (k * degree(3) + l3))
              nodes(l+1:l+degree(1)+1) = node_ids(a:a+degree(1))
              l = l + degree(1) + 1
            end do
          end do
          call set%add_element_with_operator(dp, degree, nodes, op, id)
        end do
      end do
    end do
  end subroutine lagrange_mesh_elements
end module lagrange_mesh
