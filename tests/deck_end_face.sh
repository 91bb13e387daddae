#!/usr/bin/env bash
# End faces: a cantilever bent to a full circle, by its angle and by its moment; a run that is killed goes on bit for bit.
set -u
failures=0
deck=$BEZEL_SOURCE/inputs/verify/bent_circle.inp

solve() { # label [name=value ...]
  local label=$1 status
  shift
  "$BEZEL" "$deck" "$@" --out "$label.out" >"$label.txt" 2>&1 </dev/null
  status=$?
  [ $status -eq 0 ] && return
  echo "$label: exit status $status"
  cat "$label.txt"
  failures=$((failures + 1))
}

expect() { # label column expected tolerance: last row of the history
  awk -F, -v name="$2" -v expected="$3" -v tolerance="$4" -v label="$1" '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) column = i }
    { found = $column }
    END {
      if (!column || NR < 2) { print label ": no column or row for " name; exit 1 }
      error = found - expected
      if (error < 0) error = -error
      if (!(error <= tolerance)) {
        print label ": " name " expected " expected " found " found " tolerance " tolerance
        exit 1
      }
    }' "$1.out/history.csv" || failures=$((failures + 1))
}

# The section in uniform bending has M = 0.0574401 and the energy 0.180608; a mesh of 20 elements leaves 1.2e-4 of it. A
# rigid and a held end hold the height of the section near them, which makes the beam stiffer by 0.1 % each; their
# numbers are those of this mesh.
solve both end=both
expect both tip_m 0.0574401 1.2e-5
expect both tip_rot 6.283185307179586 1e-15
expect both elastic 0.180608 3e-5
expect both end_ux -10 2e-3
expect both end_uy 0 1e-3
solve rigid end=rigid
expect rigid tip_m 0.0575566 1e-7
expect rigid tip_rot 6.283185307179586 1e-15
solve warping end=warping
expect warping tip_m 0.0575015 1e-7

# The moment of the elastica, which is 0.17 % too large, turns by that much more.
solve loaded end=both drive=moment steps=40
expect loaded tip_m 0.05753832698882405 1e-16
expect loaded tip_rot 6.29326 2e-4

# A state in which globals are saved: killed and continued, with free and prescribed angles.
for drive in angle moment; do
  arguments=(end=warping drive=$drive steps=60)
  solve whole "${arguments[@]}"
  "$BEZEL" "$deck" "${arguments[@]}" --out broken.out >broken.txt 2>&1 &
  pid=$!
  sleep 0.3
  kill -9 $pid 2>/dev/null
  wait $pid 2>/dev/null
  if [ -e broken.out/restart.h5 ]; then
    "$BEZEL" "$deck" "${arguments[@]}" --out broken.out --restart >broken.txt 2>&1 || { cat broken.txt; failures=1; }
    cmp whole.out/history.csv broken.out/history.csv || failures=1
    cmp whole.out/fields_000060.vtu broken.out/fields_000060.vtu || failures=1
  else
    echo "$drive: killed before its first state"
  fi
  rm -rf whole.out broken.out
done

# The summary names the face.
"$BEZEL" "$deck" --check >check.txt || failures=1
grep -q 'end face    tip: beam.right, rigid, rotation prescribed' check.txt || { cat check.txt; failures=1; }
exit $((failures > 0))
