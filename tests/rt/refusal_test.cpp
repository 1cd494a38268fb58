// What is said about each refusal, depending on where the program runs.
#include "rt/refusal.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using Origin = Rights::Origin;
using Right = Refusal::Right;

constexpr Refusal kNoFifo{.right = Right::fifo, .error = EPERM, .wanted = 80};
constexpr Refusal kNoLock{.right = Right::memory_lock, .error = ENOMEM};
constexpr std::uint64_t kMebibyte = std::uint64_t{1} << 20U;

std::uint64_t only(Capability capability) {
  return std::uint64_t{1} << static_cast<unsigned>(capability);
}

TEST(Refusal, NamesTheRemedyOfTheOneWhoCanGiveIt) {
  const auto fifo = [](Origin origin) { return explain(kNoFifo, {.origin = origin}); };
  EXPECT_THAT(fifo(Origin::login), AllOf(HasSubstr("'rtprio 90'"), HasSubstr("next login")));
  EXPECT_THAT(fifo(Origin::service), AllOf(HasSubstr("CAP_SYS_NICE"), HasSubstr("LimitRTPRIO=95")));
  EXPECT_THAT(fifo(Origin::container), HasSubstr("--cap-add SYS_NICE --ulimit rtprio=95"));
  const auto memory = [](Origin origin) {
    return explain(kNoLock, {.origin = origin, .lock_limit = 8 * kMebibyte});
  };
  EXPECT_THAT(memory(Origin::login), AllOf(HasSubstr("memlock unlimited"), HasSubstr("8 MiB")));
  EXPECT_THAT(memory(Origin::service), HasSubstr("LimitMEMLOCK=infinity"));
  EXPECT_THAT(memory(Origin::container), HasSubstr("--cap-add IPC_LOCK --ulimit memlock=-1"));
}

TEST(Refusal, SaysThatALimitIsTooLow) {
  EXPECT_THAT(explain(kNoFifo, {.priority_limit = 50}), HasSubstr("priority limit of 50"));
  EXPECT_THAT(explain({.right = Right::fifo, .error = EPERM, .wanted = 85}, {.priority_limit = 50}),
              HasSubstr("'rtprio 95'"));
}

// Anything else can be the cause only if the rights are there.
TEST(Refusal, BlamesGroupAndFilterOnlyWhereTheRightsAreThere) {
  const Rights root{.effective = only(Capability::sys_nice), .no_realtime_budget = true};
  EXPECT_THAT(explain(kNoFifo, root), HasSubstr("cpu.rt_runtime_us"));
  EXPECT_THAT(explain(kNoFifo, {.no_realtime_budget = true}), Not(HasSubstr("rt_runtime")));
  Rights filtered{.origin = Origin::service, .filtered = true, .priority_limit = 95};
  EXPECT_THAT(explain(kNoFifo, filtered), HasSubstr("RestrictRealtime=no"));
  filtered.origin = Origin::container;
  EXPECT_THAT(explain(kNoFifo, filtered), HasSubstr("seccomp"));
}

TEST(Refusal, KnowsThatTheRootOfAUserNamespaceIsNone) {
  const Rights rootless{
      .origin = Origin::container, .effective = ~std::uint64_t{0}, .namespaced = true};
  EXPECT_FALSE(rootless.has(Capability::sys_nice));
  EXPECT_THAT(explain(kNoFifo, rootless),
              AllOf(HasSubstr("root of the host"), HasSubstr("limits.d")));
}

TEST(Refusal, SaysWhyThereIsNoThread) {
  const Refusal none{.right = Right::thread, .error = EAGAIN};
  EXPECT_THAT(explain(none, {.process_limit = 63}),
              AllOf(HasSubstr("a limit of 63"), HasSubstr("ulimit -u")));
  EXPECT_THAT(explain(none, {}), AllOf(HasSubstr("memory"), Not(HasSubstr("ulimit"))));
  EXPECT_THAT(explain(none, {.address_space_left = 200000, .process_limit = 63}),
              AllOf(HasSubstr("ulimit -v"), Not(HasSubstr("ulimit -u"))));
  EXPECT_THAT(explain(none, {.memory_limit = 64 * kMebibyte, .process_limit = 63}),
              AllOf(HasSubstr("64 MiB of memory"), HasSubstr("MemoryMax")));
  EXPECT_THAT(explain(none, {.origin = Origin::container, .memory_limit = kMebibyte}),
              HasSubstr("--memory"));
  EXPECT_THAT(explain(none, {.task_limit = 20}),
              AllOf(HasSubstr("20 tasks"), HasSubstr("TasksMax")));
  EXPECT_THAT(explain(none, {.origin = Origin::container, .task_limit = 20}),
              HasSubstr("--pids-limit"));
  EXPECT_THAT(explain({.right = Right::stack, .error = EAGAIN}, {.lock_limit = kMebibyte}),
              AllOf(HasSubstr("MCL_FUTURE"), HasSubstr("memlock"), Not(HasSubstr("ulimit -u"))));
  EXPECT_THAT(explain({.right = Right::stack, .error = ENOMEM}, {}), HasSubstr("ulimit -v"));
}

class OwnRights : public testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    root_ = folder;
    write("proc/self/uid_map", "         0          0 4294967295\n");
    write("proc/self/cgroup", "0::/user.slice/user-1000.slice/session-3.scope\n");
    write("proc/self/status", "Name:\tx\nSeccomp:\t0\n");
  }
  void TearDown() override { std::filesystem::remove_all(root_); }
  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((root_ / path).parent_path());
    std::ofstream{root_ / path} << text;
  }
  std::filesystem::path root_;
};

TEST_F(OwnRights, KnowAContainerByItsSigns) {
  for (const char* const sign : {".dockerenv", "run/.containerenv", "run/systemd/container"}) {
    write(sign, "");
    EXPECT_EQ(own_rights(root_).origin, Origin::container) << sign;
    std::filesystem::remove(root_ / sign);
  }
}

TEST_F(OwnRights, KnowAService) {
  write("proc/self/cgroup",
        "0::/system.slice/system-cargobay.slice/cargobay@first_drive.service\n");
  EXPECT_EQ(own_rights(root_).origin, Origin::service);
  write("proc/self/cgroup", "4:memory:/x\n1:name=systemd:/system.slice/cron.service\n0::/\n");
  EXPECT_EQ(own_rights(root_).origin, Origin::service);
}

TEST_F(OwnRights, KnowAUserNamespaceAndAFilter) {
  EXPECT_FALSE(own_rights(root_).namespaced);
  EXPECT_FALSE(own_rights(root_).filtered);
  write("proc/self/uid_map", "0 1000 1\n1 100000 65536\n");
  write("proc/self/status", "Name:\tx\nSeccomp:\t2\n");
  EXPECT_TRUE(own_rights(root_).namespaced);
  EXPECT_TRUE(own_rights(root_).filtered);
}

// The file exists only with CONFIG_RT_GROUP_SCHED; its absence means nothing.
TEST_F(OwnRights, KnowAGroupWithoutARealtimeBudget) {
  write("proc/self/cgroup", "3:cpu,cpuacct:/user.slice\n");
  EXPECT_FALSE(own_rights(root_).no_realtime_budget);
  write("sys/fs/cgroup/cpu,cpuacct/user.slice/cpu.rt_runtime_us", "950000\n");
  EXPECT_FALSE(own_rights(root_).no_realtime_budget);
  write("sys/fs/cgroup/cpu,cpuacct/user.slice/cpu.rt_runtime_us", "0\n");
  EXPECT_TRUE(own_rights(root_).no_realtime_budget);
}

TEST_F(OwnRights, KnowAGroupThatHasItsMemory) {
  write("proc/self/cgroup", "0::/user.slice\n5:memory:/robots\n");
  EXPECT_EQ(own_rights(root_).memory_limit, std::nullopt);
  write("sys/fs/cgroup/user.slice/memory.max", "100000000\n");
  write("sys/fs/cgroup/user.slice/memory.current", "90000000\n");
  EXPECT_EQ(own_rights(root_).memory_limit, std::nullopt);
  write("sys/fs/cgroup/user.slice/memory.current", "99999000\n");
  EXPECT_EQ(own_rights(root_).memory_limit, 100000000U);
  write("sys/fs/cgroup/user.slice/memory.max", "max\n");
  write("sys/fs/cgroup/memory/robots/memory.limit_in_bytes", "50000000\n");
  write("sys/fs/cgroup/memory/robots/memory.usage_in_bytes", "50000000\n");
  EXPECT_EQ(own_rights(root_).memory_limit, 50000000U);
}

TEST_F(OwnRights, KnowHowMuchOfTheAddressSpaceIsLeft) {
  write("proc/self/statm", "10 5 3 1 0 2 0\n");
  rlimit former{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &former), 0);
  rlimit wanted = former;
  wanted.rlim_cur = std::uint64_t{1} << 62U;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &wanted), 0);
  const auto left = own_rights(root_).address_space_left;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &former), 0);
  const auto page = static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  EXPECT_EQ(left, (std::uint64_t{1} << 62U) - 10 * page);
}

TEST_F(OwnRights, KnowAGroupThatHasItsTasks) {
  const std::string group = "sys/fs/cgroup/user.slice/user-1000.slice/";
  write(group + "pids.max", "max\n");
  write(group + "pids.current", "33\n");
  EXPECT_EQ(own_rights(root_).task_limit, std::nullopt);
  write(group + "pids.max", "33\n");
  EXPECT_EQ(own_rights(root_).task_limit, 33U) << "of a group above its own";
}

}  // namespace
}  // namespace cargobay::rt
