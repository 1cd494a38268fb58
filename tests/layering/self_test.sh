#!/usr/bin/env bash
# Shows that check.sh finds what it is there to find: one planted violation at a time, in a copy.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
cp -r "$root"/{oi,rt,gpio,hal} "$copy"/
mkdir -p "$copy"/hal/{sim,c,cli}
# What the plants include must exist whatever the tree looks like.
for room in oi rt gpio hal hal/sim hal/c hal/cli; do
  printf '#pragma once\n' > "$copy/$room/planted_target.hpp"
done

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

# No layer includes upwards or sideways.
plant oi/planted.hpp   '#include "rt/planted_target.hpp"'   'oi must not include rt'
plant oi/planted.cpp   '#include "hal/planted_target.hpp"'  'oi must not include hal'
plant oi/planted.cpp   '  #  include "gpio/planted_target.hpp"' 'oi must not include gpio'
plant rt/planted.hpp   '#include "oi/planted_target.hpp"'   'rt must not include oi'
plant rt/planted.cpp   '#include "gpio/planted_target.hpp"' 'rt must not include gpio'
plant rt/planted.cpp   '#include "hal/planted_target.hpp"'  'rt must not include hal'
plant gpio/planted.hpp '#include "oi/planted_target.hpp"'   'gpio must not include oi'
plant gpio/planted.cpp '#include "rt/planted_target.hpp"'   'gpio must not include rt'
plant gpio/planted.cpp '#include "hal/sim/planted_target.hpp"' 'gpio must not include hal'
# Inside hal.
plant hal/planted.cpp     '#include "hal/cli/planted_target.hpp"' 'hal must not include hal/cli'
plant hal/sim/planted.cpp '#include "hal/cli/planted_target.hpp"' 'hal/sim must not include hal/cli'
plant hal/planted.hpp     '#include "hal/c/planted_target.hpp"'   'hal must not include hal/c'
plant hal/planted.hpp     '#include "hal/sim/planted_target.hpp"' 'knows the simulation'
# oi does nothing but think.
for header in iostream cstdio fstream unistd.h sys/ioctl.h ctime thread vector string memory Eigen/Core; do
  plant oi/planted.cpp "#include <$header>" 'oi does no I/O'
done
# Third parties in their own layer only, and in sources only.
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
  plant hal/planted.cpp     "#include <$header>" 'only hal/cli and hal/config* may'
  plant hal/sim/planted.cpp "#include <$header>" 'only hal/cli and hal/config* may'
  plant rt/planted.cpp      "#include <$header>" 'only hal/cli and hal/config* may'
done
# What users name.
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
allowed hal/planted.hpp     '#include "gpio/planted_target.hpp"'
allowed hal/sim/planted.cpp '#include "hal/planted_target.hpp"'
allowed hal/c/planted.cpp   '#include "hal/sim/planted_target.hpp"'
allowed hal/cli/planted.cpp '#include <CLI/CLI.hpp>'
allowed hal/cli/planted.cpp '#include "hal/sim/planted_target.hpp"'
allowed hal/config_planted.cpp    '#include <toml++/toml.h>'
allowed oi/planted.cpp      '// #include <iostream>'

if ((failures)); then
  echo "$failures failures"
  exit 1
fi
echo "every planted violation is found"
