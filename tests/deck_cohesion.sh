#!/usr/bin/env bash
# A bond over a part of a face: what is dissipated in the end, the energy balance, the fields of the interface points, and
# a restart from a state in the middle of softening, bit for bit.
set -u
deck=$BEZEL_SOURCE/inputs/verify/bond_box.inp
failures=0

fail() {
  echo "$1"
  failures=$((failures + 1))
}

within() { # what value least most
  awk -v v="$2" -v a="$3" -v b="$4" 'BEGIN { exit !(v != "" && v + 0 >= a && v + 0 <= b) }' ||
    fail "$1 is $2, expected between $3 and $4"
}

last() { # folder column: of the last row of the history
  awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } END { if (c) print $c }' "$1/history.csv"
}

largest() { # folder column: its largest size
  awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i; next }
    { v = $c < 0 ? -$c : $c; if (v > m) m = v } END { if (c) print m + 0 }' "$1/history.csv"
}

column() { # file name: an array of one component
  local offset count start
  start=$(grep -abo '<AppendedData encoding="raw">' "$1" | head -n 1 | cut -d: -f1)
  start=$((start + 31))     # behind the tag, the end of its line and the underscore
  offset=$(grep -a -m 1 "Name=\"$2\"" "$1" | sed 's/.*offset="\([0-9]*\)".*/\1/')
  [ -n "$offset" ] || return
  count=$(od -A n -t u8 -j $((start + offset)) -N 8 "$1")
  od -A n -v -t f8 -w8 -j $((start + offset + 8)) -N $((count)) "$1"
}

"$BEZEL" "$deck" --out half >half.txt 2>&1 </dev/null || fail 'half: the run fails'
"$BEZEL" "$deck" bond=1 --out whole >whole.txt 2>&1 </dev/null || fail 'whole: the run fails'
within 'half: dissipated' "$(last half dissipated)" 0.02999999999 0.03000000001
within 'whole: dissipated' "$(last whole dissipated)" 0.05999999999 0.06000000001
within 'half: the largest error of the balance' "$(largest half energy_error)" 1e-12 0.02
within 'whole: the largest error of the balance' "$(largest whole energy_error)" 1e-12 0.02

# two points are cracked from the start; after step 8 (softening) the others are damaged in part, in the end spent
damage=$(column half/interface_000008.vtu damage | awk '{ if ($1 == 1) one++; else if ($1 > 0 && $1 < 1) part++ } END { print one + 0, part + 0 }')
[ "$damage" = '2 2' ] || fail "half: after step 8 the damage is 1 at, and between 0 and 1 at '$damage' points, expected 2 2"
damage=$(column half/interface_000040.vtu damage | awk '$1 == 1 { one++ } END { print one + 0 }')
[ "$damage" = 4 ] || fail "half: in the end $damage points are spent, expected 4"
opening=$(column half/interface_000008.vtu opening | awk '$1 > 0.01 && $1 < 0.03 { n++ } END { print n + 0 }')
[ "$opening" = 2 ] || fail "half: after step 8 $opening points open between strength and end, expected 2"
column half/interface_000008.vtu traction | awk '$1 > 0 { n++ } END { exit n != 2 }' || fail 'half: two points should pull in step 8'

# killed at some instant after the state of step 5 (softening begins), the restart leaves the same history
for trial in 1 2 3; do
  rm -rf broken
  "$BEZEL" "$deck" nu=0.3 n=800 --out broken >broken.txt 2>&1 &
  pid=$!
  while [ ! -e broken/restart.h5 ]; do sleep 0.005; kill -0 $pid 2>/dev/null || break; done
  sleep "0.$((RANDOM % 3))$((RANDOM % 10))"
  kill -9 $pid 2>/dev/null
  wait $pid 2>/dev/null
  echo "trial $trial: killed after step $(tail -n 1 broken/history.csv | cut -d, -f1)"
  "$BEZEL" "$deck" nu=0.3 n=800 --out broken --restart >broken.txt 2>&1 </dev/null || fail "trial $trial: the restart fails"
  [ -d calm ] || "$BEZEL" "$deck" nu=0.3 n=800 --out calm >calm.txt 2>&1 </dev/null
  cmp calm/history.csv broken/history.csv || fail "trial $trial: another history after the restart"
  cmp calm/interface_000040.vtu broken/interface_000040.vtu || fail "trial $trial: other fields after the restart"
done

echo "cohesion decks: $failures failures"
[ $failures -eq 0 ]
