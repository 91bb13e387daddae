! What interp1d, interp2d and interp3d share.

integer function present_element()
  ! Number of the element that FEAP works on. In interpNd a dummy has the name of a variable of this common.
  implicit none
  include 'eldata.h'

  present_element = n_el
end function present_element

subroutine refuse_element(number, text)
  use extraction_mesh, only: whole_number
  use feap_host, only: fail
  implicit none
  integer, intent(in) :: number           ! FEAP's element
  character(*), intent(in) :: text        ! why, and what to do

  call fail('element '//whole_number(number)//': '//text)
end subroutine refuse_element
