character :: uct*4, utx(2)*15
common /umac1/ uct, utx
integer :: urest, unumnd, unumel, unurnd
common /umac2/ urest, unumnd, unumel, unurnd
logical :: ucount
common /umac4/ ucount
