#!/usr/bin/env bash
# Layout and names of the whole tree.
# usage: tests/lint.sh [--format] [--tidy] [--alone] [--proof] [--fix] [FILE...]
#   --format  clang-format, file names, phrases, shell syntax
#   --tidy    clang-tidy on every source and every header (or on FILE...)
#   --alone   the same with each source by itself: also finds a missing #include; takes half an hour
#   --proof   proves with planted violations that both fire
#   --fix     lets clang-format rewrite the files
# With none of these: format, tidy and proof.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

clang_format=${CLANG_FORMAT:-clang-format-22}
clang_tidy=${CLANG_TIDY:-clang-tidy-22}
jobs=$(nproc)

sources() {
  find oi rt gpio hal tests examples -type f \
    \( -name '*.hpp' -o -name '*.cpp' -o -name '*.h' -o -name '*.c' \) -print | sort
}

# For awk: what neither the formatter breaks, which leaves comments as they are, nor anything else.
long_comment='length > 100 && /^ *(\/\/|\*)/ { print FILENAME ":" FNR ": over 100 columns" }'
long_line='FNR == 1 { code = 0 } /^ *```/ { code = !code } length > 120 && !code && !/^(\||!|<)/ { print FILENAME ":" FNR ": over 120 columns" }'
odd_phrases='[a-z]*manieth|(is|are) (not )?to be had|anew|tells? of|stands? in for|where there is none|roll on'

need() {
  command -v "$1" > /dev/null && return
  echo "lint.sh: $1 is missing: run .ci/packages.sh test" >&2
  exit 2
}

check_format() {
  need "$clang_format"
  local failed=0 file
  # One line per place; the quoted source lines are left out.
  sources | xargs --no-run-if-empty "$clang_format" --dry-run -Werror 2>&1 |
    { grep -E '^[^ ].*(error|warning):' || true; } || failed=1
  # clang-tidy sees this only with --alone.
  if sources | xargs --no-run-if-empty grep -nE '^ *# *include +["<][^">]+\.(c|cpp|cxx)[">]'; then
    echo "a source file is never included"
    failed=1
  fi
  if sources | xargs awk "$long_comment" | grep . ||
    find docs README.md CHANGELOG.md -name '*.md' -print0 | sort -z | xargs -0 awk "$long_line" | grep .; then
    echo "break these lines"
    failed=1
  fi
  # The same goes for a namespace alias that nothing uses.
  while IFS=: read -r file _ alias; do
    (($(grep -cE "\\b$alias::" "$file") > 0)) || {
      echo "$file: the namespace alias $alias is unused"
      failed=1
    }
  done < <(sources | xargs --no-run-if-empty grep -nE '^ *namespace \w+ =' |
    sed -E 's/(:[0-9]+:) *namespace (\w+) =.*/\1\2/')
  # Files are lower_case; macros live in hal/c/cargobay.h.
  while read -r file; do
    echo "$file: a file is named in lower_case"
    failed=1
  done < <(sources | grep -vE '/[a-z0-9_]+\.(hpp|cpp|h|c)$' || true)
  # The worst turns of phrase that this project had. The rest is for a reader.
  if find oi rt gpio hal tests examples docs .ci .cmake README.md CHANGELOG.md -type f \
    ! -path tests/lint.sh ! -path 'tests/lint/*' ! -path 'tests/abi/*' ! -path 'tests/fuzz/corpus/*' \
    ! -name '*.svg' ! -name '*.pyc' -print | sort | xargs grep -nHwE "$odd_phrases"; then
    echo "say it plainly"
    failed=1
  fi
  while read -r file; do
    bash -n "$file" || failed=1
    [[ -x $file ]] || { echo "$file: not executable"; failed=1; }
  done < <(find .ci tests examples -name '*.sh' | sort)
  return "$failed"
}

# tidy_one BUILD FILE: quiet if there is nothing to report.
tidy_one() {
  local output checks=''
  # A unity source includes the others, so that they look like headers.
  [[ $2 != */Unity/* ]] || checks=-bugprone-suspicious-include,-google-global-names-in-headers
  output=$("$clang_tidy" -p "$1" --quiet --checks="$checks" "$2" 2>&1) && return
  printf '%s\n' "$output" | grep -vE '^[0-9]+ warnings? (generated|treated as errors?)|^Suppressed ' || true
  return 1
}

# compiled BUILD: the C++ files that it compiles, without the placeholders of empty layers and of
# precompiled headers. C is left out: names follow C rules there.
compiled() {
  sed -nE 's/^ *"file": "(.*\.(cpp|cxx))",?$/\1/p' "$1/compile_commands.json" |
    grep -vE '/(empty|pch|page_files)\.cpp$|/cmake_pch\.hxx\.cxx$|/cargobay_gtest_pch[a-z_]*\.dir/' | sort -u
}

# sources_in FILE...: the files themselves or, for a unity source, the files that it includes.
sources_in() {
  local file
  for file in "$@"; do
    case $file in
      */Unity/*) sed -nE 's/^#include "(.*)"$/\1/p' "$file" ;;
      *) echo "$file" ;;
    esac
  done | sort -u
}

# configure BUILD CMAKE-ARGUMENT...: for clang-tidy.
configure() {
  cmake --preset tidy -B "$@" > "$1.log" 2>&1 || { cat "$1.log"; return 1; }
}

check_tidy() {
  need "$clang_tidy"
  local build=build/tidy files missing
  if ((do_alone)) || (($#)); then
    configure "$build" || return
  else
    # Many sources at a time: most of the time goes into what they all include.
    build=build/tidy-unity
    configure "$build" -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=16 \
      -DCMAKE_DISABLE_PRECOMPILE_HEADERS=OFF || return
    ninja -C "$build" -t targets all | sed -n 's/^\([^:]*cmake_pch\.hxx\.pch\):.*/\1/p' |
      xargs ninja -C "$build" >> "$build.log" 2>&1 || { tail "$build.log"; return 1; }
    cp tests/.clang-tidy "$build/tests/"
  fi
  if (($#)); then
    files=$(printf "$PWD/%s\n" "$@")
  else
    files=$(compiled "$build")
    # Files that are wrong on purpose (tests/sanitizers) or for the other libgpiod are not in it.
    missing=$(comm -23 \
      <(sources | grep -E '\.cpp$' | sed "s|^|$PWD/|" | grep -vE '_v[12]\.cpp$|/tests/sanitizers/' | sort) \
      <(sources_in $files))
    if [[ -n $missing ]]; then
      echo "compiled by no target, so seen by no check:"
      echo "$missing"
      return 1
    fi
  fi
  export clang_tidy
  export -f tidy_one
  # The long ones first, so that no processor is idle at the end.
  { grep -F /Unity/ <<< "$files" || true; grep -vF /Unity/ <<< "$files" || true; } |
    xargs -P "$jobs" -n 1 bash -c 'tidy_one "$@"' _ "$build"
}

mkdir -p build
do_format=0 do_tidy=0 do_alone=0 do_proof=0 do_fix=0 files=()
for argument in "$@"; do
  case $argument in
    --format) do_format=1 ;;
    --tidy) do_tidy=1 ;;
    --alone) do_tidy=1 do_alone=1 ;;
    --proof) do_proof=1 ;;
    --fix) do_fix=1 ;;
    -*) sed -n '2,10s/^# \{0,1\}//p' "$0"; exit 2 ;;
    *) do_tidy=1 files+=("$argument") ;;
  esac
done
if ((do_format + do_tidy + do_proof + do_fix == 0)); then do_format=1 do_tidy=1 do_proof=1; fi

status=0
if ((do_fix)); then
  need "$clang_format"
  sources | xargs --no-run-if-empty -P "$jobs" -n 16 "$clang_format" -i
fi
if ((do_format)); then check_format || status=1; fi
if ((do_proof)); then tests/lint/proof.sh || status=1; fi
if ((do_tidy)); then check_tidy ${files[@]+"${files[@]}"} || status=1; fi
exit "$status"
