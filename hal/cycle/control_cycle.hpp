// The real-time path: woken by a frame, it estimates, controls and answers with DriveDirect, in one
// pass on one thread. One wait, one read and one write per frame in the steady state; no heap, no
// lock, no page fault.
//
// This class runs the pass; its parts do the work: FrameReceiver extracts frames from bytes,
// TickLedger counts ticks, Setpoint and UserControl say what is wanted, CommandSender sends.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "hal/cycle/command_sender.hpp"
#include "hal/cycle/cycle_outlets.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/cycle/frame_receiver.hpp"
#include "hal/cycle/request.hpp"
#include "hal/cycle/setpoint.hpp"
#include "hal/cycle/silence.hpp"
#include "hal/cycle/tick_ledger.hpp"
#include "hal/cycle/user_control.hpp"
#include "hal/guard/guard_mark.hpp"
#include "hal/sensing/events.hpp"
#include "hal/sensing/mode_watch.hpp"
#include "hal/sensing/power_watch.hpp"
#include "hal/sensing/sensor_board.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/histogram.hpp"
#include "rt/odometry.hpp"
#include "rt/wheel_loop.hpp"

namespace cargobay::hal {

class ControlCycle {
 public:
  using Parameters = CycleParameters;
  static constexpr std::size_t kHistory = CycleOutlets::kHistory;
  static constexpr std::size_t kLongestOwnRest = CommandSender::kLongestOwnRest;

  // `stream` must outlive the cycle and keep its rate; its robot must already stream frame lists
  // (hal/bring_up/bring_up.hpp).
  ControlCycle(ByteStream& stream, const Parameters& parameters);

  // Call before run(). Without one, the latest setpoint is followed.
  void set_control(const ControlFunction& control) { control_.set(control); }
  // Call before run().
  void set_observer(const StateObserver& observer) { observer_ = observer; }

  // Call before run(); the mark's guard must outlive the cycle. Without a mark, no guard watches.
  void set_guard(const GuardMark& guard) { sender_.set_guard(guard); }

  // Runs until something ends it. The last thing it sends, if the robot still listens, is
  // DriveDirect 0 0; the mode does not change. Call only once.
  CycleEnd run() CARGOBAY_NONBLOCKING;
  // The same in steps, for a stream in virtual time: begin(), then pass() until it is false, then
  // finish().
  void begin() CARGOBAY_NONBLOCKING;
  [[nodiscard]] bool pass() CARGOBAY_NONBLOCKING;
  CycleEnd finish() CARGOBAY_NONBLOCKING;

  // From any thread, and from a signal handler.
  void request_stop() CARGOBAY_NONBLOCKING {
    stop_requested_.store(true, std::memory_order_relaxed);
  }
  // From any thread: nothing more is written, whatever a hung control thread does if it resumes. A
  // write in progress still goes out.
  void abandon() CARGOBAY_NONBLOCKING { sender_.abandon(); }
  // From any thread: when the control thread last woke; nothing before the first time.
  std::optional<rt::TimePoint> last_pass() const CARGOBAY_NONBLOCKING {
    const std::int64_t passed_ns = passed_ns_.load(std::memory_order_relaxed);
    if (passed_ns == 0) return std::nullopt;
    return rt::TimePoint{rt::Duration{passed_ns}};
  }
  // From any thread. False for speeds that are not numbers or beyond the robot's range. A setpoint
  // lapses after setpoint_lapse, and when the robot loses its mode; then the wheels stop until a
  // new one is set.
  [[nodiscard]] bool set_speeds(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
    return within_range(speeds) && setpoint_.put(speeds);
  }

  // From any thread: for `duration` from the next pass on, silence does not mean a lost link, for
  // example while the robot plays a script that waits. The wheels get their stop all the same, in
  // case the robot listens.
  void expect_silence(rt::Duration duration) CARGOBAY_NONBLOCKING { silence_.announce(duration); }

  // From any thread. If the mode was lost and the cycle holds: tells the robot to go back to it,
  // once, and drives again when it has. The outcome is reported as an event. Otherwise nothing
  // happens.
  void request_rearm() CARGOBAY_NONBLOCKING {
    rearm_requested_.store(true, std::memory_order_relaxed);
  }

  // From one other thread. False if too many requests are waiting. A command goes out after the
  // loop's own, one per frame, as far as the robot's mode allows it then.
  [[nodiscard]] bool request(const Request& request) CARGOBAY_NONBLOCKING {
    return requests_.push(request);
  }
  // How many bytes of a request go out besides the loop's own commands; for more, the loop pauses.
  std::size_t spare_bytes() const CARGOBAY_NONBLOCKING { return sender_.spare_bytes(); }

  // From any thread.
  std::optional<CycleState> state() const CARGOBAY_NONBLOCKING { return outlets_.state.get(); }
  // From one other thread: the states of all ticks, oldest first; false when there are no more.
  bool next_state(CycleState& state) CARGOBAY_NONBLOCKING { return outlets_.history.pop(state); }
  // The same for the events.
  bool next_event(Event& event) CARGOBAY_NONBLOCKING { return outlets_.events.pop(event); }
  // Events dropped for want of room, because nothing took them. From any thread.
  std::uint64_t events_dropped() const CARGOBAY_NONBLOCKING { return outlets_.events.dropped(); }

  // The last value of each packet. From any thread.
  SensorReadings sensors() const CARGOBAY_NONBLOCKING { return outlets_.board.readings(); }
  // From any thread.
  CycleCounters counters() const CARGOBAY_NONBLOCKING {
    return outlets_.counters.get().value_or(CycleCounters{});
  }

  // While it runs, other threads may only take a snapshot() of these.
  const rt::Histogram& period_ns() const { return outlets_.period_ns; }
  const rt::Histogram& frame_to_command_ns() const { return outlets_.frame_to_command_ns; }
  // After run() has returned.
  const FrameCounters& frames() const { return counters_.frames; }
  // Commands that the port did not take whole.
  std::uint64_t unsent_commands() const { return counters_.unsent; }
  // Commands not sent because the robot might have got them in the same tick as the one before.
  std::uint64_t withheld_commands() const { return counters_.withheld; }
  const PhaseOverruns& overruns() const { return counters_.overruns; }
  // Answers of the control function that no robot can follow.
  std::uint64_t refused_controls() const { return counters_.refused; }
  // Bytes still missing of a command whose beginning the robot has received.
  std::size_t owed_bytes() const { return sender_.owed_bytes(); }
  // If the port hung up, the errno of what failed; EBADF if the descriptor is no longer the port's;
  // 0 if no call gave a reason.
  int port_error() const { return sender_.port_error(); }
  // Why the mode was last lost; none if no sensor showed it.
  Hazards mode_loss_causes() const { return mode_loss_causes_; }

 private:
  enum class Step : std::uint8_t { on, ended };
  using Sent = CommandSender::Sent;

  Step pass_once() CARGOBAY_NONBLOCKING;
  rt::TimePoint wake_time() const CARGOBAY_NONBLOCKING;
  Step look_after_guard(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  void see_frame(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING;
  void see_bumps(const oi::SensorValues& frame, std::int64_t tick) CARGOBAY_NONBLOCKING;
  Step answer(rt::TimePoint arrival) CARGOBAY_NONBLOCKING;
  void take_requests() CARGOBAY_NONBLOCKING;
  void take_request(const Request& request) CARGOBAY_NONBLOCKING;
  void account(rt::TimePoint arrival) CARGOBAY_NONBLOCKING;
  void step_through(const TickLedger::Account& account) CARGOBAY_NONBLOCKING;
  CycleState state_at(rt::TimePoint arrival) const CARGOBAY_NONBLOCKING;
  Step answer_in_mode(CycleState& state) CARGOBAY_NONBLOCKING;
  Step control(CycleState& state) CARGOBAY_NONBLOCKING;
  void send_command(CycleState& state, rt::TimePoint decided) CARGOBAY_NONBLOCKING;
  Step hold() CARGOBAY_NONBLOCKING;
  Step deadline_passed() CARGOBAY_NONBLOCKING;
  void stop_in_silence(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  Step send_owed_stop(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  FrameList next_list() CARGOBAY_NONBLOCKING;
  bool setpoint_lapsed(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  rt::WheelSpeeds wanted(const CycleState& state) CARGOBAY_NONBLOCKING;
  rt::WheelSpeeds ask_control(const CycleState& state) CARGOBAY_NONBLOCKING;
  CommandSender::Moment moment(rt::TimePoint now) const CARGOBAY_NONBLOCKING;
  void stop_wheels() CARGOBAY_NONBLOCKING;
  void report(const Event& event, std::int64_t tick) CARGOBAY_NONBLOCKING {
    outlets_.report(event, tick, woken_);
  }
  void report(EventKind what) CARGOBAY_NONBLOCKING {
    report({.what = what}, ledger_.clock().ticks());
  }
  Step end(CycleEnd why) CARGOBAY_NONBLOCKING {
    end_ = why;
    return Step::ended;
  }
  Step hung_up(int error) CARGOBAY_NONBLOCKING {
    sender_.note_hung_up(error);
    return end(CycleEnd::hung_up);
  }

  ByteStream& stream_;
  Parameters parameters_;
  rt::Duration frame_time_;  // on the wire
  UserControl control_;
  StateObserver observer_{};
  CycleCounters counters_{};
  TickLedger ledger_;
  rt::WheelLoop loop_;
  rt::Odometry odometry_;
  CommandSender sender_;
  Setpoint setpoint_;
  Silence silence_;
  ModeWatch mode_watch_;
  PowerWatch power_;
  Bumps bumps_{};
  Hazards mode_loss_causes_{};
  rt::TimePoint woken_{};
  CycleEnd end_ = CycleEnd::asked;
  // Relaxed, all three: each carries nothing but itself.
  std::atomic<bool> stop_requested_{false};
  std::atomic<bool> rearm_requested_{false};
  std::atomic<std::int64_t> passed_ns_{0};

  // The large ones last, after everything that each pass looks at: three pages of memory instead of
  // seven.
  FrameReceiver receiver_;
  RequestRing requests_{};
  CycleOutlets outlets_{};
};

}  // namespace cargobay::hal
