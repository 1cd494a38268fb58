// A host end joined to a virtual Create by a serial cable, in virtual time: both directions at the
// rates the two ends are set to, every byte at its instant. What VirtualLink waits on, and what
// Server runs along the real clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "hal/sim/line/line_faults.hpp"
#include "hal/sim/ring_buffer.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/sim/robot/uart_line.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

struct CableCounters {
  std::uint64_t host_overruns = 0;        // bytes that arrived at a host with no room for them
  std::uint64_t host_framing_errors = 0;  // bytes that arrived garbled, by their stop bit
  std::uint64_t robot_framing_errors = 0;
};

class Cable {
 public:
  static constexpr std::size_t kHostRoom = 4096;  // each way, as a kernel's tty has

  // The device outlives the cable. The host starts at the rate the robot listens at.
  explicit Cable(Device& device);

  Device& device() { return *device_; }
  const Device& device() const { return *device_; }
  // The device's: since its power-on.
  rt::Duration now() const { return device_->now(); }

  // The host's rate, from now on. Not 0. What it sent leaves at the former rate, within 2 s or not
  // at all: the next client of a port need not wait for what one before it wrote at 1 baud.
  void set_host_baud(std::uint32_t baud);
  std::uint32_t host_baud() const { return host_baud_; }

  // Queues bytes from the host, in their order at the host's rate; returns how many had room.
  std::size_t send(std::span<const std::uint8_t> bytes);
  // The same for one at a rate that was the host's, and so long behind the one before it.
  bool send(std::uint8_t byte, std::uint32_t baud, rt::Duration spacing);
  std::size_t send_room() const { return to_robot_.room(); }
  // When the last of them has left.
  rt::Duration sent_at() const { return to_robot_.free_at(); }

  // Moves on to that time, which is not in the past, delivering each byte at its instant.
  void advance_to(rt::Duration time);
  // Nothing happens before this.
  rt::Duration next_event() const;
  // The latest time that is soon enough for a host that takes bytes `batch` at a time: nothing is
  // kept waiting behind it but the first bytes of a batch whose last is still to come.
  rt::Duration next_batch(std::size_t batch) const;

  // What has arrived at the host.
  std::size_t available() const { return arrived_.size(); }
  std::size_t take(std::span<std::uint8_t> bytes);
  void discard() { arrived_.clear(); }

  // What goes wrong on the way; it may be changed at any time.
  LineFaults& faults_to_host() { return to_host_faults_.faults(); }
  LineFaults& faults_to_robot() { return to_robot_faults_.faults(); }

  const CableCounters& counters() const { return counters_; }

 private:
  void move_to_robot();
  void move_to_host();
  void arrive_at_host(std::uint8_t byte);

  Device* device_;  // outlives the cable
  std::uint32_t host_baud_;
  UartLine to_robot_{kHostRoom};
  FaultyLine to_robot_faults_;
  FaultyLine to_host_faults_;
  RingBuffer<std::uint8_t> arrived_{kHostRoom};
  CableCounters counters_{};
};

}  // namespace cargobay::hal::sim
