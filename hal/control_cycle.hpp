// The real-time path: woken by a frame, it estimates, controls and answers with DriveDirect, in one
// pass on one thread. One wait, one read and one write a frame in the steady state; no heap, no
// lock, no page fault.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/byte_stream.hpp"
#include "hal/frame_lists.hpp"
#include "hal/guard_mark.hpp"
#include "oi/command_table.hpp"
#include "oi/fixed_list.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/histogram.hpp"
#include "rt/mailbox.hpp"
#include "rt/ring.hpp"
#include "rt/setpoint_cell.hpp"
#include "rt/tick_clock.hpp"
#include "rt/wheel_loop.hpp"

namespace cargobay::hal {

// Why the cycle ended.
enum class CycleEnd : std::uint8_t {
  asked,      // request_stop()
  link_lost,  // no frame for longer than link_timeout
  mode_lost,  // the robot left the mode it was driven in: cliff, wheel drop, charger, or its button
  hung_up,    // the port is gone, or takes nothing any more
  guarded,    // the cycle stood still for so long that its guard stopped the robot
};

// One tick of the loop, as others see it.
struct CycleState {
  std::int64_t tick = 0;    // of the robot, since the first frame
  rt::TimePoint arrival{};  // of the frame, on the stream's clock
  oi::Mode mode = oi::Mode::off;
  rt::WheelSpeeds set{};  // behind the acceleration limit
  rt::WheelSpeeds estimate{};
  rt::WheelSpeeds command{};  // as sent
  rt::RemainderBelief remainder = rt::RemainderBelief::unknown;
  bool setpoint_lapsed = false;
  std::int32_t battery_mv = 0;  // 0 until the first frame that tells
};

// Behind the first frame each tick of the robot is counted once: good, bad or lost. What may still
// be on its way when the cycle ends is not counted; when the link is lost, nothing is.
struct FrameCounters {
  std::uint64_t good = 0;
  std::uint64_t bad = 0;   // damaged on the way
  std::uint64_t lost = 0;  // never came, damaged ones not included
  std::uint64_t late = 0;  // deadlines that passed without a frame
};

// Called once a frame on the control thread, between estimate and command: returns the wheel speeds
// wanted. It must not block, lock, allocate or throw. `seconds` is robot time since the first
// frame.
struct ControlFunction {
  rt::WheelSpeeds (*function)(void* context, const CycleState& state,
                              double seconds) noexcept CARGOBAY_NONBLOCKING = nullptr;
  void* context = nullptr;  // outlives the cycle
};

class ControlCycle {
 public:
  struct Parameters {
    rt::WheelLoop::Parameters loop{};
    oi::Mode drive_mode = oi::Mode::safe;  // safe or full: where the robot must stay
    rt::Duration late_margin = std::chrono::milliseconds{5};   // after which a frame is late
    rt::Duration stop_after = std::chrono::milliseconds{150};  // of silence: the wheels are stopped
    rt::Duration link_timeout = std::chrono::seconds{1};       // of silence: the cycle ends
    rt::Duration setpoint_lapse = std::chrono::milliseconds{500};
  };
  static constexpr std::size_t kHistory = 4096;  // about a minute of states

  // `stream` outlives the cycle; the robot on it streams frame lists already (hal/bring_up.hpp).
  ControlCycle(ByteStream& stream, const Parameters& parameters);

  // To be set before run(). Without one, the latest setpoint is followed.
  void set_control(const ControlFunction& control) { control_ = control; }

  // To be set before run(); what the mark is of outlives it. Without one nobody watches.
  void set_guard(const GuardMark& guard) { guard_ = guard; }

  // Runs until something ends it. The last thing it sends, where the robot still listens, is
  // DriveDirect 0 0; the mode stays as it is. Once only.
  CycleEnd run() noexcept CARGOBAY_NONBLOCKING;

  // From any thread, also from a signal handler.
  void request_stop() noexcept CARGOBAY_NONBLOCKING {
    stop_requested_.store(true, std::memory_order_relaxed);
  }
  // From any thread. False for speeds that are no number or beyond the robot's range. A setpoint
  // lapses after setpoint_lapse, and the wheels stop.
  [[nodiscard]] bool set_speeds(const rt::WheelSpeeds& speeds) noexcept CARGOBAY_NONBLOCKING;

  // From any thread: for so long from now the robot's silence is no lost link, as while it plays a
  // script that waits. The wheels get their stop all the same, should it listen.
  void expect_silence(rt::Duration duration) noexcept CARGOBAY_NONBLOCKING {
    expected_until_.store(stream_.now() + duration, std::memory_order_relaxed);
  }

  // From any thread.
  std::optional<CycleState> state() const noexcept CARGOBAY_NONBLOCKING { return state_.get(); }
  // From one other thread: the states of all ticks, oldest first; false where there is none.
  bool next_state(CycleState& state) noexcept CARGOBAY_NONBLOCKING { return history_.pop(state); }

  // After run() has returned.
  const FrameCounters& frames() const { return frames_; }
  const rt::Histogram& period_ns() const { return period_ns_; }
  const rt::Histogram& frame_to_command_ns() const { return frame_to_command_ns_; }
  // Commands that the port did not take whole.
  std::uint64_t unsent_commands() const { return unsent_; }
  // Commands not sent because the robot might have got them in the same tick as the one before.
  std::uint64_t withheld_commands() const { return withheld_; }

 private:
  enum class Step : std::uint8_t { on, ended };
  enum class Sent : std::uint8_t { whole, not_whole, withheld, failed };
  enum class Lists : std::uint8_t { as_before, changed };
  static constexpr std::size_t kReceiveBytes = 1024;
  // One entry a frame: what it says of the counters.
  using Readings = oi::FixedList<std::optional<rt::WheelEstimator::Reading>, kReceiveBytes / 4>;

  Step receive() noexcept CARGOBAY_NONBLOCKING;
  rt::TimePoint wake_time() const noexcept CARGOBAY_NONBLOCKING;
  Readings decode(std::span<const std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING;
  void take(oi::StreamDecoder::Outcome outcome, Readings& readings) noexcept CARGOBAY_NONBLOCKING;
  void give_up_open_frame(Readings& readings) noexcept CARGOBAY_NONBLOCKING;
  std::optional<rt::WheelEstimator::Reading> take_frame() noexcept CARGOBAY_NONBLOCKING;
  Step answer(rt::TimePoint arrival, const Readings& readings) noexcept CARGOBAY_NONBLOCKING;
  void account(rt::TimePoint arrival, const Readings& readings) noexcept CARGOBAY_NONBLOCKING;
  void take_back(std::uint64_t frames) noexcept CARGOBAY_NONBLOCKING;
  std::int64_t silent_ticks() const noexcept CARGOBAY_NONBLOCKING;
  void stop_in_silence() noexcept CARGOBAY_NONBLOCKING;
  bool as_told() const noexcept CARGOBAY_NONBLOCKING;
  void account_for_silence() noexcept CARGOBAY_NONBLOCKING;
  Step control(CycleState& state) noexcept CARGOBAY_NONBLOCKING;
  Step late() noexcept CARGOBAY_NONBLOCKING;
  bool tick_has_command(rt::TimePoint now) const noexcept CARGOBAY_NONBLOCKING;
  Sent send(const rt::WheelSpeeds& command, Lists lists) noexcept CARGOBAY_NONBLOCKING;
  void stop_wheels() noexcept CARGOBAY_NONBLOCKING;
  rt::WheelSpeeds wanted(const CycleState& state) noexcept CARGOBAY_NONBLOCKING;
  bool setpoint_lapsed(rt::TimePoint now) noexcept CARGOBAY_NONBLOCKING;
  Step end(CycleEnd why) noexcept CARGOBAY_NONBLOCKING {
    end_ = why;
    return Step::ended;
  }

  ByteStream& stream_;
  Parameters parameters_;
  rt::Duration frame_time_;    // on the wire
  rt::Duration command_time_;  // the same
  ControlFunction control_{};
  GuardMark guard_{};
  rt::WheelLoop loop_;
  rt::TickClock ticks_;
  oi::StreamDecoder decoder_{};
  oi::SensorValues sensors_{};
  std::array<std::uint8_t, kReceiveBytes> received_{};

  bool list_reads_ = true;  // the list that the robot was last told to stream reads the counters
  bool former_list_reads_ = true;  // the one before it, which may still be in a frame on its way
  bool misheard_ = false;          // the last frame is of neither
  oi::Mode mode_;                  // as the robot last said
  int ticks_since_reads_ = 0;      // since one of the two read them
  std::uint64_t damaged_ = 0;      // bad frames that the tick clock has not missed yet
  rt::TimePoint last_arrival_{};   // of a frame
  rt::TimePoint last_bytes_{};
  rt::TimePoint last_command_{};
  rt::TimePoint deadline_{};
  bool stopped_in_silence_ = false;
  int foreseen_ = 0;  // ticks of a silence that the loop has gone through, counted or not
  rt::TimePoint setpoint_time_{};
  std::uint32_t setpoint_serial_ = 0;
  std::int32_t battery_mv_ = 0;
  CycleEnd end_ = CycleEnd::asked;

  FrameCounters frames_{};
  rt::Histogram period_ns_{};
  rt::Histogram frame_to_command_ns_{};
  std::uint64_t unsent_ = 0;
  std::uint64_t withheld_ = 0;

  std::atomic<bool> stop_requested_{false};
  std::atomic<rt::TimePoint> expected_until_{
      rt::TimePoint{}};  // of a silence; carries nothing else
  rt::SetpointCell setpoint_{};
  rt::Mailbox<CycleState> state_{};
  rt::SpscRing<CycleState, kHistory> history_{};
};

}  // namespace cargobay::hal
