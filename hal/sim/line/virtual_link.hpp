// A byte stream to a virtual Create in virtual time: waiting makes time pass. The same code that
// drives a robot runs over it, faster than real time and the same every time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <system_error>
#include <utility>

#include "hal/sim/line/cable.hpp"
#include "hal/sim/line/virtual_time.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

class VirtualLink final : public ByteStream {
 public:
  // The device outlives the link. The host starts at the rate that the robot listens at.
  explicit VirtualLink(Device& device) : cable_{device} {}
  // The same on a clock that it shares with other links, which outlives it.
  VirtualLink(Device& device, VirtualTime& time);
  ~VirtualLink() override;
  VirtualLink(const VirtualLink&) = delete;
  VirtualLink& operator=(const VirtualLink&) = delete;

  // How the loop over this link makes a pass while time moves for another one: from then on, it is
  // called whenever the wait of its last pass is over. Empty: there is no such loop.
  void set_pass(std::function<void()> pass);

  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override;
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override;
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override;
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override;

  std::uint32_t baud() const override { return cable_.host_baud(); }
  [[nodiscard]] std::error_code set_baud(std::uint32_t baud) override;
  [[nodiscard]] std::error_code set_wake_threshold(std::size_t bytes) override;
  // Fails until on_modem_line() has said what hangs on the lines.
  [[nodiscard]] std::error_code set_modem_line(ModemLine line, bool asserted) override;
  void discard_input() override { cable_.discard(); }
  [[nodiscard]] bool drain(rt::Duration timeout) override;
  void sleep(rt::Duration duration) override { advance(duration); }

  // Lets time pass without reading.
  void advance(rt::Duration period);
  // Called with each change of RTS and DTR: a USB cable whose outputs lead to pins of the robot.
  void on_modem_line(std::function<void(ModemLine line, bool asserted)> wire) {
    modem_line_ = std::move(wire);
  }
  // The other side goes away, for this link permanently.
  void hang_up() { hung_up_ = true; }
  Cable& cable() { return cable_; }
  const Cable& cable() const { return cable_; }

 private:
  friend class VirtualTime;
  // Nothing happens before this time, and no wait of a pass is over.
  rt::Duration next_event() const;
  // Until it waits for what is still to come.
  void make_passes();
  void move_on(rt::Duration until);
  // What a wait returns now, if it is over.
  std::optional<Wait> over() const;

  Cable cable_;
  std::function<void(ModemLine line, bool asserted)> modem_line_{};
  std::size_t wake_threshold_ = 1;
  bool hung_up_ = false;

  VirtualTime* time_ = nullptr;  // outlives the link
  std::function<void()> pass_{};
  bool making_pass_ = false;  // in make_passes(): nothing moves time
  bool passed_ = false;       // the pass has come to its wait: the loop has not ended
  bool left_ = false;         // its wait was not over
  rt::Duration waits_until_{0};
};

}  // namespace cargobay::hal::sim
