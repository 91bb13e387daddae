#!/usr/bin/env bash
# The ironing deck has the dofs that it states for every basis, degree and mesh, and the areas of its bodies: the slab's
# 0.5; the die's below its flat top, down to an arc of radius 0.2, 0.15 sqrt(0.0175) + 0.04 asin(3/4) = 0.0537656180.
# (Lagrange elements interpolate the arc: 1e-3 for the coarsest bilinear mesh.)
set -u
deck=$BEZEL_SOURCE/inputs/ironing.inp
failures=0
rows='L 1 1044 3352 11904
L 2 1044 3352 11904
L 3 1042 3352 11902
L 4 1044 3356 11900
L 5 1044 3354 11904
N 1 1044 3352 11904
N 2 1044 3352 11904
N 3 1044 3352 11904
N 4 1044 3352 11904
N 5 1044 3352 11904
T 3 1040 3330 11884'
while read -r basis p expected; do
  mesh=0
  for dofs in $expected; do
    mesh=$((mesh + 1))
    output=$("$BEZEL" "$deck" basis=$basis p=$p mesh=$mesh --check 2>&1 </dev/null)
    tolerance=1e-3
    if [ $basis != L ] && [ $p -gt 1 ]; then tolerance=1e-9; fi
    awk -v dofs="$dofs" -v tolerance=$tolerance '
      $1 == "dofs" { right_dofs = $2 == dofs; found = $2 }
      $1 == "body" { area[$2 + 0] = $NF }
      END {
        slab = area[1] - 0.5; die = area[2] - 0.0537656179922
        exit !(right_dofs && slab^2 < 1e-24 && die^2 < tolerance^2 && area[2] > 0)
      }' <<<"$output" && continue
    echo "basis=$basis p=$p mesh=$mesh: expected $dofs dofs and the areas 0.5 and 0.0537656, found"
    grep -E '^(dofs|body)|inp:' <<<"$output"
    failures=$((failures + 1))
  done
done <<<"$rows"
echo "$failures failures"
[ $failures -eq 0 ]
