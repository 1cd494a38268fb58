#!/usr/bin/env bash
# Every function of the header is called by a test in C, every error it documents is provoked by
# one, and the library exports these functions and nothing else.
# usage: tests/capi/coverage.sh LIBRARY
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
library=${1:?usage: tests/capi/coverage.sh LIBRARY}
header=hal/c/cargobay.h

functions=$(grep -oE '^[a-z].*\bcargobay_[a-z0-9_]+\(' "$header" | grep -v '^typedef' |
  grep -oE 'cargobay_[a-z0-9_]+\($' | tr -d '(' | sort -u)
failed=0
complain() { echo "coverage.sh: $*" >&2; failed=1; }
[[ $(wc -l <<< "$functions") -gt 40 ]] || complain "found hardly any function in $header"
for function in $functions; do
  grep -qE "\b$function\(" tests/capi/*.c || complain "no test in C calls $function()"
done
for code in $(grep -oE '\bCARGOBAY_E_[A-Z]+ = ' "$header" | cut -d' ' -f1); do
  grep -qE "\b$code\b" tests/capi/*.c || complain "no test provokes $code"
done
exported=$(nm -D --defined-only "$library" | awk '$2 == "T" { print $3 }' | sed 's/@.*//' | sort -u)
diff <(echo "$functions") <(echo "$exported") || complain "the library exports other functions"
others=$(nm -D --defined-only "$library" | awk '$2 != "T" && $2 != "A" { print $3 }')
[[ -z $others ]] || complain "the library exports more than functions: $others"
((!failed)) || exit 1
echo "$(wc -l <<< "$functions") functions, each called by a test in C"
