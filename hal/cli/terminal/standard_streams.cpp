#include "hal/cli/terminal/standard_streams.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <initializer_list>

#include "hal/cli/terminal/signals.hpp"

namespace cargobay::cli {
namespace {

struct Stream {
  int descriptor = -1;
  std::atomic<int> error{0};  // errno of the first write that failed; nothing is written after it
};

Stream& output() {
  static Stream stream{.descriptor = STDOUT_FILENO};
  return stream;
}
Stream& error_output() {
  static Stream stream{.descriptor = STDERR_FILENO};
  return stream;
}

// 0, or errno.
int write_all(int descriptor, const char* bytes, std::size_t size) {
  constexpr int kLookMs = 50;  // longest time until a signal is noticed
  while (size > 0) {
    const bool stops = StopSignals::came();
    pollfd waited{.fd = descriptor, .events = POLLOUT, .revents = 0};
    const int ready = poll(&waited, 1, stops ? 0 : kLookMs);
    if (ready == 0 && stops) return ECANCELED;
    if (ready <= 0) continue;
    // This many never block on a pipe that is ready for writing.
    const ssize_t count = write(descriptor, bytes, std::min<std::size_t>(size, PIPE_BUF));
    if (count < 0 && errno != EINTR && errno != EAGAIN) return errno;
    if (count <= 0) continue;
    bytes += count;
    size -= static_cast<std::size_t>(count);
  }
  return 0;
}

// Claims that everything was written, whatever happened: fmt would throw otherwise.
ssize_t write_some(void* cookie, const char* bytes, std::size_t size) {
  auto& stream = *static_cast<Stream*>(cookie);
  if (stream.error.load(std::memory_order_relaxed) != 0) return static_cast<ssize_t>(size);
  const int error = write_all(stream.descriptor, bytes, size);
  if (error == 0) return static_cast<ssize_t>(size);
  stream.error.store(error, std::memory_order_relaxed);
  // A terminal that goes away sends SIGHUP; and one that was closed from the beginning (EBADF) has
  // no reader that could leave: the command does its work and reports the error at its end.
  const bool ends = error != ECANCELED && error != EBADF && stream.descriptor == STDOUT_FILENO;
  if (ends && isatty(STDOUT_FILENO) != 1) StopSignals::output_failed();
  return static_cast<ssize_t>(size);
}

void rely_on(std::FILE*& file, Stream& stream, int buffering) {
  cookie_io_functions_t functions{};
  functions.write = &write_some;
  std::FILE* const better = fopencookie(&stream, "w", functions);
  if (better == nullptr) return;  // no memory: stays as it was
  (void)std::setvbuf(better, nullptr, buffering, BUFSIZ);
  file = better;
}

}  // namespace

bool open_standard_descriptors() {
  for (const int wanted : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(wanted, F_GETFD) >= 0) continue;
    // Using it fails, just as using the closed one would.
    const int opened = open("/dev/null", wanted == STDIN_FILENO ? O_WRONLY : O_RDONLY);
    if (opened != wanted) return false;  // open() returns the lowest free number
  }
  return true;
}

void rely_on_standard_streams() {
  // Too large a file and a reader that is gone become errors; this cannot fail.
  (void)std::signal(SIGXFSZ, SIG_IGN);
  (void)std::signal(SIGPIPE, SIG_IGN);
  rely_on(stdout, output(), isatty(STDOUT_FILENO) == 1 ? _IOLBF : _IOFBF);
  rely_on(stderr, error_output(), _IONBF);
}

void note_output_is_gone() {
  int none = 0;
  output().error.compare_exchange_strong(none, EPIPE, std::memory_order_relaxed);
}

std::error_code output_error() {
  return {output().error.load(std::memory_order_relaxed), std::generic_category()};
}

}  // namespace cargobay::cli
