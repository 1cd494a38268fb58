/* A17: each function whose comment says that it is real-time safe neither allocates, locks nor
 * enters the kernel, in a library loaded by dlopen(), as the first call on its thread, whether it
 * fails or not. A new function needs no entry here. $CARGOBAY_LIBRARY is the library. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

static void (*loaded[200])(void);
#define LOADED(index, function) ((__typeof__(&function))loaded[index])
#include "every_function.h"

/* ---- what is counted: on this thread, while it calls ---- */

struct calls {
  int heap;
  int locks;
  int kernel;
};
static __thread bool counting;
static __thread struct calls counted;

void* __libc_malloc(size_t size);
void* __libc_calloc(size_t number, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* memory);

void* malloc(size_t size) {
  counted.heap += counting;
  return __libc_malloc(size);
}
void* calloc(size_t number, size_t size) {
  counted.heap += counting;
  return __libc_calloc(number, size);
}
void* realloc(void* memory, size_t size) {
  counted.heap += counting;
  return __libc_realloc(memory, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  counted.heap += counting;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, size_t alignment, size_t size) {
  counted.heap += counting;
  *memory = __libc_memalign(alignment, size);
  return *memory == NULL ? ENOMEM : 0;
}
void free(void* memory) {
  counted.heap += counting;
  __libc_free(memory);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static int (*next)(pthread_mutex_t*);
  if (next == NULL) {
    void* const found = dlsym(RTLD_NEXT, "pthread_mutex_lock");
    memcpy(&next, &found, sizeof next);
  }
  counted.locks += counting;
  return next(mutex);
}

/* The kernel leaves it to the handler what the call returns: it fails. */
static void tripped(int signal, siginfo_t* info, void* at) {
  ucontext_t* const context = at;
  (void)signal;
  (void)info;
#if defined __x86_64__
  context->uc_mcontext.gregs[REG_RAX] = -ENOSYS;
#elif defined __aarch64__
  context->uc_mcontext.regs[0] = (unsigned long long)-ENOSYS;
#elif defined __arm__
  context->uc_mcontext.arm_r0 = (unsigned long)-ENOSYS;
#else
#error "which register holds the result of a system call?"
#endif
  counted.kernel += counting;
}

/* From here on, each system call of this thread is counted, and fails. Where the clock has no vDSO,
 * reading it is one; that is the machine's. */
static void lay_tripwire(void) {
  struct sock_filter program[] = {
      BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit, 4, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit_group, 3, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_rt_sigreturn, 2, 0),
      BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_clock_gettime, 1, 0),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
      BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
  };
  const struct sock_fprog filter = {sizeof program / sizeof program[0], program};
  struct sigaction action;
  memset(&action, 0, sizeof action);
  action.sa_sigaction = tripped;
  action.sa_flags = SA_SIGINFO;
  if (sigaction(SIGSYS, &action, NULL) == 0 && prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
      prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0)
    return;
  fputs("this kernel has no seccomp filters\n", stderr);
  exit(77);
}

/* ---- calls ---- */

struct job {
  const struct function* function;
  void* handle;
  struct calls counted;
};

static void* calls_once(void* context) {
  struct job* self = context;
  /* The allocator gets its memory beforehand: a call that should not allocate can then go on. */
  void* volatile memory = malloc(100000);
  free(memory);
  lay_tripwire();
  counting = true;
  (void)self->function->call(self->handle);
  counting = false;
  self->counted = counted;
  syscall(SYS_exit, 0); /* returning would need the kernel too */
  return NULL;
}

static struct calls on_a_fresh_thread(const struct function* function, void* handle) {
  struct job job = {function, handle, {0, 0, 0}};
  pthread_t thread;
  if (pthread_create(&thread, NULL, calls_once, &job) != 0 || pthread_join(thread, NULL) != 0) {
    fputs("no thread\n", stderr);
    exit(1);
  }
  return job.counted;
}

static int failed;

static void is_safe(const struct function* function, void* handle, const char* how) {
  const struct calls did = on_a_fresh_thread(function, handle);
  if (did.heap + did.locks + did.kernel == 0) return;
  fprintf(stderr, "%s, %s: %d calls of the allocator, %d locks, %d system calls\n", function->name,
          how, did.heap, did.locks, did.kernel);
  failed = 1;
}

static bool is_real_time_safe(const struct function* function) {
  return strstr(function->comment, "real-time safe") != NULL;
}

static const struct function* find(const char* name) {
  for (int i = 0; i < kFunctionCount; ++i) {
    if (strcmp(kFunctions[i].name, name) == 0) return &kFunctions[i];
  }
  fprintf(stderr, "no function %s\n", name);
  exit(1);
}

#define MUST(function, ...)                                                             \
  do {                                                                                  \
    void (*const found_)(void) = loaded[find(#function) - kFunctions];                  \
    const int got_ = ((__typeof__(&function))found_)(__VA_ARGS__);                      \
    if (got_ != 0) {                                                                    \
      void (*const words_)(void) = loaded[find("cargobay_error_message") - kFunctions]; \
      fprintf(stderr, #function ": %d: %s\n", got_,                                     \
              ((__typeof__(&cargobay_error_message))words_)());                         \
      exit(1);                                                                          \
    }                                                                                   \
  } while (0)

static void load(void) {
  const char* path = getenv("CARGOBAY_LIBRARY");
  void* library = path == NULL ? NULL : dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (library == NULL) {
    fprintf(stderr, "$CARGOBAY_LIBRARY: %s\n", path == NULL ? "is not set" : dlerror());
    exit(1);
  }
  for (int i = 0; i < kFunctionCount; ++i) {
    void* const found = dlsym(library, kFunctions[i].name);
    memcpy(&loaded[i], &found, sizeof loaded[i]);
    if (found != NULL) continue;
    fprintf(stderr, "%s\n", dlerror());
    exit(1);
  }
}

/* Functions that lock, allocate and write a file: each counter counts. */
static void counters_count(struct cargobay_robot* robot) {
  const struct calls locks = on_a_fresh_thread(find("cargobay_send_ir"), robot);
  const struct calls writes = on_a_fresh_thread(find("cargobay_save_recording"), robot);
  if (locks.locks > 0 && writes.heap > 0 && writes.kernel > 0) return;
  fprintf(stderr, "the counters do not count: %d, %d, %d\n", locks.locks, writes.heap,
          writes.kernel);
  exit(1);
}

static void check_all(void* handles[4], const char* how) {
  for (int i = 0; i < kFunctionCount; ++i) {
    const struct function* function = &kFunctions[i];
    if (!is_real_time_safe(function) || strcmp(function->name, "cargobay_request_end") == 0)
      continue;
    is_safe(function, handles[function->kind], how);
  }
  is_safe(find("cargobay_request_end"), handles[of_robot], how);
}

int main(void) {
  void* handles[4] = {NULL, NULL, NULL, NULL};
  struct cargobay_robot* robot = NULL;
  struct cargobay_histogram* histogram = NULL;
  struct cargobay_options options;
  int count = 0;
  load();
  for (int i = 0; i < kFunctionCount; ++i) count += is_real_time_safe(&kFunctions[i]);
  check_all(handles, "with NULL");
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  MUST(cargobay_open, &options, &robot);
  MUST(cargobay_histogram_open, &histogram);
  handles[of_robot] = robot;
  handles[of_histogram] = histogram;
  for (int i = 0; i < kFunctionCount; ++i) {
    if (kFunctions[i].kind == of_robot && is_real_time_safe(&kFunctions[i]) &&
        strcmp(kFunctions[i].name, "cargobay_request_end") != 0)
      is_safe(&kFunctions[i], robot, "before the start");
  }
  MUST(cargobay_start, robot);
  MUST(cargobay_wait, robot, -1, 5000000000, NULL);
  MUST(cargobay_drive, robot, 100.0, 0.0);
  counters_count(robot);
  check_all(handles, "while the loop runs");
  MUST(cargobay_end, robot);
  check_all(handles, "after the end");
  MUST(cargobay_histogram_close, histogram);
  MUST(cargobay_close, robot);
  check_all(handles, "with a closed handle");
  printf("%d functions are real-time safe\n", count);
  if (count < 20) return 1;
  return failed;
}
