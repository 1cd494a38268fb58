// Where the robots of one world are, for each other: round obstacles that move. Each says once a
// tick where it is, and meets the others where they were last. Safe to use from any thread: in real
// time each robot has one of its own.
#pragma once

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "hal/sim/inputs.hpp"
#include "hal/sim/pose.hpp"

namespace cargobay::hal::sim {

struct Body {
  WorldPose pose{};
  std::uint8_t infrared = kNoInfrared;  // the byte that it sends just now
};

class Bodies {
 public:
  // A number for a robot, the lowest that is free. It is met from its first tell() on. Allocates.
  std::size_t enter();
  void leave(std::size_t number);
  void tell(std::size_t number, const Body& body);
  // Replaces `others` by all robots but this one.
  void look(std::size_t number, std::vector<Body>& others) const;

 private:
  struct Place {
    bool taken = false;
    std::optional<Body> body{};
  };

  mutable std::mutex mutex_;
  std::vector<Place> places_{};  // by number
};

}  // namespace cargobay::hal::sim
