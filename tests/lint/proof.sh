#!/usr/bin/env bash
# Proves that the lint fires: a misspelt check or option matches nothing and would stay green.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
clang_format=${CLANG_FORMAT:-clang-format-22}
clang_tidy=${CLANG_TIDY:-clang-tidy-22}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0
fail() { echo "FAILED: $*"; failures=$((failures + 1)); }

mkdir -p "$scratch"/{oi,tests,bad}
cp .clang-tidy .clang-format "$scratch"/
cp tests/.clang-tidy "$scratch"/tests/
cat > "$scratch/oi/planted.hpp" << 'CODE'
#pragma once

namespace cargobay::oi {

class MisnamedMember {
 public:
  [[nodiscard]] int count() const { return withoutTrailing; }

 private:
  int withoutTrailing = 0;
};

}  // namespace cargobay::oi
CODE
cat > "$scratch/oi/planted.cpp" << 'CODE'
#include "oi/planted.hpp"

#define UNPREFIXED_MACRO 1

namespace cargobay::oi {

namespace BadNamespace {
struct misnamed_type {
  int PublicMember = 0;
};
}  // namespace BadNamespace

enum class misnamed_enum { BadEnumerator };
using misnamed_alias = int;

inline constexpr int unprefixed_constant = 3;

int MisnamedFunction(int BadParameter);

int MisnamedFunction(int BadParameter) {
  const int BadLocal = BadParameter;
  int BadVariable = BadLocal;
  BadVariable += unprefixed_constant;
  return BadVariable;
}

template <typename bad_template_parameter>
bad_template_parameter identity(bad_template_parameter value) {
  return value;
}

template <int bad_value_parameter>
int parameter_value() {
  return bad_value_parameter;
}

namespace unused_alias = BadNamespace;

void* null_pointer();

void* null_pointer() { return 0; }

}  // namespace cargobay::oi
CODE
cat > "$scratch/oi/good.cpp" << 'CODE'
#include <cstdint>

namespace cargobay::oi {

struct WheelPair {
  int left = 0;
  int right = 0;
};

enum class Mode : std::uint8_t { passive, safe };

inline constexpr int kMaxWheelSpeed = 500;

class SpeedLimit {
 public:
  [[nodiscard]] int limited(int speed_mm_s) const {
    constexpr int kSlack = 1;
    constexpr const int& kSlackReference = kMaxWheelSpeed;
    const int limit = limit_mm_s_ + kSlack + kSlackReference;
    return speed_mm_s > limit ? limit : speed_mm_s;
  }

 private:
  int limit_mm_s_ = kMaxWheelSpeed;
};

template <typename T>
inline constexpr bool is_pair = false;

template <int kCapacity>
struct Buffer {
  int size = kCapacity;
};

}  // namespace cargobay::oi
CODE

tidy() { "$clang_tidy" --quiet "$@" -- -std=c++20 -I"$scratch" -Ihal/c 2>&1; }

# 1. The planted names are reported, each by its kind; in a header too.
if report=$(tidy "$scratch/oi/planted.cpp"); then fail "clang-tidy accepts the planted file"; fi
expect() {
  grep -qF "$1" <<< "$report" || fail "clang-tidy does not report: $1"
}
expect "invalid case style for struct 'misnamed_type'"
expect "invalid case style for enum 'misnamed_enum'"
expect "invalid case style for enum constant 'BadEnumerator'"
expect "invalid case style for type alias 'misnamed_alias'"
expect "invalid case style for global constant 'unprefixed_constant'"
expect "invalid case style for function 'MisnamedFunction'"
expect "invalid case style for parameter 'BadParameter'"
expect "invalid case style for local constant 'BadLocal'"
expect "invalid case style for local variable 'BadVariable'"
expect "invalid case style for public member 'PublicMember'"
expect "invalid case style for private member 'withoutTrailing'"
expect "invalid case style for namespace 'BadNamespace'"
expect "invalid case style for macro definition 'UNPREFIXED_MACRO'"
expect "invalid case style for template parameter 'bad_template_parameter'"
expect "invalid case style for value template parameter 'bad_value_parameter'"
expect "[modernize-use-nullptr,-warnings-as-errors]"
expect "[readability-identifier-naming,-warnings-as-errors]"

# Through a unity source too, as for most files (tests/lint.sh, tidy_one).
mkdir -p "$scratch/build/Unity"
printf '#include "%s"\n' "$scratch/oi/planted.cpp" > "$scratch/build/Unity/unity_0.cxx"
if report=$(tidy "$scratch/build/Unity/unity_0.cxx" \
  --checks=-bugprone-suspicious-include,-google-global-names-in-headers); then
  fail "clang-tidy accepts the planted file in a unity source"
fi
expect "planted.cpp:"
expect "planted.hpp:"
expect "invalid case style for function 'MisnamedFunction'"
expect "[modernize-use-nullptr,-warnings-as-errors]"
expect "[misc-use-internal-linkage,-warnings-as-errors]"

# 2. Good names are accepted.
report=$(tidy "$scratch/oi/good.cpp") || fail "clang-tidy rejects the good file: $report"

# 3. Every check and option named in the configuration exists, and a misspelt one is noticed.
for config in .clang-tidy tests/.clang-tidy examples/.clang-tidy; do
  report=$("$clang_tidy" --verify-config --config-file="$config" 2>&1) || fail "$config: $report"
done
misspell() {
  sed "$1" .clang-tidy > "$scratch/bad/config"
  cmp -s .clang-tidy "$scratch/bad/config" && fail "the misspelling $1 changed nothing"
  if "$clang_tidy" --verify-config --config-file="$scratch/bad/config" > /dev/null 2>&1; then
    fail "clang-tidy accepts the misspelling $1"
  fi
}
misspell 's/misc-static-assert/misc-statc-assert/'
misspell 's/readability-identifier-naming,/readability-identifer-naming,/'
misspell 's/performance-\*/perfromance-*/'
misspell 's/naming\.EnumConstantCase/naming.EnumConstanCase/'
misspell "s/naming\.LocalVariableIgnoredRegexp/naming.LocalVariableIgnoreRegexp/"

# 4. The checks are on in the folders of the sources, tests included.
for folder in oi tests; do
  "$clang_tidy" --list-checks "$scratch/$folder/planted.cpp" -- > "$scratch/checks" 2>&1 || true
  grep -q 'readability-identifier-naming$' "$scratch/checks" || fail "no naming check in $folder"
done

# 5. The analyzer finds what an example does after calls into cargobay.hpp.
mkdir -p "$scratch/examples"
cp examples/.clang-tidy "$scratch/examples/"
cat > "$scratch/examples/planted.cpp" << 'CODE'
#include <cargobay.hpp>

int main(int count, char** /*arguments*/) {
  auto robot = cargobay::Robot::open({});
  if (!robot || !robot->start()) return 1;
  int* place = nullptr;
  if (count > 2) place = &count;
  *place = 3;
  const int* leak = new int{count};
  return *leak;
}
CODE
if report=$(tidy "$scratch/examples/planted.cpp"); then fail "clang-tidy accepts the example"; fi
expect "[clang-analyzer-core.NullDereference,-warnings-as-errors]"
expect "[clang-analyzer-cplusplus.NewDeleteLeaks,-warnings-as-errors]"

# 6. clang-format too.
printf 'int  badly_laid_out( ) ;\n' > "$scratch/oi/layout.cpp"
if "$clang_format" --dry-run -Werror "$scratch/oi/layout.cpp" > /dev/null 2>&1; then
  fail "clang-format accepts a bad layout"
fi
"$clang_format" --dry-run -Werror "$scratch/oi/good.cpp" || fail "clang-format rejects the good file"

# 7. So is each turn of phrase that is not to come back.
eval "$(grep '^odd_phrases=' tests/lint.sh)"
for sentence in 'the so manieth frame' 'it is not to be had' 'it begins anew' 'this tells of that' \
  'it stands in for that' 'nothing where there is none' 'the wheels roll on'; do
  grep -qwE "$odd_phrases" <<< "$sentence" || fail "lint.sh does not mind: $sentence"
done
! grep -qwE "$odd_phrases" <<< 'every Nth frame is reported again' || fail "lint.sh minds plain words"

# 8. So is a comment or a page that nobody broke into lines.
eval "$(grep -E '^long_(comment|line)=' tests/lint.sh)"
long=$(printf 'word %.0s' {1..25})
[[ -n $(awk "$long_comment" <<< "  // $long") ]] || fail "lint.sh does not mind a long comment"
[[ -z $(awk "$long_comment" <<< "constexpr int k = 0;  // $long") ]] || fail "lint.sh minds a long row"
[[ -n $(awk "$long_line" <<< "$long") ]] || fail "lint.sh does not mind a long line of a page"
[[ -z $(awk "$long_line" <<< "| $long |") ]] || fail "lint.sh minds a long row of a table"

if ((failures)); then
  echo "$failures failures"
  exit 1
fi
echo "every planted violation is reported"
