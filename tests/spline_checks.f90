module spline_checks
  !! What must hold for any unstructured spline, measured on its extraction: sums of functions, gaps
  !! and turns of the normal along edges, second derivatives; and control points at random.
  use kinds, only: wp
  use quad_mesh, only: face_of, previous_corner
  use unstructured_spline, only: unstructured_spline_type, spline_mesh, side_of_edge
  use extraction_mesh, only: extraction_mesh_type
  use rational_basis, only: shape_functions
  use facet_samples, only: random_stream, uniform
  implicit none (type, external)
  private
  public :: column_error, look_at_edges, look_at_second_derivatives, disturb, edge_point, &
    surface_jet

contains

  real(wp) function column_error(mesh)
    type(extraction_mesh_type), intent(in), target :: mesh
    integer :: e

    column_error = 0
    do e = 1, mesh%elements%ne
      column_error = max(column_error, maxval(abs(sum(mesh%elements%operator(e), 1) - 1)))
    end do
  end function column_error

  subroutine disturb(spline, size_of, stream)
    !! Moves all control points at random.
    type(unstructured_spline_type), intent(inout) :: spline
    real(wp), intent(in) :: size_of
    type(random_stream), intent(inout) :: stream
    integer :: a, i

    do a = 1, size(spline%cp, 2)
      do i = 1, 3
        spline%cp(i,a) = spline%cp(i,a) + uniform(stream, -size_of, size_of)
      end do
    end do
  end subroutine disturb

  pure function edge_point(side, r) result(xi)
    !! Parameters of a point of an edge, r from its start.
    integer, intent(in) :: side
    real(wp), intent(in) :: r
    real(wp) :: xi(2)

    select case (side)
    case (3);      xi = [r, 0.0_wp]
    case (2);      xi = [1.0_wp, r]
    case (4);      xi = [1 - r, 1.0_wp]
    case default;  xi = [0.0_wp, 1 - r]
    end select
  end function edge_point

  subroutine surface_jet(mesh, e, xi, x, dx, d2x)
    !! Place and derivatives by s, t; ss, tt, st.
    type(extraction_mesh_type), intent(in), target :: mesh
    integer, intent(in) :: e
    real(wp), intent(in) :: xi(2)
    real(wp), intent(out) :: x(3), dx(3,2), d2x(3,3)
    integer, pointer, contiguous :: ix(:)
    real(wp), pointer, contiguous :: ce(:,:)
    real(wp), allocatable :: shp(:), dshp(:,:), d2shp(:,:), we(:), xe(:,:)
    integer :: status

    ix => mesh%elements%connectivity(e)
    ce => mesh%elements%operator(e)
    allocate (shp(size(ix)), dshp(2,size(ix)), d2shp(3,size(ix)))
    we = mesh%w(ix)
    xe = mesh%x(:,ix)
    call shape_functions(mesh%elements%degree(1:2,e), we, ce, xi, 2, shp, dshp, d2shp, status)
    if (status /= 0) error stop 'spline_checks: the weights are not positive'
    x = matmul(xe, shp)
    dx = matmul(xe, transpose(dshp))
    d2x = matmul(xe, transpose(d2shp))
  end subroutine surface_jet

  subroutine look_at_edges(spline, gap, turn)
    !! Along all smooth edges.
    type(unstructured_spline_type), intent(in) :: spline
    real(wp), intent(out) :: gap         !! largest distance between the two sides
    real(wp), intent(out) :: turn        !! largest angle between their normals [rad]
    type(extraction_mesh_type), target :: mesh
    integer, parameter :: points = 8
    real(wp) :: dx(3,2), d2x(3,3), normal(3,2), x(3,2)
    integer :: c, edge(2), k, m

    call spline_mesh(spline, mesh)
    gap = 0
    turn = 0
    do c = 1, 4*spline%mesh%nf
      edge = [c, spline%mesh%twin(c)]
      if (edge(2) < c .or. spline%mesh%crease(c)) cycle
      do k = 0, points
        do m = 1, 2
          call surface_jet(mesh, face_of(edge(m)), edge_point(side_of_edge(edge(m)), &
            merge(k, points - k, m == 1)/real(points, wp)), x(:,m), dx, d2x)
          normal(:,m) = cross(dx(:,1), dx(:,2))
          normal(:,m) = normal(:,m)/norm2(normal(:,m))
        end do
        gap = max(gap, norm2(x(:,1) - x(:,2)))
        turn = max(turn, norm2(cross(normal(:,1), normal(:,2))))
        if (dot_product(normal(:,1), normal(:,2)) < 0) turn = 2
      end do
    end do
  end subroutine look_at_edges

  real(wp) function look_at_second_derivatives(spline) result(jump)
    !! Largest difference of the second derivatives across the edges (by the knots) between faces that
    !! touch no face on a seam.
    type(unstructured_spline_type), intent(in) :: spline
    type(extraction_mesh_type), target :: mesh
    real(wp) :: across(3,2), dx(3,2), d2x(3,3), h, x(3)
    logical :: special(spline%mesh%nv)         ! of a face on a seam
    integer :: c, edge(2), k, m, side

    call spline_mesh(spline, mesh)
    special = .false.
    do c = 1, 4*spline%mesh%nf
      if (spline%mesh%seam(c)) special(spline%mesh%vertex(4*face_of(c)-3:4*face_of(c))) = .true.
    end do
    jump = 0
    do c = 1, 4*spline%mesh%nf
      edge = [c, spline%mesh%twin(c)]
      if (edge(2) < c .or. spline%mesh%crease(c)) cycle
      if (.not. (is_plain(face_of(c)) .and. is_plain(face_of(edge(2))))) cycle
      do k = 0, 4
        do m = 1, 2
          side = side_of_edge(edge(m))
          call surface_jet(mesh, face_of(edge(m)), edge_point(side, &
            merge(k, 4 - k, m == 1)/4.0_wp), x, dx, d2x)
          h = spline%mesh%interval(previous_corner(edge(m)))
          across(:,m) = d2x(:,merge(1, 2, side <= 2))/h**2
        end do
        jump = max(jump, norm2(across(:,1) - across(:,2)))
      end do
    end do

  contains

    logical function is_plain(f)
      integer, intent(in) :: f
      integer :: k

      is_plain = .true.
      do k = 4*f - 3, 4*f
        is_plain = is_plain .and. .not. special(spline%mesh%vertex(k))
      end do
    end function is_plain
  end function look_at_second_derivatives

  pure function cross(a, b)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: cross(3)

    cross = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross
end module spline_checks
