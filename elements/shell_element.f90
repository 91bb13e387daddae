module shell_element
  !! The shell of MATErial as hosts call it: law data from property lines, a Gauss rule, the kernel.
  !!
  !!     ELAStic STVK E nu | ISOTropic E nu     THICkness t [POINts n]     FINIte | SMALl
  !!     QUADrature n [m]         Gauss points per direction, degree + 1 if absent
  !!     LAYEr z                  one more layer with stresses as results, -1 (bottom) to 1 (top)
  !!
  !! Its table holds, in this order, the derivatives (5,nen,ng), the frames of the start (15,ng) and the areas (ng).
  use kinds, only: wp
  use status_codes, only: ok
  use user_element, only: element_type, element_geometry, element_state, element_energy, property_record, &
    task_prepare, task_tangent
  use gauss_rules, only: tensor_rule
  use shell_law, only: shell_law_type, define_shell_law, most_points
  use shell_section, only: section_type, section_of
  use shell_kernel, only: shell_state, shell_points, shell_tangent, shell_force, shell_state_at, curvature_at_start, &
    n_derivatives, n_frame
  use shell_stress, only: membrane_force, bending_moment, layer_cauchy, von_mises
  implicit none (type, external)
  private
  public :: shell_element_type

  type, extends(element_type) :: shell_element_type
    type(shell_law_type) :: law
    integer :: gp(2) = 0               !! Gauss points per direction, 0: degree + 1
    real(wp), allocatable :: layers(:) !! that stresses are told of, -1 to 1
  contains
    procedure :: define
    procedure :: sizes
    procedure :: evaluate
    procedure :: shell_facts
    procedure :: shell_thickness
    procedure :: output_names
    procedure :: output
  end type shell_element_type

  character(*), parameter :: known = 'ELAStic, THICkness, FINIte, SMALl, QUADrature, LAYEr'
  character(2), parameter :: tensor_part(6) = ['xx', 'yy', 'zz', 'xy', 'yz', 'xz']

contains

  subroutine define(self, ndm, properties, fault, bad_record)
    class(shell_element_type), intent(inout) :: self
    integer, intent(in) :: ndm
    type(property_record), intent(in) :: properties(:)
    character(:), allocatable, intent(out) :: fault
    integer, intent(out) :: bad_record
    integer :: i, status, elastic, thick, points
    logical :: finite, small, is_linear

    self%ndm = 3
    self%ndf = 3
    self%dp = 2
    self%smoothness = 1
    self%symmetric = .true.
    self%layers = [0.0_wp, 1.0_wp, -1.0_wp]
    is_linear = .false.
    finite = .false.
    small = .false.
    elastic = 0
    thick = 0
    points = 0
    bad_record = 0
    if (ndm /= 3) then
      fault = 'a shell lives in three dimensions: ndm is 3'
      return
    end if
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
            fault = 'write ELAStic, one law (STVK, ISOTropic), then E and nu'
            if (size(words) > 2) fault = fault//'; "'//trim(words(3))//'" is neither a number nor a parameter'
            return
          end if
          elastic = i
          select case (words(2))
          case ('stvk'); is_linear = .false.
          case ('isot'); is_linear = .true.
          case default
            fault = 'unknown elastic law "'//words(2)//'" of a shell. Known laws: STVK, ISOTropic'
            return
          end select
        case ('thic')
          thick = i
          if (size(values) /= size(words) .or. size(words) > 2) then
            fault = 'write THICkness and one number, then, if the law is to be integrated by points, POINts and their number'
            return
          end if
          if (.not. values(1) > 0) then
            fault = 'the thickness of a shell must be positive'
            return
          end if
          points = 0
          if (size(words) == 2) then
            if (words(2) /= 'poin' .or. values(2) < 2 .or. values(2) > most_points .or. abs(values(2) - nint(values(2))) > 0) then
              fault = 'POINts takes a whole number of Gauss points over the thickness, 2 to 20'
              return
            end if
            points = nint(values(2))
          end if
        case ('fini'); finite = .true.
        case ('smal'); small = .true.
        case ('quad')
          if (size(values) /= 1 .and. size(values) /= 2 .or. any(values < 1) .or. any(abs(values - nint(values)) > 0)) then
            fault = 'QUADrature takes one whole number of Gauss points, or one for each direction'
            return
          end if
          self%gp = nint(values(1))
          if (size(values) == 2) self%gp = nint(values)
        case ('laye')
          if (size(values) /= 1 .or. any(abs(values) > 1)) then
            fault = 'LAYEr takes one height from -1 (bottom) to 1 (top)'
            return
          end if
          self%layers = [0.0_wp, 1.0_wp, -1.0_wp, values]
        case default
          fault = 'unknown property "'//words(1)//'". Known properties: '//known
          return
        end select
      end associate
    end do
    bad_record = elastic
    if (elastic == 0) then
      fault = 'the elastic law is missing: add ELAStic STVK E nu (or ISOTropic)'
    else if (thick == 0) then
      bad_record = 0
      fault = 'the thickness of the shell is missing: add THICkness t'
    else if (finite .and. is_linear) then
      fault = 'ISOTropic is a law of small strains; with FINIte use STVK'
    else if (small .and. .not. is_linear) then
      fault = 'STVK is a law of finite displacements; with SMALl use ISOTropic'
    else
      call define_shell_law(properties(elastic)%values(1), properties(elastic)%values(2), properties(thick)%values(1), &
        is_linear, self%law, status)
      call self%law%integrate_by_points(points)
      if (status /= ok) fault = 'E must be positive and nu between -1 and 0.5'
    end if
  end subroutine define

  pure subroutine rule_of(self, degree, n)
    !! Gauss points in each direction.
    class(shell_element_type), intent(in) :: self
    integer, intent(in) :: degree(:)
    integer, intent(out) :: n(2)

    n = degree(1:2) + 1
    where (self%gp > 0) n = self%gp
  end subroutine rule_of

  pure subroutine sizes(self, geo, ntable, nhist)
    class(shell_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    integer, intent(out) :: ntable
    integer, intent(out) :: nhist
    integer :: n(2)

    call rule_of(self, geo%degree, n)
    ntable = product(n)*(n_derivatives*geo%nen + n_frame + 1)
    nhist = 0
  end subroutine sizes

  pure subroutine evaluate(self, task, geo, state, fe, ke, energy, status)
    class(shell_element_type), intent(in) :: self
    integer, intent(in) :: task
    type(element_geometry), intent(inout) :: geo
    type(element_state), intent(inout) :: state
    real(wp), contiguous, intent(inout) :: fe(:, :)
    real(wp), contiguous, intent(inout) :: ke(:, :, :, :)
    type(element_energy), intent(out) :: energy
    integer, intent(out) :: status
    integer :: n(2), ng, size_of_table

    call rule_of(self, geo%degree, n)
    ng = product(n)
    size_of_table = ng*(n_derivatives*geo%nen + n_frame + 1)
    if (task == task_prepare) then
      call prepare(geo, self%law, n, ng, size_of_table, geo%table, status)
    else
      call from_table(self%law, task, geo%nen, ng, size_of_table, geo%table, state%ue, fe, ke, energy%stored, status)
    end if
  end subroutine evaluate

  pure subroutine prepare(geo, law, n, ng, size_of_table, table, status)
    !! What does not change while the mesh stands.
    type(element_geometry), intent(in) :: geo
    type(shell_law_type), intent(in) :: law
    integer, intent(in) :: n(2), ng, size_of_table
    real(wp), intent(inout) :: table(size_of_table)
    integer, intent(out) :: status
    real(wp) :: xi(2, ng), wt(ng), shp(geo%nen, ng)
    real(wp) :: dshp(n_derivatives, geo%nen, ng), frame(n_frame, ng), area(ng)
    type(section_type) :: section
    integer :: g

    call tensor_rule(n, xi, wt)
    call shell_points(geo%degree(1:2), geo%xe, geo%we, geo%ce, xi, wt, shp, dshp, frame, area, status)
    if (status /= ok) return
    if (law%points > 0) then
      do g = 1, ng
        call section_of(law, curvature_at_start(frame(:, g)), section, status)
        if (status /= ok) return
      end do
    end if
    table(1:size(dshp)) = reshape(dshp, [size(dshp)])
    table(size(dshp) + 1:size(dshp) + size(frame)) = reshape(frame, [size(frame)])
    table(size_of_table - ng + 1:) = area
  end subroutine prepare

  pure subroutine from_table(law, task, nen, ng, size_of_table, table, ue, fe, ke, energy, status)
    !! The kernel on the table's parts.
    type(shell_law_type), intent(in) :: law
    integer, intent(in) :: task, nen, ng, size_of_table
    real(wp), intent(in) :: table(size_of_table)
    real(wp), contiguous, intent(in) :: ue(:, :)
    real(wp), contiguous, intent(inout) :: fe(:, :), ke(:, :, :, :)
    real(wp), intent(out) :: energy
    integer, intent(out) :: status
    integer :: frames, areas

    frames = n_derivatives*nen*ng + 1
    areas = frames + n_frame*ng
    if (task == task_tangent) then
      call tangent_of_parts(law, nen, ng, table, table(frames), table(areas), ue, fe, ke, energy, status)
    else
      call force_of_parts(law, nen, ng, table, table(frames), table(areas), ue, fe, energy, status)
    end if
  end subroutine from_table

  pure subroutine tangent_of_parts(law, nen, ng, dshp, frame, area, ue, fe, ke, energy, status)
    type(shell_law_type), intent(in) :: law
    integer, intent(in) :: nen, ng
    real(wp), intent(in) :: dshp(n_derivatives, nen, ng), frame(n_frame, ng), area(ng)
    real(wp), contiguous, intent(in) :: ue(:, :)
    real(wp), contiguous, intent(inout) :: fe(:, :), ke(:, :, :, :)
    real(wp), intent(out) :: energy
    integer, intent(out) :: status

    call shell_tangent(dshp, frame, area, ue, law, fe, ke, energy, status)
  end subroutine tangent_of_parts

  pure subroutine force_of_parts(law, nen, ng, dshp, frame, area, ue, fe, energy, status)
    type(shell_law_type), intent(in) :: law
    integer, intent(in) :: nen, ng
    real(wp), intent(in) :: dshp(n_derivatives, nen, ng), frame(n_frame, ng), area(ng)
    real(wp), contiguous, intent(in) :: ue(:, :)
    real(wp), contiguous, intent(inout) :: fe(:, :)
    real(wp), intent(out) :: energy
    integer, intent(out) :: status

    call shell_force(dshp, frame, area, ue, law, fe, energy, status)
  end subroutine force_of_parts

  pure subroutine shell_facts(self, rigidity, is_linear)
    class(shell_element_type), intent(in) :: self
    real(wp), intent(out) :: rigidity     !! E t^3/(12 (1 - nu^2)) [force*length]
    logical, intent(out) :: is_linear     !! small displacements

    rigidity = self%law%c11*self%law%thickness**3/12
    is_linear = self%law%is_linear
  end subroutine shell_facts

  pure function shell_thickness(self) result(thickness)
    class(shell_element_type), intent(in) :: self
    real(wp) :: thickness                 !! [length]

    thickness = self%law%thickness
  end function shell_thickness

  pure subroutine output_names(self, names)
    !! Cauchy stress of the middle, top and bottom (and one more) layer [stress], membrane force [force/length],
    !! moment [force], von Mises stresses [stress].
    class(shell_element_type), intent(in) :: self
    character(24), allocatable, intent(out) :: names(:)
    character(7), parameter :: layer_names(4) = [character(7) :: '', '_top', '_bottom', '_layer']
    integer :: c, l, n

    n = size(self%layers)
    allocate (names(7*n + 12))
    do c = 1, 6
      do l = 1, n
        names(6*(l - 1) + c) = 'stress'//trim(layer_names(l))//'_'//tensor_part(c)
      end do
      names(6*n + c) = 'membrane_force_'//tensor_part(c)
      names(6*n + 6 + c) = 'moment_'//tensor_part(c)
    end do
    do l = 1, n
      names(6*n + 12 + l) = 'mises'//trim(layer_names(l))
    end do
  end subroutine output_names

  pure subroutine output(self, geo, state, xi, values, status)
    class(shell_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    type(element_state), intent(in) :: state
    real(wp), intent(in) :: xi(:, :)          !! (2,np)
    real(wp), intent(out) :: values(:, :)     !! (size(output_names),np)
    integer, intent(out) :: status
    type(shell_state) :: now
    real(wp) :: shp(geo%nen, 1), dshp(n_derivatives, geo%nen, 1), frame(n_frame, 1), area(1), ue(3, geo%nen)
    integer :: g, l, n

    n = size(self%layers)
    ue = state%ue
    do g = 1, size(xi, 2)
      call shell_points(geo%degree(1:2), geo%xe, geo%we, geo%ce, xi(:, g:g), [1.0_wp], shp, dshp, frame, area, status)
      if (status /= ok) return
      call shell_state_at(geo%nen, dshp, frame, ue, self%law%is_linear, now, status)
      if (status /= ok) return
      do l = 1, n
        call layer_cauchy(now, self%law, self%layers(l)*self%law%thickness/2, values(6*l - 5:6*l, g), status)
        if (status /= ok) return
        values(6*n + 12 + l, g) = von_mises(values(6*l - 5:6*l, g))
      end do
      values(6*n + 1:6*n + 6, g) = membrane_force(now, self%law)
      values(6*n + 7:6*n + 12, g) = bending_moment(now, self%law)
    end do
  end subroutine output
end module shell_element
