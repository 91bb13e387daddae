# From what ctest writes with --output-junit: the output of the failed entries without the names of passed tests, and
# the number of tests. An entry of the unit-test runner counts each of its tests, any other counts one.

function text(line) {
  gsub(/&lt;/, "<", line); gsub(/&gt;/, ">", line); gsub(/&quot;/, "\"", line); gsub(/&apos;/, "'", line)
  gsub(/&amp;/, "\\&", line)
  return line
}

function finish(    i, n) {
  if (status == "disabled") return
  if (!closed) {
    n = finished - wrong
    passed += status == "run" && n == 0 ? 1 : n
    failed += wrong + (status != "run")
  } else if (status != "run" && !entry_failed) {
    failed++
  }
  if (status == "run") return
  printf "\n%s failed:\n", name
  for (i = 1; i <= count; i++) print "  " kept[i]
  if (running != "") print "  The process ended within " running "."
}

/<testcase / {
  name = $0; sub(/.*<testcase name="/, "", name); sub(/".*/, "", name); name = text(name)
  status = $0; sub(/.* status="/, "", status); sub(/".*/, "", status)
  count = closed = finished = wrong = entry_failed = inside = 0
  running = ""
  next
}
/<\/testcase>/ { finish(); next }
/<system-out>/ { inside = 1; sub(/.*<system-out>/, "") }
inside {
  last = sub(/<\/system-out>.*/, "")
  line = text($0)
  if (line ~ /^[ .FEI]*Start: </) {
    running = line; sub(/.*Start: </, "", running); sub(/>$/, "", running)
  } else if (line ~ /^[ .FEI]*end: </) {
    finished++
    running = ""
  } else if (line ~ /^[ .FEI]*Failure in </) {
    wrong++
  } else if (line ~ /^ \([0-9]+ tests?(, [0-9]+ disabled)?\)$/) {
    closed = 1
    split(line, words, /[( ]+/)
    passed += words[2]
  } else if (line ~ /^Tests run: [0-9]+, Failures: [0-9]+, Errors: [0-9]+/) {
    closed = 1
    split(line, words, /[:,] */)
    entry_failed = words[4] + words[6]
    passed += words[2] - entry_failed
    failed += entry_failed
  } else if (line !~ /^[ .FEI]*$/ && line !~ /^ *(Time: .*|FAILURES!!!|OK|, Disabled: [0-9]+)$/) {
    kept[++count] = line
  }
  if (last) inside = 0
}

END {
  if (passed + failed == 0 || (failed == 0 && ctest_status != 0)) {
    print "ctest itself failed with status " ctest_status
    failed++
  }
  printf "\n%d passed, %d failed\n", passed, failed
  exit failed > 0
}
