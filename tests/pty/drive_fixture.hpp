// A virtual Create in the test's own process, to be driven by the command through its pty.
#pragma once

#include <sys/stat.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hal/sim/line/server.hpp"
#include "tests/pty/command.hpp"
#include "tests/pty/serial_client.hpp"

namespace cargobay::test {

using hal::sim::test::eventually;

// The entire complaint of a command: one line after its name, which says this.
// NOLINTNEXTLINE(readability-identifier-naming): named as matchers are
MATCHER_P(OneErrorLine, says, "is one line `cargobay: error: ...` saying " + std::string{says}) {
  const std::string& text = arg;
  return text.starts_with("cargobay: error: ") && text.find('\n') == text.size() - 1 &&
         text.find(says) != std::string::npos;
}

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream file{path, std::ios::binary};
  return {std::istreambuf_iterator<char>{file}, std::istreambuf_iterator<char>{}};
}

// A folder for one test, removed with it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "cargobay-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string path(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream{path_ / name} << text;
    return path(name);
  }

 private:
  std::filesystem::path path_;
};

class DriveTest : public testing::Test {
 protected:
  using Setup = Command::Setup;

  static constexpr Setup kOnTerminal{.output = Setup::Output::terminal};
  static constexpr Setup kNobody{.user = Setup::User::nobody};

  void SetUp() override { serve({}); }
  // Holds for every test. A stop need not wait for a tick.
  void TearDown() override {
    std::optional<std::uint64_t> last_tick;
    for (const hal::sim::DriveRecord& record : drives()) {
      if (record.command == hal::sim::WheelSpeeds{}) continue;
      EXPECT_NE(last_tick, record.tick) << "two drive commands in one tick";
      last_tick = record.tick;
    }
  }
  // Replaces the robot by one with these parameters. Its port is open to all users.
  void serve(const hal::sim::Parameters& parameters) {
    server_.reset();
    drives_.clear();
    // A robot has a processor of its own: if allowed, it runs before everything else.
    auto server = hal::sim::Server::open(parameters, {.priority = 70});
    ASSERT_TRUE(server) << server.failure().message;
    server_ = std::move(*server);
    server_->with_device([this](hal::sim::Device& device) {
      device.on_drive = [this](const hal::sim::DriveRecord& record) { drives_.push_back(record); };
    });
    ASSERT_FALSE(server_->start());
    port_ = server_->path();
    ASSERT_EQ(chmod(port_.c_str(), 0666), 0);
  }

  // Arguments that name the robot's port, and those the test adds.
  std::vector<std::string> drive(std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{"drive", "--port", port_};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  bool starts_to_move() const {
    return eventually([this] { return server_->snapshot().truth.speeds.left_mm_s > 50.0; });
  }
  // Twenty ticks later it still moves, and is still told to.
  bool drives_on() const {
    const std::size_t before = drives().size();
    return eventually([&] { return drives().size() > before + 20; }) &&
           server_->snapshot().commanded.left_mm_s > 0.0;
  }
  // It stands still, and was told to; whatever ended the drive sends nothing further.
  bool stands_still() const {
    const hal::sim::WheelSpeeds commanded = server_->snapshot().commanded;
    if (commanded.left_mm_s != 0.0 || commanded.right_mm_s != 0.0) return false;
    return eventually([this] {
      const hal::sim::WheelSpeeds speeds = server_->snapshot().truth.speeds;
      return std::abs(speeds.left_mm_s) < 0.5 && std::abs(speeds.right_mm_s) < 0.5;
    });
  }
  oi::Mode mode() const { return server_->snapshot().mode; }
  // All drive commands so far that the robot obeyed.
  std::vector<hal::sim::DriveRecord> drives() const {
    std::vector<hal::sim::DriveRecord> copy;
    server_->with_device([&](hal::sim::Device&) { copy = drives_; });
    return copy;
  }

  std::string port_;

 private:
  std::vector<hal::sim::DriveRecord> drives_;  // guarded by the server's lock; outlives it

 protected:
  std::unique_ptr<hal::sim::Server> server_;
};

}  // namespace cargobay::test
