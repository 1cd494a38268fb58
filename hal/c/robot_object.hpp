// The object of a robot's handle: what lasts from open to close.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"
#include "hal/c/event_descriptor.hpp"
#include "hal/c/handles.hpp"
#include "hal/c/opening.hpp"
#include "hal/c/session.hpp"
#include "hal/c/sim_object.hpp"
#include "hal/feed/feed.hpp"
#include "hal/sensing/event_log.hpp"
#include "rt/newest_ring.hpp"

struct cargobay_robot;  // the handle

namespace cargobay::c {

// A state as the library keeps it: with the robot's tick, and what the cycle does not say.
struct SeenState {
  hal::CycleState state{};
  std::int64_t elapsed_ticks = 0;  // since the state before; 0: it is the first of a start
  std::uint32_t buttons = 0;       // enum cargobay_button
};

inline constexpr std::size_t kHistory = 256;

// A control function with what it is called with.
struct ControlSlot {
  cargobay_control function = nullptr;
  void* context = nullptr;
};

struct RobotObject {
  RobotObject() = default;
  ~RobotObject();
  RobotObject(const RobotObject&) = delete;
  RobotObject& operator=(const RobotObject&) = delete;

  bool in_virtual_time() const { return opening.virtual_time; }
  // Held by start, end and set_control; in virtual time by everything that moves it, for all robots
  // of the world.
  std::timed_mutex& owner() { return in_virtual_time() ? opening.sim->world().owner : owner_; }
  double wheel_base_mm() const { return opening.wanted.cycle.loop.estimator.wheel_base_mm; }

  // By the owner: the program's function from now on, or none. CARGOBAY_OK, or CARGOBAY_E_STALLED
  // if the former one does not return; it is then kept.
  int set_control(cargobay_control function, void* context);

  // By the owner, before the first session: others may watch. CARGOBAY_OK, or the error.
  int publish();
  // By the owner: brings the robot up, for the first time or again. After a failure there is no
  // session.
  int open_session();
  void close_session();

  // From the control thread.
  void see(const SeenState& seen) CARGOBAY_NONBLOCKING;
  void hear(const hal::Event& event) CARGOBAY_NONBLOCKING;

  Opening opening{};
  hal::EventLog events{};
  rt::NewestRing<SeenState, kHistory> history{};
  EventDescriptor descriptor{};
  std::unique_ptr<hal::Feed> feed{};  // with CARGOBAY_FLAG_PUBLISH

  std::atomic<const ControlSlot*> control{nullptr};
  std::atomic<std::uint32_t> control_calls{0};  // odd while the program's function runs
  std::unique_ptr<const ControlSlot> control_owner{};
  // Those that a call may still come back to.
  std::vector<std::unique_ptr<const ControlSlot>> former_controls{};

  // How often each packet is subscribed.
  static constexpr std::size_t kPackets = hal::SensorReadings::kSlots;
  using Subscriptions = std::array<std::uint32_t, kPackets>;
  Subscriptions subscriptions{};
  std::mutex subscribing;

  std::atomic<bool> closing{false};

 private:
  std::timed_mutex owner_;
  friend class SessionUse;
  std::unique_ptr<Session> session_owner_{};
  std::atomic<Session*> session_{nullptr};
  std::atomic<std::uint32_t> session_uses_{0};
};

// The session of a robot, which is not freed while this lives; none while the robot is brought up
// again. Lock-free.
class SessionUse {
 public:
  explicit SessionUse(RobotObject& object) CARGOBAY_NONBLOCKING : object_{object},
                                                                  session_{enter(object)} {}
  ~SessionUse() { object_.session_uses_.fetch_sub(1, std::memory_order_release); }
  SessionUse(const SessionUse&) = delete;
  SessionUse& operator=(const SessionUse&) = delete;

  explicit operator bool() const CARGOBAY_NONBLOCKING { return session_ != nullptr; }
  Session* operator->() const CARGOBAY_NONBLOCKING { return session_; }
  Session& operator*() const CARGOBAY_NONBLOCKING { return *session_; }
  hal::ControlCycle& cycle() const { return session_->robot->cycle(); }

 private:
  // In one order with close_session(): either it sees this use, or this sees no session.
  static Session* enter(RobotObject& object) CARGOBAY_NONBLOCKING {
    object.session_uses_.fetch_add(1, std::memory_order_seq_cst);
    return object.session_.load(std::memory_order_seq_cst);
  }

  RobotObject& object_;
  Session* session_;
};

using RobotTable = HandleTable<RobotObject, HandleKind::robot>;
RobotTable& robots();
using RobotUse = RobotTable::Use;

// Keeps an object that a thread may still come back to; it is never freed. Its virtual Create may
// be closed, in real time.
void keep(std::unique_ptr<RobotObject> object);

// The error for a handle that is not an open robot.
inline int bad_robot(const cargobay_robot* robot) noexcept {
  return bad_handle(robot, HandleKind::robot);
}
// The error while cargobay_start() brings the robot up again.
inline int no_session() noexcept {
  return fail(CARGOBAY_E_STATE,
              "cargobay_start() is bringing the robot up again, or has failed to; wait for it, or "
              "start again");
}

// The extra lists that have the packets that are subscribed.
hal::ExtraLists lists_with(const RobotObject::Subscriptions& subscriptions);

// The state as C programs see it.
cargobay_state c_state(const RobotObject& robot, const SeenState& known) CARGOBAY_NONBLOCKING;

// Wheel speeds for a velocity and a turn rate, scaled down together to what a wheel can do; not
// numbers if these are not.
cargobay_wheels wheels_for(const RobotObject& robot, const cargobay_twist& twist)
    CARGOBAY_NONBLOCKING;

}  // namespace cargobay::c
