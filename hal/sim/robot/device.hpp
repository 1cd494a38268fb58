// The virtual Create: bytes in, bytes out, and time that passes only when it is advanced. No clock,
// no threads; the same bytes at the same instants always give the same bytes back.
//
// It takes each byte at the instant when it has fully arrived: hal/sim/line/cable.hpp does that.
// Nothing allocates after construction, except what the hooks do.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "hal/sim/battery.hpp"
#include "hal/sim/demos/demos.hpp"
#include "hal/sim/drive_train/odometer.hpp"
#include "hal/sim/drive_train/wheels.hpp"
#include "hal/sim/inputs.hpp"
#include "hal/sim/parameters.hpp"
#include "hal/sim/pose.hpp"
#include "hal/sim/random.hpp"
#include "hal/sim/ring_buffer.hpp"
#include "hal/sim/robot/actuators.hpp"
#include "hal/sim/robot/brc_detector.hpp"
#include "hal/sim/robot/melody.hpp"
#include "hal/sim/robot/reply.hpp"
#include "hal/sim/robot/song_player.hpp"
#include "hal/sim/robot/stream_sender.hpp"
#include "hal/sim/robot/uart_line.hpp"
#include "hal/sim/robot/wait.hpp"
#include "hal/sim/safety.hpp"
#include "oi/command_parser.hpp"
#include "oi/command_table.hpp"
#include "oi/dialect.hpp"
#include "oi/fixed_list.hpp"
#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

// The true state, which no sensor reports.
struct Truth {
  WorldPose pose{};
  WheelSpeeds speeds{};
};

// What befalls a wheel: a load leaves that part of its gain, or it is stuck.
struct Hardship {
  double load = 1.0;
  rt::Duration load_until{rt::Duration::max()};
  rt::Duration stuck_until{rt::Duration::min()};
};

// A Drive or Drive Direct that the robot obeyed, as wheel speeds.
struct DriveRecord {
  rt::Duration time{};
  std::uint64_t tick = 0;  // ticks so far: two records with the same number share a 15 ms slot
  WheelSpeeds command{};
};

struct DeviceCounters {
  std::uint64_t bytes_received = 0;
  std::uint64_t bytes_unheard = 0;     // off, booting, changing the rate, or too close at 115200
  std::uint64_t bytes_overrun = 0;     // there was no room to keep them while the robot waits
  std::uint64_t commands = 0;          // obeyed
  std::uint64_t commands_refused = 0;  // not available in the mode
  // Obeyed, with data outside the manual's range: clamped to it, or ignored.
  std::uint64_t commands_out_of_range = 0;
  std::uint64_t unknown_opcodes = 0;
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_lost = 0;  // more were requested than the wire carries
  std::uint64_t frames_sent = 0;
  std::uint64_t safety_stops = 0;  // Safe became Passive
  std::uint64_t boots = 0;
};

// What goes wrong inside the robot; for its line see hal/sim/line/line_faults.hpp.
struct DeviceFaults {
  rt::Duration stalled_until{0};     // no stream frames until then
  std::uint32_t garbled_frames = 0;  // how many of the next frames to garble, except their headers
  std::uint32_t junk_readings = 0;   // how many of the next distances and angles are junk
};

enum class Power : std::uint8_t { off, booting, on };

class Device {
 public:
  explicit Device(const Parameters& parameters);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() = default;

  // A byte has fully arrived, now.
  void receive(std::uint8_t byte);
  // What it sends: pop the bytes that have arrived at the other end.
  UartLine& output() { return serial_.output; }
  const UartLine& output() const { return serial_.output; }
  // The rate that it listens at.
  std::uint32_t baud() const { return serial_.baud; }

  void advance(rt::Duration period);
  // How much time may pass at most before it does something by itself. Never negative.
  rt::Duration until_next_event() const;
  // Since it was built.
  rt::Duration now() const { return now_; }
  std::uint64_t ticks() const { return ticks_; }

  // The pins and the power button, from now on (OI p. 4, 5).
  void press_power();
  void set_power_toggle(bool high);  // pin 3: low to high toggles the power
  void set_brc(bool high);           // pin 15
  // Restarts the processor, as opcode 7 does: takes 4.5 s.
  void reset();
  // The battery fails for an instant: the robot forgets everything.
  void brown_out();

  Power power() const { return supply_.state; }
  oi::Mode mode() const { return mode_; }
  Truth truth() const;
  WheelSpeeds commanded() const { return chassis_.wheels.command(); }
  const Actuators& actuators() const { return actuators_; }
  const SongPlayer& songs() const { return songs_; }
  // The MIDI number of the note that sounds, from a song, a demo or the robot itself; 0: silence.
  std::uint8_t sounding() const;
  const StreamSender& stream() const { return stream_; }
  std::span<const std::uint8_t> script() const { return script_.bytes; }
  // Deaf and silent: a Wait command has not ended yet.
  bool waiting() const { return wait_.active(); }
  // A reply is waiting for room on the line; what comes meanwhile is kept for later.
  bool replying() const { return reply_.under_way(); }
  const Demos& demos() const { return demo_.demos; }
  Battery& battery() { return battery_; }
  const Battery& battery() const { return battery_; }
  bool brc_high() const { return supply_.brc.high(); }
  // Why Safe last became Passive.
  std::optional<SafetyCondition> last_safety_condition() const { return last_safety_condition_; }
  const DeviceCounters& counters() const { return counters_; }
  // How many bytes, at least, complete the command in progress; 0 between commands.
  std::size_t bytes_awaited() const { return serial_.parser.needed(); }
  const Parameters& parameters() const { return parameters_; }

  // What the sensors see from the next tick on.
  Inputs& inputs() { return inputs_; }
  const Inputs& inputs() const { return inputs_; }
  // What they saw at the last tick: the inputs, plus what the surroundings added.
  const Inputs& seen() const { return seen_; }
  // Holds a button down for that long, from the next tick on.
  void press(oi::Button button, rt::Duration period);
  void place(const WorldPose& pose);
  void set_wheels_blocked(bool left, bool right);
  // Changes how the wheels answer, from now on and while they turn.
  void set_wheels(const WheelParameters& parameters);
  // A load leaves that part of the wheel's gain, 1 for none, from now on; or it is stuck. For that
  // long, or to the end of the 15 ms in which it is over.
  void set_load(Side side, double factor, rt::Duration period = rt::Duration::max());
  void set_stuck(Side side, rt::Duration period = rt::Duration::max());
  const Hardship& hardship(Side side) const {
    return side == Side::left ? chassis_.left : chassis_.right;
  }
  bool stuck(Side side) const { return now_ < hardship(side).stuck_until; }
  // Turns the wheels from outside from now on, by hand or by a push; the motors are stronger.
  void turn_wheels(WheelSpeeds turned);
  // Replaces the battery with a full one: the robot forgets everything, and is off.
  void change_battery(BatteryPack pack);
  // The current through each low side driver: what it is set to, limited by the hardware.
  std::array<double, 3> low_side_driver_ma() const;

  DeviceFaults& faults() { return faults_; }
  // Prints text that is not an answer to anything.
  void print(std::string_view text);
  // Leaves the robot waiting for the data of a command that was cut off; in Passive mode if it was
  // Off. Does nothing without power.
  void take_half_command();
  // Changes the rate without the host knowing.
  void set_baud(std::uint32_t baud);

  // Called at each tick before the sensors look: a world may add to what they see, which starts as
  // the inputs above, and may move the robot.
  std::function<void(Device&, Inputs& seen)> surroundings{};
  // Called for each drive command that is obeyed, and at the end of each tick. They may look at the
  // device but not change it.
  std::function<void(const DriveRecord&)> on_drive{};
  std::function<void(const Device&)> on_tick{};

 private:
  // At most two are pending: a tick and a change of the baud rate.
  rt::Duration next_event() const;
  void advance_wheels();
  Hardship& hardship_of(Side side) { return side == Side::left ? chassis_.left : chassis_.right; }
  rt::Duration in(rt::Duration period) const;
  void load_wheels();
  void block_wheels(const Inputs& inputs);
  void overload_wheels();
  void release_buttons();
  void tick();
  void tick_oi();
  void send_frame();

  // device_power.cpp
  void switch_on(rt::Duration boot_time);
  void switch_off();
  void forget_oi();
  void tick_boot();
  void tick_play_held();
  void tick_battery();
  void print_charging();

  // device_commands.cpp
  void process();
  void interpret(std::uint8_t byte);
  void execute(const oi::CommandInfo& info, std::span<const std::uint8_t> bytes);
  void extension(std::uint8_t opcode);
  bool within_manual(std::span<const std::uint8_t> bytes) const;
  void obey(std::uint8_t opcode, std::span<const std::int32_t> arguments,
            std::span<const std::uint8_t> tail);
  void enter(oi::Mode mode);
  void stop_motors();
  void change_baud(std::int32_t code);
  void switch_baud(std::uint32_t baud);
  void drive(std::int32_t velocity_mm_s, std::int32_t radius_mm);
  void drive_direct(std::int32_t right_mm_s, std::int32_t left_mm_s);
  void obey_drive(WheelSpeeds command);
  void command_wheels(WheelSpeeds command);
  void start_demo(std::int32_t number);
  void tick_demo();
  void tick_buttons(const Inputs& before);
  Demos::View demo_view() const;
  void store_script(std::span<const std::uint8_t> body);
  void play_script();
  void show_script();
  void tick_wait();

  // device_sensors.cpp
  std::int32_t read_sensor(std::uint8_t id);
  std::int32_t junk_or(std::int32_t reading);
  static constexpr std::size_t kLongestPart = oi::kCreate.packet_size(6);  // of a reply: group 6
  void send(std::uint8_t byte);
  void reply();
  void send_packet(std::uint8_t id);

  // Battery, button, and the two pins that switch it on and change its rate.
  struct Supply {
    Power state = Power::on;
    rt::Duration powered_at{0};
    rt::Duration booted_at{0};
    bool boot_text_due = false;
    bool play_held = false;  // since power-on
    bool toggle_high = true;
    BrcDetector brc{};
    std::optional<std::uint32_t> brc_baud{};  // survives power-off, but not the loss of the battery
  };
  struct Serial {
    std::uint32_t baud;
    std::uint32_t next_baud;  // the rate to send at, once the bytes sent before have left
    UartLine output;
    RingBuffer<std::uint8_t> input;  // heard, not interpreted: all that comes while it waits
    rt::Duration change_at{rt::Duration::max()};
    rt::Duration deaf_until{0};
    rt::Duration last_heard{rt::Duration::min()};
    std::uint32_t sent_sum = 0;  // of a frame's bytes, for its checksum
    bool garbling = false;
    oi::CommandParser parser;
  };
  struct Script {
    oi::FixedList<std::uint8_t, oi::kMaxScriptBytes> bytes{};
    std::uint64_t tick = 0;  // of the last Play Script
    bool played = false;
    bool again = false;  // it replays itself from the next tick on
  };
  struct ReleasedAt {
    rt::Duration play{rt::Duration::max()};
    rt::Duration advance{rt::Duration::max()};
  };
  struct Blocked {  // by set_wheels_blocked()
    bool left = false;
    bool right = false;
  };
  struct Requested {
    std::int32_t velocity_mm_s = 0;
    std::int32_t radius_mm = 0;
    std::int32_t right_mm_s = 0;
    std::int32_t left_mm_s = 0;
  };

  struct Chassis {
    Wheels wheels;
    Odometer odometer;
    rt::Duration at{0};  // to where the wheels have been moved
    Blocked blocked{};
    Hardship left{};
    Hardship right{};
  };
  struct DemoState {
    Demos demos{};
    std::int32_t selected = 0;
    std::uint8_t note = 0;
  };

  Parameters parameters_;
  rt::Duration now_{0};
  rt::Duration next_tick_;
  std::uint64_t ticks_ = 0;
  Supply supply_{};
  Serial serial_;

  oi::Mode mode_ = oi::Mode::off;
  Inputs inputs_{};
  Inputs seen_{};  // the inputs at the last tick
  ReleasedAt released_at_{};
  Chassis chassis_;
  Requested requested_{};
  Battery battery_;
  StreamSender stream_{};
  SongPlayer songs_{};
  Melody own_sound_{};  // a beep or a tune, not a song of the Open Interface
  Actuators actuators_{};
  Script script_{};
  Wait wait_{};
  Reply reply_{};
  DemoState demo_{};
  std::optional<SafetyCondition> last_safety_condition_{};
  DeviceFaults faults_{};
  Random junk_;
  DeviceCounters counters_{};
};

}  // namespace cargobay::hal::sim
