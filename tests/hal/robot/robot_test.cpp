// A Robot from open() to stop(), in virtual time: its thread runs as fast as the link lets it.

#include "hal/robot/robot.hpp"

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <semaphore>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "rt/unchecked.hpp"
#include "tests/hal/damaged_stream.hpp"

namespace cargobay::hal {
namespace {

constexpr rt::RealtimeRequest kNoRights{.lock_memory = false, .hold_dma_latency = false};

class RobotTest : public testing::Test {
 protected:
  // The robot owns the link; a test that wants to break it does so through here.
  std::unique_ptr<ByteStream> make_link() {
    auto link = std::make_unique<sim::VirtualLink>(device_);
    link_ = link.get();
    return link;
  }
  // Asks for 200 mm/s, and ends after this many frames.
  struct Driver {
    Robot* robot = nullptr;
    int frames = 100;
    std::atomic<int> calls{0};
    std::function<void()> also{};  // instead of ending

    static ControlAnswer control(void* context, const CycleState& /*state*/, double /*seconds*/)
        CARGOBAY_NONBLOCKING {
      rt::unchecked([context] { static_cast<Driver*>(context)->count_call(); });
      return rt::WheelSpeeds{200.0, 200.0};
    }
    void count_call() {
      if (++calls != frames) return;
      if (also) {
        also();
      } else {
        robot->cycle().request_stop();
      }
    }
  };
  void expect_standing_in_passive() const {
    EXPECT_EQ(device_.mode(), oi::Mode::passive);
    EXPECT_EQ(device_.commanded(), sim::WheelSpeeds{});
  }
  static void wait_for_end(const Robot& robot) {
    while (!robot.ended()) std::this_thread::yield();
  }

  sim::Device device_{sim::Parameters{}};
  sim::VirtualLink* link_ = nullptr;  // the robot's
};

TEST_F(RobotTest, DrivesAndIsLeftStanding) {
  std::vector<std::string> steps;
  auto robot = Robot::open(
      make_link(), {.realtime = kNoRights,
                    .progress = [&](const BringUpEvent& event) { steps.push_back(event.step); }});
  ASSERT_TRUE(robot) << robot.failure().message;
  EXPECT_EQ(steps, (std::vector<std::string>{"Start", "Stream", "Safe"}));
  Driver driver{.robot = robot->get()};
  const auto grant = (*robot)->start({.function = &Driver::control, .context = &driver});
  ASSERT_TRUE(grant) << grant.failure().message;
  wait_for_end(**robot);
  const Robot::Farewell farewell = (*robot)->stop();
  EXPECT_EQ(farewell.end, CycleEnd::asked);
  EXPECT_TRUE(farewell.robot.standing());
  EXPECT_EQ(driver.calls, 100);
  EXPECT_EQ((*robot)->cycle().frames().good, 100U);
  expect_standing_in_passive();
  EXPECT_TRUE((*robot)->stop().robot.standing()) << "a second stop does nothing";
}

TEST_F(RobotTest, BeginsFromWhatItLearntBefore) {
  std::string folder = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  const LearntPlace place{.file = folder + "/it.toml", .port = "a robot"};
  for (const bool before : {false, true}) {
    auto robot = Robot::open(make_link(), {.realtime = kNoRights, .learnt = place});
    ASSERT_TRUE(robot) << robot.failure().message;
    EXPECT_EQ((*robot)->began_from().has_value(), before);
    EXPECT_EQ((*robot)->recording_header().parameters.loop.estimator.prior.has_value(), before);
    Driver driver{.robot = robot->get(), .frames = 600};
    ASSERT_TRUE((*robot)->start({.function = &Driver::control, .context = &driver}));
    wait_for_end(**robot);
    (void)(*robot)->stop();
    EXPECT_EQ((*robot)->learnt_remark(), "");
    const auto learnt = (*robot)->learnt();
    ASSERT_TRUE(learnt);
    EXPECT_NEAR(learnt->gain_left, 0.94, 0.06);
    EXPECT_NEAR(learnt->moved_s, 600 * 0.015, 0.1);
  }
  std::filesystem::remove_all(folder);
}

TEST_F(RobotTest, DrivesWhateverBecomesOfItsFile) {
  for (const char* file : {"/dev/full", "/proc/none/it.toml", "/dev/zero", "/dev/null"}) {
    auto robot = Robot::open(make_link(),
                             {.realtime = kNoRights, .learnt = {.file = file, .port = "a robot"}});
    ASSERT_TRUE(robot) << robot.failure().message;
    Driver driver{.robot = robot->get(), .frames = 300};
    ASSERT_TRUE((*robot)->start({.function = &Driver::control, .context = &driver}));
    wait_for_end(**robot);
    EXPECT_EQ((*robot)->stop().end, CycleEnd::asked) << file;
  }
  expect_standing_in_passive();
}

TEST_F(RobotTest, IsStoppedByItsDestructor) {
  Driver driver{.frames = 1'000'000'000};
  {
    auto robot = Robot::open(make_link(), {.realtime = kNoRights});
    ASSERT_TRUE(robot);
    ASSERT_TRUE((*robot)->start({.function = &Driver::control, .context = &driver}));
    while (driver.calls < 200) std::this_thread::yield();
  }
  expect_standing_in_passive();
}

TEST_F(RobotTest, IsLeftStandingWhereItWasNeverStarted) {
  {
    auto robot = Robot::open(make_link(), {.realtime = kNoRights});
    ASSERT_TRUE(robot);
    EXPECT_EQ(device_.mode(), oi::Mode::safe);
  }
  expect_standing_in_passive();
}

TEST_F(RobotTest, IsStoppedFromOutside) {
  auto robot = Robot::open(make_link(), {.realtime = kNoRights});
  ASSERT_TRUE(robot);
  Driver driver{.robot = robot->get(), .frames = 1'000'000'000};
  ASSERT_TRUE((*robot)->start({.function = &Driver::control, .context = &driver}));
  while (driver.calls < 50) std::this_thread::yield();
  EXPECT_TRUE((*robot)->stop().robot.standing());
  EXPECT_TRUE((*robot)->ended());
  expect_standing_in_passive();
}

TEST_F(RobotTest, IsStoppedWhereTheControlFunctionDoesNotReturn) {
  // The thread may come back to them at any time.
  static sim::Device& device = *new sim::Device{sim::Parameters{}};
  static Driver& driver = *new Driver{.frames = 50};
  static std::binary_semaphore& come_back = *new std::binary_semaphore{0};
  static std::atomic<bool> away{false};
  driver.also = [] {
    away = true;
    come_back.acquire();
    away = false;
  };
  auto robot = Robot::open(std::make_unique<sim::VirtualLink>(device), {.realtime = kNoRights});
  ASSERT_TRUE(robot) << robot.failure().message;
  ASSERT_TRUE((*robot)->start({.function = &Driver::control, .context = &driver}));
  while (!away) std::this_thread::yield();
  const Robot::Farewell farewell = (*robot)->stop();
  EXPECT_TRUE(farewell.abandoned);
  EXPECT_EQ(farewell.end, CycleEnd::guarded);
  EXPECT_TRUE(farewell.robot.standing());
  EXPECT_NE(explain(farewell).find("has not returned"), std::string::npos);
  EXPECT_TRUE((*robot)->lost());
  EXPECT_EQ(device.mode(), oi::Mode::passive);
  robot->reset();  // frees nothing
  come_back.release();
  while (away) std::this_thread::yield();
  EXPECT_EQ(device.mode(), oi::Mode::passive) << "what it does reaches nobody";
  EXPECT_EQ(device.commanded(), sim::WheelSpeeds{});
}

// Lets another thread run from one wait to the next, and no further.
class Turns {
 public:
  void take() {
    if (!taking_) return;
    over_.release();
    given_.acquire();
  }
  void begin() { taking_ = true; }
  void wait_for_the_first() { over_.acquire(); }
  void give_one() {
    given_.release();
    over_.acquire();
  }
  void end() {
    taking_ = false;
    given_.release();
  }

 private:
  std::atomic<bool> taking_{false};
  std::counting_semaphore<> given_{0};
  std::counting_semaphore<> over_{0};
};

TEST_F(RobotTest, FollowsSetpointsFromAnotherThread) {
  constexpr int kPatience = 1000;
  sim::VirtualLink link{device_};
  Turns turns;
  auto line = std::make_unique<test::DamagedStream>(link);
  line->before_wait = [&turns] { turns.take(); };
  auto robot = Robot::open(std::move(line), {.realtime = kNoRights});
  ASSERT_TRUE(robot);
  turns.begin();
  ASSERT_TRUE((*robot)->start({}));
  turns.wait_for_the_first();
  ControlCycle& cycle = (*robot)->cycle();
  const auto estimate = [&] {
    const auto state = cycle.state();
    return state.has_value() ? state->estimate.left_mm_s : 0.0;
  };
  for (int i = 0; i < kPatience && estimate() < 100.0; ++i) {
    EXPECT_TRUE(cycle.set_speeds({150.0, 150.0}));
    turns.give_one();
  }
  EXPECT_GE(estimate(), 100.0);
  // It is not renewed from now on.
  for (int i = 0; i < kPatience && !cycle.state()->setpoint_lapsed; ++i) turns.give_one();
  EXPECT_TRUE(cycle.state()->setpoint_lapsed);
  turns.end();
  EXPECT_TRUE((*robot)->stop().robot.standing());
  expect_standing_in_passive();
}

TEST_F(RobotTest, SaysThatThePortHungUp) {
  auto robot = Robot::open(make_link(), {.realtime = kNoRights});
  ASSERT_TRUE(robot);
  Driver driver{.robot = robot->get(), .also = [this] { link_->hang_up(); }};
  ASSERT_TRUE((*robot)->start({.function = &Driver::control, .context = &driver}));
  wait_for_end(**robot);
  const Robot::Farewell farewell = (*robot)->stop();
  EXPECT_EQ(farewell.end, CycleEnd::hung_up);
  EXPECT_FALSE(farewell.robot.standing());
}

TEST_F(RobotTest, SaysThatTheRobotLeftItsMode) {
  auto robot = Robot::open(make_link(), {.realtime = kNoRights});
  ASSERT_TRUE(robot);
  Driver driver{.robot = robot->get(),
                .also = [this] { device_.inputs().cliff_front_left.cliff = true; }};
  ASSERT_TRUE((*robot)->start({.function = &Driver::control, .context = &driver}));
  wait_for_end(**robot);
  const Robot::Farewell farewell = (*robot)->stop();
  EXPECT_EQ(farewell.end, CycleEnd::mode_lost);
  EXPECT_TRUE(farewell.robot.standing());
  expect_standing_in_passive();
}

// Told by another program on the line to go to Full: it moves, and still obeys.
TEST_F(RobotTest, IsStoppedWhereItWasPutIntoAnotherDrivingMode) {
  auto robot = Robot::open(make_link(), {.realtime = kNoRights});
  ASSERT_TRUE(robot);
  Driver driver{.robot = robot->get(), .also = [this] { device_.receive(132); }};
  std::vector<oi::Mode> stopped_in;
  device_.on_drive = [&](const sim::DriveRecord& record) {
    if (record.command != sim::WheelSpeeds{}) return;
    rt::unchecked([&] { stopped_in.push_back(device_.mode()); });
  };
  ASSERT_TRUE((*robot)->start({.function = &Driver::control, .context = &driver}));
  wait_for_end(**robot);
  EXPECT_EQ((*robot)->stop().end, CycleEnd::mode_lost);
  ASSERT_FALSE(stopped_in.empty());
  EXPECT_EQ(stopped_in.front(), oi::Mode::full);
  expect_standing_in_passive();
}

// There is no CPU with that number; real time does not need it, so this is reported, and it drives.
TEST_F(RobotTest, GoesOnWithoutTheCpuAskedFor) {
  auto robot = Robot::open(
      make_link(),
      {.realtime = {.cpu = 1'000'000, .lock_memory = false, .hold_dma_latency = false}});
  ASSERT_TRUE(robot);
  Driver driver{.robot = robot->get()};
  const auto grant = (*robot)->start({.function = &Driver::control, .context = &driver});
  ASSERT_TRUE(grant);
  EXPECT_FALSE(grant->cpu.has_value());
  EXPECT_FALSE(grant->refusals.empty());
  wait_for_end(**robot);
  EXPECT_TRUE((*robot)->stop().robot.standing());
}

// Memory that was not to be locked is not locked: this counts as a refusal.
TEST_F(RobotTest, NeverMovesWithoutTheRightsItRequires) {
  int moves = 0;
  device_.on_drive = [&](const sim::DriveRecord& record) {
    if (record.command != sim::WheelSpeeds{}) ++moves;
  };
  auto robot = Robot::open(make_link(), {.realtime = kNoRights, .require_realtime = true});
  ASSERT_TRUE(robot);
  Driver driver{.robot = robot->get()};
  const auto grant = (*robot)->start({.function = &Driver::control, .context = &driver});
  ASSERT_FALSE(grant);
  EXPECT_NE(grant.failure().message.find("--require-rt"), std::string::npos);
  EXPECT_EQ(driver.calls, 0);
  EXPECT_EQ(moves, 0);
  expect_standing_in_passive();
}

TEST_F(RobotTest, IsNotOpenedWhereItDoesNotAnswer) {
  sim::Device off{sim::Parameters{.power_on = sim::PowerOn::never}};
  const auto robot = Robot::open(std::make_unique<sim::VirtualLink>(off), {});
  ASSERT_FALSE(robot);
  EXPECT_NE(robot.failure().message.find("silent"), std::string::npos);
}

TEST(CycleEndText, SaysWhatToDo) {
  constexpr Discharge kStands{.parting = Parting::standing};
  EXPECT_EQ(explain({.end = CycleEnd::asked, .robot = kStands}), "");
  EXPECT_NE(explain({.end = CycleEnd::asked}).find("it may be moving"), std::string::npos);
  for (const CycleEnd end : {CycleEnd::link_lost, CycleEnd::mode_lost, CycleEnd::hung_up}) {
    const std::string text = explain({.end = end, .robot = kStands});
    EXPECT_NE(text.find("start again"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
  EXPECT_NE(explain({.end = CycleEnd::control_overrun}).find("control_budget"), std::string::npos);
  EXPECT_NE(explain({.end = CycleEnd::hung_up, .port_error = EBADF}).find("close_range()"),
            std::string::npos);
}

TEST(CycleEndText, SaysWhatBecameOfTheRobot) {
  for (const CycleEnd end : {CycleEnd::link_lost, CycleEnd::mode_lost, CycleEnd::hung_up,
                             CycleEnd::guarded, CycleEnd::control_overrun, CycleEnd::guard_lost}) {
    EXPECT_EQ(explain({.end = end, .robot = {.parting = Parting::standing}}).find("; the robot"),
              std::string::npos);
    EXPECT_TRUE(explain({.end = end, .robot = {.parting = Parting::standing, .by_guard = true}})
                    .ends_with("; the robot was stopped by its guard"));
    for (const Parting left : {Parting::unconfirmed, Parting::port_gone}) {
      EXPECT_TRUE(explain({.end = end, .robot = {.parting = left, .by_guard = true}})
                      .ends_with("; the robot could not be reached: it may be moving"));
    }
  }
}

TEST(CycleEndText, NamesTheCauseOfALostMode) {
  constexpr Discharge kStands{.parting = Parting::standing};
  EXPECT_EQ(explain({.end = CycleEnd::mode_lost,
                     .robot = kStands,
                     .causes = Hazards{}.with(Hazard::cliff_front_left)}),
            "a cliff at the front left: the robot stopped and left its mode; move it away from the "
            "edge, then start again");
  const auto lifted = Hazards{}.with(Hazard::cliff_left).with(Hazard::wheel_drop_right);
  EXPECT_EQ(explain({.end = CycleEnd::mode_lost, .robot = kStands, .causes = lifted}),
            "the right wheel is off the floor and a cliff on the left: the robot stopped and left "
            "its mode; set it on its wheels, then start again");
  EXPECT_NE(explain({.end = CycleEnd::mode_lost, .causes = Hazards{}.with(Hazard::charger)})
                .find("unplug"),
            std::string::npos);
}

}  // namespace
}  // namespace cargobay::hal
