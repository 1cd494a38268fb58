#include "tests/conformance/rows.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string_view>

#include <gtest/gtest.h>

namespace cargobay::conformance {
namespace {

// The strings in a line `key = "..."` or `key = ["...", "..."]`.
std::vector<std::string> strings_in(std::string_view line) {
  std::vector<std::string> strings;
  bool inside = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') {
      if (!inside) strings.emplace_back();
      inside = !inside;
    } else if (inside) {
      if (line[i] == '\\' && i + 1 < line.size()) ++i;
      strings.back() += line[i];
    }
  }
  return strings;
}

// Whether a test ran, and how; nullptr if it did not.
const testing::TestResult* result_of(const std::string& name) {
  const testing::UnitTest& all = *testing::UnitTest::GetInstance();
  for (int i = 0; i < all.total_test_suite_count(); ++i) {
    const testing::TestSuite& suite = *all.GetTestSuite(i);
    for (int j = 0; j < suite.total_test_count(); ++j) {
      const testing::TestInfo& test = *suite.GetTestInfo(j);
      if (test.should_run() && name == std::string{suite.name()} + "." + test.name()) {
        return test.result();
      }
    }
  }
  return nullptr;
}

bool is_about_the_robot(const Row& row) { return row.side == "robot" || row.side == "both"; }

const char* name(Verdict verdict) {
  switch (verdict) {
    case Verdict::holds: return "holds";
    case Verdict::fails: return "FAILS";
    case Verdict::not_judged: return "not judged";
  }
  return "";
}

}  // namespace

std::vector<Row> read_rows(const std::string& path) {
  std::vector<Row> rows;
  std::ifstream file{path};
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("[p")) {
      rows.push_back({.id = line.substr(1, line.find(']') - 1)});
      continue;
    }
    const std::vector<std::string> strings = strings_in(line);
    if (rows.empty() || strings.empty()) continue;
    if (line.starts_with("side = ")) rows.back().side = strings.front();
    if (line.starts_with("text = ")) rows.back().text = strings.front();
    if (line.starts_with("tests = ")) rows.back().tests = strings;
  }
  return rows;
}

Verdict verdict(const Row& row) {
  Verdict so_far = Verdict::not_judged;
  for (const std::string& test : row.tests) {
    const testing::TestResult* result = result_of(test);
    if (result == nullptr || result->Skipped()) continue;
    if (result->Failed()) return Verdict::fails;
    so_far = Verdict::holds;
  }
  return so_far;
}

void print_rows(const std::vector<Row>& rows, bool each) {
  int holds = 0;
  int fails = 0;
  int not_judged = 0;
  for (const Row& row : rows) {
    if (!is_about_the_robot(row)) continue;
    const Verdict found = verdict(row);
    if (found == Verdict::holds) ++holds;
    if (found == Verdict::fails) ++fails;
    if (found == Verdict::not_judged) ++not_judged;
    if (each || found == Verdict::fails) {
      std::printf("%-7s %-10s %s\n", row.id.c_str(), name(found), row.text.c_str());
    }
  }
  std::printf(
      "Of %d statements about the robot (docs/conformance.md) %d were judged: %d hold, %d fail. "
      "%d cannot be judged over the serial line, or their tests did not run.\n",
      holds + fails + not_judged, holds + fails, holds, fails, not_judged);
}

}  // namespace cargobay::conformance
