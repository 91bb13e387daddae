program functions
  !! shapes alone: a quarter circle as rational functions.
  use kinds, only: wp
  use rational_basis, only: shape_functions
  implicit none (type, external)
  real(wp) :: ce(3, 3), shp(3), dshp(1, 3), d2shp(1, 3), x(2, 3), at(2)
  integer :: i, status

  ce = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
  x = reshape([1, 0, 1, 1, 0, 1], [2, 3])
  do i = 0, 10
    call shape_functions([2], [1.0_wp, sqrt(0.5_wp), 1.0_wp], ce, [i/10.0_wp], 2, shp, dshp, d2shp, status)
    at = matmul(x, shp)
    if (status /= 0 .or. abs(norm2(at) - 1) > 1e-14_wp) error stop 1
  end do
end program functions
