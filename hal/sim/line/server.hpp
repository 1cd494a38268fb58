// A virtual Create on a pseudo-terminal, in real time. One thread runs the device along
// CLOCK_MONOTONIC and paces every byte both ways as the wire would: no byte is early, and none is
// later than the thread's own wake-up.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "hal/result.hpp"
#include "hal/sim/line/cable.hpp"
#include "hal/sim/line/host_rate_change.hpp"
#include "hal/sim/line/pty_port.hpp"
#include "hal/sim/line/pty_writes.hpp"
#include "hal/sim/line/write_times.hpp"
#include "hal/sim/parameters.hpp"
#include "hal/sim/ring_buffer.hpp"
#include "hal/sim/robot/device.hpp"
#include "rt/clock.hpp"
#include "rt/mailbox.hpp"

namespace cargobay::hal::sim {

struct ServerOptions {
  std::string link{};  // symbolic link to the pseudo-terminal; empty for none
  int priority = 0;    // SCHED_FIFO priority to ask for; 0: none
  // Bytes are handed over as soon as there are this many, or the line goes silent: 8 is what the
  // FIFO of a Pi's UART does. 1 hands over every byte by itself, at several times the CPU time.
  std::size_t batch_bytes = 8;
  std::size_t truth_samples = 4096;  // kept for take_truth(); the oldest are dropped
  // Called at the end of each tick, by whichever thread advances the robot. It may look at the
  // device but must not call the server.
  std::function<void(const Device&)> on_tick{};
};

// The true state of the robot at one tick.
struct TruthSample {
  rt::TimePoint time{};
  WheelSpeeds speeds{};
  WheelSpeeds commanded{};
  oi::Mode mode = oi::Mode::off;
};

// Where it truly is, and how fast, as of its newest tick.
struct NewestTruth {
  rt::Duration time{};  // of the robot, since its power-on
  WorldPose pose{};
  WheelSpeeds speeds{};
};

struct ServerCounters {
  std::uint64_t wakeups = 0;
  std::uint64_t stalls = 0;  // the process was stopped for over a second, and the robot with it
  std::uint64_t bytes_undelivered = 0;  // sent by the robot but not taken by the port
};

struct Snapshot {
  rt::Duration time{};  // of the robot, since its power-on
  oi::Mode mode = oi::Mode::off;
  std::uint32_t baud = 0;
  Truth truth{};
  WheelSpeeds commanded{};
  DeviceCounters device{};
  CableCounters cable{};
  ServerCounters server{};
};

class Server {
 public:
  // Opens the pseudo-terminal; the robot stays off until start().
  static Result<std::unique_ptr<Server>> open(const Parameters& parameters,
                                              const ServerOptions& options);
  // Stops.
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  // Powers the robot on. Call it once.
  [[nodiscard]] std::error_code start();
  // Ends the thread and removes the link. Idempotent; not to be called by two threads at once.
  void stop();

  // What a client opens; empty after stop().
  std::string path() const;
  // After start(): 0 if the requested priority was granted, or none was requested; else errno.
  int priority_error() const { return priority_error_; }

  // For any thread. These functions lock, and may wait for the server's thread to finish a step.
  Snapshot snapshot() const;
  // From any thread, without a lock; nothing before the first tick.
  std::optional<NewestTruth> newest_truth() const { return newest_truth_.get(); }
  // Appends the samples since the last call.
  void take_truth(std::vector<TruthSample>& samples);
  // Runs `change` on the device in its present state, between two events: bumps, cliffs, buttons, a
  // new place.
  void with_device(const std::function<void(Device&)>& change);
  // The same for the device and its line, to set faults.
  void with_cable(const std::function<void(Cable&)>& change);

  // When the robot's clock shows that time. For the robot's callbacks: on_tick, on_drive.
  rt::TimePoint monotonic(rt::Duration robot_time) const { return power_on_ + robot_time; }

  // Pulls the adapter out: the pseudo-terminal disappears, and all clients are hung up. The robot
  // stays. Plugged in again, it is a new pseudo-terminal at the same link.
  void unplug();
  [[nodiscard]] Result<void> replug();

 private:
  Server(const Parameters& parameters, const ServerOptions& options, std::unique_ptr<PtyPort> port,
         int wake_descriptor);

  void run();
  // Advances the robot to now; returns when it next needs to.
  rt::TimePoint step();
  void sleep_until(rt::TimePoint time);
  void catch_up(rt::TimePoint now);
  void take_from_host();
  void hand_to_host();
  // If the robot needs its bytes spaced, looks when the host writes them.
  void watch_spacing();
  void look_for_writes(bool bytes_came);
  void send(std::span<const std::uint8_t> bytes, std::uint32_t baud);
  // After the host has changed its rate, finds out which of the bytes were sent before.
  void follow_rate(std::uint32_t baud);
  void settle_rate();
  void end_rate_change();
  void wake();
  void pull_out();
  Result<void> plug_in();
  // Gives up the descriptors that the program has closed, and ends the thread: the robot can
  // no longer be reached.
  void lose_descriptors();

  ServerOptions options_;
  int wake_descriptor_;  // an eventfd: ends the thread's sleep
  mutable std::mutex mutex_;
  std::unique_ptr<PtyPort> port_;
  Device device_;
  Cable cable_;
  std::optional<bool> plug_{};  // what a fault has done to the port; step() does it
  // Lasts while a client has the port open at a rate that needs spacing.
  struct Spacing {
    explicit Spacing(const std::string& path) : writes{path} {}
    PtyWrites writes;
    WriteTimes times{oi::kByteSpacingAt115200};
  };
  std::optional<Spacing> spacing_{};
  HostRateChange change_{};
  std::uint8_t last_sent_ = 0;
  RingBuffer<TruthSample> truth_;
  rt::Mailbox<NewestTruth> newest_truth_{};
  ServerCounters counters_{};
  rt::TimePoint power_on_{};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> lost_{false};  // the program closed our descriptors: others may have them
  std::thread thread_;
  int priority_error_ = 0;
};

}  // namespace cargobay::hal::sim
