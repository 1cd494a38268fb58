// A tune with more notes than a song holds: stored in several songs, each played in its turn.
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static constexpr const char* kTune =
    "joy:d=8,o=5,b=240:e,e,f,g,g,f,e,d,c,c,d,e,e.,16d,4d,e,e,f,g,g,f,e,d,c,c,d,e,d.,16c,4c";

static cargobay::Expected<void> play(const cargobay::Options& options) {
  auto robot = cargobay::Robot::open(options);
  if (!robot) return cargobay::Unexpected{robot.error()};
  if (auto started = robot->start(); !started) return started;
  auto state = robot->wait(-1, 1s);
  if (!state) return state.outcome();
  const auto songs = robot->store_tune(0, kTune);
  if (!songs) return cargobay::Unexpected{songs.error()};
  std::uint32_t slot = 0;
  for (const std::chrono::nanoseconds duration : *songs) {
    if (auto sent = robot->play_song(slot); !sent) return sent;
    // While a song plays the robot ignores the next: two frames after its end is soon enough.
    const std::chrono::nanoseconds next = state->robot_time + duration + 30ms;
    const auto playing = robot->query(cargobay::Packet::song_playing, 1s);
    if (!playing) return playing.outcome();
    std::printf("song %u for %.2f s: %s\n", slot++, std::chrono::duration<double>{duration}.count(),
                playing->value != 0 ? "it plays" : "it does not play");
    while (state->robot_time < next) {
      state = robot->wait(state->tick, 1s);
      if (!state) return state.outcome();
    }
  }
  return robot->end();
}

int main(int argc, char** argv) {
  const auto done = play(argc > 1 ? cargobay::Options{.port = argv[1]}
                                  : cargobay::Options{.flags = cargobay::Flag::no_config});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
