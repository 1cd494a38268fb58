// A robot that takes no time: its frames are in memory, one for each wait.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <span>

#include "hal/byte_stream.hpp"
#include "hal/jitter/sample_frames.hpp"
#include "oi/limits.hpp"

namespace cargobay::test {

// A frame each 15 ms, of the list that was asked for last; ends by hanging up.
class MemoryStream final : public hal::ByteStream {
 public:
  explicit MemoryStream(long frames) : frames_left_{frames} {}

  Wait wait(rt::TimePoint /*deadline*/) noexcept CARGOBAY_NONBLOCKING override {
    now_ += oi::kTick;
    return --frames_left_ < 0 ? Wait::hung_up : Wait::ready;
  }
  Transfer read(std::span<std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override {
    const hal::jitter::FrameBytes& frame = frames_[list_];
    std::memcpy(bytes.data(), frame.data(), frame.size());
    return {.count = frame.size()};
  }
  // A list stands behind the Drive Direct; its second packet tells which it is.
  Transfer write(std::span<const std::uint8_t> bytes) noexcept CARGOBAY_NONBLOCKING override {
    if (bytes.size() > 8) list_ = bytes[8] == 2 ? 0 : bytes[8] == 1 ? 1 : 2;
    return {.count = bytes.size()};
  }
  rt::TimePoint now() const noexcept CARGOBAY_NONBLOCKING override { return now_; }
  std::uint32_t baud() const override { return 57600; }
  std::error_code set_baud(std::uint32_t /*baud*/) override { return {}; }
  std::error_code set_wake_threshold(std::size_t /*bytes*/) override { return {}; }
  void discard_input() override {}
  bool drain(rt::Duration /*timeout*/) override { return true; }

 private:
  long frames_left_;
  rt::TimePoint now_{};
  std::size_t list_ = 0;
  std::array<hal::jitter::FrameBytes, 3> frames_{
      hal::jitter::sample_frame(hal::FrameList::reading),
      hal::jitter::sample_frame(hal::FrameList::hazards),
      hal::jitter::sample_frame(hal::FrameList::battery)};
};

}  // namespace cargobay::test
