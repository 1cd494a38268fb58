// Where the command prints its messages.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace cargobay::cli {

// Prints one line to standard error, after the program's name. On a terminal it is broken at words;
// elsewhere it stays one line. Any thread.
void print_error(std::string_view message);
// The same, for remarks that stop nothing.
void print_remark(std::string_view message);
bool stdout_is_terminal();
bool stderr_is_terminal();
// Whether the terminal can do more than print one line after the other: TERM says so.
bool terminal_moves_cursor();
// Columns of the terminal that this descriptor is; 0 if it is none, or does not say.
std::size_t terminal_columns(int descriptor);

// Breaks a text at blanks so that no line is longer than `columns`, except by a single word. Lines
// after the first begin with `indent` blanks. 0 columns: unchanged. Line breaks in it stay.
std::string wrapped(std::string_view text, std::size_t columns, std::size_t indent);

// One line that is replaced again and again, on standard error: cut to the terminal's width, and
// gone before a message is printed. Does nothing if standard error is not a terminal that can move
// its cursor. Any thread.
void show_line(std::string_view text);
void clear_line();

// While it lives, messages are kept, and printed at its end: for a view that has the whole screen.
// One at a time.
class HeldMessages {
 public:
  HeldMessages();
  ~HeldMessages();
  HeldMessages(const HeldMessages&) = delete;
  HeldMessages& operator=(const HeldMessages&) = delete;
  // Those so far, without the program's name.
  static std::vector<std::string> so_far();
};

}  // namespace cargobay::cli
