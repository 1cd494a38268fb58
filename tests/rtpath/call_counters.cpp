#include "tests/rtpath/call_counters.hpp"

#include <dlfcn.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <pthread.h>
#include <semaphore.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstddef>

namespace {

using cargobay::test::Calls;

thread_local bool counting = false;
thread_local Calls calls;
thread_local long faults_before = 0;

void count(std::uint64_t Calls::* what) {
  if (counting) ++(calls.*what);
}

long page_faults() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_minflt + usage.ru_majflt;
}

void tripped(int /*signal*/) { count(&Calls::other_calls); }

template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

// Looked up before main(): the search itself takes locks.
auto* const kMutexLock = next<int(pthread_mutex_t*)>("pthread_mutex_lock");
auto* const kConditionSignal = next<int(pthread_cond_t*)>("pthread_cond_signal");
auto* const kConditionBroadcast = next<int(pthread_cond_t*)>("pthread_cond_broadcast");
auto* const kConditionWait = next<int(pthread_cond_t*, pthread_mutex_t*)>("pthread_cond_wait");
auto* const kReadLock = next<int(pthread_rwlock_t*)>("pthread_rwlock_rdlock");
auto* const kWriteLock = next<int(pthread_rwlock_t*)>("pthread_rwlock_wrlock");
auto* const kSemaphoreWait = next<int(sem_t*)>("sem_wait");
auto* const kSemaphorePost = next<int(sem_t*)>("sem_post");
auto* const kPpoll = next<int(pollfd*, nfds_t, const timespec*, const sigset_t*)>("ppoll");
auto* const kRead = next<ssize_t(int, void*, std::size_t)>("read");
auto* const kWrite = next<ssize_t(int, const void*, std::size_t)>("write");
auto* const kSyscall = next<long(long, ...)>("syscall");

}  // namespace

// Names that others chose: glibc for a replaced allocator, POSIX for the rest.
// NOLINTBEGIN(bugprone-reserved-identifier, readability-identifier-naming)
// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name)
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) {
  count(&Calls::heap);
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  count(&Calls::heap);
  return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) {
  count(&Calls::heap);
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  count(&Calls::heap);
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count(&Calls::heap);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  count(&Calls::heap);
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
void free(void* memory) {
  count(&Calls::heap);
  __libc_free(memory);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  count(&Calls::locks);
  return kMutexLock(mutex);
}
int pthread_cond_signal(pthread_cond_t* condition) {
  count(&Calls::locks);
  return kConditionSignal(condition);
}
int pthread_cond_broadcast(pthread_cond_t* condition) {
  count(&Calls::locks);
  return kConditionBroadcast(condition);
}
int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  count(&Calls::locks);
  return kConditionWait(condition, mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
  count(&Calls::locks);
  return kReadLock(lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) {
  count(&Calls::locks);
  return kWriteLock(lock);
}
int sem_wait(sem_t* semaphore) {
  count(&Calls::locks);
  return kSemaphoreWait(semaphore);
}
int sem_post(sem_t* semaphore) {
  count(&Calls::locks);
  return kSemaphorePost(semaphore);
}

int ppoll(pollfd* descriptors, nfds_t number, const timespec* timeout, const sigset_t* mask) {
  count(&Calls::waits);
  const int ready = kPpoll(descriptors, number, timeout, mask);
  if (ready == 0) count(&Calls::time_outs);
  return ready;
}
ssize_t read(int descriptor, void* bytes, std::size_t size) {
  count(&Calls::reads);
  return kRead(descriptor, bytes, size);
}
ssize_t write(int descriptor, const void* bytes, std::size_t size) {
  count(&Calls::writes);
  return kWrite(descriptor, bytes, size);
}

// How std::atomic's wait() and notify() call their futex.
long syscall(long number, ...) {
  if (number == SYS_futex) count(&Calls::locks);
  std::array<long, 6> arguments{};
  va_list list;
  va_start(list, number);
  for (long& argument : arguments) argument = va_arg(list, long);
  va_end(list);
  return kSyscall(number, arguments[0], arguments[1], arguments[2], arguments[3], arguments[4],
                  arguments[5]);
}
}

namespace cargobay::test {

void begin_counting() {
  calls = {};
  faults_before = page_faults();
  counting = true;
}

Calls end_counting() {
  counting = false;
  Calls result = calls;
  result.page_faults = static_cast<std::uint64_t>(page_faults() - faults_before);
  return result;
}

bool lay_tripwire() {
  struct sigaction action{};
  action.sa_handler = tripped;
  sigaction(SIGSYS, &action, nullptr);
  sigset_t trip{};
  sigemptyset(&trip);
  sigaddset(&trip, SIGSYS);
  pthread_sigmask(SIG_UNBLOCK, &trip, nullptr);

  constexpr std::array kAllowed{SYS_ppoll, SYS_read,       SYS_write,        SYS_clock_gettime,
                                SYS_exit,  SYS_exit_group, SYS_rt_sigreturn, SYS_getrusage};
  // One jump per number to the last instruction, which allows; otherwise the one before it traps.
  std::array<sock_filter, kAllowed.size() + 3> program{};
  program[0] = BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr));
  for (std::size_t i = 0; i < kAllowed.size(); ++i) {
    const auto to_allow = static_cast<std::uint8_t>(kAllowed.size() - i);
    program[1 + i] =
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, static_cast<std::uint32_t>(kAllowed[i]), to_allow, 0);
  }
  program[kAllowed.size() + 1] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
  program[kAllowed.size() + 2] = BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
  const sock_fprog filter{.len = program.size(), .filter = program.data()};
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

Uncounted::Uncounted() : was_counting_{counting} { counting = false; }
Uncounted::~Uncounted() { counting = was_counting_; }

}  // namespace cargobay::test
// NOLINTEND(readability-inconsistent-declaration-parameter-name)
// NOLINTEND(bugprone-reserved-identifier, readability-identifier-naming)
