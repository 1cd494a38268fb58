#include "hal/robot/robot.hpp"

#include <malloc.h>

#include <cerrno>
#include <chrono>
#include <mutex>
#include <string>
#include <utility>

#include "hal/port/port_users.hpp"
#include "hal/stream/spaced_stream.hpp"
#include "hal/trouble.hpp"
#include "oi/stream_budget.hpp"

namespace cargobay::hal {
namespace {

// From the robot's tick to the arrival of the command that answers its frame: both on the wire, and
// a little for the software.
double input_delay_s(std::uint32_t baud, std::size_t frame_bytes) {
  constexpr rt::Duration kSoftware = std::chrono::microseconds{200};
  return rt::seconds(oi::wire_time(frame_bytes, baud) + sending_time(oi::kDriveDirectBytes, baud) +
                     kSoftware);
}

Failure refused(const rt::RealtimeGrant& grant) {
  std::string message = "real-time rights are required but";
  for (const rt::Refusal& refusal : grant.refusals) {
    if (refusal.right == rt::Refusal::Right::fifo ||
        refusal.right == rt::Refusal::Right::memory_lock)
      message += " " + rt::explain(refusal) + ";";
  }
  message += " or leave out --require-rt";
  return {std::move(message), std::make_error_code(std::errc::operation_not_permitted)};
}

constexpr const char* kGuardLost = "the guard process died or was suspended";
constexpr const char* kGuardRemedy =
    "find out what did that (dmesg reports memory running out), then start again";

// A robot that was lifted also sees cliffs.
std::string remedy(Hazards causes) {
  if (causes.has(Hazard::wheel_drop_left) || causes.has(Hazard::wheel_drop_right) ||
      causes.has(Hazard::wheel_drop_front)) {
    return "set it on its wheels";
  }
  return causes.has(Hazard::charger) ? "unplug it" : "move it away from the edge";
}

}  // namespace

Robot::Robot(std::unique_ptr<ByteStream> stream, std::unique_ptr<Duty> duty,
             const RobotOptions& options, const BringUpReport& report)
    : stream_{std::move(stream)},
      options_{options},
      report_{report},
      keeper_{options.learnt},
      recorder_{options.recorder_bytes},
      recorded_{stream_->at_this_rate(), recorder_},
      duty_{std::move(duty)} {
  options_.cycle.loop.estimator.input_delay_s =
      input_delay_s(stream_->baud(), options_.cycle.dialect->frame_bytes);
  const auto former = keeper_.begin();
  auto& prior = options_.cycle.loop.estimator.prior;
  if (!prior) prior = former;
  cycle_ = std::make_unique<ControlCycle>(recorded_, options_.cycle);
  cycle_->set_observer(observer());
  if (Guard* const guard = duty_->guard()) cycle_->set_guard(guard->mark());
}

Robot::~Robot() { (void)stop(); }

void Robot::Deleter::operator()(Robot* robot) const {
  (void)robot->stop();
  if (robot->lost()) {
    // Kept where a leak checker sees that it is not a leak.
    static std::mutex keeping;
    static std::vector<Robot*>& kept = *new std::vector<Robot*>;
    const std::lock_guard lock{keeping};
    kept.push_back(robot);
    return;
  }
  delete robot;
}

Result<Robot::Owned> Robot::open(std::unique_ptr<ByteStream> stream, const RobotOptions& options) {
  auto duty = Duty::begin(*stream, options.guard, options.realtime.priority);
  if (!duty) return duty.failure();
  Parting left = Parting::unconfirmed;
  const oi::Dialect& dialect = *options.cycle.dialect;
  const auto report = bring_up(*stream, {.dialect = &dialect,
                                         .mode = options.cycle.drive_mode,
                                         .packets = dialect.list(FrameList::reading),
                                         .pins = options.pins,
                                         .progress = options.progress,
                                         .cancelled = options.cancelled,
                                         .left = &left});
  if (!report) {
    Failure failure = report.failure();
    const Discharge discharge = (*duty)->discharge_after(left);
    failure.message += fate(discharge);
    // Of a robot that was never heard, or whose port is gone, nothing was to be confirmed.
    const bool heard = failure.code == Trouble::unruly || failure.code == Trouble::wrong_mode;
    if (heard && !discharge.standing()) failure.code = Trouble::unconfirmed;
    return failure;
  }
  Owned robot{new Robot{std::move(stream), std::move(*duty), options, *report}};
  if (const std::error_code error = robot->stream_->set_wake_threshold(dialect.frame_bytes);
      error) {
    return Failure{"cannot set the port to wake once a frame: " + error.message(), error};
  }
  return robot;
}

Result<rt::RealtimeGrant> Robot::start(const ControlFunction& control) {
  cycle_->set_control(control);
  if (duty_->guard() != nullptr && !duty_->guard()->alive()) {
    (void)stop();  // the failure is what matters
    return Failure{std::string{kGuardLost} + ", and the robot was not driven; " + kGuardRemedy,
                   Trouble::guard};
  }
  // The thread waits for the decision: without the required rights the robot never moves.
  rt::RealtimeRequest wanted = options_.realtime;
  wanted.memory = memory_of_loop();
  rt::RealtimeGrant grant = thread_.start(wanted, [this] {
    permission_.wait(Permission::pending, std::memory_order_acquire);
    if (permission_.load(std::memory_order_acquire) == Permission::run) run();
    announce_end();
  });
  if (!thread_.running()) {
    return Failure{"cannot start the control thread: " + rt::explain(grant.refusals.back()),
                   Trouble::no_thread};
  }
  const bool refuse = options_.require_realtime && !grant.complete();
  permission_.store(refuse ? Permission::refused : Permission::run, std::memory_order_release);
  permission_.notify_one();
  if (refuse) {
    (void)stop();  // the refusal is what matters
    return refused(grant);
  }
  start_port_watch();
  return grant;
}

// On the control thread. The robot is left before anyone asks what became of it: the program may
// not look for a long time.
void Robot::run() {
  Guard* const guard = duty_->guard();
  if (guard != nullptr) guard->begin_driving();
  const CycleEnd end = cycle_->run();
  if (!ended()) note_end(end);  // else it was given up, and its recording has been read
  if (guard != nullptr) guard->end_driving();
  announce_end();
  leave();
}

// On the control thread, the owner's, or in virtual time the only one.
void Robot::announce_end() {
  ended_.store(true, std::memory_order_release);
  doorbell_.ring();
  for (const StateObserver& other : options_.observers) {
    if (other.ended != nullptr) other.ended(other.context);
  }
}

// All that a pass touches, except code and the control function's own memory.
std::vector<rt::Memory> Robot::memory_of_loop() const {
  const auto on_heap = [](const void* object) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-const-cast): it only asks
    const std::size_t bytes = malloc_usable_size(const_cast<void*>(object));
    return rt::Memory{static_cast<const std::byte*>(object), bytes};
  };
  std::vector<rt::Memory> memory{on_heap(this), on_heap(cycle_.get()), on_heap(cycle_->memory()),
                                 on_heap(dynamic_cast<const void*>(stream_.get())),
                                 recorder_.memory()};
  if (const Guard* const guard = duty_->guard()) memory.push_back(guard->memory());
  memory.insert(memory.end(), options_.memory.begin(), options_.memory.end());
  return memory;
}

void Robot::tell(const Event& event) const CARGOBAY_NONBLOCKING {
  for (const StateObserver& other : options_.observers) {
    if (other.event != nullptr) other.event(other.context, event);
  }
}

// The robot drives without it too.
void Robot::start_port_watch() {
  const std::string path = path_of(stream_->terminal().descriptor);
  if (path.empty()) return;
  const auto look_up = [this] {
    const FrameCounters frames = cycle_->counters().frames;
    const auto state = cycle_->state();
    keeper_.now_and_then(cycle_->learnt(), rt::Clock::now());
    return PortWatch::Progress{.missed = frames.bad + frames.lost, .tick = state ? state->tick : 0};
  };
  (void)port_watch_.start(path, look_up, [this](const Event& event) { tell(event); });
}

// Called by the control thread, or by the owner that has given it up: whichever comes first.
void Robot::leave() {
  if (left_.exchange(true)) return;
  Guard* const guard = duty_->guard();
  if (guard != nullptr && guard->took_robot())
    cycle_end_.store(CycleEnd::guarded, std::memory_order_relaxed);
  // One farewell is enough for a robot that has been silent for a second.
  const bool silent = cycle_end_.load(std::memory_order_relaxed) == CycleEnd::link_lost;
  const bool guard_tries = silent && guard != nullptr && guard->alive();
  farewell_.robot = guard_tries ? duty_->discharge_after(Parting::unconfirmed)
                                : duty_->discharge(cycle_->owed_bytes());
}

void Robot::note_end(CycleEnd end) {
  cycle_end_.store(end, std::memory_order_relaxed);  // whoever sees ended_ sees this
  recorder_.ended(end);
}

// Record first: whoever is woken may look.
StateObserver Robot::observer() {
  constexpr auto kSee = [](void* context, const CycleState& state) CARGOBAY_NONBLOCKING {
    auto& robot = *static_cast<Robot*>(context);
    robot.recorder_.state(state);
    for (const StateObserver& other : robot.options_.observers) {
      if (other.function != nullptr) other.function(other.context, state);
    }
    robot.doorbell_.ring();
  };
  constexpr auto kTell = [](void* context, const Event& event) CARGOBAY_NONBLOCKING {
    static_cast<const Robot*>(context)->tell(event);
  };
  constexpr auto kHear = [](void* robot, const Request& request) CARGOBAY_NONBLOCKING {
    static_cast<Robot*>(robot)->recorder_.asked(request);
  };
  return {.function = kSee, .context = this, .request = kHear, .event = kTell};
}

void Robot::start_stepped(const ControlFunction& control) {
  cycle_->set_control(control);
  cycle_->begin();
  stepped_ = true;
}

Robot::Stepped Robot::step(rt::TimePoint deadline) {
  const std::uint32_t before = doorbell_.rings();
  while (!ended()) {
    if (!cycle_->pass()) {
      note_end(cycle_->finish());
      announce_end();
      return Stepped::ended;
    }
    if (doorbell_.rings() != before) return Stepped::frame;
    if (stream_->now() >= deadline) return Stepped::timed_out;
  }
  return Stepped::ended;
}

RecordingHeader Robot::recording_header() const {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch();
  return {.baud = stream_->baud(),
          .started_ns = std::chrono::duration_cast<rt::Duration>(since_1970).count(),
          .parameters = options_.cycle};
}

// In slices: a machine that was suspended as a whole has used up only one of them.
bool Robot::ends_in_time() {
  constexpr int kSlices = 10;
  for (int i = 0; i < kSlices; ++i) {
    const std::uint32_t rings = doorbell_.rings();
    if (ended()) return true;
    (void)doorbell_.wait(rings, rt::Clock::now() + kLoopEnds / kSlices);  // the loop looks
  }
  return ended();
}

void Robot::abandon() {
  farewell_.abandoned = true;
  cycle_->abandon();
  if (Guard* const guard = duty_->guard()) guard->take_over();
  cycle_end_.store(CycleEnd::guarded, std::memory_order_relaxed);
  announce_end();  // for threads that wait for a frame
  farewell_.robot = duty_->discharge();
}

bool Robot::lost() {
  if (!lost_ && farewell_.abandoned && !thread_.try_join()) {
    thread_.detach();
    lost_ = true;
  }
  return lost_;
}

bool Robot::guard_has_taken() const {
  const Guard* const guard = duty_->guard();
  return guard != nullptr && guard->has_taken();
}

bool Robot::stalled() const {
  if (guard_has_taken()) return true;
  const auto passed = cycle_->last_pass();
  return passed && rt::Clock::now() - *passed >= options_.guard.deadline;
}

Robot::Farewell Robot::end_so_far() const {
  const CycleEnd end = cycle_end_.load(std::memory_order_relaxed);  // ended() ordered it
  const bool abandoned = end == CycleEnd::guarded && !guard_has_taken();
  // The causes belong to the control thread, which may still be away if the end is another.
  return {.end = end,
          .robot = {.parting = Parting::standing},  // nothing to report about it yet
          .abandoned = abandoned,
          .causes = end == CycleEnd::mode_lost ? cycle_->mode_loss_causes() : Hazards{},
          .port_error = end == CycleEnd::hung_up ? cycle_->port_error() : 0};
}

Robot::Farewell Robot::stop() {
  if (std::exchange(stopped_, true)) return farewell_;
  cycle_->request_stop();
  if (thread_.running() && !ends_in_time() && !left_.exchange(true)) {
    abandon();
  } else {
    thread_.join();
    if (stepped_) (void)step(rt::TimePoint::max());  // its end, as requested
    leave();                                         // unless the thread has
    farewell_.causes = cycle_->mode_loss_causes();
    farewell_.port_error = cycle_->port_error();
  }
  farewell_.end = cycle_end_.load(std::memory_order_relaxed);  // join(), or this thread, ordered it
  port_watch_.stop();
  if (!farewell_.abandoned) keeper_.keep(cycle_->learnt());
  if (farewell_.end != CycleEnd::asked) farewell_.last = last_exchanges(recorder_, kLastFrames);
  return farewell_;
}

namespace {

std::string explain_port(int error) {
  if (error == EBADF) {
    return "this program closed the port's descriptor under the library, as close_range() does; "
           "leave descriptors that are not its own open";
  }
  if (error == 0 || error == EIO) {
    return "the port hung up: unplugged, or the virtual Create ended; plug it in and start again";
  }
  return "the port failed (" + std::generic_category().message(error) + "); start again";
}

std::string explain_end(const Robot::Farewell& farewell) {
  switch (farewell.end) {
    case CycleEnd::asked: return "";
    case CycleEnd::link_lost:
      return "the robot fell silent; check the cable and the battery, then start again";
    case CycleEnd::mode_lost:
      if (farewell.causes.any()) {
        return describe(farewell.causes) + ": the robot stopped and left its mode; " +
               remedy(farewell.causes) + ", then start again";
      }
      return "the robot left its mode and stopped, and no sensor says why: something it saw for an "
             "instant, or its power button; look at it, then start again";
    case CycleEnd::hung_up: return explain_port(farewell.port_error);
    case CycleEnd::guarded:
      if (farewell.abandoned) {
        return "the control function has not returned, and the robot was stopped without it; its "
               "thread cannot be ended, nor its resources freed: end the program";
      }
      return "the loop was stalled for too long: the program was suspended, its control function "
             "did not return, or other programs took the CPU; see: cargobay doctor";
    case CycleEnd::control_overrun:
      return "the control function exceeded its time budget too many times in a row, and the robot "
             "was stopped; do less in it, leave the rest to another thread, or raise "
             "control_budget";
    case CycleEnd::control_failed:
      return "the control function failed, and the robot was stopped; see in the program why it "
             "did, "
             "then start again";
    case CycleEnd::implausible:
      return "a wheel is stuck, or the counters for distance and angle cannot be true (the event "
             "says which), and the robot was stopped; look at its wheels, then start again, or let "
             "it drive all the same with stop_if_implausible = false";
    case CycleEnd::guard_lost:
      return std::string{kGuardLost} + ", and the robot was stopped; " + kGuardRemedy;
  }
  return "";
}

}  // namespace

std::string explain(const Robot::Farewell& farewell) {
  const std::string end = explain_end(farewell);
  if (!end.empty()) return end + fate(farewell.robot);
  if (farewell.robot.standing()) return "";
  return "the robot was told to stop and go Passive, but did not confirm: it may be moving; look "
         "at "
         "it, and press its power button if it does";
}

}  // namespace cargobay::hal
