// The real-time path: woken by a frame, it estimates, controls and answers with DriveDirect, in one
// pass on one thread. One wait, one read and one write per frame in the steady state; no heap, no
// lock, no page fault.
//
// Who only drives needs no more than this header, which parses no part of the loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "rt/clock.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::oi {
template <typename Flag>
class BitSet;
enum class PacketId : std::uint8_t;
}  // namespace cargobay::oi
namespace cargobay::rt {
class Histogram;
struct LearntPlant;
struct WheelSpeeds;
}  // namespace cargobay::rt

namespace cargobay::hal {

class ByteStream;
class CyclePass;
class GuardMark;
struct ControlFunction;  // these and the next ones: hal/cycle/cycle_state.hpp
struct CycleCounters;
struct CycleState;
struct FrameCounters;
struct PhaseOverruns;
struct StateObserver;
enum class CycleEnd : std::uint8_t;
struct CycleParameters;  // hal/cycle/cycle_parameters.hpp
struct Event;            // hal/sensing/events.hpp
enum class Hazard : std::uint8_t;
struct Request;         // hal/cycle/request.hpp
struct SensorReadings;  // hal/sensing/sensor_board.hpp

class ControlCycle {
 public:
  using Parameters = CycleParameters;

  // `stream` must outlive the cycle and keep its rate; its robot must already stream frame lists
  // (hal/bring_up/bring_up.hpp).
  ControlCycle(ByteStream& stream, const Parameters& parameters);
  ~ControlCycle();
  ControlCycle(const ControlCycle&) = delete;
  ControlCycle& operator=(const ControlCycle&) = delete;

  // Call before run(). Without one, the latest setpoint is followed.
  void set_control(const ControlFunction& control);
  // Call before run().
  void set_observer(const StateObserver& observer);

  // Call before run(); the mark's guard must outlive the cycle. Without a mark, no guard watches.
  void set_guard(const GuardMark& guard);

  // All that run() touches, beside the stream and what is called: one allocation, to be locked.
  const void* memory() const { return pass_; }

  // Runs until something ends it. The last thing it sends, if the robot still listens, is
  // DriveDirect 0 0; the mode does not change. Call only once.
  CycleEnd run() CARGOBAY_NONBLOCKING;
  // The same in steps, for a stream in virtual time: begin(), then pass() until it is false, then
  // finish().
  void begin() CARGOBAY_NONBLOCKING;
  [[nodiscard]] bool pass() CARGOBAY_NONBLOCKING;
  CycleEnd finish() CARGOBAY_NONBLOCKING;

  // From any thread, and from a signal handler.
  void request_stop() CARGOBAY_NONBLOCKING;
  // From any thread: nothing more is written, whatever a hung control thread does if it resumes. A
  // write in progress still goes out.
  void abandon() CARGOBAY_NONBLOCKING;
  // From any thread: when the control thread last woke; nothing before the first time.
  std::optional<rt::TimePoint> last_pass() const CARGOBAY_NONBLOCKING;
  // From any thread. False for speeds that are not numbers or beyond the robot's range. A setpoint
  // lapses after setpoint_lapse, and when the robot loses its mode; then the wheels stop until a
  // new one is set.
  [[nodiscard]] bool set_speeds(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING;

  // From any thread: the setpoint no longer counts, and the wheels stop until the next one.
  void stand_still() CARGOBAY_NONBLOCKING;

  // From any thread: for `duration` from the next pass on, silence does not mean a lost link, for
  // example while the robot plays a script that waits. The wheels get their stop all the same, in
  // case the robot listens.
  void expect_silence(rt::Duration duration) CARGOBAY_NONBLOCKING;

  // From any thread. If the mode was lost and the cycle holds: tells the robot to go back to it,
  // once, and drives again when it has. The outcome is reported as an event. Otherwise nothing
  // happens.
  void request_rearm() CARGOBAY_NONBLOCKING;

  // From one other thread. False if too many requests are waiting. A command goes out after the
  // loop's own, one per frame, as far as the robot's mode allows it then.
  [[nodiscard]] bool request(const Request& request) CARGOBAY_NONBLOCKING;
  // How many bytes of a request go out besides the loop's own commands; for more, the loop pauses.
  std::size_t spare_bytes() const CARGOBAY_NONBLOCKING;

  // From any thread.
  std::optional<CycleState> state() const CARGOBAY_NONBLOCKING;
  // From any thread: what the loop has learnt of the wheels, a quarter of a second old at most;
  // nothing before the first frames.
  std::optional<rt::LearntPlant> learnt() const CARGOBAY_NONBLOCKING;
  // From one other thread: the states of all ticks, oldest first; false when there are no more.
  bool next_state(CycleState& state) CARGOBAY_NONBLOCKING;
  // The same for the events.
  bool next_event(Event& event) CARGOBAY_NONBLOCKING;
  // Events dropped for want of room, because nothing took them. From any thread.
  std::uint64_t events_dropped() const CARGOBAY_NONBLOCKING;

  // The last value of a packet, or of each. From any thread.
  std::int32_t reading(oi::PacketId packet) const CARGOBAY_NONBLOCKING;
  SensorReadings sensors() const CARGOBAY_NONBLOCKING;
  // From any thread.
  CycleCounters counters() const CARGOBAY_NONBLOCKING;

  // While it runs, other threads may only take a snapshot() of these.
  const rt::Histogram& period_ns() const;
  const rt::Histogram& frame_to_command_ns() const;
  // After run() has returned.
  const FrameCounters& frames() const;
  // Commands that the port did not take whole.
  std::uint64_t unsent_commands() const;
  // Commands not sent because the robot might have got them in the same tick as the one before.
  std::uint64_t withheld_commands() const;
  const PhaseOverruns& overruns() const;
  // Answers of the control function that no robot can follow.
  std::uint64_t refused_controls() const;
  // Bytes still missing of a command whose beginning the robot has received.
  std::size_t owed_bytes() const;
  // If the port hung up, the errno of what failed; EBADF if the descriptor is no longer the port's;
  // 0 if no call gave a reason.
  int port_error() const;
  // Why the mode was last lost; none if no sensor showed it.
  oi::BitSet<Hazard> mode_loss_causes() const;

 private:
  CyclePass* pass_;  // owned; std::unique_ptr's header would double the size of this one
};

}  // namespace cargobay::hal
