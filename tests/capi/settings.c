/* A12: 0 is the default, and negative is none, whatever a file says; A13: the pins of a file belong
 * to its own port, a virtual Create reads no file unless told, and settings come as text, too. */
#define _GNU_SOURCE
#include <math.h>
#include <stdbool.h>
#include <unistd.h>

#include "check.h"

static char folder[] = "/tmp/cargobay-capi-XXXXXX";
static char file[64];

static void write_file(const char* text) {
  FILE* out = fopen(file, "w");
  CHECK(out != NULL && fputs(text, out) >= 0 && fclose(out) == 0);
}

static struct cargobay_options options_with(struct cargobay_sim* sim, const char* settings) {
  SIZED(cargobay_options, options);
  options.sim = sim;
  options.settings = settings;
  return options;
}

/* How much faster a wheel gets in its first and its second tick. */
struct slew {
  double first_mm_s;
  double second_mm_s;
};

static struct slew slew_with(struct cargobay_options options) {
  struct cargobay_robot* robot = NULL;
  struct slew slew;
  UNSEEN(state);
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(run_for(robot, 0.2) == CARGOBAY_OK);
  CHECK(cargobay_get_state(robot, &state) == CARGOBAY_OK && state.limited.left_mm_s == 0.0);
  CHECK(cargobay_drive_wheels(robot, 400.0, 400.0) == CARGOBAY_OK);
  CHECK(next_state(robot, &state) == CARGOBAY_OK);
  slew.first_mm_s = state.limited.left_mm_s;
  CHECK(next_state(robot, &state) == CARGOBAY_OK);
  slew.second_mm_s = state.limited.left_mm_s - slew.first_mm_s;
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  return slew;
}

static bool near(double value, double wanted) { return fabs(value - wanted) < 1e-6; }

/* The file, over it the text, over that the members. */
static void come_one_over_the_other(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_options options = options_with(sim, NULL);
  CHECK(near(slew_with(options).first_mm_s, 15.0)); /* 1000 mm/s^2 */
  write_file("[robot]\nacceleration_mm_s2 = 100\n");
  CHECK(near(slew_with(options).first_mm_s, 15.0)); /* nobody named the file */
  options.config = file;
  CHECK(near(slew_with(options).first_mm_s, 1.5));
  options.settings = "[robot]\nacceleration_mm_s2 = 200\n";
  CHECK(near(slew_with(options).first_mm_s, 3.0));
  options.acceleration_mm_s2 = 300.0;
  CHECK(near(slew_with(options).first_mm_s, 4.5));
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  options.config = NULL;
  options.acceleration_mm_s2 = 0.0;
  CHECK(near(slew_with(options).first_mm_s, 3.0)); /* the text is no file */
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void negative_is_none(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  struct cargobay_options options =
      options_with(sim, "[robot]\njerk_mm_s3 = 1000\nremainder = \"lost\"\n");
  UNSEEN(state);
  struct slew slew = slew_with(options);
  CHECK(slew.first_mm_s < 2.0 && slew.second_mm_s > slew.first_mm_s);
  options.jerk_mm_s3 = -1.0;
  slew = slew_with(options);
  CHECK(near(slew.first_mm_s, 15.0) && near(slew.second_mm_s, 15.0));
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK && next_state(robot, &state) == CARGOBAY_OK);
  CHECK(state.remainder == CARGOBAY_REMAINDER_LOST);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  options.remainder = CARGOBAY_REMAINDER_FIND_OUT;
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  state.tick = -1;
  CHECK(cargobay_start(robot) == CARGOBAY_OK && next_state(robot, &state) == CARGOBAY_OK);
  CHECK(state.remainder == CARGOBAY_REMAINDER_UNKNOWN);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* ---- real time, or none of it ---- */

/* kB of this process that may not be swapped out. */
static long locked_kb(void) {
  char line[200];
  long locked = -1;
  FILE* status = fopen("/proc/self/status", "r");
  CHECK(status != NULL);
  while (fgets(line, sizeof line, status) != NULL) {
    if (strncmp(line, "VmLck:", 6) == 0) locked = atol(line + 6);
  }
  CHECK(fclose(status) == 0 && locked >= 0);
  return locked;
}

static struct cargobay_statistics realtime_with(struct cargobay_options options, long* locked) {
  struct cargobay_robot* robot = NULL;
  SIZED(cargobay_statistics, counted);
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_start(robot) == CARGOBAY_OK);
  CHECK(cargobay_wait(robot, -1, SECONDS(5), NULL) == CARGOBAY_OK);
  CHECK(cargobay_get_statistics(robot, &counted) == CARGOBAY_OK);
  *locked = locked_kb();
  CHECK(cargobay_end(robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  return counted;
}

static void may_do_without_real_time(void) {
  const long before = locked_kb();
  long locked = 0;
  struct cargobay_options options = options_with(NULL, "realtime.priority = 70");
  options.flags = CARGOBAY_FLAG_NO_CONFIG;
  struct cargobay_statistics counted = realtime_with(options, &locked);
  if (counted.scheduler == 1) CHECK(counted.priority == 70);
  /* A sanitizer makes nothing of mlockall(). */
  if (getenv("CARGOBAY_SANITIZED") == NULL)
    CHECK((counted.memory_locked == 1) == (locked > before));
  CHECK(locked_kb() == before); /* A17: the last close unlocks what the library locked */
  options.priority = -1;
  counted = realtime_with(options, &locked);
  CHECK(counted.scheduler == 0 && counted.priority == 0);
  options.priority = 0;
  options.flags |= CARGOBAY_FLAG_NO_REALTIME;
  options.settings = "[realtime]\npriority = 70\nrequire = true\n";
  counted = realtime_with(options, &locked);
  CHECK(counted.scheduler == 0 && counted.priority == 0 && counted.memory_locked == 0);
  CHECK(locked == before);
}

/* ---- which file, which pins ---- */

static void pins_belong_to_their_port(void) {
  char text[300];
  char path[64];
  struct cargobay_sim* sim = NULL;
  struct cargobay_robot* robot = NULL;
  struct cargobay_options options = options_with(NULL, NULL);
  CHECK(cargobay_sim_open(NULL, &sim) == CARGOBAY_OK);
  CHECK(cargobay_sim_get_path(sim, path, sizeof path) > 5);
  options.config = file;
  options.port = path;
  write_file("port = \"/dev/ttyOTHER\"\n[pins.brc]\nchip = \"no-such-chip\"\nline = 17\n");
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK); /* the other's pins are left alone */
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  snprintf(text, sizeof text, "port = \"%s\"\n[pins.brc]\nchip = \"no-such-chip\"\nline = 17\n",
           path);
  write_file(text);
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_PIN, "no-such-chip");
  options.port = NULL;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_PIN, "no-such-chip");
  CHECK(robot == NULL && cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void a_sim_reads_no_file(void) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  struct cargobay_options options = options_with(sim, NULL);
  CHECK(setenv("XDG_CONFIG_HOME", folder, 1) == 0);
  write_file("this is no TOML\n");
  CHECK(cargobay_open(&options, &robot) == CARGOBAY_OK);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  options.config = file;
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_CONFIG, file);
  options.config = NULL;
  options.sim = NULL; /* a virtual Create of its own, unless the file names a port */
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_CONFIG, file);
  CHECK(unsetenv("XDG_CONFIG_HOME") == 0 && robot == NULL);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

/* ---- text ---- */

static void refuses(const char* settings, const char* words) {
  struct cargobay_sim* sim = virtual_sim();
  struct cargobay_robot* robot = NULL;
  const struct cargobay_options options = options_with(sim, settings);
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_CONFIG, words);
  CHECK(strstr(cargobay_error_message(), "settings") != NULL); /* whose text it is */
  CHECK(robot == NULL && cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void explains_wrong_text(void) {
  refuses("[robot]\nwheelbase_mm = 258\n", "wheel_base_mm"); /* the nearest key */
  refuses("[robot]\nwheel_base_mm = 0.258\n", "50 to 1000");
  refuses("[robot]\n\n\nwheel_base_mm = \"wide\"\n", "4"); /* the line */
  refuses("[robot\n", "1");
  refuses("realtime.require = 3\n", "require");
}

/* ---- the list ---- */

static int opens_with_text(struct cargobay_sim* sim, const struct cargobay_setting* setting,
                           const char* value) {
  char text[300];
  struct cargobay_robot* robot = NULL;
  snprintf(text, sizeof text, "%s%s%s = %s\n", setting->table,
           strlen(setting->table) > 0 ? "." : "", setting->key, value);
  const struct cargobay_options options = options_with(sim, text);
  const int error = cargobay_open(&options, &robot);
  if (robot != NULL) CHECK(cargobay_close(robot) == CARGOBAY_OK);
  return error;
}

static int opens_with(struct cargobay_sim* sim, const struct cargobay_setting* setting,
                      double value) {
  char text[50];
  snprintf(text, sizeof text, "%.9g", value);
  return opens_with_text(sim, setting, text);
}

/* Each key with its range, which is the one that counts. */
static void are_listed(void) {
  struct cargobay_sim* sim = virtual_sim();
  uint32_t count = 0;
  int ranges = 0;
  int known = 0;
  int got = CARGOBAY_OK;
  SIZED(cargobay_setting, setting);
  for (; (got = cargobay_get_setting(count, &setting)) == CARGOBAY_OK; ++count) {
    CHECK(strlen(setting.key) > 2 && strlen(setting.words) > 10);
    CHECK(setting.table != NULL && setting.unit != NULL && strlen(setting.default_value) > 0);
    CHECK(strchr(setting.words, '\n') == NULL && setting.reserved == 0);
    if (strcmp(setting.key, "acceleration_mm_s2") == 0) {
      CHECK(strcmp(setting.table, "robot") == 0 && strcmp(setting.unit, "mm/s^2") == 0);
      CHECK(setting.least == 10.0 && setting.most == 100000.0);
      CHECK(strcmp(setting.default_value, "1000") == 0);
      ++known;
    }
    if (strcmp(setting.key, "port") == 0) {
      CHECK(strcmp(setting.table, "") == 0 && setting.least == 0.0 && setting.most == 0.0);
      ++known;
    }
    CHECK(opens_with_text(sim, &setting, setting.example) == CARGOBAY_OK);
    CHECK(opens_with_text(sim, &setting, "{}") == CARGOBAY_E_CONFIG);
    if (setting.least >= setting.most) continue;
    ++ranges;
    if (strcmp(setting.key, "baud") == 0) continue; /* not every number in it is a rate */
    CHECK(opens_with(sim, &setting, setting.least) == CARGOBAY_OK);
    CHECK(opens_with(sim, &setting, setting.most) == CARGOBAY_OK);
    CHECK(opens_with(sim, &setting, setting.most * 1.5 + 1.0) == CARGOBAY_E_CONFIG);
    CHECK(opens_with(sim, &setting, setting.least / 1.5 - 1.0) == CARGOBAY_E_CONFIG);
    char* rest = NULL;
    const double usual = strtod(setting.default_value, &rest);
    CHECK(*rest != '\0' || (usual >= setting.least && usual <= setting.most));
  }
  CHECK(got == CARGOBAY_ENDED && count >= 12 && ranges >= 6 && known == 2);
  CHECK(cargobay_get_setting(UINT32_MAX, &setting) == CARGOBAY_ENDED);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

int main(void) {
  CHECK(mkdtemp(folder) != NULL);
  snprintf(file, sizeof file, "%s/cargobay.toml", folder);
  come_one_over_the_other();
  negative_is_none();
  may_do_without_real_time();
  pins_belong_to_their_port();
  a_sim_reads_no_file();
  explains_wrong_text();
  are_listed();
  CHECK(unlink(file) == 0 && rmdir(folder) == 0);
  return 0;
}
