module edge_rows
  !! Edges of shells: the functions that give an edge its place and its slope, and their derivatives across it.
  !!
  !! A function belongs to the first row of an edge if it does not vanish there, to the second if it vanishes with a
  !! derivative across that does not. On an edge with unit conormal nu (outward, in the tangent plane of the start) the
  !! slope of a field d = sum_a R_a d_a is d_,nu = sum over both rows of R_a,nu d_a; the coefficients of the second row
  !! that keep it zero are, in the least-squares sense over Gauss points with lengths l_g,
  !!
  !!   d_2 = C d_1,   (S_2^T L S_2) C = - S_2^T L S_1,   S = R_a,nu(x_g)
  !!
  !! which is exact where the spline allows it; what remains of S_2 C + S_1 tells.
  use kinds, only: wp
  use status_codes, only: ok, singular_map
  use gauss_rules, only: gauss_legendre
  use rational_basis, only: shape_functions
  use side_extraction, only: side_parameters
  use model_data, only: model_type
  implicit none (type, external)
  private
  public :: edge_type, edge_point, edge_point_at, collect_edge, slope_nodes, slope_dependence

  type :: edge_type
    integer, allocatable :: first(:), second(:)   !! nodes of both rows, increasing
    real(wp), allocatable :: slope(:, :)          !! R_a,nu at the points (np,first and second) [1/length]
    real(wp), allocatable :: x(:, :)              !! points (3,np) [length]
    real(wp), allocatable :: nu(:, :), nrm(:, :)  !! outward conormals and normals (3,np)
    real(wp), allocatable :: length(:)            !! of the points (np)
  end type edge_type

  type :: edge_point
    !! A point of a side of a shell element, at the start.
    real(wp) :: x(3), tau(3), nu(3), nrm(3)       !! place, tangent x_,eta of the side, conormal, normal
    real(wp), allocatable :: dnu(:), dtau(:)      !! R_a,nu, R_a along the unit tangent (nen) [1/length]
    real(wp), allocatable :: shp(:)               !! R_a
  end type edge_point

  real(wp), parameter :: vanishing = 1e-14_wp     !! relative to the largest coefficient of an operator

contains

  subroutine edge_point_at(model, e, side, eta, point, status)
    type(model_type), intent(in), target :: model
    integer, intent(in) :: e, side                !! element and its side, 1 to 4
    real(wp), intent(in) :: eta                   !! parameter of the side
    type(edge_point), intent(out) :: point
    integer, intent(out) :: status                !! ok, bad_weight, singular_map
    integer, pointer, contiguous :: ix(:)
    real(wp), allocatable :: d1(:, :), d2(:, :)
    real(wp) :: xi(2), xa(3), xc(3), slant, outward, length
    integer :: across, along

    ix => model%mesh%connectivity(e)
    across = (side + 1)/2
    along = 3 - across
    outward = merge(1.0_wp, -1.0_wp, mod(side, 2) == 0)
    call side_parameters(side, [eta], xi)
    allocate (point%shp(size(ix)), d1(2, size(ix)), d2(0, 0))
    call shape_functions(model%mesh%degree(1:2, e), model%w(ix), model%mesh%operator(e), xi, 1, point%shp, d1, d2, status)
    if (status /= ok) return
    point%x = matmul(model%x(:, ix), point%shp)
    xa = matmul(model%x(:, ix), d1(along, :))
    xc = matmul(model%x(:, ix), d1(across, :))
    point%tau = merge(-xa, xa, side == 1 .or. side == 4)
    slant = norm2(xa)
    if (slant > 0) slant = dot_product(xc, xa)/slant**2
    xc = xc - slant*xa
    length = norm2(xc)
    status = singular_map
    if (.not. (length > 1e-12_wp*norm2(xc + slant*xa) .and. norm2(xa) > 0)) return
    status = ok
    point%nu = outward*xc/length
    point%dnu = outward/length*(d1(across, :) - slant*d1(along, :))
    point%dtau = merge(-1.0_wp, 1.0_wp, side == 1 .or. side == 4)*d1(along, :)/norm2(xa)
    point%nrm = cross(point%tau, point%nu)*(-1)/norm2(point%tau)   ! the side runs with the body on its left
  end subroutine edge_point_at

  subroutine collect_edge(model, set, edge, status)
    !! Rows, slopes and points of a surface set whose members are sides of shell elements.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: set                    !! index into model%sets
    type(edge_type), intent(out) :: edge
    integer, intent(out) :: status                !! ok, bad_weight, singular_map (a side of no length)
    integer, allocatable :: column(:)
    integer, pointer, contiguous :: ix(:)
    type(edge_point) :: point
    real(wp), allocatable :: t(:), w(:)
    integer :: a, e, g, i, n, np

    call rows_of_edge(model, set, edge%first, edge%second)
    allocate (column(model%nn), source=0)
    column(edge%first) = [(a, a=1, size(edge%first))]
    column(edge%second) = size(edge%first) + [(a, a=1, size(edge%second))]
    np = 0
    do i = 1, size(model%sets(set)%items)
      np = np + maxval(model%mesh%degree(1:2, model%sets(set)%items(i))) + 2
    end do
    allocate (edge%slope(np, size(edge%first) + size(edge%second)), source=0.0_wp)
    allocate (edge%x(3, np), edge%nu(3, np), edge%nrm(3, np), edge%length(np))
    np = 0
    status = ok
    do i = 1, size(model%sets(set)%items)
      e = model%sets(set)%items(i)
      ix => model%mesh%connectivity(e)
      n = maxval(model%mesh%degree(1:2, e)) + 2
      t = [(0.0_wp, g=1, n)]
      w = t
      call gauss_legendre(n, t, w)
      do g = 1, n
        call edge_point_at(model, e, model%sets(set)%sides(i), t(g), point, status)
        if (status /= ok) return
        np = np + 1
        edge%x(:, np) = point%x
        edge%nu(:, np) = point%nu
        edge%nrm(:, np) = point%nrm
        edge%length(np) = norm2(point%tau)*w(g)
        do a = 1, size(ix)
          if (column(ix(a)) > 0) edge%slope(np, column(ix(a))) = point%dnu(a)
        end do
      end do
    end do
  end subroutine collect_edge

  function slope_nodes(model, set) result(nodes)
    !! Nodes of both rows of an edge: they fix its place and slope.
    type(model_type), intent(in), target :: model
    integer, intent(in) :: set
    integer, allocatable :: nodes(:), second(:)

    call rows_of_edge(model, set, nodes, second)
    nodes = [nodes, second]
  end function slope_nodes

  subroutine rows_of_edge(model, set, first, second)
    type(model_type), intent(in), target :: model
    integer, intent(in) :: set
    integer, allocatable, intent(out) :: first(:), second(:)   !! increasing
    integer, pointer, contiguous :: ix(:)
    real(wp), pointer, contiguous :: ce(:, :)
    integer, allocatable :: row(:), on_side(:), behind(:)
    real(wp) :: zero
    integer :: a, e, i

    allocate (row(model%nn), source=3)
    do i = 1, size(model%sets(set)%items)
      e = model%sets(set)%items(i)
      ix => model%mesh%connectivity(e)
      ce => model%mesh%operator(e)
      zero = vanishing*maxval(abs(ce))
      on_side = columns_of_row(model%mesh%degree(1:2, e), model%sets(set)%sides(i), 0)
      behind = columns_of_row(model%mesh%degree(1:2, e), model%sets(set)%sides(i), 1)
      do a = 1, size(ix)
        if (any(abs(ce(a, on_side)) > zero)) then
          row(ix(a)) = 1
        else if (any(abs(ce(a, behind)) > zero)) then
          row(ix(a)) = min(row(ix(a)), 2)
        end if
      end do
    end do
    first = pack([(a, a=1, model%nn)], row == 1)
    second = pack([(a, a=1, model%nn)], row == 2)
  end subroutine rows_of_edge

  pure function columns_of_row(degree, side, behind) result(columns)
    !! Bernstein functions in the row of a side, or `behind` rows from it.
    integer, intent(in) :: degree(2), side, behind
    integer, allocatable :: columns(:)
    integer :: at, k

    if (side <= 2) then
      at = merge(behind, degree(1) - behind, side == 1)
      columns = [(1 + at + k*(degree(1) + 1), k=0, degree(2))]
    else
      at = merge(behind, degree(2) - behind, side == 3)
      columns = [(1 + k + at*(degree(1) + 1), k=0, degree(1))]
    end if
  end function columns_of_row

  subroutine slope_dependence(slope, length, n1, coef, error, status)
    !! The second row as a combination of the first that keeps the slope zero.
    real(wp), intent(in) :: slope(:, :)                 !! R_a,nu (np,n1+n2)
    real(wp), intent(in) :: length(:)                   !! of the points (np)
    integer, intent(in) :: n1                           !! columns that are given
    real(wp), allocatable, intent(out) :: coef(:, :)    !! C (n2,n1)
    real(wp), intent(out) :: error                      !! largest slope that remains, relative to the slopes
    integer, intent(out) :: status                      !! ok; singular_map: the second row cannot set the slope
    real(wp), allocatable :: m(:, :), left(:, :)
    real(wp), parameter :: negligible = 1e-11_wp
    integer :: i, j, k, n2

    n2 = size(slope, 2) - n1
    allocate (left(size(slope, 1), size(slope, 2)), m(n2, n2), coef(n2, n1))
    do k = 1, size(slope, 2)
      left(:, k) = length*slope(:, k)
    end do
    m = matmul(transpose(slope(:, n1 + 1:)), left(:, n1 + 1:))
    coef = -matmul(transpose(slope(:, n1 + 1:)), left(:, 1:n1))
    status = singular_map
    error = 0
    do k = 1, n2                                  ! Cholesky
      do i = 1, k - 1
        m(k, k) = m(k, k) - m(k, i)**2
      end do
      if (.not. m(k, k) > 1e-13_wp*sum(left(:, n1 + k)*slope(:, n1 + k))) return
      m(k, k) = sqrt(m(k, k))
      do j = k + 1, n2
        do i = 1, k - 1
          m(j, k) = m(j, k) - m(j, i)*m(k, i)
        end do
        m(j, k) = m(j, k)/m(k, k)
      end do
    end do
    status = ok
    do k = 1, n1
      do i = 1, n2
        coef(i, k) = (coef(i, k) - dot_product(m(i, :i - 1), coef(:i - 1, k)))/m(i, i)
      end do
      do i = n2, 1, -1
        coef(i, k) = (coef(i, k) - dot_product(m(i + 1:, i), coef(i + 1:, k)))/m(i, i)
      end do
    end do
    where (abs(coef) < negligible) coef = 0
    where (abs(coef - 1) < negligible) coef = 1
    if (size(slope) > 0) error = maxval(abs(slope(:, 1:n1) + matmul(slope(:, n1 + 1:), coef)))/maxval(abs(slope))
  end subroutine slope_dependence

  pure function cross(a, b) result(c)
    real(wp), intent(in) :: a(3), b(3)
    real(wp) :: c(3)

    c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
  end function cross
end module edge_rows
