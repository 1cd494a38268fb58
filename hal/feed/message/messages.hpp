// The messages of a feed (docs/feed.md): one line of JSON each, without its end.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "hal/columns/records.hpp"
#include "hal/cycle/cycle_state.hpp"
#include "hal/json_object.hpp"
#include "rt/histogram.hpp"

namespace cargobay::hal {

// The version of the format: another one is not understood by those who know only this.
inline constexpr int kFeedVersion = 1;

// Its name in a message's `type`.
enum class FeedType : std::uint8_t {
  hello,
  status,
  state,
  sensors,
  event,
  statistics,
  truth,
  virtual_create,
  world,
  controls,
  holder,
  missed,
  answer,
};
inline constexpr std::size_t kFeedTypes = static_cast<std::size_t>(FeedType::answer) + 1;
std::string_view name(FeedType type);
std::optional<FeedType> feed_type(std::string_view name);

// What a feed is of.
struct FeedIdentity {
  std::string program{};  // "cargobay drive"
  std::string port{};
  bool is_virtual = false;
  std::uint32_t baud = 0;
  bool steerable = false;
  double wheel_base_mm = 0.0;
  rt::Duration setpoint_lapse{};
  rt::Duration lease{};
};

// What has been counted, and the feed's own part.
struct FeedStatistics {
  CycleCounters cycle{};
  const rt::Histogram* period_ns = nullptr;            // or null
  const rt::Histogram* frame_to_command_ns = nullptr;  // likewise
  std::size_t clients = 0;
  std::uint64_t missed = 0;
};

// A message without what it says: its type, and which one of the feed it is. This and all that
// follows allocate.
JsonObject message(FeedType type, std::uint64_t sequence);

void put_hello(JsonObject& message, const FeedIdentity& of);
void put_status(JsonObject& message, std::string_view stage, std::string_view text);
// The columns of the record (hal/columns).
void put_state(JsonObject& message, const StateRecord& state);
// Likewise: every packet that has been read so far. `tick`: of the newest frame.
void put_sensors(JsonObject& message, const SensorRecord& sensors, std::int64_t tick);
void put_event(JsonObject& message, const EventRecord& event, std::int64_t sequence);
void put_statistics(JsonObject& message, const FeedStatistics& statistics);
// Who steers, and the number of the lease; without a name nobody does.
void put_holder(JsonObject& message, const std::optional<std::string>& name, std::uint64_t lease);

}  // namespace cargobay::hal
