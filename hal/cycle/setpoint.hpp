// The wheel speeds last asked for, and how long they count: a program that hangs must not leave its
// robot driving.
#pragma once

#include <atomic>
#include <cstdint>

#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"
#include "rt/setpoint_cell.hpp"
#include "rt/wheel_speeds.hpp"

namespace cargobay::hal {

// put() and revoke() from any thread, everything else on the control thread. No allocation.
class Setpoint {
 public:
  enum class Age : std::uint8_t {
    alive,
    lapses,  // at this call
    lapsed,  // or never set
  };

  // A setpoint counts for `lapse` after the tick that first sees it.
  explicit Setpoint(rt::Duration lapse) : lapse_{lapse} {}

  // False, with nothing changed, for speeds that the cell refuses.
  [[nodiscard]] bool put(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
    return cell_.put(speeds);
  }

  // Whatever has been put so far no longer counts; what is put later does.
  void revoke() CARGOBAY_NONBLOCKING {
    revoked_.store(cell_.get().serial, std::memory_order_release);  // pairs with see()
  }

  // Call once a tick. A setpoint that has lapsed stays lapsed until the next put().
  Age see(rt::TimePoint now) CARGOBAY_NONBLOCKING {
    // In this order: the setpoint is the revoked one, or a later one.
    std::uint32_t revoked = revoked_.load(std::memory_order_acquire);
    const std::uint32_t serial = cell_.get().serial;
    // Forgotten once it is seen: serial numbers come round again.
    if (revoked != 0) revoked_.compare_exchange_strong(revoked, 0, std::memory_order_relaxed);
    if (revoked == serial) {
      serial_ = serial;
      alive_ = false;
      return Age::lapsed;
    }
    if (serial != serial_) {
      serial_ = serial;
      since_ = now;
      alive_ = true;
    }
    if (!alive_) return Age::lapsed;
    if (now - since_ <= lapse_) return Age::alive;
    alive_ = false;
    return Age::lapses;
  }
  // Meaningful while it is alive.
  rt::WheelSpeeds speeds() const CARGOBAY_NONBLOCKING { return cell_.get().speeds; }
  // Whatever has been set so far no longer counts.
  void drop() CARGOBAY_NONBLOCKING {
    serial_ = cell_.get().serial;
    alive_ = false;
  }

 private:
  rt::SetpointCell cell_{};
  // The serial number that was revoked and has not been seen yet; 0: none.
  std::atomic<std::uint32_t> revoked_{0};
  rt::Duration lapse_;
  rt::TimePoint since_{};
  std::uint32_t serial_ = 0;
  bool alive_ = false;
};

}  // namespace cargobay::hal
