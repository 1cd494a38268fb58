#!/usr/bin/env bash
# Installs what is missing, builds, and runs the tests; asks nothing, can be run again.
# usage: tests/run.sh [--quick]
#   --quick  the tests in virtual time, built alone, and the layout check: four minutes from nothing
# Without it: clang-tidy, the sanitizers for addresses, undefined behaviour, threads and real time,
# fuzzing (half a minute a target; CARGOBAY_FUZZ_SECONDS), the pages of the C API, the Debian packages for
# two architectures, and their use on a fresh Debian and on an emulated Raspberry Pi too. Logs are in
# build/log.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/.."

quick=0
for argument in "$@"; do
  case $argument in
    --quick) quick=1 ;;
    *)
      sed -n '2,8s/^# \{0,1\}//p' "$0" >&2
      exit 2
      ;;
  esac
done

jobs=$(nproc)
logs=$PWD/build/log
mkdir -p "$logs"
passed=0 failed=0 skipped=0
# The sanitizers name lines only if they find llvm-symbolizer.
PATH=$PATH:/usr/lib/llvm-22/bin

# processor: sets `used` to the seconds of processor time that this shell's children took so far.
hertz=$(getconf CLK_TCK)
processor() {
  local fields
  read -ra fields < "/proc/$BASHPID/stat"
  used=$(((fields[15] + fields[16]) / hertz))
}

# report NAME STATUS SECONDS PROCESSOR TEXT: the one line of a stage; if it failed, the tail of its
# log without ctest's lines about tests that passed. Status 77: a tool that it needs is missing.
report() {
  local verdict=ok
  (($2 == 0)) || verdict=FAILED
  (($2 != 77)) || verdict=skipped
  printf '%-22s %-7s %4d s, processor %4d s  %s\n' "$1" "$verdict" "$3" "$4" "$5"
  (($2 == 0)) || grep -avE '^ +Start +[0-9]+: | Passed +[0-9.]+ sec$' "$logs/$1.log" |
    tail -n 40 | sed 's/^/    /' || true
}

# count NAME STATUS SECONDS PROCESSOR: as one check.
count() {
  case $2 in
    0) passed=$((passed + 1)) ;;
    77) skipped=$((skipped + 1)) ;;
    *) failed=$((failed + 1)) ;;
  esac
  report "$@" ""
  return "$2"
}

# stage NAME COMMAND...: now.
stage() {
  local name=$1 begin=$SECONDS status=0 used before
  shift
  processor
  before=$used
  "$@" > "$logs/$name.log" 2>&1 < /dev/null || status=$?
  processor
  count "$name" "$status" $((SECONDS - begin)) $((used - before))
}

# background NAME COMMAND...: runs it, and leaves the result for await.
background() {
  local name=$1 begin=$SECONDS status=0 used before
  shift
  processor
  before=$used
  "$@" > "$logs/$name.log" 2>&1 < /dev/null || status=$?
  processor
  echo "$status $((SECONDS - begin)) $((used - before))" > "$logs/$name.status.new"
  mv "$logs/$name.status.new" "$logs/$name.status"
}

# in_background COMMAND...: the builder from now on. It gets the processor time that others leave, and
# is a process group of its own, so that it can be ended as a whole.
in_background() {
  set -m
  (chrt --idle --pid 0 $BASHPID; "$@") &
  builder=$!
  set +m
}

# await NAME: waits until the builder has done it, and counts it.
await() {
  local status seconds used
  while [[ ! -e $logs/$1.status ]] && kill -0 "$builder" 2> /dev/null; do sleep 0.5; done
  # No status, and nothing left that could write one: the builder died.
  read -r status seconds used 2> /dev/null < "$logs/$1.status" || status=1 seconds=0 used=0
  count "$1" "$status" "$seconds" "$used"
}

# tests PRESET CTEST-ARGUMENT...: counts every test.
tests() {
  local preset=$1 begin=$SECONDS status=0 junit head total bad idle used before
  shift
  processor
  before=$used
  local name=$preset-tests
  junit=$logs/$name.xml
  rm -f "$junit"
  # Most wait for a robot, and one that computes counts as two. Beside compilers, programs of real
  # time fail if there are more of them than processors; afterwards, twice as many run.
  local parallel=$jobs
  kill -0 "${builder:-0}" 2> /dev/null || parallel=$((2 * jobs))
  ctest --preset "$preset" -j "$parallel" --output-junit "$junit" --test-output-size-passed 100000 "$@" \
    > "$logs/$name.log" 2>&1 < /dev/null || status=$?
  head=$(tr '\n' ' ' < "$junit" 2> /dev/null | grep -oE '<testsuite [^>]*>' | head -n 1) || head=''
  attribute() { sed -nE "s/.*[[:space:]]$1=\"([0-9]+)\".*/\1/p" <<< "$head"; }
  total=$(attribute tests) bad=$(attribute failures) idle=$(($(attribute skipped) + $(attribute disabled)))
  total=${total:-0} bad=${bad:-0}
  # A run without one test, or one that died, is a failure that nobody counted.
  ((total > 0)) || status=1
  if ((status != 0 && bad == 0)); then bad=1 total=$((total + 1)); fi
  passed=$((passed + total - bad - idle)) failed=$((failed + bad)) skipped=$((skipped + idle))
  processor
  report "$name" "$status" $((SECONDS - begin)) $((used - before)) \
    "$((total - bad - idle)) passed, $bad failed, $idle skipped"
  ((status == 0)) || said_by_failed "$logs/$name.log"
  grep -ahoE '^again: .*' "$junit" | sed -E 's/^again: (.*gtest_filter=)?/    again: /; s/ --gtest[^ :]*//g' || true
  ((idle == 0)) || grep -aE '\*\*\*(Skipped|Not Run)|^ *SKIPPED' "$logs/$name.log" | sort -u | sed 's/^/    /'
}

# said_by_failed LOG: of ctest, the last lines of each test that failed.
said_by_failed() {
  awk '
    function tell(  i) {
      for (i = count > 60 ? count - 60 : 0; i < count; ++i) print "    " said[i]
      count = 0
    }
    /^ +Start +[0-9]+: |^ *[0-9]+\/[0-9]+ Test +#|^[0-9]+% tests passed/ { tell(); failed = 0 }
    /\*\*\*(Failed|Timeout|Exception|Not Run)/ { failed = 1 }
    failed { said[count++] = $0 }
    END { tell() }' "$1"
}

# build PRESET [CMAKE-ARGUMENT...]
build() { cmake --preset "$@" && cmake --build --preset "$1" -j "$jobs"; }
build_quick() { cmake --preset dev && cmake --build --preset quick -j "$jobs"; }

# fuzz_one TARGET: for some seconds, from its corpus.
fuzz_one() {
  local name=${1##*/fuzz_}
  mkdir -p "build/fuzz/corpus/$name"
  local corpora=("build/fuzz/corpus/$name")
  [[ ! -d tests/fuzz/corpus/$name ]] || corpora+=("tests/fuzz/corpus/$name")
  echo "== $name"
  "$1" -max_total_time="${CARGOBAY_FUZZ_SECONDS:-30}" -artifact_prefix=build/fuzz/ \
    -print_final_stats=1 "${corpora[@]}" > "build/log/fuzz-$name.log" 2>&1 || {
    tail -n 40 "build/log/fuzz-$name.log"
    return 1
  }
  grep -E '^stat::number_of_executed_units|^Done' "build/log/fuzz-$name.log"
}

fuzz() {
  local targets=() source target
  for source in tests/fuzz/*.cpp; do
    target=build/asan/tests/fuzz_$(basename "$source" .cpp)
    [[ -x $target ]] || { echo "$target was not built"; return 1; }
    targets+=("$target")
  done
  export -f fuzz_one
  printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -n 1 bash -c 'fuzz_one "$1"' _
}

finish() {
  local text="$passed passed, $failed failed"
  ((skipped == 0)) || text+=", $skipped skipped"
  echo "$text"
  ((failed == 0))
}

if ((quick)); then
  stage install .ci/packages.sh quick || { finish; exit 1; }
  if stage quick-build build_quick; then tests quick; fi
  stage format tests/lint.sh --format || true
  finish
  exit
fi

native=$(dpkg --print-architecture)
here=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")

# pi SUITE [--build]: the emulated Pi with that Debian. With the one of this machine, it runs what is
# in the package, and tests that were built beside it.
pi() {
  local suite=$1 built=()
  shift
  [[ $suite != "$here" ]] || built=(--built build/package-arm64)
  tests/pi/bring_up_test.py "$suite" build/dev/cargobay build/pi ${built[@]+"${built[@]}"} "$@"
}

pi_build() {
  if [[ $1 == "$here" ]]; then
    cmake -D BUILD_TESTING=ON build/package-arm64 &&
      cmake --build build/package-arm64 -j "$jobs" --target test_gpio test_serial || return
  fi
  pi "$1" --build
}

# All that watches no clock, in the order in which the tests need it.
build_and_check() {
  local suite preset
  background dev-build build dev
  background package-arm64 .ci/package.sh arm64
  for suite in bookworm trixie; do background "pi-$suite-build" pi_build "$suite"; done
  for preset in asan tsan rtsan; do background "$preset-build" build "$preset"; done
  background "package-$native" .ci/package.sh "$native"
  # Whether it compiles for 32 bit; optimised, the same code has just been compiled for 64.
  background armhf-build build armhf -D CMAKE_CXX_FLAGS_RELEASE=-O0
  background lint tests/lint.sh
  background c-api docs/c-api.sh --check
}

stage install .ci/packages.sh test || { finish; exit 1; }
# The tests spend most of their time waiting for a robot. Meanwhile everything is built.
rm -f "$logs"/*.status
in_background build_and_check
trap 'kill -- -"$builder" 2> /dev/null || true' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

if await dev-build; then tests dev -LE '^pi$'; fi
# An emulated machine needs a processor for itself, and leaves the other to the builder.
for suite in bookworm trixie; do
  if await "pi-$suite-build"; then
    stage "pi-$suite" pi "$suite" || true
  fi
done
if await package-arm64; then
  stage package-pi tests/pi/package_test.py "$here" build/pi build/packages || true
fi
for preset in asan tsan rtsan; do
  if await "$preset-build"; then tests "$preset" -L '^(unit|sim|pty)(_slow)?$'; fi
done
as_root=()
(($(id -u) == 0)) || as_root=(sudo -n)
for name in "package-$native" armhf-build lint c-api; do await "$name" || true; done
# One computes, the other waits for the disk.
in_background background fuzz-run fuzz
stage package-use ${as_root[@]+"${as_root[@]}"} tests/install/package_test.sh build/packages || true
await fuzz-run || true
finish
