// What must hold for a drive of the fault matrix, and what is counted.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/campaign/faulted_drive.hpp"

namespace cargobay::campaign {

struct Verdict {
  std::vector<std::string> violations{};
  std::uint64_t due = 0;     // ticks of the robot from the cycle's first frame to its end
  std::uint64_t unsent = 0;  // of these: ticks without a frame
  bool deaf = false;   // at the end the robot still took commands for the data of a damaged one
  int back_after = 0;  // clean frames until the cycle has recovered; 0 if it did not drive on
  int waited = 0;      // ticks in which the robot took commands for the rest of another
  // Ticks after the fault, and after such a wait, until the robot obeys a command in each; 0 if it
  // did not drive on.
  int obeys_after = 0;
  double worst_error_mm_s = 0.0;  // of an estimate
  // Runs of bytes that the robot never sent as a frame, yet pass the checksum.
  std::uint64_t impostors = 0;
};

Verdict judge(const FaultCase& fault, const Observations& seen);

}  // namespace cargobay::campaign
