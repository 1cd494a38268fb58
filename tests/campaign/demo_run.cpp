#include "tests/campaign/demo_run.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <string>

#include "hal/sim/random.hpp"
#include "hal/sim/world/world_drawing.hpp"

namespace cargobay::campaign {

using hal::sim::Beam;
using hal::sim::Parameters;
using hal::sim::Point;
using hal::sim::Random;
using hal::sim::WorldPose;

Parameters robot(std::uint64_t seed, double receiver_opening_deg) {
  Random random{seed};
  Parameters parameters;
  parameters.seed = seed;
  parameters.wheels.lag_s = 0.05 + 0.1 * random.uniform();
  parameters.wheels.gain_left = 1.0 - 0.12 * random.uniform();
  parameters.wheels.gain_right = 1.0 - 0.12 * random.uniform();
  parameters.receiver_opening_deg = receiver_opening_deg;
  return parameters;
}

Run::Run(const RandomRoom& room, oi::DemoNumber demo, const Parameters& parameters)
    : room_{room}, device_{parameters} {
  hal::sim::inhabit(device_, room_.world);
  for (const std::uint8_t byte :
       {oi::Start::kOpcode, oi::Demo::kOpcode, static_cast<std::uint8_t>(demo)}) {
    device_.receive(byte);
  }
}

void Run::draw(const Options& options, std::string_view demo, std::uint64_t seed) const {
  if (options.folder.empty()) return;
  std::ofstream file{std::string{options.folder} + "/" + std::string{demo} + "." +
                     std::to_string(seed) + ".svg"};
  file << hal::sim::draw(room_.world, path_.path());
}

Point ahead(const Beam& beam, double distance_mm, double aside_mm) {
  const double heading_rad = beam.heading_deg * std::numbers::pi / 180.0;
  return {
      beam.origin.x_mm + distance_mm * std::cos(heading_rad) - aside_mm * std::sin(heading_rad),
      beam.origin.y_mm + distance_mm * std::sin(heading_rad) + aside_mm * std::cos(heading_rad)};
}

double distance_mm(const WorldPose& pose, Point to) {
  return std::hypot(pose.x_mm - to.x_mm, pose.y_mm - to.y_mm);
}

void Promises::expect(const char* what, double share, double least) {
  if (share >= least) return;
  std::fprintf(stderr, "%s: %.3f, less than %.2f\n", what, share, least);
  broken_ = true;
}

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 1.0 : static_cast<double>(part) / static_cast<double>(whole);
}

double within(const std::vector<double>& times_s, double limit_s) {
  const auto soon = std::count_if(times_s.begin(), times_s.end(),
                                  [limit_s](double time_s) { return time_s <= limit_s; });
  return share(static_cast<std::size_t>(soon), times_s.size());
}

}  // namespace cargobay::campaign
