// What on this machine spoils real time or the link to the robot, each with its remedy. Only looks:
// changes nothing.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "rt/realtime.hpp"

namespace cargobay::hal {

struct Finding {
  enum class Verdict : std::uint8_t {
    good,
    advice,  // works, but could do better
    bad,     // the loop or the link will suffer
  };
  std::string_view check{};  // a word for scripts: "kernel", "governor"
  Verdict verdict = Verdict::good;
  std::string what{};
  std::string remedy{};  // empty if all is well
};

struct Examination {
  std::string port{};                    // empty: no port is examined
  int priority = 80;                     // SCHED_FIFO, of the loop
  rt::RealtimeGrant grant{};             // what the kernel granted when asked
  rt::Rights rights = rt::own_rights();  // of the thread that asked
  std::string root{};                    // put in front of /proc and /sys; for tests
};

// Reads some hundred files of /proc and /sys: blocks for as long as that takes; allocates.
std::vector<Finding> examine(const Examination& examination);

std::string_view name(Finding::Verdict verdict);
bool all_well(const std::vector<Finding>& findings);  // none is bad

}  // namespace cargobay::hal
