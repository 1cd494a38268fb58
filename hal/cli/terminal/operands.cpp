#include "hal/cli/terminal/operands.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "hal/cli/terminal/print.hpp"

namespace cargobay::cli {
namespace {

// Prints the line in question, and a caret under the place.
void print_place(std::string_view text, const oi::TextError& error) {
  const std::size_t position = std::min(error.position, text.size());
  const std::size_t line_begin = position == 0 ? 0 : text.rfind('\n', position - 1) + 1;
  const std::string_view line = text.substr(line_begin, text.find('\n', line_begin) - line_begin);
  std::string printable{line};
  for (char& c : printable) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  const std::string carets(std::max<std::size_t>(error.length, 1), '^');
  fmt::print(stderr, "  {}\n  {:>{}}\n", printable, carets, position - line_begin + carets.size());
}

// Waits for standard input. False if nothing reads standard output any more.
bool input_comes() {
  for (;;) {
    std::array<pollfd, 2> waited{{{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0},
                                  {.fd = STDOUT_FILENO, .events = 0, .revents = 0}}};
    if (poll(waited.data(), waited.size(), -1) < 0 && errno != EINTR) return true;
    if ((waited[1].revents & (POLLERR | POLLHUP)) != 0) return false;
    if (waited[0].revents != 0) return true;
  }
}

// One run of digits: `89ff`, `0x9`, `137`.
bool read_run(std::string_view run, Base base, std::vector<std::uint8_t>& bytes) {
  if (base == Base::decimal) {
    int value = 0;
    const auto [stop, error] = std::from_chars(run.data(), run.data() + run.size(), value);
    if (error != std::errc{} || stop != run.data() + run.size() || value < -128 || value > 255)
      return false;
    bytes.push_back(static_cast<std::uint8_t>(value));
    return true;
  }
  if (run.starts_with("0x") || run.starts_with("0X") || run.starts_with("\\x"))
    run.remove_prefix(2);
  if (run.empty() || (run.size() > 1 && run.size() % 2 != 0)) return false;
  for (; !run.empty(); run.remove_prefix(std::min<std::size_t>(run.size(), 2))) {
    const std::string_view digits = run.substr(0, 2);
    std::uint8_t value = 0;
    const auto [stop, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), value, 16);
    if (error != std::errc{} || stop != digits.data() + digits.size()) return false;
    bytes.push_back(value);
  }
  return true;
}

hal::Failure no_byte(std::string_view run, Base base) {
  if (run == "*")
    return {"'*' is for lines that the dump leaves out; make it with all of them: od -v"};
  if (base == Base::decimal)
    return {fmt::format("'{}' is not a byte; in decimal bytes are numbers from 0 to 255", run)};
  const bool decimal =
      std::all_of(run.begin(), run.end(), [](char c) { return c >= '0' && c <= '9'; });
  return {fmt::format("'{}' is not a byte in hexadecimal; write two digits for each{}", run,
                      decimal ? ", or ask for decimal with --decimal" : ", such as 89 ff")};
}

}  // namespace

void take_operands(CLI::App& command, const std::string& name, const std::string& description) {
  // A positional option would leave -200 to the options, and lose its place among the words.
  command.allow_extras();
  command.description(fmt::format("{}\ncargobay {} [OPTIONS] {}\n  {}: {}",
                                  command.get_description(), command.get_name(), name, name,
                                  description));
}

hal::Result<std::string> joined_operands(const CLI::App& command) {
  const std::vector<std::string> words = command.remaining();
  if (!words.empty() && words != std::vector<std::string>{"-"})
    return fmt::format("{}", fmt::join(words, " "));
  if (words.empty() && isatty(STDIN_FILENO) == 1) {
    return hal::Failure{
        fmt::format("nothing to {0}; see: cargobay {0} --help", command.get_name())};
  }
  return read_all("-");
}

std::optional<std::vector<std::uint8_t>> encode_or_explain(std::string_view text,
                                                           oi::Beyond beyond) {
  std::vector<std::uint8_t> bytes(oi::most_bytes(text));
  const oi::TextResult result = oi::encode_text(text, bytes, beyond);
  if (result.error) {
    std::array<char, 512> message{};
    const std::size_t size = oi::format_error(*result.error, text, message);
    print_error({message.data(), size});
    print_place(text, *result.error);
    return std::nullopt;
  }
  if (result.bytes == 0) {
    print_error("there is no command in the text; write for example: drive_direct 100 100");
    return std::nullopt;
  }
  bytes.resize(result.bytes);
  return bytes;
}

hal::Result<std::vector<std::uint8_t>> read_bytes(std::string_view text, Base base) {
  constexpr std::string_view kBetween = " \t\r\n,;:[](){}\"'";
  std::vector<std::uint8_t> bytes;
  for (std::size_t begin = text.find_first_not_of(kBetween); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kBetween, begin), text.size());
    std::string_view run = text.substr(begin, end - begin);
    // \x89\xff is two bytes.
    const std::size_t next = run.find("\\x", 1);
    if (next != std::string_view::npos) run = run.substr(0, next);
    if (!read_run(run, base, bytes)) return no_byte(run, base);
    begin = text.find_first_not_of(kBetween, begin + run.size());
  }
  return bytes;
}

hal::Result<std::string> read_all(const std::string& path, const hal::InputLimits& limits) {
  const bool standard = path == "-";
  auto text =
      standard ? hal::read_standard_input(limits, input_comes) : hal::read_input(path, limits);
  if (text) return text;
  if (text.failure().code == std::errc::operation_canceled)
    return hal::Failure{"nothing reads standard output any more", text.failure().code};
  return hal::Failure{
      fmt::format("cannot read {}: {}", standard ? "standard input" : path, text.failure().message),
      text.failure().code};
}

}  // namespace cargobay::cli
