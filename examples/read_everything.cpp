// Every sensor packet, by name, with the last frame that reported it.
#include <cstdio>
#include <vector>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static cargobay::Expected<void> read_everything(const cargobay::Options& options) {
  auto robot = cargobay::Robot::open(options);
  if (!robot) return cargobay::Unexpected{robot.error()};
  if (auto started = robot->start(); !started) return started;
  std::vector<cargobay::Packet> packets;
  for (std::uint32_t number = 7; number <= 42; ++number)
    packets.push_back(cargobay::Packet{number});
  // Some are sent in any case; the others only if subscribed to.
  if (auto told = robot->subscribe(packets); !told) return told;
  auto states = robot->states(1s);
  for (const cargobay::State& state : states) {
    if (state.robot_time < 2s) continue;  // the battery comes once a second, the rest more often
    std::vector<cargobay::Reading> readings(packets.size());
    if (auto read = robot->readings(packets, readings); !read) return read;
    for (const cargobay::Reading& reading : readings) {
      std::printf("%2u  %-30s %6d  frame %lld\n", static_cast<unsigned>(reading.packet),
                  std::string{cargobay::packet_name(reading.packet)}.c_str(), reading.value,
                  static_cast<long long>(reading.tick));
    }
    return robot->end();
  }
  return states.outcome();
}

int main(int argc, char** argv) {
  const auto done =
      read_everything(argc > 1 ? cargobay::Options{.port = argv[1]}
                               : cargobay::Options{.flags = cargobay::Flag::no_config});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
