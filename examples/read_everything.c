/* Every sensor packet, by name, with the last frame that reported it. */
#include <cargobay.h>
#include <stdio.h>

/* clang-format off */
static const char* const kNames[] = {  /* from packet 7 on */
    "bumps and wheel drops", "wall", "cliff left", "cliff front left", "cliff front right",
    "cliff right", "virtual wall", "overcurrents", "unused", "unused", "infrared byte", "buttons",
    "distance, mm", "angle, deg", "charging state", "voltage, mV", "current, mA",
    "battery temperature, deg C", "battery charge, mAh", "battery capacity, mAh", "wall signal",
    "cliff left signal", "cliff front left signal", "cliff front right signal", "cliff right signal",
    "digital inputs", "analog signal", "charging sources", "OI mode", "song number", "song playing",
    "stream packets", "requested velocity, mm/s", "requested radius, mm",
    "requested right velocity, mm/s", "requested left velocity, mm/s"};
/* clang-format on */

static int read_everything(struct cargobay_robot* robot) {
  struct cargobay_state state = {.size = sizeof state};
  struct cargobay_sensors sensors = {.size = sizeof sensors};
  if (cargobay_start(robot) != 0) return -1;
  if (cargobay_subscribe(robot, CARGOBAY_EXTRA_SIGNALS_LEFT | CARGOBAY_EXTRA_SIGNALS_RIGHT |
                                    CARGOBAY_EXTRA_OUTPUTS) != 0)
    return -1;
  /* The battery comes once a second, everything else more often. */
  while (state.time_ns < 2000000000) {
    if (cargobay_wait(robot, -1, &state) != 0) return -1;
  }
  if (cargobay_get_sensors(robot, &sensors) != 0) return -1;
  for (int packet = CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS; packet < CARGOBAY_PACKETS; ++packet) {
    printf("%2d  %-30s %6d  frame %lld\n", packet, kNames[packet - 7], (int)sensors.value[packet],
           (long long)sensors.tick[packet]);
  }
  return cargobay_stop(robot);
}

int main(int argc, char** argv) {
  struct cargobay_options options = {.size = sizeof options,
                                     .flags = argc > 1 ? 0u : CARGOBAY_NO_CONFIG,
                                     .port = argc > 1 ? argv[1] : NULL};
  struct cargobay_robot* robot = NULL;
  int error = cargobay_open(&options, &robot);
  if (error == 0) error = read_everything(robot);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  return error != 0;
}
