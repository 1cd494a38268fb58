// A robot that takes no time: it is in memory, moves as commanded without lag, and has a frame
// ready for each wait.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "hal/jitter/sample_frames.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/command_table.hpp"
#include "oi/limits.hpp"
#include "rt/axis_filter.hpp"

namespace cargobay::test {

// A frame every 15 ms, of the list that was requested last; ends by hanging up. Understands a Drive
// Direct, straight ahead, and a list after it.
class MemoryStream final : public hal::ByteStream {
 public:
  explicit MemoryStream(long frames, rt::Remainder remainder = rt::Remainder::carried)
      : frames_left_{frames}, remainder_{remainder} {}

  Wait wait(rt::TimePoint /*deadline*/) CARGOBAY_NONBLOCKING override {
    now_ += oi::kTick;
    unread_um_ += speed_mm_s_ * kTickMs;
    return --frames_left_ < 0 ? Wait::hung_up : Wait::ready;
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    hal::jitter::FrameBytes& frame = frames_[list_];
    if (list_ == kReading) count_distance(frame);
    std::memcpy(bytes.data(), frame.data(), frame.size());
    return {.count = frame.size()};
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    speed_mm_s_ = static_cast<std::int16_t>(bytes[1] << 8U | bytes[2]);
    // A list follows the Drive Direct; its second packet shows which it is.
    if (bytes.size() > kSecondPacket) list_ = list_with(bytes[kSecondPacket]);
    return {.count = bytes.size()};
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override { return now_; }
  std::uint32_t baud() const override { return 57600; }
  std::error_code set_baud(std::uint32_t /*baud*/) override { return {}; }
  std::error_code set_wake_threshold(std::size_t /*bytes*/) override { return {}; }
  void discard_input() override {}
  bool drain(rt::Duration /*timeout*/) override { return true; }
  void sleep(rt::Duration /*duration*/) override {}

 private:
  static constexpr int kTickMs = 15;
  static constexpr int kUmPerMm = 1000;
  static constexpr std::size_t kSecondPacket = oi::kDriveDirectBytes + 3;
  static constexpr std::size_t kReading = 0;

  static std::size_t list_with(std::uint8_t second_packet) CARGOBAY_NONBLOCKING {
    if (second_packet == static_cast<std::uint8_t>(oi::PacketId::group_2)) return kReading;
    return second_packet == static_cast<std::uint8_t>(oi::PacketId::group_1) ? 1 : 2;
  }

  // Header, length, mode, group 2: infrared byte, buttons, then the distance.
  void count_distance(hal::jitter::FrameBytes& frame) CARGOBAY_NONBLOCKING {
    constexpr std::size_t kDistance = 7;
    const int mm = unread_um_ / kUmPerMm;
    unread_um_ = remainder_ == rt::Remainder::carried ? unread_um_ % kUmPerMm : 0;
    const int before = frame[kDistance] + frame[kDistance + 1];
    frame[kDistance] = static_cast<std::uint8_t>(static_cast<unsigned>(mm) >> 8U);
    frame[kDistance + 1] = static_cast<std::uint8_t>(mm);
    const int change = frame[kDistance] + frame[kDistance + 1] - before;
    frame.back() = static_cast<std::uint8_t>(frame.back() - change);
  }

  long frames_left_;
  rt::Remainder remainder_;
  rt::TimePoint now_{};
  std::size_t list_ = kReading;
  int speed_mm_s_ = 0;
  int unread_um_ = 0;
  std::array<hal::jitter::FrameBytes, 3> frames_{
      hal::jitter::sample_frame(hal::FrameList::reading),
      hal::jitter::sample_frame(hal::FrameList::hazards),
      hal::jitter::sample_frame(hal::FrameList::battery)};
};

}  // namespace cargobay::test
