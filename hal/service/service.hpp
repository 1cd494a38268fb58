// A robot with several clients: owns its bring-up, loop, guard and reconnection, publishes its
// feed, and is steered by whoever holds the feed's lease (docs/feed.md).
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "hal/cycle/cycle_state.hpp"
#include "hal/feed/feed.hpp"
#include "hal/port/port_identity.hpp"
#include "hal/result.hpp"
#include "hal/robot/robot.hpp"
#include "hal/sim/remote/chosen_robot.hpp"
#include "hal/sim/world/world.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal {

// What happens, for a log.
struct ServiceNews {
  std::string event{};  // a stage of docs/feed.md, or the name of an event of the robot
  std::string text{};   // for people, one line
  // Of the newest loop, so far; none before the first.
  std::optional<FrameCounters> frames{};
};

struct ServiceOptions {
  std::string program{};  // what the readers of the feed are told
  const ChosenRobot* chosen = nullptr;
  std::uint32_t baud = 0;
  RobotOptions robot{};               // its `cancelled` ends everything
  const sim::World* world = nullptr;  // of its virtual Create, if it lives in one
  // How long a robot whose loop has ended by itself is waited for; 0: not at all.
  rt::Duration patience{};
  // Called with why the robot cannot be brought up at first, each time that changes; run() then
  // waits for it too, for as long. Empty: run() fails. On run()'s thread.
  std::function<void(const std::string&)> missing{};
  // Called with one line each: what happens to the link. On run()'s thread.
  std::function<void(const std::string&)> tell{};
  // Called with the same, and with what the robot notices, except for what may come with every
  // frame of a bad line. On run()'s thread.
  std::function<void(const ServiceNews&)> log{};
};

class Service {
 public:
  // Shorter than elsewhere: clients may be phones that fall asleep, and then there is the way that
  // the wheels need to stop.
  static constexpr rt::Duration kSetpointLapse = std::chrono::milliseconds{350};

  // Publishes the feed; the robot is not touched yet. What `options` refers to outlives the
  // service. Blocks for the file system; allocates.
  static Result<std::unique_ptr<Service>> open(const ServiceOptions& options);
  // run() has returned.
  ~Service() = default;
  Service(const Service&) = delete;
  Service& operator=(const Service&) = delete;

  // Brings the robot up, drives it as its clients say, and brings it up again when its loop has
  // ended by itself: the port was gone, the robot fell silent, a wheel was stuck. Until
  // `cancelled`, which it looks at every 50 ms. Blocks. When it returns the robot stands, or the
  // failure says that it may not. `ready` is called each time the loop runs; may be empty.
  Result<void> run(const std::function<void()>& ready);

  // The socket of the feed.
  const std::string& socket() const { return feed_->socket(); }

 private:
  explicit Service(const ServiceOptions& options) : options_{options} {}

  FeedSteering steering();
  Result<Robot::Owned> bring_up();
  // Again and again, for the patience; `failed` is how it failed before. Calls `missing` with each
  // reason that is new.
  Result<Robot::Owned> bring_up_in_time(const std::function<void(const std::string&)>& missing,
                                        std::optional<Failure> failed);
  // Until the loop ends, or it is cancelled.
  Result<Robot::Farewell> drive(Robot& robot, const std::function<void()>& ready);
  Result<Robot::Owned> bring_up_again(const Robot::Farewell& farewell);
  void become(Robot* robot);
  bool watch(bool watched);
  bool stream_what_is_watched();
  Result<void> steer(const rt::WheelSpeeds& speeds);
  Result<void> send(std::string_view command);
  Result<void> rearm();
  Result<void> reset_odometry(const rt::OdometryPose& pose);
  void stop();
  void tell(const std::string& event, const std::string& what) const;
  void log(const std::string& event, const std::string& what) const;
  void log_events(Robot& robot);

  ServiceOptions options_;
  std::optional<PortIdentity> identity_{};  // of a port that may come back
  std::optional<FrameCounters> frames_{};   // of the newest loop
  std::mutex mutex_;
  bool watched_ = false;          // some reader of the feed gets the sensors
  Robot* robot_ = nullptr;        // while its loop runs: the feed's thread steers it
  std::unique_ptr<Feed> feed_{};  // last: ends first
};

}  // namespace cargobay::hal
