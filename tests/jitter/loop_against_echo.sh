#!/usr/bin/env bash
# The control loop against a bare echo on a pseudo-terminal at 1 kHz, for docs/performance.md.
# usage: tests/jitter/loop_against_echo.sh [REPEATS [FRAMES]]
# Five repeats of 30 000 frames each by default: about ten minutes. Wants the machine to itself, and
# root (or limits) for SCHED_FIFO. Fails if the median of the repeats is above 1.10 at p50 or above
# 1.25 at p99.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
repeats=${1:-5} frames=${2:-30000}
cmake --preset release > /dev/null
cmake --build --preset release -j "$(nproc)" > /dev/null
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT

echo '| run | loop p50, us | echo p50, us | p50 | p99 | again / echo p50 | p99 |'
echo '|---|---|---|---|---|---|---|'
for ((run = 1; run <= repeats; ++run)); do
  build/release/cargobay jitter --channels loop,echo,again --frames "$frames" \
    --json "$results/$run.json" > "$results/$run.txt"
  python3 - "$run" "$results/$run.json" << 'PY'
import json, sys
result = json.load(open(sys.argv[2]))
ratio = {r["over"]: r for r in result["ratios"]}
p50 = {c["name"]: c["latency_ns"]["p50"] / 1e3 for c in result["channels"]}
def cell(r):
    if r["low"] is None: return "%.3f [none: %s]" % (r["ratio"], r["lack"])
    return "%.3f [%.3f, %.3f]" % (r["ratio"], r["low"], r["high"])
loop, again = ratio["loop"], ratio["again"]
print("| %s | %.1f | %.1f | %s | %s | %s | %s |" % (sys.argv[1], p50["loop"], p50["echo"],
      cell(loop["p50"]), cell(loop["p99"]), cell(again["p50"]), cell(again["p99"])))
PY
done
python3 - "$results"/*.json << 'PY'
import json, statistics, sys
loops = [next(r for r in json.load(open(f))["ratios"] if r["over"] == "loop") for f in sys.argv[1:]]
p50 = statistics.median(r["p50"]["ratio"] for r in loops)
p99 = statistics.median(r["p99"]["ratio"] for r in loops)
print("median of %d: p50 x %.3f (bound 1.10), p99 x %.3f (bound 1.25)" % (len(loops), p50, p99))
sys.exit(p50 > 1.10 or p99 > 1.25)
PY
