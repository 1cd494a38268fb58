#!/usr/bin/env bash
# What a whole cycle costs beside its parts, in instructions, and the loop's share of a core.
# usage: tests/jitter/cost.sh
# Fails where a cycle takes more than 1.15 times the instructions of a bare echo, the decoder and
# the loop (estimator and controller) together, or the loop more than 2 % of a core. Wants valgrind.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
command -v valgrind > /dev/null || { echo "cost.sh: install valgrind" >&2; exit 1; }
build=build/bench
cmake --preset release -B "$build" -DBUILD_TESTING=ON > /dev/null
cmake --build "$build" -j "$(nproc)" --target cycle_cost cargobay > /dev/null

# count PART FRAMES
count() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$build/tests/cycle_cost" "$1" "$2" 2>&1 |
    sed -n 's/^.*Collected : \([0-9]*\).*/\1/p'
}
declare -A each
for part in cycle echo decode loop; do
  few=$(count "$part" 2000) many=$(count "$part" 22000)
  each[$part]=$(((many - few) / 20000))
  printf '%-8s %6d instructions a frame\n' "$part" "${each[$part]}"
done
parts=$((each[echo] + each[decode] + each[loop]))
awk -v cycle="${each[cycle]}" -v parts="$parts" 'BEGIN {
  printf "cycle / (echo + decode + loop) = %.3f, bound 1.15\n", cycle / parts
  exit cycle > 1.15 * parts }' || failed=1

link=$(mktemp -u)
"$build/cargobay" sim --link "$link" > /dev/null &
sim=$!
trap 'kill "$sim" 2> /dev/null || true' EXIT
until [[ -e $link ]]; do sleep 0.1; done
TIMEFORMAT='%U %S'
used=$({ time "$build/cargobay" drive --port "$link" --duration 30 --no-guard > /dev/null 2>&1; } 2>&1)
awk -v used="$used" 'BEGIN { split(used, s, " "); share = (s[1] + s[2]) / 30 * 100
  printf "the loop at 15 ms, with bring-up and report: %.2f %% of a core, bound 2 %%\n", share
  exit share > 2 }' || failed=1
exit "${failed:-0}"
