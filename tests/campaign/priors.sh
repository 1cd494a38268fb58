#!/usr/bin/env bash
# Drives random plants in virtual time, beginning from what an earlier drive learnt, of the same plant
# or of another, and puts the table into docs/control.md.
# usage: tests/campaign/priors.sh [N [SEED]]
#   N  plants of each kind of remainder, 1000 by default (two minutes); seeds from SEED (1) on
# Builds the dev preset's program. The docs are changed only by a run of 1000.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --preset dev > /dev/null
cmake --build --preset dev -j "$(nproc)" --target priors > /dev/null
made=$(mktemp)
trap 'rm -f "$made"' EXIT
build/dev/tests/priors "${1:-1000}" "${2:-1}" | tee "$made"
((${1:-1000} == 1000)) || exit 0
sed -i -e '/^<!-- priors -->$/,/^<!-- end of priors -->$/{/^<!-- /!d}' \
  -e "/^<!-- priors -->\$/r $made" docs/control.md
