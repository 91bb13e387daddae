subroutine umacr1(lct, ctl)
  !! Solution command PAIR: every slave point of every interface is paired with the nearest point of its master surface in
  !! the present position; the profile is renewed when elements have got other nodes. Once for each TANG, before it.
  use kinds, only: wp
  use feap_arrays, only: positions, store_nodes_of, renew_profile
  use feap_contact, only: interface_count, pair_interfaces, point_range, pair_nodes
  implicit none
  character(15), intent(in) :: lct
  real(wp), intent(in) :: ctl(3)
  include 'umac1.h'
  real(wp), allocatable :: x_ref(:, :), x(:, :)
  integer, allocatable :: nodes(:)
  integer :: n, e, first, last
  logical :: changed, any_changed
  logical, external :: pcomp

  if (pcomp(uct, 'mac1', 4)) then
    uct = 'pair'
    return
  end if
  if (urest /= 0) return                  ! after a restart the points are paired anew
  call positions(x_ref, x)
  call pair_interfaces(x)
  any_changed = .false.
  do n = 1, interface_count()
    call point_range(n, first, last)
    do e = first, last
      call pair_nodes(e, nodes)
      call store_nodes_of(e, nodes, changed)
      any_changed = any_changed .or. changed
    end do
  end do
  if (any_changed) call renew_profile()
end subroutine umacr1
