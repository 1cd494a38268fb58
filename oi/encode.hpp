// Commands to bytes, by the command table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>

#include "oi/command_table.hpp"
#include "oi/commands.hpp"
#include "oi/fixed_list.hpp"

namespace cargobay::oi {

namespace detail {

constexpr std::int32_t to_number(std::uint8_t value) { return value; }
template <typename Enum>
  requires std::is_enum_v<Enum>
constexpr std::int32_t to_number(Enum value) {
  return static_cast<std::int32_t>(value);
}
template <typename UnitTag>
constexpr std::int32_t to_number(Quantity<UnitTag> value) {
  return value.value;
}
template <typename Flag>
constexpr std::int32_t to_number(BitSet<Flag> value) {
  return value.raw();
}

template <typename Member>
inline constexpr bool is_list = false;
template <typename Element, std::size_t kCapacity>
inline constexpr bool is_list<FixedList<Element, kCapacity>> = true;

template <CommandStruct C, typename Pointer>
using MemberType = std::remove_cvref_t<decltype(std::declval<C>().*std::declval<Pointer>())>;

// Most bytes one member can take.
template <typename Member>
constexpr std::size_t most_bytes(const ArgumentInfo& argument, Tail tail) {
  if constexpr (is_list<Member>) return 1 + Member::capacity() * element_size(tail);
  return argument.size;
}

// Most bytes the command can take.
template <CommandStruct C>
constexpr std::size_t most_bytes() {
  return std::apply(
      [](auto... pointers) {
        [[maybe_unused]] const CommandInfo& info = kCommandInfo<C::kOpcode>;
        std::size_t sum = 1;
        [[maybe_unused]] std::size_t index = 0;
        ((sum +=
          most_bytes<MemberType<C, decltype(pointers)>>(info.argument_slots[index++], info.tail)),
         ...);
        return sum;
      },
      C::kWire);
}

// Appends the number, high byte first; false if the table does not accept it. The list has room by
// construction: it is as long as the longest form of the command.
template <typename Bytes>
constexpr bool put_number(Bytes& bytes, const ArgumentInfo& argument, std::int32_t value) {
  if (!argument.accepts(value)) return false;
  const auto raw = static_cast<std::uint32_t>(value);
  if (argument.size == 2 && !bytes.push_back(static_cast<std::uint8_t>(raw >> 8U))) return false;
  return bytes.push_back(static_cast<std::uint8_t>(raw));
}

template <typename Bytes>
constexpr bool put_element(Bytes& bytes, Tail tail, PacketId id) {
  return put_number(bytes, element_arguments(tail)[0], to_number(id));
}
template <typename Bytes>
constexpr bool put_element(Bytes& bytes, Tail tail, const Note& note) {
  return put_number(bytes, element_arguments(tail)[0], note.number) &&
         put_number(bytes, element_arguments(tail)[1], to_number(note.duration));
}
template <typename Bytes>
constexpr bool put_element(Bytes& bytes, Tail tail, std::uint8_t byte) {
  return put_number(bytes, element_arguments(tail)[0], byte);
}

template <typename Bytes, typename Member>
constexpr bool put_member(Bytes& bytes, Tail tail, const ArgumentInfo& argument,
                          const Member& member) {
  if constexpr (is_list<Member>) {
    if (!put_number(bytes, argument, static_cast<std::int32_t>(member.size()))) return false;
    for (const auto& element : member) {
      if (!put_element(bytes, tail, element)) return false;
    }
    return true;
  } else {
    return put_number(bytes, argument, to_number(member));
  }
}

}  // namespace detail

// Room for any form of this command, and no more.
template <CommandStruct C>
using EncodedCommand = FixedList<std::uint8_t, detail::most_bytes<C>()>;

// The command's bytes; nothing if a value is outside the manual's range: values are refused, never
// clamped.
template <CommandStruct C>
constexpr std::optional<EncodedCommand<C>> encode(const C& command) {
  static_assert(std::tuple_size_v<std::remove_const_t<decltype(C::kWire)>> ==
                    kCommandInfo<C::kOpcode>.argument_count,
                "kWire names a member for each argument of the table");
  EncodedCommand<C> bytes;
  if (!bytes.push_back(C::kOpcode)) return std::nullopt;
  const bool accepted = std::apply(
      [&](auto... pointers) {
        [[maybe_unused]] std::size_t index = 0;
        return (detail::put_member(bytes, kCommandInfo<C::kOpcode>.tail,
                                   kCommandInfo<C::kOpcode>.argument_slots[index++],
                                   command.*pointers) &&
                ...);
      },
      C::kWire);
  if (!accepted) return std::nullopt;
  return bytes;
}

}  // namespace cargobay::oi
