integer, parameter :: size_of_hr = 6000000, size_of_mr = 2000000
real(8) :: hr
integer :: mr
common /comblk/ hr(size_of_hr), mr(size_of_mr)
