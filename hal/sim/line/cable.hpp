// A host joined to a virtual Create by a serial cable, in virtual time: both directions at the
// rates that the two ends are set to, every byte at its instant. VirtualLink waits on it, and
// Server runs it along the real clock.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>

#include "hal/sim/line/line_faults.hpp"
#include "hal/sim/ring_buffer.hpp"
#include "hal/sim/robot/device.hpp"
#include "hal/sim/robot/uart_line.hpp"
#include "rt/clock.hpp"

namespace cargobay::hal::sim {

struct CableCounters {
  std::uint64_t host_overruns = 0;        // bytes that arrived when the host had no room
  std::uint64_t host_framing_errors = 0;  // bytes that arrived garbled, judged by their stop bit
  std::uint64_t robot_framing_errors = 0;
};

class Cable {
 public:
  static constexpr std::size_t kHostRoom = 4096;  // each way, as in a kernel's tty

  // The device outlives the cable. The host starts at the rate that the robot listens at.
  explicit Cable(Device& device);

  Device& device() { return *device_; }
  const Device& device() const { return *device_; }
  // The device's time: since its power-on.
  rt::Duration now() const { return device_->now(); }

  // Sets the host's rate from now on. Not 0. Bytes sent before leave at the former rate, within 2 s
  // or not at all: the next client of a port need not wait for what a previous one wrote at 1 baud.
  void set_host_baud(std::uint32_t baud);
  std::uint32_t host_baud() const { return host_baud_; }

  // Queues bytes from the host, in order, at the host's rate; returns how many there was room for.
  std::size_t send(std::span<const std::uint8_t> bytes);
  // The same for one byte at a former rate of the host, at least `spacing` after the one before.
  bool send(std::uint8_t byte, std::uint32_t baud, rt::Duration spacing);
  std::size_t send_room() const { return to_robot_.room(); }
  // When the last queued byte has left.
  rt::Duration sent_at() const { return to_robot_.free_at(); }

  // Advances to `time`, which is not in the past, delivering each byte at its instant.
  void advance_to(rt::Duration time);
  // Nothing happens before this time.
  rt::Duration next_event() const;
  // The latest time to advance to for a host that takes bytes `batch` at a time: by then nothing
  // has been kept waiting except the first bytes of a batch whose last is still to come.
  rt::Duration next_batch(std::size_t batch) const;

  // Does something when the time has come; at once if it is past. What is done may depend on the
  // order of the calls.
  void at(rt::Duration time, std::function<void(Cable&)> deed);
  // How many still wait for their time.
  std::size_t deeds() const { return later_.size(); }

  // Bytes that have arrived at the host.
  std::size_t available() const { return arrived_.size(); }
  std::size_t take(std::span<std::uint8_t> bytes);
  void discard() { arrived_.clear(); }

  // Pulls the plug, or puts it back. Called instead of making the line silent, if it is set: a
  // served robot's port disappears. It may be called in the middle of an advance.
  std::function<void(bool plugged)> on_plug{};
  void set_plugged(bool plugged);
  // What goes wrong on the way; may be changed at any time.
  LineFaults& faults_to_host() { return to_host_faults_.faults(); }
  LineFaults& faults_to_robot() { return to_robot_faults_.faults(); }

  const CableCounters& counters() const { return counters_; }

 private:
  void move_to_robot();
  void move_to_host();
  void arrive_at_host(std::uint8_t byte);
  void do_what_is_due();

  Device* device_;  // outlives the cable
  std::uint32_t host_baud_;
  UartLine to_robot_{kHostRoom};
  FaultyLine to_robot_faults_;
  FaultyLine to_host_faults_;
  RingBuffer<std::uint8_t> arrived_{kHostRoom};
  CableCounters counters_{};
  std::multimap<rt::Duration, std::function<void(Cable&)>> later_{};
};

}  // namespace cargobay::hal::sim
