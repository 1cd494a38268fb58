/* The robot in GLib's main loop, which GTK and GStreamer programs have too, beside a timer and
 * Ctrl-C. */
#include <cargobay.h>
#include <unistd.h>

#include <glib-unix.h>

struct drive {
  GMainLoop* loop;
  struct cargobay_robot* robot;
  struct cargobay_state state;
  int error;
};

static gboolean frame_came(gint fd, GIOCondition condition, gpointer data) {
  struct drive* drive = data;
  guint64 ignored;
  (void)condition;
  if (read(fd, &ignored, sizeof ignored) < 0) return G_SOURCE_CONTINUE; /* nothing new */
  int error = cargobay_wait(drive->robot, drive->state.tick, 0, &drive->state);
  if (error == CARGOBAY_E_TIMEOUT) return G_SOURCE_CONTINUE; /* an event, and no frame */
  if (error == 0) error = cargobay_drive(drive->robot, 150.0, 0.0);
  drive->error = error;
  if (error != 0 || drive->state.robot_time_ns >= 2000000000) g_main_loop_quit(drive->loop);
  return G_SOURCE_CONTINUE;
}

static gboolean report(gpointer data) {
  const struct drive* drive = data;
  g_print("%.0f mm ahead\n", drive->state.x_mm);
  return G_SOURCE_CONTINUE;
}

static gboolean stop(gpointer loop) {
  g_main_loop_quit(loop);
  return G_SOURCE_CONTINUE;
}

int main(int argc, char** argv) {
  const struct cargobay_options options = {.size = sizeof options,
                                           .flags = argc > 1 ? 0u : CARGOBAY_FLAG_NO_CONFIG,
                                           .port = argc > 1 ? argv[1] : NULL};
  struct drive drive = {.state = {.size = sizeof drive.state, .tick = -1}};
  drive.error = cargobay_open(&options, &drive.robot);
  if (drive.error == 0) drive.error = cargobay_start(drive.robot);
  if (drive.error == 0) {
    drive.loop = g_main_loop_new(NULL, FALSE);
    const guint frames = g_unix_fd_add(cargobay_get_fd(drive.robot), G_IO_IN, frame_came, &drive);
    g_timeout_add(500, report, &drive);
    g_unix_signal_add(SIGINT, stop, drive.loop);
    g_main_loop_run(drive.loop);
    g_source_remove(frames); /* before the robot is closed, and its descriptor with it */
    g_main_loop_unref(drive.loop);
    if (drive.error == 0) drive.error = cargobay_end(drive.robot);
  }
  if (drive.error != 0) g_printerr("%s\n", cargobay_error_message());
  cargobay_close(drive.robot);
  return drive.error != 0;
}
