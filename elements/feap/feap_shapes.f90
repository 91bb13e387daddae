module feap_shapes
  !! Gauss points and shape functions of elements with extraction operators, in the form of FEAP's arrays: points in
  !! [-1,1], derivatives before the function. quadrNd and interpNd know the routines by their binding names, without `use`,
  !! for the reason that `feap_tasks` tells.
  use, intrinsic :: iso_c_binding, only: c_int, c_double
  use kinds, only: wp
  use status_codes, only: ok, status_text
  use extraction_mesh, only: whole_number
  use gauss_rules, only: tensor_rule
  use rational_basis, only: shape_functions
  use geometry_map, only: physical_gradient
  use feap_host, only: fail
  use feap_mesh, only: mesh, element_of, weights_of, has_operator
  implicit none (type, external)
  private
  public :: spline_points, spline_functions

contains

  subroutine spline_points(number, dp, nel, wanted, room, sg, lint) bind(c, name='bezel_feap_points')
    !! Gauss points of an element; none if it has no operator: degree + 1 in each direction. A material of FEAP's always
    !! has a number, by its own rule if the deck gives none, so that it can only raise this.
    integer(c_int), intent(in) :: number                !! FEAP's element
    integer(c_int), intent(in) :: dp, nel               !! dimension that the calling element has; its nodes
    integer(c_int), intent(in) :: wanted                !! per direction, by the material
    integer(c_int), intent(in) :: room                  !! nodes and points that FEAP's arrays hold
    real(c_double), intent(inout) :: sg(dp + 1, *)     !! places and weight
    integer(c_int), intent(out) :: lint                 !! points, 0: no operator
    real(wp), allocatable :: xi(:, :), wt(:)
    integer :: e, n(dp)

    lint = 0
    if (.not. has_operator(number)) return
    e = element_of(number)
    if (mesh%dp(e) /= dp) call fail('element '//whole_number(number)//' has '//whole_number(mesh%dp(e))// &
      ' parametric directions, its material wants '//whole_number(dp))
    if (mesh%nen(e) /= nel) call fail('element '//whole_number(number)//' has '//whole_number(nel)// &
      ' nodes, its extraction operator '//whole_number(mesh%nen(e))//'. Do not change its nodes by ELEMents')
    n = mesh%degree(1:dp, e) + 1
    n = max(n, wanted)
    lint = product(n)
    if (nel > room .or. lint > room) call fail('element '//whole_number(number)//' has '//whole_number(nel)//' nodes and '// &
      whole_number(lint)//' Gauss points; FEAP''s own elements hold '//whole_number(room)// &
      '. Take BEZSolid for it, which has no limit, or fewer points (QUADrature)')
    allocate (xi(dp, lint), wt(lint))
    call tensor_rule(n, xi, wt)
    sg(1:dp, 1:lint) = 2*xi - 1
    sg(dp + 1, 1:lint) = 2**dp*wt
  end subroutine spline_points

  subroutine spline_functions(number, dp, nel, natural, sg, xl, shp, jac, done) bind(c, name='bezel_feap_functions')
    !! Functions at a point and the volume that belongs to it.
    integer(c_int), intent(in) :: number, dp, nel
    integer(c_int), intent(in) :: natural               !! 1: derivatives by the parameters in [-1,1], not by coordinates
    real(c_double), intent(in) :: sg(dp + 1)           !! place and weight
    real(c_double), intent(in) :: xl(dp, nel)          !! [length]
    real(c_double), intent(inout) :: shp(dp + 1, nel)  !! derivatives, function
    real(c_double), intent(inout) :: jac               !! [length^dp]
    integer(c_int), intent(out) :: done                 !! 0: the element has no operator
    real(wp) :: we(nel), r(nel), dr(dp, nel), d2r(0, 0), drx(dp, nel), detj
    integer :: e, status

    done = 0
    if (.not. has_operator(number)) return
    done = 1
    e = element_of(number)
    call weights_of(mesh%connectivity(e), we)
    call shape_functions(mesh%degree(1:dp, e), we, mesh%operator(e), (1 + sg(1:dp))/2, 1, r, dr, d2r, status)
    if (status == ok) call physical_gradient(xl, dr, drx, detj, status)
    if (status /= ok) call fail('element '//whole_number(number)//': '//status_text(status)// &
      '. Its nodes must have their order in the file, directions turning counter-clockwise')
    jac = detj*sg(dp + 1)/2**dp
    shp(dp + 1, 1:nel) = r
    if (natural == 1) then
      shp(1:dp, 1:nel) = dr/2
    else
      shp(1:dp, 1:nel) = drx
    end if
  end subroutine spline_functions
end module feap_shapes
