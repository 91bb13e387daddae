# Decks of contact against closed forms: patch tests with blocks that do not match, Hertz in the plane and in space.
# The pressures of the interface points are read from interface_*.vtu by grep and od.
set -u
failures=0

fail() {
  echo "$1"
  failures=$((failures + 1))
}

solve() { # label deck [name=value ...]
  local label=$1 deck=$2 status
  shift 2
  "$BEZEL" "$BEZEL_SOURCE/inputs/verify/$deck.inp" "$@" --out "$label.out" >"$label.txt" 2>&1 </dev/null
  status=$?
  [ $status -eq 0 ] && return
  fail "$label: exit status $status"
  cat "$label.txt"
}

points() { # label: x y z pressure of each interface point
  local file start
  file=$(ls "$1.out"/interface_*.vtu | tail -n 1)
  start=$(grep -abo '<AppendedData encoding="raw">' "$file" | head -n 1 | cut -d: -f1)
  start=$((start + 31))     # behind the tag, the end of its line and the underscore
  paste -d ' ' <(column "$file" "$start" Points 24) <(column "$file" "$start" traction 8)
}

column() { # file start name bytes-per-point
  local offset count
  offset=$(grep -a -m 1 "Name=\"$3\"" "$1" | sed 's/.*offset="\([0-9]*\)".*/\1/')
  count=$(od -A n -t u8 -j $(($2 + offset)) -N 8 "$1")
  od -A n -v -t f8 -w"$4" -j $(($2 + offset + 8)) -N $((count)) "$1"
}

within() { # label what value least most
  awk -v v="$3" -v a="$4" -v b="$5" 'BEGIN { exit !(v != "" && v + 0 >= a && v + 0 <= b) }' ||
    fail "$1: $2 is $3, expected between $4 and $5"
}

last() { # label column: of the last row of the history
  awk -F, -v name="$2" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) c = i } END { if (c) print $c }' \
    "$1.out/history.csv"
}

balanced() { # label component relative-tolerance: top and bottom reactions cancel
  local top bottom
  top=$(last "$1" "top_$2")
  bottom=$(last "$1" "bottom_$2")
  within "$1" "the sum of the reactions over the load" \
    "$(awk -v a="$top" -v b="$bottom" 'BEGIN { if (a < 0) print (a + b)/-a }')" "-$3" "$3"
}

patch() { # label deck exact-pressure largest-error [name=value ...]
  local label=$1 exact=$3 most=$4 deck=$2 component
  shift 4
  solve "$label" "$deck" "$@"
  within "$label" "the largest relative error of the pressure" "$(points "$label" |
    awk -v exact="$exact" '{ e = -$4/exact - 1; if (e < 0) e = -e; if (e > m) m = e; n++ } END { if (n) print m }')" 0 "$most"
  component=ry
  [ "$deck" = contact_patch_3d ] && component=rz
  balanced "$label" $component 1e-9
}

# Exact pressures: press/(1 - nu^2 + 1/penalty) and press/(1 + 1/penalty). Matching meshes are exact to rounding: the gap is
# p/penalty = 1e-5 of coordinates of 1, so 1e-10. Others have the error of the Gauss rule; the bounds are the measured
# errors (tests/study contact_patch) with a third to spare.
plane=1.09769484083424e-2
space=9.99000999000999e-3
patch matching_2d contact_patch_2d $plane 1e-9 upper=4 lower=4
patch matching_2d_l contact_patch_2d $plane 1e-9 upper=5 lower=5 basis=L p=3 gp=4
patch upper_2d_2 contact_patch_2d $plane 0.08 gp=2
patch upper_2d_8 contact_patch_2d $plane 0.0012 gp=8
patch lower_2d_8 contact_patch_2d $plane 0.0052 gp=8 slave=lower
patch cubic_2d_8 contact_patch_2d $plane 0.00013 gp=8 p=3
patch matching_3d contact_patch_3d $space 1e-9 upper=2 lower=2
patch upper_3d contact_patch_3d $space 0.013 gp=6
patch lower_3d contact_patch_3d $space 0.0046 gp=6 slave=lower

# Hertz: load P on the whole, then a and p0; relative errors of the mean pressure within half the radius, of the radius of
# contact (from the second moment in the plane, the last pressed point in space), of the whole profile.
hertz() { # label dimension
  local load
  if [ "$2" = 2 ]; then load=$(last "$1" top_ry); else load=$(last "$1" top_rz); fi
  points "$1" | awk -v dimension="$2" -v load="$load" '
    function root(x) { return x > 0 ? exp(log(x)/3) : 0 }
    BEGIN {
      pi = 3.14159265358979; E = 1/(2*0.91)
      if (dimension == 2) { P = -2*load; a = sqrt(4*P/(pi*E)); p0 = sqrt(P*E/pi) }
      else { P = -4*load; a = root(3*P/(4*E)); p0 = 1.5*P/(pi*a*a) }
    }
    {
      r = dimension == 2 ? $1 : sqrt($1*$1 + $2*$2)
      p = -$4
      exact = r < a ? p0*sqrt(1 - r*r/(a*a)) : 0
      square += (p - exact)^2; whole += exact^2
      if (r < a/2) { n++; ratio += p/exact }
      if (p > 0 && r > edge) edge = r
      if (NR == 1) before = 0; else if (r < before) disorder = 1
      if (NR == 1) q = p
      force += (r - before)*(p + q)/2
      moment += (r - before)*(p*r*r + q*before*before)/2
      before = r; q = p
    }
    END {
      width = dimension == 2 && !disorder ? 2*sqrt(moment/force) : edge
      print ratio/n - 1, width/a - 1, sqrt(square/whole)
    }'
}

solve hertz_2d hertz_2d
balanced hertz_2d ry 1e-9
read -r middle width profile <<<"$(hertz hertz_2d 2)"
within hertz_2d "the load" "$(last hertz_2d top_ry)" -2.6057e-4 -2.5796e-4
within hertz_2d "the error of the pressure in the middle" "$middle" -0.02 0.02
within hertz_2d "the error of the half-width" "$width" -0.03 0.03
within hertz_2d "the error of the pressure profile" "$profile" 0 0.08

solve hertz_3d hertz_3d
balanced hertz_3d rz 1e-9
read -r middle width profile <<<"$(hertz hertz_3d 3)"
within hertz_3d "the error of the pressure in the middle" "$middle" -0.035 0.035
within hertz_3d "the error of the radius of contact" "$width" -0.06 0.06
within hertz_3d "the error of the pressure profile" "$profile" 0 0.13

# A block that would move through a plate in one increment: that is refused, and shorter ones find the contact.
leap=$BEZEL_SOURCE/tests/decks/leap.inp
for settings in 'moves=block' 'moves=plate' 'side=-1'; do
  for steps in 1 20; do
    # shellcheck disable=SC2086
    "$BEZEL" "$leap" $settings steps=$steps --out "leap$steps.out" >"leap$steps.txt" 2>&1 </dev/null || fail "leap, $settings steps=$steps: the run fails"
  done
  grep -q 'increments were cut back because slave points moved past the search distance' leap1.txt || fail "leap, $settings: not said"
  grep -q 'moved past the search distance' leap20.txt && fail "leap, $settings: said although increments are short"
  within "leap, $settings" 'the force of one step over that of 20 short ones' \
    "$(awk -v a="$(last leap1 top_ry)" -v b="$(last leap20 top_ry)" 'BEGIN { print b < -100 ? a / b : "no force" }')" 0.9999999 1.0000001
done

echo "contact decks: $failures failures"
[ $failures -eq 0 ]
