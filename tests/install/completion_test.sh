#!/usr/bin/env bash
# What bash offers after the beginning of a command line.
# usage: completion_test.sh [COMMAND]; by itself build/release/cargobay
set -uo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
program=$(realpath "${1:-$root/build/release/cargobay}")
[[ -x $program ]] || { echo "completion_test.sh: there is no $program" >&2; exit 2; }
source "$root/docs/completion/cargobay"
failed=0

# offered LINE: what readline would get, one word per line.
offered() {
  COMP_LINE=$1 COMP_POINT=${#1} COMPREPLY=()
  # Outside of a completion compopt has nothing to change.
  compopt() { :; }
  _cargobay
  printf '%s\n' ${COMPREPLY[@]+"${COMPREPLY[@]}"}
}

# has LINE WORD..., hasnt LINE WORD..., is LINE WORD...
has() {
  local line=$1 word
  shift
  for word in "$@"; do
    grep -qxF -- "$word" < <(offered "$line") || { echo "'$line' does not offer $word"; failed=1; }
  done
}
hasnt() {
  local line=$1 word
  shift
  for word in "$@"; do
    ! grep -qxF -- "$word" < <(offered "$line") || { echo "'$line' offers $word"; failed=1; }
  done
}
is() {
  local line=$1 found
  shift
  found=$(offered "$line" | sort | tr '\n' ' ')
  [[ $found == "$(printf '%s\n' "$@" | sort | tr '\n' ' ')" ]] || {
    echo "'$line' offers: $found"
    failed=1
  }
}

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
touch mine.rec mine.toml
mkdir -p worlds

has "$program " drive replay bringup sim send
hasnt "$program " --help -h mine.rec
is "$program doc" doctor
has "$program -" --help --version
has "$program drive --" --port --profile --reconnect --power-sense-line --remainder
hasnt "$program drive --" --link '--reconnect{30}' '-h,--help'
is "$program drive --dur" --duration
is "$program drive --remainder " carried lost
is "$program drive --remainder=l" lost
has "$program drive --profile " straight steps square spin mine.rec
is "$program drive --profile sq" square
is "$program drive --config mine.t" mine.toml
is "$program sensors --json --onc" --once
is "$program drive --duration "
is "$program drive --baud 192" 19200
is "$program replay mi" mine.rec mine.toml
is "$program plot -o mine.r" mine.rec
is "$program jitter comp" compare
has "$program jitter compare --" --plot
is "$program no-such-command --po"
# All the serial ports of this machine, and nothing else.
while IFS= read -r port; do
  [[ -z $port || -e $port ]] || { echo "--port offers $port, which is not there"; failed=1; }
done < <(offered "$program drive --port ")
is "$program drive --port ./mine.r" ./mine.rec

((failed)) || echo "completion: as it should be"
exit "$failed"
