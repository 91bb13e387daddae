module t_mesh_samples
  !! T-meshes to test: curved rational patches, random refinement, and what the functions of a mesh
  !! look like seen from outside (values by the recursion that defines B-splines, ranks).
  use, intrinsic :: ieee_exceptions, only: ieee_all, ieee_set_halting_mode, ieee_get_halting_mode, &
    ieee_set_flag
  use kinds, only: wp
  use status_codes, only: ok
  use knot_vectors, only: knot_vector, open_knot_vector
  use nurbs_patch, only: nurbs_patch_type, create_patch
  use rational_basis, only: shape_functions
  use extraction_set, only: extraction_set_type
  use t_mesh, only: t_mesh_type, create_t_mesh
  use t_refinement, only: refine_cells, split_cells
  use t_spline, only: t_spline_type, t_elements_type
  use facet_samples, only: random_stream, uniform
  implicit none (type, external)
  private
  public :: wavy_patch, plain_mesh, refine_at_random, split_at_random, pick
  public :: function_value, element_at, field_at, rank_of, distance_from_span

  interface
    subroutine dgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
      import :: wp
      character, intent(in) :: jobu, jobvt
      integer, intent(in) :: m, n, lda, ldu, ldvt, lwork
      real(wp), intent(inout) :: a(lda,*)
      real(wp), intent(out) :: s(*), u(ldu,*), vt(ldvt,*), work(*)
      integer, intent(out) :: info
    end subroutine dgesvd
    subroutine dgels(trans, m, n, nrhs, a, lda, b, ldb, work, lwork, info)
      import :: wp
      character, intent(in) :: trans
      integer, intent(in) :: m, n, nrhs, lda, ldb, lwork
      real(wp), intent(inout) :: a(lda,*), b(ldb,*)
      real(wp), intent(out) :: work(*)
      integer, intent(out) :: info
    end subroutine dgels
  end interface

contains

  integer function pick(stream, low, high)
    type(random_stream), intent(inout) :: stream
    integer, intent(in) :: low, high

    pick = min(high, low + int(uniform(stream, 0.0_wp, real(high - low + 1, wp))))
  end function pick

  function wavy_patch(degree, spans, stream) result(patch)
    !! Knots at random distances, control points near (i, j, wave), weights between 1/2 and 2.
    integer, intent(in) :: degree(2)
    integer, intent(in) :: spans(2)
    type(random_stream), intent(inout) :: stream
    type(nurbs_patch_type) :: patch
    type(knot_vector) :: knots(2)
    real(wp), allocatable :: breaks(:), cp(:,:)
    integer :: a, d, i, j, status

    do d = 1, 2
      breaks = [0.0_wp]
      do i = 1, spans(d)
        breaks = [breaks, breaks(i) + uniform(stream, 0.5_wp, 1.5_wp)]
      end do
      knots(d) = open_knot_vector(degree(d), breaks)
    end do
    allocate (cp(4,product(degree+spans)))
    a = 0
    do j = 1, degree(2) + spans(2)
      do i = 1, degree(1) + spans(1)
        a = a + 1
        cp(1,a) = i + uniform(stream, -0.2_wp, 0.2_wp)
        cp(2,a) = j + uniform(stream, -0.2_wp, 0.2_wp)
        cp(3,a) = uniform(stream, -1.0_wp, 1.0_wp)
        cp(4,a) = 2.0_wp**uniform(stream, -1.0_wp, 1.0_wp)
      end do
    end do
    call create_patch(knots, cp, patch, status)
    if (status /= ok) error stop 't_mesh_samples: the patch is bad'
  end function wavy_patch

  function plain_mesh(degree, spans) result(mesh)
    !! Unit cells.
    integer, intent(in) :: degree(2)
    integer, intent(in) :: spans(2)
    type(t_mesh_type) :: mesh
    integer :: i, status

    call create_t_mesh([open_knot_vector(degree(1), [(real(i, wp), i = 0, spans(1))]), &
      open_knot_vector(degree(2), [(real(i, wp), i = 0, spans(2))])], mesh, status)
    if (status /= ok) error stop 't_mesh_samples: the mesh is bad'
  end function plain_mesh

  subroutine refine_at_random(mesh, rounds, most, stream)
    !! Regular refinement of a few random leaves, with a liking for the newest.
    type(t_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: rounds
    integer, intent(in) :: most      !! no more leaves than about this
    type(random_stream), intent(inout) :: stream
    integer, allocatable :: cells(:), marked(:)
    integer :: i, n, round, status

    do round = 1, rounds
      cells = mesh%leaves()
      if (size(cells) > most) exit
      n = pick(stream, 1, 3)
      marked = [(cells(pick(stream, 1, size(cells))), i = 1, n), pick(stream, 1, mesh%n)]
      call refine_cells(mesh, marked, status)
      if (status /= ok) error stop 't_mesh_samples: refinement failed'
    end do
  end subroutine refine_at_random

  subroutine split_at_random(mesh, splits, stream)
    !! Free splits of random leaves.
    type(t_mesh_type), intent(inout) :: mesh
    integer, intent(in) :: splits
    type(random_stream), intent(inout) :: stream
    integer, allocatable :: cells(:)
    integer :: i, halved

    do i = 1, splits
      cells = mesh%leaves()
      call split_cells(mesh, [cells(pick(stream, 1, size(cells)))], pick(stream, 1, 2), halved)
    end do
  end subroutine split_at_random

  real(wp) function function_value(spline, a, x) result(value)
    !! A function from its own knots by the recursion of de Boor and Cox. At the upper end of the
    !! domain 0: keep away from it.
    type(t_spline_type), intent(in) :: spline
    integer, intent(in) :: a
    real(wp), intent(in) :: x(2)
    type(knot_vector) :: kv
    integer :: d, p

    value = 1.0_wp
    do d = 1, 2
      p = spline%degree(d)
      kv = knot_vector(p, spline%knots(1:p+2,d,a))
      if (x(d) < kv%u(1) .or. x(d) >= kv%u(p+2)) value = 0.0_wp
      if (value <= 0.0_wp) return
      value = value * single(kv%u, x(d))
    end do
  end function function_value

  pure recursive real(wp) function single(u, x) result(value)
    real(wp), intent(in) :: u(:), x
    integer :: m

    m = size(u)
    if (m == 2) then
      value = merge(1.0_wp, 0.0_wp, u(1) <= x .and. x < u(2))
      return
    end if
    value = 0.0_wp
    if (u(m-1) > u(1)) value = value + (x - u(1)) / (u(m-1) - u(1)) * single(u(1:m-1), x)
    if (u(m) > u(2)) value = value + (u(m) - x) / (u(m) - u(2)) * single(u(2:m), x)
  end function single

  integer function element_at(elements, x) result(k)
    !! Place in the list of elements of the one that holds a point.
    type(t_elements_type), intent(in) :: elements
    real(wp), intent(in) :: x(2)

    do k = 1, elements%ne
      if (all(elements%lo(:,k) <= x .and. x <= elements%hi(:,k))) return
    end do
    error stop 't_mesh_samples: no element holds the point'
  end function element_at

  subroutine field_at(set, elements, k, values, weights, x, f)
    !! Value, derivatives in the T-mesh's parameters (2), second ones (11,22,12) of a rational field.
    type(extraction_set_type), intent(in), target :: set
    type(t_elements_type), intent(in) :: elements
    integer, intent(in) :: k                       !! place in the list of elements
    real(wp), intent(in) :: values(:), weights(:)  !! of the nodes
    real(wp), intent(in) :: x(2)
    real(wp), intent(out) :: f(6)
    integer, pointer, contiguous :: ix(:)
    real(wp), allocatable :: shp(:), dshp(:,:), d2shp(:,:), we(:)
    real(wp) :: length(2)
    integer :: e, status

    e = elements%first + k - 1
    ix => set%connectivity(e)
    we = weights(ix)
    allocate (shp(size(ix)), dshp(2,size(ix)), d2shp(3,size(ix)))
    length = elements%hi(:,k) - elements%lo(:,k)
    call shape_functions(set%degree(1:2,e), we, set%operator(e), (x - elements%lo(:,k)) / length, 2, &
      shp, dshp, d2shp, status)
    if (status /= ok) error stop 't_mesh_samples: shape functions failed'
    f(1) = dot_product(shp, values(ix))
    f(2:3) = matmul(dshp, values(ix)) / length
    f(4:6) = matmul(d2shp, values(ix)) / [length(1)**2, length(2)**2, product(length)]
  end subroutine field_at

  subroutine rank_of(set, nodes, rank, condition)
    !! Rank of the global operator (functions x Bernstein functions of all elements), singular values
    !! below 1e-10 of the largest counting as zero.
    type(extraction_set_type), intent(in), target :: set
    integer, intent(in) :: nodes
    integer, intent(out) :: rank
    real(wp), intent(out) :: condition     !! largest over smallest singular value
    real(wp), allocatable :: a(:,:), s(:), work(:)
    real(wp) :: none(1,1), unused(1,1)
    logical :: halting(size(ieee_all))
    integer :: e, info, n

    allocate (a(sum([(set%nb(e), e = 1, set%ne)]),nodes), source=0.0_wp)
    n = 0
    do e = 1, set%ne
      a(n+1:n+set%nb(e),set%connectivity(e)) = transpose(set%operator(e))
      n = n + set%nb(e)
    end do
    allocate (s(nodes), work(64*(size(a, 1)+nodes)))
    call unhalted(halting)
    call dgesvd('N', 'N', size(a, 1), nodes, a, size(a, 1), s, none, 1, unused, 1, work, size(work), info)
    call ieee_set_flag(ieee_all, .false.)
    call ieee_set_halting_mode(ieee_all, halting)
    if (info /= 0) error stop 't_mesh_samples: singular values failed'
    rank = count(s > 1e-10_wp * s(1))
    condition = s(1) / s(nodes)
  end subroutine rank_of

  subroutine unhalted(halting)
    !! LAPACK may raise exceptions on the way to good results: debug builds must not stop there.
    logical, intent(out) :: halting(:)     !! to be set again afterwards

    call ieee_get_halting_mode(ieee_all, halting)
    call ieee_set_halting_mode(ieee_all, .false.)
  end subroutine unhalted

  subroutine distance_from_span(fine, elements, set, coarse, worst)
    !! Largest distance of the coarse functions from the span of the fine ones in (p+1)(q+1) inner
    !! points of each fine element, as root mean square over the points.
    type(t_spline_type), intent(in) :: fine
    type(t_elements_type), intent(in) :: elements
    type(extraction_set_type), intent(in), target :: set
    type(t_spline_type), intent(in) :: coarse
    real(wp), intent(out) :: worst
    real(wp), allocatable :: a(:,:), b(:,:), work(:), shp(:), dshp(:,:), d2shp(:,:), we(:)
    integer, pointer, contiguous :: ix(:)
    real(wp) :: xi(2)
    logical :: halting(size(ieee_all))
    integer :: c, i, info, j, k, m, n(2), status

    n = fine%degree + 1
    m = elements%ne * product(n)
    allocate (a(m,fine%n), b(m,coarse%n), source=0.0_wp)
    m = 0
    do k = 1, elements%ne
      ix => set%connectivity(elements%first+k-1)
      we = spread(1.0_wp, 1, size(ix))
      if (allocated(shp)) deallocate (shp, dshp, d2shp)
      allocate (shp(size(ix)), dshp(2,size(ix)), d2shp(3,size(ix)))
      do j = 1, n(2)
        do i = 1, n(1)
          m = m + 1
          xi = [(2 * i - 1) / (2.0_wp * n(1)), (2 * j - 1) / (2.0_wp * n(2))]
          call shape_functions(fine%degree, we, set%operator(elements%first+k-1), xi, 0, shp, dshp, &
            d2shp, status)
          a(m,ix) = shp
          xi = elements%lo(:,k) + xi * (elements%hi(:,k) - elements%lo(:,k))
          do c = 1, coarse%n
            b(m,c) = function_value(coarse, c, xi)
          end do
        end do
      end do
    end do
    allocate (work(64*(size(a, 1)+size(a, 2)+size(b, 2))))
    call unhalted(halting)
    call dgels('N', size(a, 1), size(a, 2), size(b, 2), a, size(a, 1), b, size(b, 1), work, size(work), info)
    call ieee_set_flag(ieee_all, .false.)
    call ieee_set_halting_mode(ieee_all, halting)
    if (info /= 0) error stop 't_mesh_samples: least squares failed'
    worst = maxval(norm2(b(fine%n+1:,:), 1)) / sqrt(real(m, wp))
  end subroutine distance_from_span
end module t_mesh_samples
