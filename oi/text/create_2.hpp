// What the Create 2 and the Roomba 500 and later have and this robot has not, by their published
// Open Interface: to name what bytes are that are not this robot's.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace cargobay::oi::create_2 {

struct Packet {
  std::uint8_t id = 0;
  std::uint8_t size = 0;
  std::string_view name;
};
// clang-format off
inline constexpr std::array<Packet, 20> kPackets{{
    {43, 2, "Left Encoder Counts"},          {44, 2, "Right Encoder Counts"},
    {45, 1, "Light Bumper"},                 {46, 2, "Light Bump Left Signal"},
    {47, 2, "Light Bump Front Left Signal"}, {48, 2, "Light Bump Center Left Signal"},
    {49, 2, "Light Bump Center Right Signal"}, {50, 2, "Light Bump Front Right Signal"},
    {51, 2, "Light Bump Right Signal"},      {52, 1, "Infrared Character Left"},
    {53, 1, "Infrared Character Right"},     {54, 2, "Left Motor Current"},
    {55, 2, "Right Motor Current"},          {56, 2, "Main Brush Motor Current"},
    {57, 2, "Side Brush Motor Current"},     {58, 1, "Stasis"},
    {100, 80, "Group 100"},                  {101, 28, "Group 101"},
    {106, 12, "Group 106"},                  {107, 9, "Group 107"},
}};
// clang-format on

struct Opcode {
  std::uint8_t opcode = 0;
  std::string_view name;
};
inline constexpr std::array<Opcode, 10> kOpcodes{{{7, "Reset"},
                                                  {133, "Power"},
                                                  {146, "Drive PWM"},
                                                  {162, "Scheduling LEDs"},
                                                  {163, "Digit LEDs Raw"},
                                                  {164, "Digit LEDs ASCII"},
                                                  {165, "Buttons"},
                                                  {167, "Schedule"},
                                                  {168, "Set Day/Time"},
                                                  {173, "Stop"}}};
// The one of them that turns wheels.
inline constexpr std::uint8_t kDrivePwm = 146;

// Null if that robot has no such packet, or this one has it too.
constexpr const Packet* find_packet(std::uint8_t id) {
  for (const Packet& packet : kPackets) {
    if (packet.id == id) return &packet;
  }
  return nullptr;
}
// Empty if that robot has no such opcode, or this one has it too.
constexpr std::string_view opcode_name(std::uint8_t opcode) {
  for (const Opcode& entry : kOpcodes) {
    if (entry.opcode == opcode) return entry.name;
  }
  return {};
}

}  // namespace cargobay::oi::create_2
