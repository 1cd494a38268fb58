/* A tune with more notes than a song holds: stored in several songs, each played in its turn. */
#include <cargobay.h>
#include <stdio.h>

static const char kTune[] =
    "joy:d=8,o=5,b=240:e,e,f,g,g,f,e,d,c,c,d,e,e.,16d,4d,e,e,f,g,g,f,e,d,c,c,d,e,d.,16c,4c";

static int play(struct cargobay_robot* robot) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  int64_t durations_ns[16];
  if (cargobay_start(robot) != 0) return -1;
  if (cargobay_wait(robot, state.tick, 1000000000, &state) != 0) return -1;
  const int slots = cargobay_store_tune(robot, 0, kTune, durations_ns, 16);
  if (slots < 0) return -1;
  for (int slot = 0; slot < slots; ++slot) {
    struct cargobay_reading playing;
    if (cargobay_play_song(robot, (uint32_t)slot) != 0) return -1;
    const int64_t end_ns = state.robot_time_ns + durations_ns[slot];
    if (cargobay_query(robot, CARGOBAY_PACKET_SONG_PLAYING, 1000000000, &playing) != 0) return -1;
    printf("song %d for %.2f s: %s\n", slot, 1e-9 * (double)durations_ns[slot],
           playing.value != 0 ? "it plays" : "it does not play");
    /* While a song plays the robot ignores the next: two frames after its end is soon enough. */
    while (state.robot_time_ns < end_ns + 2 * 15000000) {
      if (cargobay_wait(robot, state.tick, 1000000000, &state) != 0) return -1;
    }
  }
  return cargobay_end(robot);
}

int main(int argc, char** argv) {
  struct cargobay_options options = {.size = sizeof options,
                                     .flags = argc > 1 ? 0u : CARGOBAY_FLAG_NO_CONFIG,
                                     .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_robot* robot = NULL;
  int error = cargobay_open(&options, &robot);
  if (error == 0) error = play(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  return error != 0;
}
