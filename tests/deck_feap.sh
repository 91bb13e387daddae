#!/usr/bin/env bash
# The FEAP kit in a small host of our own: patch tests, the driver's numbers, the host's own solid on a T-spline, faults.
set -u
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

host=$(dirname "$BEZEL")/tests/feap_host
cp "$BEZEL_SOURCE"/inputs/feap/* .

runs() { # runs DECK: the host ends well
  "$host" "$1" >"$1.txt" 2>&1 || { tail -n 5 "$1.txt"; fail "$1: the host fails"; }
}

sums() { # sums FILE.dat MESH.iga CONDITION: per step mean displacements and summed reactions of the nodes where x, y fulfil it
  awk -v mesh="$2" 'BEGIN { while ((getline line < mesh) > 0) if (split(line, w, " ") > 4 && w[1] == "node") {
        x = w[2]; y = w[3]; n++; chosen[n] = ('"$3"') ? 1 : 0; many += chosen[n] } }
    function flush() { if (steps) printf "%.16e %.16e %.16e %.16e\n", u/many, v/many, p, q; u = v = p = q = 0 }
    $1 == "time" { flush(); steps++; next }
    chosen[$1] { u += $2; v += $3; p += $4; q += $5 }
    END { flush() }' "$1"
}

agrees() { # agrees NAME.dat MESH.iga CONDITION HISTORY.csv COLUMNS: u, v, p, q of each step as the driver has them
  sums "$1" "$2" "$3" >host_numbers.txt
  awk -F, -v columns="$5" 'NR == 1 { n = split(columns, name, " "); for (k = 1; k <= n; k++) for (i = 1; i <= NF; i++)
      if ($i == name[k]) at[k] = i; next }
    { for (k = 1; k <= n; k++) printf "%s%s", $at[k], k < n ? " " : "\n" }' "$4" >driver_numbers.txt
  paste -d ' ' host_numbers.txt driver_numbers.txt | awk -v label="$1" '
    function bigger(a, b) { a = a < 0 ? -a : a; return a > b ? a : b }
    { if (NF != 8) bad = 1
      for (k = 1; k <= 4; k++) { h[NR, k] = $k; d[NR, k] = $(k + 4); m[k > 2] = bigger($(k + 4), m[k > 2]) } }
    END {
      for (i = 1; i <= NR; i++) for (k = 1; k <= 4; k++) worst = bigger((h[i, k] - d[i, k])/m[k > 2], worst)
      printf "%s: %d steps, largest difference from the driver %.1e\n", label, NR, worst
      exit bad || NR == 0 || !(worst < 1e-8) }' || fail "$1: host and driver differ"
}

# A linear field comes out at every control point, of a T-spline from a file and of operators in the deck.
runs Ipatch_t
awk -v mesh=patch_t.iga 'BEGIN { while ((getline line < mesh) > 0) if (split(line, w, " ") > 4 && w[1] == "node") {
      n++; x[n] = w[2]; y[n] = w[3] } }
  $1 != "time" { a = $2 - 0.01*x[$1]; b = $3 + 0.003/0.7*y[$1]; rows++; if (a*a + b*b > 1e-28) wrong++ }
  END { exit wrong || rows != 57 }' patch_t.dat || fail 'the T-spline patch test'
runs Ipatch_explicit
awk '$1 == 7 { a = $2 - 0.0236; b = $3 + 0.0013 } $1 == 8 { a = $2 - 0.0408; b = $3 + 0.0036 }
  $1 == 9 { a = $2 - 0.053; b = $3 + 0.0068 } $1 != "time" && $1 > 6 && $1 < 10 { n++; if (a*a + b*b > 1e-28) wrong++ }
  END { exit wrong || n != 3 }' explicit.dat || fail 'the patch test with operators in the deck'

# The host's own small-strain solid on the T-spline, by way of the replaced shape functions, is our solid.
sed 's/BEZSolid/SOLId/; /QUADrature/d; /STREss/d; s/patch_t.dat/own.dat/' Ipatch_t >Iown
sed '/QUADrature/d; s/patch_t.dat/ours.dat/' Ipatch_t >Iours
runs Iown
runs Iours
paste -d ' ' own.dat ours.dat | awk '$1 != "time" { n++; if (NF != 10) wrong++
    for (k = 2; k <= 5; k++) { a = $k - $(k + 5); if (a*a > (k < 4 ? 1e-28 : 1e-22)) wrong++ } }
  END { exit wrong || n != 57 }' || fail 'the replaced shape functions give other numbers than our solid'

# The same in space, on a block of degrees 2 x 1 x 3 from the driver.
cat >box.inp <<'DECK'
FEAP * * a block in space
0 0 0 3 3

PATCh box
  DEGRee 1 1 1
  KNOTs 1  0 0 1 1
  KNOTs 2  0 0 1 1
  KNOTs 3  0 0 1 1
  POINts
    0 0 0
    1 0 0
    0 1 0
    1.2 1 0
    0 0 1
    1 0 1.1
    0 1 1
    1 1 1
  ELEVate TO 2 1 3
  SUBDivide 1 2
  SUBDivide 2 2

MATErial 1
  SOLId
  ELAStic ISOTropic 1000 0.3

BOUNdary
  box.bottom 1 1 1

OUTPut NONE
EXPOrt FILE="box.iga"

END

BATCh
  TIME
  TANG,,1
END

STOP
DECK
cat >Ibox <<'DECK'
FEAP * * a block in space
0 0 0 3 3 0

T-SPline MATErial=1
  FILE="box.out/box.iga"

EBOUndary
  2 0.0  1 1 1
  2 1.0  1 1 1

EDISplacement
  2 1.0  0.01 0.02 -0.03

MATErial 1
  BEZSolid
  ELAStic ISOTropic 1000 0.3

END

BATCh
  DT,,1
  TIME
  TANG,,1
  REAC,FILE
  NODAl,box.dat
END

STOP
DECK
"$BEZEL" box.inp >driver.txt 2>&1 || fail 'box: the driver fails'
sed 's/BEZSolid/SOLId/; s/box.dat/boxown.dat/' Ibox >Iboxown
runs Ibox
runs Iboxown
paste -d ' ' box.dat boxown.dat | awk '$1 != "time" { n++; if (NF != 14) wrong++
    for (k = 2; k <= 7; k++) { a = $k - $(k + 7); if (a*a > (k < 5 ? 1e-30 : 1e-22)) wrong++ } }
  END { exit wrong || n < 20 }' || fail 'the replaced shape functions in space'

# A line: FEAP's coordinates, operators in the deck, a record that goes on in the next one.
cat >Iline <<'DECK'
FEAP * * a line
0 0 0 1 1 0

COORdinates
  1 0  0
  2 0  0.25
  3 0  0.75
  4 0  1

BEZIer MATErial=1
  1 DEGRee 2 &
    NODEs 1 2 3
  1 0 0
  0 1 0.5
  0 0 0.5
  2 DEGRee 2 NODEs 2 3 4
  0.5 0 0
  0.5 1 0
  0 0 1

BOUNdary
  1 0  1
  4 0  1

DISPlacement
  4 0  0.1

MATErial 1
  SOLId
  ELAStic ISOTropic 1000 0.3

END

BATCh
  DT,,1
  TIME
  TANG,,1
  REAC,FILE
  NODAl,line.dat
END

STOP
DECK
runs Iline
awk '$1 == 2 { a = $2 - 0.025 } $1 == 3 { b = $2 - 0.075 } $1 == 4 { c = $3 - 134.61538461538461 }
  END { exit !(a*a < 1e-30 && b*b < 1e-30 && c*c < 1e-20) }' line.dat || fail 'the replaced shape functions on a line'

# The driver's numbers: finite strain, contact, cohesion.
"$BEZEL" block_neo.inp >driver.txt 2>&1 || fail 'block_neo: the driver fails'
runs Iblock_neo
agrees block_neo.dat block_neo.out/block_neo.iga 'x < 1e-9' block_neo.out/history.csv 'top_ux top_uy top_rx top_ry'
for basis in N T; do
  "$BEZEL" "$BEZEL_SOURCE/inputs/ironing.inp" basis=$basis p=3 iga=1 last=23 >driver.txt 2>&1 || fail 'ironing: the driver fails'
  sed 's/LOOP,,60/LOOP,,23/' Iironing >Iironing_$basis
  rm -f ironing.dat
  runs Iironing_$basis
  agrees ironing.dat ironing.out/ironing.iga 'y > 0.4499' ironing.out/history.csv 'top_ux top_uy top_rx top_ry'
done
"$BEZEL" shell.inp >driver.txt 2>&1 || fail 'shell: the driver fails'
runs Ishell
awk '$1 == "time" { if (n++) print p, u/4; p = u = 0; next } $1 % 11 == 0 { p += $7; u += $2 } END { print p, u/4 }' CONVFMT=%.16g \
  OFMT=%.16g shell.dat | paste -d ' ' - <(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    { print $at["tip_rz"], $at["tip_ux"] }' shell.out/history.csv) | awk '{ n++; for (k = 1; k <= 2; k++) {
      a = ($k - $(k + 2))/$(k + 2); a = a < 0 ? -a : a; if (a > worst) worst = a } }
    END { printf "shell: %d steps, largest difference from the driver %.1e\n", n, worst; exit n != 8 || !(worst < 1e-8) }' ||
  fail 'shell: host and driver differ'
"$BEZEL" dcb.inp last=2 >driver.txt 2>&1 || fail 'dcb: the driver fails'
sed 's/LOOP,,20/LOOP,,2/' Idcb >Idcb_2
runs Idcb_2
awk '$1 == "time" { if (n++) print p; p = 0 } $1 >= 216 && ($1 - 216) % 43 == 0 { p += $5 } END { print p }' CONVFMT=%.16g \
  OFMT=%.16g dcb.dat | paste -d, - <(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "pull_ry") c = i; next }
    { print $c }' dcb.out/history.csv) | awk -F, '{ a = ($1 - $2)/$2; n++; if (a*a > 1e-16) wrong++
      printf "dcb: step %d, difference from the driver %.1e\n", n, a } END { exit wrong || n != 2 }' ||
  fail 'dcb: host and driver differ'

# Shells in contact by their faces.
cat >Iplates <<'DECK'
FEAP * * a shell pressed on another one
0 0 0 3 3 0

T-SPline MATErial=1
  FILE="plates.out/plates.iga"

CONTact SLAVe=upper MASTer=lower MATErial=2 GP=2 THICkness=0.1

EBOUndary
  1 0.0  1 1 1
  1 1.0  1 1 1

DISPlacement
   17 5  0 0 -0.04
   37 0  0 0 -0.04
   21 5  0 0 -0.04
   41 0  0 0 -0.04

MATErial 1
  BEZShell
  ELAStic STVK 1000 0.3
  THICkness 0.1

MATErial 2
  GPTS
  PENAlty 1e3

END

BATCh
  PROP,,1
  NOPRint
  TOL,,1e-24
  DT,,1
  LOOP,,5
    TIME
    LOOP,,20
      PAIR
      TANG,,1
    NEXT
    PAIR
    REAC,FILE
    NODAl,plates.dat
  NEXT
END
2 1
0 0
5 1

STOP
DECK
"$BEZEL" "$BEZEL_SOURCE/inputs/abaqus/plates_deck.inp" --out plates.out >driver.txt 2>&1 || fail 'plates: the driver fails'
runs Iplates
awk '$1 == "time" { if (n++) print p, q; p = q = 0; next } $1 > 16 && $1 % 5 == 2 { p += $5; q += $7 } END { print p, q }' CONVFMT=%.16g \
  OFMT=%.16g plates.dat | paste -d ' ' - <(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
    { print $at["edge_rx"], $at["edge_rz"] }' plates.out/history.csv) | awk '{ n++; for (k = 1; k <= 2; k++) {
      a = $k - $(k + 2); a = a < 0 ? -a : a; if (a > worst) worst = a }; last = $2 }
    END { printf "plates: %d steps, largest difference from the driver %.1e\n", n, worst; exit n != 5 || !(worst < 1e-8 && last < -0.9) }' ||
  fail 'plates: host and driver differ'

# Faults: the host's error, with the element and a remedy.
refuses() { # refuses LABEL SED TEXT [DECK]
  sed "$2" "${4:-Ipatch_explicit}" >Ibad
  "$host" Ibad >bad.txt 2>&1 && fail "$1: accepted"
  grep -qF -- "$3" bad.txt || { tail -n 3 bad.txt; fail "$1: another message"; }
}
refuses 'property count'  's/ISOTropic 1000 0.3/ISOTropic 1000/' 'material 1: "  ELAStic ISOTropic 1000": write ELAStic'
refuses 'unknown law'     's/ISOTropic 1000 0.3/RUBBer 1 2/' 'Known laws'
refuses 'missing operator' 's/OPERator=1/OPERator=2/' 'element 2: there is no OPERator 2'
refuses 'operator size'   's/NODEs 2 3 4  7 8 9  12 13 14/NODEs 2 3 4  7 8 9  12 13/' 'element 2 needs 8 rows of 9'
refuses 'row length'      's/^  0.5 0   0     0   0   0     0   0   0$/  0.5 0/' 'coefficients'
refuses 'unknown element set' 's/^T-SPline.*/&\n  nosuch 2/' 'no element set "nosuch"' Ipatch_t
refuses 'missing file'    's/patch_t.iga/nofile.iga/' 'nofile.iga: the file cannot be read' Ipatch_t
sed '40,60d' patch_t.iga >short.iga
refuses 'damaged file'    's/patch_t.iga/short.iga/' 'short.iga:' Ipatch_t
refuses 'unknown surface' 's/MASTer=lower.top/MASTer=lower.tip/' 'there is no surface "lower.tip". Known surfaces: lower.left' Idcb
refuses 'edge of a shell' 's/SLAVe=upper/SLAVe=upper.left/' 'CONTact: "upper.left" or "lower" is no surface' Iplates
refuses 'negative thickness' 's/THICkness=0.1$/THICkness=-0.1/' 'not negative' Iplates
cat >Iplain <<'DECK'
FEAP * * an element without operator
0 0 0 2 2 0

COORdinates
  1 0  0 0
  2 0  1 0
  3 0  1 1
  4 0  0 1

ELEMents
  1 0 1  1 2 3 4

BOUNdary
  1 0  1 1
  2 0  1 1

MATErial 1
  BEZSolid
  ELAStic ISOTropic 1000 0.3

END

BATCh
  TANG,,1
END

STOP
DECK
refuses 'no operator'     '' 'element 1 has no extraction operator. Give it by T-SPline or BEZIer' Iplain
refuses 'no interface'    's/BEZSolid/GPTS/; s/ELAStic.*/PENAlty 1/' 'element 1 is no point of an interface' Iplain
sed 's/ELAStic ISOT/ELAStic NEOH/; s/0.012 -0.0024/5.0 -0.0024/' Ipatch_explicit >Iinverted
"$host" Iinverted >bad.txt 2>&1 && fail 'an inverted element is accepted'
grep -q 'element [0-9]*: the element is inverted .* Take smaller steps' bad.txt || { tail -n 3 bad.txt; fail 'inverted: another message'; }

echo "$failures failures"
[ $failures -eq 0 ]
