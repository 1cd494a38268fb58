#!/usr/bin/env bash
# Every function of the header is called by a test in C, every error it documents is provoked by
# one, and the library exports these functions and nothing else. tests/capi/derived calls a function
# as soon as the header has it; from its release on, when it is in the ABI dump, a test of its own is
# wanted too.
# usage: tests/capi/coverage.sh LIBRARY
set -euo pipefail
library=$(realpath "${1:?usage: tests/capi/coverage.sh LIBRARY}")
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
header=hal/c/cargobay.h
dump=tests/abi/libcargobay.so.0.abi

failed=0
complain() { echo "coverage.sh: $*" >&2; failed=1; }

functions=$(grep -oE '^[a-z].*\bcargobay_[a-z0-9_]+\(' "$header" | grep -v '^typedef' |
  grep -oE 'cargobay_[a-z0-9_]+\($' | tr -d '(' | sort -u)
derived=$(tests/capi/every_function.sh "$header" | grep -oE '^    \{"cargobay_[a-z0-9_]+' |
  cut -d'"' -f2 | sort -u)
diff <(echo "$functions") <(echo "$derived") || complain "tests/capi/derived calls other functions"
released=$(grep -oE "<elf-symbol name='cargobay_[a-z0-9_]+'" "$dump" | cut -d"'" -f2 | sort -u)
for function in $(comm -12 <(echo "$functions") <(echo "$released")); do
  grep -qE "\b$function\(" tests/capi/*.c || complain "no test in C calls $function()"
done
codes=$(grep -oE '\bCARGOBAY_E_[A-Z_]+ = ' "$header" | cut -d' ' -f1)
[[ $(wc -l <<< "$codes") -gt 20 ]] || complain "found hardly any code in $header"
for code in $codes; do
  grep -qE "\b$code\b" tests/capi/*.c || complain "no test provokes $code"
done
exported=$(nm -D --defined-only "$library" | awk '$2 == "T" { print $3 }' | sed 's/@.*//' | sort -u)
diff <(echo "$functions") <(echo "$exported") || complain "the library exports other functions"
others=$(nm -D --defined-only "$library" | awk '$2 != "T" && $2 != "A" { print $3 }')
[[ -z $others ]] || complain "the library exports more than functions: $others"
((!failed)) || exit 1
echo "$(wc -l <<< "$functions") functions, each called by a test in C"
