#!/usr/bin/env bash
# A run killed at random instants and continued each time leaves the history of an undisturbed run, bit for bit.
# Usage: BEZEL=path deck_restart.sh [kills]     (default 3)
set -u
deck=$BEZEL_SOURCE/inputs/ironing.inp
kills=${1-3}
arguments=("$deck" basis=N p=2 last=60)
failures=0

"$BEZEL" "${arguments[@]}" --out whole >whole.txt || exit 1
for trial in $(seq "$kills"); do
  rm -rf broken
  "$BEZEL" "${arguments[@]}" --out broken >broken.txt 2>&1 &
  pid=$!
  sleep "0.$((RANDOM % 70 + 15))"
  kill -9 $pid 2>/dev/null
  wait $pid 2>/dev/null
  # killed again while it continues, then left to its end
  if [ -e broken/restart.h5 ]; then
    "$BEZEL" "${arguments[@]}" --out broken --restart >broken.txt 2>&1 &
    pid=$!
    sleep "0.$((RANDOM % 20 + 5))"
    kill -9 $pid 2>/dev/null
    wait $pid 2>/dev/null
    "$BEZEL" "${arguments[@]}" --out broken --restart >broken.txt 2>&1
  else
    "$BEZEL" "${arguments[@]}" --out broken --restart >broken.txt 2>&1 && { echo "a restart without state must fail"; failures=1; }
    "$BEZEL" "${arguments[@]}" --out broken >broken.txt 2>&1
  fi
  status=$?
  rows=$(wc -l <broken/history.csv)
  if [ $status -ne 0 ] || ! cmp -s whole/history.csv broken/history.csv; then
    echo "trial $trial: exit $status, $rows rows; first difference: $(diff whole/history.csv broken/history.csv | head -n 2 | tail -n 1)"
    failures=1
  fi
  cmp -s whole/fields.pvd broken/fields.pvd || { echo "trial $trial: fields.pvd differs"; failures=1; }
done
# killed after the last step but before its fields were written: they are written, and only then
cp -r whole late
sed -i '/fields_000060/d' late/fields.pvd
"$BEZEL" "${arguments[@]}" --out late --restart >late.txt 2>&1 || { echo "the restart after the last step fails"; failures=1; }
cmp whole/fields.pvd late/fields.pvd || failures=1
cmp whole/history.csv late/history.csv || failures=1
# other parameters are refused with status 2
"$BEZEL" "$deck" basis=N p=3 last=60 --out whole --restart >refused.txt 2>&1
[ $? -eq 2 ] || { echo "a restart with another parameter must be refused with status 2"; failures=1; }
exit $failures
