#!/usr/bin/env bash
# Faulty decks: exit status 2, and one message for each `! expect:` comment, at its line (`! expect anywhere:`: at any
# line), no more and no fewer.
set -u
failures=0

check() {
  local deck=$1 name=${1##*/} before=$failures output status expected found
  output=$("$BEZEL" "$deck" --check 2>&1 </dev/null)
  status=$?
  if [ $status -ne 2 ]; then
    echo "$name: exit status $status, expected 2"
    failures=$((failures + 1))
  fi
  expected=$(grep -c '! expect' "$deck")
  found=$(grep -c "$name:[0-9]*: " <<<"$output")
  if [ "$expected" -ne "$found" ]; then
    echo "$name: $found messages, expected $expected"
    failures=$((failures + 1))
  fi
  while IFS= read -r line; do
    case $line in
      *'! expect anywhere: '*)
        grep -qF -- "${line#*! expect anywhere: }" <<<"$output" && continue ;;
      *)
        grep -F -- "$name:${line%%:*}: " <<<"$output" | grep -qF -- "${line#*! expect: }" && continue ;;
    esac
    echo "$name: missing: $line"
    failures=$((failures + 1))
  done < <(grep -n '! expect' "$deck")
  if [ $failures -ne $before ]; then echo "$output"; fi
}

count=0
for deck in "$BEZEL_SOURCE"/tests/decks/bad_*.inp; do
  check "$deck"
  count=$((count + 1))
done
echo "$count faulty decks, $failures failures"
[ $count -gt 0 ] && [ $failures -eq 0 ]
