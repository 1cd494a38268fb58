/* Brings a robot up to talk at 19200 baud, whatever rate it is found at, and reports how. */
#include <cargobay.h>
#include <stdio.h>
#include <string.h>

static int tell(void* last, const char* step, const char* detail) {
  char line[200];
  snprintf(line, sizeof line, "  %s %s\n", step, detail);
  /* It comes every 100 ms, too. */
  return strcmp(last, line) != 0 && fputs(strcpy(last, line), stdout) < 0;
}

int main(int argc, char** argv) {
  char last[200] = "";
  struct cargobay_options options = {.size = sizeof options,
                                     .flags = argc > 1 ? 0u : CARGOBAY_FLAG_NO_CONFIG,
                                     .port = argc > 1 ? argv[1] : NULL,
                                     .progress = tell,
                                     .progress_context = last,
                                     .baud = 19200};
  struct cargobay_bring_up how = {.size = sizeof how};
  struct cargobay_robot* robot = NULL;
  if (cargobay_open(&options, &robot) != 0 || cargobay_get_bring_up(robot, &how) != 0)
    fprintf(stderr, "%s\n", cargobay_error_message());
  else
    printf("found at %u baud, talks at %u after %d pulses on the BRC pin\n",
           (unsigned)how.found_baud, (unsigned)how.baud, (int)how.brc_pulses);
  cargobay_close(robot);
  return how.baud != 19200;
}
