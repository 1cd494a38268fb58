#!/usr/bin/env bash
# What a program may rely on: if compiled against the first header, it runs with this library; if
# compiled against a later header, it runs as far as this library knows what it asks for; and
# nothing in the API has disappeared or changed.
# usage: tests/abi/check.sh LIBRARY COMMAND [--dump]
#   LIBRARY  libcargobay.so, with debug information
#   COMMAND  the command cargobay, which the programs replay their recordings with
#   --dump   rewrites tests/abi/libcargobay.so.0.abi: only when a version is released
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

library=$(realpath "${1:?usage: tests/abi/check.sh LIBRARY COMMAND [--dump]}")
command=$(realpath "${2:?usage: tests/abi/check.sh LIBRARY COMMAND [--dump]}")
for file in "$library" "$command"; do
  [[ -f $file ]] || { echo "check.sh: there is no file $file" >&2; exit 2; }
done
dump=tests/abi/libcargobay.so.0.abi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

dumped() { abidw --exported-interfaces-only --headers-dir hal/c --drop-private-types --no-show-locs --no-corpus-path --no-comp-dir-path "$library" | sed "s|path=./[^']*.|path='hal/c'|"; }
if [[ ${3:-} == --dump ]]; then
  dumped > "$work/new.abi"  # whole before it replaces the old one
  grep -q '<elf-function-symbols>' "$work/new.abi" || { echo "check.sh: no library: $library" >&2; exit 1; }
  cp "$work/new.abi" "$dump"
  echo "wrote $dump"
  exit
fi

# run NAME HEADER-FOLDER SOURCE...: compiles with that header, runs with this library.
run() {
  local name=$1 headers=$2
  shift 2
  ${CC:-cc} -std=c99 -I "$headers" -I tests/capi -o "$work/$name" "$@" "$library" -lm -pthread
  if CARGOBAY_COMMAND=$command CARGOBAY_GUARD=$(dirname "$command")/cargobay-guard \
    LD_LIBRARY_PATH=$(dirname "$library") CARGOBAY_SANITIZED=1 "$work/$name"; then
    echo "ok: $name"
  else
    echo "check.sh: $name does not run" >&2
    failed=1
  fi
}

run first_header tests/abi/first tests/capi/virtual_time.c
# Makes every struct that may grow larger.
mkdir "$work/later"
awk '
  /^struct cargobay_[a-z_]+ [{]$/ { inside = 1; grows = 0 }
  inside && /^  uint32_t size;/ { grows = 1 }
  inside && /^[}];$/ { if (grows) { print "  uint64_t of_a_later_version[4];"; ++count } inside = 0 }
  { print }
  END { if (count < 9) { print "found hardly a struct that grows" > "/dev/stderr"; exit 1 } }
' hal/c/cargobay.h > "$work/later/cargobay.h"
run later_header "$work/later" tests/capi/virtual_time.c
run later_header_control "$work/later" tests/capi/control.c

# The page and what it needs is another program's: these two need what they have always needed.
base='lib(gpiod|serialport|stdc\+\+|m|gcc_s|c|atomic|pthread|[a-z]*san)\.so.*|ld-linux.*'
# needs FILE PATTERN: fails if it needs a library that the pattern does not match.
needs() {
  local others
  readelf -d "$1" | sed -n 's/.*(NEEDED).*\[\(.*\)\]$/\1/p' > "$work/needed"
  grep -q '^libc\.so' "$work/needed" || { echo "check.sh: what does $1 need?" >&2; exit 1; }
  others=$(grep -vxE "$2" "$work/needed") || return 0
  echo "check.sh: $1 needs another library: ${others//$'\n'/, }" >&2
  failed=1
}
needs "$library" "$base"
needs "$command" "$base|lib(fmt|ncursesw|tinfo)\.so.*"

if [[ $(uname -m) != x86_64 ]]; then
  echo "no dump of this architecture: not compared"
elif ! command -v abidiff > /dev/null; then
  echo "check.sh: abidiff is missing: apt-get install abigail-tools" >&2
  failed=1
else
  dumped > "$work/now.abi"
  # Additions do no harm.
  abidiff --no-added-syms "$dump" "$work/now.abi" || { echo "check.sh: the ABI has changed" >&2; failed=1; }
fi
((!failed))
