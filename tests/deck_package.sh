#!/usr/bin/env bash
# `cmake --install`, moved to another place, serves a project in Fortran and C, one in C alone, and pkg-config.
set -u
failures=0
fail() { echo "$*"; failures=$((failures + 1)); }

build=$(dirname "$BEZEL")
compiler() { sed -n "s/^CMAKE_$1_COMPILER:[A-Z]*=//p" "$build/CMakeCache.txt"; }
cmake --install "$build" --prefix "$PWD/first" >install.txt 2>&1 || { cat install.txt; fail 'the installation failed'; }
mv first moved
"$PWD/moved/bin/bezel" --version >/dev/null || fail 'the installed program does not run'
grep -rl "$PWD/first\|$build" moved/lib moved/include --include='*.cmake' --include='*.pc' | grep . &&
  fail 'the package names its old place'

# expected(i,j) of the bilinear square, counter-clockwise from the left bottom: nodes 1, 2, 4, 3 of the element
awk 'BEGIN {
  nu = 0.3
  k[1] = 1/2 - nu/6; k[2] = 1/8 + nu/8; k[3] = -1/4 - nu/12; k[4] = -1/8 + 3*nu/8
  k[5] = -1/4 + nu/12; k[6] = -1/8 - nu/8; k[7] = nu/6; k[8] = 1/8 - 3*nu/8
  split("1 2 3 4 7 8 5 6", at, " ")
  row[1] = "1 2 3 4 5 6 7 8"; row[2] = "2 1 8 7 6 5 4 3"; row[3] = "3 8 1 6 7 4 5 2"; row[4] = "4 7 6 1 8 3 2 5"
  row[5] = "5 6 7 8 1 2 3 4"; row[6] = "6 5 4 3 2 1 8 7"; row[7] = "7 4 5 2 3 8 1 6"; row[8] = "8 3 2 5 4 7 6 1"
  for (i = 1; i <= 8; i++) {
    split(row[at[i]], which, " ")
    for (j = 1; j <= 8; j++) printf "%.12f%s", k[which[at[j]]]/(1 - nu*nu), j < 8 ? " " : "\n"
  }
}' >expected.txt

same() { # label program
  "$2" >"$1.txt" || fail "$1: $2 failed"
  paste -d ' ' expected.txt "$1.txt" | awk -v label="$1" '
    { if (NF != 16) bad = 1; for (j = 1; j <= 8; j++) { d = $j - $(j + 8); if (d*d > 1e-22) bad = 1 } }
    END { if (NR != 8 || bad) { print label ": not the stiffness of the square"; exit 1 } }' || failures=$((failures + 1))
}

project() { # label option...
  local label=$1
  shift
  cmake -S "$BEZEL_SOURCE/tests/package" -B "$label" -DCMAKE_PREFIX_PATH="$PWD/moved" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_C_COMPILER="$(compiler C)" "$@" >"$label.log" 2>&1 && cmake --build "$label" >>"$label.log" 2>&1 ||
    { cat "$label.log"; fail "$label: the project does not build"; }
  grep -i 'warning' "$label.log" && fail "$label: warnings"
}

project both -DCMAKE_Fortran_COMPILER="$(compiler Fortran)"
same fortran both/stiffness_fortran
same c both/stiffness_c
both/functions || fail 'the shape functions of the package are wrong'
ldd both/stiffness_fortran both/stiffness_c | grep -iE 'cholmod|umfpack|hdf5|blas|lapack' &&
  fail 'the package needs foreign libraries'
project c_alone -DWITH_FORTRAN=OFF
same c_alone c_alone/stiffness_c

if command -v pkg-config >/dev/null; then
  export PKG_CONFIG_PATH=$(dirname "$(find "$PWD/moved" -name bezel.pc)")
  read -ra flags <<<"$(pkg-config --cflags --libs bezel)"
  "$(compiler C)" "$BEZEL_SOURCE/tests/package/stiffness.c" "${flags[@]}" -o with_pc && same pkg_config ./with_pc ||
    fail 'pkg-config: does not build'
fi

echo "package: $failures failures"
[ $failures -eq 0 ]
