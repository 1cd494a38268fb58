// Brings a robot up to talk at 19200 baud, whatever rate it is found at, and reports how.
#include <array>
#include <cstdio>

#include <cargobay.hpp>

// A step that takes long is reported again every 100 ms.
static bool tell(std::string_view step, std::string_view detail) {
  static std::string before;
  const std::string line = std::string{step}.append(" ").append(detail);
  if (std::exchange(before, line) != line) std::printf("  %s\n", line.c_str());
  return true;  // false would give up
}

int main(int argc, char** argv) {
  constexpr std::array changes{"it was there already", "by the BRC pin", "by opcode 129"};
  // With a port: pins and everything else come from the configuration file.
  auto options = argc > 1 ? cargobay::Options{.port = argv[1]}
                          : cargobay::Options{.flags = cargobay::Flag::no_config};
  options.baud = 19200;
  options.progress = tell;
  const auto robot = cargobay::Robot::open(options);
  const auto how = robot ? robot->bring_up() : cargobay::Unexpected{robot.error()};
  if (!how) std::fprintf(stderr, "%s\n", how.error().message);
  if (!how) return 1;
  std::printf("found at %u baud, talks at %u: %s\n", how->found_baud, how->baud,
              changes.at(static_cast<std::size_t>(how->rate_change)));
  std::printf("%d pulses on the BRC pin, %s, %.0f ms in all\n", how->brc_pulses,
              how->powered_on ? "switched on" : "it was on",
              std::chrono::duration<double, std::milli>{how->took}.count());
  return how->baud == 19200 ? 0 : 1;
}
