#!/usr/bin/env bash
# Decks of shells against expected numbers: the linear obstacle course, large displacements, joints, snap-through.
set -u
failures=0

solve() { # label deck [name=value ...]
  local label=$1 deck=$2 status
  shift 2
  "$BEZEL" "$BEZEL_SOURCE/inputs/verify/$deck.inp" "$@" --out "$label.out" >"$label.txt" 2>&1 </dev/null
  status=$?
  [ $status -eq 0 ] && return
  echo "$label: exit status $status"
  cat "$label.txt"
  failures=$((failures + 1))
}

expect() { # label column expected tolerance [row]: the last row of the history, or that of a step
  awk -F, -v name="$2" -v expected="$3" -v tolerance="$4" -v label="$1" -v step="${5-}" '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) column = i }
    NR > 1 && (step == "" || $1 == step) { found = $column; rows++ }
    END {
      if (!column || !rows) { print label ": no column or row for " name; exit 1 }
      error = found - expected
      if (error < 0) error = -error
      if (!(error <= tolerance)) {
        print label ": " name " expected " expected " found " found " tolerance " tolerance
        exit 1
      }
    }' "$1.out/history.csv" || failures=$((failures + 1))
}

# Limits of refined meshes; the tolerances are those of the literature's digits and of these meshes (below 0.5 %).
solve roof scordelis_lo p=4 n=8
expect roof edge_uz -0.3006 1e-4
expect roof end_rz 39269.908169872416 1e-3       # the weight of the quarter, exactly
solve roof_t scordelis_lo basis=T p=3 n=8
expect roof_t edge_uz -0.3006 2e-4
solve pipe pinched_cylinder p=5 n=16
expect pipe load_uz -1.8248e-5 1e-8
solve dome pinched_hemisphere p=5 n=8
expect dome a_ux 0.0924 2e-4
expect dome b_uy -0.0924 2e-4
# T-splines refined towards the force; the second reaches the pole, a side of no length
solve pipe_t pinched_cylinder basis=T p=5 n=8
expect pipe_t load_uz -1.8248e-5 1e-8
solve dome_t pinched_hemisphere basis=T p=5 n=4
expect dome_t a_ux 0.0924 2e-4

# The elastica: 1.6064, 4.9346 at half load, 3.2894, 6.6996 at full load, and a circle; extension leaves 1e-3.
solve shear cantilever_shear p=4 n=10
expect shear tip_ux -1.6064 5e-4 10
expect shear tip_uz 4.9346 5e-4 10
expect shear tip_ux -3.2894 5e-4
expect shear tip_uz 6.6996 5e-4
expect shear root_rz -4 1e-8
solve roll cantilever_moment p=4 n=16 steps=10
expect roll tip_ux -12 0.01 5
expect roll tip_uz 7.6394 0.01 5
expect roll tip_ux -12 0.01
expect roll tip_uz 0 0.01

# Sze, Liu and Lo 2004, shear-flexible elements: within 0.9 % at each load.
solve hole hemisphere_hole p=4 n=16 steps=4
expect hole a_uy 2.596 0.021 1
expect hole b_ux -3.833 0.034 1
expect hole a_uy 3.406 0.024 2
expect hole b_ux -5.902 0.042 2
expect hole a_uy 3.816 0.027 3
expect hole b_ux -7.234 0.050 3
expect hole a_uy 4.067 0.028
expect hole b_ux -8.178 0.058

# A thick quarter ring, R/t = 5: Winkler's curved beam 0.99399311 with points over the thickness
solve thick curved_beam p=5 t=2 through=5
expect thick tip_uz 0.99399311 1e-7
solve closed curved_beam p=5 t=2
expect closed tip_uz 1.01333333 1e-6

# A ring under pressure, closed forms of St. Venant-Kirchhoff: 2.43382 and 2.05390; bending adds t^2/R^2.
solve follower shell_pressure kind=FOLLower
expect follower ring_uz 2.43382 1e-4
solve dead shell_pressure kind=PRESsure
expect dead ring_uz 2.05390 1e-4

# Joints: a stiff one does not show (0.01 %); a corner keeps its angle: F a^3/(2 EI), F a^3/(3 EI), a = 5, EI = 100.
solve joint shell_joint
expect joint tip_ux -3.2896 5e-4
expect joint tip_uz 6.6996 5e-4
solve corner shell_joint angle=90 F=1e-3 steps=1
expect corner tip_ux 6.25e-4 5e-7
expect corner tip_uz 4.1667e-4 5e-7

# Both ways over the limit point of the panel: the load at w = 15 on the falling branch.
solve panel hinged_panel drive=displacement step=0.05 steps=10
expect panel middle_uz -15 1e-12
expect panel middle_rz -387.53 0.5

echo "shells: $failures failures"
[ $failures -eq 0 ]
