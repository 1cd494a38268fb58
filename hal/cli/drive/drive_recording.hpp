// What `drive --record` writes while the robot drives: the flight recorder's own format or, if the
// name ends in .mcap, MCAP.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "hal/cli/drive/drive_links.hpp"
#include "hal/cli/terminal/outputs.hpp"
#include "hal/result.hpp"
#include "hal/robot/robot.hpp"

namespace cargobay::cli {

// All its functions block for the disk. They are called in the order in which they are declared,
// for one link after another.
class DriveRecording {
 public:
  DriveRecording() = default;
  virtual ~DriveRecording() = default;
  DriveRecording(const DriveRecording&) = delete;
  DriveRecording& operator=(const DriveRecording&) = delete;

  // Before the loop starts.
  virtual hal::Result<void> begin_link(const hal::Robot& robot) = 0;
  // Once it runs: the file gets its name.
  virtual void publish() = 0;
  // Ten times a second; `links` has just collected.
  virtual void append(const hal::Robot& robot, const DriveLinks& links) = 0;
  // After the loop has ended and `links` has the last of it.
  virtual void end_link(const hal::Robot& robot, const DriveLinks& links) = 0;
  // After the last link.
  virtual void finish() = 0;

  // What went wrong first; the drive goes on.
  virtual const hal::Result<void>& written() const = 0;
  // Those that there are, and what a user does with one.
  virtual const std::vector<std::string>& files() const = 0;
  virtual std::string advice(const std::string& file) const = 0;
};

// `path` was opened as the output "--record"; `outputs` must outlive it. `note`: what is driven.
// Null for an empty path.
std::unique_ptr<DriveRecording> drive_recording(const std::string& path, const std::string& note,
                                                Outputs& outputs);

}  // namespace cargobay::cli
