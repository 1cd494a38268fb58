#include "hal/feed/feed_reports.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "hal/cycle/control_cycle.hpp"
#include "hal/feed/world_messages.hpp"
#include "hal/robot/robot.hpp"
#include "hal/sim/remote/control.hpp"

namespace cargobay::hal {

namespace {

constexpr rt::Duration kSecond = std::chrono::seconds{1};

// On the system's clock, which may be set meanwhile.
std::int64_t unix_ns_of(rt::TimePoint time) {
  const auto age = rt::Clock::now() - time;
  const auto then = std::chrono::system_clock::now() - age;
  return std::chrono::nanoseconds{then.time_since_epoch()}.count();
}

// The newest of each packet.
oi::SensorValues values_of(const SensorReadings& readings) {
  oi::SensorValues values;
  for (std::size_t id = 0; id < SensorReadings::kSlots; ++id) {
    if (readings.tick[id] != SensorReadings::kNever)
      values.set(static_cast<oi::PacketId>(id), readings.value[id]);
  }
  return values;
}

void tell_sensors(const SensorReadings& readings, const CycleState& state, const FeedOutlet& to) {
  const SensorRecord record{.stamp = {.unix_ns = unix_ns_of(state.arrival)},
                            .values = values_of(readings),
                            .distance_sum_mm = readings.distance_sum_mm,
                            .angle_sum_deg = readings.angle_sum_deg};
  JsonObject message = to.begin(FeedType::sensors);
  // It may be that of a frame whose state is not there yet.
  put_sensors(message, record, std::ranges::max(readings.tick));
  to.tell(FeedType::sensors, std::move(message));
}

void tell_statistics(Robot& robot, const FeedReports::Readers& readers, const FeedOutlet& to) {
  const ControlCycle& cycle = robot.cycle();
  const auto period_ns = std::make_unique<rt::Histogram>(cycle.period_ns().snapshot());
  const auto frame_to_command_ns =
      std::make_unique<rt::Histogram>(cycle.frame_to_command_ns().snapshot());
  JsonObject message = to.begin(FeedType::statistics);
  put_statistics(message, {.cycle = cycle.counters(),
                           .period_ns = period_ns.get(),
                           .frame_to_command_ns = frame_to_command_ns.get(),
                           .clients = readers.clients,
                           .missed = readers.missed});
  to.tell(FeedType::statistics, std::move(message));
}

void tell_create(sim::Server& create, const FeedOutlet& to) {
  std::string state;
  create.with_cable([&state](sim::Cable& cable) { state = sim::state_json(cable); });
  JsonObject message = to.begin(FeedType::virtual_create);
  message.raw("state", state);
  to.tell(FeedType::virtual_create, std::move(message));
}

}  // namespace

void FeedReports::collect(Robot* robot, const Readers& readers, rt::TimePoint now,
                          const FeedOutlet& to) {
  tell_states(robot, told_, to);
  tell_events(told_, to);
  tell_truth(told_, to);
  if (now < next_second_) return;
  next_second_ = now + kSecond;
  tell_second(robot, readers, to);
}

void FeedReports::greet(Robot* robot, const Readers& readers, const FeedOutlet& to) const {
  if (of_.create != nullptr) {
    JsonObject controls = to.begin(FeedType::controls);
    put_controls(controls);
    to.tell(FeedType::controls, std::move(controls));
  }
  if (of_.world != nullptr) {
    JsonObject world = to.begin(FeedType::world);
    put_world(world, *of_.world);
    to.tell(FeedType::world, std::move(world));
  }
  Told none;
  tell_events(none, to);
  if (of_.tap != nullptr) none.state = std::max<std::int64_t>(of_.tap->states().last() - 1, 0);
  tell_states(robot, none, to);
  tell_truth(none, to);
  tell_second(robot, readers, to);
}

void FeedReports::skip() {
  if (of_.tap == nullptr) return;
  told_.state = of_.tap->states().last();
  told_.event = of_.tap->events().last();
}

void FeedReports::go_on_to(std::int64_t& told, std::int64_t number, FeedType type,
                           const FeedOutlet& to) {
  if (to.lost && number > told + 1) to.lost(type, static_cast<std::uint64_t>(number - told - 1));
  told = number;
}

void FeedReports::tell_states(Robot* robot, Told& told, const FeedOutlet& to) const {
  if (of_.tap == nullptr) return;
  while (const auto entry = of_.tap->states().next(told.state)) {
    go_on_to(told.state, entry->number, FeedType::state, to);
    CycleState state = entry->value;
    // Its frame may lack the packets of a hazard that is still there.
    std::optional<SensorReadings> readings;
    if (robot != nullptr) readings = robot->cycle().sensors();
    if (readings) state.hazards = hazards_in(values_of(*readings));
    JsonObject message = to.begin(FeedType::state);
    put_state(message, {.stamp = {.unix_ns = unix_ns_of(state.arrival)},
                        .state = state,
                        .wheel_base_mm = of_.wheel_base_mm});
    to.tell(FeedType::state, std::move(message));
    // The board has only the newest.
    const bool newest = entry->number == of_.tap->states().last();
    if (readings && newest) tell_sensors(*readings, state, to);
  }
}

void FeedReports::tell_events(Told& told, const FeedOutlet& to) const {
  if (of_.tap == nullptr) return;
  while (const auto entry = of_.tap->events().next(told.event)) {
    go_on_to(told.event, entry->sequence, FeedType::event, to);
    JsonObject message = to.begin(FeedType::event);
    put_event(message, {.stamp = {.unix_ns = unix_ns_of(entry->event.time)}, .event = entry->event},
              entry->sequence);
    to.tell(FeedType::event, std::move(message));
  }
}

void FeedReports::tell_truth(Told& told, const FeedOutlet& to) const {
  if (of_.create == nullptr) return;
  const auto truth = of_.create->newest_truth();
  if (!truth || truth->time.count() == told.truth_ns) return;
  told.truth_ns = truth->time.count();
  JsonObject message = to.begin(FeedType::truth);
  put_truth(message, *truth,
            static_cast<double>(unix_ns_of(of_.create->monotonic(truth->time))) / 1e9);
  to.tell(FeedType::truth, std::move(message));
}

void FeedReports::tell_second(Robot* robot, const Readers& readers, const FeedOutlet& to) const {
  if (robot != nullptr) tell_statistics(*robot, readers, to);
  if (of_.create != nullptr) tell_create(*of_.create, to);
}

}  // namespace cargobay::hal
