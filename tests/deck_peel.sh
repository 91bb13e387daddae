#!/usr/bin/env bash
# Shells in the interface: the contact patch test of mid-surfaces and of faces, a bond that is pulled apart, and the peel of
# square laminae on a mesh of one row against beam theory.
set -u
failures=0

fail() {
  echo "$1"
  failures=$((failures + 1))
}

within() { # what value least most
  awk -v v="$2" -v a="$3" -v b="$4" 'BEGIN { exit !(v != "" && v + 0 >= a && v + 0 <= b) }' ||
    fail "$1 is $2, expected between $3 and $4"
}

value() { # folder step column
  awk -F, -v step="$2" -v name="$3" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i; next }
    $1 == step { print $c }' "$1/history.csv"
}

largest() { # folder column: its largest size
  awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i; next }
    { v = $c < 0 ? -$c : $c; if (v > m) m = v } END { if (c) printf "%.16g\n", m }' "$1/history.csv"
}

run() { # folder deck settings...
  local folder=$1 deck=$2
  shift 2
  "$BEZEL" "$BEZEL_SOURCE/inputs/$deck.inp" "$@" --out "$folder" >"$folder.txt" 2>&1 </dev/null ||
    { fail "$folder: the run fails"; tail -n 3 "$folder.txt"; }
}

# the same pressure q = 0.5 everywhere, at the gap -q/penalty, whatever the meshes are; exact but for rounding
for settings in 'gap=middle' 'gap=middle turned=1' 'gap=faces' 'gap=faces turned=1' 'gap=faces basis=T gp=3' 'p=2 gp=3 n_lower=5'; do
  # shellcheck disable=SC2086
  run press verify/shell_contact $settings
  within "$settings: penetration" "$(value press 1 penetration)" 4.99999999e-4 5.00000001e-4
  within "$settings: u_z of the upper shell" "$(value press 1 upper_uz)" -5.00000001e-4 -4.99999999e-4
  within "$settings: load on the lower shell" "$(value press 1 lower_rz)" 0.499999999 0.500000001
done

# two deformable shells: exact on matching meshes; else the error of the rule on the slave side, 2 % with 2 x 2 points, 2e-4
# with 8 x 8 (README), which bends the master, but keeps the balance; whichever way the normals of a slave's patches point
for settings in 'gp=2 0.02 1e-3' 'gp=8 2e-4 5e-6' 'n_upper=4 1e-9 1e-9' 'basis=T 0.02 1e-3' 'slave=lower 0.02 1e-3'; do
  read -r setting worst least <<<"$settings"
  run pair verify/shell_patch "$setting"
  within "$setting: depth/exact" "$(awk -v p="$(value pair 1 penetration)" 'BEGIN { print p/5e-4 }')" \
    "$(awk -v w="$worst" 'BEGIN { print 1 - w }')" "$(awk -v w="$worst" 'BEGIN { print 1 + w }')"
  within "$setting: elastic over penalty energy" \
    "$(awk -v e="$(value pair 1 elastic)" -v p="$(value pair 1 penalty_energy)" 'BEGIN { print e/p }')" 0 "$least"
  within "$setting: reaction at a corner" "$(value pair 1 corner_rz)" -1e-7 1e-7
done
run alike verify/shell_patch cut=alike
run turned verify/shell_patch cut=turned
within 'halves: depth' "$(value alike 1 penetration)" 4.95e-4 5.1e-4
within 'turned half: depth over that of halves that run alike' \
  "$(awk -v a="$(value turned 1 penetration)" -v b="$(value alike 1 penetration)" 'BEGIN { print a/b }')" 0.999999999999 1.000000000001

# the law itself: p_max = 4 in step 5, half way down in step 10, nothing from step 15 on; dissipated: GIC times the area 1
for gap in middle faces; do
  run pull verify/shell_contact case=pull gap=$gap
  within "$gap: traction in step 5" "$(value pull 5 upper_rz)" 3.99999999 4.00000001
  within "$gap: traction in step 10" "$(value pull 10 upper_rz)" 1.99999999 2.00000001
  within "$gap: traction in step 16" "$(value pull 16 upper_rz)" -1e-9 1e-9
  within "$gap: dissipated" "$(value pull 40 dissipated)" 0.0599999999 0.0600000001
done

# beam theory 39.8, 24.9, 17.6, 12.5; the plate lies above it by up to 2.4 %, the mesh and the steps add their oscillation
run peel peel_square case=figure basis=N columns=40 rows=1 steps=200 last=100
within 'peel: force at 0.2' "$(value peel 10 edge_rz)" 39.0 42.0
within 'peel: force at 0.5' "$(value peel 25 edge_rz)" 24.4 26.2
within 'peel: force at 1' "$(value peel 50 edge_rz)" 17.2 18.5
within 'peel: force at 2' "$(value peel 100 edge_rz)" 12.2 13.4
within 'peel: peak' "$(largest peel edge_rz)" 94 104
within 'peel: largest error of the balance' "$(largest peel energy_error)" 0 0.05

echo "shells in the interface: $failures failures"
[ $failures -eq 0 ]
