#include "hal/cli/view/progress.hpp"

#include <chrono>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "hal/cli/terminal/print.hpp"
#include "rt/clock.hpp"

namespace cargobay::cli {
namespace {

constexpr std::chrono::milliseconds kQuietAtFirst{500};
constexpr std::chrono::milliseconds kQuietIfPlain{1000};
constexpr std::chrono::milliseconds kLineRefresh{200};

}  // namespace

Progress::Progress(std::string what) : what_{std::move(what)} {
  if (!stderr_is_terminal()) return;
  try {
    thread_ = std::thread{[this] { run(); }};
  } catch (const std::system_error&) {
    return;
  }
}

Progress::~Progress() {
  {
    const std::lock_guard lock{mutex_};
    over_ = true;
  }
  news_.notify_all();
  if (thread_.joinable()) thread_.join();
  clear_line();
}

void Progress::say(std::string what) {
  const std::lock_guard lock{mutex_};
  what_ = std::move(what);
}

void Progress::run() {
  const bool plain = !terminal_moves_cursor();
  const rt::TimePoint begin = rt::Clock::now();
  std::string shown;
  std::unique_lock lock{mutex_};
  rt::Duration pause = plain ? kQuietIfPlain : kQuietAtFirst;
  while (!news_.wait_for(lock, pause, [this] { return over_; })) {
    const double so_far = rt::seconds(rt::Clock::now() - begin);
    if (!plain) {
      show_line(fmt::format("{:.1f} s: {}", so_far, what_));
    } else if (shown != what_) {
      print_remark(what_);
      shown = what_;
    }
    pause = kLineRefresh;
  }
}

}  // namespace cargobay::cli
