// One program that drives and dies, and what happened to its robot.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hal/sim/line/server.hpp"
#include "rt/clock.hpp"

namespace cargobay::test {

enum class Way : std::uint8_t { kill, segv, abort, stop, endless };
inline constexpr std::array kWays{Way::kill, Way::segv, Way::abort, Way::stop, Way::endless};

std::string_view name(Way way);
std::optional<Way> find_way(std::string_view wanted);
// Whether the program stays alive and only its loop hangs.
bool is_hang(Way way);

struct Death {
  bool drove = false;    // its wheels turned before
  bool stopped = false;  // it was told to stop, through its port, and its wheels rest
  bool passive = false;
  bool quiet = false;       // no other drive command after that
  rt::Duration to_stop{0};  // from the death to the last byte of the stop
};

// A virtual Create for a series of victims. Each drives it with its own Robot, in its own process.
class DeathBed {
 public:
  // Null, after printing why, if there is no pseudo-terminal.
  static std::unique_ptr<DeathBed> make(std::uint64_t seed, rt::Duration deadline);

  // Takes about a second. The moment is random: up to half a second after the first motion.
  Death let_die(Way way);

 private:
  DeathBed(std::uint64_t seed, rt::Duration deadline) : chance_{seed}, deadline_{deadline} {}
  std::uint64_t draw(std::uint64_t below);
  rt::TimePoint power_on() const;
  std::vector<hal::sim::DriveRecord> take_records();

  std::uint64_t chance_;
  rt::Duration deadline_;
  std::mutex mutex_;
  std::vector<hal::sim::DriveRecord> records_;  // under mutex_
  std::unique_ptr<hal::sim::Server> server_;    // destroyed before the records
};

// Runs in the victim's process: `path` is the robot's port; dies after `frames` frames. Returns the
// exit code if it could not even do that.
int be_victim(Way way, const std::string& path, int frames, rt::Duration deadline);

}  // namespace cargobay::test
