// The link to a virtual Create on which a fault begins and ends at given instants, to the
// nanosecond, even between the bits of a frame; and a record of the traffic.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "hal/sim/line/virtual_link.hpp"
#include "hal/sim/remote/fault_command.hpp"
#include "hal/stream/byte_stream.hpp"
#include "oi/command_table.hpp"
#include "oi/stream_budget.hpp"
#include "rt/unchecked.hpp"

namespace cargobay::campaign {

class FaultedStream final : public hal::ByteStream {
 public:
  struct Change {
    rt::TimePoint time{};
    std::string_view fault{};  // for sim::apply_fault()
  };

  explicit FaultedStream(hal::sim::VirtualLink& link) : link_{&link} {}

  // In the order of their times, none of them in the past.
  std::vector<Change> changes{};
  // What the host received, and when each drive command that was sent reached the robot.
  std::vector<std::uint8_t> received{};
  std::vector<rt::TimePoint> drives{};

  // In virtual time nothing waits for these allocations.
  Wait wait(rt::TimePoint deadline) CARGOBAY_NONBLOCKING override {
    return rt::unchecked([this, deadline] { return wait_through_changes(deadline); });
  }
  Transfer read(std::span<std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    const Transfer transfer = link_->read(bytes);
    rt::unchecked([&] {
      const auto read = bytes.first(transfer.count);
      received.insert(received.end(), read.begin(), read.end());
    });
    return transfer;
  }
  Transfer write(std::span<const std::uint8_t> bytes) CARGOBAY_NONBLOCKING override {
    rt::unchecked([&] {
      // Zeros that complete half a command may precede it.
      const auto command = std::ranges::find_if(bytes, [](std::uint8_t byte) { return byte != 0; });
      if (command == bytes.end() || *command != oi::DriveDirect::kOpcode) return;
      const auto fill = static_cast<std::size_t>(command - bytes.begin());
      drives.push_back(now() + oi::wire_time(fill + oi::kDriveDirectBytes, baud()));
    });
    return link_->write(bytes);
  }
  rt::TimePoint now() const CARGOBAY_NONBLOCKING override { return link_->now(); }

  std::uint32_t baud() const override { return link_->baud(); }
  std::error_code set_baud(std::uint32_t baud) override { return link_->set_baud(baud); }
  std::error_code set_wake_threshold(std::size_t bytes) override {
    return link_->set_wake_threshold(bytes);
  }
  void discard_input() override { link_->discard_input(); }
  bool drain(rt::Duration timeout) override { return link_->drain(timeout); }
  void sleep(rt::Duration duration) override { link_->sleep(duration); }

 private:
  Wait wait_through_changes(rt::TimePoint deadline) {
    for (;;) {
      const bool ahead = next_ < changes.size() && changes[next_].time <= deadline;
      const Wait woken = link_->wait(ahead ? changes[next_].time : deadline);
      if (!ahead || woken != Wait::timed_out) return woken;
      (void)hal::sim::apply_fault(changes[next_].fault, link_->cable());  // the cases are tested
      ++next_;
    }
  }

  hal::sim::VirtualLink* link_;  // outlives the stream
  std::size_t next_ = 0;
};

}  // namespace cargobay::campaign
