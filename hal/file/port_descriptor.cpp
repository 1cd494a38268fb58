#include "hal/file/port_descriptor.hpp"

#include <fcntl.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <utility>

namespace cargobay::hal {
namespace {

constexpr int kLeast = 3;
// A descriptor table is as large as its highest number requires: stay within what every process may
// have by default.
constexpr rlim_t kUsualLimit = 1024;
constexpr rlim_t kBelowLimit = 64;

int high_number() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return kLeast;
  const rlim_t most = std::min(limit.rlim_cur, kUsualLimit);
  return most > 2 * kBelowLimit ? static_cast<int>(most - kBelowLimit) : kLeast;
}

int duplicate_high(int descriptor) {
  const int high = fcntl(descriptor, F_DUPFD_CLOEXEC, high_number());
  return high >= 0 ? high : fcntl(descriptor, F_DUPFD_CLOEXEC, kLeast);
}

bool is_that(int descriptor, dev_t device, ino_t inode) {
  struct stat file{};
  return fstat(descriptor, &file) == 0 && file.st_dev == device && file.st_ino == inode;
}

// The descriptors that a forked child closes. A child has one thread and may call only
// async-signal-safe functions: hence a table of fixed size, without a lock.
struct Kept {
  std::atomic<int> number{-1};
  std::atomic<dev_t> device{0};
  std::atomic<ino_t> inode{0};
};
constexpr std::size_t kMostKept = 256;
// NOLINTNEXTLINE(cppcoreguidelines-avoid-non-const-global-variables): the process's
std::array<Kept, kMostKept> kept_from_children{};

void close_in_child() {
  for (Kept& one : kept_from_children) {
    const int number = one.number.exchange(-1, std::memory_order_relaxed);
    const dev_t device = one.device.load(std::memory_order_relaxed);
    const ino_t inode = one.inode.load(std::memory_order_relaxed);
    if (number >= 0 && is_that(number, device, inode)) close(number);
  }
}

void keep_from_children(int number, dev_t device, ino_t inode) {
  static const int kRegistered = pthread_atfork(nullptr, nullptr, close_in_child);
  (void)kRegistered;  // fails only for want of memory: then children keep the port
  constexpr int kBusy = -2;
  for (Kept& one : kept_from_children) {
    int free = -1;
    if (!one.number.compare_exchange_strong(free, kBusy)) continue;
    one.device.store(device, std::memory_order_relaxed);
    one.inode.store(inode, std::memory_order_relaxed);
    one.number.store(number, std::memory_order_release);
    return;
  }
}

void forget(int number) {
  for (Kept& one : kept_from_children) {
    int ours = number;
    if (one.number.compare_exchange_strong(ours, -1)) return;
  }
}

}  // namespace

PortDescriptor::PortDescriptor(int number, bool owned) : number_{number}, owned_{owned} {
  struct stat file{};
  if (number < 0 || fstat(number, &file) != 0) return;
  device_ = file.st_dev;
  inode_ = file.st_ino;
  keep_from_children(number, device_, inode_);
}

PortDescriptor PortDescriptor::adopt(int descriptor) {
  const int high = duplicate_high(descriptor);
  if (high < 0) return {descriptor, true};
  close(descriptor);
  return {high, true};
}

PortDescriptor PortDescriptor::duplicate(int descriptor) {
  return {duplicate_high(descriptor), true};
}

PortDescriptor PortDescriptor::borrow(int descriptor) { return {descriptor, false}; }

PortDescriptor::~PortDescriptor() {
  if (number_ < 0) return;
  forget(number_);
  if (owned_ && still_open()) close(number_);
}

PortDescriptor::PortDescriptor(PortDescriptor&& other) noexcept
    : number_{std::exchange(other.number_, -1)},
      owned_{other.owned_},
      device_{other.device_},
      inode_{other.inode_} {}

PortDescriptor& PortDescriptor::operator=(PortDescriptor&& other) noexcept {
  std::swap(number_, other.number_);
  std::swap(owned_, other.owned_);
  std::swap(device_, other.device_);
  std::swap(inode_, other.inode_);
  return *this;
}

bool PortDescriptor::still_open() const noexcept { return is_that(number_, device_, inode_); }

StandardNumbersTaken::StandardNumbersTaken() {
  for (int number = 0; number < kLeast; ++number) {
    if (fcntl(number, F_GETFD) >= 0 || errno != EBADF) continue;
    const int opened = open("/dev/null", O_RDWR | O_CLOEXEC);
    if (opened == number) {
      ours_[number] = true;
    } else if (opened >= 0) {
      close(opened);  // another thread was faster
    }
  }
}

StandardNumbersTaken::~StandardNumbersTaken() {
  for (int number = 0; number < kLeast; ++number) {
    struct stat file{};
    const bool still = ours_[number] && fstat(number, &file) == 0 && S_ISCHR(file.st_mode) &&
                       file.st_rdev == makedev(1, 3);  // /dev/null, on every Linux
    if (still) close(number);
  }
}

}  // namespace cargobay::hal
