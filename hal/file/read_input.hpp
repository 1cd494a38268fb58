// Reads what a user names as input: configuration, world, profile, commands, recording.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "hal/result.hpp"

namespace cargobay::hal {

// The most that is read of each kind; docs/man/cargobay.inc tells users.
inline constexpr std::size_t kMostConfigBytes = std::size_t{1} << 20;     // a world too
inline constexpr std::size_t kMostTextBytes = std::size_t{64} << 20;      // everything else
inline constexpr std::size_t kMostRecordingBytes = std::size_t{1} << 30;  // over a day of driving

struct InputLimits {
  std::size_t most_bytes = kMostTextBytes;
  // If the input does not begin with this, reading stops, and what has been read is returned.
  std::string begins_with{};
};

// All of a regular file, or of a pipe that ends: a FIFO that something writes to, or what the shell
// puts in place of <(...). Of devices, only /dev/null, as an empty file. Anything else is a failure
// whose message says why and what to do, without `path`: "Is a directory; name a file". Blocks for
// the disk; for a pipe until its other end is closed, but for no more than 10 s without input. Any
// thread.
Result<std::string> read_input(const std::string& path, const InputLimits& limits);

// All of standard input, whatever it is, up to the limit. Blocks until its end, or until `comes`,
// which is called before each read and may wait for input, returns false: code operation_canceled.
Result<std::string> read_standard_input(const InputLimits& limits,
                                        const std::function<bool()>& comes);

}  // namespace cargobay::hal
