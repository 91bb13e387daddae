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

again_from_file() { # file: a triangular plate that a run has written, with its edge1 clamped and a force at its tip, solved again
  cat >again.inp <<EOF
FEAP * * the plate from its file
0 0 0 3 3

T-SPline FILE="$1" MATErial=1

MATErial 1
  SHELl
  ELAStic ISOTropic 1e6 0.3
  THICkness 0.2
  SMALl

CLAMp plate.edge1

FORCe
  tip 0 0 1e-3

HISTory tip SET=tip DISPlacement

END
BATCh
  DT,,1
  TIME
  TANG,,1
END
STOP
EOF
  solve again again.inp
  expect again tip_uz "$(awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "tip_uz") c = i } { v = $c } END { print v }' "${1%/*}/history.csv")" 1e-15
}
