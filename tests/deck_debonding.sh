#!/usr/bin/env bash
# Debonding decks against their closed forms: the bar that snaps back, the double cantilever beam under end rotations and
# under end displacements, energies, Newton's convergence, and a run that is killed in the middle of softening.
set -u
inputs=$BEZEL_SOURCE/inputs
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }
# rows FILE SCRIPT: awk over a history.csv with column[name] set; what it prints is wrong
rows() {
  awk -F, "function v(name) { return \$column[name] }
           function far(a, b, tolerance) { return (a - b)^2 > tolerance^2 }
           NR == 1 { for (i = 1; i <= NF; i++) column[\$i] = i; next }
           $2" "$1" >wrong.txt || fail "$1 cannot be read"
  while read -r line; do fail "$1: $line"; done <wrong.txt
}

# Every point of the snap-back on u = sigma 2L/E + g(sigma); the residual tolerance 1e-9 on sigma leaves 1e-10 of u.
"$BEZEL" "$inputs/snap_back.inp" --out bar >bar.txt 2>&1 || fail "bar: exit status $?"
rows bar/history.csv '
  { u = v("end_ux"); s = v("end_rx"); d = v("dissipated") }
  d == 0 && far(u, 0.104*s, 1e-8) { print "rising: u = " u " at sigma = " s }
  d > 0 && s > 1e-9 { soft++; if (far(u, 0.04 + 0.064*s, 1e-8)) print "going back: u = " u " at sigma = " s }
  d > 0 && s > 1e-9 && far(d, 0.02*(1 - s), 1e-8) { print "dissipated " d " at sigma = " s }
  u > peak { peak = u }
  v("energy_error")^2 > 1e-8 { print "energy_error " v("energy_error") }
  END {
    if (soft < 15) print "only " soft + 0 " points while sigma falls"
    if (far(d, 0.02, 1e-12)) print "dissipated in the end: " d ", expected 0.02"
    if (s^2 > 1e-18 || far(u, 0.12, 1e-9)) print "not apart in the end: sigma = " s ", u = " u
  }'
"$BEZEL" "$inputs/snap_back.inp" path=OFF --out jump >jump.txt 2>&1
[ $? -eq 1 ] || fail "without path following the bar must stop with status 1"
rows jump/history.csv 'END { if (v("end_ux") < 0.1035 || v("end_ux") > 0.104001) print "stopped at u = " v("end_ux") }'

# What is prescribed at time 0 already does work (bar of stiffness 1000), and path following finds that state by time.
jump=$BEZEL_SOURCE/tests/decks/jump_at_start.inp
for path in off auto arc; do
  "$BEZEL" "$jump" path=$path --out "jump_$path" >"jump_$path.txt" 2>&1 || fail "jump, path=$path: exit status $?"
  rows "jump_$path/history.csv" '
    { u = v("end_ux"); rows++ }
    far(v("work"), 500*u*u, 1e-9) || far(v("elastic"), 500*u*u, 1e-9) { print "work " v("work") " at u = " u }
    END { if (rows != 4 || u < 0.09) print rows + 0 " rows, the last at u = " u }'
done
sed 's/PATH ARClength LENGth=0.01 UNTIl=1/PATH DISSipation/' "$jump" >no_bond.inp
"$BEZEL" no_bond.inp path=arc --out no_bond >no_bond.txt 2>&1
[ $? -eq 2 ] || fail 'PATH DISSipation without a cohesive interface must be refused with status 2'
grep -q 'no interface of the deck is cohesive' no_bond.txt || fail 'PATH DISSipation without cohesion: no such message'
sed 's/PATH AUTO UNTIl=1/PATH AUTO UNTIl=0/' "$jump" >past.inp
"$BEZEL" past.inp path=auto --out past >past.txt 2>&1 || fail "UNTIl=0: exit status $?"
grep -q 'is not before UNTIl' past.txt || fail 'UNTIl in the past: no message'

# Moments before the crack grows within 1 %, afterwards M_c within what 1 mm elements oscillate by.
"$BEZEL" "$inputs/dcb_ebm.inp" basis=N last=0.04 --out ebm >ebm.txt 2>&1 || fail "ebm: exit status $?"
rows ebm/history.csv '
  { r = v("arm_rot"); m = v("arm_m"); d = v("dissipated") }
  function early(rotation, expected) {
    if (r_n < rotation && rotation <= r && ++seen) {
      m_r = m_n + (m - m_n)*(rotation - r_n)/(r - r_n)
      if (far(m_r, expected, 0.01*expected)) print "M = " m_r " at rotation " rotation ", expected " expected
    }
  }
  { early(0.005, 8.81); early(0.01, 17.15); early(0.02, 30.17); r_n = r; m_n = m }
  m >= 0.999*32.931 { grows = 1 }
  grows { if (d > d_n && n++) { sum += m*(d - d_n); all += d - d_n }
          if (far(m, 32.931, 0.01*32.931)) print "M = " m " at rotation " r }
  { d_n = d }
  v("energy_error")^2 > 1e-6 { print "energy_error " v("energy_error") }
  END {
    if (seen != 3) print "rotations missed"
    if (n < 15) print "only " n + 0 " points while the crack grows"
    if (n > 0 && far(sum/all, 32.931, 0.003*32.931)) print "mean of M " sum/all ", expected 32.931"
  }'

# A bond from 4 to 14, of elements of 2 mm: torn through, it has dissipated G_IC times its area.
"$BEZEL" "$inputs/dcb_ebm.inp" basis=N mesh=1 gp=4 penalty=1e3 glued=14 last=0.05 --out whole >whole.txt 2>&1 || fail "whole: exit status $?"
rows whole/history.csv 'END { if (far(v("dissipated"), 1, 1e-12) || v("active") != 0) print "dissipated " v("dissipated") ", active " v("active") }'

# Opened by displacements: beam theory before and while the crack grows; corrections e_(k+1) <= 10 e_k^2 (e_k of 1e-3 to 1e-5
# fall by more than 100) in most of the points; going on after a kill in the middle of softening gives the same, bit for bit.
sed 's/^BATCh/BATCh\n  PRINt/; s/^OUTPut NONE/OUTPut NONE\nRESTart EVERy=4/' "$inputs/dcb_opening.inp" >opening.inp
"$BEZEL" opening.inp last=0.5 --out opening >opening.txt 2>&1 || fail "opening: exit status $?"
rows opening/history.csv '
  { u = v("up_uy"); p = v("up_ry"); d = v("dissipated"); ei = 122e3/(1 - 0.0625)/12; k = (2/(0.004*ei))^0.25 }
  d == 0 && far(p*(8000 + 1200/k + 60/k^2 + 1.5/k^3)/(3*ei*u), 1, 0.015) { print "P = " p " at u = " u " before the crack grows" }
  d > 0.08 { n++; if (far(p, (0.02*ei)^0.75/sqrt(3*ei*u), 0.005*p)) print "P = " p " at u = " u ", beam theory says " (0.02*ei)^0.75/sqrt(3*ei*u) }
  v("energy_error")^2 > 1e-6 { print "energy_error " v("energy_error") }
  END { if (n < 20) print "only " n + 0 " points while the crack grows" }'
awk '
  /^  iteration/ { n = $2 + 0; c[n] = $8; switched[n] = $12 }
  /by dissipation/ && n >= 4 && !switched[n] && !switched[n - 1] { judged++; if (c[n - 1] <= 10*c[n - 2]^2) good++ }
  END { if (judged < 20 || good < 0.8*judged) print "corrections of " good + 0 " of " judged + 0 " points are quadratic" }' opening.txt >slow.txt
while read -r line; do fail "$line"; done <slow.txt

"$BEZEL" opening.inp last=0.5 --out broken >broken.txt 2>&1 &
pid=$!
for wait in $(seq 2000); do
  [ "$(grep -c . broken/history.csv 2>/dev/null || echo 0)" -lt 25 ] || break
  sleep 0.01
done
kill -9 $pid 2>/dev/null
wait $pid 2>/dev/null
[ "$(grep -c . broken/history.csv)" -lt "$(grep -c . opening/history.csv)" ] || fail "the run could not be killed before its end"
"$BEZEL" opening.inp last=0.5 --out broken --restart >broken.txt 2>&1 || fail "restart: exit status $?"
cmp opening/history.csv broken/history.csv || fail "the restarted history differs"
[ $failures -eq 0 ]
