#!/usr/bin/env bash
# Makes HTML of the C API, hal/c/cargobay.h, in build/docs (Debian's package doxygen).
# usage: docs/c-api.sh [--check]
#   --check  makes nothing that stays: exit status 1 where a symbol is not documented
# Fails in both cases where Doxygen warns of anything, and prints what.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

check=0
for argument in "$@"; do
  case $argument in
    --check) check=1 ;;
    *)
      sed -n '2,5s/^# \{0,1\}//p' "$0" >&2
      exit 2
      ;;
  esac
done

command -v doxygen > /dev/null || {
  echo "c-api.sh: doxygen is missing: sudo apt install doxygen" >&2
  exit 2
}

version=$(sed -nE 's/^#define CARGOBAY_VERSION_(MAJOR|MINOR|PATCH) ([0-9]+)$/\2/p' hal/c/cargobay.h |
  paste -sd .)
folder=build/docs
if ((check)); then
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
fi
mkdir -p "$folder"
if ! said=$({
  cat docs/Doxyfile
  echo "PROJECT_NUMBER = $version"
  echo "OUTPUT_DIRECTORY = $folder"
} | doxygen - 2>&1) || [[ -n $said ]]; then
  printf '%s\n' "${said//"$PWD/"/}" >&2
  exit 1
fi
# A header that is not read has nothing undocumented in it either.
grep -q cargobay_open "$folder/cargobay_8h.html" || {
  echo "c-api.sh: hal/c/cargobay.h is not in what was made" >&2
  exit 1
}
if ((check)); then
  echo "hal/c/cargobay.h: every symbol is documented"
else
  echo "$folder/cargobay_8h.html"
fi
