#!/usr/bin/env bash
# Quadrilateral meshes with T-junctions against expected numbers, and again from the file of extraction operators that they
# write.
set -u
. "$BEZEL_SOURCE/tests/history_checks.sh"

verify=$BEZEL_SOURCE/inputs/verify

# The plate with an extraordinary point: value of the mesh without T-junctions for the same faces elsewhere, 1e-3 and 4e-5
# off the converged 2.05038e-4.
solve coarse "$verify/t_mesh_plate.inp"
expect coarse tip_uz 2.04829e-4 1e-9
solve plate "$verify/t_mesh_plate.inp" n=1
expect plate tip_uz 2.05030e-4 1e-9

# The same plate from its file.
again_from_file plate.out/plate.iga

# The patch test: uniform stress in the plane, on the mesh and on the mesh divided once.
cp "$verify/t_mesh_plate.obj" .
cat >patch.inp <<'EOD'
FEAP * * uniform stress on a mesh with T-junctions and an extraordinary point
! Tractions of a uniform stress act on the three sides; u = (a x + b y, d y), held at two corners. Plane strain.

PARAmeter
  n = 0     [integer 0:]
  a = 0.01
  b = 0.004
  d = 0.003
  E  = 1000
  nu = 0.3
  lambda = E*nu/((1 + nu)*(1 - 2*nu))
  mu     = E/(2*(1 + nu))
  sxx = lambda*(a + d) + 2*mu*a
  syy = lambda*(a + d) + 2*mu*d
  sxy = mu*b
  nx  = sqrt(3)/2
  ny  = 0.5

0 0 0 2 2

QUADmesh plate FILE="t_mesh_plate.obj" MATErial=1
  REFIne n

MATErial 1
  SOLId
  ELAStic ISOTropic E nu
  PLANe STRAin
  SMALl
  QUADrature 8

SET left  CORNer plate.edge3 plate.edge1
SET right CORNer plate.edge1 plate.edge2
SET tip   CORNer plate.edge2 plate.edge3

SLOAd plate.edge1 TRACtion -sxy -syy
SLOAd plate.edge2 TRACtion  sxx*nx+sxy*ny  sxy*nx+syy*ny
SLOAd plate.edge3 TRACtion -sxx*nx+sxy*ny -sxy*nx+syy*ny

BOUNdary
  left  1 1
  right 0 1

HISTory tip SET=tip DISPlacement
HISTory ELAStic

END
BATCh
  DT,,1
  TIME
  TANG,,1
END
STOP
EOD
for n in 0 1; do
  solve patch patch.inp n=$n
  expect patch tip_ux 0.16928203230275509 1e-13
  expect patch tip_uy 0.051961524227066319 1e-13
  expect patch elastic 16.237976320958225 1e-11
done

# OBJ files that are no meshes: the line of the file, the face and the vertex.
check() {
  local name=$1 expected=$2
  printf 'FEAP * * faulty file\n0 0 0 3 3\nQUADmesh a FILE="%s.obj"\n\nEND\nBATCh\nEND\nSTOP\n' "$name" >"$name.inp"
  "$BEZEL" "$name.inp" --check </dev/null 2>&1 | grep -qF -- "$expected" && return
  echo "$name.obj: missing: $expected"
  failures=$((failures + 1))
}
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 2 3 4\nf 2 5 3\n' >triangle.obj
check triangle 'triangle.obj:7: QUADmesh: face 2 is a triangle'
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nf 1 5 2 3 4\n' >pentagon.obj
check pentagon 'face 1 has 5 vertices, 0 of which can be T-junctions'

echo "$failures failures"
[ $failures -eq 0 ]
