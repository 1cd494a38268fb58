// The real-time path: woken by a frame, it estimates, controls and answers with DriveDirect, in one
// pass on one thread. One wait, one read and one write a frame in the steady state; no heap, no
// lock, no page fault.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>

#include "hal/cycle/events.hpp"
#include "hal/cycle/frame_lists.hpp"
#include "hal/cycle/frame_rotation.hpp"
#include "hal/cycle/hearing_watch.hpp"
#include "hal/cycle/mode_watch.hpp"
#include "hal/cycle/outgoing.hpp"
#include "hal/cycle/power_watch.hpp"
#include "hal/cycle/request.hpp"
#include "hal/cycle/sensor_board.hpp"
#include "hal/guard/guard_mark.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/command_table.hpp"
#include "oi/fixed_list.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"
#include "rt/histogram.hpp"
#include "rt/mailbox.hpp"
#include "rt/odometry.hpp"
#include "rt/ring.hpp"
#include "rt/setpoint_cell.hpp"
#include "rt/tick_clock.hpp"
#include "rt/wheel_loop.hpp"

namespace cargobay::hal {

// Why the cycle ended.
enum class CycleEnd : std::uint8_t {
  asked,            // request_stop()
  link_lost,        // no frame for longer than link_timeout
  mode_lost,        // the robot left the mode it was driven in: mode_loss_causes()
  hung_up,          // a call on the port failed: it is gone, or no longer ours: port_error()
  guarded,          // the cycle stood still for so long that its guard stopped the robot
  control_overrun,  // the control function was over its budget too many times in a row
  guard_lost,       // the guard is dead or suspended, and nobody would stop the robot in our place
};

// What the cycle does when the robot has left its mode by itself, and the cause has been told.
enum class OnModeLoss : std::uint8_t {
  end,   // it ends
  hold,  // it goes on, driving nothing, until request_rearm() or request_stop()
};

// One tick of the loop, as others see it.
struct CycleState {
  std::int64_t tick = 0;     // of the robot, since the first frame
  rt::TimePoint arrival{};   // of the frame, on the stream's clock
  rt::WheelSpeeds target{};  // as asked for; 0 where nothing valid was
  rt::WheelSpeeds set{};     // behind the acceleration limit
  rt::WheelSpeeds estimate{};
  rt::WheelSpeeds command{};  // as sent
  rt::RemainderBelief remainder = rt::RemainderBelief::unknown;
  oi::Mode mode = oi::Mode::off;
  bool setpoint_lapsed = false;
  Hazards hazards{};  // that this frame tells of, whether or not they stop the robot
  // What the robot said of its counters, where this frame reads them.
  std::optional<rt::WheelEstimator::Reading> reading{};
  std::int32_t battery_mv = 0;  // 0 until the first frame that tells
  Bumps bumps{};                // as the last frame told that has them
  rt::Pose pose{};              // by odometry
  double distance_mm = 0.0;
  rt::PoseCovariance pose_covariance{};
};

// Behind the first frame each tick of the robot is counted once: good, bad or lost. What may still
// be on its way when the cycle ends is not counted; when the link is lost, nothing is.
struct FrameCounters {
  std::uint64_t good = 0;
  std::uint64_t bad = 0;   // damaged on the way
  std::uint64_t lost = 0;  // never came, damaged ones not included
  std::uint64_t late = 0;  // deadlines that passed without a frame
};

// How often a phase of the cycle took longer than it may. Each is counted for itself.
struct PhaseOverruns {
  std::uint64_t wait = 0;   // the frame was here more than late_margin behind its time
  std::uint64_t read = 0;   // taking and understanding it: 1 ms
  std::uint64_t user = 0;   // the control function: control_budget
  std::uint64_t write = 0;  // control and sending: 1 ms
};

// All that is counted, as of one frame.
struct CycleCounters {
  FrameCounters frames{};
  PhaseOverruns overruns{};
  std::uint64_t unsent = 0;    // commands that the port did not take whole
  std::uint64_t withheld = 0;  // not sent: the robot might have got them in the tick of the last
  std::uint64_t refused = 0;   // answers of the control function that no robot can follow
};

// Called once a frame on the control thread, between estimate and command: returns the wheel speeds
// wanted, each within -500 to 500 mm/s; for others the wheels stop, and they are counted. It must
// not block, lock, allocate or throw. `seconds` is robot time since the first frame. While the
// robot has lost its mode it is not called.
struct ControlFunction {
  rt::WheelSpeeds (*function)(void* context, const CycleState& state,
                              double seconds) noexcept CARGOBAY_NONBLOCKING = nullptr;
  void* context = nullptr;  // outlives the cycle
};

// Called once a frame on the control thread, behind the command, with all that became of the tick.
// The rules are those of a ControlFunction.
struct StateObserver {
  void (*function)(void* context, const CycleState& state) noexcept CARGOBAY_NONBLOCKING = nullptr;
  void* context = nullptr;  // outlives the cycle
  // Of each request, when the cycle takes it up; may be null.
  void (*request)(void* context, const Request& request) noexcept CARGOBAY_NONBLOCKING = nullptr;
};

class ControlCycle {
 public:
  struct Parameters {
    // Its estimator's tick_s is the robot's tick: 15 ms, but where the cycle itself is measured.
    rt::WheelLoop::Parameters loop{};
    oi::Mode drive_mode = oi::Mode::safe;  // safe or full: where the robot must stay
    rt::Duration late_margin = std::chrono::milliseconds{5};   // after which a frame is late
    rt::Duration stop_after = std::chrono::milliseconds{150};  // of silence: the wheels are stopped
    rt::Duration link_timeout = std::chrono::seconds{1};       // of silence: the cycle ends
    rt::Duration setpoint_lapse = std::chrono::milliseconds{500};
    // For each call of the control function. At 19200 baud frame, command and a new list take 14 of
    // the tick's 15 ms on the wire: with 2 ms more the command is in its tick still.
    rt::Duration control_budget = std::chrono::milliseconds{2};
    // In a row; one more, and the wheels are stopped and the cycle ends. Ten ticks are the 150 ms
    // that the robot may be silent before the wheels are stopped: no worse to steer by.
    int control_overruns_allowed = 10;
    OnModeLoss on_mode_loss = OnModeLoss::end;
    rt::Odometry::Parameters odometry{};
    PowerWatch::Limits power{};
  };
  static constexpr std::size_t kHistory = 4096;  // about a minute of states
  // Of the loop's own commands, as far as the robot may still wait for it where the line was cut:
  // all of a Drive Direct but its opcode, all ids of a list.
  static constexpr std::size_t kLongestOwnRest =
      std::max(oi::kDriveDirectBytes - 1, kSignalsLeftList.size());

  // `stream` outlives the cycle and keeps its rate; the robot on it streams frame lists already
  // (hal/bring_up/bring_up.hpp).
  ControlCycle(ByteStream& stream, const Parameters& parameters);

  // To be set before run(). Without one, the latest setpoint is followed.
  void set_control(const ControlFunction& control) { control_ = control; }
  // To be set before run().
  void set_observer(const StateObserver& observer) { observer_ = observer; }

  // To be set before run(); what the mark is of outlives it. Without one nobody watches.
  void set_guard(const GuardMark& guard) { guard_ = guard; }

  // Runs until something ends it. The last thing it sends, where the robot still listens, is
  // DriveDirect 0 0; the mode stays as it is. Once only.
  CycleEnd run() noexcept CARGOBAY_NONBLOCKING;
  // The same in steps, for a stream in virtual time: begin(), then pass() until it is false, then
  // finish().
  void begin() noexcept CARGOBAY_NONBLOCKING;
  [[nodiscard]] bool pass() noexcept CARGOBAY_NONBLOCKING;
  CycleEnd finish() noexcept CARGOBAY_NONBLOCKING;

  // From any thread, also from a signal handler.
  void request_stop() noexcept CARGOBAY_NONBLOCKING {
    stop_requested_.store(true, std::memory_order_relaxed);
  }
  // From any thread: nothing is written any more, whatever the control thread does when it comes
  // back from where it hangs. What it writes at this very moment still goes out.
  void abandon() noexcept CARGOBAY_NONBLOCKING { abandoned_.store(true); }
  // From any thread: when the control thread last woke; nothing before the first time.
  std::optional<rt::TimePoint> last_pass() const noexcept CARGOBAY_NONBLOCKING {
    const std::int64_t passed_ns = passed_ns_.load(std::memory_order_relaxed);
    if (passed_ns == 0) return std::nullopt;
    return rt::TimePoint{rt::Duration{passed_ns}};
  }
  // From any thread. False for speeds that are no number or beyond the robot's range. A setpoint
  // lapses after setpoint_lapse, and when the robot loses its mode; then the wheels stop, and stay
  // so until a new one is set.
  [[nodiscard]] bool set_speeds(const rt::WheelSpeeds& speeds) noexcept CARGOBAY_NONBLOCKING;

  // From any thread: for so long from the next pass on the robot's silence is no lost link, as
  // while it plays a script that waits. The wheels get their stop all the same, should it listen.
  void expect_silence(rt::Duration duration) noexcept CARGOBAY_NONBLOCKING {
    announced_silence_.store(duration, std::memory_order_relaxed);
  }

  // From any thread. Where the mode was lost and the cycle holds: tells the robot to go back to it,
  // once, and drives on when it has. What comes of it is an event. Otherwise nothing happens.
  void request_rearm() noexcept CARGOBAY_NONBLOCKING {
    rearm_requested_.store(true, std::memory_order_relaxed);
  }

  // From one other thread. False where too many wait already. A command goes out behind the loop's
  // own, one a frame, as far as the robot's mode allows it then.
  [[nodiscard]] bool request(const Request& request) noexcept CARGOBAY_NONBLOCKING {
    return requests_.push(request);
  }
  // So many bytes of a request go out beside the loop's own commands; for more it has to pause.
  std::size_t spare_bytes() const noexcept CARGOBAY_NONBLOCKING { return spare_bytes_; }

  // From any thread.
  std::optional<CycleState> state() const noexcept CARGOBAY_NONBLOCKING { return state_.get(); }
  // From one other thread: the states of all ticks, oldest first; false where there is none.
  bool next_state(CycleState& state) noexcept CARGOBAY_NONBLOCKING { return history_.pop(state); }
  // The same for the events.
  bool next_event(Event& event) noexcept CARGOBAY_NONBLOCKING { return events_.pop(event); }
  // Events that found no room, because nobody took them. From any thread.
  std::uint64_t events_dropped() const noexcept CARGOBAY_NONBLOCKING { return events_.dropped(); }

  // What each packet said last. From any thread.
  SensorReadings sensors() const noexcept CARGOBAY_NONBLOCKING { return board_.readings(); }
  // From any thread.
  CycleCounters counters() const noexcept CARGOBAY_NONBLOCKING {
    return counters_mail_.get().value_or(CycleCounters{});
  }

  // While it runs, from another thread, only a snapshot() of these.
  const rt::Histogram& period_ns() const { return period_ns_; }
  const rt::Histogram& frame_to_command_ns() const { return frame_to_command_ns_; }
  // After run() has returned.
  const FrameCounters& frames() const { return counters_.frames; }
  // Commands that the port did not take whole.
  std::uint64_t unsent_commands() const { return counters_.unsent; }
  // Commands not sent because the robot might have got them in the same tick as the one before.
  std::uint64_t withheld_commands() const { return counters_.withheld; }
  const PhaseOverruns& overruns() const { return counters_.overruns; }
  // Answers of the control function that no robot can follow.
  std::uint64_t refused_controls() const { return counters_.refused; }
  // Bytes of a command that the robot has got the beginning of.
  std::size_t owed_bytes() const { return outgoing_.bytes().size(); }
  // The errno of what failed where the port hung up; EBADF where the descriptor is no longer the
  // port's; 0 where nothing said more.
  int port_error() const { return port_error_; }
  // Why the mode was lost, the last time that it was; none where no sensor said.
  Hazards mode_loss_causes() const { return mode_loss_causes_; }

 private:
  enum class Step : std::uint8_t { on, ended };
  enum class Sent : std::uint8_t { whole, not_whole, withheld, failed };
  static constexpr std::size_t kReceiveBytes = 1024;
  // One entry a frame: what it says of the counters.
  using Readings = oi::FixedList<std::optional<rt::WheelEstimator::Reading>, kReceiveBytes / 4>;

  Step receive() noexcept CARGOBAY_NONBLOCKING;
  rt::TimePoint wake_time() const noexcept CARGOBAY_NONBLOCKING;
  void decode(std::span<const std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING;
  void take(oi::StreamDecoder::Outcome outcome) noexcept CARGOBAY_NONBLOCKING;
  void give_up_open_frame() noexcept CARGOBAY_NONBLOCKING;
  std::optional<rt::WheelEstimator::Reading> take_frame() noexcept CARGOBAY_NONBLOCKING;
  Step answer(rt::TimePoint arrival) noexcept CARGOBAY_NONBLOCKING;
  void account(rt::TimePoint arrival) noexcept CARGOBAY_NONBLOCKING;
  void account_for_ticks(rt::TimePoint arrival, int frames) noexcept CARGOBAY_NONBLOCKING;
  bool reading_is_doubtful() const noexcept CARGOBAY_NONBLOCKING;
  std::uint64_t newly_damaged(rt::TimePoint arrival) noexcept CARGOBAY_NONBLOCKING;
  void take_back(std::uint64_t frames) noexcept CARGOBAY_NONBLOCKING;
  std::int64_t silent_ticks() const noexcept CARGOBAY_NONBLOCKING;
  void stop_in_silence() noexcept CARGOBAY_NONBLOCKING;
  std::optional<FrameList> list_of_frame() const noexcept CARGOBAY_NONBLOCKING;
  void account_for_silence() noexcept CARGOBAY_NONBLOCKING;
  Step answer_in_mode(CycleState& state) noexcept CARGOBAY_NONBLOCKING;
  Step control(CycleState& state) noexcept CARGOBAY_NONBLOCKING;
  Step hold() noexcept CARGOBAY_NONBLOCKING;
  Step late() noexcept CARGOBAY_NONBLOCKING;
  FrameList next_list() noexcept CARGOBAY_NONBLOCKING;
  void publish(const CycleState& state) noexcept CARGOBAY_NONBLOCKING;
  void take_requests() noexcept CARGOBAY_NONBLOCKING;
  void take(const Request& request) noexcept CARGOBAY_NONBLOCKING;
  void add_command() noexcept CARGOBAY_NONBLOCKING;
  std::size_t longest_rest() const noexcept CARGOBAY_NONBLOCKING;
  bool on_time() const noexcept CARGOBAY_NONBLOCKING;
  bool tick_has_command(rt::TimePoint sent) const noexcept CARGOBAY_NONBLOCKING;
  Sent send(const rt::WheelSpeeds& command, FrameList list,
            rt::TimePoint now) noexcept CARGOBAY_NONBLOCKING;
  bool bytes_are_missing(std::int64_t ticks) const noexcept CARGOBAY_NONBLOCKING;
  void add_list(FrameList list) noexcept CARGOBAY_NONBLOCKING;
  std::size_t fill() const noexcept CARGOBAY_NONBLOCKING;
  // For all that is known.
  bool hears() const noexcept CARGOBAY_NONBLOCKING {
    return !hearing_in_doubt_ && !hearing_.misheard() && !hearing_.deaf();
  }
  rt::Duration fill_time(std::size_t zeros) const noexcept CARGOBAY_NONBLOCKING {
    return static_cast<std::int64_t>(zeros) * byte_time_;
  }
  Sent write_out(rt::TimePoint now) noexcept CARGOBAY_NONBLOCKING;
  Step hung_up(int error) noexcept CARGOBAY_NONBLOCKING;
  void stop_wheels() noexcept CARGOBAY_NONBLOCKING;
  rt::WheelSpeeds wanted(const CycleState& state) noexcept CARGOBAY_NONBLOCKING;
  rt::WheelSpeeds ask_control(const CycleState& state) noexcept CARGOBAY_NONBLOCKING;
  bool setpoint_lapsed(rt::TimePoint now) noexcept CARGOBAY_NONBLOCKING;
  void watch(const oi::SensorValues& frame, std::int64_t tick) noexcept CARGOBAY_NONBLOCKING;
  void watch_bumps(const oi::SensorValues& frame, std::int64_t tick) noexcept CARGOBAY_NONBLOCKING;
  void tell(Event event, std::int64_t tick) noexcept CARGOBAY_NONBLOCKING;
  void tell(EventKind what) noexcept CARGOBAY_NONBLOCKING { tell({.what = what}, ticks_.ticks()); }
  Step end(CycleEnd why) noexcept CARGOBAY_NONBLOCKING {
    end_ = why;
    return Step::ended;
  }

  ByteStream& stream_;
  Parameters parameters_;
  rt::Duration tick_;
  rt::Duration way_around_;    // what lies between port and robot may add, both ways together
  rt::Duration frame_time_;    // on the wire
  rt::Duration command_time_;  // the same
  rt::Duration byte_time_;     // the same
  std::size_t spare_bytes_;    // beside the loop's own commands
  std::size_t most_fill_;      // zeros in front of a command that leave it in its tick
  ControlFunction control_{};
  GuardMark guard_{};
  StateObserver observer_{};
  rt::WheelLoop loop_;
  rt::Odometry odometry_;
  rt::TickClock ticks_;
  oi::StreamDecoder decoder_{};
  oi::SensorValues sensors_{};
  Bumps bumps_{};

  FrameRotation rotation_{};
  FrameList list_ = FrameList::reading;         // that the robot was last told to stream
  FrameList former_list_ = FrameList::reading;  // may still be in a frame on its way
  HearingWatch hearing_{list_};
  bool hearing_in_doubt_ = false;  // the line was dead since it was filled up
  bool list_in_doubt_ = false;     // filled up, and not told since
  int ticks_since_reads_ = 0;      // since one of the two read the counters
  std::uint64_t corrupt_ = 0;      // candidates, since the last frame
  std::uint64_t bytes_ = 0;        // received by the last arrival of a frame
  std::uint64_t skipped_ = 0;      // of these, in no frame
  std::uint64_t damaged_ = 0;      // bad frames that the tick clock has not missed yet
  rt::TimePoint woken_{};
  rt::TimePoint last_arrival_{};  // of a frame
  rt::TimePoint last_bytes_{};
  rt::TimePoint last_command_{};
  Outgoing outgoing_{};
  rt::WheelSpeeds acting_{};  // the last command that the robot got whole
  rt::TimePoint deadline_{};
  bool stopped_in_silence_ = false;
  rt::TimePoint expected_until_{};  // the end of a silence that was announced
  int foreseen_ = 0;        // ticks of a silence that the loop has gone through, counted or not
  bool stop_owed_ = false;  // the port has not taken it whole
  rt::TimePoint setpoint_time_{};
  std::uint32_t setpoint_serial_ = 0;
  bool setpoint_alive_ = false;
  bool control_was_sane_ = true;
  bool late_ = false;          // the frame that is answered
  int overruns_in_a_row_ = 0;  // of the control function
  ModeWatch mode_watch_;
  PowerWatch power_;
  Hazards mode_loss_causes_{};
  CycleEnd end_ = CycleEnd::asked;
  int port_error_ = 0;

  CycleCounters counters_{};

  std::atomic<bool> stop_requested_{false};
  std::atomic<bool> abandoned_{false};
  std::atomic<std::int64_t> passed_ns_{0};
  std::atomic<bool> rearm_requested_{false};
  // Not taken up yet by the control thread; it alone looks at the clock. Carries nothing else.
  static constexpr rt::Duration kNoneAnnounced = rt::Duration::min();
  std::atomic<rt::Duration> announced_silence_{kNoneAnnounced};
  std::optional<Request> command_{};  // waits for room on the line
  rt::TimePoint line_free_{};         // behind a long command
  rt::TimePoint last_request_{};      // a command: when it was sent, and all of it but its opcode
  std::size_t last_request_rest_ = 0;
  rt::SetpointCell setpoint_{};

  // The large ones, behind all that each pass looks at: three pages of memory instead of seven.
  SensorBoard board_{};
  std::array<std::uint8_t, kReceiveBytes> received_{};
  Readings readings_{};  // of the frames that this pass received
  RequestRing requests_{};
  rt::Mailbox<CycleState> state_{};
  rt::Mailbox<CycleCounters> counters_mail_{};
  rt::Histogram period_ns_{};
  rt::Histogram frame_to_command_ns_{};
  rt::SpscRing<CycleState, kHistory> history_{};
  EventRing events_{};
};

}  // namespace cargobay::hal
