# Sourced by driver/run and tests/run: from a bare Debian 12 to a current build, silently if nothing is missing and
# nothing changed. All messages go to standard error; any failure here ends with status 3.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
packages=(gcc gfortran libc6-dev cmake ninja-build libsuitesparse-dev libopenblas-serial-dev libhdf5-dev)

say() { printf 'bezel: %s\n' "$*" >&2; }
give_up() { say "$@"; exit 3; }

# Packages of the list that dpkg does not call installed; nothing on systems without dpkg, where CMake will tell.
missing_packages() {
  command -v dpkg-query >/dev/null || return 0
  local installed
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${packages[@]}" 2>/dev/null | sed -n 's/^installed //p')
  printf '%s\n' "${packages[@]}" | grep -vxF "$installed"
}

install_packages() {
  local missing as_root=() log
  mapfile -t missing < <(missing_packages)
  [ ${#missing[@]} -gt 0 ] || return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || give_up "missing packages, and neither root nor sudo to install them: ${missing[*]}"
    as_root=(sudo)
  fi
  say "installing with ${as_root[*]:+${as_root[*]} }apt-get: ${missing[*]}"
  log=$(mktemp)
  if ! "${as_root[@]}" apt-get update >"$log" 2>&1 </dev/null ||
    ! "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
      -o DPkg::Lock::Timeout=300 "${missing[@]}" >>"$log" 2>&1 </dev/null; then
    tail -n 20 "$log" >&2
    rm -f "$log"
    give_up "these packages are missing and could not be installed: ${missing[*]}"
  fi
  rm -f "$log"
}

# What a build folder must not outlive: its place, the compiler, and the processor that -march=native means.
fingerprint() {
  local fc
  fc=$(sed -n 's/^CMAKE_Fortran_COMPILER:[A-Z]*=//p' "$1/CMakeCache.txt")
  echo "$1"
  "$fc" --version 2>/dev/null | head -n 1
  grep -m 1 '^flags' /proc/cpuinfo 2>/dev/null | cksum
}

# build FOLDER TYPE TARGET...: configures the folder where needed and builds the targets.
build() {
  local folder=$1 type=$2 log stamp
  shift 2
  log=$(mktemp)
  stamp=$folder/bezel.stamp
  if [ -e "$folder/CMakeCache.txt" ]; then
    # A folder that somebody configured by hand has no stamp, and is used as it is if CMake accepts its place.
    if { [ -e "$stamp" ] && [ "$(cat "$stamp")" != "$(fingerprint "$folder")" ]; } ||
      ! grep -qxF "CMAKE_CACHEFILE_DIR:INTERNAL=$folder" "$folder/CMakeCache.txt" ||
      ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt"; then
      say "$folder was made elsewhere or by another compiler; building afresh"
      rm -rf "$folder" || give_up "cannot remove $folder"
    fi
  fi
  if [ ! -e "$folder/CMakeCache.txt" ]; then
    say "building in $folder, once"
    if ! cmake -S "$root" -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE="$type" >"$log" 2>&1; then
      cat "$log" >&2
      rm -rf "$log" "$folder/CMakeCache.txt"
      give_up "the configuration failed"
    fi
    fingerprint "$folder" >"$stamp"
  fi
  # Twice: the first build after a module has moved to another layer ends early, looking for it in its old place.
  if ! cmake --build "$folder" --target "$@" >"$log" 2>&1 && ! cmake --build "$folder" --target "$@" >"$log" 2>&1; then
    # Of ninja's output only what belongs to the failed steps.
    awk '/^FAILED/ { on = 1 } /^\[[0-9]+\/[0-9]+\]/ { on = 0 } on { print; some = 1 } END { exit !some }' "$log" >&2 ||
      cat "$log" >&2
    rm -f "$log"
    give_up "the build failed"
  fi
  rm -f "$log"
}

# locked NUMBER FILE: waits for its turn and keeps it until the descriptor of that number is closed.
locked() {
  command -v flock >/dev/null || return 0
  eval "exec $1<\"\$2\""
  flock -n "$1" || {
    say "waiting for another run that uses ${2#"$root"/}"
    flock "$1"
  }
}
