/* Brings a robot up to talk at 19200 baud, whatever rate it is found at, and reports how. */
#include <cargobay.h>
#include <stdio.h>

static void tell(void* context, const char* step, const char* detail) {
  (void)context;
  printf("  %s %s\n", step, detail);
}

int main(int argc, char** argv) {
  static const char* const kChanges[] = {"it was there already", "by the BRC pin", "by opcode 129"};
  /* With a port: pins and everything else come from the configuration file. */
  struct cargobay_options options = {.size = sizeof options,
                                     .flags = argc > 1 ? 0u : CARGOBAY_NO_CONFIG,
                                     .port = argc > 1 ? argv[1] : NULL,
                                     .baud = 19200,
                                     .progress = tell};
  struct cargobay_bring_up how = {.size = sizeof how};
  struct cargobay_robot* robot = NULL;
  int error = cargobay_open(&options, &robot);
  if (error == 0) error = cargobay_get_bring_up(robot, &how);
  if (error != 0) fprintf(stderr, "%s\n", cargobay_error_message());
  cargobay_close(robot);
  if (error != 0) return 1;
  printf("found at %u baud, talks at %u: %s\n", (unsigned)how.found_baud, (unsigned)how.baud,
         kChanges[how.rate_change]);
  printf("%d pulses on the BRC pin, %s, %.0f ms in all\n", (int)how.brc_pulses,
         how.powered_on != 0 ? "switched on" : "it was on", 1e-6 * (double)how.took_ns);
  return how.baud != 19200;
}
