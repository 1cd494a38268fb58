#include "hal/sim/robot/device.hpp"

#include <algorithm>

#include "oi/checksum.hpp"
#include "oi/dialect.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal::sim {

namespace {

// Room for the bytes that come while the robot waits: a script and some more.
constexpr std::size_t kInputRoom = 512;
constexpr std::uint64_t kJunkSeed = 0x6a756e6b;

// "The force field on top of the Home Base also trips this sensor" (OI p. 17), whatever sends it.
void see_force_field(Inputs& seen) {
  using oi::InfraredCharacter;
  if (seen.home_base && seen.infrared == kNoInfrared) {
    seen.infrared =
        static_cast<std::uint8_t>(InfraredCharacter::home_base_red_and_green_buoy_and_force_field);
  }
  if (seen.home_base || seen.beams().has(oi::HomeBaseBeam::force_field)) seen.virtual_wall = true;
}

}  // namespace

Device::Device(const Parameters& parameters)
    : parameters_{parameters},
      next_tick_{parameters.first_tick},
      serial_{.baud = parameters.boot_baud,
              .next_baud = parameters.boot_baud,
              .output = UartLine{std::max(parameters.transmit_bytes, kLongestPart)},
              .input = RingBuffer<std::uint8_t>{kInputRoom},
              .parser = oi::CommandParser{*parameters.dialect}},
      chassis_{.wheels = Wheels{parameters}, .odometer = Odometer{parameters}},
      battery_{parameters.battery},
      junk_{parameters.seed ^ kJunkSeed} {
  switch (parameters.power_on) {
    case PowerOn::long_ago: supply_.brc.power_on(-BrcDetector::kAfterPowerOn); break;
    case PowerOn::now: switch_on(kPowerOnTime); break;
    case PowerOn::never: supply_.state = Power::off; break;
  }
}

Truth Device::truth() const {
  Wheels wheels = chassis_.wheels;
  wheels.advance(now_ - chassis_.at);
  return {.pose = wheels.pose(), .speeds = wheels.speeds()};
}

std::uint8_t Device::sounding() const {
  if (songs_.playing()) return songs_.sounding(now_);
  return own_sound_.playing() ? own_sound_.sounding(now_) : demo_.note;
}

void Device::place(const WorldPose& pose) {
  advance_wheels();
  chassis_.wheels.place(pose);
}

void Device::set_wheels_blocked(bool left, bool right) {
  chassis_.blocked.left = left;
  chassis_.blocked.right = right;
  advance_wheels();
  block_wheels(inputs_);
}

void Device::block_wheels(const Inputs& inputs) {
  chassis_.wheels.set_blocked(
      chassis_.blocked.left || stuck(Side::left) || inputs.overcurrent_left_wheel,
      chassis_.blocked.right || stuck(Side::right) || inputs.overcurrent_right_wheel);
}

void Device::set_wheels(const WheelParameters& parameters) {
  advance_wheels();
  parameters_.wheels = parameters;
  chassis_.wheels.set(parameters);
  chassis_.odometer.set(parameters);
}

// When so much time is over, which may be never.
rt::Duration Device::in(rt::Duration period) const {
  return period < rt::Duration::max() - now_ ? now_ + period : rt::Duration::max();
}

void Device::set_load(Side side, double factor, rt::Duration period) {
  advance_wheels();
  hardship_of(side).load = factor;
  hardship_of(side).load_until = in(period);
  load_wheels();
}

void Device::set_stuck(Side side, rt::Duration period) {
  advance_wheels();
  hardship_of(side).stuck_until = in(period);
  block_wheels(inputs_);
}

void Device::load_wheels() {
  for (Hardship* const wheel : {&chassis_.left, &chassis_.right}) {
    if (now_ >= wheel->load_until) *wheel = {.load = 1.0, .stuck_until = wheel->stuck_until};
  }
  chassis_.wheels.set_load(chassis_.left.load, chassis_.right.load);
}

void Device::turn_wheels(WheelSpeeds turned) {
  advance_wheels();
  chassis_.wheels.set_turned(turned);
}

rt::Duration Device::next_event() const { return std::min(next_tick_, serial_.change_at); }

rt::Duration Device::until_next_event() const { return next_event() - now_; }

void Device::advance(rt::Duration period) {
  const rt::Duration end = now_ + period;
  while (next_event() <= end) {
    now_ = next_event();
    if (serial_.change_at == now_) {
      serial_.baud = serial_.next_baud;
      serial_.change_at = rt::Duration::max();
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
  chassis_.wheels.advance(now_ - chassis_.at);
  chassis_.at = now_;
}

void Device::tick() {
  ++ticks_;
  advance_wheels();
  load_wheels();
  chassis_.wheels.tick();
  chassis_.odometer.latch(chassis_.wheels.left().counts(), chassis_.wheels.right().counts());
  release_buttons();
  const Inputs before = seen_;
  seen_ = inputs_;
  if (surroundings) surroundings(*this, seen_);
  see_force_field(seen_);
  overload_wheels();
  tick_battery();
  tick_play_held();
  own_sound_.advance(now_);
  if (supply_.state == Power::booting) tick_boot();
  if (supply_.state == Power::on) {
    tick_buttons(before);
    tick_oi();
  }
  if (on_tick) on_tick(*this);
}

// A motor gets 1.0 A at most (OI p. 17): a wheel that needs more to move stands still, and a wheel
// that is held draws that much.
void Device::overload_wheels() {
  block_wheels(seen_);
  if (chassis_.wheels.left().stalled()) seen_.overcurrent_left_wheel = true;
  if (chassis_.wheels.right().stalled()) seen_.overcurrent_right_wheel = true;
}

void Device::press(oi::Button button, rt::Duration period) {
  const bool play = button == oi::Button::play;
  (play ? inputs_.play_button : inputs_.advance_button) = true;
  (play ? released_at_.play : released_at_.advance) = next_tick_ + period;
}

void Device::release_buttons() {
  const auto release = [this](bool& button, rt::Duration& released_at) {
    if (now_ < released_at) return;
    button = false;
    released_at = rt::Duration::max();
  };
  release(inputs_.play_button, released_at_.play);
  release(inputs_.advance_button, released_at_.advance);
}

void Device::tick_oi() {
  songs_.advance(now_);
  if (mode_ == oi::Mode::safe) {
    // Applies even while a script waits: the robot must not keep rolling.
    if (const auto found = safety_condition(seen_, commanded(), parameters_.wheels.wheel_base_mm)) {
      last_safety_condition_ = found;
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
    size += 1U + parameters_.dialect->packet(oi::PacketId{id}).size;
  }
  send(oi::kFrameHeader);
  serial_.sent_sum = parameters_.checksum == oi::Checksum::excluding_header ? 0U : oi::kFrameHeader;
  serial_.garbling = faults_.garbled_frames > 0;
  if (serial_.garbling) --faults_.garbled_frames;
  send(static_cast<std::uint8_t>(size));
  for (const std::uint8_t id : stream_.packets()) {
    send(id);
    send_packet(id);
  }
  send(static_cast<std::uint8_t>(0U - serial_.sent_sum));
  serial_.garbling = false;
  ++counters_.frames_sent;
}

void Device::send(std::uint8_t byte) {
  serial_.sent_sum += byte;
  const auto sent = serial_.garbling ? static_cast<std::uint8_t>(junk_.next()) : byte;
  if (serial_.output.push(now_, sent, serial_.next_baud)) {
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
  const bool too_close = oi::needs_spacing(serial_.baud) &&
                         serial_.last_heard != rt::Duration::min() &&
                         now_ - serial_.last_heard < oi::kByteSpacingAt115200;
  if (supply_.state != Power::on || too_close || now_ < serial_.deaf_until) {
    ++counters_.bytes_unheard;
    return;
  }
  serial_.last_heard = now_;
  if (!serial_.input.push_back(byte)) {
    ++counters_.bytes_overrun;
    return;
  }
  process();
}

}  // namespace cargobay::hal::sim
