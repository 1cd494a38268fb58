// The table of the manual's statements (statements.toml), as far as this suite proves them.
#pragma once

#include <string>
#include <vector>

namespace cargobay::conformance {

struct Row {
  std::string id{};    // p7.1: page and number
  std::string side{};  // host, robot, both or wiring
  std::string text{};
  std::vector<std::string> tests{};
};

// The rows of that file, in order; empty if it cannot be read.
std::vector<Row> read_rows(const std::string& path);

enum class Verdict { holds, fails, not_judged };

// From those of its tests that ran in this program: fails if one failed.
Verdict verdict(const Row& row);

// Prints how many rows about the robot this run judged; with `each`, one line for each of them.
void print_rows(const std::vector<Row>& rows, bool each);

}  // namespace cargobay::conformance
