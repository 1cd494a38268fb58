// Every command of the manual as a named struct. Its kWire lists the members in the order of the
// arguments in its table entry; ranges, sizes and order are the table's (oi/command_table.hpp).
#pragma once

#include <cstdint>
#include <tuple>

#include "oi/bit_set.hpp"
#include "oi/fixed_list.hpp"
#include "oi/limits.hpp"
#include "oi/packet_table.hpp"
#include "oi/units.hpp"

namespace cargobay::oi {

enum class Led : std::uint8_t { play = 1, advance = 3 };                               // OI p. 9
enum class LowSideDriver : std::uint8_t { driver_0 = 0, driver_1 = 1, driver_2 = 2 };  // OI p. 10
enum class DigitalOutput : std::uint8_t { output_0 = 0, output_1 = 1, output_2 = 2 };  // OI p. 10

// OI p. 8.
enum class DemoNumber : std::int8_t {
  abort = -1,
  cover = 0,
  cover_and_dock = 1,
  spot_cover = 2,
  mouse = 3,
  drive_figure_eight = 4,
  wimp = 5,
  home = 6,
  tag = 7,
  pachelbel = 8,
  banjo = 9,
};

// OI p. 16. The inverse of an event is its negative.
enum class ScriptEvent : std::int8_t {
  wheel_drop = 1,
  front_wheel_drop = 2,
  left_wheel_drop = 3,
  right_wheel_drop = 4,
  bump = 5,
  left_bump = 6,
  right_bump = 7,
  virtual_wall = 8,
  wall = 9,
  cliff = 10,
  left_cliff = 11,
  front_left_cliff = 12,
  front_right_cliff = 13,
  right_cliff = 14,
  home_base = 15,
  advance_button = 16,
  play_button = 17,
  digital_input_0 = 18,
  digital_input_1 = 19,
  digital_input_2 = 20,
  digital_input_3 = 21,
  mode_passive = 22,
};
// The event that waits until `event` is over.
constexpr ScriptEvent inverse(ScriptEvent event) {
  return static_cast<ScriptEvent>(-static_cast<std::int8_t>(event));
}

// Radii with a special meaning (OI p. 9).
inline constexpr Mm kStraight{-32768};
inline constexpr Mm kStraightAlternative{32767};
inline constexpr Mm kTurnClockwise{-1};
inline constexpr Mm kTurnCounterClockwise{1};

// A note outside 31 to 127 is a rest (OI p. 11).
struct Note {
  std::uint8_t number = 0;
  SixtyFourths duration{};
  friend constexpr bool operator==(const Note&, const Note&) = default;
};

// clang-format off
#define CARGOBAY_OI_BARE_COMMAND(Name, number)                             \
  struct Name {                                                            \
    static constexpr std::uint8_t kOpcode = number;                        \
    static constexpr std::tuple<> kWire{};                                 \
    friend constexpr bool operator==(const Name&, const Name&) = default;  \
  }
CARGOBAY_OI_BARE_COMMAND(Start, 128);
CARGOBAY_OI_BARE_COMMAND(Control, 130);
CARGOBAY_OI_BARE_COMMAND(Safe, 131);
CARGOBAY_OI_BARE_COMMAND(Full, 132);
CARGOBAY_OI_BARE_COMMAND(Spot, 134);
CARGOBAY_OI_BARE_COMMAND(Cover, 135);
CARGOBAY_OI_BARE_COMMAND(CoverAndDock, 143);
CARGOBAY_OI_BARE_COMMAND(PlayScript, 153);
CARGOBAY_OI_BARE_COMMAND(ShowScript, 154);
#undef CARGOBAY_OI_BARE_COMMAND
// clang-format on

struct Baud {
  std::uint8_t code = 0;  // oi/baud.hpp
  static constexpr std::uint8_t kOpcode = 129;
  static constexpr std::tuple kWire{&Baud::code};
  friend constexpr bool operator==(const Baud&, const Baud&) = default;
};

struct Demo {
  DemoNumber demo = DemoNumber::abort;
  static constexpr std::uint8_t kOpcode = 136;
  static constexpr std::tuple kWire{&Demo::demo};
  friend constexpr bool operator==(const Demo&, const Demo&) = default;
};

struct Drive {
  MmPerSec velocity{};
  Mm radius = kStraight;  // from the robot's centre to the turning circle's, positive to the left
  static constexpr std::uint8_t kOpcode = 137;
  static constexpr std::tuple kWire{&Drive::velocity, &Drive::radius};
  friend constexpr bool operator==(const Drive&, const Drive&) = default;
};

struct LowSideDrivers {
  BitSet<LowSideDriver> drivers{};
  static constexpr std::uint8_t kOpcode = 138;
  static constexpr std::tuple kWire{&LowSideDrivers::drivers};
  friend constexpr bool operator==(const LowSideDrivers&, const LowSideDrivers&) = default;
};

struct Leds {
  BitSet<Led> leds{};
  std::uint8_t power_color = 0;      // 0 green to 255 red
  std::uint8_t power_intensity = 0;  // 0 off to 255 full
  static constexpr std::uint8_t kOpcode = 139;
  static constexpr std::tuple kWire{&Leds::leds, &Leds::power_color, &Leds::power_intensity};
  friend constexpr bool operator==(const Leds&, const Leds&) = default;
};

struct Song {
  std::uint8_t slot = 0;
  FixedList<Note, kMaxSongNotes> notes{};  // at least one
  static constexpr std::uint8_t kOpcode = 140;
  static constexpr std::tuple kWire{&Song::slot, &Song::notes};
  friend constexpr bool operator==(const Song&, const Song&) = default;
};

// Ignored by the robot while a song plays (OI p. 13).
struct Play {
  std::uint8_t slot = 0;
  static constexpr std::uint8_t kOpcode = 141;
  static constexpr std::tuple kWire{&Play::slot};
  friend constexpr bool operator==(const Play&, const Play&) = default;
};

struct Sensors {
  PacketId packet = PacketId::group_0;
  static constexpr std::uint8_t kOpcode = 142;
  static constexpr std::tuple kWire{&Sensors::packet};
  friend constexpr bool operator==(const Sensors&, const Sensors&) = default;
};

// Duty cycles, 0 to 128.
struct PwmLowSideDrivers {
  std::uint8_t driver_0 = 0;
  std::uint8_t driver_1 = 0;
  std::uint8_t driver_2 = 0;
  static constexpr std::uint8_t kOpcode = 144;
  static constexpr std::tuple kWire{&PwmLowSideDrivers::driver_2, &PwmLowSideDrivers::driver_1,
                                    &PwmLowSideDrivers::driver_0};
  friend constexpr bool operator==(const PwmLowSideDrivers&, const PwmLowSideDrivers&) = default;
};

struct DriveDirect {
  MmPerSec left{};
  MmPerSec right{};
  static constexpr std::uint8_t kOpcode = 145;
  static constexpr std::tuple kWire{&DriveDirect::right, &DriveDirect::left};
  friend constexpr bool operator==(const DriveDirect&, const DriveDirect&) = default;
};

struct DigitalOutputs {
  BitSet<DigitalOutput> outputs{};
  static constexpr std::uint8_t kOpcode = 147;
  static constexpr std::tuple kWire{&DigitalOutputs::outputs};
  friend constexpr bool operator==(const DigitalOutputs&, const DigitalOutputs&) = default;
};

using StreamList = FixedList<PacketId, kMaxStreamPackets>;

struct Stream {
  StreamList packets{};
  static constexpr std::uint8_t kOpcode = 148;
  static constexpr std::tuple kWire{&Stream::packets};
  friend constexpr bool operator==(const Stream&, const Stream&) = default;
};

struct QueryList {
  FixedList<PacketId, kMaxQueryPackets> packets{};
  static constexpr std::uint8_t kOpcode = 149;
  static constexpr std::tuple kWire{&QueryList::packets};
  friend constexpr bool operator==(const QueryList&, const QueryList&) = default;
};

enum class StreamState : std::uint8_t { pause = 0, resume = 1 };

struct PauseResumeStream {
  StreamState state = StreamState::pause;
  static constexpr std::uint8_t kOpcode = 150;
  static constexpr std::tuple kWire{&PauseResumeStream::state};
  friend constexpr bool operator==(const PauseResumeStream&, const PauseResumeStream&) = default;
};

struct SendIr {
  std::uint8_t byte = 0;
  static constexpr std::uint8_t kOpcode = 151;
  static constexpr std::tuple kWire{&SendIr::byte};
  friend constexpr bool operator==(const SendIr&, const SendIr&) = default;
};

// Length 0 clears the stored script.
struct Script {
  FixedList<std::uint8_t, kMaxScriptBytes> body{};
  static constexpr std::uint8_t kOpcode = 152;
  static constexpr std::tuple kWire{&Script::body};
  friend constexpr bool operator==(const Script&, const Script&) = default;
};

struct WaitTime {
  Tenths time{};
  static constexpr std::uint8_t kOpcode = 155;
  static constexpr std::tuple kWire{&WaitTime::time};
  friend constexpr bool operator==(const WaitTime&, const WaitTime&) = default;
};

struct WaitDistance {
  Mm distance{};
  static constexpr std::uint8_t kOpcode = 156;
  static constexpr std::tuple kWire{&WaitDistance::distance};
  friend constexpr bool operator==(const WaitDistance&, const WaitDistance&) = default;
};

struct WaitAngle {
  Deg angle{};
  static constexpr std::uint8_t kOpcode = 157;
  static constexpr std::tuple kWire{&WaitAngle::angle};
  friend constexpr bool operator==(const WaitAngle&, const WaitAngle&) = default;
};

struct WaitEvent {
  ScriptEvent event = ScriptEvent::wheel_drop;
  static constexpr std::uint8_t kOpcode = 158;
  static constexpr std::tuple kWire{&WaitEvent::event};
  friend constexpr bool operator==(const WaitEvent&, const WaitEvent&) = default;
};

// One of the structs above.
template <typename C>
concept CommandStruct = requires {
  C::kOpcode;
  C::kWire;
};

}  // namespace cargobay::oi
