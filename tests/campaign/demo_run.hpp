// A demo in a room by chance, in virtual time: what the campaign of the demos is made of.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "hal/sim/world/path_recorder.hpp"
#include "oi/commands.hpp"
#include "tests/campaign/random_room.hpp"

namespace cargobay::campaign {

struct Options {
  std::uint64_t from = 1;
  std::uint64_t to = 20;
  std::string_view only{};    // empty: all
  std::string_view folder{};  // empty: no drawings
};

// No two robots are alike.
hal::sim::Parameters robot(std::uint64_t seed, double receiver_opening_deg);

// A demo in a room, from its start.
class Run {
 public:
  Run(const RandomRoom& room, oi::DemoNumber demo, const hal::sim::Parameters& parameters);

  // To the next tick.
  void step() {
    device_.advance(device_.until_next_event());
    path_.add(pose(), device_.seen().bump_left || device_.seen().bump_right);
  }
  bool over() const {
    return device_.now() > std::chrono::seconds{1} && !device_.demos().running();
  }
  double time_s() const { return rt::seconds(device_.now()); }
  hal::sim::WorldPose pose() const { return device_.truth().pose; }
  const hal::sim::Device& device() const { return device_; }
  // Into the folder of the options, if there is one.
  void draw(const Options& options, std::string_view demo, std::uint64_t seed) const;

 private:
  const RandomRoom& room_;
  hal::sim::Device device_;
  hal::sim::PathRecorder path_{};
};

// So far in front of a lamp, and to the left of that.
hal::sim::Point ahead(const hal::sim::Beam& beam, double distance_mm, double aside_mm = 0.0);
double distance_mm(const hal::sim::WorldPose& pose, hal::sim::Point to);

// Prints each share that is less than it ought to be.
class Promises {
 public:
  void expect(const char* what, double share, double least);
  bool broken() const { return broken_; }

 private:
  bool broken_ = false;
};

double share(std::size_t part, std::size_t whole);
// Of these times, how many are not longer.
double within(const std::vector<double>& times_s, double limit_s);

// Runs a demo in each room, and prints its row of the table.
void run_homing(const Options& options, oi::DemoNumber demo, const char* name, Promises& promises);
void run_mouse(const Options& options, Promises& promises);

}  // namespace cargobay::campaign
