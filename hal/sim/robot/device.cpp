#include "hal/sim/robot/device.hpp"

#include <algorithm>

#include "oi/checksum.hpp"
#include "oi/extensions.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal::sim {

namespace {

constexpr std::uint32_t kFastBaud = 115200;
// Room for the bytes that come while the robot waits: a script and some more.
constexpr std::size_t kInputRoom = 512;
constexpr std::uint64_t kJunkSeed = 0x6a756e6b;

// "The force field on top of the Home Base also trips this sensor" (OI p. 17), whatever sends it.
void see_force_field(Inputs& seen) {
  if (seen.home_base && seen.infrared == kNoInfrared) seen.infrared = kInfraredWhenDocked;
  if (seen.home_base || has_force_field(seen.infrared)) seen.virtual_wall = true;
}

}  // namespace

Device::Device(const Parameters& parameters)
    : parameters_{parameters},
      next_tick_{parameters.first_tick},
      baud_{parameters.boot_baud},
      next_baud_{parameters.boot_baud},
      output_{std::max(parameters.transmit_bytes, kLongestPart)},
      input_{kInputRoom},
      wheels_{parameters},
      odometer_{parameters},
      battery_{parameters.battery},
      junk_{parameters.seed ^ kJunkSeed} {
  switch (parameters.power_on) {
    case PowerOn::long_ago: brc_.power_on(-BrcDetector::kAfterPowerOn); break;
    case PowerOn::now: switch_on(kPowerOnTime); break;
    case PowerOn::never: power_ = Power::off; break;
  }
}

Truth Device::truth() const {
  Wheels wheels = wheels_;
  wheels.advance(now_ - wheels_at_);
  return {.pose = wheels.pose(), .speeds = wheels.speeds()};
}

std::uint8_t Device::sounding() const {
  if (songs_.playing()) return songs_.sounding(now_);
  return own_sound_.playing() ? own_sound_.sounding(now_) : demo_note_;
}

void Device::place(const Pose& pose) {
  advance_wheels();
  wheels_.place(pose);
}

void Device::set_wheels_blocked(bool left, bool right) {
  left_blocked_ = left;
  right_blocked_ = right;
  advance_wheels();
  wheels_.set_blocked(left || inputs_.overcurrent_left_wheel,
                      right || inputs_.overcurrent_right_wheel);
}

void Device::turn_wheels(WheelSpeeds turned) {
  advance_wheels();
  wheels_.set_turned(turned);
}

rt::Duration Device::next_event() const { return std::min(next_tick_, baud_change_at_); }

rt::Duration Device::until_next_event() const { return next_event() - now_; }

void Device::advance(rt::Duration period) {
  const rt::Duration end = now_ + period;
  while (next_event() <= end) {
    now_ = next_event();
    if (baud_change_at_ == now_) {
      baud_ = next_baud_;
      baud_change_at_ = rt::Duration::max();
    }
    if (next_tick_ == now_) {
      tick();
      next_tick_ += oi::kTick;
    }
  }
  now_ = end;
}

// Integrates the wheels from one change to the next and no finer, so that the result does not
// depend on how time is divided into calls of advance().
void Device::advance_wheels() {
  wheels_.advance(now_ - wheels_at_);
  wheels_at_ = now_;
}

void Device::tick() {
  ++ticks_;
  advance_wheels();
  wheels_.tick();
  odometer_.latch(wheels_.left().counts(), wheels_.right().counts());
  release_buttons();
  const Inputs before = seen_;
  seen_ = inputs_;
  if (surroundings) surroundings(*this, seen_);
  see_force_field(seen_);
  overload_wheels();
  tick_battery();
  tick_play_held();
  own_sound_.advance(now_);
  if (power_ == Power::booting) tick_boot();
  if (power_ == Power::on) {
    tick_buttons(before);
    tick_oi();
  }
  if (on_tick) on_tick(*this);
}

// A motor gets 1.0 A at most (OI p. 17): a wheel that needs more to move stands still, and a wheel
// that is held draws that much.
void Device::overload_wheels() {
  wheels_.set_blocked(left_blocked_ || seen_.overcurrent_left_wheel,
                      right_blocked_ || seen_.overcurrent_right_wheel);
  if (wheels_.left().stalled()) seen_.overcurrent_left_wheel = true;
  if (wheels_.right().stalled()) seen_.overcurrent_right_wheel = true;
}

void Device::press(oi::Button button, rt::Duration period) {
  const bool play = button == oi::Button::play;
  (play ? inputs_.play_button : inputs_.advance_button) = true;
  (play ? play_released_at_ : advance_released_at_) = next_tick_ + period;
}

void Device::release_buttons() {
  const auto release = [this](bool& button, rt::Duration& released_at) {
    if (now_ < released_at) return;
    button = false;
    released_at = rt::Duration::max();
  };
  release(inputs_.play_button, play_released_at_);
  release(inputs_.advance_button, advance_released_at_);
}

void Device::tick_oi() {
  songs_.advance(now_);
  if (mode_ == oi::Mode::safe) {
    // Applies even while a script waits: the robot must not keep rolling.
    if (const auto found = hazard(seen_, commanded(), parameters_.wheels.wheel_base_mm)) {
      last_hazard_ = found;
      ++counters_.safety_stops;
      enter(oi::Mode::passive);
    }
  }
  tick_wait();
  reply();
  process();
  tick_demo();
  const bool busy = waiting() || replying();
  if (mode_ != oi::Mode::off && stream_.running() && !busy && now_ >= faults_.stalled_until) {
    send_frame();
  }
}

// A frame goes out whole or in part, as far as there is room: "the data stream will eventually
// become corrupted", as the manual says (OI p. 14).
void Device::send_frame() {
  std::uint32_t size = 0;
  for (const std::uint8_t id : stream_.packets()) {
    size += 1U + oi::find_packet(id, parameters_.extensions)->size;
  }
  send(oi::kFrameHeader);
  sent_sum_ = parameters_.checksum == oi::Checksum::excluding_header ? 0U : oi::kFrameHeader;
  garbling_ = faults_.garbled_frames > 0;
  if (garbling_) --faults_.garbled_frames;
  send(static_cast<std::uint8_t>(size));
  for (const std::uint8_t id : stream_.packets()) {
    send(id);
    send_packet(id);
  }
  send(static_cast<std::uint8_t>(0U - sent_sum_));
  garbling_ = false;
  ++counters_.frames_sent;
}

void Device::send(std::uint8_t byte) {
  sent_sum_ += byte;
  const auto sent = garbling_ ? static_cast<std::uint8_t>(junk_.next()) : byte;
  if (output_.push(now_, sent, next_baud_)) {
    ++counters_.bytes_sent;
  } else {
    ++counters_.bytes_lost;
  }
}

void Device::print(std::string_view text) {
  for (const char character : text) send(static_cast<std::uint8_t>(character));
}

void Device::receive(std::uint8_t byte) {
  ++counters_.bytes_received;
  // At 115200 a byte that begins less than 200 us after the last one heard is lost (OI p. 7).
  const bool too_close = baud_ == kFastBaud && last_heard_ != rt::Duration::min() &&
                         now_ - last_heard_ < oi::kByteSpacingAt115200;
  if (power_ != Power::on || too_close || now_ < deaf_until_) {
    ++counters_.bytes_unheard;
    return;
  }
  last_heard_ = now_;
  if (!input_.push_back(byte)) {
    ++counters_.bytes_overrun;
    return;
  }
  process();
}

}  // namespace cargobay::hal::sim
