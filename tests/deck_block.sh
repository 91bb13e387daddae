#!/usr/bin/env bash
# Only what a scene requires: a linear block without interface is solved once, without search, contact and history.
set -u
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

"$BEZEL" "$BEZEL_SOURCE/inputs/block.inp" --out block.out >block.txt 2>&1 </dev/null || fail "exit status $?"
grep -q ' 0 interface points' block.txt || fail 'interface points'
grep -Eq '^  (search|contact) ' block.txt && fail 'time was spent on search or contact'
grep -q ', 1 factorisations (0 not positive definite), 1 patterns' block.txt || fail 'not one factorisation and one pattern'
grep -q 'solver CHOLMOD' block.txt || fail 'not the symmetric solver'
# one assembly with tangent, one residual that finds the solution exact
grep -Eq '^  elements .* 2 calls' block.txt || fail 'more than two passes over the elements'
grep -Eq '^  (factorise|solve|analyse|pattern|prepare) .* 1 calls' block.txt || fail 'something was done twice'
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i }
  END {
    bad = NR != 2 || $at["active"] != 0 || $at["iterations"] != 1
    d = $at["right_ux"] - 0.01; if (d*d > 1e-28) bad = 1
    d = $at["top_uy"] + 0.003; if (d*d > 1e-28) bad = 1
    d = $at["left_rx"] + 10; if (d*d > 1e-22) bad = 1
    if (bad) print "wrong history: " $0
    exit bad }' block.out/history.csv || failures=$((failures + 1))

# Memory is that of the mesh: 22500 bilinear elements and 45450 equations take about 110 MB.
"$BEZEL" "$BEZEL_SOURCE/inputs/block.inp" n=150 p=1 --out peak.out >/dev/null 2>&1 </dev/null &
id=$!
most=0
while now=$(awk '/VmHWM/ { print $2 }' /proc/$id/status 2>/dev/null) && [ -n "$now" ]; do
  most=$now
  sleep 0.01
done
wait $id || fail "the fine mesh: exit status $?"
echo "peak memory of 22500 elements: $most kB"
[ "$most" -gt 0 ] && [ "$most" -lt 200000 ] || fail "peak memory $most kB, expected less than 200000"

echo "$failures failures"
[ $failures -eq 0 ]
