module refinement_zones
  !! Boxes and balls in space with the levels of refinement that elements in them get.
  use kinds, only: wp
  use local_refinement, only: refinement_region
  implicit none (type, external)
  private
  public :: zone_type, zones_type

  type :: zone_type
    integer :: levels = 1
    logical :: is_ball = .false.
    real(wp) :: low(3) = -huge(1.0_wp)       !! of a box [length]
    real(wp) :: high(3) = huge(1.0_wp)
    real(wp) :: centre(3) = 0                !! of a ball [length]
    real(wp) :: radius = 0
  end type zone_type

  type, extends(refinement_region) :: zones_type
    type(zone_type), allocatable :: zones(:)
  contains
    procedure :: add
    procedure :: most_levels
    procedure :: wants
  end type zones_type

contains

  subroutine add(self, zone)
    class(zones_type), intent(inout) :: self
    type(zone_type), intent(in) :: zone

    if (.not. allocated(self%zones)) allocate (self%zones(0))
    self%zones = [self%zones, zone]
  end subroutine add

  pure integer function most_levels(self)
    class(zones_type), intent(in) :: self

    most_levels = 0
    if (allocated(self%zones)) most_levels = maxval([0, self%zones%levels])
  end function most_levels

  pure logical function wants(self, level, x)
    !! Whether the box around the points of a face reaches into one of the zones.
    class(zones_type), intent(in) :: self
    integer, intent(in) :: level
    real(wp), intent(in) :: x(:,:)           !! (3,:) [length]

    real(wp) :: high(3), low(3)
    integer :: k

    wants = .false.
    if (.not. allocated(self%zones)) return
    low = minval(x, 2)
    high = maxval(x, 2)
    do k = 1, size(self%zones)
      associate (zone => self%zones(k))
        if (zone%levels < level) cycle
        if (zone%is_ball) then
          wants = norm2(max(low - zone%centre, 0.0_wp, zone%centre - high)) < zone%radius
        else
          ! no face reaches into an empty box; touching does not count unless the face is flat there
          wants = all(high >= zone%low .and. low <= zone%high) .and. &
            .not. any((high <= zone%low .or. low >= zone%high) .and. high > low)
        end if
      end associate
      if (wants) return
    end do
  end function wants
end module refinement_zones
