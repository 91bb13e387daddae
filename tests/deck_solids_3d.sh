#!/usr/bin/env bash
# Contact and debonding of solids in space against plane strain: the extruded problem with u_z = 0 has the forces per width,
# the gaps and the steps of the problem in the plane, for trivariate NURBS and for swept T-splines.
set -u
failures=0

solve() { # label deck [name=value ...]
  local label=$1 deck=$2 status
  shift 2
  "$BEZEL" "$BEZEL_SOURCE/inputs/$deck.inp" "$@" --out "$label.out" >"$label.txt" 2>&1 </dev/null
  status=$?
  [ $status -eq 0 ] && return
  echo "$label: exit status $status"
  cat "$label.txt"
  failures=$((failures + 1))
}

alike() { # plane solid width rows tolerance column ...: those of the solid / width, against the largest in the plane
  local plane=$1 solid=$2 width=$3 rows=$4 tolerance=$5
  shift 5
  awk -F, -v width="$width" -v rows="$rows" -v tolerance="$tolerance" -v names="$*" -v label="$solid" '
    FNR == 1 { file++; for (i = 1; i <= NF; i++) place[file, $i] = i; n = split(names, name, " "); next }
    file == 1 { for (k = 1; k <= n; k++) {
        v = $place[1, name[k]]; plane[FNR, k] = v; if (v < 0) v = -v; if (v > largest[k]) largest[k] = v
      }
      lines = FNR }
    file == 2 {
      for (k = 1; k <= n; k++) {
        part = name[k] ~ /^(time|iterations|penetration)$|_u[xyz]$|_rot$/ ? 1 : name[k] == "active" ? 2 : width
        error = $place[2, name[k]]/part - plane[FNR, k]
        if (error < 0) error = -error
        if (!((1, name[k]) in place && (2, name[k]) in place && error <= tolerance*largest[k])) {
          print label ": row " FNR - 1 ": " name[k] " " $place[2, name[k]] "/" part " against " plane[FNR, k]
          wrong++
        }
      }
      if (FNR != lines) next
      if (lines != rows + 1) { print label ": " lines - 1 " rows, expected " rows; wrong++ }
      ended = 1
    }
    END { if (!ended || FNR != lines) { print label ": not as many rows as the plane has"; wrong++ } exit wrong > 0 }
  ' "$plane.out/history.csv" "$solid.out/history.csv" || failures=$((failures + 1))
}

# Pressing, sliding: steps of Newton with the same iterations. Rounding of positions of 1 against a depth of 1e-4.
for basis in N T; do
  case $basis in
    N) p=2 ;;
    T) p=3 ;;
  esac
  steps=(steps_press=4 steps_slide=60 last=6)
  solve ironing_2d_$basis ironing mesh=1 basis=$basis p=$p "${steps[@]}"
  solve ironing_3d_$basis ironing_3d basis=$basis p=$p width=0.16 "${steps[@]}"
  alike ironing_2d_$basis ironing_3d_$basis 0.16 6 1e-9 iterations active top_rx top_ry penetration
done
# Other elements along the depth: another degree, two elements.
solve deeper ironing_3d basis=N p=2 width=0.2 pz=2 layers=2 steps_press=4 last=2
solve plane ironing mesh=1 basis=N p=2 steps_press=4 last=2
alike plane deeper 0.2 2 1e-9 iterations top_rx top_ry penetration

# Debonding up to the largest moment: the path is controlled by time, then by what is dissipated.
for basis in N T; do
  solve dcb_2d_$basis verify/dcb_3d dim=2 basis=$basis last=0.022
  solve dcb_3d_$basis verify/dcb_3d basis=$basis last=0.022
  rows=$(($(wc -l <dcb_2d_$basis.out/history.csv) - 1))
  alike dcb_2d_$basis dcb_3d_$basis 2 $rows 1e-8 active time arm_m arm_rot work elastic dissipated
done

echo "solids in space: $failures failures"
[ $failures -eq 0 ]
