#include "hal/robot/open_watch.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

namespace cargobay::hal {

OpenWatch::~OpenWatch() {
  if (is_ours()) close(descriptor_);
}

bool OpenWatch::begin(const std::string& path) {
  const int first = inotify_init1(IN_CLOEXEC | IN_NONBLOCK);
  if (first < 0) return false;
  // Not one of the standard streams, if the program has closed those.
  descriptor_ = fcntl(first, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  close(first);
  if (descriptor_ >= 0) watch_ = inotify_add_watch(descriptor_, path.c_str(), IN_OPEN);
  return watch_ >= 0;
}

bool OpenWatch::is_ours() const {
  if (descriptor_ < 0) return false;
  std::array<char, 64> target{};
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor_);
  const ssize_t length = readlink(link.c_str(), target.data(), target.size());
  return length > 0 &&
         std::string_view{target.data(), static_cast<std::size_t>(length)} == "anon_inode:inotify";
}

OpenWatch::Woken OpenWatch::wait(rt::TimePoint limit) {
  const timespec timeout =
      rt::as_timespec(std::max(limit - rt::Clock::now(), rt::Duration::zero()));
  pollfd what{.fd = descriptor_, .events = POLLIN, .revents = 0};
  if (watch_ < 0) return Woken::blind;
  if (ppoll(&what, 1, &timeout, nullptr) <= 0) return Woken::timed_out;
  if (!is_ours()) return Woken::blind;
  // One kind of note at most is long: the name of a file in a folder, which this is not.
  alignas(inotify_event) std::array<char, 1024> notes{};
  Woken woken = Woken::timed_out;
  for (ssize_t count = 0; (count = read(descriptor_, notes.data(), notes.size())) > 0;) {
    woken = Woken::opened;
    // The last note of a watch that was removed.
    inotify_event last{};
    const std::size_t at = static_cast<std::size_t>(count) - sizeof last;
    std::copy_n(notes.data() + at, sizeof last, reinterpret_cast<char*>(&last));
    if ((last.mask & IN_IGNORED) != 0) return Woken::ended;
  }
  return woken == Woken::opened ? woken : Woken::blind;
}

void OpenWatch::end() const {
  if (watch_ >= 0 && is_ours()) (void)inotify_rm_watch(descriptor_, watch_);
}

}  // namespace cargobay::hal
