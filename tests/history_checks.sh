# For the deck tests that compare the last row of a history with expected numbers: sourced by them.
failures=0

solve() { # label deck [name=value ...]: a file, or a deck's name in inputs/ without .inp
  local label=$1 deck=$2 status
  shift 2
  [ "${deck%.inp}" != "$deck" ] || deck=$BEZEL_SOURCE/inputs/$deck.inp
  "$BEZEL" "$deck" "$@" --out "$label.out" >"$label.txt" 2>&1 </dev/null
  status=$?
  [ $status -eq 0 ] && return
  echo "$label: exit status $status"
  cat "$label.txt"
  failures=$((failures + 1))
}

expect() { # label column expected tolerance [step]: in the last row of the history, or in that of a step
  awk -F, -v name="$2" -v expected="$3" -v tolerance="$4" -v label="$1" -v step="${5-}" '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) column = i }
    NR > 1 && (step == "" || $1 == step) { found = $column; rows++ }
    END {
      if (!column || !rows) { print label ": no column or row for " name; exit 1 }
      error = found - expected
      if (error < 0) error = -error
      if (!(error <= tolerance)) {
        print label ": " name " expected " expected " found " found " tolerance " tolerance
        exit 1
      }
    }' "$1.out/history.csv" || failures=$((failures + 1))
}
