#!/usr/bin/env bash
# Ironing with N3 on mesh 1 through pressing and 40 sliding steps: runs to its end without cut-backs, Newton ends with
# quadratic convergence, forces balance, and the press-in force is that of the converged problem within 0.2 %
# (finer meshes with more points: 0.03974, tests/study trade).
set -u
deck=$BEZEL_SOURCE/inputs/ironing.inp
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

sed 's/^BATCh/BATCh\n  PRINt/' "$deck" >printed.inp
"$BEZEL" printed.inp basis=N last=60 --out out >out.txt || fail "exit status $?"
awk -F, '
  NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
  { cutbacks += $column["cutbacks"]; rows++ }
  $1 == 20 { py = $column["top_ry"]; px = $column["top_rx"]; uy = $column["top_uy"] }
  $1 == 60 { ux = $column["top_ux"] }
  END {
    if (rows != 60) print "expected 60 rows, found " rows
    if (cutbacks != 0) print "expected no cut-backs, found " cutbacks
    if ((py + 0.03975)^2 > (0.002 * 0.03975)^2) print "press-in force " py ", expected -0.03975 within 0.2 %"
    if (px^2 > (2e-3 * py)^2) print "horizontal force " px " at the start of the slide"
    if ((uy + 0.05)^2 > 1e-24) print "top_uy " uy " is not -0.05"
    if ((ux - 0.025)^2 > 1e-24) print "top_ux " ux " is not 0.025"
  }' out/history.csv >wrong.txt
while read -r line; do fail "$line"; done <wrong.txt
# e_(k+1) <= C e_k^2 for the last corrections of a step in which no point switched any more. C = 1000 per length: e_k is
# 1e-5 to 1e-7 there, so linear convergence at a rate of 1/100 would already fail.
awk '
  /^  iteration/ { n = $2 + 0; c[n] = $8; switched[n] = $12 }
  /^step/ {
    if (n >= 4 && !switched[n] && !switched[n - 1] && c[n - 1] > 0) {
      judged++
      if (c[n - 1] > 1000 * c[n - 2]^2) print "step " $2 ": corrections " c[n - 2], c[n - 1] " are not quadratic"
    }
    n = 0
  }
  END { if (judged < 10) print "only " judged + 0 " steps could be judged" }' out.txt >slow.txt
while read -r line; do fail "$line"; done <slow.txt
[ -s out/fields.pvd ] && [ -s out/results.vtkhdf ] && [ -s out/restart.h5 ] || fail "a result file is missing"
[ $failures -eq 0 ]
