# check.sh FAILING_TESTS [PREPROCESSOR]: every failing test is reported and counted, and the run's status says so; the
# preprocessor refuses malformed files with file and line. Without a second argument (pFUnit) only the first half.
here=$(dirname "$0")
failing=$1 preprocessor=$2
failed=0
fail() { echo "runner: $1"; failed=1; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$failing" >"$scratch/out" 2>&1 && fail "failing tests end with status 0"
count=$(grep -c '^ *@test' "$here/test_failing.pf")
grep -q '^ *FAILURES!!!' "$scratch/out" || fail "no line FAILURES!!!"
grep -q "Tests run: $count, Failures: $count, Errors: 0" "$scratch/out" ||
  fail "$count tests must fail: $(grep 'Tests run' "$scratch/out")"
grep -q 'not to be reached' "$scratch/out" && fail "a test goes on after a failed assertion"
line=$(($(grep -n 'subroutine failing_on_purpose' "$here/test_failing.pf" | head -n 1 | cut -d: -f1) + 1))
grep -q "test_failing.pf:$line" "$scratch/out" || fail "no place test_failing.pf:$line for assertFail"
[ -n "$preprocessor" ] || exit $failed

line=$(grep -n 'message=.said.' "$here/test_failing.pf" | cut -d: -f1)
for words in "test_failing.pf:$line: .*reals_beyond_the_tolerance: said: expected 1.0*, found 1.50*, difference 0.50*" \
  'one_element_of_a_matrix_differs: .* at \[2,1\]$' 'vectors_of_different_lengths: expected shape \[2\], found \[3\]'; do
  grep -q "$words" "$scratch/out" || fail "no line with $words"
done
"$failing" --filter reals_ >"$scratch/out" 2>&1
grep -q 'Tests run: 2,' "$scratch/out" || fail "the filter reals_ does not select two tests"
"$failing" --filter no_such_name >/dev/null 2>&1 && fail "a filter that selects nothing ends with status 0"

# refused FILE: the preprocessor fails, leaves no output behind, and what it says is in found.
refused() {
  "$preprocessor" "$1" "$scratch/out.F90" >"$scratch/found" 2>&1 && fail "$1 is accepted"
  [ ! -e "$scratch/out.F90" ] || { fail "$1 leaves an output behind"; rm "$scratch/out.F90"; }
}

# Each comment !!! says what is wrong with the line below it.
refused "$here/malformed.pf"
awk '/^ *!!! / { sub(/^ *!!! /, ""); print FILENAME ":" FNR + 1 ": " $0 }' "$here/malformed.pf" >"$scratch/wanted"
while IFS= read -r wanted; do
  grep -qF "$wanted" "$scratch/found" || fail "not said: $wanted"
done <"$scratch/wanted"
[ "$(wc -l <"$scratch/wanted")" = "$(sort -u "$scratch/found" | wc -l)" ] || {
  fail "more or less is said than this:"
  cat "$scratch/found"
}

# whole NAME TEXT WORDS: a file of this name and text is refused with these words.
whole() {
  printf "$2" >"$scratch/$1"
  refused "$scratch/$1"
  grep -qF "$3" "$scratch/found" || fail "$1 is not refused with: $3"
}
whole test_b.pf 'module test_a\n@test\nsubroutine a()\nend subroutine a\nend module test_a\n' \
  'test_b.pf:1: expected "module test_b"'
whole test_a.pf 'module test_a\nend module test_a\n' \
  'the file holds no @test'
whole test_a.pf 'module test_a\nend module test_a\nmodule test_c\nend module test_c\n' \
  'test_a.pf:3: a second module'
whole test_a.pf '@test\nsubroutine a()\nend subroutine a\n' \
  'test_a.pf:1: a directive before the module statement'
whole test_a.pf 'module test_a\n@test\n' \
  'test_a.pf:2: no subroutine follows'
whole test_a.pf '' \
  'the file holds no "module test_a"'
exit $failed
