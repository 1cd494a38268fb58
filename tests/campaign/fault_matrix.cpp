// fault_matrix [--seeds N] [--fault NAME] [--seed N]: every named fault of the virtual Create
// during every profile, over N seeds (20 by default), in virtual time. Prints the table of
// docs/reliability.md. Anything that does not hold goes to standard error, and the exit status is
// 1. --fault and --seed repeat one row, or one drive of it.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>

#include "tests/campaign/fault_case.hpp"
#include "tests/campaign/faulted_drive.hpp"
#include "tests/campaign/number.hpp"
#include "tests/campaign/verdict.hpp"

namespace cargobay::campaign {
namespace {

struct Options {
  std::uint64_t first_seed = 1;
  std::uint64_t seeds = 20;
  std::string_view fault{};  // empty: all
};

constexpr std::array<std::string_view, 4> kProfiles{"straight", "steps", "square", "spin"};

struct Row {
  std::uint64_t drives = 0;
  std::uint64_t ended = 0;    // by the fault; each robot was brought up and driven again
  std::uint64_t toggled = 0;  // of these: only the power toggle helped
  std::uint64_t deaf = 0;     // drives after which the robot did not obey
  std::uint64_t due = 0;
  std::uint64_t unsent = 0;
  hal::FrameCounters frames{};
  int back_after = 0;   // the maximum
  int waited = 0;       // the maximum
  int obeys_after = 0;  // the maximum
  std::array<double, kProfiles.size()> worst_error_mm_s{};
  std::uint64_t impostors = 0;
  std::uint64_t misled = 0;  // drives in which such a frame made something not hold
  std::uint64_t failed = 0;  // drives in which something else failed
};

std::optional<Options> parse(int count, char** words) {
  Options options;
  for (int i = 1; i < count; i += 2) {
    if (i + 1 == count) return std::nullopt;
    const std::string_view option{words[i]};
    const std::string_view value{words[i + 1]};
    if (option == "--fault") {
      options.fault = value;
      continue;
    }
    const auto wanted = number(value);
    if (!wanted || (option != "--seeds" && option != "--seed")) return std::nullopt;
    options.seeds = option == "--seeds" ? *wanted : 1;
    if (option == "--seed") options.first_seed = *wanted;
  }
  return options;
}

DriveCase drive_case(std::size_t row, std::size_t profile, const cli::Profile& driven,
                     std::uint64_t seed) {
  return {.fault = kFaultCases[row],
          .profile = &driven,
          .remainder = seed % 2 == 0 ? hal::sim::Remainder::carried : hal::sim::Remainder::lost,
          .seed = seed * 1000 + row * kProfiles.size() + profile};  // different for each drive
}

void report(const FaultCase& fault, std::string_view profile, std::uint64_t seed,
            const Verdict& verdict) {
  for (const std::string& violation : verdict.violations) {
    std::fprintf(stderr, "%s: --fault '%s' --seed %llu, %s: %s\n",
                 verdict.impostors > 0 ? "misled" : "failed", std::string{fault.name}.c_str(),
                 static_cast<unsigned long long>(seed), std::string{profile}.c_str(),
                 violation.c_str());
  }
}

void add(Row& row, std::size_t profile, const Observations& seen, const Verdict& verdict) {
  ++row.drives;
  if (seen.restarted) ++row.ended;
  if (seen.toggled) ++row.toggled;
  if (verdict.deaf) ++row.deaf;
  row.due += verdict.due;
  row.unsent += verdict.unsent;
  row.frames.good += seen.frames.good;
  row.frames.bad += seen.frames.bad;
  row.frames.lost += seen.frames.lost;
  row.impostors += verdict.impostors;
  if (!verdict.violations.empty()) ++(verdict.impostors > 0 ? row.misled : row.failed);
  if (verdict.impostors > 0) return;
  row.back_after = std::max(row.back_after, verdict.back_after);
  row.waited = std::max(row.waited, verdict.waited);
  row.obeys_after = std::max(row.obeys_after, verdict.obeys_after);
  row.worst_error_mm_s[profile] = std::max(row.worst_error_mm_s[profile], verdict.worst_error_mm_s);
}

Row run_row(std::size_t number, const Options& options) {
  const FaultCase& fault = kFaultCases[number];
  Row row;
  for (std::size_t profile = 0; profile < kProfiles.size(); ++profile) {
    for (std::uint64_t i = 0; i < options.seeds; ++i) {
      const std::uint64_t seed = options.first_seed + i;
      const double speed_mm_s = 100.0 + 25.0 * static_cast<double>(seed % 9);
      const auto driven = cli::Profile::load(std::string{kProfiles[profile]}, speed_mm_s);
      const Observations seen = drive(drive_case(number, profile, *driven, seed));
      const Verdict verdict = judge(fault, seen);
      report(fault, kProfiles[profile], seed, verdict);
      add(row, profile, seen, verdict);
    }
  }
  return row;
}

void print_head() {
  std::printf(
      "| fault | drives | ended | deaf | ticks | no frame sent | good | bad | lost | back after | "
      "waited | obeys after | straight | steps | square | spin | impostors | failed |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

// A count, and in parentheses how many of them are special; nothing if none are.
std::string counted(std::uint64_t count, std::uint64_t special) {
  if (count == 0) return {};
  return std::to_string(count) + (special > 0 ? " (" + std::to_string(special) + ")" : "");
}

void print(const FaultCase& fault, const Row& row) {
  const auto number = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
  std::printf("| `%s`%s | %llu | %s | %s | %llu | %s | %llu | %s | %s |",
              std::string{fault.begin}.c_str(), std::string{fault.lasts}.c_str(),
              number(row.drives), counted(row.ended, row.toggled).c_str(),
              counted(row.deaf, 0).c_str(), number(row.due), counted(row.unsent, 0).c_str(),
              number(row.frames.good), counted(row.frames.bad, 0).c_str(),
              counted(row.frames.lost, 0).c_str());
  for (const int after : {row.back_after, row.waited, row.obeys_after})
    std::printf(" %s |", counted(static_cast<std::uint64_t>(after), 0).c_str());
  for (const double error_mm_s : row.worst_error_mm_s) std::printf(" %.0f |", error_mm_s);
  std::printf(" %s | %s |\n", counted(row.impostors, row.misled).c_str(),
              counted(row.failed, 0).c_str());
  std::fflush(stdout);
}

// The number of drives in which something did not hold.
std::uint64_t run(const Options& options) {
  std::uint64_t failed = 0;
  print_head();
  for (std::size_t number = 0; number < kFaultCases.size(); ++number) {
    if (!options.fault.empty() && kFaultCases[number].name != options.fault) continue;
    const Row row = run_row(number, options);
    print(kFaultCases[number], row);
    failed += row.failed;
  }
  return failed;
}

}  // namespace
}  // namespace cargobay::campaign

int main(int argc, char** argv) {
  const auto options = cargobay::campaign::parse(argc, argv);
  if (!options) {
    std::fprintf(stderr, "usage: fault_matrix [--seeds N] [--fault NAME] [--seed N]\n");
    return 2;
  }
  if (!cargobay::campaign::all_named_faults_are_in()) {
    std::fprintf(stderr, "a fault of the virtual Create has no case in fault_case.hpp\n");
    return 1;
  }
  const std::uint64_t failed = cargobay::campaign::run(*options);
  if (failed > 0) {
    std::fprintf(stderr, "%llu drives failed\n", static_cast<unsigned long long>(failed));
  }
  return failed == 0 ? 0 : 1;
}
