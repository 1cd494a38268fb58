// A virtual Create with a host at the other end of its line, in virtual time.
#pragma once

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"

namespace cargobay::hal::sim::test {

using Bytes = std::vector<std::uint8_t>;
inline std::string text(const Bytes& bytes) { return {bytes.begin(), bytes.end()}; }

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""us;
using std::chrono_literals::operator""ns;
using std::chrono_literals::operator""s;

// Wheels that do at once what they are told.
inline Parameters ideal_wheels() {
  Parameters parameters;
  parameters.wheels = {
      .lag_s = 1e-9, .gain_left = 1.0, .gain_right = 1.0, .dead_band_mm_s = 0.0, .noise_mm_s = 0.0};
  return parameters;
}
inline Parameters without_noise() {
  Parameters parameters;
  parameters.wheels.noise_mm_s = 0.0;
  return parameters;
}

struct Robot {
  explicit Robot(const Parameters& parameters = {}) : device{parameters}, link{device} {}

  // Sends, and lets the last byte arrive.
  void send(std::initializer_list<std::uint8_t> bytes) { send(Bytes{bytes}); }
  void send(const Bytes& bytes) {
    (void)link.write(bytes);      // 4096 bytes of room
    (void)link.drain(1s * 3600);  // as long as the slowest rate takes
  }
  void wait(rt::Duration period) { link.advance(period); }
  // What has arrived since the last call.
  Bytes receive() {
    Bytes bytes(Cable::kHostRoom);
    bytes.resize(link.read(bytes).count);
    return bytes;
  }
  // Sends and returns what comes back within 10 ms, in which no unexpected tick passes.
  Bytes ask(std::initializer_list<std::uint8_t> bytes) {
    (void)receive();
    send(bytes);
    wait(10ms);
    return receive();
  }
  void to_tick() { wait(device.until_next_event()); }

  Device device;
  VirtualLink link;
};

inline std::int16_t word(const Bytes& bytes, std::size_t at) {
  return static_cast<std::int16_t>(bytes.at(at) * 256 + bytes.at(at + 1));
}

}  // namespace cargobay::hal::sim::test
