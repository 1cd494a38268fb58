#include "hal/export/retelling.hpp"

#include <algorithm>

#include "rt/unchecked.hpp"

namespace cargobay::hal {
namespace {

// When the recorded clock was first asked; before that, an entry has no time.
rt::TimePoint first_time(const Recording& recording) {
  Entry entry;
  for (EntryCursor cursor{recording.blocks()}; cursor.next(entry);) {
    if (entry.kind == EntryKind::clock) return entry.time;
  }
  return {};
}

// Goes through the recording beside the replay, up to the tick that this has come to.
struct BesideReplay {
  RecordSink& sink;
  EntryCursor cursor;
  Narrator narrator;
  EntryKind kind = EntryKind::clock;  // of the last entry

  // False after the last entry.
  bool go_on() {
    Entry entry;
    if (!sink.wants_more() || !cursor.next(entry)) return false;
    narrator.take(entry);
    kind = entry.kind;
    return true;
  }
  static void replayed(void* context, const CycleState& state) CARGOBAY_NONBLOCKING {
    rt::unchecked([&] {  // not in real time
      auto& self = *static_cast<BesideReplay*>(context);
      if (!self.sink.wants_more()) return;
      self.narrator.know(state);
      while (self.go_on() && self.kind != EntryKind::state) {
      }
    });
  }
  static void noted(void* context, const Event& event) CARGOBAY_NONBLOCKING {
    rt::unchecked([&] { static_cast<BesideReplay*>(context)->narrator.know(event); });
  }
};

}  // namespace

void Narrator::know(const Event& event) {
  // Some are noted by another thread than the loop's.
  const auto after = std::ranges::upper_bound(events_, event.time, {}, &Event::time);
  events_.insert(after, event);
}

void Narrator::take(const Entry& entry) {
  if (entry.time >= origin_.time) time_ = entry.time;
  if (entry.kind == EntryKind::read) hear(entry.bytes);
  if (entry.kind == EntryKind::wrote) say(entry.bytes.first(entry.transfer.count));
  if (entry.kind == EntryKind::state) tell_state(entry.state);
}

void Narrator::begin_link() {
  decoder_.reset();
  parser_.reset();
}

void Narrator::finish() {
  if (!sink_.wants_more()) return;
  for (; !states_.empty(); states_.pop_front())
    tell_state(states_.front(), StateRecord::Extent::whole);
  tell_events_up_to(rt::TimePoint::max());
}

void Narrator::hear(std::span<const std::uint8_t> bytes) {
  decoder_.push(bytes, [this](oi::StreamDecoder::Outcome outcome) {
    if (outcome != oi::StreamDecoder::Outcome::frame) return;
    sensors_.stamp = stamp(time_);
    sensors_.values.clear();
    (void)oi::decode_frame(decoder_.frame(), sensors_.values);  // its structure was checked
    sensors_.distance_sum_mm += sensors_.values.raw(oi::PacketId::distance);  // 0 if it has none
    sensors_.angle_sum_deg += sensors_.values.raw(oi::PacketId::angle);
    ++counts_.sensors;
    sink_.take(sensors_);
  });
}

void Narrator::say(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    if (parser_.push(byte) == oi::CommandParser::Outcome::incomplete) continue;
    ++counts_.commands;
    sink_.take(CommandRecord{.stamp = stamp(time_), .bytes = parser_.bytes()});
  }
}

void Narrator::tell_state(const CycleState& recorded) {
  while (!states_.empty() && states_.front().arrival <= recorded.arrival) {
    const CycleState state = states_.front();
    states_.pop_front();
    tell_state(state, StateRecord::Extent::whole);
    if (state.arrival == recorded.arrival) return;
  }
  tell_state(recorded, StateRecord::Extent::recorded);
}

void Narrator::tell_state(const CycleState& state, StateRecord::Extent extent) {
  tell_events_up_to(state.arrival);
  ++counts_.states;
  if (extent == StateRecord::Extent::recorded) ++counts_.partial_states;
  sink_.take(StateRecord{.stamp = stamp(state.arrival),
                         .state = state,
                         .extent = extent,
                         .wheel_base_mm = wheel_base_mm_});
}

void Narrator::tell_events_up_to(rt::TimePoint time) {
  for (; !events_.empty() && events_.front().time <= time; events_.pop_front()) {
    ++counts_.events;
    sink_.take(EventRecord{.stamp = stamp(events_.front().time), .event = events_.front()});
  }
}

Stamp Narrator::stamp(rt::TimePoint time) const {
  const rt::Duration since = time - origin_.time;
  return {.unix_ns = origin_.unix_ns + since.count(), .time_s = rt::seconds(since)};
}

Retelling retell(const Recording& recording, RecordSink& sink) {
  const RecordingHeader& header = recording.header();
  BesideReplay beside{
      .sink = sink,
      .cursor = EntryCursor{recording.blocks()},
      .narrator = Narrator{sink,
                           {.unix_ns = header.started_ns, .time = first_time(recording)},
                           header.parameters.loop.estimator.wheel_base_mm}};
  const auto replayed = replay(
      recording,
      {.function = &BesideReplay::replayed, .context = &beside, .event = &BesideReplay::noted});
  while (beside.go_on()) {
  }
  beside.narrator.finish();
  Retelling result{.counts = beside.narrator.counts()};
  if (replayed) result.difference = replayed->difference;  // without a beginning, nothing was
  return result;
}

}  // namespace cargobay::hal
