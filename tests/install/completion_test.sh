#!/usr/bin/env bash
# What bash, zsh and fish offer after the beginning of a command line.
# usage: completion_test.sh [COMMAND]; by itself build/release/cargobay
# Without zsh or fish it tries what is there, says so, and exits with 77.
set -uo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
program=$(realpath "${1:-$root/build/release/cargobay}")
[[ -x $program ]] || { echo "completion_test.sh: there is no $program" >&2; exit 2; }
source "$root/docs/completion/cargobay"
failed=0

# What the shell would get, one word per line: in_bash LINE, in_zsh LINE, in_fish LINE.
in_bash() {
  COMP_LINE=$1 COMP_POINT=${#1} COMPREPLY=()
  # Outside of a completion compopt has nothing to change.
  compopt() { :; }
  _cargobay
  printf '%s\n' ${COMPREPLY[@]+"${COMPREPLY[@]}"}
}

in_zsh() {
  # Outside of a completion, zsh's functions do nothing: these print what they are given.
  zsh -f -c '
    _describe() { local -a all; all=("${(@P)argv[-1]}"); print -rl -- "${all[@]%%:*}"; }
    compset() { [[ $current == --*=* ]] && current=${current#*=}; }
    _files() { print -rl -- $current*(N); }
    setopt extended_glob
    words=(${(z)1}) && [[ $1 != *" " ]] || words+=("")
    CURRENT=$#words current=$words[-1]
    source "$2"' zsh "$1" "$root/docs/completion/_cargobay" | sed -E 's/^--[a-z-]+=//'
}
in_fish() {
  HOME=$folder fish --no-config -c 'source $argv[2]; complete -C $argv[1]' "$1" \
    "$root/docs/completion/cargobay.fish" | sed -E 's/\t.*//; s/^--[a-z-]+=//'
}
offered() { "in_$shell" "$1" | sed '/^$/d'; }

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
  [[ $found == "$(printf '%s\n' "$@" | sed '/^$/d' | sort | tr '\n' ' ')" ]] || {
    echo "'$line' offers: $found"
    failed=1
  }
}

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
touch mine.rec mine.toml

every_shell() {
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
  is "$program drive --config=mine.t" mine.toml
  is "$program sensors --json --onc" --once
  is "$program drive --duration "
  is "$program drive --baud 192" 19200
  is "$program replay mi" mine.rec mine.toml
  is "$program plot -o mine.r" mine.rec
  is "$program export mi" mine.rec mine.toml
  has "$program export --" --csv --jsonl --mcap --topics
  is "$program export --csv mine.r" mine.rec
  is "$program export --topics states,sen" states,sensors
  is "$program jitter comp" compare
  has "$program jitter compare --" --plot
  is "$program no-such-command --po"
  is "$program sensors --packets distance,angl" distance,angle
  is "$program sim --fault unpl" unplugged
  is "$program sim --plant quad" quadrature
  is "$program send play_" play_script
  is "$program encode drive 100 str" straight
  # All the serial ports of this machine, and nothing else.
  while IFS= read -r port; do
    [[ -z $port || -e $port ]] || { echo "--port offers $port, which is not there"; failed=1; }
  done < <(offered "$program drive --port ")
  is "$program drive --port ./mine.r" ./mine.rec
}

missing=()
for shell in bash zsh fish; do
  if command -v "$shell" > /dev/null; then every_shell; else missing+=("$shell"); fi
  ((!failed)) || { echo "so says $shell"; break; }
done
((failed)) && exit 1
((${#missing[@]})) || { echo "completion: as it should be"; exit 0; }
echo "completion: as it should be, but not tried in ${missing[*]}"
exit 77
