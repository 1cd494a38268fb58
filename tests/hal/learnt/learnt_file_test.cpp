#include "hal/learnt/learnt_file.hpp"

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr const char* kPort = "usb 0403:6001 A9048VXM";

rt::LearntPlant some_plant() {
  return {.lag_s = 0.123,
          .lag_sd_s = 0.011,
          .dead_time_s = 0.031,
          .dead_time_sd_s = 0.012,
          .ramp_s2_mm = 0.00125,
          .ramp_sd_s2_mm = 0.0003,
          .gain_left = 0.91,
          .gain_left_sd = 0.013,
          .gain_right = 0.87,
          .gain_right_sd = 0.014,
          .remainder = rt::RemainderBelief::lost,
          .moved_s = 37.5};
}

void expect_same(const rt::LearntPlant& a, const rt::LearntPlant& b) {
  for (const auto member :
       {&rt::LearntPlant::lag_s, &rt::LearntPlant::lag_sd_s, &rt::LearntPlant::dead_time_s,
        &rt::LearntPlant::dead_time_sd_s, &rt::LearntPlant::ramp_s2_mm,
        &rt::LearntPlant::ramp_sd_s2_mm, &rt::LearntPlant::gain_left,
        &rt::LearntPlant::gain_left_sd, &rt::LearntPlant::gain_right,
        &rt::LearntPlant::gain_right_sd, &rt::LearntPlant::moved_s})
    EXPECT_NEAR(a.*member, b.*member, 1e-6);
  EXPECT_EQ(a.remainder, b.remainder);
}

class LearntFile : public testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (fs::temp_directory_path() / "cargobay-XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    folder_ = folder;
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file() const { return (folder_ / "cargobay" / "learnt" / "it.toml").string(); }
  std::string holding(const std::string& text) const {
    const std::string path = (folder_ / "other.toml").string();
    std::ofstream{path} << text;
    return path;
  }
  std::string why_not(const std::string& text) const {
    const auto loaded = load_learnt(holding(text), kPort);
    EXPECT_FALSE(loaded) << text;
    return loaded ? "" : loaded.failure().message;
  }

  fs::path folder_;
};

std::string with(std::string text, const std::string& part, const std::string& other) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, std::string::npos) << part;
  return text.replace(at, part.size(), other);
}

TEST_F(LearntFile, KeepsWhatWasLearnt) {
  ASSERT_TRUE(save_learnt(file(), {.port = kPort, .plant = some_plant()}));
  const auto loaded = load_learnt(file(), kPort);
  ASSERT_TRUE(loaded) << loaded.failure().message;
  expect_same(*loaded, some_plant());
}

TEST_F(LearntFile, IsForItsOwnerAlone) {
  ASSERT_TRUE(save_learnt(file(), {.port = kPort, .plant = some_plant()}));
  EXPECT_EQ(fs::status(fs::path{file()}.parent_path()).permissions(), fs::perms::owner_all);
}

TEST_F(LearntFile, IsReplaced) {
  rt::LearntPlant plant = some_plant();
  ASSERT_TRUE(save_learnt(file(), {.port = kPort, .plant = plant}));
  plant.lag_s = 0.2;
  plant.remainder = rt::RemainderBelief::unknown;
  ASSERT_TRUE(save_learnt(file(), {.port = kPort, .plant = plant}));
  expect_same(*load_learnt(file(), kPort), plant);
  EXPECT_EQ(std::distance(fs::directory_iterator{fs::path{file()}.parent_path()}, {}), 1)
      << "something was left beside it";
}

TEST_F(LearntFile, MayBeMissing) {
  const auto loaded = load_learnt(file(), kPort);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.failure().code, std::errc::no_such_file_or_directory);
}

TEST_F(LearntFile, OfAnotherRobotIsNotTaken) {
  const std::string text = learnt_text({.port = "/dev/ttyAMA0", .plant = some_plant()});
  EXPECT_THAT(why_not(text), HasSubstr("/dev/ttyAMA0"));
}

// Cut off anywhere, as by a machine that lost its power, it is refused or whole: what is missing is
// at most the kind of remainder at its end.
TEST_F(LearntFile, ThatIsBrokenIsNotTaken) {
  const std::string text = learnt_text({.port = kPort, .plant = some_plant()});
  int taken = 0;
  for (std::size_t length = 0; length < text.size(); ++length)
    taken += load_learnt(holding(text.substr(0, length)), kPort) ? 1 : 0;
  EXPECT_LT(taken, 30);
  EXPECT_THAT(why_not(""), HasSubstr("version"));
  EXPECT_THAT(why_not(std::string(100, '\0')), HasSubstr("not TOML"));
  EXPECT_THAT(why_not("GIF89a"), HasSubstr("not TOML"));
  EXPECT_THAT(why_not("[[["), HasSubstr("not TOML"));
  EXPECT_THAT(why_not(with(text, "version = 1", "version = 2")), HasSubstr("version 1"));
  EXPECT_FALSE(load_learnt(folder_.string(), kPort));
  EXPECT_FALSE(load_learnt("/dev/zero", kPort));
}

TEST_F(LearntFile, WithAValueThatNoRobotHasIsNotTaken) {
  const std::string text = learnt_text({.port = kPort, .plant = some_plant()});
  EXPECT_THAT(why_not(with(text, "lag_s = 0.123", "lag_s = 123")), HasSubstr("lag_s must be"));
  EXPECT_THAT(why_not(with(text, "lag_s = 0.123", "lag_s = nan")), HasSubstr("lag_s"));
  EXPECT_THAT(why_not(with(text, "lag_s = 0.123", "lag_s = 'x'")), HasSubstr("lag_s"));
  EXPECT_THAT(why_not(with(text, "gain_left = 0.91", "gain_left = -1")), HasSubstr("gain_left"));
  EXPECT_THAT(why_not(with(text, "gain_right_sd = 0.014", "gain_right_sd = inf")),
              HasSubstr("gain_right_sd"));
}

TEST_F(LearntFile, SaysWhyItIsNotWritten) {
  const LearntRecord record{.port = kPort, .plant = some_plant()};
  const auto full = save_learnt("/dev/full", record);
  ASSERT_FALSE(full);
  EXPECT_THAT(full.failure().message, HasSubstr("/dev/full"));
  // A file where its folder should be, a folder where it should be, a name that is too long.
  const std::string blocked = holding("") + "/it.toml";
  fs::create_directories(folder_ / "folder.toml");
  for (const std::string& path :
       {blocked, (folder_ / "folder.toml").string(), (folder_ / std::string(300, 'x')).string(),
        std::string{"/proc/cargobay/it.toml"}}) {
    const auto saved = save_learnt(path, record);
    ASSERT_FALSE(saved) << path;
    EXPECT_THAT(saved.failure().message, HasSubstr(path));
  }
}

TEST_F(LearntFile, MayBeWrittenByTwoAtOnce) {
  rt::LearntPlant first = some_plant();
  rt::LearntPlant second = some_plant();
  second.lag_s = 0.456;
  ASSERT_TRUE(save_learnt(file(), {.port = kPort, .plant = first}));
  const auto write = [this](const rt::LearntPlant& plant) {
    for (int i = 0; i < 50; ++i) (void)save_learnt(file(), {.port = kPort, .plant = plant});
  };
  std::thread one{write, first};
  std::thread other{write, second};
  for (int i = 0; i < 100; ++i) {
    const auto loaded = load_learnt(file(), kPort);
    EXPECT_TRUE(loaded) << loaded.failure().message;
  }
  one.join();
  other.join();
  EXPECT_TRUE(load_learnt(file(), kPort));
}

TEST(LearntPlantWorthKeeping, HasMovedAndIsKnown) {
  EXPECT_TRUE(worth_keeping(some_plant()));
  rt::LearntPlant plant = some_plant();
  plant.moved_s = 1.0;
  EXPECT_FALSE(worth_keeping(plant)) << "hardly driven";
  plant = some_plant();
  plant.gain_right_sd = 0.2;
  EXPECT_FALSE(worth_keeping(plant)) << "not known";
  plant = some_plant();
  plant.gain_left = 0.4;
  EXPECT_FALSE(worth_keeping(plant)) << "counters that are dead";
}

}  // namespace
}  // namespace cargobay::hal
