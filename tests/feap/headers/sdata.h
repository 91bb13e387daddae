integer :: ndf, ndm, nen1, nst, nneq, ndl
common /sdata/ ndf, ndm, nen1, nst, nneq, ndl
