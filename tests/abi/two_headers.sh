#!/usr/bin/env bash
# One program may be linked from objects that were compiled against different versions of
# cargobay.hpp: each works with its own structs. Without the inline namespace that tells the
# versions apart it would fail, which is shown too.
# usage: tests/abi/two_headers.sh LIBRARY
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
library=$(realpath "${1:?usage: tests/abi/two_headers.sh LIBRARY}")
compiler=${CXX:-c++}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0
complain() { echo "two_headers.sh: $*" >&2; failed=1; }

# later FOLDER NAMESPACE: the headers of a later version, in which each struct that grows is larger.
later() {
  mkdir "$work/$1"
  awk '
    /^struct cargobay_[a-z_]+ [{]$/ { inside = 1; grows = 0 }
    inside && /^  uint32_t size;/ { grows = 1 }
    inside && /^[}];$/ && grows { print "  uint64_t of_a_later_version[4];"; ++count }
    /^[}];$/ { inside = 0 }
    /define CARGOBAY_VERSION_MINOR/ { $3 = $3 + 1 }
    { print }
    END { if (count < 9) { print "found hardly a struct that grows" > "/dev/stderr"; exit 1 } }
  ' hal/c/cargobay.h > "$work/$1/cargobay.h"
  # Those of C++ are their twins. Note, Reading, Twist and Wheels never change.
  awk -v namespace="$2" '
    /^\/\/ (Like )?struct cargobay_/ { twin = !/_(note|reading|twist|wheels)\./ }
    /^struct [A-Za-z]+ [{]$/ { inside = twin; twin = 0 }
    inside && /^[}];$/ { print "  std::uint64_t of_a_later_version[4] = {};"; ++count; inside = 0 }
    /CARGOBAY_VERSION_MINOR == / { sub(/MINOR == [0-9]+/, "MINOR == CARGOBAY_VERSION_MINOR") }
    { gsub(/v[0-9]+_[0-9]+/, namespace); print }
    END { if (count < 9) { print "found hardly a struct that grows" > "/dev/stderr"; exit 1 } }
  ' hal/c/cargobay.hpp > "$work/$1/cargobay.hpp"
}
now=$(grep -oE '^inline namespace v[0-9]+_[0-9]+' hal/c/cargobay.hpp | cut -d' ' -f3)
later later v999_1
later planted "$now"

cat > "$work/part.cpp" << 'END'
#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <vector>

#include <cargobay.hpp>

using namespace std::chrono_literals;

// Whether the templates that work on these structs know how long they are.
template <typename T>
static bool strides(const std::vector<T>& values) {
  const auto* const first = reinterpret_cast<const char*>(&values.at(0));
  return reinterpret_cast<const char*>(&values.at(1)) - first == sizeof(T) &&
         reinterpret_cast<const char*>(&values.back()) - first ==
             static_cast<std::ptrdiff_t>((values.size() - 1) * sizeof(T));
}

static bool holds(bool what, const char* words) {
  if (!what) std::printf("%s: not so: %s\n", PART_NAME, words);
  return what;
}

static cargobay::Expected<std::vector<cargobay::State>> drive(cargobay::Robot& robot) {
  std::vector<cargobay::State> kept;
  auto states = robot.states(1s);
  for (const cargobay::State& state : states) {
    kept.push_back(state);
    if (auto set = robot.drive(200.0, 0.0); !set) return cargobay::Unexpected{set.error()};
    if (kept.size() == 100) return kept;
  }
  return cargobay::Unexpected{states.outcome().error()};
}

// Each state is as it was in its frame, and what is new in the later version is 0.
static bool whole(const std::vector<cargobay::State>& states) {
  std::int64_t tick = states.front().tick;
  for (const cargobay::State& state : states) {
    if (state.tick != tick++ || state.robot_time != state.tick * 15ms) return false;
    if (state.mode != cargobay::Mode::safe || state.arrival <= 0ns) return false;
#ifdef LATER
    if (std::ranges::count(state.of_a_later_version, 0U) != 4) return false;
#endif
  }
  return states.back().x_mm > 100.0;
}

extern "C" int PART() {
  auto sim = cargobay::Sim::open({.time = cargobay::SimTime::virtual_time});
  if (!holds(sim.has_value(), "the virtual Create opens")) return 1;
  auto robot = cargobay::Robot::open({.sim = &*sim});
  if (!holds(robot && robot->start(), "the robot starts")) return 1;
  auto driven = drive(*robot);
  if (!holds(driven.has_value(), "it drives")) return 1;
  std::vector<cargobay::State> states = *std::move(driven);
  bool good = holds(strides(states) && whole(states), "a vector of states");
  std::ranges::sort(states, std::greater{}, &cargobay::State::tick);
  std::ranges::reverse(states);
  std::map<std::int64_t, cargobay::State> by_tick;
  for (const cargobay::State& state : states) by_tick[state.tick] = state;
  good &= holds(whole(states) && by_tick.rbegin()->second.x_mm == states.back().x_mm, "sorted");

  std::vector<cargobay::State> past(100);
  const auto count = robot->history(states.front().tick - 1, past);
  good &= holds(count && *count == 100 && strides(past) && whole(past), "their history");

  const auto set = robot->set_control([&](const cargobay::State& state) {
    states.push_back(state);
    return cargobay::Twist{50.0, 0.5};
  });
  good &= holds(set && sim->inject("bump left"), "it is set");
  while (states.size() < 110 && robot->wait(states.back().tick, 1s)) continue;
  good &= holds(strides(states) && whole(states), "a control function");

  const std::optional<cargobay::Event> event = robot->next_event(0);
  const std::vector<cargobay::Event> events(3, event.value_or(cargobay::Event{}));
  good &= holds(event && strides(events) && events.at(2).bumps == cargobay::Bump::left, "an event");
  good &= holds(robot->end() && robot->end_report()->passive_seen, "the end");
  return good ? 0 : 1;
}
END
cat > "$work/main.cpp" << 'END'
extern "C" int first();
extern "C" int second();
int main() { return first() + second(); }
END
$compiler -std=c++20 -c -o "$work/main.o" "$work/main.cpp"

# compiled HEADERS NAME LEVEL FLAG...: the object NAME-LEVEL.o, whose function is called NAME.
compiled() {
  $compiler -std=c++20 "-O$3" -I "$1" "-DPART=$2" "-DPART_NAME=\"$2\"" "${@:4}" -c \
    -o "$work/$2-$3.o" "$work/part.cpp"
}
# linked OBJECT...: makes $work/program of both parts.
linked() { $compiler -o "$work/program" "$work/main.o" "$@" "$library"; }
runs() { env LD_LIBRARY_PATH="$(dirname "$library")" "$work/program"; }

grows=$(awk '/^struct cargobay_[a-z_]+ [{]$/ { name = $2 }
  /^  uint32_t size;/ { print name }' hal/c/cargobay.h | paste -sd'|')
weak() { nm -C "$1" | awk '$2 ~ /^[WVu]$/' | cut -c20- | sort -u; }
for level in 0 2; do
  compiled hal/c first "$level" &
  compiled "$work/later" second "$level" -DLATER
  wait $!
  for order in "first second" "second first"; do
    read -r one other <<< "$order"
    linked "$work/$one-$level.o" "$work/$other-$level.o"
    runs || complain "-O$level, $order"
  done
  # What both objects define is merged: nothing of ours that grows may be part of it.
  merged=$(comm -12 <(weak "$work/first-$level.o") <(weak "$work/second-$level.o"))
  if grep -E "cargobay::|\b($grows)\b" <<< "$merged"; then complain "-O$level merges this"; fi
  [[ $level != 0 || $(wc -l <<< "$merged") -gt 50 ]] || complain "found hardly anything merged"
done

# Not inlined, so that templates are merged for sure.
compiled "$work/planted" second 0 -DLATER
for order in "first second" "second first"; do
  read -r one other <<< "$order"
  linked "$work/$one-0.o" "$work/$other-0.o"
  # In a shell of its own, which would report how it dies.
  if (runs) > "$work/says" 2>&1; then
    complain "without a namespace of its own it works all the same: $order"
  fi
done

# A state does not pass from one version to the other: that does not link.
printf '#include <cargobay.hpp>\n%s\n%s\n' 'void take(const cargobay::State&) {}' \
  'extern "C" int first() { return 0; }' > "$work/takes.cpp"
printf '#include <cargobay.hpp>\n%s\n%s\n' 'void take(const cargobay::State&);' \
  'extern "C" int second() { take({}); return 0; }' > "$work/gives.cpp"
$compiler -std=c++20 -I hal/c -c -o "$work/takes.o" "$work/takes.cpp"
$compiler -std=c++20 -I hal/c -c -o "$work/gives.o" "$work/gives.cpp"
linked "$work/takes.o" "$work/gives.o" || complain "a state does not pass within one version"
$compiler -std=c++20 -I "$work/later" -c -o "$work/gives.o" "$work/gives.cpp"
if linked "$work/takes.o" "$work/gives.o" 2> "$work/says"; then
  complain "a state passes from one version to the other"
fi
grep -q "undefined reference to .take(cargobay" "$work/says" || complain "it fails otherwise"
((!failed)) || exit 1
echo "two versions of cargobay.hpp in one program: each works"
