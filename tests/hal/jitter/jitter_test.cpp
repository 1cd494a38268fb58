// What the timing-jitter benchmark computes from instants, without a clock.
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "hal/doctor/conditions.hpp"
#include "hal/jitter/bootstrap.hpp"
#include "hal/jitter/channel.hpp"

namespace cargobay::hal::jitter {
namespace {

using std::chrono_literals::operator""ms;

Instants frame(std::int64_t complete_ns, std::int64_t latency_ns) {
  Instants frame{.complete_ns = complete_ns};
  frame.set(Stage::woken, complete_ns + latency_ns / 2);
  frame.set(Stage::written, complete_ns + latency_ns);
  return frame;
}

TEST(JitterRecorder, CountsBehindItsWarmUp) {
  Measured measured{.period = 1ms};
  Recorder recorder{measured, {.warm_up = 3, .slice_frames = 5}};
  for (int i = 0; i < 8; ++i) recorder.take(frame(i * 1'000'000, i < 3 ? 900'000 : 100'000));
  EXPECT_EQ(measured.frames, 5U);
  EXPECT_EQ(measured.raw.count(), 5U);
  EXPECT_EQ(measured.raw.max(), 100'000U) << "the warm-up is left out";
  EXPECT_EQ(measured.slices.back().headline_ns.size(), 5U);
  EXPECT_EQ(measured.stages[static_cast<std::size_t>(Stage::woken)].max(), 50'000U);
  EXPECT_FALSE(measured.seen[static_cast<std::size_t>(Stage::decided)]);
  EXPECT_FALSE(measured.seen[static_cast<std::size_t>(Stage::arrived)]);
}

TEST(JitterRecorder, CountsWhatWaitedBehindALateOne) {
  Measured measured{.period = 1ms};
  Recorder recorder{measured, {.warm_up = 0, .slice_frames = 2}};
  recorder.take(frame(0, 100'000));
  recorder.take(frame(1'000'000, 3'500'000));
  EXPECT_EQ(measured.raw.count(), 2U);
  // 3.5, 2.5, 1.5 and 0.5 ms beside the first.
  EXPECT_EQ(measured.headline_ns().count(), 5U);
  EXPECT_EQ(measured.headline_ns().max(), 3'500'000U);
}

TEST(JitterRecorder, TakesAStampBeforeItsBeginningForNone) {
  Measured measured{.period = 1ms};
  Recorder recorder{measured, {.warm_up = 0, .slice_frames = 1}};
  recorder.take(frame(1'000'000, -500));
  EXPECT_EQ(measured.raw.max(), 0U);
}

// Slices with similar values: `shift` from slice to slice.
std::vector<Slice> slices(double scale, double shift, unsigned seed) {
  std::mt19937 random{seed};
  std::lognormal_distribution<double> values{0.0, 0.3};
  std::normal_distribution<double> moods{0.0, shift};
  std::vector<Slice> all(30);
  for (Slice& slice : all) {
    const double mood = std::exp(moods(random));
    for (int i = 0; i < 100; ++i)
      slice.headline_ns.push_back(
          static_cast<std::uint32_t>(10'000.0 * scale * mood * values(random)));
  }
  return all;
}

TEST(Bootstrap, KnowsAPercentile) {
  const std::vector<Slice> all{{.headline_ns = {5, 1, 3}}, {.headline_ns = {2, 4}}};
  EXPECT_EQ(percentile(all, 50), 3.0);
  EXPECT_EQ(percentile(all, 100), 5.0);
  EXPECT_EQ(percentile(all, 0), 1.0);
  EXPECT_EQ(percentile({}, 50), 0.0);
}

// For a hundred pairs of the same thing, about 95 intervals contain 1; a difference of a tenth
// shows.
TEST(Bootstrap, IsAsSureAsItSays) {
  int holds = 0;
  int sees = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    const auto a = slices(1.0, 0.05, 2 * seed);
    const auto b = slices(1.0, 0.05, 2 * seed + 1);
    const Estimate same = ratio_of_percentiles(a, b, 50, seed, 100);
    if (same.low <= 1.0 && same.high >= 1.0) ++holds;
    const Estimate more = ratio_of_percentiles(slices(1.1, 0.05, 2 * seed), b, 50, seed, 100);
    if (more.low > 1.0) ++sees;
  }
  EXPECT_GE(holds, 86);
  EXPECT_LE(holds, 100);
  EXPECT_GE(sees, 95);
}

// Neighbours are alike, because the machine has moods: single values would look more certain.
TEST(Bootstrap, IsLessSureWhereSlicesDiffer) {
  const Estimate calm = ratio_of_percentiles(slices(1.0, 0.0, 1), slices(1.0, 0.0, 2), 50);
  const Estimate moody = ratio_of_percentiles(slices(1.0, 0.2, 1), slices(1.0, 0.2, 2), 50);
  EXPECT_GT(moody.high - moody.low, 5.0 * (calm.high - calm.low));
}

TEST(Bootstrap, GivesTheSameAgain) {
  const auto a = slices(1.0, 0.1, 1);
  const auto b = slices(1.0, 0.1, 2);
  EXPECT_EQ(ratio_of_percentiles(a, b, 99, 7).low, ratio_of_percentiles(a, b, 99, 7).low);
  EXPECT_EQ(ratio_of_percentiles({}, b, 99).value, 0.0);
}

// A folder that looks like a Pi's /proc and /sys.
class FakeRoot {
 public:
  FakeRoot() {
    put("proc/device-tree/model", std::string{"Raspberry Pi 3 Model B Rev 1.2"} + '\0');
    put("proc/cpuinfo", "processor\t: 0\nmodel name\t: ARMv8 Processor rev 4 (v8l)\n");
    put("proc/loadavg", "0.25 0.10 0.05 1/123 4567\n");
    put("sys/kernel/realtime", "1\n");
    put("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "ondemand\n");
    put("sys/class/thermal/thermal_zone0/temp", "48312\n");
    put("sys/devices/platform/soc/soc:firmware/get_throttled", "50005\n");
  }
  ~FakeRoot() { std::filesystem::remove_all(root_); }
  FakeRoot(const FakeRoot&) = delete;
  FakeRoot& operator=(const FakeRoot&) = delete;
  const std::string& path() const { return root_; }

 private:
  void put(const std::string& name, const std::string& text) {
    const std::filesystem::path file = root_ + "/" + name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream{file} << text;
  }
  std::string root_ = testing::TempDir() + "cargobay_conditions_" + std::to_string(getpid());
};

TEST(JitterConditions, AreThoseOfTheMachine) {
  const FakeRoot root;
  const Conditions now = look_at_conditions(root.path());
  EXPECT_EQ(now.board, "Raspberry Pi 3 Model B Rev 1.2");
  EXPECT_EQ(now.processor, "ARMv8 Processor rev 4 (v8l)");
  EXPECT_EQ(now.preemption, "PREEMPT_RT");
  EXPECT_EQ(now.governor, "ondemand");
  EXPECT_DOUBLE_EQ(now.temperature_c.value_or(0.0), 48.312);
  EXPECT_EQ(now.throttled, 0x50005U);
  EXPECT_DOUBLE_EQ(now.load, 0.25);
}

TEST(JitterConditions, AreLeftOutWhereNothingTells) {
  const Conditions now = look_at_conditions("/no/such/folder");
  EXPECT_EQ(now.board, "");
  EXPECT_FALSE(now.temperature_c.has_value());
  EXPECT_FALSE(now.throttled.has_value());
  EXPECT_NE(now.preemption, "") << "the kernel's own word";
}

}  // namespace
}  // namespace cargobay::hal::jitter
