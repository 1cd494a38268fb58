#!/usr/bin/env bash
# Calibrates random plants in virtual time, and puts what came of it into docs/control.md.
# usage: tests/campaign/calibrations.sh [N [SEED]]
#   N  plants of each kind of remainder, 200 by default (two minutes); seeds from SEED (1) on
# Builds the dev preset's program. The docs are changed only by a run of 200.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --preset dev > /dev/null
cmake --build --preset dev -j "$(nproc)" --target calibrations > /dev/null
made=$(mktemp)
trap 'rm -f "$made"' EXIT
build/dev/tests/calibrations "${1:-200}" "${2:-1}" | tee "$made"
((${1:-200} == 200)) || exit 0
sed -i -e '/^<!-- calibrations -->$/,/^<!-- end of calibrations -->$/{/^<!-- /!d}' \
  -e "/^<!-- calibrations -->\$/r $made" docs/control.md
