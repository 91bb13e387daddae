#!/usr/bin/env bash
# End faces: a cantilever bent to a full circle, by its angle and by its moment; a run that is killed goes on bit for bit.
set -u
. "$BEZEL_SOURCE/tests/history_checks.sh"
deck=$BEZEL_SOURCE/inputs/verify/bent_circle.inp

# The section in uniform bending has M = 0.0574401 and the energy 0.180608; a mesh of 20 elements leaves 1.2e-4 of it. A
# rigid and a held end hold the height of the section near them, which makes the beam stiffer by 0.1 % each; their
# numbers are those of this mesh.
solve both "$deck" end=both
expect both tip_m 0.0574401 1.2e-5
expect both tip_rot 6.283185307179586 1e-15
expect both elastic 0.180608 3e-5
expect both end_ux -10 2e-3
expect both end_uy 0 1e-3
solve rigid "$deck" end=rigid
expect rigid tip_m 0.0575566 1e-7
expect rigid tip_rot 6.283185307179586 1e-15
solve warping "$deck" end=warping
expect warping tip_m 0.0575015 1e-7

# The moment of the elastica, which is 0.17 % too large, turns by that much more.
solve loaded "$deck" end=both drive=moment steps=40
expect loaded tip_m 0.05753832698882405 1e-16
expect loaded tip_rot 6.29326 2e-4

# A state in which globals are saved: killed and continued, with free and prescribed angles.
for drive in angle moment; do
  arguments=(end=warping drive=$drive steps=60)
  solve whole "$deck" "${arguments[@]}"
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
