module c_shells
  !! C interface of the shell kernel, of the joint between shells and of moments on edges; see bezel.h for the arrays.
  !! Nothing is saved between calls.
  use, intrinsic :: iso_c_binding, only: c_int, c_double
  use shell_law, only: shell_law_type, define_shell_law
  use shell_kernel, only: shell_points, shell_tangent, shell_force, n_derivatives, n_frame
  use shell_joint, only: joint_force
  use edge_moment, only: edge_moment_force
  implicit none (type, external)
  private
  public :: c_shell_law, bezel_define_shell_law, bezel_shell_points, bezel_shell_tangent, bezel_shell_force, &
    bezel_joint_force, bezel_edge_moment

  type, bind(c) :: c_shell_law
    !! bezel_shell_law of the header.
    real(c_double) :: c11, c12, c33, nu, thickness
    integer(c_int) :: is_linear
  end type c_shell_law

contains

  function bezel_define_shell_law(e, nu, thickness, is_linear, law) result(status) bind(c)
    real(c_double), value :: e, nu, thickness
    integer(c_int), value :: is_linear
    type(c_shell_law), intent(out) :: law
    integer(c_int) :: status
    type(shell_law_type) :: own

    call define_shell_law(e, nu, thickness, is_linear /= 0, own, status)
    law = c_shell_law(own%c11, own%c12, own%c33, own%nu, own%thickness, merge(1, 0, own%is_linear))
  end function bezel_define_shell_law

  elemental function law_of(law) result(own)
    type(c_shell_law), intent(in) :: law
    type(shell_law_type) :: own

    own%c11 = law%c11
    own%c12 = law%c12
    own%c33 = law%c33
    own%nu = law%nu
    own%thickness = law%thickness
    own%is_linear = law%is_linear /= 0
  end function law_of

  function bezel_shell_points(degree, nen, xe, we, ce, ng, xi, wt, shp, dshp, frame, area) result(status) bind(c)
    integer(c_int), intent(in) :: degree(2)
    integer(c_int), value :: nen
    real(c_double), intent(in) :: xe(3, nen)              !! reference control points
    real(c_double), intent(in) :: we(nen)
    real(c_double), intent(in) :: ce(nen, product(degree + 1))
    integer(c_int), value :: ng
    real(c_double), intent(in) :: xi(2, ng), wt(ng)
    real(c_double), intent(out) :: shp(nen, ng), dshp(n_derivatives, nen, ng), frame(n_frame, ng), area(ng)
    integer(c_int) :: status

    call shell_points(degree, xe, we, ce, xi, wt, shp, dshp, frame, area, status)
  end function bezel_shell_points

  function bezel_shell_tangent(nen, ng, dshp, frame, area, ue, law, fe, ke, energy) result(status) bind(c)
    integer(c_int), value :: nen, ng
    real(c_double), intent(in) :: dshp(n_derivatives, nen, ng), frame(n_frame, ng), area(ng)
    real(c_double), intent(in) :: ue(3, nen)
    type(c_shell_law), intent(in) :: law
    real(c_double), intent(out) :: fe(3, nen)
    real(c_double), intent(inout) :: ke(3, nen, 3, nen)   !! blocks a >= b
    real(c_double), intent(out) :: energy
    integer(c_int) :: status

    call shell_tangent(dshp, frame, area, ue, law_of(law), fe, ke, energy, status)
  end function bezel_shell_tangent

  function bezel_shell_force(nen, ng, dshp, frame, area, ue, law, fe, energy) result(status) bind(c)
    integer(c_int), value :: nen, ng
    real(c_double), intent(in) :: dshp(n_derivatives, nen, ng), frame(n_frame, ng), area(ng)
    real(c_double), intent(in) :: ue(3, nen)
    type(c_shell_law), intent(in) :: law
    real(c_double), intent(out) :: fe(3, nen)
    real(c_double), intent(out) :: energy
    integer(c_int) :: status

    call shell_force(dshp, frame, area, ue, law_of(law), fe, energy, status)
  end function bezel_shell_force

  function bezel_joint_force(nen, ng, dshp, start, length, cos_0, sin_0, stiffness, is_linear, ue, fe, ke, energy) &
      result(status) bind(c)
    integer(c_int), value :: nen, ng
    real(c_double), intent(in) :: dshp(3, nen, ng)        !! along the conormals of both sides, along the edge
    real(c_double), intent(in) :: start(3, 3, ng)         !! these three tangents at the start
    real(c_double), intent(in) :: length(ng), cos_0(ng), sin_0(ng)
    real(c_double), value :: stiffness
    integer(c_int), value :: is_linear
    real(c_double), intent(in) :: ue(3, nen)
    real(c_double), intent(out) :: fe(3, nen)
    real(c_double), intent(inout) :: ke(3, nen, 3, nen)   !! blocks a >= b
    real(c_double), intent(out) :: energy
    integer(c_int) :: status

    call joint_force(dshp, start, length, cos_0, sin_0, stiffness, is_linear /= 0, ue, fe, ke, energy, status)
  end function bezel_joint_force

  function bezel_edge_moment(side, nen, ng, xe, ue, dshp, length, moment, fe, ke) result(status) bind(c)
    integer(c_int), value :: side, nen, ng
    real(c_double), intent(in) :: xe(3, nen), ue(3, nen)
    real(c_double), intent(in) :: dshp(2, nen, ng)        !! R_,1 and R_,2 at points of the edge
    real(c_double), intent(in) :: length(ng)
    real(c_double), value :: moment
    real(c_double), intent(out) :: fe(3, nen)
    real(c_double), intent(out) :: ke(3, nen, 3, nen)     !! unsymmetric, all blocks
    integer(c_int) :: status

    call edge_moment_force(side, xe, ue, dshp, length, moment, fe, ke, status)
  end function bezel_edge_moment
end module c_shells
