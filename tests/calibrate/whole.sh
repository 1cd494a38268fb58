#!/usr/bin/env bash
# Whole calibrations on virtual Creates, most of a minute of real time: one makes the configuration
# that is not there yet, which the next drive obeys; one cannot print its result.
# usage: tests/calibrate/whole.sh CARGOBAY
set -euo pipefail

cargobay=$(realpath "${1:?usage: tests/calibrate/whole.sh CARGOBAY}")
work=$(mktemp -d)
full=
trap '[[ -z $full ]] || kill "$full" 2> /dev/null || true; rm -rf "$work"' EXIT
failed=0
expect() { # WHAT COMMAND...
  local what=$1
  shift
  "$@" || { echo "whole.sh: $what does not hold" >&2; failed=1; }
}

"$cargobay" calibrate --config /dev/null --learnt none > /dev/full 2> "$work/full.err" &
full=$!
code=0
"$cargobay" calibrate --config "$work/new.toml" --learnt none > "$work/out" 2> "$work/err" || code=$?
cat "$work/err" "$work/out"
expect "a whole calibration exits with 0" test "$code" -eq 0
expect "it says that it makes the file" grep -q 'is not there yet: it will be made' "$work/err"
expect "it says where the result is" grep -q "^Written to   $work/new.toml$" "$work/out"
base=$(sed -n 's/^Wheel base  *\([0-9.]*\) mm .*/\1/p' "$work/out")
expect "the file has what was printed" grep -qx "wheel_base_mm = $base" "$work/new.toml"
expect "it is the virtual Create's, to 3 mm" awk -v b="$base" 'BEGIN { exit !(b > 255 && b < 261) }'
"$cargobay" drive --config "$work/new.toml" --learnt none --duration 0.5 > /dev/null ||
  expect "a drive reads it" false

code=0
wait "$full" || code=$?
full=
expect "a result that cannot be printed is exit code 1, not $code" test "$code" -eq 1
expect "and said" grep -q 'cannot write to standard output: No space left on device' "$work/full.err"
exit "$failed"
