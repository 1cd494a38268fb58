/* Arguments that are NULL, not a number or out of range: each gets CARGOBAY_E_ARGUMENT, and words
 * that say which one it is and what it may be. */
#include <math.h>

#include "check.h"

#define REFUSES(call, words) CHECK_FAILS(call, CARGOBAY_E_ARGUMENT, words)

/* A member at a value that it must not have, then back at its default. */
#define REFUSES_OPTION(member, value, words)          \
  do {                                                \
    struct cargobay_robot* robot_ = NULL;             \
    options.member = value;                           \
    REFUSES(cargobay_open(&options, &robot_), words); \
    CHECK(robot_ == NULL);                            \
    options.member = 0;                               \
  } while (0)
#define REFUSES_SIM_OPTION(member, value, words)        \
  do {                                                  \
    struct cargobay_sim* sim_ = NULL;                   \
    options.member = value;                             \
    REFUSES(cargobay_sim_open(&options, &sim_), words); \
    CHECK(sim_ == NULL);                                \
    options.member = 0;                                 \
  } while (0)

static void of_open(struct cargobay_sim* sim) {
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_options, options);
  REFUSES(cargobay_open(NULL, NULL), "`robot` is NULL");
  options.size = 0;
  REFUSES(cargobay_open(&options, &robot), "`size`");
  options.size = sizeof options;
  options.flags = 1u << 31;
  REFUSES(cargobay_open(&options, &robot), "`flags`");
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.sim = sim;
  options.port = "/dev/ttyS0";
  REFUSES(cargobay_open(&options, &robot), "`sim`");
  options.port = NULL;
  REFUSES_OPTION(mode, CARGOBAY_MODE_PASSIVE, "`mode`");
  REFUSES_OPTION(baud, 12345, "`baud`");
  REFUSES_OPTION(priority, 99, "`priority`");
  REFUSES_OPTION(port_fd, 2, "`port_fd`");
  REFUSES_OPTION(port_fd, -1, "`port_fd`");
  REFUSES_OPTION(control_overruns, 1000001, "`control_overruns`");
  REFUSES_OPTION(setpoint_lapse_ns, 19999999, "`setpoint_lapse_ns`");
  REFUSES_OPTION(setpoint_lapse_ns, SECONDS(61), "`setpoint_lapse_ns`");
  REFUSES_OPTION(control_budget_ns, 9999, "`control_budget_ns`");
  REFUSES_OPTION(control_budget_ns, -1, "`control_budget_ns`");
  REFUSES_OPTION(link_timeout_ns, SECONDS(0.1), "`link_timeout_ns`");
  REFUSES_OPTION(guard_deadline_ns, SECONDS(0.01), "`guard_deadline_ns`");
  REFUSES_OPTION(acceleration_mm_s2, NAN, "`acceleration_mm_s2`");
  REFUSES_OPTION(acceleration_mm_s2, -1.0, "`acceleration_mm_s2`");
  REFUSES_OPTION(jerk_mm_s3, NAN, "`jerk_mm_s3`");
  REFUSES_OPTION(wheel_base_mm, 0.258, "`wheel_base_mm`");
  REFUSES_OPTION(distance_scale, 3.0, "`distance_scale`");
  REFUSES_OPTION(turn_scale, INFINITY, "`turn_scale`");
  REFUSES_OPTION(remainder, 3, "`remainder`");
  REFUSES_OPTION(remainder, -2, "`remainder`");
  options.flags |= CARGOBAY_FLAG_PIN_CPU;
  REFUSES_OPTION(cpu, 1024, "`cpu`");
  options.flags = CARGOBAY_FLAG_NO_CONFIG | CARGOBAY_FLAG_REQUIRE_REALTIME;
  options.flags |= CARGOBAY_FLAG_NO_REALTIME;
  REFUSES(cargobay_open(&options, &robot), "real-time rights");
  CHECK(robot == NULL);
}

static void of_sim(struct cargobay_sim* sim) {
  char text[100];
  SIZED(cargobay_sim_options, options);
  REFUSES(cargobay_sim_open(NULL, NULL), "`sim` is NULL");
  REFUSES_SIM_OPTION(gain_left, 1.51, "`gain_left`");
  REFUSES_SIM_OPTION(gain_right, 0.09, "`gain_right`");
  REFUSES_SIM_OPTION(lag_ns, 999999, "`lag_ns`");
  REFUSES_SIM_OPTION(lag_ns, -1, "`lag_ns`");
  REFUSES_SIM_OPTION(noise_mm_s, 101.0, "`noise_mm_s`");
  REFUSES_SIM_OPTION(wheel_base_mm, 49.0, "`wheel_base_mm`");
  REFUSES_SIM_OPTION(boot_baud, 1, "`boot_baud`");
  REFUSES_SIM_OPTION(plant, "sloth", "`plant`: unknown plant or value 'sloth'");
  REFUSES_SIM_OPTION(plant, "lag 100",
                     "`plant`: lag is in seconds, 0.001 to 1; milliseconds? did you mean 0.1");
  REFUSES_SIM_OPTION(time, 2, "`time`");
  REFUSES_SIM_OPTION(remainder, 3, "`remainder`");
  options.time = CARGOBAY_SIM_TIME_VIRTUAL;
  REFUSES_SIM_OPTION(link, "/tmp/none", "no pseudo-terminal");
  REFUSES(cargobay_sim_inject(sim, "dance", text, sizeof text), "dance");
  REFUSES(cargobay_sim_inject(sim, NULL, NULL, 0), "`line`");
  REFUSES(cargobay_sim_get_truth(sim, NULL), "NULL");
  REFUSES(cargobay_sim_advance(sim, -1), "negative");
  REFUSES(cargobay_sim_get_path(sim, NULL, 0), "`path`");
}

static void of_driving(struct cargobay_robot* robot) {
  const struct cargobay_twist twist = {0.0, 0.0};
  const struct cargobay_twist no_twist = {NAN, 0.0};
  struct cargobay_wheels wheels;
  SIZED(cargobay_state, state);
  REFUSES(cargobay_drive_wheels(robot, 501.0, 0.0), "500 mm/s");
  REFUSES(cargobay_drive_wheels(robot, 0.0, NAN), "not a number");
  REFUSES(cargobay_drive(robot, NAN, 0.0), "not a number");
  REFUSES(cargobay_drive(robot, 0.0, INFINITY), "not a number");
  REFUSES(cargobay_drive_radius(robot, 100.0, NAN), "INFINITY");
  REFUSES(cargobay_wheels_of(robot, twist, NULL), "`wheels`");
  REFUSES(cargobay_wheels_of(robot, no_twist, &wheels), "not a number");
  REFUSES(cargobay_reset_odometry(robot, NAN, 0.0, 0.0), "not a number");
  REFUSES(cargobay_reset_odometry(robot, 0.0, 1.1e9, 0.0), "1e9");
  REFUSES(cargobay_expect_silence(robot, -1), "negative");
  REFUSES(cargobay_get_state(robot, NULL), "NULL");
  REFUSES(cargobay_get_history(robot, -1, NULL, 1), "NULL");
  REFUSES(cargobay_get_history(robot, -1, &state, 0), "1 to 256");
  REFUSES(cargobay_get_history(robot, -1, &state, 257), "1 to 256");
  REFUSES(cargobay_get_end(robot, NULL), "NULL");
  REFUSES(cargobay_save_recording(robot, NULL), "`path`");
}

static void of_reading(struct cargobay_robot* robot) {
  static const uint32_t packets[65] = {CARGOBAY_PACKET_WALL};
  struct cargobay_reading readings[65];
  REFUSES(cargobay_get_readings(robot, NULL, 1, readings), "`packets`");
  REFUSES(cargobay_get_readings(robot, packets, 1, NULL), "`readings`");
  REFUSES(cargobay_get_readings(robot, packets, 0, readings), "1 to 64");
  REFUSES(cargobay_get_readings(robot, packets, 65, readings), "1 to 64");
  REFUSES(cargobay_subscribe(robot, NULL, 1), "`packets`");
  REFUSES(cargobay_subscribe(robot, packets, 65), "1 to 64");
  REFUSES(cargobay_unsubscribe(robot, packets, 0), "1 to 64");
  REFUSES(cargobay_query(robot, CARGOBAY_PACKET_DISTANCE, 0, readings), "odometry");
  REFUSES(cargobay_query(robot, CARGOBAY_PACKET_WALL, 0, NULL), "`reading`");
  SIZED(cargobay_setting, setting);
  REFUSES(cargobay_get_setting(0, NULL), "NULL");
  setting.size = 0;
  REFUSES(cargobay_get_setting(0, &setting), "`size`");
  REFUSES(cargobay_get_statistics(robot, NULL), "NULL");
  REFUSES(cargobay_get_learnt(robot, NULL), "NULL");
  REFUSES(cargobay_get_bring_up(robot, NULL), "NULL");
  REFUSES(cargobay_get_info(robot, NULL), "NULL");
  REFUSES(cargobay_get_missing_rights(robot, NULL, 0), "`text`");
}

static void of_commands(struct cargobay_robot* robot) {
  const struct cargobay_note note = {SECONDS(0.25), 60, 0};
  REFUSES(cargobay_store_song(robot, 0, NULL, 1), "`notes`");
  REFUSES(cargobay_store_song(robot, 16, &note, 1), "`slot`");
  REFUSES(cargobay_store_song(robot, 0, &note, 17), "cargobay_store_tune");
  REFUSES(cargobay_store_song(robot, 0, &note, 0), "1 to 16");
  REFUSES(cargobay_play_song(robot, 16), "`slot`");
  REFUSES(cargobay_store_tune(robot, 0, "no tune", NULL, 0), "column");
  REFUSES(cargobay_store_tune(robot, 0, NULL, NULL, 0), "`rtttl`");
  REFUSES(cargobay_store_script(robot, "dance", 0), "dance");
  REFUSES(cargobay_store_script(robot, "leds none 0 0", 2), "`how`");
  REFUSES(cargobay_store_script(robot, NULL, 0), "`text`");
  REFUSES(cargobay_send_command(robot, "drive 100 straight", 0), "for the loop");
  REFUSES(cargobay_send_command(robot, "passive", 0), "passive");
  REFUSES(cargobay_send_command(robot, "start", 0), "for the loop");
  REFUSES(cargobay_send_command(robot, "", 0), "no command");
  REFUSES(cargobay_send_bytes(robot, (const uint8_t*)"\x8b\x00", 2, 0), "whole");
  REFUSES(cargobay_send_bytes(robot, NULL, 2, 0), "`bytes`");
  REFUSES(cargobay_play_script(robot, -1), "negative");
}

static void of_events(struct cargobay_robot* robot) {
  char text[100];
  SIZED(cargobay_event, event);
  REFUSES(cargobay_next_event(robot, 0, NULL), "NULL");
  event.kind = 99;
  REFUSES(cargobay_describe_event(&event, text, sizeof text), "no event");
  REFUSES(cargobay_describe_event(NULL, text, sizeof text), "`event`");
  event.kind = 0;
  REFUSES(cargobay_describe_event(&event, NULL, 0), "`text`");
}

static void of_histograms(struct cargobay_robot* robot) {
  int64_t time_ns = 0;
  struct cargobay_histogram* histogram = NULL;
  REFUSES(cargobay_histogram_open(NULL), "`histogram`");
  CHECK(cargobay_histogram_open(&histogram) == CARGOBAY_OK);
  REFUSES(cargobay_histogram_get(histogram, NULL), "NULL");
  REFUSES(cargobay_histogram_get_percentile(histogram, 101.0, &time_ns), "0 to 100");
  REFUSES(cargobay_histogram_get_percentile(histogram, NAN, &time_ns), "0 to 100");
  REFUSES(cargobay_histogram_get_percentile(histogram, 50.0, NULL), "`time_ns`");
  REFUSES(cargobay_copy_histogram(robot, 2, histogram), "`measure`");
  CHECK(cargobay_histogram_close(histogram) == CARGOBAY_OK);
}

int main(void) {
  struct cargobay_sim* sim = virtual_sim();
  of_open(sim);
  of_sim(sim);
  struct cargobay_robot* robot = robot_of(sim, 0);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  of_driving(robot);
  of_reading(robot);
  of_commands(robot);
  of_events(robot);
  of_histograms(robot);
  /* None of that has done anything. */
  CHECK(run_for(robot, 0.1) == CARGOBAY_OK);
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
  return 0;
}
