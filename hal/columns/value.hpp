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
// A cell: empty if the value is not known; truth is 1 or 0; several words have ; between them, and
// none of them is the word `none`. In quotes if it has to be (RFC 4180).
void append_csv(std::string& out, const Value& value);

// Writes members of a JSON object that is open in `out`, which outlives it: a comma before each but
// one after the `{`. A path `a.b` is member `b` of the object `a`; those of one object come one
// after the other.
class MemberWriter {
 public:
  explicit MemberWriter(std::string& out) : out_{out} {}
  // Leaves out what is not known. The path outlives the next call.
  void put(std::string_view path, const Value& value);
  // The last call: the object itself stays open.
  void end();

 private:
  void key(std::string_view name);

  std::string& out_;
  std::string_view group_{};
};

}  // namespace cargobay::hal
