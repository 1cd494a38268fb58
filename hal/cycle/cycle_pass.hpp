// What a control cycle (hal/cycle/control_cycle.hpp, which says what each function does) is made
// of: FrameReceiver extracts frames from bytes, TickLedger counts ticks, Setpoint and UserControl
// say what is wanted, CommandSender sends. This class runs the pass; its parts do the work.
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
#include "hal/sensing/limit_watch.hpp"
#include "hal/sensing/mode_watch.hpp"
#include "hal/sensing/power_watch.hpp"
#include "hal/sensing/sensor_board.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/both_odometries.hpp"
#include "rt/histogram.hpp"
#include "rt/wheel_loop.hpp"

namespace cargobay::hal {

class CyclePass {
 public:
  CyclePass(ByteStream& stream, const CycleParameters& parameters);

  CycleEnd run() CARGOBAY_NONBLOCKING;
  void begin() CARGOBAY_NONBLOCKING;
  [[nodiscard]] bool pass() CARGOBAY_NONBLOCKING;
  CycleEnd finish() CARGOBAY_NONBLOCKING;

 private:
  friend class ControlCycle;  // its other functions only reach into the parts
  enum class Step : std::uint8_t { on, ended };
  using Sent = CommandSender::Sent;

  Step pass_once() CARGOBAY_NONBLOCKING;
  rt::TimePoint wake_time() const CARGOBAY_NONBLOCKING;
  Step look_after_guard(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  void see_frame(const oi::SensorValues& frame) CARGOBAY_NONBLOCKING;
  Step see_wheels() CARGOBAY_NONBLOCKING;
  void see_limits(CycleState& state) CARGOBAY_NONBLOCKING;
  void see_bumps(const oi::SensorValues& frame, std::int64_t tick) CARGOBAY_NONBLOCKING;
  Step answer(rt::TimePoint arrival) CARGOBAY_NONBLOCKING;
  void take_requests() CARGOBAY_NONBLOCKING;
  void take_request(const Request& request) CARGOBAY_NONBLOCKING;
  void account(rt::TimePoint arrival) CARGOBAY_NONBLOCKING;
  void step_through(const TickLedger::Account& account) CARGOBAY_NONBLOCKING;
  CycleState state_at(rt::TimePoint arrival) const CARGOBAY_NONBLOCKING;
  Step answer_in_mode(CycleState& state) CARGOBAY_NONBLOCKING;
  Step control(CycleState& state) CARGOBAY_NONBLOCKING;
  Step hold() CARGOBAY_NONBLOCKING;
  Step deadline_passed() CARGOBAY_NONBLOCKING;
  void stop_in_silence(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  Step send_owed_stop(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  FrameList next_list() CARGOBAY_NONBLOCKING;
  bool setpoint_lapsed(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  ControlAnswer by_setpoint(rt::TimePoint now) CARGOBAY_NONBLOCKING;
  void see_refusal() CARGOBAY_NONBLOCKING;
  CommandSender::Moment moment(rt::TimePoint now) const CARGOBAY_NONBLOCKING;
  void stop_wheels() CARGOBAY_NONBLOCKING;
  // Rare: kept out of what each frame runs through.
  [[gnu::noinline]] void report(const Event& event, std::int64_t tick) CARGOBAY_NONBLOCKING;
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
  CycleParameters parameters_;
  rt::Duration frame_time_;  // on the wire
  UserControl control_;
  StateObserver observer_{};
  CycleCounters counters_{};
  TickLedger ledger_;
  rt::WheelLoop loop_;
  rt::BothOdometries odometry_;
  CommandSender sender_;
  Setpoint setpoint_;
  Silence silence_;
  ModeWatch mode_watch_;
  PowerWatch power_;
  // What has been seen and reported.
  struct Seen {
    Bumps bumps{};
    LimitWatch limits{};
    bool wheels = false;
  };
  Seen seen_{};
  bool steered_ = false;  // by the control function, not by setpoints
  Hazards mode_loss_causes_{};
  struct Wait {
    rt::TimePoint until{};
    bool left = false;  // before it was over: goes on in the next pass
    rt::TimePoint woken{};
  };
  Wait wait_{};
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
