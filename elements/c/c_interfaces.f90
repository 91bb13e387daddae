module c_interfaces
  !! C interface of the interface law and of the kernels of one slave Gauss point; see bezel.h for the arrays. Nothing
  !! is saved between calls.
  use, intrinsic :: iso_c_binding, only: c_int, c_double
  use interface_law, only: gap_law, gap_response, contact_law, cohesive_law, cohesive_law_of_stiffness, interface_response
  use gpts_kernel, only: gpts_point
  use gpts_corner, only: gpts_corner_point
  implicit none (type, external)
  private
  public :: c_gap_law, c_gap_response, bezel_contact_law, bezel_cohesive_law, bezel_cohesive_law_of_stiffness, &
    bezel_interface_response, bezel_gpts_point, bezel_gpts_corner_point

  type, bind(c) :: c_gap_law
    !! bezel_gap_law of the header.
    real(c_double) :: penalty, p_max, g_max, g_u
    integer(c_int) :: reversible
    real(c_double) :: offset
  end type c_gap_law

  type, bind(c) :: c_gap_response
    !! bezel_gap_response of the header.
    real(c_double) :: gap, traction, slope, opening, penalty_energy, elastic_energy, dissipated, dissipation_slope
  end type c_gap_response

contains

  elemental function law_of(law) result(own)
    type(c_gap_law), intent(in) :: law
    type(gap_law) :: own

    own%penalty = law%penalty
    own%p_max = law%p_max
    own%g_max = law%g_max
    own%g_u = law%g_u
    own%reversible = law%reversible /= 0
    own%offset = law%offset
  end function law_of

  elemental function c_law_of(own) result(law)
    type(gap_law), intent(in) :: own
    type(c_gap_law) :: law

    law = c_gap_law(own%penalty, own%p_max, own%g_max, own%g_u, merge(1, 0, own%reversible), own%offset)
  end function c_law_of

  elemental function c_response_of(own) result(response)
    type(gap_response), intent(in) :: own
    type(c_gap_response) :: response

    response = c_gap_response(own%gap, own%traction, own%slope, own%opening, own%penalty_energy, own%elastic_energy, &
                              own%dissipated, own%dissipation_slope)
  end function c_response_of

  function bezel_contact_law(penalty, law) result(status) bind(c)
    real(c_double), value :: penalty
    type(c_gap_law), intent(out) :: law
    integer(c_int) :: status
    type(gap_law) :: own

    call contact_law(penalty, own, status)
    law = c_law_of(own)
  end function bezel_contact_law

  function bezel_cohesive_law(penalty, p_max, toughness, g_max, law) result(status) bind(c)
    real(c_double), value :: penalty, p_max, toughness, g_max
    type(c_gap_law), intent(out) :: law
    integer(c_int) :: status
    type(gap_law) :: own

    call cohesive_law(penalty, p_max, toughness, g_max, own, status)
    law = c_law_of(own)
  end function bezel_cohesive_law

  function bezel_cohesive_law_of_stiffness(penalty, p_max, toughness, stiffness, law) result(status) bind(c)
    real(c_double), value :: penalty, p_max, toughness, stiffness
    type(c_gap_law), intent(out) :: law
    integer(c_int) :: status
    type(gap_law) :: own

    call cohesive_law_of_stiffness(penalty, p_max, toughness, stiffness, own, status)
    law = c_law_of(own)
  end function bezel_cohesive_law_of_stiffness

  pure subroutine bezel_interface_response(law, gap, opening_n, response) bind(c)
    type(c_gap_law), intent(in) :: law
    real(c_double), value :: gap, opening_n
    type(c_gap_response), intent(out) :: response
    type(gap_response) :: own

    call interface_response(law_of(law), gap, opening_n, own)
    response = c_response_of(own)
  end subroutine bezel_interface_response

  function bezel_gpts_point(ndm, nes, shp_s, xs, nem, shp_m, dshp_m, d2shp_m, xm, side, law, opening_n, wt, &
      want_tangent, response, fe, ke) result(status) bind(c)
    integer(c_int), value :: ndm, nes
    real(c_double), intent(in) :: shp_s(nes), xs(ndm, nes)
    integer(c_int), value :: nem
    real(c_double), intent(in) :: shp_m(nem), dshp_m(ndm - 1, nem), d2shp_m((ndm - 1)*ndm/2, nem), xm(ndm, nem)
    real(c_double), value :: side
    type(c_gap_law), intent(in) :: law
    real(c_double), value :: opening_n, wt
    integer(c_int), value :: want_tangent
    type(c_gap_response), intent(out) :: response
    real(c_double), intent(inout) :: fe(ndm, nes + nem)
    real(c_double), intent(inout) :: ke(ndm, nes + nem, ndm, nes + nem)
    integer(c_int) :: status
    type(gap_response) :: own

    call gpts_point(shp_s, xs, shp_m, dshp_m, d2shp_m, xm, side, law_of(law), opening_n, wt, want_tangent /= 0, own, fe, &
                    ke, status)
    response = c_response_of(own)
  end function bezel_gpts_point

  function bezel_gpts_corner_point(ndm, nes, shp_s, xs, nem, shp_m, dshp_m, d2shp_m, xm, side, held, law, opening_n, &
      wt, want_tangent, response, fe, ke) result(status) bind(c)
    integer(c_int), value :: ndm, nes
    real(c_double), intent(in) :: shp_s(nes), xs(ndm, nes)
    integer(c_int), value :: nem
    real(c_double), intent(in) :: shp_m(nem), dshp_m(ndm - 1, nem), d2shp_m((ndm - 1)*ndm/2, nem), xm(ndm, nem)
    real(c_double), value :: side
    integer(c_int), intent(in) :: held(ndm - 1)
    type(c_gap_law), intent(in) :: law
    real(c_double), value :: opening_n, wt
    integer(c_int), value :: want_tangent
    type(c_gap_response), intent(out) :: response
    real(c_double), intent(inout) :: fe(ndm, nes + nem)
    real(c_double), intent(inout) :: ke(ndm, nes + nem, ndm, nes + nem)
    integer(c_int) :: status
    type(gap_response) :: own

    call gpts_corner_point(shp_s, xs, shp_m, dshp_m, d2shp_m, xm, side, held /= 0, law_of(law), opening_n, wt, &
                           want_tangent /= 0, own, fe, ke, status)
    response = c_response_of(own)
  end function bezel_gpts_corner_point
end module c_interfaces
