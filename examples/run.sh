#!/usr/bin/env bash
# Builds Cargobay on a fresh Debian 12 or 13 and closes the velocity loop on the built-in virtual
# Create: `cargobay drive`. Arguments go to it, for example --profile square --plot square.svg.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

# quietly WHAT COMMAND...: one line, and the log only if it fails. All on stderr: stdout is drive's.
quietly() {
  local what=$1 log status=0
  shift
  echo "$what" >&2
  log=$(mktemp)
  "$@" > "$log" 2>&1 < /dev/null || status=$?
  ((status == 0)) || { tail -n 40 "$log" >&2; echo "failed: $*" >&2; }
  rm -f "$log"
  return "$status"
}

quietly "packages: installing what is missing" "$root/.ci/packages.sh" run
cd "$root"
quietly "configuring" cmake --preset release
quietly "building (a minute or two the first time)" cmake --build --preset release --target cargobay
cd "$OLDPWD"
exec "$root/build/release/cargobay" drive "$@"
