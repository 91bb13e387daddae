module c_solids
  !! C interface of the solid kernel and of surface loads; see bezel.h for the arrays. Nothing is saved between calls.
  use, intrinsic :: iso_c_binding, only: c_int, c_double
  use material_laws, only: solid_law, define_solid_law, stress_and_tangent
  use solid_kernel, only: bernstein_table, solid_points, solid_tangent, solid_force, solid_cauchy
  use surface_load, only: dead_traction, dead_pressure, follower_pressure, body_force
  use symmetric_tangent, only: mirror
  implicit none (type, external)
  private
  public :: c_solid_law, bezel_define_solid_law, bezel_stress_and_tangent, bezel_solid_points, bezel_solid_tangent, &
    bezel_solid_force, bezel_solid_cauchy, bezel_mirror, bezel_dead_traction, bezel_dead_pressure, &
    bezel_follower_pressure, bezel_body_force

  type, bind(c) :: c_solid_law
    !! bezel_solid_law of the header.
    integer(c_int) :: kind, mode, ndm
    real(c_double) :: e, nu, mu, lambda
  end type c_solid_law

contains

  function bezel_define_solid_law(kind, mode, e, nu, law) result(status) bind(c)
    integer(c_int), value :: kind, mode
    real(c_double), value :: e, nu
    type(c_solid_law), intent(out) :: law
    integer(c_int) :: status
    type(solid_law) :: own

    call define_solid_law(kind, mode, e, nu, own, status)
    law = c_solid_law(own%kind, own%mode, own%ndm, own%e, own%nu, own%mu, own%lambda)
  end function bezel_define_solid_law

  elemental function law_of(law) result(own)
    type(c_solid_law), intent(in) :: law
    type(solid_law) :: own

    own = solid_law(law%kind, law%mode, law%ndm, law%e, law%nu, law%mu, law%lambda)
  end function law_of

  function bezel_stress_and_tangent(law, f, psi, p, a) result(status) bind(c)
    type(c_solid_law), intent(in) :: law
    real(c_double), intent(in) :: f(law%ndm, law%ndm)     !! deformation gradient
    real(c_double), intent(out) :: psi                    !! energy per reference volume
    real(c_double), intent(out) :: p(law%ndm, law%ndm)    !! first Piola stress
    real(c_double), intent(out) :: a(law%ndm, law%ndm, law%ndm, law%ndm)
    integer(c_int) :: status

    call stress_and_tangent(law_of(law), f, psi, p, a, status)
  end function bezel_stress_and_tangent

  function bezel_solid_points(ndm, degree, nen, xe, we, ce, ng, xi, wt, shp, dshp, dvol) result(status) bind(c)
    integer(c_int), value :: ndm
    integer(c_int), intent(in) :: degree(ndm)
    integer(c_int), value :: nen
    real(c_double), intent(in) :: xe(ndm, nen)            !! reference control points
    real(c_double), intent(in) :: we(nen)
    real(c_double), intent(in) :: ce(nen, product(degree + 1))
    integer(c_int), value :: ng                           !! points of the rule
    real(c_double), intent(in) :: xi(ndm, ng), wt(ng)
    real(c_double), intent(out) :: shp(nen, ng), dshp(ndm, nen, ng), dvol(ng)
    integer(c_int) :: status
    real(c_double) :: bez(size(ce, 2), ng), dbez(ndm, size(ce, 2), ng)

    call bernstein_table(degree, xi, bez, dbez)
    call solid_points(xe, we, ce, bez, dbez, wt, shp, dshp, dvol, status)
  end function bezel_solid_points

  function bezel_solid_tangent(ndm, nen, ng, dshp, dvol, ue, law, fe, ke, energy) result(status) bind(c)
    integer(c_int), value :: ndm, nen, ng
    real(c_double), intent(in) :: dshp(ndm, nen, ng), dvol(ng)
    real(c_double), intent(in) :: ue(ndm, nen)
    type(c_solid_law), intent(in) :: law
    real(c_double), intent(out) :: fe(ndm, nen)
    real(c_double), intent(inout) :: ke(ndm, nen, ndm, nen)  !! blocks a >= b
    real(c_double), intent(out) :: energy
    integer(c_int) :: status

    call solid_tangent(dshp, dvol, ue, law_of(law), fe, ke, energy, status)
  end function bezel_solid_tangent

  function bezel_solid_force(ndm, nen, ng, dshp, dvol, ue, law, fe, energy) result(status) bind(c)
    integer(c_int), value :: ndm, nen, ng
    real(c_double), intent(in) :: dshp(ndm, nen, ng), dvol(ng)
    real(c_double), intent(in) :: ue(ndm, nen)
    type(c_solid_law), intent(in) :: law
    real(c_double), intent(out) :: fe(ndm, nen)
    real(c_double), intent(out) :: energy
    integer(c_int) :: status

    call solid_force(dshp, dvol, ue, law_of(law), fe, energy, status)
  end function bezel_solid_force

  function bezel_solid_cauchy(ndm, nen, np, dshp, ue, law, sigma) result(status) bind(c)
    integer(c_int), value :: ndm, nen, np
    real(c_double), intent(in) :: dshp(ndm, nen, np)
    real(c_double), intent(in) :: ue(ndm, nen)
    type(c_solid_law), intent(in) :: law
    real(c_double), intent(out) :: sigma(6, np)
    integer(c_int) :: status

    call solid_cauchy(dshp, ue, law_of(law), sigma, status)
  end function bezel_solid_cauchy

  pure subroutine bezel_mirror(ndf, nen, ke) bind(c)
    integer(c_int), value :: ndf, nen
    real(c_double), intent(inout) :: ke(ndf, nen, ndf, nen)

    call mirror(ke)
  end subroutine bezel_mirror

  pure subroutine bezel_dead_traction(ndm, nen, ng, xe, shp, dshp, wt, traction, fe) bind(c)
    integer(c_int), value :: ndm, nen, ng
    real(c_double), intent(in) :: xe(ndm, nen), shp(nen, ng), dshp(ndm - 1, nen, ng), wt(ng)
    real(c_double), intent(in) :: traction(ndm, ng)
    real(c_double), intent(out) :: fe(ndm, nen)

    call dead_traction(xe, shp, dshp, wt, traction, fe)
  end subroutine bezel_dead_traction

  pure subroutine bezel_dead_pressure(ndm, nen, ng, xe, shp, dshp, wt, pressure, fe) bind(c)
    integer(c_int), value :: ndm, nen, ng
    real(c_double), intent(in) :: xe(ndm, nen), shp(nen, ng), dshp(ndm - 1, nen, ng), wt(ng)
    real(c_double), intent(in) :: pressure(ng)
    real(c_double), intent(out) :: fe(ndm, nen)

    call dead_pressure(xe, shp, dshp, wt, pressure, fe)
  end subroutine bezel_dead_pressure

  pure subroutine bezel_follower_pressure(ndm, nen, ng, xe, ue, shp, dshp, wt, pressure, fe, ke) bind(c)
    integer(c_int), value :: ndm, nen, ng
    real(c_double), intent(in) :: xe(ndm, nen), ue(ndm, nen), shp(nen, ng), dshp(ndm - 1, nen, ng), wt(ng)
    real(c_double), intent(in) :: pressure(ng)
    real(c_double), intent(out) :: fe(ndm, nen)
    real(c_double), intent(out) :: ke(ndm, nen, ndm, nen)  !! unsymmetric, all blocks

    call follower_pressure(xe, ue, shp, dshp, wt, pressure, fe, ke)
  end subroutine bezel_follower_pressure

  pure subroutine bezel_body_force(ndm, nen, ng, shp, dvol, force, fe) bind(c)
    integer(c_int), value :: ndm, nen, ng
    real(c_double), intent(in) :: shp(nen, ng), dvol(ng)
    real(c_double), intent(in) :: force(ndm, ng)
    real(c_double), intent(out) :: fe(ndm, nen)

    call body_force(shp, dvol, force, fe)
  end subroutine bezel_body_force
end module c_solids
