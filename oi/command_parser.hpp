// Bytes to whole commands, one byte at a time: the robot's side of the line.
//
// It divides the bytes exactly as the robot does and judges no value: a Song of 255 notes is
// swallowed whole before anything refuses it (oi/parse.hpp does). A half-sent command therefore
// takes what follows as its data. Every sequence of bytes is safe; 520 bytes of state, no heap.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

#include "oi/command_table.hpp"
#include "oi/dialect.hpp"

namespace cargobay::oi {

class CommandParser {
 public:
  enum class Outcome : std::uint8_t { incomplete, command, unknown_opcode };

  // Longest sequence that is one command to the parser.
  static constexpr std::size_t kMostBytes = 1 + kLongestRest;

  constexpr explicit CommandParser(const Dialect& dialect = kCreate) : dialect_{&dialect} {}

  constexpr Outcome push(std::uint8_t byte) noexcept {
    if (length_ == expected_) return begin(byte);
    bytes_[length_++] = byte;
    if (length_ < expected_) return Outcome::incomplete;
    expected_ = length_of_command();
    return length_ < expected_ ? Outcome::incomplete : Outcome::command;
  }

  // The entry of the command that is complete or in progress. Must not be called after reset() or
  // an unknown opcode.
  constexpr const CommandInfo& info() const {
    assert(info_ != nullptr);
    return *info_;
  }
  // After `command` the whole command with its opcode, after `unknown_opcode` that byte, otherwise
  // what has arrived of the command in progress. Valid until the next push.
  constexpr std::span<const std::uint8_t> bytes() const { return {bytes_.data(), length_}; }
  // At least this many more bytes complete the command in progress; 0 between commands.
  constexpr std::size_t needed() const { return expected_ - length_; }

  // Forgets a command in progress.
  constexpr void reset() noexcept {
    info_ = nullptr;
    length_ = 0;
    expected_ = 0;
  }

 private:
  constexpr Outcome begin(std::uint8_t opcode) noexcept {
    info_ = dialect_->find_command(opcode);
    bytes_[0] = opcode;
    length_ = 1;
    if (info_ == nullptr) {
      expected_ = 1;
      return Outcome::unknown_opcode;
    }
    expected_ = length_of_command();
    return expected_ == 1 ? Outcome::command : Outcome::incomplete;
  }

  // As far as the bytes tell: up to the length byte until that has arrived.
  constexpr std::size_t length_of_command() const {
    const std::size_t length = command_length(*info_, bytes());
    return length != 0 ? length : 1 + info_->argument_bytes();
  }

  const Dialect* dialect_;
  const CommandInfo* info_ = nullptr;
  std::size_t length_ = 0;
  std::size_t expected_ = 0;  // == length_ between commands
  std::array<std::uint8_t, kMostBytes> bytes_{};
};

}  // namespace cargobay::oi
