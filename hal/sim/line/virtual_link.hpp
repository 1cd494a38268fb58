// A byte stream to a virtual Create in virtual time: waiting makes time pass. The same code that
// drives a robot runs over it, faster than real time and the same every time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <system_error>

#include "hal/sim/line/cable.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class VirtualLink final : public ByteStream {
 public:
  // The device outlives the link. The host starts at the rate that the robot listens at.
  explicit VirtualLink(Device& device) : cable_{device} {}

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override;
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override;
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override;
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override;

  std::uint32_t baud() const override { return cable_.host_baud(); }
  [[nodiscard]] std::error_code set_baud(std::uint32_t baud) override;
  [[nodiscard]] std::error_code set_wake_threshold(std::size_t bytes) override;
  void discard_input() override { cable_.discard(); }
  [[nodiscard]] bool drain(rt::Duration timeout) override;
  void sleep(rt::Duration duration) override { advance(duration); }

  // Lets time pass without reading.
  void advance(rt::Duration period) { cable_.advance_to(cable_.now() + period); }
  // The other side goes away, for this link permanently.
  void hang_up() { hung_up_ = true; }
  Cable& cable() { return cable_; }

 private:
  Cable cable_;
  std::size_t wake_threshold_ = 1;
  bool hung_up_ = false;
};

}  // namespace cargobay::hal::sim
