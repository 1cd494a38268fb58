// A virtual Create in this process, and the commands that talk to it without a bring-up.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "hal/sim/line/server.hpp"
#include "rt/clock.hpp"
#include "tests/pty/serial_client.hpp"
#include "tests/pty/tools_process.hpp"

namespace cargobay::test {

class RobotTool : public testing::Test {
 protected:
  RobotTool() {
    auto server = hal::sim::Server::open({}, {});
    if (server && !(*server)->start()) server_ = std::move(*server);
  }
  void SetUp() override { ASSERT_TRUE(server_); }

  std::vector<std::string> with_port(const std::string& tool,
                                     const std::vector<std::string>& words) const {
    std::vector<std::string> all{tool, "--port", server_->path()};
    all.insert(all.end(), words.begin(), words.end());
    return all;
  }
  Outcome send(const std::vector<std::string>& words) const {
    return run_tool(with_port("send", words));
  }
  Outcome sensors(const std::vector<std::string>& words) const {
    return run_tool(with_port("sensors", words));
  }
  std::string error_of(const std::vector<std::string>& words) const {
    const Outcome outcome = send(words);
    EXPECT_EQ(outcome.code, 1);
    return outcome.error;
  }
  // After the pause one frame may still be in flight.
  bool streams_no_longer() const {
    const auto frames_later = [this](rt::Duration time) {
      const rt::Duration now = server_->snapshot().time;
      EXPECT_TRUE(
          hal::sim::test::eventually([&] { return server_->snapshot().time > now + time; }));
      return server_->snapshot().device.frames_sent;
    };
    const std::uint64_t frames = frames_later(std::chrono::milliseconds{100});
    return frames_later(std::chrono::milliseconds{100}) == frames;
  }
  bool turning() const {
    const hal::sim::Snapshot now = server_->snapshot();
    return now.commanded.left_mm_s != 0.0 || now.commanded.right_mm_s != 0.0;
  }
  bool stopped() const {
    return hal::sim::test::eventually([this] { return !turning(); });
  }

  std::unique_ptr<hal::sim::Server> server_;
};

}  // namespace cargobay::test
