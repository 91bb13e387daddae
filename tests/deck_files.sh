#!/usr/bin/env bash
# Meshes from files: --check of them, the patch test on one made by hand, and decks whose mesh was exported and read back.
set -u
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }
meshes=$BEZEL_SOURCE/tests/meshes

# what --check prints: sizes known from geometry
holds() { # FILE LINE
  "$BEZEL" --check "$meshes/$1" >check.txt 2>&1 || fail "$1: exit status $?"
  grep -qxF -- "$2" check.txt || { fail "$1: missing: $2"; cat check.txt; }
}
holds strip.iga  'area        6.000000000000'
holds strip.iga  'nodes       8 (1 unused besides)'
holds strip.iga  'set         end: 1 sides, length 3.000000000000'
holds strip.bxt  'area        6.000000000000'
holds strip.json 'degrees     2 x 1 (2 elements)'
holds ring.iga   'area        2.356194490192'
holds ring.iga   'set         outer: 1 sides, length 3.141592653590'
holds brick.iga  'volume      30.000000000000'

# faulty files: exit status 2, file and line
refused() { # NAME LINE: the file in bad.txt
  "$BEZEL" --check bad.txt >check.txt 2>&1
  [ $? -eq 2 ] || fail "$1: exit status is not 2"
  grep -q "^bad.txt:$2: " check.txt || { fail "$1: no message for line $2"; cat check.txt; }
}
sed 's/^0 1 0.5 0 0 0$/0 1 0.5 0 0/' "$meshes/strip.iga" >bad.txt; refused 'short row' 24
sed 's/^node 1.5 0 0 1$/node 1.5 0 0 NaN/' "$meshes/strip.iga" >bad.txt; refused 'not a number' 9
sed 's/^elemN 2/elemN 20/' "$meshes/strip.iga" >bad.txt; refused 'wrong count' 5
head -n 24 "$meshes/strip.bxt" >bad.txt; refused truncated 24
sed 's/"coeff_vector_ids": \[3,/"coeff_vector_ids": [30,/' "$meshes/strip.json" >bad.txt; refused 'vector id' 25
"$BEZEL" "$meshes/strip.iga" >check.txt 2>&1
[ $? -eq 2 ] || fail 'a mesh given as a deck: exit status is not 2'
lines=$(wc -l <"$meshes/strip.iga")
for n in $(seq 1 $((lines - 1))); do
  head -n "$n" "$meshes/strip.iga" >bad.txt
  "$BEZEL" --check bad.txt >check.txt 2>&1
  status=$?
  # whole after the last row of coefficients, line 34; comment lines alone are no mesh but a poor deck
  if [ "$n" -ge 34 ]; then [ $status -eq 0 ]; else [ $status -eq 2 ]; fi || fail "cut behind line $n: exit status $status"
done

# Irons' patch test: u = (0.01 x + 0.004 y, -0.002 x + 0.003 y) prescribed on the outline comes out at the free control
# points, whatever the weights; 12 Gauss points per direction leave no error of integration.
cp "$meshes/patch.iga" .
{
  printf '%s\n' 'FEAP * * patch test on a mesh from a file' '0 0 0 2 2' '' 'T-SPline FILE="patch.iga" MATErial=1' '' \
    'MATErial 1' 'SOLId' 'ELAStic ISOTropic 1000 0.3' 'PLANe STRAin' 'SMALl' 'QUADrature 12' '' \
    'SET outline UNION bottom top left right' 'BOUNdary' 'outline 1 1' '' 'DISPlacement'
  awk '$1 == "node" { n++
    if (n != 5 && n != 8 && n != 11) printf "%d 0 %.17g %.17g\n", n, 0.01*$2 + 0.004*$3, -0.002*$2 + 0.003*$3 }' patch.iga
  printf '%s\n' ''
  for n in 5 8 11; do printf '%s\n' "SET node$n NODEs $n" "HISTory u$n SET=node$n DISPlacement"; done
  printf '%s\n' 'HISTory r SET=outline REACtion' 'HISTory i SET=inner DISPlacement' 'OUTPut NONE' 'END' 'BATCh' \
    'TOL,,1e-16' 'DT,,1' 'TIME' 'LOOP,,5' 'TANG,,1' 'NEXT' 'END' 'STOP'
} >patch.inp
"$BEZEL" patch.inp >patch.txt 2>&1 || { fail "patch test: exit status $?"; cat patch.txt; }
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
  function off(name, value, d) { d = $at[name] - value; if (d < 0) d = -d; if (d > most) most = d }
  NR == 2 {
    off("u5_ux", 0.01*4.9 + 0.004*1.0); off("u5_uy", -0.002*4.9 + 0.003*1.0)
    off("u8_ux", 0.01*3.6 + 0.004*1.2); off("u8_uy", -0.002*3.6 + 0.003*1.2)
    off("u11_ux", 0.01*2.0 + 0.004*0.9); off("u11_uy", -0.002*2.0 + 0.003*0.9)
    off("i_ux", (0.01*10.5 + 0.004*3.1)/3) }
  END { print "patch test: largest error of a displacement", most; exit !(NR == 2 && most < 1e-13) }' patch.out/history.csv ||
  fail 'the patch test fails'

# A deck that exports its mesh, and the same deck with that mesh read back: the same history, to the last bit.
deck=$BEZEL_SOURCE/inputs/ironing.inp
awk '/^OUTPut/ { print "EXPOrt FILE=\"mesh.iga\""; print "EXPOrt FILE=\"mesh.h5\"" } { print }' "$deck" >made.inp
awk '/^PATCh slab/ { skip = 1; print "PARAmeter"; print "  file = \"mesh.iga\""; print ""
    print "T-SPline FILE=\"made.out/{file}\""
    print "  slab MATErial=1 BODY=1"; print "  die MATErial=2 BODY=2"; print "" }
  /^MATErial 1 slab/ { skip = 0 } !skip { print }' "$deck" >read.inp
for basis in 'basis=N p=3' 'basis=L p=2'; do
  # shellcheck disable=SC2086
  "$BEZEL" made.inp $basis mesh=1 last=3 >made.txt 2>&1 || { fail "$basis: exit status $?"; cat made.txt; }
  for form in iga h5; do
    "$BEZEL" read.inp last=3 file=mesh.$form >read.txt 2>&1 || { fail "$basis from .$form: exit status $?"; cat read.txt; }
    cmp made.out/history.csv read.out/history.csv || fail "$basis from .$form: another history"
  done
  "$BEZEL" --check made.out/mesh.iga | tail -n +2 >iga.txt
  "$BEZEL" --check made.out/mesh.h5 | tail -n +2 >h5.txt
  cmp iga.txt h5.txt || fail "$basis: the two files differ"
done
# --check writes nothing
rm -rf made.out
"$BEZEL" made.inp --check >check.txt 2>&1 || fail "exit status $?"
[ ! -e made.out ] || fail '--check wrote the mesh'

echo "$failures failures"
[ $failures -eq 0 ]
