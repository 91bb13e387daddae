module bezier_cells
  !! The mesh as VTK's rational Bezier cells. Each cell has its own points: with the extraction operator C and the
  !! control weights w of an element
  !!
  !!     w_b = C^T w,    X_b = (C^T (w X)) / w_b,    f_b = (C^T (w f)) / w_b
  !!
  !! for the geometry and every field f held by control values: exact. Points stand in VTK's order (corners, edges,
  !! faces, interior), which is that of vtkHigherOrderHexahedron in files of version 2.2.
  use, intrinsic :: iso_fortran_env, only: int8
  use kinds, only: wp, i8
  use extraction_set, only: extraction_set_type
  implicit none (type, external)
  private
  public :: bezier_cells_type, vtk_point_order

  integer(int8), parameter :: cell_type(0:3) = [1_int8, 75_int8, 77_int8, 79_int8]
    !! vertex, Bezier curve, quadrilateral, hexahedron

  type :: bezier_cells_type
    !! All that does not change while the mesh stands.
    integer :: nc = 0                               !! cells
    integer :: np = 0                               !! points of all cells
    integer, allocatable :: first(:)                !! cell c has points first(c) .. first(c+1)-1 (nc+1)
    integer, allocatable :: place(:)                !! Bernstein index of each point in its cell (np)
    integer(int8), allocatable :: types(:)          !! VTK's cell types (nc)
    integer(i8), allocatable :: connectivity(:)     !! 0, 1, ..., np-1
    integer(i8), allocatable :: offsets(:)          !! of the cells in the connectivity (nc+1), the first is 0
    real(wp), allocatable :: degrees(:, :)          !! HigherOrderDegrees (3,nc)
    real(wp), allocatable :: weights(:)             !! RationalWeights (np)
    real(wp), allocatable :: points(:, :)           !! (3,np) [length]
    integer, allocatable :: material(:), body(:)    !! ids (nc)
  contains
    procedure :: init
    procedure :: interpolate
  end type bezier_cells_type

contains

  subroutine init(self, mesh, x, w, material, body)
    class(bezier_cells_type), intent(out) :: self
    type(extraction_set_type), intent(in) :: mesh
    real(wp), intent(in) :: x(:, :)          !! reference control points (ndm,nn) [length]
    real(wp), intent(in) :: w(:)             !! control weights (nn)
    integer, intent(in) :: material(:)       !! id of each element (ne)
    integer, intent(in) :: body(:)           !! id of each element (ne)

    integer, allocatable :: order(:)
    real(wp), allocatable :: values(:, :)
    integer :: e, k, nb, old(3)

    self%nc = mesh%ne
    self%material = material(:mesh%ne)
    self%body = body(:mesh%ne)
    allocate (self%first(mesh%ne + 1))
    self%first(1) = 1
    do e = 1, mesh%ne
      self%first(e+1) = self%first(e) + mesh%nb(e)
    end do
    self%np = self%first(mesh%ne+1) - 1
    self%types = cell_type(mesh%dp(:mesh%ne))
    self%degrees = real(mesh%degree(:, :mesh%ne), wp)
    self%offsets = int(self%first - 1, i8)
    self%connectivity = [(int(k, i8), k=0, self%np - 1)]

    allocate (self%place(self%np), order(0))
    old = -1
    do e = 1, mesh%ne
      nb = mesh%nb(e)
      if (any(mesh%degree(:, e) /= old)) then
        deallocate (order)
        allocate (order(nb))
        call vtk_point_order(mesh%degree(:, e), order)
        old = mesh%degree(:, e)
      end if
      self%place(self%first(e):self%first(e+1)-1) = order
    end do

    allocate (self%weights(self%np), self%points(3, self%np))
    call bezier_weights(self, mesh, w)
    call self%interpolate(mesh, w, x, values)
    self%points = values
  end subroutine init

  subroutine bezier_weights(self, mesh, w)
    !! w_b = C^T w
    type(bezier_cells_type), intent(inout) :: self
    type(extraction_set_type), intent(in), target :: mesh
    real(wp), intent(in) :: w(:)

    real(wp), pointer, contiguous :: ce(:, :)
    integer, pointer, contiguous :: ix(:)
    integer :: e, k

    do e = 1, mesh%ne
      ce => mesh%operator(e)
      ix => mesh%connectivity(e)
      do k = self%first(e), self%first(e+1) - 1
        self%weights(k) = dot_product(ce(:, self%place(k)), w(ix))
      end do
    end do
  end subroutine bezier_weights

  subroutine interpolate(self, mesh, w, f, values)
    !! A field of control values at the points of the cells, f_b = (C^T (w f)) / w_b.
    class(bezier_cells_type), intent(in) :: self
    type(extraction_set_type), intent(in), target :: mesh    !! the one of `init`
    real(wp), intent(in) :: w(:)                             !! control weights (nn)
    real(wp), intent(in) :: f(:, :)                          !! control values (components,nn)
    real(wp), allocatable, intent(out) :: values(:, :)       !! (3,np): the first three components, missing ones 0

    real(wp), pointer, contiguous :: ce(:, :)
    integer, pointer, contiguous :: ix(:)
    real(wp) :: sum3(3)
    real(wp), allocatable :: wf(:, :)
    integer :: e, k, a, b, nc

    nc = min(3, size(f, 1))
    allocate (values(3, self%np), wf(3, size(w)))
    wf = 0
    do a = 1, size(w)
      wf(:nc, a) = w(a)*f(:nc, a)
    end do
    do e = 1, mesh%ne
      ce => mesh%operator(e)
      ix => mesh%connectivity(e)
      do k = self%first(e), self%first(e+1) - 1
        b = self%place(k)
        sum3 = 0
        do a = 1, size(ix)
          sum3 = sum3 + ce(a, b)*wf(:, ix(a))
        end do
        ! an operator with an empty column has no control value there
        values(:, k) = 0
        if (abs(self%weights(k)) > 0) values(:, k) = sum3/self%weights(k)
      end do
    end do
  end subroutine interpolate

  subroutine vtk_point_order(degree, order)
    !! Bernstein index (first direction fastest, from 1) of each point of a cell in VTK's order.
    integer, intent(in) :: degree(3)     !! 0 in unused directions
    integer, intent(out) :: order(:)     !! (product(degree+1))

    integer :: n(3), i, j, k, at

    n = degree
    at = 0
    if (n(1) == 0) then
      call add(0, 0, 0)
    else if (n(2) == 0) then
      call add(0, 0, 0)
      call add(n(1), 0, 0)
      do i = 1, n(1) - 1
        call add(i, 0, 0)
      end do
    else if (n(3) == 0) then
      call add_corners(0)
      call add_edges(0)
      do j = 1, n(2) - 1
        do i = 1, n(1) - 1
          call add(i, j, 0)
        end do
      end do
    else
      call add_corners(0)
      call add_corners(n(3))
      call add_edges(0)
      call add_edges(n(3))
      call add_upright(0, 0)
      call add_upright(n(1), 0)
      call add_upright(n(1), n(2))
      call add_upright(0, n(2))
      do i = 0, n(1), n(1)
        do k = 1, n(3) - 1
          do j = 1, n(2) - 1
            call add(i, j, k)
          end do
        end do
      end do
      do j = 0, n(2), n(2)
        do k = 1, n(3) - 1
          do i = 1, n(1) - 1
            call add(i, j, k)
          end do
        end do
      end do
      do k = 0, n(3), n(3)
        do j = 1, n(2) - 1
          do i = 1, n(1) - 1
            call add(i, j, k)
          end do
        end do
      end do
      do k = 1, n(3) - 1
        do j = 1, n(2) - 1
          do i = 1, n(1) - 1
            call add(i, j, k)
          end do
        end do
      end do
    end if

  contains

    subroutine add(i, j, k)
      integer, intent(in) :: i, j, k

      at = at + 1
      order(at) = 1 + i + (n(1) + 1)*(j + (n(2) + 1)*k)
    end subroutine add

    subroutine add_corners(k)
      integer, intent(in) :: k

      call add(0, 0, k)
      call add(n(1), 0, k)
      call add(n(1), n(2), k)
      call add(0, n(2), k)
    end subroutine add_corners

    subroutine add_edges(k)
      !! All edges run upwards.
      integer, intent(in) :: k

      integer :: i, j

      do i = 1, n(1) - 1
        call add(i, 0, k)
      end do
      do j = 1, n(2) - 1
        call add(n(1), j, k)
      end do
      do i = 1, n(1) - 1
        call add(i, n(2), k)
      end do
      do j = 1, n(2) - 1
        call add(0, j, k)
      end do
    end subroutine add_edges

    subroutine add_upright(i, j)
      integer, intent(in) :: i, j

      integer :: k

      do k = 1, n(3) - 1
        call add(i, j, k)
      end do
    end subroutine add_upright
  end subroutine vtk_point_order
end module bezier_cells
