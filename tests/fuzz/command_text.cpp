// Any text at all: refused with a message that stays in its buffer, or bytes whose commands,
// written as text, make the same bytes again.

#include "oi/text/command_text.hpp"

#include <array>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "oi/parse.hpp"
#include "oi/text/describe.hpp"

namespace {

namespace oi = cargobay::oi;

void require(bool holds) {
  if (!holds) std::abort();
}

void check_command(std::span<const std::uint8_t> command) {
  static std::array<char, oi::kMaxCommandText> text;
  const std::size_t size = oi::format_command(command, text);
  require(size != 0);
  std::array<std::uint8_t, oi::kMaxCommandBytes> again{};
  const oi::TextResult result = oi::encode_text({text.data(), size}, again);
  require(!result.error && result.bytes == command.size());
  require(std::equal(command.begin(), command.end(), again.begin()));
}

void check_text_beyond(std::string_view text) {
  std::vector<std::uint8_t> bytes(oi::most_bytes(text));
  const oi::TextResult result = oi::encode_text(text, bytes, oi::Beyond::manual);
  require(!result.error || result.error->code != oi::TextError::Code::output_full);
}

void check_text(std::string_view text) {
  std::vector<std::uint8_t> bytes(oi::most_bytes(text));
  const oi::TextResult result = oi::encode_text(text, bytes);
  if (result.error) {
    require(result.error->code != oi::TextError::Code::output_full);
    require(result.error->position + result.error->length <= text.size());
    std::array<char, 400> message{};
    require(oi::format_error(*result.error, text, message) < message.size());
    return;
  }
  std::span<const std::uint8_t> rest{bytes.data(), result.bytes};
  while (!rest.empty()) {
    const oi::ParseResult parsed = oi::parse_command(rest);
    require(parsed.outcome == oi::ParseResult::Outcome::command);
    check_command(rest.first(parsed.length));
    rest = rest.subspan(parsed.length);
  }
}

// The same bytes as they might be on the wire: every byte is described once.
void check_description(std::span<const std::uint8_t> bytes) {
  std::size_t told = 0;
  const auto tell = [&told](const oi::Annotation& annotation) {
    if (annotation.kind != oi::Annotation::Kind::command) told += annotation.bytes.size();
  };
  (void)oi::describe_commands(bytes, tell);
  require(told == bytes.size());
  (void)oi::describe_stream(bytes, tell);
  require(told == 2 * bytes.size());
  (void)oi::describe_commands(bytes, tell, oi::kCreateWithExtensions);
  (void)oi::describe_stream(bytes, tell, oi::kCreateWithExtensions);
  require(told == 4 * bytes.size());
  const oi::ParseResult parsed = oi::parse_command(bytes);
  if (parsed.outcome == oi::ParseResult::Outcome::command)
    check_command(bytes.first(parsed.length));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  check_text({reinterpret_cast<const char*>(data), size});
  check_text_beyond({reinterpret_cast<const char*>(data), size});
  check_description({data, size});
  return 0;
}
