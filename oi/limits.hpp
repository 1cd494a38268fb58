// Numbers in the manual that concern more than one command or packet.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

namespace cargobay::oi {

// The robot updates its sensors, and sends a stream frame, this often (OI p. 13).
inline constexpr std::chrono::nanoseconds kTick = std::chrono::milliseconds{15};

inline constexpr std::int32_t kMaxWheelSpeed = 500;  // mm/s, either way (OI p. 9)
inline constexpr std::int32_t kMaxRadius = 2000;     // mm, either way (OI p. 9)

inline constexpr std::size_t kMaxScriptBytes = 100;   // OI p. 15: bytes, not commands
inline constexpr std::size_t kMaxSongNotes = 16;      // OI p. 11
inline constexpr std::size_t kSongSlots = 16;         // OI p. 11
inline constexpr std::size_t kMaxStreamPackets = 43;  // OI p. 14
inline constexpr std::size_t kMaxQueryPackets = 255;  // OI p. 13
inline constexpr std::size_t kMaxCommandBytes = 2 + kMaxQueryPackets;

inline constexpr std::uint8_t kFrameHeader = 19;  // OI p. 14
inline constexpr std::size_t kMaxFrameBytes = 2 + 255 + 1;

inline constexpr std::chrono::milliseconds kBaudChangeWait{100};  // OI p. 7

// From the start of one byte sent to the robot to the start of the next, at its fastest rate; a
// byte that comes sooner is lost (OI p. 7).
inline constexpr std::chrono::microseconds kByteSpacingAt115200{200};
constexpr bool needs_spacing(std::uint32_t baud) { return baud >= 115200; }

}  // namespace cargobay::oi
