/* All functions, with a handle that is not open or of another kind; `words` are in the message. */
#ifndef EVERY_FUNCTION_H
#define EVERY_FUNCTION_H

#include <string.h>

#include "check.h"

static inline void every_robot_function_refuses(struct cargobay_robot* robot, const char* words) {
  int32_t value = 0;
  const uint8_t byte = 153;
  const struct cargobay_note note = {60, 16};
  SIZED(cargobay_state, state);
  SIZED(cargobay_sensors, sensors);
  SIZED(cargobay_statistics, statistics);
  SIZED(cargobay_bring_up, bring_up);
  SIZED(cargobay_event, event);
  CHECK_FAILS(cargobay_close(robot), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_start(robot), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_stop(robot), CARGOBAY_E_HANDLE, words);
  CHECK(cargobay_request_stop(robot) == CARGOBAY_E_HANDLE);
  CHECK_FAILS(cargobay_set_control(robot, NULL, NULL), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_get_bring_up(robot, &bring_up), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_get_state(robot, &state), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_wait(robot, 0, &state), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_reset_odometry(robot, 0.0, 0.0, 0.0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_drive_wheels(robot, 0.0, 0.0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_drive(robot, 0.0, 0.0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_drive_radius(robot, 0.0, 1.0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_rearm(robot), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_expect_silence(robot, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_next_event(robot, &event), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_get_sensors(robot, &sensors), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_subscribe(robot, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_query(robot, 27, 0, &value), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_leds(robot, 0, 0, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_digital_outputs(robot, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_low_side_drivers(robot, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_pwm_low_side_drivers(robot, 0, 0, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_send_ir(robot, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_song(robot, 0, &note, 1), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_play_song(robot, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_tune(robot, 0, "t:d=4:c", NULL), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_script(robot, "", 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_play_script(robot, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_command(robot, "play 0", 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_raw(robot, &byte, 1, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_get_statistics(robot, &statistics), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_copy_histogram(robot, 0, NULL), CARGOBAY_E_HANDLE, words);
}

static inline void every_sim_function_refuses(struct cargobay_sim* sim, const char* words) {
  char path[64];
  SIZED(cargobay_truth, truth);
  CHECK_FAILS(cargobay_sim_close(sim), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_sim_path(sim, path, sizeof path), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_sim_inject(sim, "state", NULL, 0), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_sim_truth(sim, &truth), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_sim_advance(sim, 0), CARGOBAY_E_HANDLE, words);
}

static inline void every_histogram_function_refuses(struct cargobay_histogram* histogram,
                                                    const char* words) {
  int64_t time_ns = 0;
  SIZED(cargobay_distribution, held);
  CHECK_FAILS(cargobay_histogram_close(histogram), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_histogram_record(histogram, 1), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_histogram_get(histogram, &held), CARGOBAY_E_HANDLE, words);
  CHECK_FAILS(cargobay_histogram_percentile(histogram, 50.0, &time_ns), CARGOBAY_E_HANDLE, words);
}

#endif
