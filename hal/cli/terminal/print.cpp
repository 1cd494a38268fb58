#include "hal/cli/terminal/print.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <utility>

#include <fmt/core.h>

namespace cargobay::cli {
namespace {

constexpr std::string_view kErrorPrefix = "cargobay: error: ";
constexpr std::string_view kRemarkPrefix = "cargobay: ";
constexpr std::size_t kIndent = 2;

struct Message {
  std::string_view prefix{};
  std::string text{};
};

// What threads share that print to standard error.
struct MessageState {
  std::mutex mutex{};
  bool line_shown = false;
  bool holding = false;
  std::vector<Message> held{};
};

// Never destroyed: threads may print until the process is gone.
MessageState& message_state() {
  static auto& instance =
      *new MessageState;  // NOLINT(cppcoreguidelines-owning-memory): as said above
  return instance;
}

void erase_line(MessageState& all) {
  if (std::exchange(all.line_shown, false)) fmt::print(stderr, "\r\033[K");
}

void put_message(const Message& message) {
  const std::string line = std::string{message.prefix} + message.text;
  fmt::print(stderr, "{}\n", wrapped(line, terminal_columns(STDERR_FILENO), kIndent));
}

void print_after(std::string_view prefix, std::string_view text) {
  MessageState& all = message_state();
  const std::lock_guard lock{all.mutex};
  Message message{.prefix = prefix, .text = std::string{text}};
  if (all.holding) {
    all.held.push_back(std::move(message));
    return;
  }
  erase_line(all);
  put_message(message);
}

// Continuation bytes of UTF-8 take no column.
bool begins_character(char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }

std::size_t display_width(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(text, begins_character));
}

std::string_view cut_to(std::string_view text, std::size_t columns) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (begins_character(text[i]) && seen++ == columns) return text.substr(0, i);
  }
  return text;
}

// The words of one line, appended; `column` is where the text begins.
void wrap_line(std::string& out, std::string_view line, std::size_t columns, std::size_t indent) {
  std::size_t column = 0;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t word = std::min(line.find_first_not_of(' ', at), line.size());
    const std::size_t end = std::min(line.find(' ', word), line.size());
    const std::size_t size = display_width(line.substr(at, end - at));
    if (column + size > columns && column > indent && word < end) {
      out += '\n' + std::string(indent, ' ');
      out += line.substr(word, end - word);
      column = indent + display_width(line.substr(word, end - word));
    } else {
      out += line.substr(at, end - at);
      column += size;
    }
    at = end;
  }
}

}  // namespace

void print_error(std::string_view message) { print_after(kErrorPrefix, message); }
void print_remark(std::string_view message) { print_after(kRemarkPrefix, message); }
bool stdout_is_terminal() { return isatty(STDOUT_FILENO) == 1; }
bool stderr_is_terminal() { return isatty(STDERR_FILENO) == 1; }

bool terminal_moves_cursor() {
  const char* const name = std::getenv("TERM");  // NOLINT(concurrency-mt-unsafe): nothing sets it
  return name != nullptr && *name != '\0' && std::string_view{name} != "dumb";
}

std::size_t terminal_columns(int descriptor) {
  winsize size{};
  return ioctl(descriptor, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

std::string wrapped(std::string_view text, std::size_t columns, std::size_t indent) {
  if (columns == 0) return std::string{text};
  std::string out;
  for (std::size_t at = 0;;) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    wrap_line(out, text.substr(at, end - at), columns, indent);
    if (end == text.size()) return out;
    out += '\n';
    at = end + 1;
  }
}

void show_line(std::string_view text) {
  if (!stderr_is_terminal() || !terminal_moves_cursor()) return;
  MessageState& all = message_state();
  const std::lock_guard lock{all.mutex};
  if (all.holding) return;
  constexpr std::size_t kUsual = 80;
  const std::size_t columns = terminal_columns(STDERR_FILENO);
  // In the last column the cursor may wrap.
  fmt::print(stderr, "\r\033[K{}", cut_to(text, (columns == 0 ? kUsual : columns) - 1));
  all.line_shown = true;
}

void clear_line() {
  MessageState& all = message_state();
  const std::lock_guard lock{all.mutex};
  erase_line(all);
}

HeldMessages::HeldMessages() {
  MessageState& all = message_state();
  const std::lock_guard lock{all.mutex};
  erase_line(all);
  all.holding = true;
}

HeldMessages::~HeldMessages() {
  MessageState& all = message_state();
  const std::lock_guard lock{all.mutex};
  all.holding = false;
  for (const Message& message : std::exchange(all.held, {})) put_message(message);
}

std::vector<std::string> HeldMessages::so_far() {
  MessageState& all = message_state();
  const std::lock_guard lock{all.mutex};
  std::vector<std::string> texts;
  texts.reserve(all.held.size());
  for (const Message& message : all.held) texts.push_back(message.text);
  return texts;
}

}  // namespace cargobay::cli
