// One value of a record, and how it is written as JSON and as CSV: the same digits in both.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace cargobay::hal {

// std::monostate: not known. A number that is not finite is not known either.
using Value = std::variant<std::monostate, bool, std::int64_t, double, std::string,
                           std::vector<std::string_view>>;

bool known(const Value& value);

// Numbers in as few digits as give the same number when read; 200.0 is one that need not be whole.
// Text that is not UTF-8 has U+FFFD in place of what is wrong. What is not known is `null`.
void append_json(std::string& out, const Value& value);
// A string as JSON, with its quotes.
void append_json_text(std::string& out, std::string_view text);
// A cell: empty if the value is not known; truth is 1 or 0; several words have ; between them, and
// none of them is the word `none`. In quotes if it has to be (RFC 4180).
void append_csv(std::string& out, const Value& value);

// Writes one JSON object, member by member. A path `a.b` is member `b` of the object `a`; those of
// one object come one after the other.
class ObjectWriter {
 public:
  // Appends to `out`, which outlives it.
  explicit ObjectWriter(std::string& out) : out_{out} { out_ += '{'; }
  // Leaves out what is not known.
  void put(std::string_view path, const Value& value);
  // The last call.
  void close();

 private:
  std::string& out_;
  std::string_view group_{};
  bool after_member_ = false;
};

}  // namespace cargobay::hal
