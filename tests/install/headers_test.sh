#!/usr/bin/env bash
# The public headers compile without a warning in every standard of C and C++, and no struct of
# cargobay.h has a hole, on machines of 64 bit and of 32 bit.
# usage: tests/install/headers_test.sh HEADER_FOLDER [LAYOUTS]
#        tests/install/headers_test.sh --self-test HEADER_FOLDER
# LAYOUTS is a file to write the layouts and numbers to. --self-test proves with planted faults
# that each check fires. CC, CLANG: compilers instead of gcc and clang-22; theirs for C++ are
# found beside them. Without clang-22 it is left out, and said so.
set -euo pipefail

usage() {
  sed -n '2,9s/^# \{0,1\}//p' "$0" >&2
  exit 2
}
gcc=${CC:-gcc}
clang=${CLANG:-clang-22}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
warnings=(-Wall -Wextra -pedantic -Werror)
failed=0
complain() {
  echo "headers_test.sh: $*"
  failed=1
}

# plus_plus COMPILER: gcc-12 has its g++-12, clang-22 its clang++-22.
plus_plus() {
  local folder='' name=$1
  [[ $1 != */* ]] || { folder=${1%/*}/ name=${1##*/}; }
  case $name in
    *gcc*) echo "$folder${name/gcc/g++}" ;;
    *) echo "$folder${name/clang/clang++}" ;;
  esac
}

# newest COMPILER LANGUAGE STANDARD...: the first of the names that this compiler knows.
newest() {
  local compiler=$1 language=$2 standard
  shift 2
  for standard in "$@"; do
    "$compiler" -x "$language" "-std=$standard" -fsyntax-only /dev/null 2> /dev/null || continue
    echo "$standard"
    return
  done
}

# silent FOLDER HEADER LANGUAGE COMPILER STANDARD: twice in one source, and without a word.
silent() {
  printf '#include <%s>\n#include <%s>\nint main(void) { return 0; }\n' "$2" "$2" > "$work/silent.x"
  [[ $3 != c++ ]] || sed -i 's/(void)/()/' "$work/silent.x"
  "$4" -x "$3" "-std=$5" "${warnings[@]}" -I"$1" -fsyntax-only "$work/silent.x" > "$work/said" 2>&1
}

# all_standards FOLDER: or those that match `only`.
all_standards() {
  local compiler plus standard count=0
  for compiler in "${compilers[@]}"; do
    plus=$(plus_plus "$compiler")
    for standard in c89 c99 c11 c17 "$(newest "$compiler" c c23 c2x)"; do
      [[ $standard == ${only:-*} ]] || continue
      silent "$1" cargobay.h c "$compiler" "$standard" ||
        { complain "cargobay.h, $compiler -std=$standard:"; cat "$work/said"; }
      count=$((count + 1))
    done
    for standard in c++98 c++03 c++11 c++14 c++17 c++20 "$(newest "$plus" c++ c++23 c++2b)"; do
      [[ $standard == ${only:-*} ]] || continue
      silent "$1" cargobay.h c++ "$plus" "$standard" ||
        { complain "cargobay.h, $plus -std=$standard:"; cat "$work/said"; }
      count=$((count + 1))
      [[ -e $1/cargobay.hpp ]] || continue
      case $standard in
        c++2*)
          silent "$1" cargobay.hpp c++ "$plus" "$standard" ||
            { complain "cargobay.hpp, $plus -std=$standard:"; head -n 20 "$work/said"; }
          ;;
        *)
          if silent "$1" cargobay.hpp c++ "$plus" "$standard"; then
            complain "cargobay.hpp does not refuse $plus -std=$standard"
          elif ! grep -qE 'cargobay\.hpp:.*error: .*C\+\+20' "$work/said"; then
            complain "cargobay.hpp, $plus -std=$standard: not its own #error:"
            head -n 5 "$work/said"
          fi
          ;;
      esac
    done
  done
  ((failed)) || echo "ok      cargobay.h in $count standards of ${compilers[*]}"
}

# parsed FOLDER: "struct NAME", "member NAME", "enum NAME" and "number NAME" lines. A member that
# it does not understand is an error, because it would not be checked.
parsed() {
  "$gcc" -E -P -I"$1" -x c "$1/cargobay.h" | tr '\n' ' ' | sed -E 's/[{};]/&\n/g' | awk '
    function bad(what) { print "not understood: " what > "/dev/stderr"; exit 1 }
    { gsub(/^ +| +$/, "") }
    /^struct cargobay_[a-z_]+ \{$/ { print "struct " $2; inside = "struct"; next }
    /^enum cargobay_[a-z_]+ \{$/ { print "enum " $2; inside = "enum"; next }
    !inside || /^;?$/ { next }
    inside == "enum" {
      gsub(/\}.*/, "")
      count = split($0, parts, ",")
      for (i = 1; i <= count; ++i) {
        if (parts[i] !~ /[A-Z]/) continue
        if (!match(parts[i], /CARGOBAY_[A-Z0-9_]+/)) bad(parts[i])
        print "number " substr(parts[i], RSTART, RLENGTH)
      }
      inside = ""; next
    }
    /^\}$/ { inside = ""; next }
    { sub(/;$/, ""); member = $0 }
    member ~ /\(\*/ { sub(/.*\(\* */, "", member); sub(/\).*/, "", member) }
    member ~ /,/ { bad(member) }
    { sub(/ *\[.*/, "", member); sub(/.*[ *]/, "", member) }
    member !~ /^[a-z_0-9]+$/ { bad($0) }
    { print "member " member }'
}

# asserts: from the parsed lines, that each member begins where the one before it ends.
asserts() {
  awk '
    function must(place, words) {
      printf "_Static_assert(%s == %s, \"%s\");\n", place, before, words
    }
    function end() {
      if (name != "") must("sizeof(struct " name ")", "padding at the end of " name)
    }
    $1 == "struct" { end(); name = $2; before = "0" }
    $1 == "enum" { end(); name = "" }
    $1 == "member" {
      place = "offsetof(struct " name ", " $2 ")"
      must(place, "a hole before " name "." $2)
      before = place " + sizeof(((struct " name "*)0)->" $2 ")"
    }
    END { end() }'
}

# printer: from the parsed lines, a program that prints layouts and numbers.
printer() {
  printf '#include <cargobay.h>\n#include <stdio.h>\n'
  printf '#define SIZE(s) printf("struct %%s: %%u bytes\\n", #s, (unsigned)sizeof(struct s))\n'
  printf '#define AT(s, m) printf("  %%3u %%3u %%s\\n", (unsigned)offsetof(struct s, m), '
  printf '(unsigned)sizeof(((struct s*)0)->m), #m)\n'
  printf '#define NUMBER(n) printf("%%s %%d\\n", #n, (int)n)\n'
  echo 'int main(void) {'
  awk '$1 == "struct" { name = $2; print "  SIZE(" name ");" }
    $1 == "member" { print "  AT(" name ", " $2 ");" }
    $1 == "number" { print "  NUMBER(" $2 ");" }'
  echo '  return 0; }'
}

# checked_by NAME COMMAND...: the assertions, by a compiler that only looks. It needs no C library.
checked_by() {
  local name=$1
  shift
  if "$@" -std=c11 -ffreestanding -I"$folder" -fsyntax-only "$work/asserts.c" \
    > "$work/said" 2>&1; then
    echo "ok      layouts and numbers, $name"
    looked=$((looked + 1))
  else
    complain "layouts and numbers, $name:"
    grep -oE '(a hole before|padding at the end of|[A-Z0-9_]+ is not) [a-z0-9_.-]+' "$work/said" ||
      head -n 20 "$work/said"
  fi
}

# layouts FOLDER FILE
layouts() {
  local folder=$1 looked=0
  parsed "$folder" > "$work/parsed" ||
    { complain "cargobay.h has something that this does not understand"; return; }
  (($(grep -c '^struct' "$work/parsed") >= 15 && $(grep -c '^member' "$work/parsed") >= 150)) ||
    complain "found hardly a struct in $folder/cargobay.h"
  printer < "$work/parsed" > "$work/printer.c"
  "$gcc" -I"$folder" "$work/printer.c" -o "$work/printer" && "$work/printer" > "$2" || exit 1
  # The numbers as this machine has them, for compilers whose programs do not run here.
  {
    echo '#include <cargobay.h>'
    asserts < "$work/parsed"
    awk '/^CARGOBAY_/ {
      printf "_Static_assert(%s == %s, \"%s is not %s\");\n", $1, $2, $1, $2 }' "$2"
  } > "$work/asserts.c"
  checked_by "this machine" "$gcc"
  # 32 bit: x86 aligns int64_t to 4, arm to 8.
  if "$gcc" -m32 -ffreestanding -fsyntax-only -x c /dev/null 2> /dev/null; then
    checked_by "$gcc -m32" "$gcc" -m32
  fi
  if command -v "$clang" > /dev/null; then
    checked_by "32-bit arm" "$clang" --target=armv7-linux-gnueabihf
    checked_by "64-bit arm" "$clang" --target=aarch64-linux-gnu
  elif command -v arm-linux-gnueabihf-gcc > /dev/null; then
    checked_by "32-bit arm" arm-linux-gnueabihf-gcc
  fi
  ((failed || looked >= 2)) || complain "no compiler for 32 bit: apt-get install clang-22"
  if printf 'int main(void) { return 0; }\n' | "$gcc" -m32 -x c - -o "$work/short" 2> /dev/null &&
    "$work/short"; then
    "$gcc" -m32 -I"$folder" "$work/printer.c" -o "$work/printer" && "$work/printer" > "$2.32"
  fi
}

# copied FROM: a fresh folder with the headers. What the compiler takes for a folder of the system
# gets no warnings, and HEADER_FOLDER may be /usr/include.
copied() {
  rm -rf "$work/headers"
  mkdir "$work/headers"
  cp "$1/cargobay.h" "$work/headers"
  [[ ! -e $1/cargobay.hpp ]] || cp "$1/cargobay.hpp" "$work/headers"
}

check() {
  all_standards "$work/headers"
  layouts "$work/headers" "$1"
}

# caught WHAT CHECK WORDS FILE SED: with this planted, the check fails and says these words.
caught() {
  local output
  copied "$from"
  sed -i -E "$5" "$work/headers/$4"
  ! cmp -s "$from/$4" "$work/headers/$4" || { echo "headers_test.sh: could not plant $1"; exit 1; }
  if output=$("$2" "$work/headers" "$work/layouts" 2>&1; exit "$failed"); then
    echo "headers_test.sh: did not see $1"
    exit 1
  fi
  grep -qE -e "$3" <<< "$output" ||
    { echo "headers_test.sh: of $1 it says"; echo "$output"; exit 1; }
  echo "ok      sees $1"
}

self_test() {
  local truth='/^struct cargobay_truth \{/,/^\}/'
  compilers=("$gcc")
  only='c89' caught "a comment of C99" all_standards '-std=c89' cargobay.h '/^#include <stdint.h>/a // planted'
  only='c++98' caught "a comma of C++11" all_standards '-std=c\+\+98' cargobay.h \
    's/(CARGOBAY_E_WHEELS = -27)/\1,/'
  caught "a hole" layouts 'a hole before cargobay_truth\.' cargobay.h \
    "$truth"' s/^  int32_t mode;/&\n  uint32_t planted;/'
  caught "padding at the end" layouts 'padding at the end of cargobay_truth' cargobay.h \
    "$truth"' s/^  int32_t commanded_right_mm_s;/&\n  uint32_t planted;/'
  caught "a number that depends on the machine" layouts 'CARGOBAY_LED_ADVANCE is not' cargobay.h \
    's/(CARGOBAY_LED_ADVANCE = )1 << 1/\1(int)sizeof(long)/'
  caught "a member that it cannot read" layouts 'does not understand' cargobay.h \
    "$truth"' s/^  double x_mm;/  double x_mm, planted;/'
  if command -v "$clang" > /dev/null; then
    caught "a hole on 32-bit arm only" layouts 'a hole before cargobay_options\.' cargobay.h \
      's/^  double acceleration_mm_s2;/  const char* planted;\n&/'
  fi
  [[ -e $from/cargobay.hpp ]] || return 0
  only='c++17' caught "an hpp that does not refuse C++17" all_standards 'does not refuse|not its own' \
    cargobay.hpp 's/^# *error .*/\/\/ planted/'
  only='c++20' caught "an hpp with a warning" all_standards 'cargobay\.hpp, .*-std=c\+\+20' cargobay.hpp \
    '/^#include .*cargobay\.h[>"]/a static int planted(int unused) { return 0; }'
}

from=''
do_self_test=0
if [[ ${1:-} == --self-test ]]; then
  do_self_test=1
  shift
fi
(($# == 1 || ($# == 2 && !do_self_test))) || usage
from=$1
[[ -f $from/cargobay.h ]] || { echo "headers_test.sh: there is no $from/cargobay.h" >&2; exit 2; }
compilers=("$gcc")
if command -v "$clang" > /dev/null; then
  compilers+=("$clang")
else
  echo "without $clang: apt-get install clang-22"
fi
if ((do_self_test)); then
  self_test
  exit
fi
copied "$from"
check "${2:-$work/layouts}"
((!failed)) || exit 1
echo "headers: $(grep -c '^struct' "$work/parsed") structs without a hole," \
  "$(grep -c '^number' "$work/parsed") numbers"
