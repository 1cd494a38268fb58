// Reads sensors without driving: by stream, or once by query. For tools; the control cycle has its
// own way.
#pragma once

#include <memory>
#include <span>

#include "hal/result.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/packet_table.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"

namespace cargobay::hal {

// Asks for the packets once (Query List) and waits for the answer, at most 1.5 s. A stream in
// progress is paused for it and resumed. A robot that is off is started; otherwise its mode does
// not change.
Result<oi::SensorValues> query_sensors(ByteStream& stream, std::span<const oi::PacketId> packets);

class SensorStream {
 public:
  // Makes the robot stream these packets; starts it if it is off. `stream` must outlive the object.
  // Blocks for up to 1 s.
  static Result<std::unique_ptr<SensorStream>> open(ByteStream& stream,
                                                    std::span<const oi::PacketId> packets);
  // Pauses the stream and waits until the robot is silent: 40 ms, up to 0.5 s if it never is.
  ~SensorStream();
  SensorStream(const SensorStream&) = delete;
  SensorStream& operator=(const SensorStream&) = delete;

  // The next frame's values. Blocks until it arrives; fails after 500 ms without one.
  Result<oi::SensorValues> next();

 private:
  explicit SensorStream(ByteStream& stream) : stream_{stream} {}

  ByteStream& stream_;
  oi::StreamDecoder decoder_{};
};

}  // namespace cargobay::hal
