#!/usr/bin/env bash
# Tests again_after_standstill itself: what it repeats, how often, and what it leaves alone.
# usage: self_test.sh PROGRAM
set -euo pipefail

program=$1
runs=$(mktemp)
trap 'rm -f "$runs"' EXIT

# expect WHAT CODE RUNS BEAR COMMAND
expect() {
  local code=0
  : > "$runs"
  "$program" --bear "$4" /bin/sh -c "echo >> '$runs'; $5" > /dev/null || code=$?
  if ((code != $2 || $(wc -l < "$runs") != $3)); then
    echo "self_test.sh: $1: returned $code after $(wc -l < "$runs") runs, not $2 after $3" >&2
    exit 1
  fi
}

# Stops the launcher itself, its watches included, for twice as long as it may bear.
still='kill -STOP $PPID; sleep 0.2; kill -CONT $PPID;'
never=3600000
expect 'what passes is run once' 0 1 100 "$still true"
expect 'a failure on a steady machine is one' 3 1 "$never" "$still exit 3"
expect 'a failure behind a standstill is run again' 0 3 100 "$still test \$(wc -l < '$runs') -eq 3"
expect 'six times at most' 3 6 100 "$still exit 3"
expect 'a signal is a failure' 137 1 "$never" 'kill -KILL $$'

# A feed that one run leaves is not in the way of the next.
folders=$(mktemp)
trap 'rm -f "$runs" "$folders"' EXIT
expect 'each run has an empty folder for its feeds' 0 3 100 \
  "$still echo \$XDG_RUNTIME_DIR >> '$folders'; mkdir \$XDG_RUNTIME_DIR/cargobay && test \$(wc -l < '$runs') -eq 3"
while read -r folder; do
  [[ $folder == /tmp/cargobay-run-* && ! -e $folder ]] || { echo "self_test.sh: $folder is left" >&2; exit 1; }
done < "$folders"
