/* A robot that a program drives and others watch through its feed (docs/feed.md). */
#define _GNU_SOURCE
#include <dirent.h>
#include <signal.h>
#include <stdbool.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

#include "check.h"

/* Where the feeds of this test are. */
static char folder[] = "/tmp/cargobay_publish_XXXXXX";

/* The path of the only socket there; false if there is none. */
static bool find_socket(char* path, size_t size) {
  DIR* const listing = opendir(folder);
  bool found = false;
  CHECK(listing != NULL);
  for (struct dirent* entry; (entry = readdir(listing)) != NULL;) {
    if (entry->d_name[0] == '.') continue;
    CHECK(!found);
    found = true;
    CHECK(snprintf(path, size, "%s/%s", folder, entry->d_name) < (int)size);
  }
  closedir(listing);
  return found;
}

struct watcher {
  int socket;
  FILE* lines;
};

static struct watcher attach(void) {
  const struct timeval patience = {.tv_sec = 10};
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  struct watcher watcher;
  CHECK(find_socket(address.sun_path, sizeof address.sun_path));
  watcher.socket = socket(AF_UNIX, SOCK_STREAM, 0);
  CHECK(setsockopt(watcher.socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience) == 0);
  CHECK(connect(watcher.socket, (struct sockaddr*)&address, sizeof address) == 0);
  watcher.lines = fdopen(watcher.socket, "r");
  CHECK(watcher.lines != NULL);
  return watcher;
}

/* Reads until a message has both. */
static void expect(struct watcher* watcher, const char* one, const char* other) {
  static char line[1 << 16];
  do {
    CHECK(fgets(line, sizeof line, watcher->lines) != NULL);
  } while (strstr(line, one) == NULL || strstr(line, other) == NULL);
}

static void is_watched_from_start_to_close(void) {
  static const char kStop[] = "{\"do\":\"stop\",\"id\":1}\n";
  char path[200];
  struct cargobay_sim* sim = NULL;
  struct cargobay_robot* robot;
  struct watcher watcher;
  pid_t child;
  SIZED(cargobay_sim_options, options);
  CHECK(cargobay_sim_open(&options, &sim) == CARGOBAY_OK);
  robot = robot_of(sim, CARGOBAY_FLAG_NO_REALTIME);
  CHECK(!find_socket(path, sizeof path)); /* nothing is published unless it is asked for */
  CHECK(cargobay_close(robot) == CARGOBAY_OK);

  robot = robot_of(sim, CARGOBAY_FLAG_NO_REALTIME | CARGOBAY_FLAG_PUBLISH);
  watcher = attach();
  expect(&watcher, "\"type\":\"hello\"", "\"steerable\":false");
  for (int start = 0; start < 2; ++start) {
    CHECK(cargobay_start(robot) == CARGOBAY_OK);
    expect(&watcher, "\"stage\":\"driving\"", "");
    expect(&watcher, "\"type\":\"state\"", "\"mode\":\"safe\"");
    expect(&watcher, "\"type\":\"truth\"", "");
    CHECK(write(watcher.socket, kStop, sizeof kStop - 1) == (ssize_t)(sizeof kStop - 1));
    expect(&watcher, "\"id\":1,\"ok\":false", "drives by itself");
    CHECK(cargobay_end(robot) == CARGOBAY_OK);
    expect(&watcher, "\"stage\":\"lost\"", "");
  }
  /* A forked child does not keep the watcher's connection. */
  child = fork();
  if (child == 0) {
    alarm(60);
    for (;;) pause();
  }
  CHECK(child > 0);
  CHECK(cargobay_close(robot) == CARGOBAY_OK);
  expect(&watcher, "\"stage\":\"ended\"", "\"text\":\"\"");
  CHECK(fgetc(watcher.lines) == EOF && feof(watcher.lines));
  fclose(watcher.lines);
  CHECK(kill(child, SIGKILL) == 0 && waitpid(child, NULL, 0) == child);
  CHECK(!find_socket(path, sizeof path));
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

static void says_why_it_cannot_be_watched(void) {
  struct cargobay_robot* robot = NULL;
  struct cargobay_sim* sim = virtual_sim();
  SIZED(cargobay_options, options);
  options.flags = CARGOBAY_FLAG_NO_CONFIG | CARGOBAY_FLAG_PUBLISH;
  options.sim = sim;
  CHECK(setenv("CARGOBAY_FEED_DIR", "/proc/none", 1) == 0);
  CHECK_FAILS(cargobay_open(&options, &robot), CARGOBAY_E_FILE, "CARGOBAY_FEED_DIR");
  CHECK(robot == NULL);
  CHECK(cargobay_sim_close(sim) == CARGOBAY_OK);
}

int main(void) {
  CHECK(mkdtemp(folder) != NULL);
  CHECK(setenv("CARGOBAY_FEED_DIR", folder, 1) == 0);
  is_watched_from_start_to_close();
  CHECK(rmdir(folder) == 0);
  says_why_it_cannot_be_watched();
  return 0;
}
