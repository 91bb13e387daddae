module feap_bulk
  !! Elements that fill a body or a surface (solid, shell, ...) as FEAP calls them: any element_type behind the tasks of
  !! an elmtNN. What an element precomputes is kept here, by FEAP's element number.
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use extraction_mesh, only: whole_number
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use geometry_map, only: physical_gradient
  use surface_frame, only: tangent_frame_at
  use user_element, only: element_type, element_geometry, element_state, element_energy, mirror, task_prepare, task_residual, &
    task_tangent
  use feap_host, only: fail
  use feap_materials, only: of_material
  use feap_mesh, only: mesh, element_of, has_operator, weights_of
  implicit none (type, external)
  private
  public :: prepare_element, element_forces, stress_at_points

  type :: element_table
    real(wp), allocatable :: values(:)
    real(wp), allocatable :: we(:)                       !! weights
  end type element_table

  type(element_table), allocatable, target, save :: table(:)   !! by FEAP's element number

contains

  subroutine geometry_of(number, ndm, nel, xl, geo)
    !! Degrees, operator and weights of FEAP's element.
    integer, intent(in) :: number, ndm, nel
    real(wp), intent(in), target :: xl(ndm, nel)           !! reference control points
    type(element_geometry), intent(out) :: geo
    integer :: e

    if (.not. has_operator(number)) call fail('element '//whole_number(number)// &
      ' has no extraction operator. Give it by T-SPline or BEZIer, or take a SOLId material for it')
    e = element_of(number)
    if (mesh%nen(e) /= nel) call fail('element '//whole_number(number)//' has '//whole_number(nel)// &
      ' nodes, its extraction operator '//whole_number(mesh%nen(e))//'. Do not change its nodes by ELEMents')
    geo%ndm = ndm
    geo%dp = mesh%dp(e)
    geo%nen = nel
    geo%degree = mesh%degree(:, e)
    geo%ce => mesh%operator(e)
    geo%xe => xl
    geo%we => table(number)%we
    geo%table => table(number)%values
  end subroutine geometry_of

  subroutine prepare_element(number, material, ndm, nel, xl, numel)
    !! What does not change while the mesh stands.
    integer, intent(in) :: number, material, ndm, nel, numel
    real(wp), intent(in), target :: xl(ndm, nel)
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energy
    real(wp) :: fe(0, 0), ke(0, 0, 0, 0)
    integer :: n, nhist, status

    if (.not. allocated(table)) allocate (table(numel))
    if (allocated(table(number)%values)) deallocate (table(number)%values, table(number)%we)
    call geometry_of(number, ndm, nel, xl, geo)
    call of_material(material)%element%sizes(geo, n, nhist)
    allocate (table(number)%values(n), table(number)%we(nel))
    call weights_of(mesh%connectivity(element_of(number)), table(number)%we)
    geo%we => table(number)%we
    geo%table => table(number)%values
    call of_material(material)%element%evaluate(task_prepare, geo, state, fe, ke, energy, status)
    if (status /= ok) call fail('element '//whole_number(number)//': '//status_text(status)// &
      '. Its nodes must have their order in the file, directions turning counter-clockwise')
  end subroutine prepare_element

  subroutine element_forces(number, material, want_tangent, ndf, ndm, nel, nst, xl, ul, s, p, energy)
    !! FEAP's p = -fe and s = ke.
    integer, intent(in) :: number, material
    logical, intent(in) :: want_tangent
    integer, intent(in) :: ndf, ndm, nel, nst
    real(wp), intent(in), target :: xl(ndm, nel)
    real(wp), intent(in), target :: ul(ndf*nel)            !! total displacements
    real(wp), intent(inout), target :: s(nst*nst), p(nst)
    real(wp), intent(out) :: energy                        !! stored
    type(element_geometry) :: geo
    type(element_state) :: state
    type(element_energy) :: energies
    real(wp), pointer, contiguous :: fe(:, :), ke(:, :, :, :)
    integer :: status, n

    call geometry_of(number, ndm, nel, xl, geo)
    associate (element => of_material(material)%element)
      n = element%ndf*nel
      if (n == nst .and. element%ndf == ndf) then          ! FEAP's arrays are the kernel's
        state%ue(1:ndf, 1:nel) => ul
        state%un => state%ue
        fe(1:ndf, 1:nel) => p
        ke(1:ndf, 1:nel, 1:ndf, 1:nel) => s
        call element%evaluate(merge(task_tangent, task_residual, want_tangent), geo, state, fe, ke, energies, status)
        if (want_tangent .and. element%symmetric) call mirror(ke)
        p = -p
      else
        call forces_by_copy(element, merge(task_tangent, task_residual, want_tangent), geo, ndf, nst, ul, s, p, energies, &
          status)
      end if
    end associate
    energy = energies%stored
    if (status /= ok) call fail('element '//whole_number(number)//': '//status_text(status)//'. Take smaller steps (DT)')
  end subroutine element_forces

  subroutine forces_by_copy(element, task, geo, ndf, nst, ul, s, p, energy, status)
    !! The mesh has room for more nodes or dofs than this element uses.
    class(element_type), intent(in) :: element
    integer, intent(in) :: task
    type(element_geometry), intent(inout) :: geo
    integer, intent(in) :: ndf, nst
    real(wp), intent(in) :: ul(ndf, geo%nen)
    real(wp), intent(inout) :: s(nst, nst), p(nst)
    type(element_energy), intent(out) :: energy
    integer, intent(out) :: status
    real(wp), target :: u(element%ndf, geo%nen)
    real(wp) :: f(element%ndf, geo%nen), k(element%ndf, geo%nen, element%ndf, geo%nen)
    type(element_state) :: state
    integer :: a, b, j, df

    df = element%ndf
    u = ul(1:df, :)
    state%ue => u
    state%un => u
    call element%evaluate(task, geo, state, f, k, energy, status)
    do a = 1, geo%nen
      p(ndf*(a - 1) + 1:ndf*(a - 1) + df) = -f(:, a)
    end do
    if (task /= task_tangent) return
    if (element%symmetric) call mirror(k)
    do b = 1, geo%nen
      do j = 1, df
        do a = 1, geo%nen
          s(ndf*(a - 1) + 1:ndf*(a - 1) + df, ndf*(b - 1) + j) = k(:, a, j, b)
        end do
      end do
    end do
  end subroutine forces_by_copy

  subroutine stress_at_points(number, material, ndf, ndm, nel, xl, ul, x, shp, dvol, stress)
    !! Places, functions, volumes and the element's fields (stresses) at its Gauss points.
    integer, intent(in) :: number, material, ndf, ndm, nel
    real(wp), intent(in), target :: xl(ndm, nel)
    real(wp), intent(in) :: ul(ndf, nel)
    real(wp), allocatable, intent(out) :: x(:, :)            !! (ndm,ng) [length]
    real(wp), allocatable, intent(out) :: shp(:, :)          !! (nel,ng)
    real(wp), allocatable, intent(out) :: dvol(:)            !! (ng)
    real(wp), allocatable, intent(out) :: stress(:, :)       !! (fields,ng)
    type(element_geometry) :: geo
    type(element_state) :: state
    character(24), allocatable :: names(:)
    real(wp), allocatable :: xi(:, :), wt(:)
    real(wp), allocatable, target :: ue(:, :)
    real(wp) :: dshp(mesh%dp(element_of(number)), nel), d2shp(0, 0), dshpx(ndm, nel), detj
    real(wp) :: tau(ndm, mesh%dp(element_of(number))), nrm(ndm)
    integer :: n(3), g, status

    call geometry_of(number, ndm, nel, xl, geo)
    n = geo%degree + 1
    allocate (xi(geo%dp, product(n(1:geo%dp))), wt(product(n(1:geo%dp))))
    call tensor_rule(n(1:geo%dp), xi, wt)
    allocate (x(ndm, size(wt)), shp(nel, size(wt)), dvol(size(wt)))
    do g = 1, size(wt)
      call shape_functions(geo%degree(1:geo%dp), geo%we, geo%ce, xi(:, g), 1, shp(:, g), dshp, d2shp, status)
      if (geo%dp == ndm) then
        x(:, g) = matmul(xl(:, 1:nel), shp(:, g))
        call physical_gradient(xl(:, 1:nel), dshp, dshpx, detj, status)
      else
        call tangent_frame_at(xl(:, 1:nel), shp(:, g), dshp, x(:, g), tau, nrm, detj, status)
      end if
      dvol(g) = wt(g)*detj
    end do
    associate (element => of_material(material)%element)
      allocate (ue, source=ul(1:element%ndf, :))
      state%ue => ue
      state%un => ue
      call element%output_names(names)
      allocate (stress(size(names), size(wt)))
      call element%output(geo, state, xi, stress, status)
    end associate
    if (status /= ok) call fail('element '//whole_number(number)//': '//status_text(status))
  end subroutine stress_at_points
end module feap_bulk
