#!/usr/bin/env bash
# Meshes with extraordinary points: patch tests of shells and of swept solids, symmetry edges, agreement with joined patches.
set -u
. "$BEZEL_SOURCE/tests/history_checks.sh"

verify=$BEZEL_SOURCE/inputs/verify

# Constant membrane forces, moments and twist: energy over that of the constant state. E = 1e4, nu = 0.3, t = 0.05; q = 1e-9.
exact() { # corners state
  awk -v m="$1" -v state="$2" 'BEGIN {
    q = 1e-9; t = 0.05; area = m/2*sin(8*atan2(1, 1)/m)*0.8
    if (state == "membrane") printf "%.16e", area*6.85*q^2/(2*1e4*t)
    if (state == "bending") printf "%.16e", 12*area*1.4*q^2/(2*1e4*t^3)
    if (state == "twist") printf "%.16e", 12*area*2.6*q^2/(2*1e4*t^3)
  }'
}
tenth() { # number: a part in 1e10
  awk -v number="$1" 'BEGIN { printf "%.3e", number*1e-10 }'
}
for corners in 3 5; do
  for state in membrane bending twist; do
    value=$(exact $corners $state)
    solve patch_$corners$state "$verify/extraordinary_patch.inp" corners=$corners state=$state
    expect patch_$corners$state elastic "$value" "$(tenth "$value")"
  done
  # the membrane state on a distorted mesh; without affine image constant moments are approximated only
  value=$(exact $corners membrane)
  solve distorted_$corners "$verify/extraordinary_patch.inp" corners=$corners off=0.15
  expect distorted_$corners elastic "$value" "$(tenth "$value")"
done
value=$(exact 5 twist)
solve local "$verify/extraordinary_patch.inp" corners=5 state=twist local=1
expect local elastic "$value" "$(tenth "$value")"

# Swept solids: uniaxial stress. Areas of the polygons are m/2 sin(2 pi/m), u_z = 2e-3, energy = area 1e-3.
for corners in 3 5; do
  solve swept_$corners "$verify/swept_polygon.inp" corners=$corners
  expect swept_$corners top_uz 2e-3 1e-14
  expect swept_$corners elastic "$(awk -v m=$corners 'BEGIN { printf "%.16e", m/2*sin(8*atan2(1, 1)/m)*1e-3 }')" 1e-14
done
# the far corner of the pentagon: x and y shrink towards the corner that is held
expect swept_5 far_uy "$(awk 'BEGIN { turn = 8*atan2(1, 1)/5; printf "%.16e", -3e-4*(cos(turn/2) - cos(1.5*turn)) }')" 1e-14

# One smooth mesh and joined patches: the plate with one side clamped; the octant of a sphere, whose edges lie in planes of
# symmetry (membrane theory; the reference value of the pinched hemisphere).
solve plate "$verify/polygon_plate.inp" hold=one
expect plate tip_uz 2.05038e-4 4e-9
solve joined "$verify/polygon_plate.inp" hold=one basis=N p=4 n=4
expect joined tip_uz 2.05038e-4 2e-7
for basis in E C N; do
  solve pressed_$basis "$verify/sphere_octant.inp" load=pressure basis=$basis level=2 n=4
  expect pressed_$basis elastic 0.1006919 1e-6
done
solve pinched "$verify/sphere_octant.inp" basis=E level=3
expect pinched a_ux 0.0924 4e-4
expect pinched b_uy -0.0924 4e-4

# What SYMMetric is for: without it the fitted surface leans a little.
sed 's/ SYMMetric//; s|"\.\./|"'"$BEZEL_SOURCE"'/inputs/|' "$verify/sphere_octant.inp" >leans.inp
"$BEZEL" leans.inp level=1 --check </dev/null 2>&1 | grep -q 'does not meet a plane at right angles' || {
  echo 'a surface that leans was taken for symmetric'
  failures=$((failures + 1))
}

# Words that SPHEre and SWEEp do not know.
refused() { # line fact
  cat >wrong.inp <<EOF
FEAP * * wrong words
0 0 0 3 3
QUADmesh a
  VERTices 4
    0 0 0
    1 0 0
    1 1 0
    0 1 0
  FACEs 1
    1 2 3 4
  $1

END
BATCh
END
STOP
EOF
  if "$BEZEL" wrong.inp --check </dev/null >wrong.txt 2>&1 || ! grep -qF "wrong.inp:11: QUADmesh: $2" wrong.txt; then
    echo "not told: $2"
    cat wrong.txt
    failures=$((failures + 1))
  fi
}
refused 'SPHEre 0 0 -1 2 SMOOth' 'unknown word "SMOOth". Behind the radius only SYMMetric may stand.'
refused 'SWEEp 0 0 0' 'a sweep has a vector'

echo "extraordinary points: $failures failures"
[ $failures -eq 0 ]
