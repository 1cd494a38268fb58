// What a bring-up did, as lines for people and as JSON for programs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "hal/bring_up/bring_up.hpp"
#include "hal/result.hpp"

namespace cargobay::cli {

struct BringUpRecord {
  std::string port;
  std::string robot;  // what it is
  std::uint32_t baud = 0;
  std::vector<hal::BringUpEvent> steps{};
};

std::string line(const hal::BringUpEvent& event);
// The same without the time, for a line of progress: "bring-up: asking at 57600 baud".
std::string in_words(const hal::BringUpEvent& event);
std::string summary(const BringUpRecord& record, const hal::BringUpReport& report);
std::string json(const BringUpRecord& record, const hal::Result<hal::BringUpReport>& result);

}  // namespace cargobay::cli
