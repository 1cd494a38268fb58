#!/usr/bin/env bash
# Breaks wheels and counters of random plants in virtual time, drives whole ones, and puts the table
# into docs/control.md.
# usage: tests/campaign/wheel_faults.sh [N [SEED]]
#   N     plants of each kind of remainder, 1000 by default (three minutes), a tenth of them for
#         each fault; seeds from SEED (1) on
# Builds the dev preset's program. The docs are changed only by a run of 1000.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --preset dev > /dev/null
cmake --build --preset dev -j "$(nproc)" --target wheel_faults > /dev/null
made=$(mktemp)
trap 'rm -f "$made"' EXIT
build/dev/tests/wheel_faults "${1:-1000}" "${2:-1}" | tee "$made"
((${1:-1000} == 1000)) || exit 0
sed -i -e '/^<!-- wheel faults -->$/,/^<!-- end of wheel faults -->$/{/^<!-- /!d}' \
  -e "/^<!-- wheel faults -->\$/r $made" docs/control.md
