#!/usr/bin/env bash
# Decks of the solid elements against expected numbers: patch tests, thick cylinder, Cook's membrane, locking.
set -u
. "$BEZEL_SOURCE/tests/history_checks.sh"

# Patch tests: rounding (values of 1e-2, reactions of 10) and what 12 Gauss points leave of rational gradients.
solve explicit patch_explicit
expect explicit inner_ux 0.0391333333333333333 1e-14
expect explicit inner_uy -0.0039 1e-14
expect explicit outline_rx 0 1e-11
expect explicit outline_ry 0 1e-11
solve plane verify/patch_2d
expect plane centre_ux 0.006901721147975517 1e-14
expect plane centre_uy 0.0006917156591861554 1e-14
expect plane outline_rx 0 1e-11
expect plane outline_ry 0 1e-11
solve space verify/patch_3d
expect space centre_ux 0.0033496295098278056 1e-14
expect space centre_uy 0.002295773215892383 1e-14
expect space centre_uz -4.126916004421489e-05 1e-14
expect space faces_rx 0 1e-11
expect space faces_ry 0 1e-11
expect space faces_rz 0 1e-11
solve finite verify/patch_finite
expect finite centre_ux 0.35972973150735826 1e-12
expect finite centre_uy -0.14894000132151694 1e-12
expect finite elastic 0.16420123205562825 1e-12
expect finite outline_rx 0 1e-12
expect finite outline_ry 0 1e-12

# Lame's solution; the tolerances are some times the errors of these meshes (1.4e-13 and 2.8e-9).
solve cylinder verify/thick_cylinder p=4 mesh=8
expect cylinder inner_ux 0.0019066666666666667 1e-12
expect cylinder outer_ux 0.0012133333333333333 1e-12
expect cylinder base_ry -1 1e-9
solve cylinder_L verify/thick_cylinder basis=L p=3 mesh=8
expect cylinder_L inner_ux 0.0019066666666666667 5e-9
expect cylinder_L outer_ux 0.0012133333333333333 5e-9

# Cook's membrane: the published limits have four digits; the singular corner leaves 0.2 % on these meshes.
for basis in N L; do
  solve "cook_$basis" verify/cook basis=$basis p=3 n=32
  expect "cook_$basis" mid_uy 23.97 0.03
  expect "cook_$basis" tip_uy 25.19 0.04
  expect "cook_$basis" left_ry -1 1e-9
done
solve cook_L1 verify/cook basis=L p=1 n=32        # bilinear: 1 to 1.5 % too stiff
expect cook_L1 mid_uy 23.82 0.01

# Nearly incompressible: p = 1 locks (2.40 of 8.06), p = 5 does not; the neo-Hookean panel moves 6.9.
solve lock_1 verify/cook_incompressible basis=L p=1
expect lock_1 tip_uy 2.402 0.001
solve lock_3 verify/cook_incompressible basis=N p=3
expect lock_3 tip_uy 7.896 0.001
solve lock_5 verify/cook_incompressible basis=L p=5
expect lock_5 tip_uy 8.055 0.001
solve neo_3 verify/cook_incompressible law=NEOH basis=N p=3
expect neo_3 tip_uy 6.800 0.001
expect neo_3 left_ry -100 1e-5

echo "$failures failures"
[ $failures -eq 0 ]
