module right_angles
  !! Where a side of an element lies in a plane x_i = const, the surface meets the plane at right angles if the other
  !! coordinates have no derivative across the side: sum_a R_a,v x_a,j = 0, j /= i. That is a mirrored mesh's smoothness. It
  !! holds along the side if it holds at degree + 1 points.
  use kinds, only: wp
  use status_codes, only: ok
  use gauss_rules, only: gauss_legendre
  use rational_basis, only: shape_functions
  use side_extraction, only: side_parameters
  use extraction_mesh, only: extraction_mesh_type
  use linear_rows, only: linear_rows_type
  implicit none (type, external)
  private
  public :: add_right_angle

contains

  subroutine add_right_angle(mesh, e, side, i, rows)
    type(extraction_mesh_type), intent(in), target :: mesh
    integer, intent(in) :: e, side                        !! element and its side, 1 to 4
    integer, intent(in) :: i                              !! the coordinate that is constant
    type(linear_rows_type), intent(inout) :: rows(3)      !! of the control points' coordinates

    integer, pointer, contiguous :: ix(:)
    real(wp), pointer, contiguous :: ce(:,:)
    real(wp), allocatable :: shp(:), d1(:,:), d2(:,:), t(:), w(:)
    real(wp) :: xi(2)
    integer :: across, g, j, n, status

    ix => mesh%elements%connectivity(e)
    ce => mesh%elements%operator(e)
    across = (side + 1)/2
    n = mesh%elements%degree(3-across,e) + 1
    allocate (shp(size(ix)), d1(2,size(ix)), d2(3,size(ix)), t(n), w(n))
    call gauss_legendre(n, t, w)
    do g = 1, n
      call side_parameters(side, t(g:g), xi)
      call shape_functions(mesh%elements%degree(1:2,e), mesh%w(ix), ce, xi, 1, shp, d1, d2, status)
      if (status /= ok) cycle
      do j = 1, 3
        if (j /= i) call rows(j)%add_row(ix, d1(across,:))
      end do
    end do
  end subroutine add_right_angle
end module right_angles
