// A tune with more notes than a song holds: stored in several songs, each played in its turn.
#include <cstdio>

#include <cargobay.hpp>

using namespace std::chrono_literals;

static constexpr const char* kTune =
    "joy:d=8,o=5,b=240:e,e,f,g,g,f,e,d,c,c,d,e,e.,16d,4d,e,e,f,g,g,f,e,d,c,c,d,e,d.,16c,4c";

static cargobay::Expected<void> play(const cargobay::Options& options) {
  auto robot = cargobay::Robot::open(options);
  if (!robot) return robot.error();
  if (auto started = robot->start(); !started) return started;
  auto state = robot->wait(1s);
  if (!state) return state.error();
  const auto songs = robot->tune(0, kTune);
  if (!songs) return songs.error();
  std::uint8_t slot = 0;
  for (const std::chrono::nanoseconds duration : *songs) {
    if (auto sent = robot->play_song(slot); !sent) return sent;
    // While a song plays the robot ignores the next: two frames after its end is soon enough.
    const std::chrono::nanoseconds next =
        std::chrono::nanoseconds{state->time_ns} + duration + 30ms;
    const auto playing = robot->query(CARGOBAY_PACKET_SONG_PLAYING, 1s);
    if (!playing) return playing.error();
    std::printf("song %d for %.2f s: %s\n", slot++, std::chrono::duration<double>{duration}.count(),
                *playing != 0 ? "it plays" : "it does not play");
    while (std::chrono::nanoseconds{state->time_ns} < next) {
      state = robot->wait(1s);
      if (!state) return state.error();
    }
  }
  return robot->stop();
}

int main(int argc, char** argv) {
  const auto done = play(argc > 1 ? cargobay::Options{.port = argv[1]}
                                  : cargobay::Options{.flags = CARGOBAY_NO_CONFIG});
  if (!done) std::fprintf(stderr, "%s\n", done.error().message);
  return done ? 0 : 1;
}
