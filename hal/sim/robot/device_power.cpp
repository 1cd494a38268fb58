// Power, boot and charging: what the robot does before and besides its Open Interface (OI p. 5),
// and what it prints then.
#include <array>
#include <cmath>
#include <cstdio>

#include "hal/sim/robot/device.hpp"
#include "oi/dialect.hpp"
#include "oi/limits.hpp"

namespace cargobay::hal::sim {

namespace {

// What the robot's bootloader and firmware print; 3 s of silence come first.
constexpr std::string_view kBootText =
    "bl-start\r\n2006-09-12-1137-L   \r\nRDK by iRobot!\r\nMC9S12E128\r\n2006-11-20-1731-L   \r\n"
    "battery-current-quiescent-raw 524  battery-current-zero 510\r\n\r\n2006-11-20-1731-L   \r\n";
constexpr rt::Duration kBootSilence = std::chrono::seconds{3};
constexpr rt::Duration kResetTime = std::chrono::milliseconds{4500};
constexpr rt::Duration kPlayHeld = std::chrono::seconds{4};
// "A tune of descending pitches" (OI p. 5); the manual does not say which.
constexpr std::array kTuneOf19200{
    oi::Note{79, oi::SixtyFourths{8}}, oi::Note{76, oi::SixtyFourths{8}},
    oi::Note{72, oi::SixtyFourths{8}}, oi::Note{67, oi::SixtyFourths{16}}};

constexpr double kSleepingMa = 5.0;
constexpr double kIdleMa = 250.0;
constexpr double kWheelMaPerMmPerSec = 0.5;
constexpr double kStalledWheelMa = 1000.0;                   // OI p. 17
constexpr double kDriverMa = 250.0;                          // of a load at a low side driver
constexpr std::array kDriverLimitsMa{500.0, 500.0, 1600.0};  // OI p. 17

}  // namespace

void Device::switch_on(rt::Duration boot_time) {
  forget_oi();
  supply_.state = Power::booting;
  supply_.powered_at = now_;
  supply_.booted_at = now_ + boot_time;
  supply_.boot_text_due = true;
  supply_.play_held = inputs_.play_button;
  actuators_ = {};
  actuators_.digital_outputs = kAllOutputs;
  supply_.brc.power_on(now_);
  switch_baud(supply_.brc_baud.value_or(parameters_.boot_baud));
  ++counters_.boots;
}

void Device::switch_off() {
  forget_oi();
  supply_.state = Power::off;
  actuators_ = {};
  print("processor-sleep\r\n");
}

void Device::forget_oi() {
  mode_ = oi::Mode::off;
  command_wheels({});
  serial_.parser.reset();
  serial_.input.clear();
  wait_.end();
  reply_.clear();
  demo_.demos.stop();
  demo_.note = 0;
  own_sound_.stop();
  stream_.reset();
  songs_.reset();
  script_.bytes.clear();
  script_.played = false;
  script_.again = false;
  requested_.velocity_mm_s = 0;
  requested_.radius_mm = 0;
  requested_.right_mm_s = 0;
  requested_.left_mm_s = 0;
}

void Device::press_power() {
  if (supply_.state != Power::off) return switch_off();
  serial_.output.clear();  // unsent bytes, at 300 baud half a minute's worth, go with the power
  print("key-wakeup\r\n");
  switch_on(kPowerOnTime);
}

void Device::set_power_toggle(bool high) {
  if (high && !supply_.toggle_high) press_power();
  supply_.toggle_high = high;
}

void Device::set_brc(bool high) {
  if (!supply_.brc.set_level(high, now_) || supply_.state == Power::off) return;
  supply_.brc_baud = parameters_.dialect->brc_baud;
  switch_baud(parameters_.dialect->brc_baud);
}

void Device::reset() {
  if (supply_.state != Power::off) switch_on(kResetTime);
}

void Device::brown_out() {
  if (supply_.state == Power::off) return;
  supply_.brc_baud.reset();
  serial_.output.clear();
  switch_on(kPowerOnTime);
}

// After that "the OI is in off mode" (OI p. 6) and no rate is remembered (OI p. 5, 7).
void Device::change_battery(BatteryPack pack) {
  forget_oi();
  supply_.state = Power::off;
  actuators_ = {};
  supply_.brc_baud.reset();
  serial_.output.clear();
  battery_.insert(pack);
}

// "If too much current is requested, the current is limited" (OI p. 10).
std::array<double, 3> Device::low_side_driver_ma() const {
  std::array<double, 3> drivers_ma{};
  for (std::size_t i = 0; i < drivers_ma.size(); ++i) {
    const double full_ma = seen_.overcurrent_low_side_driver[i] ? kDriverLimitsMa[i] : kDriverMa;
    drivers_ma[i] = full_ma * actuators_.low_side_drivers[i] / kFullDuty;
  }
  return drivers_ma;
}

void Device::tick_boot() {
  if (supply_.boot_text_due && now_ >= supply_.powered_at + kBootSilence) {
    supply_.boot_text_due = false;
    actuators_.digital_outputs = 0;
    print(kBootText);
  }
  if (now_ >= supply_.booted_at) supply_.state = Power::on;
}

void Device::tick_battery() {
  const bool in_control = mode_ == oi::Mode::safe || mode_ == oi::Mode::full;
  double load_ma = supply_.state == Power::off ? kSleepingMa : kIdleMa;
  const WheelSpeeds speeds = chassis_.wheels.speeds();
  load_ma += kWheelMaPerMmPerSec * (std::abs(speeds.left_mm_s) + std::abs(speeds.right_mm_s));
  for (const Wheel& wheel : {chassis_.wheels.left(), chassis_.wheels.right()})
    load_ma += wheel.stalled() ? kStalledWheelMa : 0.0;
  for (const double driver_ma : low_side_driver_ma()) load_ma += driver_ma;
  battery_.advance(oi::kTick, load_ma, seen_.charger || seen_.home_base, !in_control);
  if (battery_.empty() && supply_.state != Power::off) {
    switch_off();
    supply_.brc_baud.reset();
  }
  const bool second_over = battery_.charging_time() / std::chrono::seconds{1} !=
                           (battery_.charging_time() - oi::kTick) / std::chrono::seconds{1};
  if (battery_.charging() && second_over && parameters_.charging_text) print_charging();
}

// Holding Play down for 4 s from power-on means 19200 (OI p. 5).
void Device::tick_play_held() {
  supply_.play_held = supply_.play_held && seen_.play_button && supply_.state != Power::off;
  if (!supply_.play_held || now_ < supply_.powered_at + kPlayHeld) return;
  supply_.play_held = false;
  switch_baud(parameters_.dialect->brc_baud);
  own_sound_.start(kTuneOf19200, now_);
}

void Device::print_charging() {
  const auto seconds = battery_.charging_time() / std::chrono::seconds{1};
  std::array<char, 96> line{};
  const int length = std::snprintf(
      line.data(), line.size(), "bat:   min %d  sec %d  mV %d  mA %d  deg-C %d  \r\n",
      static_cast<int>(seconds / 60), static_cast<int>(seconds % 60),
      static_cast<int>(battery_.voltage_mv()), static_cast<int>(battery_.current_ma()),
      static_cast<int>(battery_.temperature_deg_c()));
  print({line.data(), static_cast<std::size_t>(length)});
}

}  // namespace cargobay::hal::sim
