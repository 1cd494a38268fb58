#!/usr/bin/env bash
# No room of hal has more than 20 files, and no source more than 400 lines.
# usage: sizes.sh [--self-test | ROOT]; prints what is too large, exit 1 if anything is.
set -euo pipefail

most_files=20
most_lines=400
# A header that is the manual of an API is as long as the API is.
long_ones='^hal/c/cargobay\.(h|hpp)$'

check() {
  local room file count found=0
  cd "$1"
  while read -r room; do
    count=$(find "$room" -maxdepth 1 -type f | wc -l)
    ((count <= most_files)) || { echo "$room has $count files: make a room of some, at most $most_files"; found=1; }
  done < <(find hal -type d | sort)
  while read -r file; do
    count=$(wc -l < "$file")
    ((count <= most_lines)) || { echo "$file has $count lines: split it, at most $most_lines"; found=1; }
  done < <(find oi rt gpio hal -type f \( -name '*.?pp' -o -name '*.h' -o -name '*.c' \) | grep -vE "$long_ones" | sort)
  return "$found"
}

self_test() {
  local output
  copy=$(mktemp -d)
  trap 'rm -rf "$copy"' EXIT
  mkdir -p "$copy"/{oi,rt,gpio,hal/full}
  for i in $(seq "$most_files"); do : > "$copy/hal/full/file_$i.hpp"; done
  for i in $(seq "$most_lines"); do echo '//'; done > "$copy/rt/long.cpp"
  (check "$copy") || { echo "complains of what is allowed"; exit 1; }
  : > "$copy/hal/full/one_more.hpp"
  echo '//' >> "$copy/rt/long.cpp"
  output=$(check "$copy") && { echo "too large, and not found"; exit 1; }
  [[ $output == *"hal/full has 21 files"*"rt/long.cpp has 401 lines"* ]] || { echo "found otherwise: $output"; exit 1; }
  echo "what is too large is found"
}

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
case ${1:-} in
  --self-test) self_test ;;
  *) check "${1:-$root}" ;;
esac
