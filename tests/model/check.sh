#!/usr/bin/env bash
# Has spin explore every state of a model in this folder, and of its wrong versions, which must
# fail. usage: check.sh MODEL TWIN...; exit 77 if spin is missing.
set -euo pipefail

folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
(($# >= 2)) || { sed -n '2,3s/^# //p' "$0" >&2; exit 2; }
model=$1
shift
command -v spin > /dev/null || { echo "skipped: no spin here (Debian: apt-get install spin)"; exit 77; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# verdict [TWIN]: holds, fails, or what went wrong with the search itself.
verdict() {
  rm -f pan pan.* ./*.trail
  spin ${1:+-D"$1"} -a "$folder/$model.pml" > log 2>&1 || { echo "spin refuses it: $(tail -n 3 log)"; return; }
  # enabled() in a claim cannot be combined with partial order reduction.
  ${CC:-cc} -O2 -w -Wno-error=implicit-function-declaration -DNOREDUCE -o pan pan.c > log 2>&1 || { echo "does not compile: $(tail -n 3 log)"; return; }
  ./pan -m1000000 > log 2>&1 || true
  if grep -q '^pan:1: ' log; then
    echo fails
  elif grep -q 'errors: 0$' log && ! grep -q 'max search depth too small\|not completed' log; then
    echo holds
  else
    echo "was not searched to the end"
  fi
}

states() { awk '/states, stored/ { print $1 }' log; }

result=$(verdict)
echo "$model: $result, $(states) states"
[[ $result == holds ]] || { cat log; exit 1; }
for twin in "$@"; do
  result=$(verdict "$twin")
  echo "$model, twin $twin: $result: $(grep -m 1 '^pan:1:' log || true)"
  [[ $result == fails ]] || { echo "this twin must fail"; exit 1; }
done
