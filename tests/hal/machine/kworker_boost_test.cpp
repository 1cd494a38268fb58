// The kworkers of a machine made up in a folder; what the kernel would be told goes there as well.
#include "hal/machine/kworker_boost.hpp"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

constexpr unsigned kFlagsOfAKworker = 0x00200040;

class KworkerBoostTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    proc_ = folder;
    add(1, "init", 0, 0);
    add(20, "kworker/0:1-events", kFlagsOfAKworker, 0);
    add(21, "kworker/u8:0-events_unbound", kFlagsOfAKworker, 0);
    add(22, "kworker/u8:1-flush_to_ldisc", kFlagsOfAKworker, 0);
    add(23, "kworker/u8:2-writeback", kFlagsOfAKworker, 50);
    add(24, "kworker/u8:3 of a user", 0, 0);
  }
  void TearDown() override { std::filesystem::remove_all(proc_); }

  void add(int id, const std::string& name, unsigned flags, int priority) const {
    const std::filesystem::path folder = proc_ / std::to_string(id);
    std::filesystem::create_directories(folder);
    std::ofstream file{folder / "stat"};
    file << id << " (" << name << ") S 1 1 1 0 -1 " << flags;
    for (int field = 10; field < 40; ++field) file << " 0";
    file << ' ' << priority << " 1 0 0\n";
  }
  SchedulerCalls scheduler() {
    return {.set_fifo =
                [this](pid_t thread, int priority) {
                  if (refuse_at_ == thread) return refuse_with_;
                  raised_.push_back(thread);
                  add(thread, "kworker/u8:9", kFlagsOfAKworker, priority);
                  return 0;
                },
            .set_ordinary =
                [this](pid_t thread) {
                  lowered_.push_back(thread);
                  add(thread, "kworker/u8:9", kFlagsOfAKworker, 0);
                  return 0;
                }};
  }

  std::filesystem::path proc_;
  pid_t refuse_at_ = 0;
  int refuse_with_ = 0;
  std::vector<pid_t> raised_;
  std::vector<pid_t> lowered_;
};

// Its file opens, and reading it fails.
TEST_F(KworkerBoostTest, PassesOverATaskThatEndsMeanwhile) {
  std::filesystem::create_directories(proc_ / "25" / "stat");
  KworkerBoost boost{79, proc_, scheduler()};
  ASSERT_FALSE(boost.start());
  EXPECT_THAT(raised_, UnorderedElementsAre(21, 22));
}

TEST_F(KworkerBoostTest, RaisesTheOrdinaryOnesOfNoCpuAndLowersThemAgain) {
  KworkerBoost boost{79, proc_, scheduler()};
  ASSERT_FALSE(boost.start());
  EXPECT_THAT(raised_, UnorderedElementsAre(21, 22));
  boost.stop();
  EXPECT_THAT(lowered_, UnorderedElementsAre(21, 22));
  boost.stop();
  EXPECT_EQ(lowered_.size(), 2U) << "once";
}

TEST_F(KworkerBoostTest, IsUndoneByItsDestructor) {
  {
    KworkerBoost boost{79, proc_, scheduler()};
    ASSERT_FALSE(boost.start());
  }
  EXPECT_THAT(lowered_, UnorderedElementsAre(21, 22));
}

TEST_F(KworkerBoostTest, LeavesAloneWhatIsNoLongerAsItMadeIt) {
  KworkerBoost boost{79, proc_, scheduler()};
  ASSERT_FALSE(boost.start());
  add(21, "sshd", 0, 79);                                        // its number was reused
  add(22, "kworker/u8:1-flush_to_ldisc", kFlagsOfAKworker, 60);  // set by another program
  boost.stop();
  EXPECT_THAT(lowered_, IsEmpty());
}

TEST_F(KworkerBoostTest, ChangesNothingWhereTheRightIsRefused) {
  refuse_at_ = 22;
  refuse_with_ = EPERM;
  KworkerBoost boost{79, proc_, scheduler()};
  const std::error_code refused = boost.start();
  EXPECT_EQ(refused, std::errc::operation_not_permitted);
  EXPECT_EQ(lowered_, raised_);
  EXPECT_THAT(explain_kworker_boost(refused),
              AllOf(HasSubstr("Operation not permitted"), HasSubstr("SYS_NICE")));
}

TEST_F(KworkerBoostTest, PassesOverOneThatHasEnded) {
  refuse_at_ = 21;
  refuse_with_ = ESRCH;
  KworkerBoost boost{79, proc_, scheduler()};
  EXPECT_FALSE(boost.start());
  EXPECT_THAT(raised_, ElementsAre(22));
}

TEST_F(KworkerBoostTest, PutsRightWhatAKilledProcessLeft) {
  add(22, "kworker/u8:1-flush_to_ldisc", kFlagsOfAKworker, 79);
  KworkerBoost boost{79, proc_, scheduler()};
  ASSERT_FALSE(boost.start());
  EXPECT_THAT(raised_, ElementsAre(21));
  boost.stop();
  EXPECT_THAT(lowered_, UnorderedElementsAre(21, 22));
}

TEST(KworkerPriority, IsJustBelowTheLoop) { EXPECT_EQ(kworker_priority(80), 79); }

}  // namespace
}  // namespace cargobay::hal
