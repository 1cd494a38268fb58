// What the timing-jitter benchmark computes from instants, without a clock.
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "hal/doctor/conditions.hpp"
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
  // 3.5, 2.5 and 1.5 ms beside the first: half a millisecond is within what is expected.
  EXPECT_EQ(measured.headline_ns().count(), 4U);
  EXPECT_EQ(measured.headline_ns().min(), 100'000U);
  EXPECT_EQ(measured.headline_ns().max(), 3'500'000U);
}

TEST(JitterRecorder, TakesAStampBeforeItsBeginningForNone) {
  Measured measured{.period = 1ms};
  Recorder recorder{measured, {.warm_up = 0, .slice_frames = 1}};
  recorder.take(frame(1'000'000, -500));
  EXPECT_EQ(measured.raw.max(), 0U);
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
