// Reads sensors without driving: frame by frame, or once by query. For tools; the control cycle has
// its own way.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/commands.hpp"
#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"

namespace cargobay::hal {

// Asks for the packets once (Query List) and waits for the answer, at most 1.5 s. A stream in
// progress is paused for it and resumed. A robot that is off is started; otherwise its mode does
// not change. The failure is Trouble::silent if nothing answers, or what is sent comes back.
Result<oi::SensorValues> query_sensors(ByteStream& stream, std::span<const oi::PacketId> packets);

// One frame of a SensorStream. The robot's distance and angle are those since it was last asked;
// the sums are of all frames since open(), those of damaged frames missing, and 0 if the packets do
// not contain them.
struct SensorFrame {
  oi::SensorValues values{};
  rt::TimePoint arrival{};  // on the stream's clock
  std::int64_t distance_mm = 0;
  std::int64_t angle_deg = 0;
};

// Not thread-safe. A frame that comes in time costs one sleep and one read.
class SensorStream {
 public:
  // Makes the robot stream these packets; starts it if it is off. If their frames do not fit 15 ms
  // at this baud rate, or the robot answers but does not stream, each frame is asked for instead,
  // one after the other. `stream` must outlive the object. Allocates. Blocks for up to 1 s, 2.5 s
  // if the robot does not stream.
  static Result<std::unique_ptr<SensorStream>> open(ByteStream& stream,
                                                    std::span<const oi::PacketId> packets);
  // Pauses the stream and waits until the robot is silent: 40 ms, up to 0.5 s if it never is.
  ~SensorStream();
  SensorStream(const SensorStream&) = delete;
  SensorStream& operator=(const SensorStream&) = delete;

  // The next frame. Blocks until it arrives; fails after 500 ms without one. Allocates only then.
  Result<SensorFrame> next();
  // Why the frames are asked for; empty if they are streamed.
  const std::string& why_asked() const { return why_asked_; }

 private:
  explicit SensorStream(ByteStream& stream) : stream_{stream} {}
  bool begin(const oi::Stream& list);
  Result<void> begin_asking(std::span<const oi::PacketId> packets);
  Result<oi::SensorValues> next_streamed();
  Result<oi::SensorValues> next_asked();
  void read();
  bool take_frame(oi::SensorValues& values);
  std::size_t open_bytes() const;
  void wake_at(std::size_t bytes);

  ByteStream& stream_;
  oi::StreamDecoder decoder_{};
  std::array<std::uint8_t, 512> read_{};  // [begin_, end_) has been read and not decoded
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::size_t frame_bytes_ = 1;
  oi::QueryList query_{};
  std::size_t reply_bytes_ = 0;
  rt::TimePoint due_{};  // the next frame should be there
  rt::TimePoint asked_at_{};
  std::string why_asked_{};
  SensorFrame sums_{};
};

}  // namespace cargobay::hal
