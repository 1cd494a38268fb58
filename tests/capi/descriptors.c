/* A program that was started without standard input and output: nothing in the library may get
   their numbers, or what the program prints would go to the robot. Reports by its exit code what is
   wrong, since it has nowhere to print to. */
#include <cargobay.h>
#include <fcntl.h>
#include <unistd.h>

static int standard_numbers_are_free(void) {
  for (int number = 0; number < 3; ++number) {
    if (fcntl(number, F_GETFD) >= 0) return 0;
  }
  return 1;
}

int main(void) {
  struct cargobay_options options = {.size = sizeof options, .flags = CARGOBAY_FLAG_NO_CONFIG};
  struct cargobay_state state = {.size = sizeof state, .tick = -1};
  struct cargobay_robot* robot = NULL;
  close(0);
  close(1);
  close(2);
  if (cargobay_open(&options, &robot) != 0) return 10;
  if (!standard_numbers_are_free()) return 11;
  if (cargobay_start(robot) != 0) return 12;
  for (int frame = 0; frame < 30; ++frame) {
    if (cargobay_drive(robot, 100.0, 0.0) != 0) return 13;
    if (cargobay_wait(robot, state.tick, -1, &state) != 0) return 14;
  }
  if (cargobay_get_fd(robot) < 3) return 19;
  if (!standard_numbers_are_free()) return 15;
  if (cargobay_end(robot) != 0) return 16;
  if (cargobay_close(robot) != 0) return 17;
  return standard_numbers_are_free() ? 0 : 18;
}
