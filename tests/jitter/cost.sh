#!/usr/bin/env bash
# What a whole cycle costs compared with its parts, in instructions, and the loop's share of a core.
# usage: tests/jitter/cost.sh Fails if a cycle takes more than 1.15 times the instructions, those of
# the kernel included, of a bare echo on a pseudo-terminal, the decoder and the loop (estimator and
# controller) together, or if the loop takes more than 2 % of a core. Needs valgrind, and qemu for
# the kernel's (.ci/packages.sh test).
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
command -v valgrind > /dev/null || { echo "cost.sh: install valgrind" >&2; exit 1; }
build=build/bench
cmake --preset release -B "$build" -DBUILD_TESTING=ON > /dev/null
cmake --build "$build" -j "$(nproc)" --target cycle_cost cargobay > /dev/null

frames=20000
# count KIND PART: the instructions for all frames.
count() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null --toggle-collect='*measured<*' \
    "$build/tests/cycle_cost" "$1" "$2" "$frames" 2>&1 | sed -n 's/^.*Collected : \([0-9]*\).*/\1/p'
}
echo "without the kernel, on a stream in memory, instructions a frame:"
for kind in carried lost; do
  printf '%-8s' "$kind"
  for part in cycle echo decode loop; do
    printf '  %s %6d' "$part" $(($(count "$kind" "$part") / frames))
  done
  echo
done

echo "with the kernel, on a pseudo-terminal:"
tests/pi/cycle_cost.py build/pi || failed=1

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
