module packed_pairs
  !! Packed order of second derivatives and symmetric tensors in 1, 2 and 3 dimensions (ParaView's
  !! order): 11 | 11,22,12 | 11,22,33,12,23,13.
  implicit none (type, external)
  private
  public :: pair_i, pair_j, packed

  !> first and second index of packed component m in dimension d: pair_i(m,d), pair_j(m,d)
  integer, parameter :: pair_i(6,3) = reshape([1,0,0,0,0,0, 1,2,1,0,0,0, 1,2,3,1,2,1], [6,3])
  integer, parameter :: pair_j(6,3) = reshape([1,0,0,0,0,0, 1,2,2,0,0,0, 1,2,3,2,3,3], [6,3])

  !> packed component of the pair (i,j) in dimension d: packed(i,j,d)
  integer, parameter :: packed(3,3,3) = reshape([ &
    1,0,0, 0,0,0, 0,0,0, &
    1,3,0, 3,2,0, 0,0,0, &
    1,4,6, 4,2,5, 6,5,3], [3,3,3])
end module packed_pairs
