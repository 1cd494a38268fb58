// Commands beside a drive: they show what its feed tells, and leave its port alone.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "drive_fixture.hpp"
#include "hal/feed/feed_reader.hpp"

namespace cargobay::test {
namespace {

using hal::sim::test::eventually;
using testing::HasSubstr;
using testing::Not;
using namespace nlohmann::literals;  // NOLINT(google-build-using-namespace): _json_pointer

class AttachedTest : public DriveTest {
 protected:
  void SetUp() override {
    DriveTest::SetUp();
    drive_ = std::make_unique<Command>(std::vector<std::string>{
        "drive", "--port", port_, "--duration", "600", "--config", "/dev/null"});
    ASSERT_TRUE(starts_to_move());
  }
  void TearDown() override {
    if (drive_->running()) {
      drive_->send(SIGINT);
      EXPECT_EQ(drive_->exit_code(), 128 + SIGINT) << drive_->err();
    }
    EXPECT_THAT(drive_->err(), Not(HasSubstr("also has it open")));
    DriveTest::TearDown();
  }
  std::unique_ptr<Command> drive_{};
};

// Whether the sums, which begin with 0 at that tick, are those of what was counted after it. The
// last few frames may have come after the last state that was heard.
bool add_up(const std::map<std::int64_t, std::int64_t>& counted, std::int64_t first,
            const std::map<std::int64_t, std::int64_t>& sums) {
  std::int64_t sum = 0;
  std::size_t compared = 0;
  for (auto frame = counted.upper_bound(first); frame != counted.end(); ++frame) {
    sum += frame->second;
    const auto shown = sums.find(frame->first - first);
    if (shown == sums.end()) continue;
    if (shown->second != sum) return false;
    ++compared;
  }
  return compared + 5 > sums.size();
}

TEST_F(AttachedTest, SensorsShowsTheFramesOfTheDrive) {
  Command command{{"sensors", "--json", "--port", port_, "--packets", "distance,oi_mode"}};
  auto states = hal::FeedReader::attach(port_);
  ASSERT_TRUE(states);
  std::map<std::int64_t, std::int64_t> counted;  // by tick, in its frame
  const auto hear = [&] {
    for (auto line = states->next(rt::Clock::now()); line && *line;
         line = states->next(rt::Clock::now())) {
      const auto message = nlohmann::json::parse(**line);
      EXPECT_NE(message["type"], "missed");
      if (message["type"] == "state")
        counted[message["tick"]] = message.value("/reading/distance_mm"_json_pointer, 0);
    }
  };
  ASSERT_TRUE(eventually([&] {
    hear();
    (void)command.running();
    return std::ranges::count(command.out(), '\n') > 50;
  }));
  command.send(SIGINT);
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.err(), HasSubstr("cargobay drive (process"));
  hear();
  std::istringstream lines{command.out()};
  std::map<std::int64_t, std::int64_t> sums;  // by ticks since the first
  double time_s = -1.0;
  for (std::string line; std::getline(lines, line);) {
    const auto frame = nlohmann::json::parse(line, nullptr, false);
    ASSERT_FALSE(frame.is_discarded()) << line;
    sums[std::lround(frame["time_s"].get<double>() / 0.015)] = frame["distance_sum"];
    EXPECT_EQ(frame["oi_mode_name"], "safe");
    EXPECT_FALSE(frame.contains("voltage"));
    EXPECT_GT(frame["time_s"], time_s);
    time_s = frame["time_s"];
  }
  EXPECT_GT(sums.rbegin()->second, 20);
  EXPECT_TRUE(std::ranges::any_of(counted, [&](const auto& first) {
    return add_up(counted, first.first, sums);
  })) << "each frame counts once";
}

TEST_F(AttachedTest, SensorsOnceLeavesOutWhatTheDriveDoesNotRead) {
  Command command{{"sensors", "--once", "--port", port_, "--packets", "voltage,wall_signal"}};
  EXPECT_EQ(command.exit_code(), 0) << command.err();
  EXPECT_THAT(command.out(), HasSubstr("Voltage"));
  EXPECT_THAT(command.out(), Not(HasSubstr("Wall Signal")));
}

TEST_F(AttachedTest, SensorsEndsWithTheDrive) {
  Command command{{"sensors", "--json", "--port", port_}};
  ASSERT_TRUE(eventually([&] {
    (void)command.running();
    return std::ranges::count(command.out(), '\n') > 5;
  }));
  drive_->send(SIGINT);
  EXPECT_EQ(command.exit_code(), 1);
  EXPECT_THAT(command.err(), HasSubstr("has ended"));
}

}  // namespace
}  // namespace cargobay::test
