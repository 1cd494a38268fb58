// The device that the conformance suite asks: the virtual Create in virtual time, or any device at
// the other end of a port. The tests know nothing but its bytes.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/baud.hpp"

namespace cargobay::conformance {

using Bytes = std::vector<std::uint8_t>;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

// Opened by main(); null: the virtual Create.
extern std::unique_ptr<hal::ByteStream> port;
// The rate it listens at when a test begins.
extern std::uint32_t boot_baud;

class Conformance : public testing::Test {
 protected:
  // Passive, with no stream, song, script or wheel going, whatever it was before.
  void SetUp() override;
  // Leaves it Passive and silent.
  void TearDown() override;

  hal::ByteStream& stream() { return port ? *port : *link_; }
  void send(const Bytes& bytes);
  // `count` bytes, or what came within `patience`.
  Bytes receive(std::size_t count, rt::Duration patience = 2s);
  // Everything that comes within that time.
  Bytes listen(rt::Duration period);
  // Sends, and returns the answer of that length.
  Bytes ask(const Bytes& command, std::size_t count) {
    send(command);
    return receive(count);
  }
  std::uint8_t packet(std::uint8_t id);
  std::int16_t word_packet(std::uint8_t id);
  std::uint8_t mode() { return packet(35); }
  // The distance travelled within that time; reading clears it.
  int moved_within(rt::Duration period);
  // Lets time pass, and drops what comes.
  void wait(rt::Duration period) { (void)listen(period); }

 private:
  std::unique_ptr<hal::sim::Device> device_{};
  std::unique_ptr<hal::sim::VirtualLink> link_{};
};

}  // namespace cargobay::conformance
