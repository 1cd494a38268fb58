#!/usr/bin/env bash
# No room of hal has more than 20 files, no source and no test more than 400 lines, no class more than
# 25 data members, and the header of the control cycle parses no part of the loop. (clang-tidy sees to
# functions: at most 60 lines.)
# usage: sizes.sh [--self-test | ROOT]; prints what is too large, exit 1 if anything is.
set -euo pipefail

most_files=20
most_lines=400
most_members=25
# A header that is the manual of an API is as long as the API is.
long_ones='^hal/c/cargobay\.(h|hpp)$|^tests/abi/first/cargobay\.h$'

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
  done < <(find oi rt gpio hal tests -type f \( -name '*.?pp' -o -name '*.h' -o -name '*.c' \
    -o -name '*.js' -o -name '*.css' -o -name '*.py' \) | grep -vE "$long_ones" | sort)
  while read -r count class; do
    ((count <= most_members)) || { echo "$class has $count members: make parts of it, at most $most_members"; found=1; }
  done < <(members)
  if grep -nH '^#include "hal/' hal/cycle/control_cycle.hpp; then
    echo "who includes this would parse the whole loop: declare it, and include it in the .cpp"
    found=1
  fi
  return "$found"
}

# The data members of each class, those that all its objects share left out.
members() {
  find oi rt gpio hal -type f -name '*.?pp' | grep -vE "$long_ones" | sort |
    ctags -L - --language-force=C++ --kinds-C++=m --fields=+s -f - | grep -v 'static constexpr' |
    grep -oE '(class|struct):[A-Za-z0-9_:]+' | sort | uniq -c
}

self_test() {
  local output
  copy=$(mktemp -d)
  trap 'rm -rf "$copy"' EXIT
  mkdir -p "$copy"/{oi,rt,gpio,hal/full,hal/cycle,tests}
  echo '#include "rt/clock.hpp"' > "$copy/hal/cycle/control_cycle.hpp"
  for i in $(seq "$most_files"); do : > "$copy/hal/full/file_$i.hpp"; done
  for i in $(seq "$most_lines"); do echo '//'; done > "$copy/rt/long.cpp"
  cp "$copy/rt/long.cpp" "$copy/tests/long.py"
  {
    echo 'class Large {'
    echo '  static constexpr int kShared = 1;'
    for i in $(seq "$most_members"); do echo "  int member_${i}_ = 0;"; done
  } > "$copy/gpio/large.hpp"
  echo '};' >> "$copy/gpio/large.hpp"
  (check "$copy") || { echo "complains of what is allowed"; exit 1; }
  : > "$copy/hal/full/one_more.hpp"
  for i in rt/long.cpp tests/long.py; do echo '//' >> "$copy/$i"; done
  sed -i '$i\  bool one_more_;' "$copy/gpio/large.hpp"
  echo '#include "hal/cycle/cycle_pass.hpp"' >> "$copy/hal/cycle/control_cycle.hpp"
  output=$(check "$copy") && { echo "too large, and not found"; exit 1; }
  [[ $output == *"hal/full has 21 files"*"rt/long.cpp has 401 lines"*"tests/long.py has 401 lines"*"class:Large has 26 members"*"parse the whole loop"* ]] || { echo "found otherwise: $output"; exit 1; }
  echo "what is too large is found"
}

command -v ctags > /dev/null || { echo "sizes.sh: ctags is missing: run .ci/packages.sh test"; exit 1; }
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
case ${1:-} in
  --self-test) self_test ;;
  *) check "${1:-$root}" ;;
esac
