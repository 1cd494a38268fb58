#!/usr/bin/env bash
# examples/rust, built against the installed header by Debian's cargo and bindgen, without the
# network: its tests pass, its program drives a virtual Create and reports errors.
# usage: tests/install/rust_test.sh [PREFIX | FOLDER_WITH_DEBS]
# PREFIX is what `cmake --install` filled; of a folder with packages the library and its header are
# unpacked, not installed. Without: whatever pkg-config finds.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
(($# <= 1)) || { sed -n '2,6s/^# \{0,1\}//p' "$0" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Debian's come first: with an older Rust than others have.
export PATH=/usr/bin:$PATH
for program in cargo bindgen pkg-config cc; do
  command -v "$program" > /dev/null || {
    echo "SKIPPED: $program is missing: apt-get install cargo bindgen pkg-config gcc"
    exit 77
  }
done

if (($# == 1)); then
  prefix=$(realpath "$1")
  shopt -s nullglob
  packages=("$prefix"/libcargobay*_"$(dpkg --print-architecture 2> /dev/null || true)".deb)
  shopt -u nullglob
  if ((${#packages[@]} > 0)); then
    for package in "${packages[@]}"; do dpkg-deb -x "$package" "$work/unpacked"; done
    prefix=$work/unpacked/usr
  fi
  found=$(find "$prefix" -name cargobay.pc -print -quit)
  [[ -n $found ]] || { echo "rust_test.sh: no cargobay.pc below $1" >&2; exit 2; }
  PKG_CONFIG_PATH=$(dirname "$found")
  export PKG_CONFIG_PATH
fi
pkg-config --exists cargobay ||
  { echo "SKIPPED: pkg-config finds no cargobay: apt-get install libcargobay-dev"; exit 77; }

# step WHAT COMMAND...: one line, and the log if it fails.
step() {
  local what=$1
  shift
  "$@" > "$work/log" 2>&1 < /dev/null || {
    echo "FAILED  $what"
    tail -n 60 "$work/log"
    exit 1
  }
  echo "ok      $what"
}

cp -r "$root/examples/rust" "$work/rust"
rm -rf "$work/rust/target" "$work/rust/Cargo.lock"
cd "$work/rust"
# No configuration and no cache of this user's, and one cargo for all.
export CARGO_HOME=$work/cargo CARGO_TARGET_DIR=$work/target RUSTFLAGS='-D warnings'
echo "$(cargo --version), $(bindgen --version), cargobay $(pkg-config --modversion cargobay)"
step "cargo build --offline" cargo build --offline
step "cargo test --offline" cargo test --offline
grep -qE 'test result: ok. [1-9][0-9]* passed; 0 failed' "$work/log" ||
  { echo "FAILED  no test has run"; cat "$work/log"; exit 1; }
grep -qE 'bindgen_test_layout_cargobay_options ... ok' "$work/log" ||
  { echo "FAILED  the layouts are not tested"; cat "$work/log"; exit 1; }

drive=$work/target/debug/drive
step "drives a virtual Create" "$drive"
grep -qE '^[1-9][0-9]{2} mm ahead' "$work/log" || { echo "FAILED  it says:"; cat "$work/log"; exit 1; }
status=0
"$drive" /dev/no_robot_here > "$work/log" 2>&1 || status=$?
if ((status != 1)) || ! grep -qE '/dev/no_robot_here.*\(CARGOBAY_E_NO_PORT\)$' "$work/log"; then
  echo "FAILED  without such a port it ends with $status and says:"
  cat "$work/log"
  exit 1
fi
echo "ok      says that there is no such port: $(cat "$work/log")"
