// How a robot that listens at another of its rates understands the question with which the bring-up
// looks for it.
#include <array>
#include <chrono>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/line/cable.hpp"
#include "hal/sim/random.hpp"
#include "hal/sim/robot/device.hpp"
#include "oi/dialect.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using Bytes = std::vector<std::uint8_t>;

constexpr int kTries = 12;
constexpr std::uint8_t kWall = 8;

// A robot in Passive at its own rate, and a host at another.
class Asked {
 public:
  Asked(std::uint32_t own, std::uint32_t other, std::uint64_t seed)
      : own_{own},
        device_{at(own)},
        random_{seed},
        gaps_{static_cast<std::uint32_t>(seed % 3) * 150} {
    device_.on_tick = [this](const sim::Device& device) {
      moved_ = moved_ || device.commanded() != sim::WheelSpeeds{};
    };
    send({128});
    pass(milliseconds{40});
    cable_.set_host_baud(other);
  }
  // Byte by byte with random gaps, or all at once.
  void send(const Bytes& bytes) {
    for (const std::uint8_t byte : bytes) {
      (void)cable_.send(Bytes{byte});
      pass(sim::bit_time(sim::kBitsPerByte, cable_.host_baud()));
      pass(microseconds{200 + (gaps_ == 0 ? 0 : random_.below(gaps_))});
    }
  }
  void pass(rt::Duration duration) { cable_.advance_to(cable_.now() + duration); }
  // It has not driven, does not wait, and obeys what it is told at its own rate.
  bool unharmed() {
    pass(milliseconds{400});
    const bool waits = device_.waiting();
    cable_.set_host_baud(own_);
    (void)answer();
    send({128});
    pass(milliseconds{20});
    (void)answer();
    send({142, 35});
    pass(milliseconds{30} + sim::bit_time(2L * sim::kBitsPerByte, own_));
    return !moved_ && !waits && answer() == Bytes{1};
  }

 private:
  static sim::Parameters at(std::uint32_t baud) {
    sim::Parameters parameters;
    parameters.boot_baud = baud;
    return parameters;
  }
  Bytes answer() {
    Bytes all(cable_.available());
    (void)cable_.take(all);
    return all;
  }

  std::uint32_t own_;
  sim::Device device_;
  sim::Cable cable_{device_};
  sim::Random random_;
  std::uint32_t gaps_;  // us at most
  bool moved_ = false;
};

// Over all pairs of rates and some gaps: in how many cases something is wrong.
template <typename Say>
int harmed_by(const Say& say) {
  int harmed = 0;
  for (const std::uint32_t own : oi::kCreate.baud_rates) {
    for (const std::uint32_t other : oi::kCreate.baud_rates) {
      for (std::uint64_t seed = 0; own != other && seed < kTries; ++seed) {
        Asked robot{own, other, seed};
        say(robot);
        if (!robot.unharmed()) ++harmed;
      }
    }
  }
  return harmed;
}

void ask(Asked& robot, std::uint8_t packet) {
  robot.send({142, packet});
  robot.pass(milliseconds{60});
  robot.send({142, packet});
}
void start_and_ask(Asked& robot, std::uint8_t packet) {
  robot.send({128});
  robot.pass(milliseconds{25});
  ask(robot, packet);
}

TEST(WrongRate, MakesNothingOfTheQuestionWhetherARobotIsThere) {
  EXPECT_EQ(harmed_by([](Asked& robot) { start_and_ask(robot, kWall); }), 0);
}

// As name_other_end() asks.
TEST(WrongRate, MakesNothingOfTheQuestionWithoutStart) {
  EXPECT_EQ(harmed_by([](Asked& robot) { ask(robot, kWall); }), 0);
}
// What `send stop` says to a robot that it does not hear: less than a farewell.
TEST(WrongRate, MakesLittleOfAStop) {
  const auto pairs =
      static_cast<int>(oi::kCreate.baud_rates.size() * (oi::kCreate.baud_rates.size() - 1));
  EXPECT_LT(harmed_by([](Asked& robot) { robot.send({145, 0, 0, 0, 0, 136, 255, 128}); }),
            pairs * kTries / 50);
}

TEST(WrongRate, MakesCommandsOfOtherQuestions) {
  EXPECT_GT(harmed_by([](Asked& robot) { start_and_ask(robot, 41); }), 0);
}

}  // namespace
}  // namespace cargobay::hal
