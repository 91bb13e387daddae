# check.sh LINK_ALONE COMPILER MODULES: shapes and elements need nothing but the compiler's own libraries, and a layer
# cannot use one above it.
program=$1 compiler=$2 modules=$3
failed=0
fail() { echo "layers: $1"; failed=1; }

"$program" >/dev/null || fail "$program does not run"
foreign=$(ldd "$program" | grep -iE 'cholmod|umfpack|amd|suitesparse|metis|hdf5|blas|lapack')
[ -z "$foreign" ] || fail "shapes and elements alone need $foreign"

# compiles MODULE FOLDER...: whether a source with `use MODULE` compiles when it sees these module folders.
compiles() {
  local source=$scratch/use_$1.f90
  printf 'subroutine probe()\n  use %s\nend subroutine probe\n' "$1" >"$source"
  shift
  "$compiler" -fsyntax-only "${@/#/-I$modules/}" "$source" >/dev/null 2>&1
}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
compiles build_info driver || fail "a source of the driver cannot use a module of the driver"
compiles interface_law shapes elements || fail "a source of elements cannot use a module of elements"
compiles kinds shapes elements || fail "a source of elements cannot use a module of shapes"
compiles interface_law shapes && fail "a source of shapes can use a module of elements"
compiles build_info shapes elements && fail "a source of elements can use a module of the driver"
exit $failed
