// The object of a robot's handle.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "hal/c/cargobay.h"
#include "hal/c/errors.hpp"
#include "hal/c/handles.hpp"
#include "hal/c/sim_object.hpp"
#include "hal/file/output_file.hpp"
#include "hal/recording/recording_writer.hpp"
#include "hal/robot/robot.hpp"
#include "hal/sim/remote/plant.hpp"

struct cargobay_robot;  // the handle

namespace cargobay::c {

struct RobotObject {
  RobotObject() = default;
  ~RobotObject();
  RobotObject(const RobotObject&) = delete;
  RobotObject& operator=(const RobotObject&) = delete;

  enum class Life : std::uint8_t { open, running, stopped };

  // Each returns CARGOBAY_OK, or the error of a function that is called too early or too late.
  int must_run() const noexcept;
  int must_be_started() const noexcept;

  // Why the loop ended, as an error with its message; CARGOBAY_OK if it was asked to end.
  int end_of_loop(const hal::Robot::Farewell& ended) const;

  // Puts a request into the cycle's ring: CARGOBAY_OK or CARGOBAY_E_FULL. From any thread; locks.
  int request(const hal::Request& wanted);

  SimUse sim{};               // the program's virtual Create that is the robot, if any
  hal::Plant plant{};         // otherwise
  hal::Robot::Owned robot{};  // destroyed before what it drives
  std::unique_ptr<hal::RecordingWriter> recording{};
  std::optional<hal::OutputFile> record_file{};  // until the loop starts
  double wheel_base_mm = 0.0;
  bool virtual_time = false;

  cargobay_control control = nullptr;
  void* context = nullptr;
  std::atomic<bool> control_threw{false};

  std::atomic<Life> life{Life::open};
  std::optional<rt::RealtimeGrant> grant{};  // once started
  std::optional<hal::Robot::Farewell> farewell{};
  std::string unrecorded_why{};  // empty if nothing went wrong

  std::timed_mutex owner;  // for start, stop, set_control; in virtual time for everything
  std::mutex requests;     // the one producer of the cycle's ring
  std::mutex events;       // the one consumer of its events
};

using RobotTable = HandleTable<RobotObject, HandleKind::robot>;
RobotTable& robots();

// Keeps an object that a thread may still come back to; it is never freed. Its virtual Create may
// be closed, in real time.
void keep(std::unique_ptr<RobotObject> object);
using RobotUse = RobotTable::Use;

// The error for a handle that is not an open robot.
inline int bad_robot(const cargobay_robot* robot) noexcept {
  return bad_handle(robot, HandleKind::robot);
}

// Whether this thread is in a control function, of any robot.
bool in_control() noexcept;
int not_from_control(const char* function) noexcept;

// The cycle's control function, which calls the program's; its context is the RobotObject.
rt::WheelSpeeds call_control(void* object, const hal::CycleState& state, double seconds)
    CARGOBAY_NONBLOCKING;

// The state as C programs see it.
cargobay_state c_state(const RobotObject& robot, const hal::CycleState& state) CARGOBAY_NONBLOCKING;

}  // namespace cargobay::c
