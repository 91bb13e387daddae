module place_element
  !! An element for tests of results: it has no force, and tells where its points are, stress XX YY ZZ = x y z. With
  !! a negative ndm it tells less.
  use kinds, only: wp
  use status_codes, only: ok
  use bernstein, only: bernstein_basis
  use user_element, only: element_type, element_geometry, element_state, element_energy, property_record
  implicit none (type, external)
  private
  public :: place_element_type

  type, extends(element_type) :: place_element_type
  contains
    procedure :: define
    procedure :: sizes
    procedure :: evaluate
    procedure :: output_names
    procedure :: output
  end type place_element_type

contains

  subroutine define(self, ndm, properties, fault, bad_record)
    class(place_element_type), intent(inout) :: self
    integer, intent(in) :: ndm
    type(property_record), intent(in) :: properties(:)
    character(:), allocatable, intent(out) :: fault
    integer, intent(out) :: bad_record

    self%ndm = ndm
    self%ndf = ndm
    bad_record = size(properties)
    if (bad_record > 0) fault = 'this element has no properties'
  end subroutine define

  pure subroutine sizes(self, geo, ntable, nhist)
    class(place_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    integer, intent(out) :: ntable, nhist

    ntable = 0
    nhist = 0*self%ndm*geo%nen
  end subroutine sizes

  pure subroutine evaluate(self, task, geo, state, fe, ke, energy, status)
    class(place_element_type), intent(in) :: self
    integer, intent(in) :: task
    type(element_geometry), intent(inout) :: geo
    type(element_state), intent(inout) :: state
    real(wp), contiguous, intent(inout) :: fe(:, :), ke(:, :, :, :)
    type(element_energy), intent(out) :: energy
    integer, intent(out) :: status

    fe = 0
    ke = 0
    energy%stored = 0*(task + self%ndm + geo%nen + state%dt)
    status = ok
  end subroutine evaluate

  pure subroutine output_names(self, names)
    class(place_element_type), intent(in) :: self
    character(24), allocatable, intent(out) :: names(:)

    names = [character(24) :: 'sigma_xx', 'sigma_yy', 'sigma_zz', 'sigma_xy', 'ones']
    if (self%ndm < 0) names = names(:1)
  end subroutine output_names

  pure subroutine output(self, geo, state, xi, values, status)
    class(place_element_type), intent(in) :: self
    type(element_geometry), intent(in) :: geo
    type(element_state), intent(in) :: state
    real(wp), intent(in) :: xi(:, :)
    real(wp), intent(out) :: values(:, :)
    integer, intent(out) :: status

    real(wp) :: bez(size(geo%ce, 2)), shp(geo%nen), unused1(0, 0), unused2(0, 0)
    integer :: g

    values = 0
    status = merge(ok, 1, state%dt > 0)
    if (self%ndm < 0) return
    do g = 1, size(xi, 2)
      call bernstein_basis(geo%degree(:geo%dp), xi(:, g), 0, bez, unused1, unused2)
      shp = matmul(geo%ce, bez)*geo%we
      shp = shp/sum(shp)
      values(:self%ndm, g) = matmul(geo%xe, shp)
      values(4, g) = values(1, g) - values(2, g)
      values(5, g) = 1
    end do
  end subroutine output
end module place_element
