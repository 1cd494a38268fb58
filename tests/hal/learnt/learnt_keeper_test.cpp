// What a drive begins from and leaves, and where.
#include "hal/learnt/learnt_keeper.hpp"

#include <pty.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/learnt/learnt_file.hpp"

namespace cargobay::hal {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;
namespace fs = std::filesystem;

rt::LearntPlant plant_of(double lag_s, double log_odds_carried) {
  return {.lag_s = lag_s,
          .gain_left_sd = 0.01,
          .gain_right_sd = 0.01,
          .remainder =
              log_odds_carried > 0.0 ? rt::RemainderBelief::carried : rt::RemainderBelief::lost,
          .log_odds_carried = log_odds_carried,
          .moved_s = 10.0};
}

class LearntKeeperTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (fs::temp_directory_path() / "cargobay-XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    folder_ = folder;
  }
  void TearDown() override { fs::remove_all(folder_); }
  LearntPlace place(const std::string& port = "/dev/ttyAMA0") const {
    return {.file = (folder_ / "it.toml").string(), .port = port};
  }
  fs::path folder_;
};

TEST_F(LearntKeeperTest, HandsADriveToTheNext) {
  LearntKeeper first{place()};
  EXPECT_FALSE(first.begin());
  first.keep(plant_of(0.2, 15.0));
  EXPECT_EQ(first.remark(), "");
  LearntKeeper second{place()};
  const auto begun = second.begin();
  ASSERT_TRUE(begun);
  EXPECT_NEAR(begun->lag_s, 0.2, 1e-6);
  EXPECT_EQ(begun->remainder, rt::RemainderBelief::carried);
}

TEST_F(LearntKeeperTest, KeepsTheKindThatADriveDidNotFindOut) {
  LearntKeeper{place()}.keep(plant_of(0.2, 15.0));
  LearntKeeper second{place()};
  (void)second.begin();
  second.keep(plant_of(0.1, -2.0));  // hardly more than a guess
  LearntKeeper third{place()};
  EXPECT_EQ(third.begin()->remainder, rt::RemainderBelief::carried);
  third.keep(plant_of(0.1, -15.0));
  EXPECT_EQ(LearntKeeper{place()}.begin()->remainder, rt::RemainderBelief::lost);
}

TEST_F(LearntKeeperTest, LeavesTheFileWhereADriveHasLearntNothing) {
  LearntKeeper{place()}.keep(plant_of(0.2, 15.0));
  rt::LearntPlant little = plant_of(0.4, 15.0);
  little.moved_s = 1.0;
  LearntKeeper{place()}.keep(little);
  LearntKeeper{place()}.keep(std::nullopt);
  EXPECT_NEAR(LearntKeeper{place()}.begin()->lag_s, 0.2, 1e-6);
}

TEST_F(LearntKeeperTest, ForgetsIfAskedTo) {
  LearntKeeper{place()}.keep(plant_of(0.2, 15.0));
  LearntPlace fresh = place();
  fresh.forget = true;
  LearntKeeper keeper{fresh};
  EXPECT_FALSE(keeper.begin());
  keeper.keep(plant_of(0.3, 2.0));
  const auto next = LearntKeeper{place()}.begin();
  EXPECT_NEAR(next->lag_s, 0.3, 1e-6);
  EXPECT_EQ(next->remainder, rt::RemainderBelief::unknown);
}

TEST_F(LearntKeeperTest, UsesAndKeepsNothingWithoutAFile) {
  LearntKeeper keeper{LearntPlace{}};
  EXPECT_FALSE(keeper.begin());
  keeper.keep(plant_of(0.2, 15.0));
  EXPECT_EQ(keeper.remark(), "");
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(LearntKeeperTest, SaysThatAFileIsBrokenAndReplacesIt) {
  const std::string sound = learnt_text({.port = place().port, .plant = plant_of(0.1, 15.0)});
  for (const std::string& text :
       {sound.substr(0, sound.size() / 2), std::string{}, std::string(500, '\0'), sound + "[[["}) {
    std::ofstream{place().file} << text;
    LearntKeeper keeper{place()};
    EXPECT_FALSE(keeper.begin());
    EXPECT_THAT(keeper.remark(), HasSubstr(place().file));
    keeper.keep(plant_of(0.2, 15.0));
    EXPECT_EQ(keeper.remark(), "");
    EXPECT_TRUE(LearntKeeper{place()}.begin());
  }
}

// As in --learnt /etc/cargobay.toml.
TEST_F(LearntKeeperTest, NeverReplacesAFileOfAnotherKind) {
  const std::string text = "[robot]\nlearnt = 'it.toml'\n";
  for (const bool forget : {false, true}) {
    std::ofstream{place().file} << text;
    LearntPlace named = place();
    named.forget = forget;
    LearntKeeper keeper{named};
    EXPECT_FALSE(keeper.begin());
    keeper.keep(plant_of(0.2, 15.0));
    EXPECT_THAT(keeper.remark(), HasSubstr("holds something else"));
    std::ifstream file{place().file};
    EXPECT_EQ((std::string{std::istreambuf_iterator<char>{file}, {}}), text);
  }
}

TEST_F(LearntKeeperTest, SaysThatItCannotWrite) {
  LearntKeeper keeper{{.file = "/dev/full", .port = "/dev/ttyAMA0"}};
  keeper.keep(plant_of(0.2, 15.0));
  EXPECT_THAT(keeper.remark(), HasSubstr("is not kept: cannot write /dev/full"));
}

TEST_F(LearntKeeperTest, WritesOnceAMinute) {
  LearntKeeper keeper{place()};
  rt::TimePoint now{};
  keeper.now_and_then(plant_of(0.2, 15.0), now);
  keeper.now_and_then(plant_of(0.2, 15.0), now + std::chrono::seconds{59});
  EXPECT_FALSE(fs::exists(place().file));
  now += std::chrono::seconds{61};
  keeper.now_and_then(plant_of(0.2, 15.0), now);
  EXPECT_TRUE(LearntKeeper{place()}.begin());
  keeper.now_and_then(plant_of(0.4, 15.0), now + std::chrono::seconds{59});
  EXPECT_NEAR(LearntKeeper{place()}.begin()->lag_s, 0.2, 1e-6);
  keeper.now_and_then(plant_of(0.4, 15.0), now + std::chrono::seconds{61});
  EXPECT_NEAR(LearntKeeper{place()}.begin()->lag_s, 0.4, 1e-6);
}

// NOLINTBEGIN(concurrency-mt-unsafe): one thread
class StateFolder : public testing::Test {
 protected:
  static constexpr const char* kNames[] = {"STATE_DIRECTORY", "XDG_STATE_HOME", "HOME"};
  void SetUp() override {
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
      if (const char* value = std::getenv(kNames[i])) before_[i] = value;
      unsetenv(kNames[i]);
    }
  }
  void TearDown() override {
    for (std::size_t i = 0; i < std::size(kNames); ++i) {
      if (before_[i]) {
        setenv(kNames[i], before_[i]->c_str(), 1);
      } else {
        unsetenv(kNames[i]);
      }
    }
  }
  std::optional<std::string> before_[std::size(kNames)];
};

TEST_F(StateFolder, IsThatOfWhoeverRunsIt) {
  EXPECT_EQ(state_folder(), "/var/lib/cargobay");
  setenv("HOME", "/", 1);  // a service's
  EXPECT_EQ(state_folder(), "/var/lib/cargobay");
  setenv("HOME", "/home/ada", 1);
  EXPECT_EQ(state_folder(), "/home/ada/.local/state/cargobay");
  setenv("XDG_STATE_HOME", "state", 1);  // by its specification, to be ignored
  EXPECT_EQ(state_folder(), "/home/ada/.local/state/cargobay");
  setenv("XDG_STATE_HOME", "/state", 1);
  EXPECT_EQ(state_folder(), "/state/cargobay");
  setenv("STATE_DIRECTORY", "/var/lib/cargobay/driver:/var/lib/other", 1);
  EXPECT_EQ(state_folder(), "/var/lib/cargobay/driver");
}

TEST_F(StateFolder, HasAFileForEachPort) {
  setenv("XDG_STATE_HOME", "/state", 1);
  EXPECT_EQ(learnt_place("", "/dev/no-such_port.0").file,
            "/state/cargobay/learnt/dev-no%2Dsuch_port.0.toml");
  EXPECT_EQ(learnt_place("", "/dev/no-such_port.0").port, "/dev/no-such_port.0");
  EXPECT_NE(learnt_place("", "/dev/a-b").file, learnt_place("", "/dev/a/b").file);
  EXPECT_NE(learnt_place("", "/dev/a%b").file, learnt_place("", "/dev/a%25b").file);
  EXPECT_THAT(learnt_place("", "no_port").port, StartsWith("/"));
  EXPECT_THAT(learnt_place("", "no_port").port, EndsWith("/no_port"));
  EXPECT_EQ(learnt_place("none", "/dev/no_port").file, "");
  EXPECT_EQ(learnt_place("mine.toml", "/dev/no_port").file, "mine.toml");
  EXPECT_EQ(learnt_place("mine.toml", "/dev/no_port").port, "/dev/no_port");
}
// NOLINTEND(concurrency-mt-unsafe)

TEST(LearntPlaceOfAVirtualCreate, IsOnlyWhereItIsNamed) {
  int master = -1;
  int slave = -1;
  char path[100] = {};
  ASSERT_EQ(openpty(&master, &slave, path, nullptr, nullptr), 0);
  const std::string as_descriptor = "/proc/self/fd/" + std::to_string(slave);
  for (const std::string& port : {std::string{}, std::string{path}, as_descriptor}) {
    EXPECT_EQ(learnt_place("", port).file, "") << port;
    EXPECT_EQ(learnt_place("mine.toml", port).file, "mine.toml") << port;
    EXPECT_EQ(learnt_place("mine.toml", port).port, "a virtual Create") << port;
  }
  close(master);
  close(slave);
}

TEST(PortName, TellsAdaptersApart) {
  PortIdentity identity{.kind = PortIdentity::Kind::usb,
                        .path = "/dev/ttyUSB3",
                        .usb_vendor_id = 0x0403,
                        .usb_product_id = 0x6001,
                        .usb_serial = "A9048VXM"};
  EXPECT_EQ(port_name(identity), "usb 0403:6001 A9048VXM");
  identity.kind = PortIdentity::Kind::path;
  EXPECT_EQ(port_name(identity), "/dev/ttyUSB3");
  identity.path = "/dev/serial/../ttyUSB3";
  EXPECT_EQ(port_name(identity), "/dev/ttyUSB3");
}

}  // namespace
}  // namespace cargobay::hal
