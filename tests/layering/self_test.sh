#!/usr/bin/env bash
# Proves that check.sh finds what it is there to find: one planted violation at a time, in a copy.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
cp -r "$root"/{oi,rt,gpio,hal} "$copy"/
# The files that the plants include.
while IFS=: read -r room _; do
  printf '#pragma once\n' > "$copy/$room/planted_target.hpp"
done < <(grep -v '^#' "$here/rooms.txt")

failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }

"$here/check.sh" "$copy" || fail "the tree itself has violations"

# plant FILE LINE REASON: LINE in FILE is reported on line 3 with REASON, and nothing else is.
plant() {
  local file=$1 line=$2 reason=$3 output
  printf '#pragma once\n\n%s\n' "$line" > "$copy/$file"
  if output=$("$here/check.sh" "$copy"); then
    fail "not found: $file: $line"
  elif [[ $output != "$file:3: "*"$reason"* || $output == *$'\n'* ]]; then
    fail "found otherwise than expected: $file: $line: $output"
  fi
  rm "$copy/$file"
}

# allowed FILE LINE: no complaint.
allowed() {
  local file=$1 line=$2 output
  printf '#pragma once\n\n%s\n' "$line" > "$copy/$file"
  output=$("$here/check.sh" "$copy") || fail "complains of what is allowed: $output"
  rm "$copy/$file"
}

# Room by room: anything not in the room's row is reported, and nothing else.
rows() { grep -v '^#' "$here/rooms.txt"; }
while IFS=: read -r room allowed_rooms; do
  expected=''
  printf '#pragma once\n' > "$copy/$room/planted.hpp"
  while IFS=: read -r other _; do
    [[ $other != "$room" ]] || continue
    echo "#include \"$other/planted_target.hpp\"" >> "$copy/$room/planted.hpp"
    [[ " $allowed_rooms " == *" $other "* ]] || expected+="$room must not include $other"$'\n'
  done < <(rows)
  found=$("$here/check.sh" "$copy" | sed -E 's/^[^ ]+ (.*) \(.*/\1/') || true
  [[ $found == "${expected%$'\n'}" ]] || fail "$room: expected: $expected found: $found"
  rm "$copy/$room/planted.hpp"
done < <(rows)
# Each row is needed: without it the tree does not pass. Nor does it with one arrow more, or one up.
mkdir "$copy/layering"
cp "$here/check.sh" "$copy/layering"
while IFS=: read -r room _; do
  grep -v "^$room:" "$here/rooms.txt" > "$copy/layering/rooms.txt"
  output=$("$copy/layering/check.sh" "$copy") && fail "the row of $room is not missed"
  [[ $output == *"$room is not in "* ]] || fail "the row of $room: $output"
done < <(rows)
sed 's|^hal/machine:|& gpio|' "$here/rooms.txt" > "$copy/layering/rooms.txt"
output=$("$copy/layering/check.sh" "$copy") && fail "an arrow that nothing uses passes"
[[ $output == *"nothing in hal/machine includes gpio" ]] || fail "unused arrow: $output"
sed 's|^hal/machine:|& hal/robot|' "$here/rooms.txt" > "$copy/layering/rooms.txt"
output=$("$copy/layering/check.sh" "$copy") && fail "an arrow upwards passes"
[[ $output == *"hal/machine is below hal/robot"* ]] || fail "arrow upwards: $output"
# oi does no I/O.
for header in iostream cstdio fstream unistd.h sys/ioctl.h ctime thread vector string memory Eigen/Core; do
  plant oi/planted.cpp "#include <$header>" 'oi does no I/O'
done
# Third parties only in their own layer, and only in sources.
plant rt/planted.cpp      '#include <gpiod.h>'         'rt does not know'
plant rt/planted.cpp      '#include <libserialport.h>' 'rt does not know'
plant gpio/planted.cpp    '#include <libserialport.h>' 'gpio does not know'
plant gpio/planted.cpp    '#include <Eigen/Core>'      'Eigen belongs to rt'
plant hal/planted.cpp     '#include <Eigen/Core>'      'Eigen belongs to rt'
plant hal/planted.cpp     '#include <gpiod.h>'         'hal does not know'
plant hal/planted.cpp     '#include <boost/asio.hpp>'  'hal does not know'
plant gpio/planted.hpp    '#include <gpiod.h>'         'third-party header in a header'
plant hal/planted.hpp     '#include <libserialport.h>' 'third-party header in a header'
plant hal/cli/planted.hpp '#include <CLI/CLI.hpp>'     'third-party header in a header'
for header in CLI/CLI.hpp toml++/toml.h nlohmann/json.hpp fmt/format.h; do
  plant hal/planted.cpp     "#include <$header>" 'only hal/cli, hal/config, hal/export, hal/feed, hal/learnt and hal/web may'
  plant hal/sim/planted.cpp "#include <$header>" 'only hal/cli, hal/config, hal/export, hal/feed, hal/learnt and hal/web may'
  plant rt/planted.cpp      "#include <$header>" 'only hal/cli, hal/config, hal/export, hal/feed, hal/learnt and hal/web may'
done
plant hal/export/planted.cpp '#include <fmt/format.h>'      'only hal/cli, hal/config, hal/export, hal/feed, hal/learnt and hal/web may'
plant hal/export/planted.hpp '#include <nlohmann/json.hpp>' 'third-party header in a header'
plant hal/feed/planted.cpp       '#include <libwebsockets.h>' 'hal does not know'
plant hal/web/server/planted.hpp '#include <libwebsockets.h>' 'hal does not know'
# Files that users name.
plant hal/cli/planted.cpp '#include <fstream>'              'files are read by'
plant hal/sim/planted.cpp '#include <fstream>'              'files are read by'
plant hal/planted.cpp     'int a = open("x", O_CREAT);'     'files are written by'
plant hal/cli/planted.cpp 'auto* a = std::fopen("x", "w");' 'files are written by'
plant hal/cli/planted.cpp 'std::ofstream a{"x"};'           'files are written by'
# Paths.
plant oi/planted.cpp  '#include "planted_target.hpp"'      'not a path from the repository root'
plant hal/planted.cpp '#include "../oi/planted_target.hpp"' 'not a path from the repository root'
plant hal/planted.cpp '#include "hal/../oi/planted_target.hpp"' 'not a path from the repository root'
plant hal/planted.cpp '#include "tests/sim/world.hpp"'     'not a path from the repository root'
plant oi/planted.cpp  '#include "oi/no_such_file.hpp"'     'no such file'
plant rt/planted.cpp  '#include <rt/planted_target.hpp>'   'ours goes in quotes'
plant rt/planted.cpp  '#include CARGOBAY_HEADER'           'computed include'

allowed oi/planted.hpp      '#include <span>'
allowed oi/planted.cpp      '#include "oi/planted_target.hpp"'
allowed rt/planted.hpp      '#include <Eigen/Core>'
allowed rt/planted.cpp      '#include <sys/mman.h>'
allowed rt/planted.hpp      '#include <sanitizer/rtsan_interface.h>'
allowed gpio/planted.cpp    '#include <gpiod.h>'
allowed hal/planted.cpp     '#include <libserialport.h>'
allowed hal/cli/planted.cpp '#include <CLI/CLI.hpp>'
allowed hal/export/planted.cpp '#include <nlohmann/json.hpp>'
allowed hal/config/planted.cpp    '#include <toml++/toml.h>'
allowed hal/learnt/planted.cpp    '#include <toml++/toml.h>'
allowed oi/planted.cpp      '// #include <iostream>'

if ((failures)); then
  echo "$failures failures"
  exit 1
fi
echo "every planted violation is found"
