// Machines as their /proc and /sys describe them, made up in a folder.
#include "hal/doctor/doctor.hpp"

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace cargobay::hal {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using Verdict = Finding::Verdict;

constexpr unsigned kKernelThread = 0x00200040;

class Doctor : public testing::Test {
 protected:
  void SetUp() override {
    std::string folder = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
    ASSERT_NE(mkdtemp(folder.data()), nullptr);
    root_ = folder;
    write("proc/sys/kernel/version", "#1 SMP PREEMPT_RT Debian 6.1.1");
    write("proc/sys/kernel/sched_rt_runtime_us", "950000");
    write("proc/sys/kernel/sched_rt_period_us", "1000000");
    write("sys/devices/system/cpu/online", "0-3");
    write("sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "performance");
    write("proc/loadavg", "0.52 2.58 4.59 1/467 1021");
    write("dev/ttyAMA0", "");
  }
  void TearDown() override { std::filesystem::remove_all(root_); }

  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories((root_ / path).parent_path());
    std::ofstream{root_ / path, std::ios::binary} << text << '\n';
  }
  // A process with one thread; its flags, priority and policy as in proc(5).
  void add_process(int id, const std::string& name, unsigned flags, int priority,
                   int parent = 1) const {
    const std::string folder = "proc/" + std::to_string(id);
    std::string stat = std::to_string(id) + " (" + name + ") S " + std::to_string(parent) +
                       " 1 1 0 -1 " + std::to_string(flags);
    for (int field = 10; field < 40; ++field) stat += " 0";
    stat += ' ' + std::to_string(priority) + " 1 0 0";
    write(folder + "/stat", stat);
    write(folder + "/task/" + std::to_string(id) + "/stat", stat);
    write(folder + "/comm", name);
  }
  void opens(int id, const std::string& file) const {
    const auto link = root_ / "proc" / std::to_string(id) / "fd/0";
    std::filesystem::create_directories(link.parent_path());
    std::filesystem::remove(link);
    std::filesystem::create_symlink(root_ / file, link);
  }
  static rt::RealtimeGrant all_granted() {
    return {.fifo = true, .priority = 80, .memory_locked = true, .dma_latency_held = true};
  }
  std::vector<Finding> examine(rt::RealtimeGrant grant = all_granted()) const {
    return hal::examine({.port = (root_ / "dev/ttyAMA0").string(),
                         .grant = std::move(grant),
                         .rights = rights_,
                         .root = root_.string()});
  }
  static Finding find(const std::vector<Finding>& findings, std::string_view check) {
    const auto found = std::ranges::find(findings, check, &Finding::check);
    return found == findings.end() ? Finding{.what = "not looked at"} : *found;
  }
  // The one finding, with that verdict, names the remedy.
  void expect(std::string_view check, Verdict verdict, const std::string& remedy,
              rt::RealtimeGrant grant = all_granted()) const {
    const auto findings = examine(std::move(grant));
    const Finding finding = find(findings, check);
    EXPECT_EQ(finding.verdict, verdict) << check << ": " << finding.what;
    EXPECT_THAT(finding.remedy, HasSubstr(remedy)) << finding.what;
    EXPECT_EQ(all_well(findings), verdict != Verdict::bad);
  }

  std::filesystem::path root_;
  rt::Rights rights_{};  // of an ordinary user
};

TEST_F(Doctor, FindsNothingOnAMachineThatIsWell) {
  const auto findings = examine();
  EXPECT_TRUE(all_well(findings));
  for (const Finding& finding : findings) {
    if (finding.check == "gpio") continue;  // this machine's own
    EXPECT_EQ(finding.verdict, Verdict::good) << finding.check << ": " << finding.what;
    EXPECT_THAT(finding.what, Not(IsEmpty()));
    EXPECT_THAT(finding.remedy, IsEmpty());
  }
}

TEST_F(Doctor, KnowsBothSignsOfARealtimeKernel) {
  write("proc/sys/kernel/version", "#1 SMP PREEMPT_DYNAMIC Debian 6.12.1");
  expect("kernel", Verdict::advice, "linux-image-rt");
  write("sys/kernel/realtime", "1");
  expect("kernel", Verdict::good, "");
}

TEST_F(Doctor, SaysWhichRightsAreMissing) {
  rt::RealtimeGrant grant;
  for (const auto right : {rt::Refusal::Right::fifo, rt::Refusal::Right::memory_lock,
                           rt::Refusal::Right::dma_latency}) {
    grant.refusals.push_back({.right = right, .error = EPERM});
  }
  expect("memory", Verdict::bad, "memlock unlimited", grant);
  expect("fifo", Verdict::bad, "rtprio 90", grant);
  EXPECT_EQ(find(examine(grant), "sleep").verdict, Verdict::advice);
}

TEST_F(Doctor, SeesThrottling) {
  write("proc/sys/kernel/sched_rt_runtime_us", "100000");
  expect("throttling", Verdict::bad, "sched_rt_runtime_us=950000");
  write("proc/sys/kernel/sched_rt_runtime_us", "-1");
  expect("throttling", Verdict::good, "");
}

TEST_F(Doctor, SeesAGovernorOfAnyCpu) {
  write("sys/devices/system/cpu/cpu3/cpufreq/scaling_governor", "ondemand");
  expect("governor", Verdict::advice, "echo performance");
  EXPECT_THAT(find(examine(), "governor").what, HasSubstr("ondemand"));
}

TEST_F(Doctor, SeesDeepSleepWhereItIsNotHeldOff) {
  write("sys/devices/system/cpu/cpu0/cpuidle/state2/name", "C6");
  write("sys/devices/system/cpu/cpu0/cpuidle/state2/latency", "133");
  rt::RealtimeGrant grant = all_granted();
  EXPECT_EQ(find(examine(grant), "idle").what, "not looked at");
  grant.dma_latency_held = false;
  expect("idle", Verdict::advice, "cpuidle.off=1", grant);
  write("sys/devices/system/cpu/cpu0/cpuidle/state2/disable", "1");
  EXPECT_EQ(find(examine(grant), "idle").what, "not looked at");
}

TEST_F(Doctor, WantsACpuForTheKworkers) {
  write("sys/devices/system/cpu/online", "0");
  expect("kworkers", Verdict::advice, "more CPUs");
  write("sys/devices/system/cpu/online", "0,2-3");
  EXPECT_THAT(find(examine(), "kworkers").what, HasSubstr("of 3 CPUs"));
}

// A program below the loop also keeps them waiting.
TEST_F(Doctor, SeesWhoKeepsTheKworkersWaiting) {
  add_process(8, "modest", 0, 10);
  expect("kworkers", Verdict::advice, "--boost-kworkers");
  EXPECT_THAT(find(examine(), "kworkers").what, HasSubstr("modest (10)"));
}

TEST_F(Doctor, SeesABusyMachine) {
  EXPECT_THAT(find(examine(), "load").what, HasSubstr("0.5 busy programs"));
  write("proc/loadavg", "4.00 2.58 1.59 5/467 1021");
  expect("load", Verdict::advice, "--boost-kworkers");
  EXPECT_THAT(find(examine(), "load").what,
              HasSubstr("4.0 busy programs in the last minute, on 4"));
  std::filesystem::remove(root_ / "sys/devices/system/cpu/online");
  EXPECT_EQ(find(examine(), "load").what, "not looked at");
  write("sys/devices/system/cpu/online", "0-3");
  std::filesystem::remove(root_ / "proc/loadavg");
  EXPECT_EQ(find(examine(), "load").what, "not looked at");
}

TEST_F(Doctor, SeesKworkersThatWereLeftRaised) {
  add_process(7, "kworker/0:1-events", kKernelThread, 79);
  add_process(8, "kworker/u8:2-flush_to_ldisc", kKernelThread, 0);
  add_process(9, "kworker/u8:3 of a user", 0, 0);
  EXPECT_EQ(find(examine(), "kworkers").verdict, Verdict::good);
  add_process(10, "kworker/u8:4-events_unbound", kKernelThread, 79);
  expect("kworkers", Verdict::advice, "chrt --other");
  EXPECT_THAT(find(examine(), "kworkers").what, HasSubstr("priority 79"));
}

TEST_F(Doctor, SeesRivalsButNeitherTheKernelsOwnNorGuards) {
  add_process(7, "migration/0", kKernelThread, 99);
  add_process(8, "modest", 0, 79);
  add_process(11, "cargobay-guard", 0, 90);
  expect("rivals", Verdict::good, "");
  add_process(9, "a (strange) name", 0, 80);
  expect("rivals", Verdict::advice, "chrt");
  EXPECT_THAT(find(examine(), "rivals").what, HasSubstr("a (strange) name (80)"));
}

TEST_F(Doctor, SaysThatThereIsNoPort) {
  std::filesystem::remove(root_ / "dev/ttyAMA0");
  expect("port", Verdict::bad, "cargobay ports");
}

TEST_F(Doctor, KnowsTheMiniUartOfAPi) {
  write("dev/ttyS0", "");
  std::filesystem::remove(root_ / "dev/ttyAMA0");
  std::filesystem::create_symlink("ttyS0", root_ / "dev/ttyAMA0");  // as /dev/serial0 is
  EXPECT_EQ(find(examine(), "uart").what, "not looked at") << "on a PC it is a port like others";
  write("proc/device-tree/model", "Raspberry Pi 3 Model B Rev 1.2");
  expect("uart", Verdict::bad, "dtoverlay=disable-bt");
}

TEST_F(Doctor, SeesTheKernelsConsoleOnThePort) {
  write("proc/consoles", "tty0                 -WU (EC p  )    4:1");
  EXPECT_TRUE(all_well(examine()));
  write("proc/consoles", "tty0 -WU (EC p  ) 4:1\nttyAMA0 -W- (EC  p a) 204:64");
  expect("console", Verdict::bad, "console=ttyAMA0");
}

// agetty of systemd 257 does not have the port's name on its command line, and a shell never did.
TEST_F(Doctor, SeesWhoElseHasThePortOpen) {
  write("dev/ttyAMA1", "");
  add_process(55, "agetty", 0, 0);
  write("proc/55/cmdline", std::string("/sbin/agetty\0-o\0--\0--noclear\0-\0linux", 37));
  write("proc/55/cgroup",
        "0::/system.slice/system-serial\\x2dgetty.slice/serial-getty@ttyAMA0.service");
  opens(55, "dev/ttyAMA1");
  EXPECT_TRUE(all_well(examine())) << "another port's";
  opens(55, "dev/ttyAMA0");
  expect("users", Verdict::bad, "systemctl disable --now serial-getty@ttyAMA0.service");
  EXPECT_THAT(find(examine(), "users").what, HasSubstr("agetty (process 55) has"));
  EXPECT_THAT(find(examine(), "users").remedy, Not(HasSubstr("console=")));
  write("proc/cmdline", "console=tty0 console=ttyAMA0,115200 rw");
  expect("users", Verdict::bad, "remove console=ttyAMA0 from the kernel's command line");
}

TEST_F(Doctor, NamesEachUserOfThePortWithARemedy) {
  const struct {
    const char* name;
    const char* remedy;
  } users[] = {{"login", "log out"},
               {"bash", "log out"},
               {"screen", "close it"},
               {"minicom", "close it"},
               {"ModemManager", "ID_MM_DEVICE_IGNORE"},
               {"brltty", "apt remove brltty"},
               {"cargobay", "kill 70"},
               {"logger of bytes", "kill 70"}};
  for (const auto& [name, remedy] : users) {
    add_process(70, name, 0, 0);
    opens(70, "dev/ttyAMA0");
    expect("users", Verdict::bad, remedy);
    EXPECT_THAT(find(examine(), "users").what, HasSubstr(std::string{name} + " (process 70)"));
  }
  write("proc/70/cgroup", "0::/system.slice/telemetry.service");
  expect("users", Verdict::bad, "systemctl stop telemetry.service");
}

TEST_F(Doctor, CountsAGuardWithItsProgram) {
  add_process(80, "cargobay", 0, 0);
  add_process(81, "cargobay-guard", 0, 0, 80);
  opens(80, "dev/ttyAMA0");
  opens(81, "dev/ttyAMA0");
  const auto findings = examine();
  EXPECT_EQ(std::ranges::count(findings, "users", &Finding::check), 1);
  EXPECT_THAT(find(findings, "users").what, HasSubstr("cargobay (process 80)"));
  std::filesystem::remove_all(root_ / "proc/80");  // it was killed
  expect("users", Verdict::bad, "wait a few seconds");
}

TEST_F(Doctor, SeesASlowAdapter) {
  write("sys/class/tty/ttyAMA0/device/latency_timer", "16");
  expect("adapter", Verdict::bad, "/sys/class/tty/ttyAMA0/device/latency_timer");
  write("sys/class/tty/ttyAMA0/device/latency_timer", "1");
  EXPECT_TRUE(all_well(examine()));
}

}  // namespace
}  // namespace cargobay::hal
