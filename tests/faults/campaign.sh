#!/usr/bin/env bash
# Makes each system call on the port fail once, at a random call, and puts the table of what
# happened to the robots into docs/reliability.md, between its marks. usage:
# tests/faults/campaign.sh [RUNS] [SEED] Builds what it needs of the dev preset. 10 000 runs by
# default: half an hour on two cores.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
runs=${1:-10000}
seed=${2:-1}

cmake --preset dev > /dev/null
cmake --build --preset dev -j "$(nproc)" --target lastword > /dev/null
table=$(mktemp)
trap 'rm -f "$table"' EXIT
status=0  # 1 if a run failed: that is in the table
tests/faults/campaign.py build/dev --runs "$runs" --seed "$seed" --table "$table" || status=$?
sed -i -e '/^<!-- failing calls -->$/,/^<!-- end of failing calls -->$/{/^<!-- /!d}' \
  -e "/^<!-- failing calls -->\$/r $table" docs/reliability.md
exit "$status"
