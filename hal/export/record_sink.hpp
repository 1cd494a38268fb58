// Who is told the records of a drive, one after the other, and where they go.
#pragma once

#include <functional>
#include <string_view>

#include "hal/columns/records.hpp"
#include "hal/result.hpp"
#include "oi/bit_set.hpp"

namespace cargobay::hal {

using Topics = oi::BitSet<Topic>;
inline constexpr Topics kAllTopics{(1U << kTopics) - 1U};

// Records come in the order of the frames: of one frame its sensors, then commands, events and the
// state. Within a topic, time does not go back. One thread.
class RecordSink {
 public:
  RecordSink() = default;
  virtual ~RecordSink() = default;
  RecordSink(const RecordSink&) = delete;
  RecordSink& operator=(const RecordSink&) = delete;

  virtual void take(const StateRecord& record) = 0;
  virtual void take(const SensorRecord& record) = 0;
  virtual void take(const EventRecord& record) = 0;
  virtual void take(const CommandRecord& record) = 0;
  // False: whatever comes is of no use any longer.
  virtual bool wants_more() const = 0;
};

// Writes the records to a file.
class Export : public RecordSink {
 public:
  // What went wrong so far: nothing is written after it.
  virtual const Result<void>& written() const = 0;
  bool wants_more() const final { return static_cast<bool>(written()); }
  // Call once, after the last record: writes what is left. Returns written().
  virtual Result<void> finish() = 0;
};

// Takes all of the bytes, or fails.
using WriteBytes = std::function<Result<void>(std::string_view bytes)>;

}  // namespace cargobay::hal
