module sphere_target
  !! A sphere to fit surfaces to.
  use kinds, only: wp
  use surface_fit, only: target_surface
  implicit none (type, external)
  private
  public :: sphere_type

  type, extends(target_surface) :: sphere_type
    real(wp) :: centre(3) = 0        !! [length]
    real(wp) :: radius = 1           !! [length]
  contains
    procedure :: closest_to
  end type sphere_type

contains

  pure function closest_to(self, x) result(y)
    class(sphere_type), intent(in) :: self
    real(wp), intent(in) :: x(3)     !! a place other than the centre
    real(wp) :: y(3)

    y = x - self%centre
    y = self%centre + self%radius/norm2(y)*y
  end function closest_to
end module sphere_target
