// One drive of the fault matrix, in virtual time, through the shipping path: bring-up, control
// cycle, leaving; and if the fault ended the cycle, all of it once more. It only observes;
// verdict.hpp says what must hold.
#pragma once

#include <cstdint>
#include <vector>

#include "hal/cli/drive/profile.hpp"
#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_parameters.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/sim/robot/device.hpp"
#include "tests/campaign/fault_case.hpp"

namespace cargobay::campaign {

// The robot at the end of a tick.
struct TickSeen {
  std::uint64_t tick = 0;
  bool frame = false;  // it sent one
  bool clean = false;  // and no remaining fault could touch it
  bool waits = false;  // it was in the middle of a command
  oi::Mode mode = oi::Mode::off;
  std::int32_t battery_mv = 0;
  rt::WheelSpeeds truth{};
};

// The cycle at the moment it answers.
struct AnswerSeen {
  std::uint64_t tick = 0;  // of the robot
  hal::CycleState state{};
  hal::FrameCounters frames{};
};

struct Observations {
  bool brought_up = false;
  hal::CycleEnd end = hal::CycleEnd::asked;
  rt::TimePoint ended{};
  std::uint64_t last_tick = 0;  // of the robot, when the cycle ended
  rt::WheelSpeeds commanded{};  // of the robot, at that time
  bool backlog = false;         // the robot had more to send at that time
  hal::FrameCounters frames{};
  std::vector<TickSeen> ticks{};
  std::vector<AnswerSeen> answers{};
  std::vector<hal::CycleState> states{};  // as published
  std::vector<std::uint64_t> obeyed{};    // the tick of each drive command that the robot obeyed
  std::vector<std::uint64_t> written{};   // the tick in which each one sent reached the robot
  std::vector<std::uint8_t> sent{};       // by the robot
  std::vector<std::uint8_t> received{};   // by the host

  bool restarted = false;  // the members below are valid
  bool toggled = false;    // only power off and on helped
  bool brought_up_again = false;
  hal::FrameCounters second_frames{};
  hal::CycleEnd second_end = hal::CycleEnd::asked;
  rt::WheelSpeeds second_truth{};  // at its last frame
  bool passive_at_last = false;    // the robot, in truth
  rt::WheelSpeeds commanded_at_last{};
};

struct DriveCase {
  FaultCase fault{};
  const cli::Profile* profile = nullptr;  // outlives the drive
  hal::sim::Remainder remainder = hal::sim::Remainder::carried;
  std::uint64_t seed = 1;
};

constexpr int kSecondFrames = 150;
constexpr double kSecondSpeed = 200.0;  // mm/s

Observations drive(const DriveCase& which);

}  // namespace cargobay::campaign
