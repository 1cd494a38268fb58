// How a robot was opened, so that it can be brought up again in the same way.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hal/c/cargobay.h"
#include "hal/c/sim_object.hpp"
#include "hal/file/output_file.hpp"
#include "hal/result.hpp"
#include "hal/robot/robot.hpp"
#include "hal/sim/remote/chosen_robot.hpp"
#include "hal/stream/byte_stream.hpp"

namespace cargobay::c {

struct Opening {
  // Reads options and configuration, and finds the robot; nothing is sent to it. CARGOBAY_OK or the
  // error. With `record`, the file is opened.
  int prepare(const cargobay_options& options, std::optional<hal::OutputFile>& record);
  // Opens the line to the robot.
  int open_stream(std::unique_ptr<hal::ByteStream>& stream);

  SimUse sim{};               // the program's virtual Create that is the robot, if any
  hal::ChosenRobot chosen{};  // otherwise
  hal::RobotOptions wanted{};
  std::uint32_t baud = 0;
  bool virtual_time = false;
  bool published = false;             // with CARGOBAY_FLAG_PUBLISH
  bool baud_is_the_programs = false;  // not the configuration's
  int (*progress)(void* context, const char* step, const char* detail) = nullptr;
  void* progress_context = nullptr;

 private:
  int take_sim(const cargobay_options& options);
  int take_plant(const hal::Config& config);
};

// The code for a failure to bring the robot up.
int code_of(const hal::Failure& failure, const Opening& opening);

// Calls the program's function at each step of a bring-up, and in between.
class ProgressTeller {
 public:
  explicit ProgressTeller(const Opening& opening) : opening_{opening} {}

  void tell(const hal::BringUpEvent& event);
  // Called every 20 ms. Whether the program gives up.
  bool given_up();

 private:
  void call();

  const Opening& opening_;
  std::string step_{};
  std::string detail_{};
  int polls_ = 0;
  bool given_up_ = false;
};

}  // namespace cargobay::c
