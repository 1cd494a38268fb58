#!/usr/bin/env bash
# Runs the fault matrix and puts its table into docs/reliability.md.
# usage: tests/campaign/fault_matrix.sh [SEEDS]
# Builds the dev preset's fault_matrix. 1000 seeds by default: 132 000 drives, some minutes.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
seeds=${1:-1000}

cmake --preset dev > /dev/null
cmake --build --preset dev -j "$(nproc)" --target fault_matrix > /dev/null
table=$(mktemp)
trap 'rm -f "$table"' EXIT
begin=$SECONDS
status=0  # 1 if a drive failed: that is in the table
build/dev/tests/fault_matrix --seeds "$seeds" > "$table" || status=$?
echo "$seeds seeds in $((SECONDS - begin)) s"
sed -i -e '/^<!-- fault matrix -->$/,/^<!-- end of fault matrix -->$/{/^<!-- /!d}' \
  -e "/^<!-- fault matrix -->\$/r $table" docs/reliability.md
exit "$status"
