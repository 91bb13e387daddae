real(8) :: dm
integer :: n_el, ma, mct, iel, nel, pstyp, eltyp, elty2, elty3
common /eldata/ dm, n_el, ma, mct, iel, nel, pstyp, eltyp, elty2, elty3
