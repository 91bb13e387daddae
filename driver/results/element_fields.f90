module element_fields
  !! What the elements tell about themselves (stresses and the like) at the points of the Bezier cells.
  !!
  !! An element's `output` is evaluated at the (p+1)^dp Gauss points x_g. With the weight function W = sum_b w_b B_b, the
  !! coefficients f_b of
  !!
  !!     f = sum_b w_b B_b f_b / W,    (w f)_b = sum_g (B^-1)_bg W(x_g) f(x_g),    B_gb = B_b(x_g)
  !!
  !! interpolate it there in the element's own rational basis, in which viewers evaluate every point array.
  !!
  !! Names ending in _xx, _yy, _zz, _xy, _yz, _xz become one array of six components in ParaView's order, _x, _y, _z one
  !! of three; components that an element lacks are zero. Other names are scalars. An element without a field has NaN
  !! there, which viewers leave blank.
  use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
  use kinds, only: wp
  use status_codes, only: ok
  use bernstein, only: bernstein_basis, bernstein_1d
  use gauss_rules, only: gauss_legendre, tensor_rule
  use user_element, only: element_geometry, element_state
  use model_data, only: model_type
  use bulk_elements, only: bulk_type
  use bezier_cells, only: bezier_cells_type
  use result_frame, only: result_field_type
  implicit none (type, external)
  private
  public :: evaluate_element_fields, bernstein_coefficients, bernstein_at_gauss_inverse

  character(2), parameter :: tensor_part(6) = ['xx', 'yy', 'zz', 'xy', 'yz', 'xz']
  character(1), parameter :: vector_part(3) = ['x', 'y', 'z']

  type :: name_map
    !! Where the outputs of one material go.
    integer, allocatable :: field(:)        !! number of the field of each output
    integer, allocatable :: component(:)    !! component in it
  end type name_map

  type :: square_matrix
    real(wp), allocatable :: a(:, :)
  end type square_matrix

contains

  subroutine evaluate_element_fields(model, cells, u, un, time, dt, bulk, fields, failures)
    type(model_type), intent(in), target :: model
    type(bezier_cells_type), intent(in) :: cells                      !! of model%mesh
    real(wp), intent(in) :: u(:, :)                                   !! control values (ndf,nn)
    real(wp), intent(in) :: un(:, :)                                  !! those of the last step (ndf,nn)
    real(wp), intent(in) :: time, dt
    type(bulk_type), intent(in), target :: bulk                       !! tables and histories of the elements
    type(result_field_type), allocatable, intent(out) :: fields(:)
    integer, intent(out) :: failures                                  !! elements that could not tell (NaN there)

    type(name_map) :: maps(size(model%materials))
    type(square_matrix), allocatable :: inverse(:)
    type(element_geometry) :: geo
    type(element_state) :: state
    real(wp), allocatable, target :: xe(:, :), we(:), ue(:, :), une(:, :)
    real(wp), allocatable :: xi(:, :), gauss_weight(:), bez(:, :), values(:, :), f(:), wb(:)
    integer, pointer, contiguous :: ix(:)
    integer :: e, m, dp, nb, ndf, no, i, k, g, degree(3), old(3), status
    real(wp) :: unused1(0, 0), unused2(0, 0), blank

    call group_names(model, maps, fields)
    blank = ieee_value(blank, ieee_quiet_nan)
    do i = 1, size(fields)
      k = size(fields(i)%values, 1)
      deallocate (fields(i)%values)
      allocate (fields(i)%values(k, cells%np), source=0.0_wp)
    end do
    failures = 0
    if (size(fields) == 0) return

    allocate (inverse(0:maxval(model%mesh%degree(:, :model%mesh%ne))))
    allocate (xi(0, 0), bez(0, 0))
    old = -1
    do e = 1, model%mesh%ne
      m = model%material_of(e)
      do i = 1, size(fields)
        if (any(maps(m)%field == i)) cycle
        fields(i)%values(:, cells%first(e):cells%first(e+1)-1) = blank
      end do
      no = size(maps(m)%field)
      if (no == 0) cycle

      dp = model%mesh%dp(e)
      degree = model%mesh%degree(:, e)
      nb = model%mesh%nb(e)
      if (any(degree /= old) .or. size(xi, 1) /= dp) then
        old = degree
        deallocate (xi, bez)
        allocate (xi(dp, nb), bez(nb, nb))
        if (allocated(gauss_weight)) deallocate (gauss_weight)
        allocate (gauss_weight(nb))
        call tensor_rule(degree(:dp) + 1, xi, gauss_weight)
        do g = 1, nb
          call bernstein_basis(degree(:dp), xi(:, g), 0, bez(:, g), unused1, unused2)
        end do
        do k = 1, dp
          if (.not. allocated(inverse(degree(k))%a)) &
            call bernstein_at_gauss_inverse(degree(k), inverse(degree(k))%a)
        end do
      end if

      ix => model%mesh%connectivity(e)
      ndf = min(model%materials(m)%element%ndf, size(u, 1))
      xe = model%x(:, ix)
      we = model%w(ix)
      ue = u(:ndf, ix)
      une = un(:ndf, ix)
      geo%ndm = model%ndm
      geo%dp = dp
      geo%nen = size(ix)
      geo%degree = degree
      geo%xe => xe
      geo%we => we
      geo%ce => model%mesh%operator(e)
      state%ue => ue
      state%un => une
      state%time = time
      state%dt = dt
      geo%table => bulk%table(bulk%table_ptr(e) + 1:bulk%table_ptr(e + 1))
      state%hist => bulk%hist_n(bulk%hist_ptr(e) + 1:bulk%hist_ptr(e + 1))
      state%hist_n => state%hist

      if (allocated(values)) deallocate (values)
      allocate (values(no, nb))
      call model%materials(m)%element%output(geo, state, xi, values, status)
      if (status /= ok) then
        failures = failures + 1
        do i = 1, no
          fields(maps(m)%field(i))%values(:, cells%first(e):cells%first(e+1)-1) = blank
        end do
        cycle
      end if

      ! the weights of the cell, back in tensor order
      if (allocated(wb)) deallocate (wb)
      allocate (wb(nb))
      do k = cells%first(e), cells%first(e+1) - 1
        wb(cells%place(k)) = cells%weights(k)
      end do
      do g = 1, nb
        values(:, g) = values(:, g)*dot_product(wb, bez(:, g))
      end do
      do i = 1, no
        f = values(i, :)
        do k = 1, dp
          call bernstein_coefficients(inverse(degree(k))%a, product(degree(:k-1) + 1), f)
        end do
        do k = cells%first(e), cells%first(e+1) - 1
          fields(maps(m)%field(i))%values(maps(m)%component(i), k) = f(cells%place(k))/cells%weights(k)
        end do
      end do
    end do
  end subroutine evaluate_element_fields

  pure subroutine bernstein_coefficients(inverse, stride, f)
    !! Values at Gauss points become Bernstein coefficients, in one direction of a tensor-product array.
    real(wp), intent(in) :: inverse(:, :)    !! of the direction (p+1,p+1)
    integer, intent(in) :: stride            !! product of p+1 over the faster directions
    real(wp), intent(inout) :: f(:)

    real(wp) :: line(size(inverse, 1))
    integer :: n, first, i, k

    n = size(inverse, 1)
    do first = 1, size(f), n*stride
      do i = first, first + stride - 1
        line = f(i:i+(n-1)*stride:stride)
        do k = 1, n
          f(i+(k-1)*stride) = dot_product(inverse(k, :), line)
        end do
      end do
    end do
  end subroutine bernstein_coefficients

  pure subroutine bernstein_at_gauss_inverse(p, inverse)
    !! Inverse of B_gb = B_b(x_g) by elimination with row exchange.
    integer, intent(in) :: p
    real(wp), allocatable, intent(out) :: inverse(:, :)    !! (p+1,p+1)

    real(wp) :: a(p + 1, 2*(p + 1)), x(p + 1), w(p + 1), b(p + 1), row(2*(p + 1))
    integer :: n, i, k, pivot

    n = p + 1
    call gauss_legendre(n, x, w)
    a = 0
    do i = 1, n
      call bernstein_1d(p, x(i), b)
      a(i, :n) = b
      a(i, n+i) = 1
    end do
    do k = 1, n
      pivot = k - 1 + maxloc(abs(a(k:, k)), 1)
      row = a(pivot, :)
      a(pivot, :) = a(k, :)
      a(k, :) = row/row(k)
      do i = 1, n
        if (i /= k) a(i, :) = a(i, :) - a(i, k)*a(k, :)
      end do
    end do
    inverse = a(:, n+1:)
  end subroutine bernstein_at_gauss_inverse

  subroutine group_names(model, maps, fields)
    !! One list of fields for all materials; `values` comes with the number of components and no points.
    type(model_type), intent(in) :: model
    type(name_map), intent(out) :: maps(:)
    type(result_field_type), allocatable, intent(out) :: fields(:)

    type(result_field_type), allocatable :: longer(:)
    character(24), allocatable :: names(:)
    character(:), allocatable :: base
    integer :: m, i, k, components, component

    allocate (fields(0))
    do m = 1, size(model%materials)
      call model%materials(m)%element%output_names(names)
      allocate (maps(m)%field(size(names)), maps(m)%component(size(names)))
      do i = 1, size(names)
        call split_name(trim(names(i)), base, components, component)
        do k = 1, size(fields)
          if (fields(k)%name == base .and. size(fields(k)%values, 1) == components) exit
        end do
        if (k > size(fields)) then
          allocate (longer(k))
          longer(:k-1) = fields
          longer(k)%name = base
          allocate (longer(k)%values(components, 0))
          call move_alloc(longer, fields)
        end if
        maps(m)%field(i) = k
        maps(m)%component(i) = component
      end do
    end do
  end subroutine group_names

  pure subroutine split_name(name, base, components, component)
    character(*), intent(in) :: name                       !! stress_xy
    character(:), allocatable, intent(out) :: base         !! stress
    integer, intent(out) :: components, component          !! 6, 4

    integer :: bar, i

    base = name
    components = 1
    component = 1
    bar = index(name, '_', back=.true.)
    if (bar < 2) return
    do i = 1, 6
      if (name(bar+1:) /= tensor_part(i)) cycle
      base = name(:bar-1)
      components = 6
      component = i
    end do
    do i = 1, 3
      if (name(bar+1:) /= vector_part(i)) cycle
      base = name(:bar-1)
      components = 3
      component = i
    end do
    if (base == 'sigma') base = 'stress'
  end subroutine split_name
end module element_fields
