#include "hal/c/robot_object.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <iterator>
#include <span>
#include <thread>
#include <utility>
#include <vector>

#include "hal/c/errors.hpp"
#include "hal/sim/remote/control_socket.hpp"
#include "oi/limits.hpp"
#include "rt/twist.hpp"

namespace cargobay::c {
namespace {

// From the wheels as the OI has them to those of the C API.
cargobay_wheels c_wheels(const rt::WheelSpeeds& speeds) CARGOBAY_NONBLOCKING {
  return {.left_mm_s = speeds.left_mm_s, .right_mm_s = speeds.right_mm_s};
}

std::int32_t c_remainder(rt::RemainderBelief belief) CARGOBAY_NONBLOCKING {
  switch (belief) {
    case rt::RemainderBelief::unknown: return CARGOBAY_REMAINDER_UNKNOWN;
    case rt::RemainderBelief::carried: return CARGOBAY_REMAINDER_CARRIED;
    case rt::RemainderBelief::lost: return CARGOBAY_REMAINDER_LOST;
  }
  return CARGOBAY_REMAINDER_UNKNOWN;
}

std::uint32_t c_bumps(hal::Bumps bumps) CARGOBAY_NONBLOCKING {
  return (bumps.has(oi::Bump::bump_left) ? std::uint32_t{CARGOBAY_BUMP_LEFT} : 0U) |
         (bumps.has(oi::Bump::bump_right) ? std::uint32_t{CARGOBAY_BUMP_RIGHT} : 0U);
}

// There is no port.
std::string name_in_virtual_time() {
  static std::atomic<int> robots{0};
  return "virtual-" + std::to_string(getpid()) + "-" + std::to_string(++robots);
}

int not_opened(const hal::Failure& failure, const Opening& opening) {
  const int code = code_of(failure, opening);
  if (code != CARGOBAY_E_CANCELLED) return fail(code, failure);
  return fail(code, failure.message +
                        ": `progress` gave up, or the robot is being closed; open it "
                        "again when it may take its time");
}

}  // namespace

RobotObject::~RobotObject() {
  if (feed) feed->leave();
  session_.store(nullptr);
  session_owner_.reset();  // before what it drives
  feed.reset();            // before another may publish the same virtual Create
  if (opening.sim) opening.sim->taken.store(false);
}

int RobotObject::set_control(cargobay_control function, void* context) {
  std::unique_ptr<const ControlSlot> slot;
  if (function != nullptr)
    slot =
        std::make_unique<const ControlSlot>(ControlSlot{.function = function, .context = context});
  control.store(slot.get(), std::memory_order_seq_cst);
  std::unique_ptr<const ControlSlot> former = std::exchange(control_owner, std::move(slot));
  const std::uint32_t calls = control_calls.load(std::memory_order_seq_cst);
  if (!former || calls % 2 == 0) return CARGOBAY_OK;
  // The former one is being called: the loop waits for it, and so does this.
  const rt::TimePoint until = rt::Clock::now() + opening.wanted.guard.deadline;
  while (control_calls.load(std::memory_order_acquire) == calls) {
    if (rt::Clock::now() >= until) {
      former_controls.push_back(std::move(former));
      return fail(CARGOBAY_E_STALLED,
                  "the former control function has not returned within `guard_deadline_ns`; it is "
                  "not called again, but keep what it uses until the process ends");
    }
    std::this_thread::sleep_for(std::chrono::microseconds{100});
  }
  return CARGOBAY_OK;
}

int RobotObject::publish() {
  SimObject* const own = opening.sim ? &*opening.sim : nullptr;
  hal::sim::Server* const create = own != nullptr ? own->server.get() : opening.chosen.server();
  hal::FeedOptions options{
      .of = {.program = program_invocation_short_name,
             .port = own == nullptr ? opening.chosen.port
                     : own->server  ? own->server->path()
                                    : name_in_virtual_time(),
             .is_virtual = own != nullptr || create != nullptr,
             .baud = opening.baud,
             .wheel_base_mm = wheel_base_mm(),
             .setpoint_lapse = opening.wanted.cycle.setpoint_lapse},
      .create = create,
      .world = own != nullptr && create != nullptr ? &own->world().world : nullptr};
  if (create != nullptr) {
    options.steering.control = [create](std::string_view line) {
      return hal::sim::control(line, *create);
    };
  }
  auto opened = hal::Feed::open(std::move(options));
  if (!opened) return fail(CARGOBAY_E_FILE, opened.failure());
  feed = std::move(*opened);
  return CARGOBAY_OK;
}

void RobotObject::close_session() {
  if (feed) feed->leave();
  session_.store(nullptr, std::memory_order_seq_cst);
  // In one order with SessionUse: whoever is not seen here sees no session.
  while (session_uses_.load(std::memory_order_seq_cst) != 0)
    std::this_thread::sleep_for(std::chrono::microseconds{100});
  session_owner_.reset();
}

int RobotObject::open_session() {
  if (session_owner_) {
    if (auto learnt = session_owner_->robot->learnt())
      opening.wanted.cycle.loop.estimator.prior = learnt;
  }
  close_session();
  if (feed) feed->report("bring_up", "the robot is brought up");
  std::unique_ptr<hal::ByteStream> stream;
  if (const int failed = opening.open_stream(stream); failed != CARGOBAY_OK) return failed;
  auto session = std::make_unique<Session>(*this);
  const auto newest = history.newest();
  if (newest) {
    session->first_tick = newest->value.state.tick + 1;
    session->first_distance_mm = newest->value.state.distance_mm;
  }
  ProgressTeller teller{opening};
  hal::RobotOptions wanted = opening.wanted;
  wanted.progress = [&teller](const hal::BringUpEvent& event) { teller.tell(event); };
  wanted.cancelled = [&teller, this] { return teller.given_up() || closing.load(); };
  wanted.observers = {session->observer()};
  wanted.memory = {std::as_bytes(std::span{this, 1}), std::as_bytes(std::span{session.get(), 1})};
  if (feed) feed->attach_to(wanted);
  auto opened = hal::Robot::open(std::move(stream), wanted);
  if (!opened) return not_opened(opened.failure(), opening);
  session->robot = std::move(*opened);
  session_owner_ = std::move(session);
  session_.store(session_owner_.get(), std::memory_order_seq_cst);
  if (feed) feed->follow(*session_owner_->robot);
  if (!newest) return CARGOBAY_OK;
  hal::Request pose;
  pose.kind = hal::Request::Kind::pose;
  pose.pose = newest->value.state.pose;
  return session_owner_->request(pose);
}

void RobotObject::see(const SeenState& seen) CARGOBAY_NONBLOCKING {
  history.put(seen);
  descriptor.signal();
}

void RobotObject::hear(const hal::Event& event) CARGOBAY_NONBLOCKING {
  events.put(event);
  descriptor.signal();
}

RobotTable& robots() {
  // Made by the compiler: the first call may come from where nothing may be allocated.
  static constinit RobotTable table;
  return table;
}

void keep(std::unique_ptr<RobotObject> object) {
  {
    // Unless another thread is still bringing the robot up: it uses the feed.
    const std::unique_lock lock{object->owner(), std::try_to_lock};
    if (lock) object->feed.reset();
  }
  // In virtual time the thread may be inside the virtual Create, and a feed looks at it.
  if (object->opening.sim && !object->in_virtual_time() && !object->feed) {
    object->opening.sim->taken.store(false);
    object->opening.sim = {};
  }
  // Stays reachable, so that a leak checker does not report it.
  static std::mutex keeping;
  static std::vector<RobotObject*>& kept = *new std::vector<RobotObject*>;
  const std::lock_guard lock{keeping};
  kept.push_back(object.release());
}

cargobay_wheels wheels_for(const RobotObject& robot, const cargobay_twist& twist)
    CARGOBAY_NONBLOCKING {
  const rt::WheelSpeeds wheels = rt::wheels_for({twist.velocity_mm_s, twist.turn_rate_rad_s},
                                                robot.wheel_base_mm(), oi::kMaxWheelSpeed);
  return {wheels.left_mm_s, wheels.right_mm_s};
}

cargobay_state c_state(const RobotObject& robot, const SeenState& known) CARGOBAY_NONBLOCKING {
  constexpr std::int64_t kTickNs = rt::Duration{oi::kTick}.count();
  const hal::CycleState& state = known.state;
  cargobay_state seen{};
  seen.size = sizeof seen;
  seen.mode = static_cast<std::int32_t>(state.mode);
  seen.tick = state.tick;
  seen.robot_time_ns = state.tick * kTickNs;
  seen.elapsed_ns = known.elapsed_ticks * kTickNs;
  seen.arrival_ns = rt::nanoseconds(state.arrival);
  seen.target = c_wheels(state.target);
  seen.limited = c_wheels(state.set);
  seen.estimate = c_wheels(state.estimate);
  seen.command = c_wheels(state.command);
  const rt::WheelSpeeds& speeds = state.estimate;
  seen.velocity_mm_s = (speeds.left_mm_s + speeds.right_mm_s) / 2.0;
  seen.turn_rate_rad_s = (speeds.right_mm_s - speeds.left_mm_s) / robot.wheel_base_mm();
  seen.x_mm = state.pose.x_mm;
  seen.y_mm = state.pose.y_mm;
  seen.heading_rad = state.pose.heading_rad;
  seen.distance_mm = state.distance_mm;
  const rt::PoseCovariance& p = state.pose_covariance;
  const std::array covariance{p.xx, p.xy, p.xh, p.xy, p.yy, p.yh, p.xh, p.yh, p.hh};
  std::copy(covariance.begin(), covariance.end(), std::begin(seen.covariance));
  seen.remainder = c_remainder(state.remainder);
  seen.setpoint_lapsed = state.setpoint_lapsed ? 1 : 0;
  seen.hazards = state.hazards.raw();
  seen.bumps = c_bumps(state.bumps);
  seen.buttons = known.buttons;
  seen.battery_mv = state.battery_mv;
  seen.limits = state.limits.raw();
  return seen;
}

}  // namespace cargobay::c
