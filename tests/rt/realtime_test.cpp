#include "rt/realtime.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <string>

#include <gtest/gtest.h>

namespace cargobay::rt {
namespace {

using Right = Refusal::Right;

bool is_refused(const RealtimeGrant& grant, Right right) {
  return std::any_of(grant.refusals.begin(), grant.refusals.end(),
                     [right](const Refusal& refusal) { return refusal.right == right; });
}

// What is wrong with the grant, compared with what the thread found; empty if nothing is.
std::string contradiction(const RealtimeGrant& grant, const RealtimeRequest& request, int policy,
                          int priority) {
  if (grant.fifo == is_refused(grant, Right::fifo)) return "FIFO neither granted nor refused";
  if (grant.fifo != (policy == SCHED_FIFO)) return "another scheduler than granted";
  if (grant.fifo && priority != request.priority) return "another priority than asked for";
  if (grant.priority != (grant.fifo ? request.priority : 0)) return "another priority than granted";
  if (request.lock_memory && grant.memory_locked == is_refused(grant, Right::memory_lock))
    return "memory neither locked nor refused";
  if (request.hold_dma_latency && grant.dma_latency_held == is_refused(grant, Right::dma_latency))
    return "latency neither held nor refused";
  return {};
}

// Starts a thread with this request; what it found must agree with the grant.
RealtimeGrant start(const RealtimeRequest& request, std::string& wrong) {
  std::atomic<int> policy{-1};
  std::atomic<int> priority{-1};
  std::atomic<int> cpu{-1};
  RealtimeThread thread;
  const RealtimeGrant grant = thread.start(request, [&] {
    int found = -1;
    sched_param parameters{};
    pthread_getschedparam(pthread_self(), &found, &parameters);
    policy = found;
    priority = parameters.sched_priority;
    cpu = sched_getcpu();
  });
  if (!thread.running()) {
    wrong = "no thread";
    return grant;
  }
  thread.join();
  if (thread.running()) wrong = "joined, and still running";
  const std::string found = contradiction(grant, request, policy, priority);
  if (!found.empty()) wrong = found;
  return grant;
}

TEST(RealtimeThread, GetsWhatItSaysItGot) {
  std::string wrong;
  const RealtimeGrant grant = start({.priority = 42}, wrong);
  EXPECT_EQ(wrong, "");
  EXPECT_EQ(grant.complete(), grant.fifo && grant.memory_locked);
}

TEST(RealtimeThread, AsksForNothingItWasNotAskedFor) {
  std::string wrong;
  const RealtimeGrant grant = start({.lock_memory = false, .hold_dma_latency = false}, wrong);
  EXPECT_EQ(wrong, "");
  EXPECT_FALSE(grant.memory_locked);
  EXPECT_FALSE(grant.dma_latency_held);
  EXPECT_FALSE(is_refused(grant, Right::memory_lock));
  EXPECT_FALSE(is_refused(grant, Right::dma_latency));
}

TEST(RealtimeThread, RunsOnTheCpuAskedFor) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  ASSERT_EQ(sched_getaffinity(0, sizeof allowed, &allowed), 0);
  int wanted = 0;
  while (!CPU_ISSET(static_cast<unsigned>(wanted), &allowed)) ++wanted;
  std::atomic<int> cpus{0};
  RealtimeThread thread;
  const RealtimeGrant grant = thread.start({.cpu = wanted, .lock_memory = false}, [&] {
    cpu_set_t mine;
    CPU_ZERO(&mine);
    sched_getaffinity(0, sizeof mine, &mine);
    cpus = CPU_COUNT(&mine);
  });
  thread.join();
  EXPECT_EQ(grant.cpu, wanted);
  EXPECT_EQ(cpus, 1) << "from its first instruction on";
}

cpu_set_t own_cpus() {
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  EXPECT_EQ(sched_getaffinity(0, sizeof cpus, &cpus), 0);
  return cpus;
}

TEST(KeepOff, LeavesTheCpuToALoopThatIsPinnedToIt) {
  const cpu_set_t allowed = own_cpus();
  if (CPU_COUNT(&allowed) < 2) GTEST_SKIP() << "needs two CPUs";
  unsigned wanted = 0;
  while (!CPU_ISSET(wanted, &allowed)) ++wanted;
  std::thread{[&] {
    keep_off(static_cast<int>(wanted));
    const cpu_set_t left = own_cpus();
    EXPECT_FALSE(CPU_ISSET(wanted, &left));
    EXPECT_EQ(CPU_COUNT(&left), CPU_COUNT(&allowed) - 1);
    std::thread{[&] {
      const cpu_set_t inherited = own_cpus();
      EXPECT_TRUE(CPU_EQUAL(&left, &inherited));
    }}.join();
    RealtimeThread loop;
    const RealtimeGrant grant = loop.start({.cpu = static_cast<int>(wanted)}, [] {});
    loop.join();
    EXPECT_EQ(grant.cpu, static_cast<int>(wanted));
  }}.join();
}

TEST(KeepOff, DoesNothingWhereNoOtherCpuIsLeft) {
  const cpu_set_t allowed = own_cpus();
  std::thread{[&] {
    for (int cpu = -1; cpu <= CPU_SETSIZE; ++cpu) keep_off(cpu);
    const cpu_set_t left = own_cpus();
    EXPECT_EQ(CPU_COUNT(&left), 1);
  }}.join();
  const cpu_set_t after = own_cpus();
  EXPECT_TRUE(CPU_EQUAL(&allowed, &after)) << "of the thread alone";
}

TEST(RealtimeThread, RunsElsewhereWhereThatCpuIsNotThere) {
  for (const int cpu : {-1, 1000, 1'000'000}) {
    std::string wrong;
    const RealtimeGrant grant = start({.cpu = cpu, .lock_memory = false}, wrong);
    EXPECT_EQ(wrong, "");
    EXPECT_FALSE(grant.cpu.has_value());
    EXPECT_TRUE(is_refused(grant, Right::affinity));
  }
}

TEST(RealtimeThread, JoinsWhenItIsDestroyed) {
  std::atomic<bool> done{false};
  {
    RealtimeThread thread;
    (void)thread.start({.lock_memory = false}, [&] { done = true; });  // not the grant's test
  }
  EXPECT_TRUE(done);
}

TEST(RealtimeThread, HasAStackThatTheBodyNeedNotFault) {
  std::atomic<long> faults{-1};
  RealtimeThread thread;
  (void)thread.start({.lock_memory = false}, [&] {
    rusage before{};
    rusage after{};
    getrusage(RUSAGE_THREAD, &before);
    constexpr std::size_t kBytes = std::size_t{384} * 1024;
    std::array<volatile char, kBytes> stack;  // NOLINT(cppcoreguidelines-pro-type-member-init)
    for (std::size_t i = 0; i < kBytes; i += 4096) stack[i] = 1;
    getrusage(RUSAGE_THREAD, &after);
    faults = after.ru_minflt - before.ru_minflt;
  });
  thread.join();
  EXPECT_LE(faults, 2) << "of 96 pages; the first calls of a thread cost some";
}

TEST(Refusal, SaysWhatWasRefusedWhyAndWhatToDo) {
  const struct {
    Refusal refusal;
    std::string what;
    std::string remedy;
  } all[] = {
      {{Right::fifo, EPERM}, "SCHED_FIFO", "rtprio"},
      {{Right::memory_lock, ENOMEM}, "locking memory", "memlock"},
      {{Right::affinity, EINVAL}, "CPU", "lscpu"},
      {{Right::dma_latency, EACCES}, "/dev/cpu_dma_latency", "udev"},
      {{Right::dma_latency, ENOENT}, "/dev/cpu_dma_latency", "not there"},
  };
  for (const auto& [refusal, what, remedy] : all) {
    const std::string text = explain(refusal, Rights{});
    EXPECT_NE(text.find(what), std::string::npos) << text;
    EXPECT_NE(text.find(remedy), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
  }
  EXPECT_NE(explain({Right::fifo, EPERM}).find("Operation not permitted"), std::string::npos);
}

// Runs `body` in a separate process; returns what it wrote, or how it ended.
template <typename Body>
std::string in_child(Body&& body) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    const std::string text = body();
    const bool written = write(ends[1], text.data(), text.size()) >= 0;
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  std::string text;
  std::array<char, 512> chunk{};
  for (ssize_t count = 0; (count = read(ends[0], chunk.data(), chunk.size())) > 0;) {
    text.append(chunk.data(), static_cast<std::size_t>(count));
  }
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? text : "the child died: " + text;
}

// Gives up every right: root becomes nobody, other users have none anyway.
void give_up_rights() {
  const rlimit none{0, 0};
  setrlimit(RLIMIT_RTPRIO, &none);
  setrlimit(RLIMIT_MEMLOCK, &none);
  constexpr uid_t kNobody = 65534;
  if (geteuid() == 0 && (setgid(kNobody) != 0 || setuid(kNobody) != 0)) _exit(2);
}

TEST(RealtimeThread, RunsWithoutRightsAndSaysSo) {
  const std::string said = in_child([] {
    give_up_rights();
    std::string wrong;
    const RealtimeGrant grant = start({}, wrong);
    if (!wrong.empty()) return wrong;
    std::string text = grant.complete() ? "complete\n" : "";
    for (const Refusal& refusal : grant.refusals) text += explain(refusal) + '\n';
    return text;
  });
  EXPECT_NE(said.find("SCHED_FIFO refused (Operation not permitted)"), std::string::npos) << said;
  // Some sanitizers answer mlockall() themselves, and never refuse it.
  const bool lock_refused = said.find("locking memory refused") != std::string::npos;
  EXPECT_TRUE(lock_refused || CARGOBAY_SANITIZED) << said;
  EXPECT_NE(said.find("/dev/cpu_dma_latency"), std::string::npos) << said;
  EXPECT_EQ(said.find("complete"), std::string::npos) << said;
  EXPECT_EQ(said.find("died"), std::string::npos) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 3) << said;
}

TEST(RealtimeThread, SaysWhyNoThreadCouldBeMade) {
  const std::string said = in_child([] {
    give_up_rights();
    const rlimit none{0, 0};
    setrlimit(RLIMIT_NPROC, &none);
    RealtimeThread thread;
    const RealtimeGrant grant =
        thread.start({.lock_memory = false, .hold_dma_latency = false}, [] {});
    if (thread.running()) return std::string{"it ran"};
    return explain(grant.refusals.back());
  });
  EXPECT_NE(said.find("Resource temporarily unavailable"), std::string::npos) << said;
  EXPECT_NE(said.find("ulimit -u"), std::string::npos) << said;
}

}  // namespace
}  // namespace cargobay::rt
