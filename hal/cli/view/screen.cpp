#include "hal/cli/view/screen.hpp"

#include <sys/ioctl.h>
#include <sys/mman.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <utility>

#define NCURSES_NOMACROS 1  // NOLINT(*-macro-usage,*-identifier-naming): how ncurses is told
#include <curses.h>

#include "hal/cli/terminal/print.hpp"
#include "hal/cli/terminal/signals.hpp"
#include "hal/cli/terminal/standard_streams.hpp"
#include "hal/cli/view/restore.hpp"

namespace cargobay::cli {
namespace {

// Initialised before main(): a signal handler uses them.
std::atomic<bool>& suspend_wanted() {
  static constinit std::atomic<bool> wanted{false};
  return wanted;
}
std::atomic<bool>& continued() {
  static constinit std::atomic<bool> seen{false};
  return seen;
}

void note_signal(int signal) {
  (signal == SIGTSTP ? suspend_wanted() : continued()).store(true, std::memory_order_relaxed);
}

struct sigaction handled(int signal) {
  struct sigaction action{};
  action.sa_handler = &note_signal;
  action.sa_flags = SA_RESTART;
  struct sigaction former{};
  sigaction(signal, &action, &former);
  return former;
}

// Without the delays in it, such as $<50>: they were for terminals that could not keep up.
std::string without_delays(std::string text) {
  for (std::size_t at = text.find("$<"); at != std::string::npos; at = text.find("$<", at)) {
    const std::size_t end = text.find('>', at);
    if (end == std::string::npos) break;
    text.erase(at, end + 1 - at);
  }
  return text;
}

// Empty if the terminal cannot do it.
std::string capability(const char* name) {
  const char* const text = tigetstr(name);
  const bool there = text != nullptr && std::bit_cast<std::intptr_t>(text) != -1;
  return there ? without_delays(text) : "";
}

// Lines and columns of the scrolling region: some terminals keep it when the other screen is left.
std::string whole_region(const WindowSize& size) {
  const std::string form = capability("csr");
  if (form.empty()) return {};
  const char* const text = tiparm(form.c_str(), 0, size.rows - 1);
  return text == nullptr ? "" : text;
}

WindowSize window_size() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_row > 0 && size.ws_col > 0)
    return {.rows = size.ws_row, .columns = size.ws_col};
  return {.rows = 24, .columns = 80};  // what a terminal is that does not say
}

// Writing to a terminal, or changing it, suspends a process that is not of its foreground job.
bool in_foreground() {
  const pid_t job = tcgetpgrp(STDOUT_FILENO);
  return job < 0 ? errno == ENOTTY : job == getpgrp();
}

bool wants_colours() {
  const char* const no = std::getenv("NO_COLOR");  // NOLINT(concurrency-mt-unsafe): nothing sets it
  return no == nullptr || *no == '\0';
}

constexpr short kGoodPair = 1;
constexpr short kAlarmPair = 2;

// ncurses draws into memory: what it drew goes out through the command's own standard output, which
// no terminal that takes nothing can block for ever, and the terminal's settings stay ours.
class Canvas {
 public:
  static std::unique_ptr<Canvas> make() {
    std::unique_ptr<Canvas> canvas{new Canvas};
    return canvas->screen_ == nullptr ? nullptr : std::move(canvas);
  }
  ~Canvas() {
    if (screen_ != nullptr) {
      (void)endwin();
      delscreen(screen_);
    }
    if (out_ != nullptr) (void)std::fclose(out_);
  }
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  void resize(const WindowSize& size) { (void)resizeterm(size.rows, size.columns); }
  void redraw_all() { (void)clearok(curscr, true); }
  // The bytes that make the terminal show this.
  std::string draw(const std::vector<ScreenLine>& lines) {
    (void)werase(stdscr);
    const int rows = getmaxy(stdscr);
    for (int row = 0; row < rows && row < static_cast<int>(lines.size()); ++row)
      put(row, lines[static_cast<std::size_t>(row)]);
    (void)wmove(stdscr, rows - 1, 0);
    (void)wnoutrefresh(stdscr);
    (void)doupdate();
    return take();
  }

 private:
  Canvas() {
    const int memory = memfd_create("cargobay-view", MFD_CLOEXEC);
    if (memory < 0) return;
    out_ = fdopen(memory, "w+");
    if (out_ == nullptr) return;
    screen_ = newterm(nullptr, out_, stdin);  // from which nothing is read
    if (screen_ == nullptr) return;
    (void)typeahead(-1);  // a key does not put a picture off
    if (wants_colours() && has_colors() && start_color() == OK && use_default_colors() == OK) {
      colours_ =
          init_pair(kGoodPair, COLOR_GREEN, -1) == OK && init_pair(kAlarmPair, COLOR_RED, -1) == OK;
    }
    // How ncurses begins: it would switch to the other screen once more, and save the cursor there.
    (void)doupdate();
    (void)take();
  }

  chtype attributes(TextStyle style) const {
    switch (style) {
      case TextStyle::plain: break;
      case TextStyle::title: return A_REVERSE;
      case TextStyle::strong: return A_BOLD;
      case TextStyle::good: return colours_ ? static_cast<chtype>(COLOR_PAIR(kGoodPair)) : A_NORMAL;
      case TextStyle::alarm:
        return A_BOLD | (colours_ ? static_cast<chtype>(COLOR_PAIR(kAlarmPair)) : A_REVERSE);
    }
    return A_NORMAL;
  }

  void put(int row, const ScreenLine& line) const {
    const int columns = getmaxx(stdscr);
    int column = 0;
    for (const ScreenText& text : line) {
      const int size = std::min(static_cast<int>(text.text.size()), columns - column);
      if (size <= 0) continue;
      (void)wattrset(stdscr, static_cast<int>(attributes(text.style)));
      (void)mvwaddnstr(stdscr, row, column, text.text.c_str(), size);
      column += size;
    }
    (void)wattrset(stdscr, A_NORMAL);
  }

  std::string take() const {
    (void)std::fflush(out_);
    const int memory = fileno(out_);
    const off_t size = lseek(memory, 0, SEEK_CUR);
    std::string bytes(static_cast<std::size_t>(std::max<off_t>(size, 0)), '\0');
    if (pread(memory, bytes.data(), bytes.size(), 0) != size) bytes.clear();
    (void)!ftruncate(memory, 0);
    (void)lseek(memory, 0, SEEK_SET);
    return bytes;
  }

  std::FILE* out_ = nullptr;
  SCREEN* screen_ = nullptr;
  bool colours_ = false;
};

class TerminalScreen final : public Screen {
 public:
  TerminalScreen(const TerminalScreen&) = delete;
  TerminalScreen& operator=(const TerminalScreen&) = delete;
  TerminalScreen(std::unique_ptr<Canvas> canvas, ControlZ control_z)
      : canvas_{std::move(canvas)}, control_z_{control_z} {
    suspend_wanted().store(false, std::memory_order_relaxed);
    continued().store(false, std::memory_order_relaxed);
    if (control_z_ == ControlZ::suspends) former_stop_ = handled(SIGTSTP);
    former_continue_ = handled(SIGCONT);
    enter();
  }
  ~TerminalScreen() override {
    leave();
    if (control_z_ == ControlZ::suspends) sigaction(SIGTSTP, &former_stop_, nullptr);
    sigaction(SIGCONT, &former_continue_, nullptr);
  }

  WindowSize size() override { return window_size(); }

  void draw(const std::vector<ScreenLine>& lines) override {
    (void)attend();
    if (!entered_ && !in_foreground()) return;
    if (!entered_) enter();
    if (const WindowSize now = window_size(); now != size_) follow(now);
    print(canvas_->draw(lines));
  }

  bool attend() override {
    if (suspend_wanted().exchange(false, std::memory_order_relaxed)) {
      suspend();
      return true;
    }
    if (!continued().exchange(false, std::memory_order_relaxed)) return false;
    // Whoever had the terminal meanwhile has left something on it.
    if (entered_ && in_foreground()) {
      leave();
      enter();
    }
    return true;
  }

 private:
  static void print(std::string_view bytes) {
    (void)std::fwrite(bytes.data(), 1, bytes.size(), stdout);
    (void)std::fflush(stdout);
  }

  void enter() {
    size_ = window_size();
    canvas_->resize(size_);
    canvas_->redraw_all();
    termios found{};
    found_ = tcgetattr(STDOUT_FILENO, &found) == 0 ? std::optional{found} : std::nullopt;
    arm_restore(STDOUT_FILENO, way_out(), found_);
    if (found_) {
      found.c_lflag &= ~static_cast<tcflag_t>(ECHO | ICANON);
      tcsetattr(STDOUT_FILENO, TCSANOW, &found);
    }
    print(capability("smcup") + whole_region(size_) + capability("civis"));
    entered_ = true;
  }
  void leave() {
    if (!std::exchange(entered_, false)) return;
    if (output_error()) {  // nothing more goes out that way
      restore_terminal();
      return;
    }
    print(way_out());
    disarm_restore();
    if (found_) tcsetattr(STDOUT_FILENO, TCSAFLUSH, &*found_);  // what was typed was for the view
  }
  // A terminal without another screen is cleared.
  std::string way_out() const {
    const std::string other = capability("rmcup");
    return capability("sgr0") + whole_region(size_) + capability("cnorm") +
           (other.empty() ? capability("clear") : other);
  }
  void follow(const WindowSize& now) {
    size_ = now;
    canvas_->resize(now);
    canvas_->redraw_all();
    arm_restore(STDOUT_FILENO, way_out(), found_);
    print(whole_region(now));
  }
  // As the system would, but with the terminal put in order first.
  void suspend() {
    leave();
    sigaction(SIGTSTP, &former_stop_, nullptr);
    (void)raise(SIGTSTP);
    former_stop_ = handled(SIGTSTP);
    continued().store(false, std::memory_order_relaxed);
    if (in_foreground()) enter();
  }

  HeldMessages held_{};
  std::unique_ptr<Canvas> canvas_;
  ControlZ control_z_;
  struct sigaction former_stop_{};
  struct sigaction former_continue_{};
  std::optional<termios> found_{};
  WindowSize size_{};
  bool entered_ = false;
};

}  // namespace

std::unique_ptr<Screen> Screen::open(ControlZ control_z) {
  if (!stdout_is_terminal() || !terminal_moves_cursor() || !in_foreground()) return nullptr;
  call_before_exit(&restore_terminal);
  auto canvas = Canvas::make();
  if (!canvas || capability("cup").empty()) return nullptr;
  return std::make_unique<TerminalScreen>(std::move(canvas), control_z);
}

}  // namespace cargobay::cli
