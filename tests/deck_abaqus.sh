#!/usr/bin/env bash
# The user elements for Abaqus: the one file compiles alone without warnings; the small host gives the driver's numbers; wrong
# data end the analysis, and failing elements cut the increment, with element and remedy.
set -u
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

build=$(dirname "$BEZEL")
host=$build/tests/abaqus_host

# With many warnings on but those of the optimiser: it takes a few seconds.
compiler=$(sed -n 's/^CMAKE_Fortran_COMPILER:[A-Z]*=//p' "$build/CMakeCache.txt")
mkdir alone
(cd alone && "$compiler" -std=legacy -Wall -ffree-form -c "$build/abaqus/bezel_uel.for" -o uel.o) >alone.txt 2>&1 ||
  fail 'the file for Abaqus does not compile alone'
[ -s alone.txt ] && { head -n 20 alone.txt; fail 'the file for Abaqus compiles with warnings'; }
head -n 1 "$build/abaqus/bezel_uel.for" | grep -qxF '!DIR$ FREEFORM' || fail 'a .for file is fixed form without !DIR$ FREEFORM'

job() { # job deck [name=value ...]: the driver's results in JOB.csv, the host's in JOB.txt
  local name=$1 deck=$2
  shift 2
  cp "$BEZEL_SOURCE/inputs/abaqus/$name.inp" "$BEZEL_SOURCE/inputs/abaqus/$name.bezel" .
  "$BEZEL" "$deck" "$@" --out "$name.out" >"$name.log" 2>&1 || { tail -n 5 "$name.log"; fail "$name: the driver fails"; }
  cp "$name.out/$name.iga" .
  mv "$name.out/history.csv" "$name.csv"
  "$build/bezel_abaqus" . "$name" || fail "$name: bezel_abaqus fails"
  "$host" . "$name" >"$name.txt" || fail "$name: the host fails"
  grep -qxF 'completed, 0 messages' "$name.txt" ||
    { grep '\*\*\*' "$name.txt" | head; fail "$name: the host does not complete"; }
}

agrees() { # job set columns: mean displacement and reactions of a set in all increments, relative to the largest of a kind
  grep " $2 " "$1.txt" | cut -c 17- | sed 's/^ *[^ ]* *//' >host_numbers.txt
  awk -F, -v columns="$3" 'NR == 1 { n = split(columns, name, " "); for (k = 1; k <= n; k++) for (i = 1; i <= NF; i++)
      if ($i == name[k]) at[k] = i; next }
    { for (k = 1; k <= n; k++) printf "%s%s", $at[k], k < n ? " " : "\n" }' "$1.csv" >driver_numbers.txt
  paste -d ' ' host_numbers.txt driver_numbers.txt | awk -v label="$1" -v columns="$3" '
    function bigger(a, b) { a = a < 0 ? -a : a; return a > b ? a : b }
    BEGIN { n = split(columns, name, " ") }
    { if (NF != 2*n) bad = 1
      for (k = 1; k <= n; k++) { h[NR, k] = $k; d[NR, k] = $(k + n); m[2*k > n] = bigger($(k + n), m[2*k > n]) } }
    END {
      for (i = 1; i <= NR; i++) for (k = 1; k <= n; k++) worst = bigger((h[i, k] - d[i, k])/m[2*k > n], worst)
      printf "%s: %d increments, largest difference from the driver %.1e\n", label, NR, worst
      exit bad || NR == 0 || worst > 1e-8 }' || fail "$1: the host and the driver differ"
}

job block "$BEZEL_SOURCE/inputs/abaqus/block_deck.inp"
agrees block block_top 'top_ux top_uy top_rx top_ry'
job peel "$BEZEL_SOURCE/inputs/abaqus/peel_deck.inp"
agrees peel upper_left 'pull_ux pull_uy pull_rx pull_ry'
job arc "$BEZEL_SOURCE/inputs/abaqus/arc_deck.inp"
agrees arc arc_right 'end_ux end_uy end_uz end_rx end_ry end_rz'
job plates "$BEZEL_SOURCE/inputs/abaqus/plates_deck.inp"     # faces of shells in contact
agrees plates upper_left 'edge_ux edge_uy edge_uz edge_rx edge_ry edge_rz'
job ironing "$BEZEL_SOURCE/inputs/ironing.inp" basis=N last=23 iga=1
agrees ironing die_top 'top_ux top_uy top_rx top_ry'
# T-splines: elements of many numbers of nodes, so many types
"$BEZEL" "$BEZEL_SOURCE/inputs/ironing.inp" basis=T last=3 iga=1 --out t.out >t.log 2>&1 || fail 'ironing with T-splines: the driver fails'
mkdir t
cp t.out/ironing.iga "$BEZEL_SOURCE/inputs/abaqus/ironing.bezel" t
sed 's/^1., 20./1., 3./; s/-0.05$/-0.0075/; 0,/END STEP/!d' "$BEZEL_SOURCE/inputs/abaqus/ironing.inp" >t/ironing.inp
"$build/bezel_abaqus" t ironing && "$host" t ironing >ironing_t.txt || fail 'ironing with T-splines: the host fails'
mv t.out/history.csv ironing_t.csv
agrees ironing_t die_top 'top_ux top_uy top_rx top_ry'

refused() { # words: the last analysis, whose output is in bad.txt, ended with a message that has them
  grep -F '***ERROR' bad.txt >message.txt || { fail "not refused: $*"; return; }
  local word
  for word in "$@"; do
    grep -qF -- "$word" message.txt || { cat message.txt; fail "the message lacks: $word"; }
  done
}

bad() { # job sed-script file: runs the job in a folder of its own with one file changed
  rm -rf bad
  mkdir bad
  cp "$1.inp" "$1.bezel" "$1.iga" "$1_mesh.inp" bad
  sed -i "$2" "bad/$3"
  "$host" bad "$1" >bad.txt && ! grep -q '\*\*\*' bad.txt && fail "accepted: $2"
}

bad block 's/^1, 100., 0.3, 1, 0/1, 100., 0.3, 1/' block.inp
refused 'user element 1 has 4 properties' 'five: law, E, nu, state, Gauss points'
bad block 's/^1, 100., 0.3, 1, 0/1, 100., 0.6, 1, 0/' block.inp
refused 'user element 1 ' 'nu < 0.5'
bad block 's/FIRST=1/FIRST=3/' block.bezel
refused 'user element 1 has no extraction operator' 'FIRST='
bad block '0,/^8,/s/^8,.*/8, 0.5, 0.5/' block_mesh.inp
refused 'user element 1 does not fit the mesh file' 'node 5' 'node 8' 'bezel_abaqus'
bad block 's/^belem 9 2 2/belem 9 3 2/' block.iga
refused 'block.iga, line'
bad block 's/block.iga/nothing.iga/' block.bezel
refused 'nothing.iga'
bad peel 's/VARIABLES=24/VARIABLES=20/' peel_mesh.inp
refused 'user element 1001 has 20 state variables and needs 24' 'VARIABLES='
bad peel 's/GMAX/&/; s/^10., 0.01, 2.5E-4, 0.01/10., 0.01, 2.5E-4/' peel.inp
refused 'user element 1001 has 3 properties' 'penalty, p_max, G_Ic, g_max'
bad peel 's/2.5E-4, 0.01/2.5E-5, 0.01/' peel.inp
refused 'user element 1001 ' 'g_max < 2 G_Ic/p_max'
bad peel 's/MASTER=lower.top/MASTER=lower.up/' peel.bezel
refused 'peel.bezel, line 4' 'lower.up' 'Known:' 'lower.top'
bad peel 's/PATCH=0.5/PATCH=0.01/' peel.bezel
refused 'user element 1001 has' 'nodes' 'bezel_abaqus'

bad plates 's/SLAVE=upper/SLAVE=upper.left/' plates.bezel
refused 'plates.bezel, line 4' 'no surface "upper.left"' 'Known: lower upper'
bad plates 's/THICKNESS=0.1/THICKNESS=-1/' plates.bezel
refused 'plates.bezel, line 4' 'THICKNESS='

# An element that turns inside out asks for a smaller increment; the host goes on and arrives.
bad block 's/^1., 10./1., 1./; s/-0.2$/-0.7/' block.inp
grep -q 'user element [0-9]*: the element is inverted.*the increment is cut' bad.txt || fail 'no inverted element was told'
grep -q '^completed' bad.txt || fail 'the cut increments do not arrive'

# A slave point that leaves its patch of master facets cuts the increment, with its element named.
mkdir left
cp peel.iga left
sed 's/PATCH=0.5/PATCH=0.01/' peel.bezel >left/peel.bezel
sed 's/^10., 0.01, 2.5E-4, 0.01/10., 0., 0., 0./; s/^upper_left, 1, 1/upper_left, 1, 1, 0.5/; s/2, 2, 0.03/2, 2, -0.001/' peel.inp \
  >left/peel.inp
"$build/bezel_abaqus" left peel
"$host" left peel >left.txt && fail 'a point left its patch, and the host arrived'
grep -q 'user element 100[0-9]: a slave point has left the master facets.*the increment is cut' left.txt ||
  { tail -n 3 left.txt; fail 'a point that leaves its patch is not told'; }

echo "abaqus: $failures failures"
[ $failures -eq 0 ]
