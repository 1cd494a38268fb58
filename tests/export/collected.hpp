// Keeps the records of a drive.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/export/record_sink.hpp"
#include "hal/export/retelling.hpp"

namespace cargobay::hal::test {

struct Collected final : RecordSink {
  void take(const StateRecord& record) override { states.push_back(record); }
  void take(const SensorRecord& record) override { sensors.push_back(record); }
  void take(const EventRecord& record) override { events.push_back(record); }
  void take(const CommandRecord& record) override {
    commands.emplace_back(record.bytes.begin(), record.bytes.end());
  }
  bool wants_more() const override { return states.size() < most_states; }

  std::size_t most_states = SIZE_MAX;
  std::vector<StateRecord> states{};
  std::vector<SensorRecord> sensors{};
  std::vector<EventRecord> events{};
  std::vector<std::vector<std::uint8_t>> commands{};
};

inline Retelling retold(const std::vector<std::uint8_t>& file, RecordSink& sink) {
  const auto recording = Recording::read(file);
  EXPECT_TRUE(recording) << recording.failure().message;
  return retell(*recording, sink);
}

}  // namespace cargobay::hal::test
