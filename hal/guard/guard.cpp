#include "hal/guard/guard.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <ctime>
#include <new>
#include <utility>

#include "hal/file/port_descriptor.hpp"
#include "hal/guard/guard_program.hpp"
#include "hal/port/port_lock.hpp"
#include "hal/trouble.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kReadyTimeout{2000};
// How long the guard takes to end once released, and to deal with a robot that does not answer.
constexpr milliseconds kEndTimeout{1000};
constexpr milliseconds kFarewellTimeout{4000};
constexpr milliseconds kSilence{500};  // without a beat for so long, it will not end either
constexpr milliseconds kNap{1};
constexpr int kAboveTheLoop = 10;
constexpr int kMostPriority = 98;  // 99 is for threads without which the kernel stops working

void nap() {
  const timespec pause = rt::as_timespec(kNap);
  nanosleep(&pause, nullptr);
}

Failure no_guard(const std::string& why) {
  return {
      "the robot would have no guard, and its wheels would keep turning if this program died: " +
          why,
      Trouble::guard};
}

void prepare(GuardBlock& block, const PortLock& lock, const GuardOptions& options, int priority,
             std::uint32_t baud) {
  block.owner = getpid();
  block.priority = priority > 0 ? std::min(priority + kAboveTheLoop, kMostPriority) : 0;
  block.deadline_ns = options.deadline.count();
  block.found = lock.found();
  block.found_baud = lock.found_speed().value_or(0);
  block.wanted_baud = baud;
  const bool idle = options.moves == GuardOptions::Moves::nothing;
  block.idle_beat_ns = rt::Duration{idle ? kIdleGuardBeat : kGuardBeat}.count();
  pthread_mutexattr_t attributes;
  pthread_mutexattr_init(&attributes);
  pthread_mutexattr_setpshared(&attributes, PTHREAD_PROCESS_SHARED);
  pthread_mutexattr_setrobust(&attributes, PTHREAD_MUTEX_ROBUST);
  pthread_mutex_init(&block.alive, &attributes);
  pthread_mutexattr_destroy(&attributes);
}

// Returns an errno. Of this process's descriptors the child gets only those of the port, the block
// and the owner pipe: it keeps neither the user's terminal nor any of the user's pipes open.
int spawn(const std::string& program, int port, int block, int owner, pid_t& process) {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&files);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_adddup2(&files, port, GuardBlock::kPort);
  posix_spawn_file_actions_adddup2(&files, block, GuardBlock::kBlock);
  posix_spawn_file_actions_adddup2(&files, owner, GuardBlock::kOwner);
  for (const int number : {0, 1, 2})
    posix_spawn_file_actions_addopen(&files, number, "/dev/null", O_RDWR, 0);
  posix_spawn_file_actions_addclosefrom_np(&files, GuardBlock::kOwner + 1);
  sigset_t all;
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &all);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSID);
  std::array<char, 16> name{"cargobay-guard"};
  std::array<char*, 2> arguments{name.data(), nullptr};
  const int error =
      posix_spawn(&process, program.c_str(), &files, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  return error;
}

}  // namespace

Result<std::unique_ptr<Guard>> Guard::start(const ByteStream::Terminal& terminal,
                                            const GuardOptions& options, int priority,
                                            std::uint32_t baud) {
  const auto found = guard_program(options.program);
  if (!found) return no_guard(found.failure().message);
  const std::string& program = *found;
  const StandardNumbersTaken taken;
  const PortDescriptor shared = PortDescriptor::adopt(memfd_create("cargobay-guard", MFD_CLOEXEC));
  const PortDescriptor port = PortDescriptor::duplicate(terminal.descriptor);
  std::array<int, 2> pipe{-1, -1};
  if (pipe2(pipe.data(), O_CLOEXEC | O_NONBLOCK) != 0)
    return no_guard(std::generic_category().message(errno));
  PortDescriptor watched = PortDescriptor::adopt(pipe[0]);
  PortDescriptor owner = PortDescriptor::adopt(pipe[1]);
  void* memory = MAP_FAILED;
  if (port.number() >= 0 && ftruncate(shared.number(), sizeof(GuardBlock)) == 0) {
    memory =
        mmap(nullptr, sizeof(GuardBlock), PROT_READ | PROT_WRITE, MAP_SHARED, shared.number(), 0);
  }
  if (memory == MAP_FAILED) return no_guard(std::generic_category().message(errno));
  (void)madvise(memory, sizeof(GuardBlock), MADV_DONTFORK);  // a child must not touch it
  std::unique_ptr<Guard> guard{new Guard{new (memory) GuardBlock}};
  prepare(*guard->block_, *terminal.lock, options, priority, baud);
  guard->owner_ = std::move(owner);
  guard->watched_ = std::move(watched);
  const int error =
      spawn(program, port.number(), shared.number(), guard->watched_.number(), guard->process_);
  if (error != 0) {
    guard->process_ = -1;
    return no_guard("cannot start " + program + ": " + std::generic_category().message(error));
  }
  if (!guard->wait_until_ready()) {
    return no_guard(program + " does not start; is it from another version than this program?");
  }
  return guard;
}

Guard::~Guard() {
  release();
  munmap(block_, sizeof(GuardBlock));
}

bool Guard::wait_until_ready() const {
  const rt::TimePoint limit = rt::Clock::now() + kReadyTimeout;
  while (!block_->ready.load(std::memory_order_acquire)) {
    if (!alive() || rt::Clock::now() >= limit) return false;
    nap();
  }
  return true;
}

void Guard::begin_driving() {
  pthread_mutex_lock(&block_->alive);
  block_->driven.store(true, std::memory_order_relaxed);
  block_->beat_ns.store(rt::nanoseconds(rt::Clock::now()), std::memory_order_relaxed);
  GuardState expected = GuardState::standing_by;
  // The guard may have taken the robot from an owner that it found dead.
  block_->state.compare_exchange_strong(expected, GuardState::driving);
  wake();
}

// If the guard was lost, the robot is being left already.
void Guard::end_driving() {
  take_over();
  pthread_mutex_unlock(&block_->alive);
}

void Guard::take_over() {
  GuardState expected = GuardState::driving;
  block_->state.compare_exchange_strong(expected, GuardState::leaving);
}

bool Guard::has_taken() const {
  return block_->state.load(std::memory_order_acquire) == GuardState::taken;
}

bool Guard::took_robot() {
  if (!has_taken()) return false;
  wait_until_done();
  return true;
}

Parting Guard::hand_over() {
  GuardState expected = block_->state.load(std::memory_order_acquire);
  while (expected != GuardState::taken &&
         !block_->state.compare_exchange_weak(expected, GuardState::handed_over)) {
  }
  wake();
  wait_until_done();
  return parting();
}

Parting Guard::parting() const { return block_->parting.load(std::memory_order_acquire); }

void Guard::robot_is_left() {
  GuardState expected = block_->state.load(std::memory_order_acquire);
  while (expected != GuardState::taken &&
         !block_->state.compare_exchange_weak(expected, GuardState::left)) {
  }
}

void Guard::release() {
  if (took_robot()) block_->state.store(GuardState::released, std::memory_order_release);
  GuardState expected = block_->state.load(std::memory_order_acquire);
  while (expected != GuardState::taken &&
         !block_->state.compare_exchange_weak(expected, GuardState::released)) {
  }
  if (expected == GuardState::taken) release();  // taken at this very moment
  wake();
  collect();
}

bool Guard::beats() const {
  const rt::TimePoint beat{rt::Duration{block_->guard_beat_ns.load(std::memory_order_relaxed)}};
  return rt::Clock::now() < beat + kSilence;
}

// The guard also beats while it stops a robot; one that does not beat will not finish.
void Guard::wait_until_done() const {
  const rt::TimePoint limit = rt::Clock::now() + kFarewellTimeout;
  while (!block_->done.load(std::memory_order_acquire) && alive() && beats() &&
         rt::Clock::now() < limit) {
    nap();
  }
}

// From its sleep between two beats. If this fails, the guard looks at the state a beat later.
void Guard::wake() const {
  if (!owner_.still_open() || !watched_.still_open()) return;  // another's files
  const std::uint8_t byte = 0;
  (void)!write(owner_.number(), &byte, sizeof byte);
}

// One that does not end, or does not beat, is killed.
void Guard::collect() {
  const rt::TimePoint limit = rt::Clock::now() + kEndTimeout;
  while (process_ > 0 && alive()) {
    if (rt::Clock::now() >= limit || !beats()) kill(process_, SIGKILL);
    nap();
  }
  // Code that collects all children may have been faster.
  if (process_ > 0) (void)waitpid(process_, nullptr, 0);
  process_ = -1;
}

bool Guard::alive() const {
  siginfo_t ended{};
  if (process_ <= 0) return false;
  const int result =
      waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOHANG | WNOWAIT);
  return result == 0 && ended.si_pid == 0;
}

}  // namespace cargobay::hal
