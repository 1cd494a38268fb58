// Any input as the text of a script, and as the bytes of one: what compiles is disassembled to the
// same bytes, every body of bytes is the same after disassembly, and its text is canonical.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>

#include "oi/text/script_text.hpp"

namespace {

using cargobay::oi::compile;
using cargobay::oi::disassemble;
using cargobay::oi::Script;
using cargobay::oi::ScriptText;

void require(bool holds) {
  if (!holds) std::abort();
}

void check_bytes(const Script& script) {
  const ScriptText text = disassemble(script);
  Script compiled;
  require(!compile({text.data(), text.size()}, compiled));
  require(compiled == script);
  require(disassemble(compiled) == text);
}

void check_text(std::string_view text) {
  Script script;
  const auto error = compile(text, script);
  if (!error) return check_bytes(script);
  require(script.body.empty());
  require(error->line >= 1 && error->column >= 1 && error->column <= text.size() + 1);
  std::array<char, 400> line{};
  const std::size_t size = format_error(*error, text, line);
  require(size > 0 && size < line.size());
  require(std::find(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(size), '\n') ==
          line.begin() + static_cast<std::ptrdiff_t>(size));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes{data, size};
  Script script;
  require(script.body.append(bytes.first(std::min(size, cargobay::oi::kMaxScriptBytes))));
  check_bytes(script);
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-reinterpret-cast): bytes as characters
  check_text({reinterpret_cast<const char*>(data), size});
  return 0;
}
