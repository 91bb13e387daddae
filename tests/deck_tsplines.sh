#!/usr/bin/env bash
# Decks of T-splines against expected numbers: patch tests, merged patches, singular corners.
set -u
. "$BEZEL_SOURCE/tests/history_checks.sh"

# Patch tests: values of 1e-2, forces of 10; rounding times the condition of the systems, and what the Gauss rule leaves.
for refine in CELLs SIDE ROWS SPLIt NONE; do
  solve "plane_$refine" verify/patch_t refine=$refine
  expect "plane_$refine" corner_ux 0.014 1e-13
  expect "plane_$refine" corner_uy 0.003 1e-13
  expect "plane_$refine" supports_rx 0 1e-11
  expect "plane_$refine" supports_ry 0 1e-11
  expect "plane_$refine" elastic 0.09375 1e-12
done
for refine in CELLs ROWS NONE; do
  solve "space_$refine" verify/patch_t_3d refine=$refine
  expect "space_$refine" corner_ux 0.0134 1e-12
  expect "space_$refine" corner_uy 0.0083 1e-12
  expect "space_$refine" corner_uz -0.004 1e-12
  expect "space_$refine" supports_rx 0 1e-10
  expect "space_$refine" supports_ry 0 1e-10
  expect "space_$refine" supports_rz 0 1e-10
  expect "space_$refine" elastic 0.08105769230769231 1e-12
done

# Merged patches: one body without gap (its area is that of the outline), one field.
for smooth in C0 C1 C2; do
  solve "merge_$smooth" verify/merge_t smooth=$smooth
  expect "merge_$smooth" corner_ux 0.029 1e-13
  expect "merge_$smooth" corner_uy 0.003 1e-13
  expect "merge_$smooth" supports_rx 0 1e-11
  expect "merge_$smooth" supports_ry 0 1e-11
  expect "merge_$smooth" elastic 0.234375 1e-12
  "$BEZEL" "$BEZEL_SOURCE/inputs/verify/merge_t.inp" smooth=$smooth --check </dev/null | awk -v label="merge_$smooth" '
    $1 == "body" { bodies++; area = $NF }
    END {
      if (bodies == 1 && (area - 2.5)^2 < 1e-24) exit
      print label ": " bodies " bodies, area " area ", expected one of 2.5"
      exit 1
    }' || failures=$((failures + 1))
done
output=$("$BEZEL" "$BEZEL_SOURCE/inputs/verify/merge_t.inp" shift=0.1 --check 2>&1 </dev/null)
status=$?
if [ $status -ne 2 ] || [ "$(grep -c 'inp:[0-9]*: ' <<<"$output")" -ne 1 ] \
  || ! grep -q 'merge_t.inp:[0-9]*: MERGe: the edges are not the same curve: .* are 0.1[0-9]* apart' <<<"$output"; then
  echo "edges 0.1 apart: exit status $status"
  echo "$output"
  failures=$((failures + 1))
fi

# Singular corners: T-splines with 1566 dofs miss 4.3e-8 of the energy, uniform NURBS with 2450 dofs 5e-5 of it.
solve corners_T verify/corners_t
expect corners_T elastic 0.44407158911 3e-8
expect corners_T left_rx -1 1e-12
solve corners_N verify/corners_t basis=N n=32
expect corners_N elastic 0.4440486 1e-7

echo "$failures failures"
[ $failures -eq 0 ]
