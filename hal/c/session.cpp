#include "hal/c/session.hpp"

#include <cxxabi.h>
#include <unistd.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <utility>

#include "hal/c/errors.hpp"
#include "hal/c/robot_object.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::c {
namespace {

// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): each thread's own
__attribute__((tls_model("initial-exec"))) thread_local bool control_runs = false;

// The control function has ended its thread: by pthread_exit(), by a cancellation, or because its
// interpreter ends. The loop cannot go on without a thread, nor end on one that is unwinding: the
// robot is stopped just as when the function does not return.
[[noreturn]] void never_come_back() noexcept {
  for (;;) pause();
}

int code_of(hal::CycleEnd end) noexcept {
  switch (end) {
    case hal::CycleEnd::asked: return CARGOBAY_OK;
    case hal::CycleEnd::link_lost: return CARGOBAY_E_SILENT;
    case hal::CycleEnd::mode_lost: return CARGOBAY_E_MODE;
    case hal::CycleEnd::hung_up: return CARGOBAY_E_UNPLUGGED;
    case hal::CycleEnd::guarded: return CARGOBAY_E_STALLED;
    case hal::CycleEnd::control_overrun:
    case hal::CycleEnd::control_failed: return CARGOBAY_E_CONTROL;
    case hal::CycleEnd::guard_lost: return CARGOBAY_E_GUARD;
    case hal::CycleEnd::implausible: return CARGOBAY_E_WHEELS;
  }
  return CARGOBAY_E_SYSTEM;
}

hal::ControlAnswer answer_of(const RobotObject& robot, const cargobay_output& output)
    CARGOBAY_NONBLOCKING {
  switch (output.kind) {
    case CARGOBAY_OUTPUT_WHEELS:
      return rt::WheelSpeeds{output.wheels.left_mm_s, output.wheels.right_mm_s};
    case CARGOBAY_OUTPUT_TWIST: {
      const cargobay_wheels wheels = wheels_for(robot, output.twist);
      return rt::WheelSpeeds{wheels.left_mm_s, wheels.right_mm_s};
    }
    case CARGOBAY_OUTPUT_SETPOINT: return hal::ControlAnswer::Kind::setpoint;
    default: {
      constexpr double kNoSpeed = std::numeric_limits<double>::quiet_NaN();
      return rt::WheelSpeeds{kNoSpeed, kNoSpeed};  // refused, and counted
    }
  }
}

// As the library keeps it. On the control thread.
SeenState seen_by(const Session& session, const hal::CycleState& state) CARGOBAY_NONBLOCKING {
  SeenState seen{.state = state,
                 .elapsed_ticks = session.last_tick < 0
                                      ? 0
                                      : std::max<std::int64_t>(state.tick - session.last_tick, 0),
                 .buttons = session.buttons()};
  seen.state.tick += session.first_tick;
  seen.state.distance_mm += session.first_distance_mm;
  return seen;
}

// Calls the program's function.
hal::ControlAnswer call(Session& session, const ControlSlot& slot, const hal::CycleState& state) {
  RobotObject& robot = session.object;
  const cargobay_state told = c_state(robot, seen_by(session, state));
  cargobay_output output{};
  output.size = sizeof output;
  control_runs = true;
  int result = 0;
  try {
    result = slot.function(slot.context, &told, &output);
  } catch (const abi::__forced_unwind&) {
    if (robot.in_virtual_time()) std::terminate();  // the program's own thread cannot be kept
    never_come_back();
  } catch (...) {
    session.control_threw.store(true);
    result = -1;
  }
  control_runs = false;
  if (result == 0) return answer_of(robot, output);
  if (!session.control_threw.load()) session.control_result.store(result);
  return result > 0 ? hal::ControlAnswer::Kind::finish : hal::ControlAnswer::Kind::fail;
}

hal::ControlAnswer decide(void* context, const hal::CycleState& state, double /*seconds*/)
    CARGOBAY_NONBLOCKING {
  auto& session = *static_cast<Session*>(context);
  RobotObject& robot = session.object;
  // In one order with RobotObject::set_control(): either it sees the call, or this its change.
  const std::uint32_t calls = robot.control_calls.load(std::memory_order_relaxed);
  robot.control_calls.store(calls + 1, std::memory_order_seq_cst);
  const ControlSlot* const slot = robot.control.load(std::memory_order_seq_cst);
  hal::ControlAnswer answer = hal::ControlAnswer::Kind::setpoint;
  if (slot != nullptr) {
    // The program's own function; the cycle and the guard watch how long it takes.
    answer = rt::unchecked([&]() noexcept { return call(session, *slot, state); });
  }
  robot.control_calls.store(calls + 2, std::memory_order_release);
  return answer;
}

}  // namespace

Session::~Session() {
  if (hal::sim::VirtualLink* const link = virtual_link()) link->set_pass({});
  if (robot) (void)robot->stop();
  recording.reset();  // it reads what the robot's recorder holds
}

hal::ControlFunction Session::control() { return {.function = &decide, .context = this}; }

hal::StateObserver Session::observer() {
  constexpr auto kSee = [](void* context, const hal::CycleState& state) CARGOBAY_NONBLOCKING {
    auto& session = *static_cast<Session*>(context);
    // Frames that were given up, and come after all, take their ticks back: none is told twice.
    if (state.tick <= session.last_tick) return;
    session.object.see(seen_by(session, state));
    session.last_tick = state.tick;
  };
  constexpr auto kHear = [](void* context, const hal::Event& event) CARGOBAY_NONBLOCKING {
    auto& session = *static_cast<Session*>(context);
    hal::Event told = event;
    told.tick += session.first_tick;
    session.object.hear(told);
  };
  constexpr auto kEnded = [](void* context) CARGOBAY_NONBLOCKING {
    static_cast<Session*>(context)->object.descriptor.signal();
  };
  return {.function = kSee, .context = this, .event = kHear, .ended = kEnded};
}

std::uint32_t Session::buttons() const CARGOBAY_NONBLOCKING {
  const oi::BitSet<oi::Button> pressed{
      static_cast<std::uint8_t>(robot->cycle().reading(oi::PacketId::buttons))};
  return (pressed.has(oi::Button::play) ? std::uint32_t{CARGOBAY_BUTTON_PLAY} : 0U) |
         (pressed.has(oi::Button::advance) ? std::uint32_t{CARGOBAY_BUTTON_ADVANCE} : 0U);
}

int Session::must_be_started() const noexcept {
  if (life.load(std::memory_order_acquire) == Life::open)
    return fail(CARGOBAY_E_STATE, "the loop was not started; call cargobay_start() first");
  return CARGOBAY_OK;
}

int Session::must_run() const noexcept {
  if (const int early = must_be_started(); early != CARGOBAY_OK) return early;
  if (life.load(std::memory_order_acquire) == Life::stopped || robot->ended()) {
    return fail(
        CARGOBAY_E_STATE,
        "the loop has ended; cargobay_get_end() says why; cargobay_start() starts it again");
  }
  return CARGOBAY_OK;
}

int Session::request(const hal::Request& wanted) {
  const std::lock_guard lock{requests};
  if (robot->cycle().request(wanted)) return CARGOBAY_OK;
  return fail(CARGOBAY_E_FULL,
              "32 requests are already waiting, and one goes out per frame; try again later");
}

int Session::record() {
  if (!record_file) return CARGOBAY_OK;
  hal::RecordingHeader header = robot->recording_header();
  header.software = "libcargobay " CARGOBAY_VERSION;
  auto writer =
      hal::RecordingWriter::create(std::move(*record_file), header, robot->flight_recorder());
  record_file.reset();
  if (!writer) return fail(CARGOBAY_E_FILE, writer.failure());
  recording = std::move(*writer);
  return CARGOBAY_OK;
}

// Called once the loop runs: a start that fails leaves an older recording untouched.
int Session::publish_record() {
  if (!recording) return CARGOBAY_OK;
  recording->publish();
  if (object.in_virtual_time()) return CARGOBAY_OK;
  if (const std::error_code error = recording->start(); error) {
    return fail(CARGOBAY_E_LIMIT, "cannot start the thread that records: " + error.message() +
                                      "; raise the limit of threads");
  }
  return CARGOBAY_OK;
}

int Session::start() {
  if (const int failed = record(); failed != CARGOBAY_OK) {
    end();
    return failed;
  }
  if (object.in_virtual_time()) {
    robot->start_stepped(control());
    // While time moves for another robot of the world.
    virtual_link()->set_pass([this] { step(robot->now()); });
    grant.emplace();
  } else {
    auto granted = robot->start(control());
    if (!granted) {
      end();
      const bool refused = granted.failure().code == std::errc::operation_not_permitted;
      return fail(refused ? static_cast<int>(CARGOBAY_E_RIGHTS)
                          : c::code_of(granted.failure(), object.opening),
                  granted.failure());
    }
    grant = *granted;
  }
  if (const int failed = publish_record(); failed != CARGOBAY_OK) {
    end();
    return failed;
  }
  life.store(Life::running, std::memory_order_release);
  if (object.feed) object.feed->report("driving", "the robot is under control of this program");
  return CARGOBAY_OK;
}

void Session::step(rt::TimePoint until) {
  if (robot->ended()) return;
  (void)robot->step(until);
  if (recording) recording->append();
}

// What moves it in virtual time; none in real time.
hal::sim::VirtualLink* Session::virtual_link() const {
  return object.in_virtual_time() ? object.opening.sim->link.get() : nullptr;
}

void Session::end() {
  if (hal::sim::VirtualLink* const link = virtual_link()) link->set_pass({});
  const hal::Robot::Farewell left = robot->stop();
  {
    const std::lock_guard lock{ending_};
    if (!farewell_) farewell_ = left;
  }
  life.store(Life::stopped, std::memory_order_release);
  if (object.feed) object.feed->report("lost", words_of(*this, left).message);
  if (!recording) return;
  if (const auto& done = recording->finish(); !done) {
    const std::lock_guard lock{ending_};
    unrecorded_why_ = done.failure().message;
  }
}

std::optional<hal::Robot::Farewell> Session::farewell() {
  const std::lock_guard lock{ending_};
  if (farewell_) return farewell_;
  if (life.load(std::memory_order_acquire) == Life::open || !robot->ended()) return std::nullopt;
  return robot->end_so_far();
}

std::string Session::unrecorded_why() const {
  const std::lock_guard lock{ending_};
  return unrecorded_why_;
}

int Session::outcome() {
  const auto known = farewell();
  const EndWords words = words_of(*this, *known);
  return words.code == CARGOBAY_OK ? words.code : fail(words.code, words.message);
}

EndWords words_of(const Session& session, const hal::Robot::Farewell& farewell) {
  if (session.control_threw.load()) {
    return {CARGOBAY_E_CONTROL,
            "an exception left the control function, and the robot was stopped; catch it there"};
  }
  const int code = code_of(farewell.end);
  if (farewell.end == hal::CycleEnd::control_failed) {
    return {
        code,
        "the control function returned " + std::to_string(session.control_result.load()) +
            ", and the robot was stopped; look up what the program means by it, then start again"};
  }
  if (code != CARGOBAY_OK) return {code, hal::explain(farewell)};
  if (!farewell.robot.standing()) return {CARGOBAY_E_UNCONFIRMED, hal::explain(farewell)};
  std::string unrecorded = session.unrecorded_why();
  return unrecorded.empty() ? EndWords{} : EndWords{CARGOBAY_E_FILE, std::move(unrecorded)};
}

bool in_control() noexcept { return control_runs; }

int not_from_control(const char* function) noexcept {
  return guarded([&] {
    return fail(CARGOBAY_E_THREAD,
                std::string{function} +
                    "() waits for the loop, and the loop for this control function; call "
                    "cargobay_request_end() here, and this from another thread");
  });
}

}  // namespace cargobay::c
