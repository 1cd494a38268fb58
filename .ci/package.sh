#!/usr/bin/env bash
# Builds the Debian packages libcargobay0, libcargobay-dev, python3-cargobay, cargobay and cargobay-web
# into build/packages.
# usage: .ci/package.sh [amd64|arm64|armhf]
# Without an architecture: that of this machine. For another it is cross-compiled.
# Asks nothing; installs what is missing. For the Debian that it runs on: packages for Debian 13 are
# built on Debian 13. tests/install/package_test.sh tries them.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

native=$(dpkg --print-architecture)
architecture=${1:-$native}
case $architecture in
  "$native") preset=release purpose=package ;;
  arm64) preset=aarch64 purpose=package-arm64 ;;
  armhf) preset=armhf purpose=package-armhf ;;
  *)
    sed -n '2,7s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac

.ci/packages.sh "$purpose"

# A tree of its own: what goes into packages looks for its guard below /usr.
tree=$PWD/build/package-$architecture
packages=$PWD/build/packages
log=$PWD/build/log/package-$architecture.log
mkdir -p "$packages" "${log%/*}"

# The date of the changelog, and so the same packages from the same commit.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2> /dev/null || date +%s)}
export SOURCE_DATE_EPOCH

# logged WHAT COMMAND...: one line, and the end of the log if it fails.
logged() {
  echo "$1"
  shift
  "$@" >> "$log" 2>&1 < /dev/null || {
    tail -n 40 "$log" >&2
    echo "failed: $*; all of it is in $log" >&2
    exit 1
  }
}

# for_architecture COMMAND...: with what dpkg's tools go by.
for_architecture() { dpkg-architecture -f -a "$architecture" -c "$@" 2>> "$log"; }

: > "$log"
# Debian's hardening, without debug information. CMake takes them from the environment, once.
flags() {
  DEB_BUILD_MAINT_OPTIONS=hardening=+all DEB_CFLAGS_MAINT_STRIP=-g DEB_CXXFLAGS_MAINT_STRIP=-g \
    for_architecture dpkg-buildflags --get "$1"
}
CFLAGS="$(flags CFLAGS) $(flags CPPFLAGS)"
CXXFLAGS="$(flags CXXFLAGS) $(flags CPPFLAGS)"
LDFLAGS="$(flags LDFLAGS) -Wl,--as-needed"
export CFLAGS CXXFLAGS LDFLAGS

logged "configuring for $architecture" cmake --preset "$preset" -B "$tree" \
  -D CMAKE_INSTALL_PREFIX=/usr -D CARGOBAY_COMMAND=ON -D CARGOBAY_WEB=ON \
  -D CARGOBAY_SHARED=ON -D BUILD_TESTING=OFF
# What is packed, and not the examples.
logged "building (some minutes the first time)" cmake --build "$tree" -j "${CARGOBAY_JOBS:-$(nproc)}" \
  --target cargobay cargobay_web_program cargobay_gamepad cargobay_shared cargobay_guard
rm -f "$packages"/*_"$architecture".deb "$packages"/python3-cargobay_*_all.deb
logged "packing" for_architecture cpack --config "$tree/CPackConfig.cmake" -B "$packages"
rm -rf "$packages/_CPack_Packages"
ls "$packages"/*_"$architecture".deb "$packages"/python3-cargobay_*_all.deb
