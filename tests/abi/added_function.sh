#!/usr/bin/env bash
# A function that is added touches the header, one source and the map, and nothing else: it is
# exported under its own version, the tests that are derived from the header call it, and no other
# check wants an edit. A program that needs it is refused by a library without it, before main().
# usage: tests/abi/added_function.sh BUILD
#   BUILD  build folder with libcargobay.so
set -euo pipefail
build=$(realpath "${1:?usage: tests/abi/added_function.sh BUILD}")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
root=$PWD
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
complain() { echo "added_function.sh: $*" >&2; exit 1; }

# The three edits, in a copy.
mkdir -p "$work/tree/tests"
cp -r hal "$work/tree"
cp -r tests/capi tests/abi "$work/tree/tests"
cd "$work/tree"
header=hal/c/cargobay.h
awk '
  /^#ifdef __cplusplus$/ { last = NR }
  { line[NR] = $0 }
  END {
    for (i = 1; i <= NR; ++i) {
      if (i == last) {
        print "/** Added later. @return 0; CARGOBAY_E_HANDLE. Any thread; real-time safe. */"
        print "int cargobay_of_a_later_version(struct cargobay_robot* robot);\n"
      }
      print line[i]
    }
  }' "$root/$header" > "$header"
cat > hal/c/functions/added.cpp << 'END'
#include "hal/c/cargobay.h"
#include "hal/c/robot_object.hpp"

extern "C" int cargobay_of_a_later_version(struct cargobay_robot* robot) {
  const cargobay::c::RobotUse use = cargobay::c::robots().use(robot);
  return use ? static_cast<int>(CARGOBAY_OK) : cargobay::c::bad_robot(robot);
}
END
printf 'CARGOBAY_0.2 {\n  global:\n    cargobay_of_a_later_version;\n} CARGOBAY_0.1;\n' >> hal/c/libcargobay.map

# The library as the build makes it, with that source and that map.
cd "$build"
g++ -std=c++20 -fPIC -I "$work/tree" -I "$root" -c "$work/tree/hal/c/functions/added.cpp" -o "$work/added.o"
link=$(ninja -t commands cargobay_shared | grep -E -- '-shared ' | sed 's/^: && //; s/ && :$//')
link=${link//$root\/hal\/c\/libcargobay.map/$work\/tree\/hal\/c\/libcargobay.map}
link=$(sed -E "s# -o libcargobay\.so[^ ]*# $work/added.o -o $work/libcargobay.so.0#" <<< "$link")
eval "$link"
ln -s libcargobay.so.0 "$work/libcargobay.so"

cd "$work/tree"
tests/capi/coverage.sh "$work/libcargobay.so.0" > "$work/coverage.log" 2>&1 ||
  { cat "$work/coverage.log" >&2; complain "the coverage of the C API wants another edit"; }
if command -v abidiff > /dev/null && [[ $(uname -m) == x86_64 ]]; then
  abidiff --no-added-syms "$build/libcargobay.so" "$work/libcargobay.so.0" > "$work/abidiff.log" 2>&1 ||
    { cat "$work/abidiff.log" >&2; complain "abidiff takes an addition for a change"; }
fi
for test in tests/capi/derived/*.c; do
  name=$(basename "$test" .c)
  tests/capi/every_function.sh "$header" > "$work/every_function.h"
  grep -q cargobay_of_a_later_version "$work/every_function.h" || complain "the derived tests leave it out"
done

cat > "$work/program.c" << 'END'
#include <stdio.h>
#include "cargobay.h"
int main(void) {
  puts("in main");
  return cargobay_of_a_later_version(NULL) == CARGOBAY_E_HANDLE ? 0 : 1;
}
END
gcc -std=c99 -I hal/c -o "$work/program" "$work/program.c" -L "$work" -lcargobay
LD_LIBRARY_PATH=$work "$work/program" > /dev/null || complain "a program does not find the new function"
if LD_LIBRARY_PATH=$build "$work/program" > "$work/out" 2> "$work/err"; then
  complain "an older library runs a program that needs the new function"
fi
[[ ! -s $work/out ]] || complain "it was refused only in the middle of main()"
grep -q 'CARGOBAY_0.2' "$work/err" || { cat "$work/err" >&2; complain "refused otherwise"; }
echo "a function was added with three edits; an older library refuses a program that needs it"
