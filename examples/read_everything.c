/* Every sensor packet, by name, with the last frame that reported it. */
#include <cargobay.h>
#include <stdio.h>

enum {
  first_packet = CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS,
  packet_count = CARGOBAY_PACKET_REQUESTED_LEFT_VELOCITY - first_packet + 1
};

static int read_everything(struct cargobay_robot* robot) {
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  struct cargobay_reading readings[packet_count];
  uint32_t packets[packet_count];
  for (uint32_t i = 0; i < packet_count; ++i) packets[i] = first_packet + i;
  if (cargobay_start(robot) != 0) return -1;
  /* Some are sent in any case; the others only if subscribed to. */
  if (cargobay_subscribe(robot, packets, packet_count) != 0) return -1;
  /* The battery comes once a second, everything else more often. */
  while (state.robot_time_ns < 2000000000) {
    if (cargobay_wait(robot, state.tick, -1, &state) != 0) return -1;
  }
  if (cargobay_get_readings(robot, packets, packet_count, readings) != 0) return -1;
  for (int i = 0; i < packet_count; ++i) {
    printf("%2d  %-30s %6d  frame %lld\n", first_packet + i, cargobay_packet_name(first_packet + i),
           (int)readings[i].value, (long long)readings[i].tick);
  }
  return cargobay_end(robot);
}

int main(int argc, char** argv) {
  struct cargobay_options options = {.size = sizeof options,
                                     .flags = argc > 1 ? 0u : CARGOBAY_FLAG_NO_CONFIG,
                                     .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_robot* robot = NULL;
  int error = cargobay_open(&options, &robot);
  if (error == 0) error = read_everything(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  return error != 0;
}
