// Every sensor packet, by name, with the last frame that reported it.
#include <array>
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

// clang-format off
static constexpr std::array kNames{  // from packet 7 on
    "bumps and wheel drops", "wall", "cliff left", "cliff front left", "cliff front right",
    "cliff right", "virtual wall", "overcurrents", "unused", "unused", "infrared byte", "buttons",
    "distance, mm", "angle, deg", "charging state", "voltage, mV", "current, mA",
    "battery temperature, deg C", "battery charge, mAh", "battery capacity, mAh", "wall signal",
    "cliff left signal", "cliff front left signal", "cliff front right signal", "cliff right signal",
    "digital inputs", "analog signal", "charging sources", "OI mode", "song number", "song playing",
    "stream packets", "requested velocity, mm/s", "requested radius, mm",
    "requested right velocity, mm/s", "requested left velocity, mm/s"};
// clang-format on

static cargobay::Expected<void> read_everything(const cargobay::Options& options) {
  auto robot = cargobay::Robot::open(options);
  if (!robot) return robot.error();
  if (auto started = robot->start(); !started) return started;
  auto told = robot->subscribe(CARGOBAY_EXTRA_SIGNALS_LEFT | CARGOBAY_EXTRA_SIGNALS_RIGHT |
                               CARGOBAY_EXTRA_OUTPUTS);
  if (!told) return told;
  // The battery comes once a second, everything else more often.
  for (std::chrono::nanoseconds now{0}; now < 2s;) {
    const auto state = robot->wait(1s);
    if (!state) return state.error();
    now = std::chrono::nanoseconds{state->time_ns};
  }
  const auto sensors = robot->sensors();
  if (!sensors) return sensors.error();
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const std::size_t packet = CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS + i;
    std::printf("%2zu  %-30s %6d  frame %lld\n", packet, kNames[i], sensors->value[packet],
                static_cast<long long>(sensors->tick[packet]));
  }
  return robot->stop();
}

int main(int argc, char** argv) {
  const auto done = read_everything(argc > 1 ? cargobay::Options{.port = argv[1]}
                                             : cargobay::Options{.flags = CARGOBAY_NO_CONFIG});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
