program host
  !! Runs a deck of inputs/feap: host DECK; host DECK time: what a call of elmt01 costs.
  use host_deck, only: deck_unit
  use host_mesh, only: read_mesh
  use host_solution, only: solve
  use host_timing, only: time_calls
  implicit none
  include 'iofile.h'
  character(256) :: deck, task
  integer :: code

  call get_command_argument(1, deck)
  iow = 16
  open (iow, status='scratch')
  open (deck_unit, file=deck, status='old', action='read', iostat=code)
  if (code /= 0) error stop 'host: the deck cannot be read'
  call read_mesh()
  call get_command_argument(2, task)
  if (task == 'time') then
    call time_calls()
  else
    call solve()
  end if
end program host
