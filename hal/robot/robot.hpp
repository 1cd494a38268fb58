// A Create under control: brought up, driven by the real-time thread, and left standing in Passive.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "hal/bring_up/bring_up.hpp"
#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/cycle/request.hpp"
#include "hal/guard/duty.hpp"
#include "hal/guard/guard.hpp"
#include "hal/learnt/learnt_keeper.hpp"
#include "hal/recording/exchange.hpp"
#include "hal/recording/flight_recorder.hpp"
#include "hal/recording/recording_header.hpp"
#include "hal/recording/recording_stream.hpp"
#include "hal/result.hpp"
#include "hal/robot/port_watch.hpp"
#include "hal/sensing/sensor_board.hpp"
#include "hal/stream/byte_stream.hpp"
#include "rt/doorbell.hpp"
#include "rt/histogram.hpp"
#include "rt/realtime.hpp"

namespace cargobay::hal {

struct RobotOptions {
  CycleParameters cycle = defaults_for(oi::kCreate);
  rt::RealtimeRequest realtime{};
  bool require_realtime = false;  // a refusal by the kernel is a failure, not a remark
  GuardOptions guard{};           // for a robot on a terminal; virtual time has no guard
  // What an earlier drive learnt of the wheels, unless `cycle` has a prior already; and where this
  // one is to keep what it learns: once a minute in real time, and at the end.
  LearntPlace learnt{};
  std::size_t recorder_bytes = FlightRecorder::kDefaultBytes;  // of memory, for the last events
  // For the bring-up, as in BringUpRequest; the pins are not touched after open().
  RobotPins pins{};
  std::function<void(const BringUpEvent&)> progress{};
  std::function<bool()> cancelled{};
  // Called on the control thread, in their order, after the robot's own; events of the port come
  // from another thread. `request` is not called.
  std::vector<StateObserver> observers{};
  // What the observers and the control function touch; locked with the loop's own.
  std::vector<rt::Memory> memory{};
  // Kept as long as the robot, whose control thread may never come back.
  std::vector<std::shared_ptr<const void>> kept{};
};

// Call all functions from one thread, unless the ControlCycle says otherwise.
class Robot {
 public:
  // Stops it, and frees nothing if the control thread is lost(): it may come back to the robot.
  struct Deleter {
    void operator()(Robot* robot) const;
  };
  using Owned = std::unique_ptr<Robot, Deleter>;

  // Starts the guard and brings the robot up at the stream's rate; blocks as bring_up() does. After
  // a failure the robot has been told to stop and go Passive, by the guard if need be; the message
  // says so if it may be moving. The stream is closed. The code is a Trouble or the system's.
  static Result<Owned> open(std::unique_ptr<ByteStream> stream, const RobotOptions& options);
  // Stops, unless stop() was called.
  ~Robot();
  Robot(const Robot&) = delete;
  Robot& operator=(const Robot&) = delete;

  // Starts the real-time thread; call once. A failure leaves the robot standing; its code is
  // Trouble::guard, Trouble::no_thread, or operation_not_permitted for rights that are required.
  Result<rt::RealtimeGrant> start(const ControlFunction& control);
  // The same in virtual time: no thread. step() runs the cycle on the calling thread until it has
  // answered a frame, has ended, or `deadline` on the stream's clock has passed.
  void start_stepped(const ControlFunction& control);
  enum class Stepped : std::uint8_t { frame, timed_out, ended };
  Stepped step(rt::TimePoint deadline);
  // The running cycle: state, setpoints, request_stop().
  ControlCycle& cycle() { return *cycle_; }
  const BringUpReport& bring_up_report() const { return report_; }
  // From one other thread: events of the robot or its port, oldest first; false if there are none.
  // Locks.
  bool next_event(Event& event) { return cycle_->next_event(event) || port_watch_.next(event); }
  // What the cycle has received and done lately, for hal/recording/recording_file.hpp; from any
  // thread.
  const FlightRecorder& flight_recorder() const { return recorder_; }
  // What the drive began from; nothing if from nothing.
  const std::optional<rt::LearntPlant>& began_from() const {
    return options_.cycle.loop.estimator.prior;
  }
  // What the next drive should begin from; nothing if this one has not learnt enough.
  std::optional<rt::LearntPlant> learnt() const { return keeper_.result(cycle_->learnt()); }
  // One line: why the file of LearntPlace could not be used or, after stop(), written; else empty.
  const std::string& learnt_remark() const { return keeper_.remark(); }
  // The header of a recording that begins now.
  RecordingHeader recording_header() const;

  struct Farewell {
    CycleEnd end = CycleEnd::asked;
    Discharge robot{};             // what became of it
    bool abandoned = false;        // the control thread has not come back
    Hazards causes{};              // of mode_lost; none if no sensor said why
    int port_error = 0;            // errno of the call that ended the cycle; 0 if none did
    std::vector<Exchange> last{};  // the last kLastFrames, if the cycle ended by itself
  };
  static constexpr std::size_t kLastFrames = 10;
  // Ends the cycle and its thread. The thread leaves the robot as soon as the cycle has ended, for
  // whatever reason, even if this is not called. Blocks for up to 2 s, at 19200 baud 3 s. A control
  // thread that has not come back from the control function within kLoopEnds is abandoned: the
  // robot is left without it, and from then on nothing that the thread does reaches the robot.
  Farewell stop();
  static constexpr rt::Duration kLoopEnds = std::chrono::milliseconds{500};
  // After stop(): whether the control thread was abandoned and is still away. Once this is true,
  // this object, with all that it refers to, belongs to the thread and must stay.
  [[nodiscard]] bool lost();
  // The loop has not completed a pass within the guard's deadline, or the guard has taken the
  // robot. In real time; from any thread.
  bool stalled() const;
  // Whether the cycle has ended, by itself or on request.
  bool ended() const { return ended_.load(std::memory_order_acquire); }
  // After that: what stop() will report, as far as it is already known.
  Farewell end_so_far() const;
  // Rings once per frame and at the end of the cycle; from any thread.
  rt::Doorbell& doorbell() { return doorbell_; }
  std::uint32_t baud() const { return stream_->baud(); }
  // From the robot's tick to the arrival of the command that answers its frame.
  double delay_s() const { return options_.cycle.loop.estimator.input_delay_s; }
  // The time that the cycle goes by.
  rt::TimePoint now() const { return stream_->now(); }

 private:
  Robot(std::unique_ptr<ByteStream> stream, std::unique_ptr<Duty> duty, const RobotOptions& options,
        const BringUpReport& report);
  void run();
  void leave();
  void note_end(CycleEnd end);
  void announce_end();
  bool ends_in_time();
  void abandon();
  bool guard_has_taken() const;
  void tell(const Event& event) const CARGOBAY_NONBLOCKING;
  StateObserver observer();
  std::vector<rt::Memory> memory_of_loop() const;
  void start_port_watch();

  std::unique_ptr<ByteStream> stream_;  // outlives cycle_
  RobotOptions options_;
  BringUpReport report_;
  LearntKeeper keeper_;  // the port watch's, until that has stopped
  FlightRecorder recorder_;
  RecordingStream recorded_;  // stream_ as the cycle sees it
  std::unique_ptr<ControlCycle> cycle_;
  std::unique_ptr<Duty> duty_;  // ends before its stream
  rt::RealtimeThread thread_;
  PortWatch port_watch_;  // looks at cycle_
  enum class Permission : std::uint8_t { pending, run, refused };
  std::atomic<Permission> permission_{Permission::pending};  // depends on what the kernel granted
  std::atomic<CycleEnd> cycle_end_{CycleEnd::asked};         // farewell_ belongs to the owner
  std::atomic<bool> ended_{false};
  bool stepped_ = false;  // start_stepped() was called
  rt::Doorbell doorbell_{};
  std::atomic<bool> left_{false};  // the robot is being left, or has been
  bool stopped_ = false;           // stop() was called
  bool lost_ = false;
  Farewell farewell_{};
};

// One line: why the cycle ended, what became of the robot, and what to do. Empty if the end was
// requested and the robot stands.
std::string explain(const Robot::Farewell& farewell);

}  // namespace cargobay::hal
