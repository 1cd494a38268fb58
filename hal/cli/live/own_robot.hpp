// A robot for a command that wants to watch or steer one when nothing publishes any: a service of
// the command's own, to whose feed it attaches like any other client.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "hal/cli/drive/drive_options.hpp"
#include "hal/feed/feed_reader.hpp"
#include "hal/result.hpp"
#include "hal/service/service.hpp"
#include "hal/sim/remote/chosen_robot.hpp"

namespace cargobay::cli {

// One thread, beside its own.
class OwnRobot {
 public:
  // Publishes the feed, and begins to bring the robot up. Blocks for some ms; allocates.
  static hal::Result<std::unique_ptr<OwnRobot>> start(const DriveOptions& options,
                                                      const hal::Config& config,
                                                      const std::string& program);
  // The robot stands, or its guard has stopped it. Blocks for up to 2 s.
  ~OwnRobot();
  OwnRobot(const OwnRobot&) = delete;
  OwnRobot& operator=(const OwnRobot&) = delete;

  const std::string& socket() const { return service_->socket(); }
  // Lets it stand, and waits for that; says what went wrong, if anything did. Once.
  hal::Result<void> end();

 private:
  OwnRobot() = default;

  hal::ChosenRobot chosen_{};  // outlives the service
  std::unique_ptr<hal::Service> service_{};
  std::atomic<bool> cancelled_{false};
  hal::Result<void> ended_{};  // of the thread, until it is joined
  std::thread thread_{};
};

// A feed to be read, and the robot behind it if it is the command's own.
struct Attached {
  std::unique_ptr<OwnRobot> own{};  // null: another process's
  hal::FeedReader reader;
};

// Attaches to the feed of the options' port; without a port, to the only feed there is. If nothing
// publishes it: a robot of our own. Fails if there are several feeds and no port was named.
hal::Result<Attached> attach(const DriveOptions& options, const std::string& program);

}  // namespace cargobay::cli
