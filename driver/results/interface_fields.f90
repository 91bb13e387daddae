module interface_fields
  !! Fields of the interface points for results: slave points in their present place with gap, traction and pairing, and
  !! what the interface elements tell of themselves (cohesion: the largest opening and the damage, 0 intact, 1 spent).
  use kinds, only: wp
  use model_data, only: model_type
  use interface_points, only: interface_points_type, place_of_slave
  use user_element, only: element_geometry, element_state
  use result_frame, only: result_field_type
  implicit none (type, external)
  private
  public :: evaluate_interface_fields

  character(24), parameter :: common(5) = [character(24) :: 'gap', 'traction', 'active', 'paired', 'interface']

contains

  subroutine evaluate_interface_fields(model, interfaces, u, points, fields)
    type(model_type), intent(in) :: model
    type(interface_points_type), intent(in), target :: interfaces(:)
    real(wp), intent(in) :: u(:, :)                            !! committed control values (ndf,nn)
    real(wp), allocatable, intent(out) :: points(:, :)         !! (3,n) [length]
    type(result_field_type), allocatable, intent(out) :: fields(:)
    character(24), allocatable :: names(:), own(:)
    type(element_geometry) :: geo
    type(element_state) :: state
    real(wp), allocatable :: x(:, :), values(:, :)
    real(wp) :: xi(model%ndm - 1, 1)
    real(wp), target :: hist(maxval([0, interfaces%nhist]))
    integer :: i, j, k, n, o, status

    allocate (names, source=common)
    n = 0
    do i = 1, size(interfaces)
      n = n + interfaces(i)%np
      call model%interfaces(i)%element%output_names(own)
      do o = 1, size(own)
        if (.not. any(names == own(o))) names = [names, own(o)]
      end do
    end do
    allocate (points(3, n), source=0.0_wp)
    allocate (fields(size(names)))
    do k = 1, size(names)
      fields(k)%name = trim(names(k))
      allocate (fields(k)%values(1, n), source=0.0_wp)
    end do

    x = model%x + u(1:model%ndm, 1:model%nn)
    k = 0
    do i = 1, size(interfaces)
      call model%interfaces(i)%element%output_names(own)
      if (allocated(values)) deallocate (values)
      allocate (values(size(own), 1))
      associate (p => interfaces(i))
        do j = 1, p%np
          k = k + 1
          call place_of_slave(x, p, j, points(1:model%ndm, k))
          fields(1)%values(1, k) = p%gap(j)
          fields(2)%values(1, k) = p%traction(j)
          fields(3)%values(1, k) = merge(1.0_wp, 0.0_wp, p%active(j))
          fields(4)%values(1, k) = merge(1.0_wp, 0.0_wp, p%facet(j) > 0)
          fields(5)%values(1, k) = i
          if (size(own) == 0) cycle
          xi(:, 1) = p%point(:, j)
          hist(1:p%nhist) = p%hist_n(:, j)
          state%hist_n => hist(1:p%nhist)
          call model%interfaces(i)%element%output(geo, state, xi, values, status)
          do o = 1, size(own)
            fields(findloc(names, own(o), 1))%values(1, k) = values(o, 1)
          end do
        end do
      end associate
    end do
  end subroutine evaluate_interface_fields
end module interface_fields
