#include "hal/feed/message/messages.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

#include "oi/limits.hpp"

namespace cargobay::hal {

namespace {

constexpr std::array<std::string_view, kFeedTypes> kTypeNames{
    "hello",          "status", "state",    "sensors", "event",  "statistics", "truth",
    "virtual_create", "world",  "controls", "holder",  "missed", "answer"};

// Pairs of a value and how often a duration was at most that, and above the pair's before. A bucket
// is a sixteenth of its power of two: fine enough for a drawing.
std::string histogram_json(const rt::Histogram& histogram) {
  JsonArray pairs;
  std::uint64_t end = 0;
  std::uint64_t count = 0;
  const auto put = [&] {
    if (count > 0) pairs.raw(JsonArray{}.raw(digits(end)).raw(digits(count)).take());
    count = 0;
  };
  histogram.visit([&](std::uint64_t value, std::uint64_t more) {
    constexpr unsigned kBits = 4;
    const unsigned width = static_cast<unsigned>(std::bit_width(value));
    const unsigned shift = width > kBits + 1 ? width - kBits - 1 : 0;
    const std::uint64_t last = (((value >> shift) + 1) << shift) - 1;
    if (last != end) put();
    end = last;
    count += more;
  });
  put();
  return pairs.take();
}

JsonObject percentiles_json(const rt::Histogram& histogram) {
  JsonObject object;
  object.number("count", histogram.count())
      .number("min", histogram.min())
      .number("p50", histogram.percentile(50))
      .number("p90", histogram.percentile(90))
      .number("p99", histogram.percentile(99))
      .number("p999", histogram.percentile(99.9))
      .number("max", histogram.max())
      .raw("histogram", histogram_json(histogram));
  return object;
}

}  // namespace

std::string_view name(FeedType type) { return kTypeNames[static_cast<std::size_t>(type)]; }

std::optional<FeedType> feed_type(std::string_view name) {
  const auto* const found = std::ranges::find(kTypeNames, name);
  if (found == kTypeNames.end()) return std::nullopt;
  return static_cast<FeedType>(found - kTypeNames.begin());
}

JsonObject message(FeedType type, std::uint64_t sequence) {
  JsonObject object;
  object.text("type", name(type)).number("seq", sequence);
  return object;
}

void put_hello(JsonObject& message, const FeedIdentity& of) {
  message.number("feed", kFeedVersion)
      .text("cargobay", CARGOBAY_VERSION)
      .text("program", of.program)
      .number("pid", getpid())
      .text("port", of.port)
      .number("baud", of.baud)
      .text("robot", of.is_virtual ? "virtual Create" : "robot")
      .truth("steerable", of.steerable)
      .number("wheel_base_mm", of.wheel_base_mm)
      .number("max_speed_mm_s", oi::kMaxWheelSpeed)
      .number("tick_s", rt::seconds(oi::kTick))
      .number("setpoint_lapse_s", rt::seconds(of.setpoint_lapse))
      .number("lease_s", rt::seconds(of.lease));
}

void put_status(JsonObject& message, std::string_view stage, std::string_view text) {
  message.text("stage", stage).text("text", text);
}

void put_state(JsonObject& message, const StateRecord& state) {
  put_columns(message, state_columns(), state);
}

void put_sensors(JsonObject& message, const SensorRecord& sensors, std::int64_t tick) {
  message.number("tick", tick).number("robot_time_s", robot_time_s(tick));
  put_columns(message, sensor_columns(), sensors);
}

void put_event(JsonObject& message, const EventRecord& event, std::int64_t sequence) {
  message.number("sequence", sequence);
  put_columns(message, event_columns(), event);
}

void put_statistics(JsonObject& message, const FeedStatistics& statistics) {
  const FrameCounters& frames = statistics.cycle.frames;
  const PhaseOverruns& late = statistics.cycle.overruns;
  JsonObject counted;
  counted.number("good", frames.good)
      .number("bad", frames.bad)
      .number("lost", frames.lost)
      .number("late", frames.late);
  JsonObject overruns;
  overruns.number("wait", late.wait)
      .number("read", late.read)
      .number("user", late.user)
      .number("write", late.write);
  message.object("frames", std::move(counted))
      .object("overruns", std::move(overruns))
      .number("unsent", statistics.cycle.unsent)
      .number("withheld", statistics.cycle.withheld)
      .number("refused", statistics.cycle.refused);
  if (statistics.period_ns != nullptr)
    message.object("period_ns", percentiles_json(*statistics.period_ns));
  if (statistics.frame_to_command_ns != nullptr)
    message.object("frame_to_command_ns", percentiles_json(*statistics.frame_to_command_ns));
  message.number("clients", statistics.clients).number("missed", statistics.missed);
}

void put_holder(JsonObject& message, const std::optional<std::string>& name, std::uint64_t lease) {
  name ? message.text("name", *name).number("lease", lease)
       : message.raw("name", "null").raw("lease", "null");
}

}  // namespace cargobay::hal
