// What a robot's handle has between a start and an end: the robot itself. A handle that is started
// again gets another.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "hal/file/output_file.hpp"
#include "hal/recording/recording_writer.hpp"
#include "hal/result.hpp"
#include "hal/robot/robot.hpp"
#include "rt/nonblocking.hpp"

namespace cargobay::hal::sim {
class VirtualLink;
}  // namespace cargobay::hal::sim

namespace cargobay::c {

struct RobotObject;

struct Session {
  explicit Session(RobotObject& of) : object{of} {}
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  enum class Life : std::uint8_t { open, running, stopped };

  // What the loop is driven by, and tells; all with the session as context.
  hal::ControlFunction control();
  hal::StateObserver observer();

  // Each returns CARGOBAY_OK or why not, as an error with its message.
  int must_be_started() const noexcept;
  int must_run() const noexcept;
  // Puts a request into the cycle's ring. From any thread; locks.
  int request(const hal::Request& wanted);
  // By the owner. `end` is idempotent.
  int start();
  void end();
  // In virtual time: runs the loop until it has answered a frame, or until then.
  void step(rt::TimePoint until);
  // After that: CARGOBAY_OK, or why it ended.
  int outcome();

  // enum cargobay_button, as last reported; on the control thread.
  std::uint32_t buttons() const CARGOBAY_NONBLOCKING;

  // What is known about the end so far; nothing before it. From any thread; locks.
  std::optional<hal::Robot::Farewell> farewell();
  // Why the recording could not be written; empty if nothing went wrong. From any thread; locks.
  std::string unrecorded_why() const;

  RobotObject& object;
  hal::Robot::Owned robot{};
  std::unique_ptr<hal::RecordingWriter> recording{};
  std::optional<hal::OutputFile> record_file{};  // until the loop starts
  std::optional<rt::RealtimeGrant> grant{};      // once started
  // Where the robot's ticks and distance go on: the loop counts from 0 each time.
  std::int64_t first_tick = 0;
  double first_distance_mm = 0.0;

  std::atomic<Life> life{Life::open};
  std::atomic<bool> control_threw{false};
  std::atomic<int> control_result{0};  // what ended the loop

  std::int64_t last_tick = -1;  // that the control thread has told
  std::mutex requests;          // the one producer of the cycle's ring

 private:
  hal::sim::VirtualLink* virtual_link() const;
  int record();
  int publish_record();

  mutable std::mutex ending_;
  std::optional<hal::Robot::Farewell> farewell_{};
  std::string unrecorded_why_{};
};

// The code and the message of a loop that ended so; CARGOBAY_OK and "" if it was asked to.
struct EndWords {
  int code = 0;
  std::string message{};
};
EndWords words_of(const Session& session, const hal::Robot::Farewell& farewell);

// Whether this thread is in a control function, of any robot.
bool in_control() noexcept;
int not_from_control(const char* function) noexcept;

}  // namespace cargobay::c
