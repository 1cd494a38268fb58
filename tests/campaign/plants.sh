#!/usr/bin/env bash
# Drives the velocity loop on random plants in virtual time and puts the table into docs/control.md,
# and what plants.py draws of it into docs/control-plants.svg.
# usage: tests/campaign/plants.sh [N [SEED]]
#   N     plants of each kind of remainder, 1000 by default (four minutes); seeds from SEED (1) on.
#         A single plant: tests/campaign/plants.sh 1 SEED
# Builds the dev preset's program. The docs are changed only by a run of 1000.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --preset dev > /dev/null
cmake --build --preset dev -j "$(nproc)" --target plants > /dev/null
made=$(mktemp)
shares=$(mktemp)
trap 'rm -f "$made" "$shares"' EXIT
PLANT_SHARES=$shares build/dev/tests/plants "${1:-1000}" "${2:-1}" | tee "$made"
((${1:-1000} == 1000)) || exit 0
tests/campaign/plants.py "$shares" docs/control-plants.svg
sed -i -e '/^<!-- plants -->$/,/^<!-- end of plants -->$/{/^<!-- /!d}' \
  -e "/^<!-- plants -->\$/r $made" docs/control.md
