// The feed of a robot that a command drives. A command whose feed cannot be published says so, and
// drives all the same.
#pragma once

#include <memory>
#include <string>

#include "hal/feed/feed.hpp"
#include "hal/robot/robot.hpp"
#include "hal/sim/remote/chosen_robot.hpp"

namespace cargobay::cli {

class Published {
 public:
  // None.
  Published() = default;
  // `program` is what readers are told; what is chosen outlives this.
  Published(const std::string& program, const hal::ChosenRobot& chosen, std::uint32_t baud,
            const hal::RobotOptions& robot);

  // The robot is to leave what it knows for the feed.
  void attach_to(hal::RobotOptions& robot) const;
  // A link begins, and ends: both before `robot` does.
  void follow(hal::Robot& robot) const;
  void leave(const std::string& why) const;

 private:
  std::unique_ptr<hal::Feed> feed_{};
};

}  // namespace cargobay::cli
