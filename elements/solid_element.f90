module solid_element
  !! The solid of MATErial as hosts call it: law data from property lines, a Gauss rule, the kernel.
  !!
  !!     ELAStic NEOHook E nu | STVK E nu | ISOTropic E nu     PLANe STRAin | STREss     FINIte [VOLUme 1] | SMALl
  !!     QUADrature n [m k]       Gauss points per direction, degree + 1 if absent
  !!
  !! Its table holds, in this order, dR/dX (ndm,nen,ng) and the volumes of the Gauss points (ng).
  use kinds, only: wp
  use status_codes, only: ok, wrong_dimension
  use user_element, only: element_type, element_geometry, element_state, element_energy, property_record, &
    task_prepare, task_tangent
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use geometry_map, only: physical_gradient
  use material_laws, only: solid_law, define_solid_law, neo_hooke, neo_hooke_quadratic, st_venant, small_strain, &
    plane_strain, plane_stress, three_dimensional
  use solid_kernel, only: bernstein_table, solid_points, solid_tangent, solid_force, solid_cauchy
  implicit none (type, external)
  private
  public :: solid_element_type

  type, extends(element_type) :: solid_element_type
    type(solid_law) :: law
    integer :: gp(3) = 0             !! Gauss points per direction, 0: degree + 1
  contains
    procedure :: define
    procedure :: sizes
    procedure :: evaluate
    procedure :: output_names
    procedure :: output
  end type solid_element_type

  character(*), parameter :: known = 'ELAStic, PLANe, FINIte, SMALl, QUADrature'

contains

  subroutine define(self, ndm, properties, fault, bad_record)
    class(solid_element_type), intent(inout) :: self
    integer, intent(in) :: ndm
    type(property_record), intent(in) :: properties(:)
    character(:), allocatable, intent(out) :: fault
    integer, intent(out) :: bad_record
    integer :: i, kind, mode, status, elastic
    logical :: finite, small

    self%ndm = ndm
    self%ndf = ndm
    self%symmetric = .true.
    kind = 0
    mode = merge(three_dimensional, plane_strain, ndm == 3)
    finite = .false.
    small = .false.
    elastic = 0
    do i = 1, size(properties)
      bad_record = i
      associate (words => properties(i)%words, values => properties(i)%values)
        if (size(words) == 0) then
          fault = 'a property begins with a word. Known properties: '//known
          return
        end if
        select case (words(1))
        case ('elas')
          if (size(words) /= 2 .or. size(values) /= 2) then
            fault = 'write ELAStic, one law (NEOHook, STVK, ISOTropic), then E and nu'
            if (size(words) > 2) fault = fault//'; "'//trim(words(3))//'" is neither a number nor a parameter'
            return
          end if
          elastic = i
          select case (words(2))
          case ('neoh'); kind = neo_hooke
          case ('stvk'); kind = st_venant
          case ('isot'); kind = small_strain
          case default
            fault = 'unknown elastic law "'//words(2)//'". Known laws: NEOHook, STVK, ISOTropic'
            return
          end select
        case ('plan')
          if (ndm == 3) then
            fault = 'PLANe has no meaning in three dimensions; remove it'
            return
          end if
          if (size(words) /= 2) then
            fault = 'write PLANe STRAin or PLANe STREss'
            return
          end if
          select case (words(2))
          case ('stra'); mode = plane_strain
          case ('stre'); mode = plane_stress
          case default
            fault = 'unknown plane state "'//words(2)//'". Known states: STRAin, STREss'
            return
          end select
        case ('fini')
          finite = .true.
          if (size(words) > 1) then
            if (words(2) /= 'volu' .or. size(values) /= 1) then
              fault = 'FINIte takes only VOLUme and a model number'
              return
            end if
            if (abs(values(1) - 1) > 0) then
              fault = 'only VOLUme 1, lambda/4 (J^2 - 1 - 2 ln J), is offered; without it (59) of the paper is used'
              return
            end if
            if (kind == neo_hooke) kind = neo_hooke_quadratic
            if (kind == 0) then
              fault = 'FINIte VOLUme belongs after ELAStic NEOHook'
              return
            end if
          end if
        case ('smal')
          small = .true.
        case ('quad')
          if (size(values) /= 1 .and. size(values) /= ndm .or. any(values < 1) .or. any(abs(values - nint(values)) > 0)) then
            fault = 'QUADrature takes one whole number of Gauss points, or one for each direction'
            return
          end if
          self%gp = nint(values(1))
          if (size(values) == ndm) self%gp(1:ndm) = nint(values)
        case default
          fault = 'unknown property "'//words(1)//'". Known properties: '//known
          return
        end select
      end associate
    end do
    bad_record = elastic
    if (elastic == 0) then
      fault = 'the elastic law is missing: add ELAStic NEOHook E nu (or STVK, ISOTropic)'
    else if (finite .and. kind == small_strain) then
      fault = 'ISOTropic is a law of small strains; with FINIte use NEOHook or STVK'
    else if (small .and. kind /= small_strain) then
      fault = 'NEOHook and STVK are laws of finite strain; with SMALl use ISOTropic'
    else
      call define_solid_law(kind, mode, properties(elastic)%values(1), properties(elastic)%values(2), self%law, status)
      if (status /= ok) fault = 'E must be positive and nu between -1 and 0.5'
    end if
  end subroutine define

  pure subroutine rule_of(self, degree, n)
    !! Gauss points in each direction.
    class(solid_element_type), intent(in) :: self
    integer, intent(in) :: degree(:)
    integer, intent(out) :: n(:)

    n = degree(1:self%ndm) + 1
    where (self%gp(1:self%ndm) > 0) n = self%gp(1:self%ndm)
  end subroutine rule_of

  pure subroutine sizes(self, geo, ntable, nhist)
    class(solid_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    integer, intent(out) :: ntable
    integer, intent(out) :: nhist
    integer :: n(self%ndm)

    call rule_of(self, geo%degree, n)
    ntable = product(n)*(self%ndm*geo%nen + 1)
    nhist = 0
  end subroutine sizes

  pure subroutine evaluate(self, task, geo, state, fe, ke, energy, status)
    class(solid_element_type), intent(in) :: self
    integer, intent(in) :: task
    type(element_geometry), intent(inout) :: geo
    type(element_state), intent(inout) :: state
    real(wp), contiguous, intent(inout) :: fe(:, :)
    real(wp), contiguous, intent(inout) :: ke(:, :, :, :)
    type(element_energy), intent(out) :: energy
    integer, intent(out) :: status
    integer :: n(self%ndm), ng

    call rule_of(self, geo%degree, n)
    ng = product(n)
    if (task == task_prepare .and. geo%dp /= self%ndm) then
      status = wrong_dimension
    else if (task == task_prepare) then
      call prepare(self, geo, n, ng, geo%table, status)
    else
      call from_table(self%law, task, self%ndm, geo%nen, ng, geo%table, state%ue, fe, ke, energy%stored, status)
    end if
  end subroutine evaluate

  pure subroutine prepare(self, geo, n, ng, table, status)
    !! Reference gradients and volumes of the Gauss points.
    class(solid_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    integer, intent(in) :: n(:), ng
    real(wp), intent(inout) :: table((self%ndm*geo%nen + 1)*ng)
    integer, intent(out) :: status
    real(wp) :: xi(self%ndm, ng), wt(ng), bez(size(geo%ce, 2), ng), dbez(self%ndm, size(geo%ce, 2), ng)
    real(wp) :: shp(geo%nen, ng), dshp(self%ndm, geo%nen, ng), dvol(ng)

    call tensor_rule(n, xi, wt)
    call bernstein_table(geo%degree(1:self%ndm), xi, bez, dbez)
    call solid_points(geo%xe, geo%we, geo%ce, bez, dbez, wt, shp, dshp, dvol, status)
    table(1:size(dshp)) = reshape(dshp, [size(dshp)])
    table(size(dshp) + 1:) = dvol
  end subroutine prepare

  pure subroutine from_table(law, task, ndm, nen, ng, table, ue, fe, ke, energy, status)
    !! The kernel on the table's parts.
    type(solid_law), intent(in) :: law
    integer, intent(in) :: task, ndm, nen, ng
    real(wp), intent(in) :: table(ndm*nen*ng + ng)
    real(wp), contiguous, intent(in) :: ue(:, :)
    real(wp), contiguous, intent(inout) :: fe(:, :), ke(:, :, :, :)
    real(wp), intent(out) :: energy
    integer, intent(out) :: status

    if (task == task_tangent) then
      call tangent_of_parts(law, ndm, nen, ng, table, table(ndm*nen*ng + 1), ue, fe, ke, energy, status)
    else
      call force_of_parts(law, ndm, nen, ng, table, table(ndm*nen*ng + 1), ue, fe, energy, status)
    end if
  end subroutine from_table

  pure subroutine tangent_of_parts(law, ndm, nen, ng, dshp, dvol, ue, fe, ke, energy, status)
    type(solid_law), intent(in) :: law
    integer, intent(in) :: ndm, nen, ng
    real(wp), intent(in) :: dshp(ndm, nen, ng), dvol(ng)
    real(wp), contiguous, intent(in) :: ue(:, :)
    real(wp), contiguous, intent(inout) :: fe(:, :), ke(:, :, :, :)
    real(wp), intent(out) :: energy
    integer, intent(out) :: status

    call solid_tangent(dshp, dvol, ue, law, fe, ke, energy, status)
  end subroutine tangent_of_parts

  pure subroutine force_of_parts(law, ndm, nen, ng, dshp, dvol, ue, fe, energy, status)
    type(solid_law), intent(in) :: law
    integer, intent(in) :: ndm, nen, ng
    real(wp), intent(in) :: dshp(ndm, nen, ng), dvol(ng)
    real(wp), contiguous, intent(in) :: ue(:, :)
    real(wp), contiguous, intent(inout) :: fe(:, :)
    real(wp), intent(out) :: energy
    integer, intent(out) :: status

    call solid_force(dshp, dvol, ue, law, fe, energy, status)
  end subroutine force_of_parts

  pure subroutine output_names(self, names)
    class(solid_element_type), intent(in) :: self
    character(24), allocatable, intent(out) :: names(:)  !! Cauchy stress [stress]

    names = [character(24) :: 'stress_xx', 'stress_yy', 'stress_zz', 'stress_xy', 'stress_yz', 'stress_xz']
    if (self%ndm == 0) names = names(1:0)
  end subroutine output_names

  pure subroutine output(self, geo, state, xi, values, status)
    !! Cauchy stress at any points of the element.
    class(solid_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    type(element_state), intent(in) :: state
    real(wp), intent(in) :: xi(:, :)          !! (dp,np)
    real(wp), intent(out) :: values(:, :)     !! (6,np) [stress]
    integer, intent(out) :: status
    real(wp) :: shp(geo%nen), parametric(self%ndm, geo%nen), d2shp(0, 0), dshp(self%ndm, geo%nen, size(xi, 2)), detj
    integer :: g

    do g = 1, size(xi, 2)
      call shape_functions(geo%degree(1:self%ndm), geo%we, geo%ce, xi(:, g), 1, shp, parametric, d2shp, status)
      if (status /= ok) return
      call physical_gradient(geo%xe, parametric, dshp(:, :, g), detj, status)
      if (status /= ok) return
    end do
    call solid_cauchy(dshp, state%ue, self%law, values, status)
  end subroutine output
end module solid_element
