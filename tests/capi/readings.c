/* A1: readings by the numbers of their packets; A9: bits that mean the same with every robot; A10:
 * no parameter wraps; A11: no more is written than there is room for, and times are in ns. */
#define _POSIX_C_SOURCE 200809L
#include <stdbool.h>

#include "check.h"

struct drive {
  struct cargobay_sim* sim;
  struct cargobay_robot* robot;
};

static struct drive begin(void) {
  struct drive drive = {virtual_sim(), NULL};
  drive.robot = robot_of(drive.sim, 0);
  CHECK(cargobay_start(drive.robot) == CARGOBAY_OK);
  CHECK(run_for(drive.robot, 1.5) == CARGOBAY_OK);
  return drive;
}

static void finish(struct drive drive) {
  CHECK(cargobay_close(drive.robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(drive.sim) == CARGOBAY_OK);
}

static void inject(struct drive drive, const char* line) {
  CHECK(cargobay_sim_inject(drive.sim, line, NULL, 0) >= 0);
}

static struct cargobay_reading reading_of(struct drive drive, uint32_t packet) {
  struct cargobay_reading reading;
  CHECK(cargobay_get_readings(drive.robot, &packet, 1, &reading) == CARGOBAY_OK);
  CHECK(reading.packet == packet);
  return reading;
}

/* Several at once come in the order in which they were asked for, all as of the same frame. */
static void come_in_order(void) {
  const struct drive drive = begin();
  const uint32_t packets[] = {CARGOBAY_PACKET_VOLTAGE, CARGOBAY_PACKET_WALL_SIGNAL,
                              CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS, CARGOBAY_PACKET_OI_MODE,
                              CARGOBAY_PACKET_VOLTAGE};
  struct cargobay_reading readings[6];
  UNSEEN(state);
  inject(drive, "bump right");
  CHECK(run_for(drive.robot, 0.2) == CARGOBAY_OK);
  memset(readings, 0xa5, sizeof readings);
  CHECK(cargobay_get_readings(drive.robot, packets, 5, readings) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  for (int i = 0; i < 5; ++i) CHECK(readings[i].packet == packets[i]);
  CHECK(readings[5].packet == 0xa5a5a5a5); /* no more than was asked for */
  CHECK(readings[0].value == state.battery_mv && readings[0].value > 10000);
  CHECK(readings[1].tick == -1 && readings[1].arrival_ns == 0); /* nobody asked the robot */
  CHECK(readings[2].value == 1 && readings[2].tick > state.tick - 3);
  CHECK(readings[3].value == CARGOBAY_MODE_SAFE && readings[3].tick == state.tick);
  CHECK(readings[3].arrival_ns == state.arrival_ns);
  CHECK(memcmp(&readings[4], &readings[0], sizeof readings[0]) == 0);
  finish(drive);
}

static void are_all_there(void) {
  const struct drive drive = begin();
  uint32_t packets[36];
  struct cargobay_reading readings[36];
  UNSEEN(state);
  for (uint32_t i = 0; i < 36; ++i) packets[i] = CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS + i;
  CHECK(cargobay_subscribe(drive.robot, packets, 36) == CARGOBAY_OK);
  CHECK(run_for(drive.robot, 2.0) == CARGOBAY_OK);
  CHECK(cargobay_get_readings(drive.robot, packets, 36, readings) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  for (int i = 0; i < 36; ++i) {
    const bool of_the_battery = readings[i].packet >= CARGOBAY_PACKET_CHARGING_STATE &&
                                readings[i].packet <= CARGOBAY_PACKET_BATTERY_CAPACITY;
    CHECK(readings[i].tick > state.tick - (of_the_battery ? 140 : 60));
    CHECK(readings[i].arrival_ns > 0);
  }
  CHECK(cargobay_unsubscribe(drive.robot, packets, 36) == CARGOBAY_OK);
  finish(drive);
}

/* How often a packet was reported within two seconds. */
static int reports_of(struct drive drive, uint32_t packet) {
  int count = 0;
  int64_t last = reading_of(drive, packet).tick;
  UNSEEN(state);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  for (int i = 0; i < 133; ++i) {
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
    const int64_t tick = reading_of(drive, packet).tick;
    count += tick != last;
    last = tick;
  }
  return count;
}

/* Two parts of a program that know nothing of each other want the same packet. */
static void subscriptions_are_counted(void) {
  const struct drive drive = begin();
  const uint32_t signals[] = {CARGOBAY_PACKET_WALL_SIGNAL, CARGOBAY_PACKET_ANALOG_SIGNAL};
  const uint32_t wrong[] = {CARGOBAY_PACKET_WALL_SIGNAL, CARGOBAY_PACKET_WALL_SIGNAL, 58};
  CHECK(reports_of(drive, signals[0]) == 0);
  CHECK(cargobay_subscribe(drive.robot, signals, 2) == CARGOBAY_OK); /* the one */
  CHECK(cargobay_subscribe(drive.robot, signals, 1) == CARGOBAY_OK); /* the other */
  CHECK(run_for(drive.robot, 0.3) == CARGOBAY_OK);
  for (int i = 0; i < 2; ++i) {
    const int reports = reports_of(drive, signals[i]);
    CHECK(reports >= 10 && reports <= 61);
  }
  CHECK(cargobay_unsubscribe(drive.robot, signals, 2) == CARGOBAY_OK); /* the one */
  CHECK(run_for(drive.robot, 0.3) == CARGOBAY_OK);
  CHECK(reports_of(drive, signals[0]) >= 10);
  CHECK_FAILS(cargobay_unsubscribe(drive.robot, signals, 2), CARGOBAY_E_ARGUMENT, "subscribed");
  CHECK_FAILS(cargobay_subscribe(drive.robot, wrong, 3), CARGOBAY_E_UNSUPPORTED, "packet");
  CHECK_FAILS(cargobay_unsubscribe(drive.robot, wrong, 3), CARGOBAY_E_UNSUPPORTED, "packet");
  CHECK_FAILS(cargobay_unsubscribe(drive.robot, wrong, 2), CARGOBAY_E_ARGUMENT, "subscribed");
  CHECK(reports_of(drive, signals[0]) >= 10); /* none of these has counted */
  CHECK(cargobay_unsubscribe(drive.robot, signals, 1) == CARGOBAY_OK); /* the other */
  CHECK(run_for(drive.robot, 0.3) == CARGOBAY_OK);
  CHECK(reports_of(drive, signals[0]) == 0 && reports_of(drive, signals[1]) == 0);
  CHECK_FAILS(cargobay_unsubscribe(drive.robot, signals, 1), CARGOBAY_E_ARGUMENT, "subscribed");
  finish(drive);
}

/* A query is sampled after the call, whether the packet is streamed or not. */
static void are_queried(void) {
  const struct drive drive = begin();
  struct cargobay_reading reading;
  UNSEEN(state);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  inject(drive, "analog-in 777");
  CHECK(cargobay_query(drive.robot, CARGOBAY_PACKET_ANALOG_SIGNAL, SECONDS(1), &reading) ==
        CARGOBAY_OK);
  CHECK(reading.value == 777 && reading.packet == CARGOBAY_PACKET_ANALOG_SIGNAL);
  CHECK(reading.tick > state.tick && reading.arrival_ns > state.arrival_ns);
  inject(drive, "analog-in 333");
  CHECK(cargobay_query(drive.robot, CARGOBAY_PACKET_ANALOG_SIGNAL, SECONDS(1), &reading) ==
        CARGOBAY_OK);
  CHECK(reading.value == 333);
  CHECK(cargobay_query(drive.robot, CARGOBAY_PACKET_VOLTAGE, SECONDS(3), &reading) == CARGOBAY_OK);
  CHECK(reading.value > 10000);
  const struct cargobay_reading before = reading;
  CHECK(cargobay_query(drive.robot, CARGOBAY_PACKET_WALL_SIGNAL, 0, &reading) ==
        CARGOBAY_E_TIMEOUT);
  CHECK(memcmp(&reading, &before, sizeof reading) == 0);
  finish(drive);
}

/* The manual's packet 18 has Play in bit 0 and Advance in bit 2, its LEDs have 1 and 3. */
static void bits_begin_at_0(void) {
  const struct drive drive = begin();
  char answer[4096];
  SIZED(cargobay_state, state);
  SIZED(cargobay_event, event);
  inject(drive, "press advance 1000");
  CHECK(run_for(drive.robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(state.buttons == CARGOBAY_BUTTON_ADVANCE && CARGOBAY_BUTTON_ADVANCE == 2);
  inject(drive, "bump both");
  inject(drive, "overcurrent ld1 on");
  CHECK(run_for(drive.robot, 0.3) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  CHECK(state.bumps == (CARGOBAY_BUMP_LEFT | CARGOBAY_BUMP_RIGHT) && state.bumps == 3);
  while (cargobay_next_event(drive.robot, event.sequence, &event) == 1 &&
         event.kind != CARGOBAY_EVENT_OVERCURRENT_BEGAN) {
  }
  CHECK(event.overcurrents == CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_1);
  CHECK(CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_1 == 8);
  CHECK(cargobay_set_leds(drive.robot, CARGOBAY_LED_ADVANCE, 9, 99) == CARGOBAY_OK);
  CHECK(run_for(drive.robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_sim_inject(drive.sim, "state", answer, sizeof answer) > 0);
  CHECK(strstr(answer, "\"advance\":true") != NULL && strstr(answer, "\"play\":false") != NULL);
  finish(drive);
}

#define TOO_LARGE(call)                                                              \
  do {                                                                               \
    static const uint32_t kTooLarge[] = {256, 257, 0x10000, 0x80000000, UINT32_MAX}; \
    for (size_t i_ = 0; i_ < sizeof kTooLarge / sizeof kTooLarge[0]; ++i_) {         \
      const uint32_t value = kTooLarge[i_];                                          \
      CHECK_FAILS(call, CARGOBAY_E_ARGUMENT, "");                                    \
    }                                                                                \
  } while (0)

/* 256 is not 0. */
static void nothing_wraps(void) {
  const struct drive drive = begin();
  struct cargobay_robot* const robot = drive.robot;
  struct cargobay_note note = {SECONDS(0.25), 60, 0};
  TOO_LARGE(cargobay_play_song(robot, value));
  TOO_LARGE(cargobay_set_leds(robot, value, 0, 0));
  TOO_LARGE(cargobay_set_leds(robot, 0, value, 0));
  TOO_LARGE(cargobay_set_leds(robot, 0, 0, value));
  TOO_LARGE(cargobay_set_digital_outputs(robot, value));
  TOO_LARGE(cargobay_set_low_side_drivers(robot, value));
  TOO_LARGE(cargobay_set_pwm_low_side_drivers(robot, value, 0, 0));
  TOO_LARGE(cargobay_set_pwm_low_side_drivers(robot, 0, value, 0));
  TOO_LARGE(cargobay_set_pwm_low_side_drivers(robot, 0, 0, value));
  TOO_LARGE(cargobay_send_ir(robot, value));
  TOO_LARGE(cargobay_store_song(robot, value, &note, 1));
  TOO_LARGE(cargobay_store_tune(robot, value, "t:d=4:c", NULL, 0));
  for (uint32_t number = 256; number != 0; number *= 2) {
    note.number = number;
    CHECK_FAILS(cargobay_store_song(robot, 0, &note, 1), CARGOBAY_E_ARGUMENT, "number");
  }
  note.number = 60;
  note.duration_ns = INT64_C(3984375001);
  CHECK_FAILS(cargobay_store_song(robot, 0, &note, 1), CARGOBAY_E_ARGUMENT, "3984375000");
  note.duration_ns = -1;
  CHECK_FAILS(cargobay_store_song(robot, 0, &note, 1), CARGOBAY_E_ARGUMENT, "3984375000");
  finish(drive);
}

/* No further duration is written than fits, whatever the tune has. */
static void tunes_keep_to_their_room(void) {
  static const char kTune[] = "t:d=8,o=5,b=120:c,d,e,f,g,a,b,c6,d6,e6,f6,g6,a6,b6,c7,d7,e7,f7";
  const struct drive drive = begin();
  int64_t durations[3];
  for (size_t capacity = 0; capacity <= 2; ++capacity) {
    memset(durations, 0xa5, sizeof durations);
    CHECK(cargobay_store_tune(drive.robot, 4, kTune, durations, capacity) == 2);
    CHECK((durations[0] == SECONDS(4)) == (capacity > 0));
    CHECK((durations[1] == SECONDS(0.5)) == (capacity > 1));
    CHECK(durations[2] == (int64_t)UINT64_C(0xa5a5a5a5a5a5a5a5));
    CHECK(run_for(drive.robot, 0.3) == CARGOBAY_OK);
  }
  CHECK(cargobay_store_tune(drive.robot, 4, kTune, NULL, 16) == 2);
  CHECK_FAILS(cargobay_store_tune(drive.robot, 15, kTune, durations, 3), CARGOBAY_E_ARGUMENT, "");
  finish(drive);
}

/* How long a song of 16 such notes plays, by the robot. */
static double plays_s(struct drive drive, int64_t note_ns) {
  struct cargobay_note notes[16];
  char answer[4096];
  int frames = 0;
  UNSEEN(state);
  for (int i = 0; i < 16; ++i) notes[i] = (struct cargobay_note){note_ns, 60, 0};
  CHECK(cargobay_store_song(drive.robot, 2, notes, 16) == CARGOBAY_OK);
  CHECK(cargobay_play_song(drive.robot, 2) == CARGOBAY_OK);
  CHECK(run_for(drive.robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_get_state(drive.robot, &state) == CARGOBAY_OK);
  do {
    CHECK(next_state(drive.robot, &state) == CARGOBAY_OK);
    CHECK(cargobay_sim_inject(drive.sim, "state", answer, sizeof answer) > 0);
    ++frames;
  } while (strstr(answer, "\"song_playing\":true") != NULL);
  return 0.2 + 0.015 * frames;
}

/* To the nearest 64th of a second: 16 notes of 31.4 of them are 7.75 s, of 31.6 they are 8 s. */
static void notes_are_rounded(void) {
  const struct drive drive = begin();
  const double short_s = plays_s(drive, INT64_C(15625000) * 314 / 10);
  const double long_s = plays_s(drive, INT64_C(15625000) * 316 / 10);
  CHECK(short_s > 7.65 && short_s < 7.85);
  CHECK(long_s > 7.9 && long_s < 8.1);
  finish(drive);
}

int main(void) {
  come_in_order();
  are_all_there();
  subscriptions_are_counted();
  are_queried();
  bits_begin_at_0();
  nothing_wraps();
  tunes_keep_to_their_room();
  notes_are_rounded();
  return 0;
}
