// What the codec costs, compared with the least that the same bytes could cost: the decoder with
// just summing them, the encoder with just copying them.

#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <vector>

#include <benchmark/benchmark.h>

#include "oi/command_parser.hpp"
#include "oi/encode.hpp"
#include "oi/sensors.hpp"
#include "oi/stream_decoder.hpp"

namespace {

using namespace cargobay::oi;  // NOLINT(google-build-using-namespace): the subject of this program

SensorValues random_values(std::mt19937& random) {
  SensorValues values;
  for (std::uint8_t id = kFirstSinglePacket; id <= kLastPacket; ++id) {
    values.set(PacketId{id}, static_cast<std::int32_t>(random() & 0xffffU));
  }
  return values;
}

// What a robot is really asked for, shortest first; 3 has 19s in half of its data; 4 is the window
// stream, in which every tenth frame has another list.
std::vector<PacketId> list(std::int64_t kind, std::size_t frame) {
  using enum PacketId;
  if (kind == 4 && frame % 10 != 0) return {oi_mode};
  if (kind == 0 || kind == 4) return {distance, angle, oi_mode};
  if (kind == 1)
    return {bumps_and_wheel_drops, distance, angle, voltage, current, oi_mode, buttons};
  return {group_6};
}

// About 64 KiB of good frames.
std::vector<std::uint8_t> stream(std::int64_t kind) {
  std::mt19937 random{1};
  std::vector<std::uint8_t> bytes;
  std::array<std::uint8_t, kMaxFrameBytes> frame{};
  for (std::size_t count = 0; bytes.size() < 65536; ++count) {
    const std::vector<PacketId> packets = list(kind, count);
    SensorValues values = random_values(random);
    if (kind == 3) {
      for (std::uint8_t id = kFirstSinglePacket; id <= kLastPacket; ++id) {
        if (random() % 2 == 0) values.set(PacketId{id}, 0x1313);
      }
    }
    const std::size_t size = encode_frame(packets, values, Checksum::including_header, frame);
    bytes.insert(bytes.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(size));
  }
  return bytes;
}

void count_bytes(benchmark::State& state, std::size_t bytes_a_round) {
  const auto bytes = static_cast<double>(state.iterations()) * static_cast<double>(bytes_a_round);
  state.counters["per_byte"] =
      benchmark::Counter(bytes, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void sum_bytes(benchmark::State& state) {
  const std::vector<std::uint8_t> bytes = stream(state.range(0));
  for ([[maybe_unused]] auto round : state) {
    std::uint8_t sum = 0;
    for (std::uint8_t byte : bytes) {
      asm volatile("" : "+r"(byte));  // as they come: one by one
      sum = static_cast<std::uint8_t>(sum + byte);
    }
    benchmark::DoNotOptimize(sum);
  }
  count_bytes(state, bytes.size());
}
BENCHMARK(sum_bytes)->ArgName("list")->DenseRange(0, 4);

void decode_stream(benchmark::State& state) {
  const std::vector<std::uint8_t> bytes = stream(state.range(0));
  StreamDecoder decoder;
  for ([[maybe_unused]] auto round : state) {
    for (const std::uint8_t byte : bytes) {
      auto outcome = decoder.push(byte);
      while (outcome != StreamDecoder::Outcome::nothing) {
        benchmark::DoNotOptimize(decoder.frame());
        outcome = decoder.next();
      }
    }
  }
  count_bytes(state, bytes.size());
}
BENCHMARK(decode_stream)->ArgName("list")->DenseRange(0, 4);

// Bytes to values.
void decode_stream_and_frames(benchmark::State& state) {
  const std::vector<std::uint8_t> bytes = stream(state.range(0));
  StreamDecoder decoder;
  SensorValues values;
  for ([[maybe_unused]] auto round : state) {
    for (const std::uint8_t byte : bytes) {
      auto outcome = decoder.push(byte);
      while (outcome != StreamDecoder::Outcome::nothing) {
        if (outcome == StreamDecoder::Outcome::frame) {
          benchmark::DoNotOptimize(decode_frame(decoder.frame(), values));
        }
        outcome = decoder.next();
      }
    }
  }
  count_bytes(state, bytes.size());
}
BENCHMARK(decode_stream_and_frames)->ArgName("list")->DenseRange(0, 4);

void decode_noise(benchmark::State& state) {
  std::mt19937 random{2};
  std::vector<std::uint8_t> bytes(65536);
  for (std::uint8_t& byte : bytes) {
    byte = static_cast<std::uint8_t>(random());
    if (state.range(0) != 0 && random() % 4 == 0) byte = kFrameHeader;
  }
  StreamDecoder decoder;
  for ([[maybe_unused]] auto round : state) {
    for (const std::uint8_t byte : bytes) {
      auto outcome = decoder.push(byte);
      while (outcome != StreamDecoder::Outcome::nothing) outcome = decoder.next();
    }
  }
  count_bytes(state, bytes.size());
}
BENCHMARK(decode_noise)->ArgName("with_19s")->Arg(0)->Arg(1);

// A frame with a wrong checksum, in which every third byte begins another with the same end, also
// with a wrong checksum.
void decode_worst_line(benchmark::State& state) {
  std::vector<std::uint8_t> frame{kFrameHeader, 255};
  for (std::size_t left = 252; frame.size() + 1 < kMaxFrameBytes; left -= 3) {
    frame.insert(frame.end(), {22, kFrameHeader, static_cast<std::uint8_t>(left)});
  }
  frame.push_back(0);
  StreamDecoder decoder{Checksum::including_header};
  for ([[maybe_unused]] auto round : state) {
    for (const std::uint8_t byte : frame) {
      auto outcome = decoder.push(byte);
      while (outcome != StreamDecoder::Outcome::nothing) outcome = decoder.next();
    }
  }
  state.counters["refused"] = static_cast<double>(decoder.counters().bad_checksum) /
                              static_cast<double>(state.iterations());
}
BENCHMARK(decode_worst_line);

void encode_drive_direct(benchmark::State& state) {
  std::int32_t speed = 0;
  for ([[maybe_unused]] auto round : state) {
    speed = (speed + 1) % 500;
    auto bytes = encode(DriveDirect{.left = MmPerSec{speed}, .right = MmPerSec{-speed}});
    benchmark::DoNotOptimize(bytes);
  }
}
BENCHMARK(encode_drive_direct);

void copy_drive_direct(benchmark::State& state) {
  std::array<std::uint8_t, 5> from{145, 0, 100, 255, 156};
  std::array<std::uint8_t, 5> to{};
  for ([[maybe_unused]] auto round : state) {
    benchmark::DoNotOptimize(from);
    std::memcpy(to.data(), from.data(), from.size());
    benchmark::DoNotOptimize(to);
  }
}
BENCHMARK(copy_drive_direct);

void parse_drive_direct(benchmark::State& state) {
  const std::array<std::uint8_t, 5> bytes{145, 0, 100, 255, 156};
  CommandParser parser;
  for ([[maybe_unused]] auto round : state) {
    for (std::uint8_t byte : bytes) {
      benchmark::DoNotOptimize(byte);
      benchmark::DoNotOptimize(parser.push(byte));
    }
  }
  count_bytes(state, bytes.size());
}
BENCHMARK(parse_drive_direct);

}  // namespace
