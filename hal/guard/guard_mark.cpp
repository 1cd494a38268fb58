#include "hal/guard/guard_mark.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <string_view>

#include "rt/unchecked.hpp"

namespace cargobay::hal {
namespace {

using std::chrono::milliseconds;

// A guard that sleeps for longer than this is frozen (the freezer of a control group).
constexpr milliseconds kOversleeps{80};
// One that is ready to run but gets no processor: the machine is busy, and the guard's stop would
// be late.
constexpr milliseconds kStarves{500};

// The state as in /proc/PID/stat, proc(5): R, S, D, T, t, Z, X. 'X' if there is no such process,
// '?' if that cannot be found out.
char state_of(pid_t process) noexcept {
  std::array<char, 32> path{};
  std::snprintf(path.data(), path.size(), "/proc/%d/stat", static_cast<int>(process));
  const int file = open(path.data(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return errno == ENOENT || errno == ESRCH ? 'X' : '?';
  std::array<char, 64> text{};  // "PID (cargobay-guard) S ..."
  const ssize_t size = read(file, text.data(), text.size());
  close(file);
  const std::string_view line{text.data(), static_cast<std::size_t>(size > 0 ? size : 0)};
  const std::size_t end_of_name = line.rfind(')');
  return end_of_name == std::string_view::npos || end_of_name + 2 >= line.size()
             ? '?'
             : line[end_of_name + 2];
}

bool is_lost(char state, rt::Duration silent) noexcept {
  switch (state) {
    case 'T':
    case 't':
    case 'Z':
    case 'X': return true;
    case 'R': return silent >= kStarves;
    default: return silent >= kOversleeps;
  }
}

}  // namespace

GuardMark::Robot GuardMark::look_after_guard(rt::Duration silent) CARGOBAY_NONBLOCKING {
  const bool lost = rt::unchecked([&]() noexcept { return is_lost(state_of(guard_), silent); });
  if (!lost) return Robot::ours;
  // A guard that is woken now finds that the robot is being left.
  GuardState expected = GuardState::driving;
  return block_->state.compare_exchange_strong(expected, GuardState::guard_lost) ||
                 expected == GuardState::guard_lost
             ? Robot::unguarded
             : Robot::taken;
}

}  // namespace cargobay::hal
