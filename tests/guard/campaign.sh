#!/usr/bin/env bash
# How long a robot keeps rolling when its program dies or hangs: the guard's figures for
# docs/reliability.md, which it rewrites between its marks.
# usage: tests/guard/campaign.sh [DEATHS] [FOLDER]
#   DEATHS  by SIGKILL, both with idle and with loaded cores (1000); a fifth as many of the others
#   FOLDER  the build's (build/dev)
# Takes about half an hour, wants the machine to itself, and needs root (or CAP_SYS_NICE) and
# stress-ng.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
deaths=${1:-1000}
folder=${2:-build/dev}
program=$folder/tests/guard_campaign
page=docs/reliability.md
[[ -x $program ]] || { echo "campaign.sh: no $program; build it: cmake --build --preset dev" >&2; exit 1; }
command -v stress-ng > /dev/null || { echo "campaign.sh: install stress-ng" >&2; exit 1; }

result=$(mktemp)
load=
leave() {
  [[ -z $load ]] || kill "$load" 2> /dev/null || true
  rm -f "$result"
}
trap leave EXIT

failed=0
# run NAME BOUND: all deaths, the rows prefixed with the load's name. BOUND: ms for the p99.
run() {
  {
    "$program" --deaths "$deaths" --lanes 4 --judge "$2" --way kill || failed=1
    "$program" --deaths $((deaths / 5)) --lanes 4 --judge "$2" --way segv --way abort || failed=1
    # Hung programs are found by the deadline, plus up to three frames.
    "$program" --deaths $((deaths / 5)) --lanes 4 --judge 45 --way stop --way endless || failed=1
  } | tee /dev/stderr | sed -n "s/^| \(kill\|segv\|abort\|stop\|endless\) /| $1 &/p" |
    sed 's/| |/|/' >> "$result"
}

run idle 10
stress-ng --cpu "$(nproc)" --quiet &
load=$!
run loaded 25
kill "$load"
load=

{
  printf '%s, %s cores, kernel %s, %s; deadline 150 ms, 57600 baud, four robots at a time.\n\n' \
    "$(date -u +%F)" "$(nproc)" "$(uname -r)" \
    "$(systemd-detect-virt 2> /dev/null | grep -v none || echo 'a virtual machine or none')"
  echo '| cores | death | robots | stopped | p50, ms | p99, ms | max, ms |'
  echo '|---|---|---|---|---|---|---|'
  tr -s ' ' < "$result"
} > "$result.page"
sed -i -e "/<!-- guard: begin -->/,/<!-- guard: end -->/{/<!-- guard/!d}" \
  -e "/<!-- guard: begin -->/r $result.page" "$page"
rm -f "$result.page"
exit "$failed"
