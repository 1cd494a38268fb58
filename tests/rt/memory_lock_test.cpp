// Locked memory under a limit, in a separate process: later allocations must still succeed.
#include "rt/memory_lock.hpp"

#include <linux/capability.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "rt/realtime.hpp"

namespace cargobay::rt {
namespace {

constexpr rlim_t kMib = rlim_t{1} << 20U;
constexpr std::size_t kPage = 4096;

void set_limit(rlim_t bytes) {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  limit.rlim_cur = std::min(bytes, limit.rlim_max);
  setrlimit(RLIMIT_MEMLOCK, &limit);
}

void drop_capability_to_lock() {
  __user_cap_header_struct header{.version = _LINUX_CAPABILITY_VERSION_3, .pid = 0};
  std::array<__user_cap_data_struct, 2> sets{};
  if (syscall(SYS_capget, &header, sets.data()) != 0) return;
  const std::uint32_t rest = ~(std::uint32_t{1} << static_cast<unsigned>(Capability::ipc_lock));
  sets[0].effective &= rest;
  sets[0].permitted &= rest;
  syscall(SYS_capset, &header, sets.data());
}

long locked_kib() {
  std::ifstream status{"/proc/self/status"};
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmLck:")) return std::stol(line.substr(6));
  }
  return -1;
}

// Needs more stack than any program's main thread begins with.
[[gnu::noinline]] int dive(int depth) {
  std::array<volatile char, kPage> frame{};
  frame[0] = static_cast<char>(depth);
  return depth == 0 ? 0 : dive(depth - 1) + (frame[0] != static_cast<char>(depth) ? 1 : 0);
}

// What a program does besides driving its robot. Empty if all of it is granted.
std::string allocates() {
  constexpr std::size_t kBytes = std::size_t{64} * kMib;
  char* const memory = static_cast<char*>(std::malloc(kBytes));
  if (memory == nullptr) return "no 64 MiB";
  for (std::size_t i = 0; i < kBytes; i += kPage) memory[i] = 1;
  char* const more = static_cast<char*>(std::realloc(memory, 2 * kBytes));
  if (more == nullptr) return "no 128 MiB";
  std::free(more);
  std::array<std::thread, 8> threads;
  std::atomic<int> ran{0};
  try {
    for (std::thread& thread : threads) thread = std::thread{[&ran] { ++ran; }};
  } catch (const std::system_error& error) {
    return std::string{"no thread: "} + error.what();
  }
  for (std::thread& thread : threads) thread.join();
  return ran == 8 && dive(1000) == 0 ? "" : "threads or stack went wrong";
}

// In a child, since limits and rights cannot be regained; returns its report, or how it died.
std::string in_child(const std::function<std::string()>& body) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
    const std::string text = body();
    _exit(write(ends[1], text.data(), text.size()) >= 0 ? 0 : 1);
  }
  close(ends[1]);
  std::string text;
  std::array<char, 512> chunk{};
  for (ssize_t count = 0; (count = read(ends[0], chunk.data(), chunk.size())) > 0;)
    text.append(chunk.data(), static_cast<std::size_t>(count));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFSIGNALED(status)) return "killed by signal " + std::to_string(WTERMSIG(status));
  return text;
}

// A loop that runs while `meanwhile` does.
std::string beside_a_loop(const std::vector<Memory>& memory,
                          const std::function<std::string(const RealtimeGrant&)>& meanwhile) {
  std::atomic<bool> end{false};
  RealtimeThread thread;
  const RealtimeGrant grant = thread.start({.priority = 10, .memory = memory}, [&end] {
    while (!end) usleep(1000);
  });
  const std::string said = meanwhile(grant);
  end = true;
  return said;
}

// As in a container: root, by user number.
TEST(MemoryLock, LeavesAllAllocationsToAProgramWithALimit) {
  EXPECT_EQ(in_child([] {
              set_limit(8 * kMib);
              drop_capability_to_lock();
              const std::vector<std::byte> loop(kMib);
              return beside_a_loop({loop}, [](const RealtimeGrant& grant) -> std::string {
                if (std::string denied = allocates(); !denied.empty()) return denied;
                if (!grant.memory_locked) return "not locked";
                if (grant.lock_limit_bytes != 8 * kMib) return "another limit";
                if (grant.locked_bytes < kMib) return "less than was asked for";
                if (locked_kib() < 1024 && !CARGOBAY_SANITIZED) return "nothing locked in fact";
                return "";
              });
            }),
            "");
}

// A daemon that opens its port as root and then drops its rights.
TEST(MemoryLock, LeavesAllAllocationsToAProgramThatDropsItsRights) {
  EXPECT_EQ(in_child([] {
              set_limit(8 * kMib);
              return beside_a_loop({}, [](const RealtimeGrant& grant) -> std::string {
                if (!grant.memory_locked) return "not locked";
                drop_capability_to_lock();
                return allocates();
              });
            }),
            "");
}

TEST(MemoryLock, LocksNothingWhereTheLimitIsTooLow) {
  EXPECT_EQ(in_child([] {
              set_limit(kMib / 16);
              drop_capability_to_lock();
              return beside_a_loop({}, [](const RealtimeGrant& grant) -> std::string {
                if (CARGOBAY_SANITIZED) return "";  // some answer mlock() themselves
                if (grant.memory_locked) return "locked";
                return locked_kib() == 0 ? allocates() : "something is locked";
              });
            }),
            "");
}

// Nor does the process keep what an ended loop had locked.
TEST(MemoryLock, UnlocksWhatALoopHad) {
  EXPECT_EQ(in_child([]() -> std::string {
              if (CARGOBAY_SANITIZED) return "";
              set_limit(8 * kMib);
              drop_capability_to_lock();
              const std::vector<std::byte> loop(2 * kMib);
              const auto nothing = [](const RealtimeGrant&) { return std::string{}; };
              (void)beside_a_loop({loop}, nothing);  // only the code stays locked
              const long after_one = locked_kib();
              for (int i = 0; i < 20; ++i) (void)beside_a_loop({loop}, nothing);
              return locked_kib() <= after_one + 16 ? "" : "it grows";
            }),
            "");
}

}  // namespace
}  // namespace cargobay::rt
