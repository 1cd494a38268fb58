#!/usr/bin/env bash
# `cargobay jitter --channels sleep` against cyclictest (rt-tests), in turns on one CPU.
# usage: tests/jitter/against_cyclictest.sh [ROUNDS [WAKES]]
# Twenty rounds of 3000 wake-ups each at 1 ms and priority 80 by default: two minutes. Fails if the
# overall medians differ by more than 10 %, the p99 by more than cyclictest's rounds differ, or the
# files in their form.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
rounds=${1:-20} wakes=${2:-3000}
command -v cyclictest > /dev/null || { echo "against_cyclictest.sh: install rt-tests" >&2; exit 1; }
cmake --preset release > /dev/null
cmake --build --preset release -j "$(nproc)" > /dev/null
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
cpu=$(($(nproc) - 1))
for ((round = 1; round <= rounds; ++round)); do
  cyclictest --mlockall --priority=80 --interval=1000 --loops="$wakes" --affinity="$cpu" --threads=1 \
    --policy=fifo --histogram=20000 --quiet --histfile="$results/cyclictest-$round" > /dev/null 2>&1
  build/release/cargobay jitter --channels sleep --frames "$wakes" --cpu "$cpu" \
    --cyclictest "$results/cargobay-$round" > /dev/null
done
# Every digit counts, but not which one it is, nor how many rows of one form follow each other.
form() { tr 1-9 0 < "$1" | uniq; }
diff <(form "$results/cyclictest-1") <(form "$results/cargobay-1")
python3 - "$results" "$rounds" << 'PY'
import sys
folder, rounds = sys.argv[1], int(sys.argv[2])
def counts(name):
    found = {}
    for line in open(f"{folder}/{name}"):
        words = line.split()
        if len(words) >= 2 and words[0].isdigit():
            found[int(words[0])] = found.get(int(words[0]), 0) + int(words[1])
    return found
def percentile(all_counts, percent):
    total, seen = sum(all_counts.values()), 0
    for value in sorted(all_counts):
        seen += all_counts[value]
        # In the middle of its microsecond, by its rank there.
        if seen >= percent / 100 * total:
            rank = percent / 100 * total - (seen - all_counts[value])
            return value + rank / all_counts[value]
def merged(name):
    found = {}
    for i in range(1, rounds + 1):
        for value, count in counts(f"{name}-{i}").items():
            found[value] = found.get(value, 0) + count
    return found
ours, theirs = merged("cargobay"), merged("cyclictest")
each = [percentile(counts(f"cyclictest-{i}"), 99) for i in range(1, rounds + 1)]
p50 = percentile(ours, 50), percentile(theirs, 50)
p99 = percentile(ours, 99), percentile(theirs, 99)
print("p50: cargobay %.1f us, cyclictest %.1f us, x %.3f (bound 0.9 to 1.1)" % (*p50, p50[0] / p50[1]))
print("p99: cargobay %.1f us, cyclictest %.1f us, its rounds %.1f to %.1f us" % (*p99, min(each), max(each)))
good = 0.9 <= p50[0] / p50[1] <= 1.1 and min(each) <= p99[0] <= max(each)
sys.exit(not good)
PY
