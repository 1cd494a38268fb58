// Brings a robot up to talk at 19200 baud, whatever rate it is found at, and reports how.
#include <array>
#include <cstdio>

#include <cargobay.hpp>

static void tell(std::string_view step, std::string_view detail) {
  std::printf("  %s %s\n", std::string{step}.c_str(), std::string{detail}.c_str());
}

static cargobay::Expected<cargobay::BringUp> bring_up(const cargobay::Options& options) {
  auto robot = cargobay::Robot::open(options);
  if (!robot) return robot.error();
  return robot->bring_up();
}

int main(int argc, char** argv) {
  constexpr std::array changes{"it was there already", "by the BRC pin", "by opcode 129"};
  // With a port: pins and everything else come from the configuration file.
  auto options = argc > 1 ? cargobay::Options{.port = argv[1]}
                          : cargobay::Options{.flags = CARGOBAY_NO_CONFIG};
  options.baud = 19200;
  options.progress = tell;
  const auto how = bring_up(options);
  if (!how) {
    std::fprintf(stderr, "%s\n", how.error().message);
    return 1;
  }
  std::printf("found at %u baud, talks at %u: %s\n", how->found_baud, how->baud,
              changes.at(static_cast<std::size_t>(how->rate_change)));
  std::printf("%d pulses on the BRC pin, %s, %.0f ms in all\n", how->brc_pulses,
              how->powered_on != 0 ? "switched on" : "it was on",
              1e-6 * static_cast<double>(how->took_ns));
  return how->baud == 19200 ? 0 : 1;
}
