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
    if (list_ == kReading) count_distance(frame, 7);
    if (list_ == kDistance || list_ == kDistanceButtons) count_distance(frame, 5);
    std::memcpy(bytes.data(), frame.data(), frame.size());
    return {.count = frame.size()};
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    speed_mm_s_ = static_cast<std::int16_t>(bytes[1] << 8U | bytes[2]);
    // A list follows the Drive Direct; its packets show which it is.
    if (bytes.size() > kFirstPacket) list_ = list_of(bytes.subspan(kFirstPacket));
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
  static constexpr std::size_t kFirstPacket = oi::kDriveDirectBytes + 2;
  static constexpr auto kReading = static_cast<std::size_t>(oi::FrameList::reading);
  static constexpr auto kDistance = static_cast<std::size_t>(oi::FrameList::distance);
  static constexpr auto kDistanceButtons =
      static_cast<std::size_t>(oi::FrameList::distance_buttons);

  static std::size_t list_of(std::span<const std::uint8_t> ids) CARGOBAY_NONBLOCKING {
    for (std::size_t i = 0; i < oi::kFrameLists; ++i) {
      const oi::StreamList& list = oi::kCreate.frame_lists[i];
      bool same = ids.size() >= list.size();
      for (std::size_t packet = 0; same && packet < list.size(); ++packet)
        same = ids[packet] == static_cast<std::uint8_t>(list[packet]);
      if (same) return i;
    }
    return kReading;
  }

  // Header, length, mode, then the distance, or group 2: infrared byte, buttons, distance.
  void count_distance(hal::jitter::FrameBytes& frame, std::size_t at) CARGOBAY_NONBLOCKING {
    const int mm = unread_um_ / kUmPerMm;
    unread_um_ = remainder_ == rt::Remainder::carried ? unread_um_ % kUmPerMm : 0;
    const int before = frame[at] + frame[at + 1];
    frame[at] = static_cast<std::uint8_t>(static_cast<unsigned>(mm) >> 8U);
    frame[at + 1] = static_cast<std::uint8_t>(mm);
    const int change = frame[at] + frame[at + 1] - before;
    frame.back() = static_cast<std::uint8_t>(frame.back() - change);
  }

  long frames_left_;
  rt::Remainder remainder_;
  rt::TimePoint now_{};
  std::size_t list_ = kReading;
  int speed_mm_s_ = 0;
  int unread_um_ = 0;
  std::array<hal::jitter::FrameBytes, oi::kFrameLists> frames_ = hal::jitter::sample_frames();
};

}  // namespace cargobay::test
