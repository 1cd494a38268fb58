// Bytes to commands, by the command table: the inverse of oi/encode.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

#include "oi/command.hpp"
#include "oi/command_table.hpp"
#include "oi/commands.hpp"
#include "oi/dialect.hpp"
#include "oi/encode.hpp"
#include "oi/fixed_list.hpp"

namespace cargobay::oi {

// The number in a command that is outside the manual's range.
struct RangeError {
  const ArgumentInfo* argument = nullptr;  // in the command table
  std::size_t offset = 0;                  // of its first byte; the opcode is at 0
  std::int32_t value = 0;
};

namespace detail {

template <typename Member>
constexpr Member from_number(std::int32_t number) {
  if constexpr (std::is_enum_v<Member> || std::is_same_v<Member, std::uint8_t>) {
    return static_cast<Member>(number);
  } else if constexpr (requires { Member{}.raw(); }) {
    return Member{static_cast<std::uint8_t>(number)};
  } else {
    return Member{number};
  }
}

// The bytes of one command, read from the front; stops at the first number out of range.
class Reader {
 public:
  constexpr explicit Reader(std::span<const std::uint8_t> bytes) : bytes_{bytes} {}

  constexpr const std::optional<RangeError>& error() const { return error_; }
  constexpr bool at_end() const { return offset_ == bytes_.size(); }

  // False if the bytes end or the table does not accept the number.
  constexpr bool number(const ArgumentInfo& argument, std::int32_t& value) {
    if (bytes_.size() - offset_ < argument.size) return false;
    value = number_at(bytes_.subspan(offset_), argument);
    if (!argument.accepts(value)) {
      error_ = RangeError{&argument, offset_, value};
      return false;
    }
    offset_ += argument.size;
    return true;
  }

  constexpr bool element(Tail tail, PacketId& id) {
    std::int32_t value = 0;
    if (!number(element_arguments(tail)[0], value)) return false;
    id = static_cast<PacketId>(value);
    return true;
  }
  constexpr bool element(Tail tail, Note& note) {
    std::int32_t key = 0;
    std::int32_t duration = 0;
    if (!number(element_arguments(tail)[0], key)) return false;
    if (!number(element_arguments(tail)[1], duration)) return false;
    note = Note{static_cast<std::uint8_t>(key), SixtyFourths{duration}};
    return true;
  }
  constexpr bool element(Tail tail, std::uint8_t& byte) {
    std::int32_t value = 0;
    if (!number(element_arguments(tail)[0], value)) return false;
    byte = static_cast<std::uint8_t>(value);
    return true;
  }

  template <typename Member>
  constexpr bool member(Tail tail, const ArgumentInfo& argument, Member& out) {
    std::int32_t value = 0;
    if (!number(argument, value)) return false;
    if constexpr (is_list<Member>) {
      for (std::int32_t i = 0; i < value; ++i) {
        typename Member::value_type read{};
        if (!element(tail, read) || !out.push_back(read)) return false;
      }
    } else {
      out = from_number<Member>(value);
    }
    return true;
  }

 private:
  std::span<const std::uint8_t> bytes_;
  std::size_t offset_ = 1;
  std::optional<RangeError> error_;
};

template <CommandStruct C>
constexpr std::optional<C> read(Reader& reader) {
  C command{};
  const bool whole = std::apply(
      [&](auto... pointers) {
        [[maybe_unused]] std::size_t index = 0;
        return (reader.member(kCommandInfo<C::kOpcode>.tail,
                              kCommandInfo<C::kOpcode>.argument_slots[index++],
                              command.*pointers) &&
                ...);
      },
      C::kWire);
  if (!whole || !reader.at_end()) return std::nullopt;
  return command;
}

}  // namespace detail

// The command in these bytes, opcode included; nothing unless they are exactly one such command
// with every number in its range.
template <CommandStruct C>
constexpr std::optional<C> parse(std::span<const std::uint8_t> bytes) {
  if (bytes.empty() || bytes[0] != C::kOpcode) return std::nullopt;
  detail::Reader reader{bytes};
  return detail::read<C>(reader);
}

struct ParseResult {
  enum class Outcome : std::uint8_t { command, incomplete, unknown_opcode, out_of_range };
  Outcome outcome = Outcome::incomplete;
  Command command{};                  // Outcome::command
  const CommandInfo* info = nullptr;  // the opcode's entry, if there is one
  std::size_t length = 0;             // bytes of the whole command; 0 while incomplete
  std::size_t needed = 0;             // Outcome::incomplete: at least this many more bytes
  RangeError error{};                 // Outcome::out_of_range
};

// Reads the first command of the bytes, never past its end; what follows it is left alone. (Not
// constexpr: clang cannot assign a variant of libstdc++ 12 at compile time.)
ParseResult parse_command(std::span<const std::uint8_t> bytes, const Dialect& dialect = kCreate);

}  // namespace cargobay::oi
