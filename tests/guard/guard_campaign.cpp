// guard_campaign [--deaths N] [--way kill|segv|abort|stop|endless]... [--lanes N] [--judge MS]
//
// Lets programs that drive a virtual Create over a pseudo-terminal die, each at a random moment,
// and checks that their guards stop the robots. Fails if one keeps rolling, is not made Passive, or
// is commanded again. Prints how long it took, from the death to the last byte of the stop at the
// robot; this is only judged if --judge gives the limit for the p99, on top of the deadline for
// programs that hang.
#include <sys/prctl.h>
#include <sys/wait.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "oi/stream_budget.hpp"
#include "rt/histogram.hpp"
#include "tests/guard/death.hpp"

namespace cargobay::test {
namespace {

constexpr rt::Duration kDeadline = std::chrono::milliseconds{150};  // the default

struct Plan {
  int deaths = 50;
  std::vector<Way> ways{};
  int lanes = 2;
  std::optional<double> judge_ms{};
};

struct Result {
  int died = 0;
  int failed = 0;
  rt::Histogram to_stop_ns{};
};

void tell(Way way, const Death& death) {
  std::fprintf(stderr, "%s: %s%s%s%s\n", std::string{name(way)}.c_str(),
               death.drove ? "" : "did not drive; ", death.stopped ? "" : "not stopped; ",
               death.passive ? "" : "not Passive; ", death.quiet ? "" : "commanded again");
}

void run_lane(Way way, int seed, std::atomic<int>& left, std::mutex& mutex, Result& result) {
  const auto bed = DeathBed::make(static_cast<std::uint64_t>(seed), kDeadline);
  while (left.fetch_sub(1) > 0) {
    const Death death = bed ? bed->let_die(way) : Death{};
    const std::lock_guard lock{mutex};
    ++result.died;
    if (death.drove && death.stopped && death.passive && death.quiet) {
      result.to_stop_ns.record(static_cast<std::uint64_t>(death.to_stop.count()));
    } else {
      tell(way, death);
      ++result.failed;
    }
  }
}

bool run_way(Way way, const Plan& plan) {
  Result result;
  std::mutex mutex;
  std::atomic<int> left{plan.deaths};
  std::vector<std::thread> lanes;
  // A spinning program takes up a processor; the kernel needs another to pass on the bytes of a
  // pseudo-terminal.
  const int count = way == Way::endless ? 1 : plan.lanes;
  lanes.reserve(static_cast<std::size_t>(count));
  for (int lane = 0; lane < count; ++lane) {
    lanes.emplace_back([&, lane] { run_lane(way, lane, left, mutex, result); });
  }
  for (std::thread& lane : lanes) lane.join();
  while (waitpid(-1, nullptr, WNOHANG) > 0) {  // guards whose owners have died
  }
  const auto ms = [&result](double percent) {
    return static_cast<double>(result.to_stop_ns.percentile(percent)) / 1e6;
  };
  std::printf("| %-7s | %6d | %7d | %8.2f | %8.2f | %8.2f |\n", std::string{name(way)}.c_str(),
              result.died, result.died - result.failed, ms(50), ms(99), ms(100));
  std::fflush(stdout);
  const double allowed_ms =
      plan.judge_ms.value_or(1e9) + (is_hang(way) ? 1e3 * rt::seconds(kDeadline) : 0.0);
  return result.failed == 0 && ms(99) <= allowed_ms;
}

int usage() {
  std::fprintf(stderr,
               "usage: guard_campaign [--deaths N] [--way kill|segv|abort|stop|endless]... "
               "[--lanes N] [--judge MS]\n");
  return 2;
}

// 0 if the text is not a number: no option accepts 0.
template <typename Number>
Number number(const std::string& text) {
  Number value = 0;
  (void)std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

std::optional<Plan> parse(const std::vector<std::string>& words) {
  Plan plan;
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    const std::string& value = words[i + 1];
    if (words[i] == "--deaths") {
      plan.deaths = number<int>(value);
    } else if (words[i] == "--lanes") {
      plan.lanes = number<int>(value);
    } else if (words[i] == "--judge") {
      plan.judge_ms = number<double>(value);
    } else if (const auto way = find_way(value); words[i] == "--way" && way) {
      plan.ways.push_back(*way);
    } else {
      return std::nullopt;
    }
  }
  if (plan.ways.empty()) plan.ways.assign(kWays.begin(), kWays.end());
  const bool sensible = words.size() % 2 == 0 && plan.deaths > 0 && plan.lanes > 0;
  return sensible ? std::optional{plan} : std::nullopt;
}

int run(const std::vector<std::string>& words) {
  if (words.size() == 5 && words[0] == "--victim") {
    return be_victim(find_way(words[1]).value_or(Way::kill), words[2], number<int>(words[3]),
                     rt::Duration{number<std::int64_t>(words[4])});
  }
  const auto plan = parse(words);
  if (!plan) return usage();
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  const double wire_ms =
      1e3 * rt::seconds(oi::wire_time(oi::kDriveDirectBytes, oi::kCreate.default_baud));
  std::printf("from death to the stop's last byte, of which the wire takes %.2f ms\n\n", wire_ms);
  std::printf(
      "| death   | robots | stopped | p50, ms  | p99, ms  | max, ms  "
      "|\n|---|---|---|---|---|---|\n");
  bool all = true;
  for (const Way way : plan->ways) all = run_way(way, *plan) && all;
  return all ? 0 : 1;
}

}  // namespace
}  // namespace cargobay::test

int main(int argc, char** argv) { return cargobay::test::run({argv + 1, argv + argc}); }
