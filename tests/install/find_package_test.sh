#!/usr/bin/env bash
# find_package(cargobay) in projects that say nothing of a standard, or of an older one, or have no
# C++ at all: each builds and runs. Without C++20, cargobay.hpp says so in one line.
# usage: tests/install/find_package_test.sh BUILD_DIR
set -euo pipefail

build=$(realpath "${1:?usage: tests/install/find_package_test.sh BUILD_DIR}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset CARGOBAY_GUARD CXXFLAGS CFLAGS
for component in library development; do
  cmake --install "$build" --prefix "$work/prefix" --component "$component" > /dev/null
done

cat > "$work/main.cpp" << 'END'
#include <cargobay.hpp>

#include <cstdio>

int main() {
  auto sim = cargobay::Sim::open({});
  std::puts(sim ? "there is a robot" : "there is none");
}
END
cat > "$work/main.c" << 'END'
#include <cargobay.h>
#include <stdio.h>

int main(void) {
  puts(cargobay_version());
  return 0;
}
END

failed=0
# builds NAME LANGUAGES SOURCE [LINE_OF_CMAKE]: and prints what the program prints.
builds() {
  local folder=$work/$1
  mkdir -p "$folder"
  cat > "$folder/CMakeLists.txt" << END
cmake_minimum_required(VERSION 3.16)
project($1 $2)
${4:-}
find_package(cargobay REQUIRED)
add_executable(program ../$3)
target_link_libraries(program cargobay::cargobay)
END
  if cmake -S "$folder" -B "$folder/build" -D CMAKE_PREFIX_PATH="$work/prefix" > "$folder/log" 2>&1 &&
    cmake --build "$folder/build" >> "$folder/log" 2>&1 && "$folder/build/program" > "$folder/said"; then
    echo "ok      $1: $(< "$folder/said")"
  else
    echo "FAILED  $1"
    tail -n 20 "$folder/log"
    failed=1
  fi
}

builds plain CXX main.cpp
builds older_standard CXX main.cpp 'set(CMAKE_CXX_STANDARD 17)'
builds strict CXX main.cpp 'set(CMAKE_CXX_EXTENSIONS OFF)'
builds only_c C main.c
builds both 'C CXX' main.cpp

# Without CMake: one complaint of the header, and it says what to do.
header=$(find "$work/prefix" -name cargobay.hpp)
echo '#include <cargobay.hpp>' > "$work/old.cpp"
said=$("${CXX:-c++}" -std=c++17 -fsyntax-only -I "${header%/*}" "$work/old.cpp" 2>&1) && failed=1
if [[ $(grep -c ' error: ' <<< "$said") == 1 &&
  $said == *"needs C++20 or later: compile with -std=c++20, or use cargobay.h"* ]]; then
  echo "ok      C++17 is refused in one line"
else
  printf 'FAILED  C++17 is not refused in one line:\n%s\n' "$said"
  failed=1
fi
((!failed)) && echo "find_package_test.sh: all as it should be"
