logical :: quad, ttfl, nurbfl, vemfl
common /qudshpa/ quad, ttfl, nurbfl, vemfl
integer :: lint, npm, nvn
real(8) :: jac
common /qudshp0/ jac(125), lint, npm, nvn
real(8) :: sg1, shp1, sg2, el2, shp2, sg3, el3, shp3, shpm
common /qudshp1/ sg1(2, 20), shp1(2, 20, 20)
common /qudshp2/ sg2(3, 64), el2(4, 16), shp2(3, 64, 64)
common /qudshp3/ sg3(4, 125), el3(5, 16), shp3(4, 125, 125)
common /qudshpm/ shpm(125, 125)
