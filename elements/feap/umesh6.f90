subroutine umesh6(tx, prt)
  !! Mesh command WEIGhts: records `n ng w` to a blank one, control weights of nodes that COORdinates gave; nodes between
  !! n and that of the next record, ng apart, have weights between the two. Nodes without a weight have 1.
  use kinds, only: wp
  use feap_host, only: fail
  use feap_items, only: item_list, read_items
  use feap_arrays, only: is_counting
  use feap_mesh, only: begin_pass, set_weight
  implicit none
  character(15), intent(in) :: tx(*)      ! FEAP's items: they hold but 15 letters
  logical, intent(in) :: prt              ! whether data are to be printed
  include 'umac1.h'
  type(item_list) :: items
  real(wp) :: w, last_w
  integer :: n, ng, last_n, last_ng, i
  logical, external :: pcomp

  if (pcomp(uct, 'mes6', 4)) then
    uct = 'weig'
    return
  end if
  call begin_pass(is_counting())
  last_ng = 0
  last_n = 0
  last_w = 1
  do
    call read_items(items)
    if (items%n == 0) exit
    if (items%n /= 3) call fail('WEIGhts: records are node, increment, weight: '//items%line)
    n = items%whole(1)
    ng = items%whole(2)
    w = items%number(3)
    if (n < 1 .or. .not. w > 0) call fail('WEIGhts: nodes and weights are positive: '//items%line)
    if (last_ng > 0) then
      do i = last_n + last_ng, n - 1, last_ng
        call set_weight(i, last_w + (w - last_w)*(i - last_n)/(n - last_n))
      end do
    end if
    call set_weight(n, w)
    last_n = n
    last_ng = ng
    last_w = w
  end do
end subroutine umesh6
