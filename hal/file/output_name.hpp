// What is at the path where a user wants output, and whether it may be written: the rule stated in
// hal/file/output_file.hpp.
#pragma once

#include <cstdint>
#include <string>

namespace cargobay::hal {

struct OutputName {
  enum class Kind : std::uint8_t {
    refused,     // by the rule
    failed,      // by the system
    descriptor,  // of this process
    in_place,    // a FIFO or a device that takes everything
    present,     // a file that may be replaced
    absent,      // nothing
  };
  Kind kind = Kind::failed;
  std::string path{};     // where its links lead
  int descriptor = -1;    // for Kind::descriptor
  int error = 0;          // for Kind::failed, errno
  std::string refusal{};  // for Kind::refused: why, and what to do
};

OutputName find_output(const std::string& path);

}  // namespace cargobay::hal
