#!/usr/bin/env bash
# Runs the demos in random rooms and puts the table and three drawings into docs.
# usage: tests/campaign/demos.sh [N [FOLDER]]
#   N       number of rooms, 1000 by default, from 1001 on: the demos were developed on the others
#   FOLDER  gets the drawings of each demo in the first ten of them
# Builds the dev preset's demo_rooms. Exit status 1 if something promised does not hold.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
first=1001
last=$((first + ${1:-1000} - 1))
folder=${2:-}
program=build/dev/tests/demo_rooms

cmake --preset dev > /dev/null
cmake --build --preset dev -j "$(nproc)" --target demo_rooms > /dev/null
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
begin=$SECONDS
status=0  # 1 if something did not hold: the numbers are in the table
"$program" --from "$first" --to "$last" > "$made/table" || status=$?
echo "rooms $first to $last in $((SECONDS - begin)) s"
sed -i -e '/^<!-- demo rooms -->$/,/^<!-- end of demo rooms -->$/{/^<!-- /!d}' \
  -e "/^<!-- demo rooms -->\$/r $made/table" docs/virtual-create.md

draw() {  # DEMO ROOM NAME
  "$program" --from "$2" --to "$2" --only "$1" --draw "$made" > /dev/null 2>&1 || true
  cp "$made/$1.$2.svg" "docs/$3.svg"
}
draw cover_and_dock 1002 demo-cover-and-dock
draw home 1001 demo-home
draw tag 1001 demo-tag
if [[ -n $folder ]]; then
  mkdir -p "$folder"
  "$program" --from "$first" --to "$((first + 9))" --draw "$folder" > /dev/null 2>&1 || true
  echo "drawings in $folder"
fi
exit "$status"
