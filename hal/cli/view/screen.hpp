// A view that has the terminal's whole screen: lines of text, drawn by ncurses.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace cargobay::cli {

enum class TextStyle : std::uint8_t { plain, title, strong, good, alarm };

struct ScreenText {
  std::string text{};  // ASCII
  TextStyle style = TextStyle::plain;
};
using ScreenLine = std::vector<ScreenText>;

struct WindowSize {
  int rows = 0;
  int columns = 0;
  friend bool operator==(const WindowSize&, const WindowSize&) = default;
};

// What Ctrl-Z does: suspends the command, as usual; or it is one of the StopSignals, and ends it.
enum class ControlZ : std::uint8_t { suspends, ends };

// From its beginning to its end the terminal shows its other screen, echoes nothing that is typed,
// and messages are kept (HeldMessages); then it is as it was, also after Ctrl-Z and a crash. One at
// a time, all calls from one thread. Colours unless NO_COLOR is set.
class Screen {
 public:
  // Null if standard output is not a terminal, or one that cannot move its cursor (TERM=dumb), or
  // belongs to another job now.
  static std::unique_ptr<Screen> open(ControlZ control_z);
  virtual ~Screen() = default;
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  // Of the window as it is now.
  virtual WindowSize size() = 0;
  // Shows these lines, each cut at the window's edge, and no others. Waits for a slow terminal
  // until one of the StopSignals comes.
  virtual void draw(const std::vector<ScreenLine>& lines) = 0;
  // Suspends the command if Ctrl-Z was typed; returns when it is continued, and true if the next
  // picture is due at once. Costs next to nothing otherwise.
  virtual bool attend() = 0;

 protected:
  Screen() = default;
};

// So many columns wide: cut, or filled with blanks.
inline std::string fitted(std::string text, int columns) {
  text.resize(static_cast<std::size_t>(std::max(columns, 0)), ' ');
  return text;
}

}  // namespace cargobay::cli
