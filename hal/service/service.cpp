#include "hal/service/service.hpp"

#include <algorithm>
#include <array>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "hal/cycle/control_cycle.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/cycle/request.hpp"
#include "hal/port/open_port.hpp"
#include "hal/robot/reconnect.hpp"
#include "hal/robot/side_command.hpp"
#include "hal/sensing/events.hpp"
#include "hal/sim/remote/control_socket.hpp"
#include "oi/commands.hpp"
#include "oi/parse.hpp"
#include "oi/text/command_text.hpp"
#include "oi/value_names.hpp"

namespace cargobay::hal {

namespace {

constexpr rt::Duration kLookAt = std::chrono::milliseconds{50};

constexpr const char* kNoRobot = "the robot is not under control now; the feed's status says why";

bool may_come_with_each_frame(EventKind what) {
  return what == EventKind::frames_lost || what == EventKind::limit_began ||
         what == EventKind::limit_ended;
}

// Whole commands that leave the loop alone, and after which the robot hears what it is told.
Result<std::vector<std::vector<std::uint8_t>>> commands_of(std::string_view text) {
  std::vector<std::uint8_t> bytes(oi::most_bytes(text));
  const oi::TextResult encoded = oi::encode_text(text, bytes);
  if (encoded.error) {
    std::array<char, 400> said{};
    return Failure{.message = {said.data(), oi::format_error(*encoded.error, text, said)}};
  }
  std::vector<std::vector<std::uint8_t>> commands;
  for (auto rest = std::span<const std::uint8_t>{bytes}.first(encoded.bytes); !rest.empty();) {
    const oi::ParseResult parsed = oi::parse_command(rest);
    if (parsed.outcome != oi::ParseResult::Outcome::command)
      return Failure{.message = "not whole commands with values in range"};
    const auto command = rest.first(parsed.length);
    if (const auto alone = leaves_loop_alone(command); !alone) return alone.failure();
    // While a script waits the robot hears nothing, not even the stop that is everyone's.
    if (command[0] == oi::PlayScript::kOpcode)
      return Failure{.message =
                         "a script may drive, and wait without hearing a stop; not from here"};
    commands.emplace_back(command.begin(), command.end());
    rest = rest.subspan(parsed.length);
  }
  return commands;
}

}  // namespace

Result<std::unique_ptr<Service>> Service::open(const ServiceOptions& options) {
  std::unique_ptr<Service> service{new Service{options}};
  const ChosenRobot& chosen = *options.chosen;
  auto feed = Feed::open({.of = {.program = options.program,
                                 .port = chosen.port,
                                 .is_virtual = chosen.create != nullptr,
                                 .baud = options.baud,
                                 .wheel_base_mm = options.robot.cycle.loop.estimator.wheel_base_mm,
                                 .setpoint_lapse = kSetpointLapse},
                          .steering = service->steering(),
                          .create = chosen.server(),
                          .world = options.world});
  if (!feed) return feed.failure();
  service->feed_ = std::move(*feed);
  service->feed_->attach_to(service->options_.robot);
  service->options_.robot.cycle.setpoint_lapse = kSetpointLapse;
  // What its clients are shown first is why the robot stands, and they can put it right.
  service->options_.robot.cycle.on_mode_loss = OnModeLoss::hold;
  return service;
}

FeedSteering Service::steering() {
  FeedSteering steering{
      .drive = [this](const rt::WheelSpeeds& speeds) { return steer(speeds); },
      .stop = [this] { stop(); },
      .rearm = [this] { return rearm(); },
      .reset_odometry = [this](const rt::OdometryPose& pose) { return reset_odometry(pose); },
      .send = [this](std::string_view command) { return send(command); },
      .watch = [this](bool watched) { return watch(watched); }};
  if (sim::Server* const server = options_.chosen->server()) {
    steering.control = [server](std::string_view line) { return sim::control(line, *server); };
  }
  return steering;
}

Result<void> Service::run(const std::function<void()>& ready) {
  auto robot = bring_up();
  if (!robot && options_.missing && !options_.robot.cancelled()) {
    robot = bring_up_in_time(options_.missing, robot.failure());
  }
  while (robot) {
    const auto farewell = drive(**robot, ready);
    if (!farewell) return farewell.failure();
    if (farewell->end == CycleEnd::asked) {
      const std::string wrong = explain(*farewell);
      log("ended", wrong.empty() ? "the robot stands: asked to end" : wrong);
      return wrong.empty() ? Result<void>{} : Failure{.message = wrong};
    }
    tell("lost", explain(*farewell));
    if (auto learnt = (*robot)->learnt()) options_.robot.cycle.loop.estimator.prior = learnt;
    *robot = nullptr;  // gives its port back
    robot = bring_up_again(*farewell);
  }
  feed_->report("ended", robot.failure().message);
  return robot.failure();
}

Result<Robot::Owned> Service::bring_up() {
  feed_->report("bring_up", "the robot is brought up");
  auto port = open_port(options_.chosen->port, options_.baud);
  if (!port) return port.failure();
  if (!port->remark.empty()) tell("bring_up", port->remark);
  // A pseudo-terminal that goes away does not come back under its name, unless a link leads to it.
  if (options_.patience > rt::Duration::zero() && !options_.chosen->create) {
    if (auto identity = identify(options_.chosen->port, serial_ports()))
      identity_ = std::move(*identity);
  }
  return Robot::open(std::move(port->stream), options_.robot);
}

Result<Robot::Farewell> Service::drive(Robot& robot, const std::function<void()>& ready) {
  const auto grant = robot.start({});
  if (!grant) return grant.failure();
  become(&robot);
  feed_->follow(robot);
  constexpr const char* kDriving = "the loop runs, and the robot is steered by who holds the lease";
  feed_->report("driving", kDriving);
  log("driving", kDriving);
  if (ready) ready();
  while (!robot.ended() && !options_.robot.cancelled()) {
    std::this_thread::sleep_for(kLookAt);
    log_events(robot);
  }
  become(nullptr);
  const Robot::Farewell farewell = robot.stop();
  log_events(robot);
  feed_->leave();
  feed_->report("lost", explain(farewell));
  return farewell;
}

// Whatever ended the loop, the wheels stand and the lease's holder has been told: a client that
// steers again sees what it does.
Result<Robot::Owned> Service::bring_up_again(const Robot::Farewell& farewell) {
  if (options_.patience == rt::Duration::zero()) return Failure{.message = explain(farewell)};
  if (may_reconnect(farewell.end) && identity_) {
    auto back = reconnect({.port = *identity_,
                           .baud = options_.baud,
                           .robot = options_.robot,
                           .patience = options_.patience,
                           .tell = [this](const std::string& what) { tell("lost", what); }});
    if (!back) return back.failure();
    if (!back->remark.empty()) tell("bring_up", back->remark);
    return std::move(back->robot);
  }
  // A pseudo-terminal's number that is gone may come back as something else.
  const bool is_gone = farewell.end == CycleEnd::hung_up && !options_.chosen->create;
  if (is_gone) return Failure{.message = explain(farewell)};
  return bring_up_in_time([](const std::string&) {}, std::nullopt);
}

Result<Robot::Owned> Service::bring_up_in_time(
    const std::function<void(const std::string&)>& missing, std::optional<Failure> failed) {
  const rt::TimePoint until = rt::Clock::now() + options_.patience;
  std::string said;
  for (BackOff back_off;;) {
    if (failed) feed_->report("lost", failed->message);
    if (failed && std::exchange(said, failed->message) != said) {
      missing(said);
      log("lost", said);
    }
    const rt::TimePoint next = rt::Clock::now() + back_off.next();
    while (rt::Clock::now() < next && !options_.robot.cancelled())
      std::this_thread::sleep_for(kLookAt);
    auto robot = bring_up();
    if (robot || rt::Clock::now() >= until) return robot;
    if (options_.robot.cancelled())
      return Failure{.message = robot.failure().message,
                     .code = make_error_code(std::errc::operation_canceled)};
    failed = robot.failure();
  }
}

void Service::become(Robot* robot) {
  const std::lock_guard lock{mutex_};
  robot_ = robot;
  // There is room: nobody could ask this loop for anything before.
  if (watched_) (void)stream_what_is_watched();
}

bool Service::watch(bool watched) {
  const std::lock_guard lock{mutex_};
  watched_ = watched;
  return stream_what_is_watched();
}

// Wall, cliff signals and outputs too, if somebody is shown them: frames that carry them come in
// turns with those that the loop needs.
bool Service::stream_what_is_watched() {
  if (robot_ == nullptr) return true;
  Request request;
  request.kind = Request::Kind::stream;
  if (watched_) request.extras = kAllExtraLists;
  return robot_->cycle().request(request);
}

void Service::tell(const std::string& event, const std::string& what) const {
  if (options_.tell) options_.tell(what);
  log(event, what);
}

void Service::log(const std::string& event, const std::string& what) const {
  if (options_.log) options_.log({.event = event, .text = what, .frames = frames_});
}

void Service::log_events(Robot& robot) {
  frames_ = robot.cycle().counters().frames;
  for (Event event; robot.next_event(event);) {
    if (!may_come_with_each_frame(event.what)) log(std::string{name(event.what)}, describe(event));
  }
}

Result<void> Service::steer(const rt::WheelSpeeds& speeds) {
  const std::lock_guard lock{mutex_};
  if (robot_ == nullptr) return Failure{.message = kNoRobot};
  const auto state = robot_->cycle().state();
  if (state && state->mode != oi::Mode::safe && state->mode != oi::Mode::full) {
    return Failure{.message = "the robot has gone to " + std::string{oi::name(state->mode)} +
                              " mode and obeys no drive commands; put right what stopped it, then "
                              "`rearm`"};
  }
  if (!robot_->cycle().set_speeds(speeds))
    return Failure{.message = "a wheel's speed must be from -500 to 500 mm/s"};
  return {};
}

void Service::stop() {
  const std::lock_guard lock{mutex_};
  if (robot_ != nullptr) robot_->cycle().stand_still();
}

Result<void> Service::rearm() {
  const std::lock_guard lock{mutex_};
  if (robot_ == nullptr) return Failure{.message = kNoRobot};
  robot_->cycle().request_rearm();
  return {};
}

Result<void> Service::reset_odometry(const rt::OdometryPose& pose) {
  const std::lock_guard lock{mutex_};
  if (robot_ == nullptr) return Failure{.message = kNoRobot};
  Request request;
  request.kind = Request::Kind::pose;
  request.pose = pose;
  if (robot_->cycle().request(request)) return {};
  return Failure{.message = "too many requests wait for the loop; ask again"};
}

Result<void> Service::send(std::string_view command) {
  const auto commands = commands_of(command);
  if (!commands) return commands.failure();
  const std::lock_guard lock{mutex_};
  if (robot_ == nullptr) return Failure{.message = kNoRobot};
  for (const std::vector<std::uint8_t>& each : *commands) {
    const auto request = side_request(robot_->cycle(), each, Request::WhenLong::wait);
    if (!request && request.failure().code == std::errc::operation_not_permitted)
      return Failure{.message = request.failure().message + ": `rearm`"};
    if (!request) return request.failure();
    if (!robot_->cycle().request(*request))
      return Failure{.message = "too many requests wait for the loop; ask again"};
  }
  return {};
}

}  // namespace cargobay::hal
