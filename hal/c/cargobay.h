/**
 * @file cargobay.h
 * The C API of Cargobay: a real-time control loop for the iRobot Create (2006) and its Open
 * Interface ("OI"), and a virtual Create to try everything on.
 *
 *     struct cargobay_options options = {.size = sizeof options, .port = "/dev/ttyUSB0"};
 *     struct cargobay_robot *robot;
 *     if (cargobay_open(&options, &robot) != 0) return complain(cargobay_error_message());
 *     cargobay_start(robot);
 *     cargobay_drive(robot, 200.0, 0.0);
 *     ...
 *     cargobay_close(robot);
 *
 * @section life Life of a robot
 * cargobay_open() opens the port and brings the robot up; the robot stands still. cargobay_start()
 * starts the loop. From then on you drive it either with setpoints (cargobay_drive() and its like),
 * which lapse after half a second unless renewed, or with a control function, which the loop calls
 * once a frame, every 15 ms. cargobay_stop() ends the loop and leaves the robot stopped, in Passive
 * mode; cargobay_close() frees everything else. If the loop ends by itself (the link is lost, the
 * robot has left its mode, ...), it stops the robot first; cargobay_wait() and cargobay_stop() say
 * why it ended.
 *
 * Without a port the robot is a virtual Create on a pseudo-terminal, in real time; everything works
 * as it does with a real robot. With `sim` the robot is the virtual Create that you opened, which
 * may run in virtual time. There is no control thread then: cargobay_wait() advances time frame by
 * frame, calls the control function itself, and returns as soon as the result is computed. That
 * makes unit tests of a controller possible.
 *
 * @section errors Errors
 * Functions return 0, or a negative enum cargobay_error; a few return a count or a length instead
 * of 0, and say so. Each code has one culprit. cargobay_error_message() returns one line for a
 * person: what failed, and what to do about it. A failed call changes nothing unless documented
 * otherwise. The library never prints, exits, or installs a signal handler.
 *
 * @section sizes Structs that grow
 * A struct whose first member is `size` may gain members at its end in a later version. Set `size`
 * to sizeof the struct, and every member that you do not use to 0, which always means the default.
 * If the program is older than the library, its struct is shorter: the missing members count as 0
 * on the way in and are not written on the way out. If the program is newer, its struct is longer:
 * the members that this library does not know must be 0 on the way in (else CARGOBAY_E_ARGUMENT),
 * and are set to 0 on the way out. A `size` below 4, or more than 4096 bytes above that of this
 * library's struct, was never set: CARGOBAY_E_ARGUMENT, and nothing is read or written. The `state`
 * passed to a control function has the size that this library knows: a program compiled against a
 * newer header checks its `size` first.
 *
 * @section threads Threads
 * Each function says which threads may call it:
 * - *any thread*: several threads at once, too, and the control function. Those that are also
 *   *real-time safe* do not block, lock, allocate or enter the kernel.
 * - *owner*: one thread at a time, and not the control function; otherwise CARGOBAY_E_STATE.
 *
 * In virtual time, all functions of a robot and its virtual Create are for one thread at a time.
 * A handle that is NULL, was closed, is of another kind (a virtual Create's instead of a robot's)
 * or belongs to the parent of a forked process is recognised: CARGOBAY_E_HANDLE. Close handles
 * before the process ends, or its guard will stop the robot.
 *
 * @section callbacks The control function
 * The control function runs on the control thread, at real-time priority if that was granted,
 * within a budget of 2 ms (`control_budget_us`). It must not block. If it throws (in C++), the
 * exception goes no further: the wheels stop and the loop ends with CARGOBAY_E_CONTROL.
 *
 * If the control function does not return, or ends its thread, the guard stops the robot after
 * `guard_deadline_ms`; from then on nothing that the loop does reaches the robot. cargobay_wait()
 * returns CARGOBAY_E_STALLED. cargobay_stop() and cargobay_close() stop the robot without the help
 * of the loop, unless the guard already has, and return CARGOBAY_E_STALLED too. If the function has
 * still not returned by then, its thread keeps running, and everything it may come back to is never
 * freed: the robot, its locked memory, and the descriptor of its port, which stays in use. So the
 * function's code and its `context` must stay valid too. The only way to get rid of such a thread
 * is to end the process. In virtual time it is the program's own thread that hangs, in
 * cargobay_wait().
 *
 * @section units Units
 * mm, mm/s, rad, rad/s and ns; sensor packets have the units of the manual. x points ahead, y to
 * the left, angles are counter-clockwise positive. Left comes before right.
 */
#ifndef CARGOBAY_H
#define CARGOBAY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------ version */

/** Version of this header. Major: something was removed or has changed its meaning. */
#define CARGOBAY_VERSION_MAJOR 0
/** Minor: something was added. */
#define CARGOBAY_VERSION_MINOR 1
/** Patch: something was fixed. */
#define CARGOBAY_VERSION_PATCH 0

/**
 * The version of the library in use, "0.1.0"; the macros give the version of the header.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_version(void);

/* ------------------------------------------------------------------------------------- errors */

/** What a function returns when it fails. Codes are never renumbered; new ones may be added. */
enum cargobay_error {
  CARGOBAY_OK = 0,
  CARGOBAY_E_ARGUMENT = -1, /**< the caller: a value is NULL, not a number, or out of range */
  CARGOBAY_E_HANDLE = -2,   /**< the caller: a handle is NULL, closed, or of another kind */
  CARGOBAY_E_STATE = -3,    /**< the caller: called in the wrong order, or on the wrong thread */
  CARGOBAY_E_CONFIG = -4,   /**< the configuration file, or a value in it */
  CARGOBAY_E_SYSTEM = -5,   /**< the machine: memory, threads, files */
  CARGOBAY_E_PORT = -6,     /**< the port or a pin: missing, busy, forbidden, unplugged */
  CARGOBAY_E_RIGHTS = -7,   /**< the machine's settings: required real-time rights not granted */
  CARGOBAY_E_ROBOT = -8,    /**< the robot: it does not answer, or has gone silent */
  CARGOBAY_E_MODE = -9, /**< what the robot met: it left its mode (cliff, wheel drop, charger) */
  CARGOBAY_E_CONTROL = -10, /**< the control function: over its budget too often, or it threw */
  CARGOBAY_E_STALLED = -11, /**< the process: it hung, and its guard stopped the robot */
  CARGOBAY_E_FULL = -12,    /**< the line: no room for this now; try again later */
  CARGOBAY_E_TIMEOUT = -13, /**< nobody: the time ran out first */
  CARGOBAY_E_GUARD = -14    /**< the guard: it died or was suspended, so the robot was stopped */
};

/**
 * The name of a code, as "CARGOBAY_E_PORT"; "CARGOBAY_E_?" for a code this library does not know.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_error_name(int error);

/**
 * Explains the last failed call on this thread, in one line, with the remedy.
 * @return a string that lives until the next failed call on this thread; "" before the first. Any
 * thread.
 */
const char* cargobay_error_message(void);

/* ---------------------------------------------------------------------------- virtual Create */

/** A virtual Create. The program opens and closes it; it outlives the robot that uses it. */
struct cargobay_sim;

/** How time passes for a virtual Create. */
enum cargobay_sim_time {
  CARGOBAY_SIM_REAL = 0,   /**< follows CLOCK_MONOTONIC; reached through a pseudo-terminal */
  CARGOBAY_SIM_VIRTUAL = 1 /**< passes only when advanced; every run is the same */
};

/** What happens to the fraction of a millimetre or degree that reading packet 19 or 20 leaves. */
enum cargobay_remainder {
  CARGOBAY_REMAINDER_UNKNOWN = 0, /**< not known yet; as an option: the loop finds out */
  CARGOBAY_REMAINDER_CARRIED = 1, /**< it counts towards the next reading */
  CARGOBAY_REMAINDER_LOST = 2     /**< it is lost */
};

/** Options of a virtual Create. 0 is the default everywhere. */
struct cargobay_sim_options {
  uint32_t size;      /**< sizeof(struct cargobay_sim_options) */
  int32_t time;       /**< enum cargobay_sim_time */
  uint64_t seed;      /**< of its random noise; 0: 1 */
  int32_t remainder;  /**< enum cargobay_remainder; 0: carried */
  uint32_t boot_baud; /**< rate it uses after power-on: 57600 (0), 19200, ... */
  const char* link;   /**< symbolic link to its pseudo-terminal; NULL: none. Real time only */
  const char* world; /**< file of walls, cliffs and beams (docs/virtual-create.md); NULL: a plain */
  double lag_s;      /**< time constant of the wheels, 0.001 to 10; 0: 0.1 */
  double droop_left; /**< part of the command that the wheel falls short by, 0 to 0.9; 0: 0.06 */
  double droop_right; /**< the same for the right wheel, 0 to 0.9; 0: 0.1 */
  double noise_mm_s;  /**< standard deviation of a wheel's speed, 0 to 100; 0: 1; negative: none */
  double wheel_base_mm; /**< its true wheel base, 50 to 1000; 0: 258 */
};

/** What really happens to a virtual Create; no sensor reports it. */
struct cargobay_truth {
  uint32_t size;                /**< sizeof(struct cargobay_truth) */
  int32_t mode;                 /**< enum cargobay_mode */
  int64_t time_ns;              /**< since the virtual Create was opened */
  double left_mm_s;             /**< speed of the left wheel over the ground */
  double right_mm_s;            /**< speed of the right wheel over the ground */
  double x_mm;                  /**< position */
  double y_mm;                  /**< position */
  double heading_rad;           /**< not wrapped */
  int32_t commanded_left_mm_s;  /**< the last command that it obeyed */
  int32_t commanded_right_mm_s; /**< the last command that it obeyed */
};

/**
 * Opens a virtual Create, switched on, in mode Off. In real time it gets a thread of its own.
 * @param options NULL for the defaults; borrowed for the call.
 * @param sim receives the handle, to be passed to cargobay_sim_close(); NULL after a failure.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_CONFIG if the world cannot be read; CARGOBAY_E_SYSTEM
 * if no pseudo-terminal, link or thread is available. Owner; blocks for some ms, allocates.
 */
int cargobay_sim_open(const struct cargobay_sim_options* options, struct cargobay_sim** sim);

/**
 * Closes a virtual Create. Close the robot that uses it first; otherwise CARGOBAY_E_STATE.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE. Owner; blocks for some ms.
 */
int cargobay_sim_close(struct cargobay_sim* sim);

/**
 * The path of its pseudo-terminal, which any OI client may open: "/dev/pts/3".
 * @param path receives it, NUL-terminated; truncated if it does not fit.
 * @return its full length; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE in virtual
 * time, which has no pseudo-terminal. Any thread; locks.
 */
int cargobay_sim_path(struct cargobay_sim* sim, char* path, size_t path_size);

/**
 * Does something to a virtual Create: presses its buttons, puts things in front of its sensors,
 * makes something go wrong.
 * @param line a command of docs/virtual-create.md: "bump left", "cliff front_left on",
 * "battery 300", "fault lost 0.01", "place 0 0 90", "state".
 * @param answer receives the answer, NUL-terminated, truncated if it does not fit; may be NULL.
 * @return the full length of the answer; CARGOBAY_E_ARGUMENT for a line that it does not know;
 * CARGOBAY_E_HANDLE. Any thread; locks, allocates.
 */
int cargobay_sim_inject(struct cargobay_sim* sim, const char* line, char* answer,
                        size_t answer_size);

/**
 * The true pose, speeds, mode and time of a virtual Create.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread; locks.
 */
int cargobay_sim_truth(struct cargobay_sim* sim, struct cargobay_truth* truth);

/**
 * Lets time pass without a robot: at once in virtual time, by sleeping in real time.
 * @param duration_ns 0 to 86400000000000, a day.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE in virtual time while an open
 * robot uses it: cargobay_wait() advances time then. Owner; in real time blocks for `duration_ns`,
 * or until the virtual Create is closed.
 */
int cargobay_sim_advance(struct cargobay_sim* sim, int64_t duration_ns);

/* ------------------------------------------------------------------------------ open and close */

/** A robot. The program opens and closes it. */
struct cargobay_robot;

/** OI mode, packet 35 (OI p. 6). */
enum cargobay_mode {
  CARGOBAY_MODE_OFF = 0,
  CARGOBAY_MODE_PASSIVE = 1,
  CARGOBAY_MODE_SAFE = 2,
  CARGOBAY_MODE_FULL = 3
};

/** Bits of cargobay_options.flags. */
enum cargobay_flag {
  CARGOBAY_REQUIRE_REALTIME = 1 << 0, /**< CARGOBAY_E_RIGHTS if the kernel refuses one */
  CARGOBAY_NO_GUARD = 1 << 1, /**< no guard process; if this one dies, the wheels keep turning */
  CARGOBAY_HOLD_ON_MODE_LOSS = 1 << 2, /**< the loop goes on but drives nothing: cargobay_rearm() */
  CARGOBAY_OPEN_LOOP = 1 << 3, /**< the command is the setpoint; the estimate plays no part in it */
  CARGOBAY_PIN_CPU = 1 << 4,   /**< the control thread runs on `cpu` only */
  CARGOBAY_NO_CONFIG = 1 << 5  /**< no configuration file is read */
};

/** How to reach and drive a robot. 0 and NULL are the default everywhere. */
struct cargobay_options {
  uint32_t size;    /**< sizeof(struct cargobay_options) */
  uint32_t flags;   /**< bits of enum cargobay_flag */
  const char* port; /**< serial port or pseudo-terminal; NULL: the configuration's or, if it names
                         none, a virtual Create of its own */
  struct cargobay_sim* sim; /**< the robot is this virtual Create; `port` must then be NULL, and
                                 configured pins are left alone */
  const char* config;       /**< configuration file (docs/wiring.md); NULL: /etc/cargobay.toml, then
                                 $XDG_CONFIG_HOME/cargobay.toml over it, whichever of them exist */
  const char* record;       /**< file to record the drive to, for `cargobay replay`; NULL: none.
                                 cargobay_open() opens it; it gets this name once the loop runs */
  uint32_t baud;            /**< baud rate; 0: the configuration's, or 57600 */
  int32_t mode;      /**< mode to drive in: CARGOBAY_MODE_SAFE (or 0) or CARGOBAY_MODE_FULL */
  int32_t remainder; /**< enum cargobay_remainder; 0: the configuration's, or found out */
  int32_t priority;  /**< SCHED_FIFO priority, 1 to 98; 0: the configuration's, or 80 */
  int32_t cpu;       /**< CPU for CARGOBAY_PIN_CPU, 0 to 1023 */
  uint32_t setpoint_lapse_ms; /**< age at which a setpoint lapses, 20 to 60000; 0: 500 */
  uint32_t control_budget_us; /**< for a call of the control function, 10 to 1000000; 0: 2000 */
  uint32_t control_overruns;  /**< in a row that end the loop, 1 to 1000000; 0: 10 */
  uint32_t link_timeout_ms;   /**< silence that ends the loop, 200 to 600000; 0: 1000 */
  uint32_t guard_deadline_ms; /**< after which the guard stops the robot, 40 to 10000; 0: 150 */
  double acceleration_mm_s2;  /**< limit, 1 to 100000; 0: the configuration's, or 1000 */
  double jerk_mm_s3;          /**< limit, 1 to 10000000; 0: the configuration's, or none */
  double wheel_base_mm;       /**< between the wheels, 50 to 1000; 0: the configuration's, or 258 */
  double distance_scale;      /**< true distance per mm reported, 0.5 to 2; 0: the configuration's,
                                   or 1 */
  double turn_scale; /**< true angle per degree reported, 0.5 to 2; 0: the configuration's, or 1 */
  /** Called at each step of the bring-up, on the calling thread. Must not throw. NULL: none. */
  void (*progress)(void* context, const char* step, const char* detail);
  void* progress_context; /**< the `context` passed to `progress` */
};

/**
 * Opens the port and brings the robot up, whatever state it is in. Afterwards the robot stands
 * still, in its mode, and its loop does not run yet. With pins configured, bring-up includes power
 * and baud rate.
 * @param options NULL for the defaults; borrowed for the call, `sim` for the life of the robot.
 * @param robot receives the handle, to be passed to cargobay_close(); NULL after a failure: the
 * robot was then told to stop and go Passive, and nothing is left open.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_CONFIG; CARGOBAY_E_HANDLE for `sim`; CARGOBAY_E_STATE
 * if another robot already uses `sim`; CARGOBAY_E_PORT; CARGOBAY_E_ROBOT; CARGOBAY_E_SYSTEM, also
 * if `record` cannot be written.
 * Owner; blocks for 0.2 s if the robot answers at once, for up to 40 s; allocates.
 */
int cargobay_open(const struct cargobay_options* options, struct cargobay_robot** robot);

/**
 * Stops the robot if it has not been stopped yet, and frees everything. Waits for other threads
 * that are inside a function of this robot.
 * @return 0, also if the loop had ended by itself; CARGOBAY_E_STALLED if the control function has
 * not returned: the robot was stopped and the handle is closed all the same, but not everything is
 * freed (see callbacks above); CARGOBAY_E_HANDLE; CARGOBAY_E_STATE from the control function. Any
 * other thread; blocks for up to 2 s, for 3 s more if another thread is inside cargobay_start(),
 * cargobay_stop() or, in virtual time, cargobay_wait().
 */
int cargobay_close(struct cargobay_robot* robot);

/** The result of the bring-up. */
struct cargobay_bring_up {
  uint32_t size;          /**< sizeof(struct cargobay_bring_up) */
  uint32_t found_baud;    /**< rate at which the robot first answered */
  uint32_t baud;          /**< rate in use now */
  int32_t rate_change;    /**< 0: none was needed, 1: by the BRC pin, 2: by opcode 129 */
  int32_t powered_on;     /**< 1: it was off, and the power toggle turned it on */
  int32_t resynchronised; /**< 1: it was waiting for the rest of a half-sent command */
  int32_t brc_pulses;     /**< number of pulses on the BRC pin */
  int32_t battery_mv;     /**< 0: not reported yet */
  int64_t took_ns;        /**< how long it took */
};

/**
 * How the bring-up went.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread; real-time safe.
 */
int cargobay_get_bring_up(struct cargobay_robot* robot, struct cargobay_bring_up* bring_up);

/* ------------------------------------------------------------------------------------ the state */

/** What makes Safe mode stop the robot (OI p. 6); bits of cargobay_state.hazards. */
enum cargobay_hazard {
  CARGOBAY_WHEEL_DROP_LEFT = 1 << 0,
  CARGOBAY_WHEEL_DROP_RIGHT = 1 << 1,
  CARGOBAY_WHEEL_DROP_FRONT = 1 << 2,
  CARGOBAY_CLIFF_LEFT = 1 << 3,
  CARGOBAY_CLIFF_FRONT_LEFT = 1 << 4,
  CARGOBAY_CLIFF_FRONT_RIGHT = 1 << 5,
  CARGOBAY_CLIFF_RIGHT = 1 << 6,
  CARGOBAY_CHARGER = 1 << 7
};

/** Bits of cargobay_state.bumps. */
enum cargobay_bump { CARGOBAY_BUMP_RIGHT = 1 << 0, CARGOBAY_BUMP_LEFT = 1 << 1 };

/** Wheel speeds, mm/s, -500 to 500 each. */
struct cargobay_wheels {
  double left_mm_s;  /**< of the left wheel */
  double right_mm_s; /**< of the right wheel */
};

/** The state of the loop at one tick. */
struct cargobay_state {
  uint32_t size;      /**< sizeof(struct cargobay_state) */
  int32_t mode;       /**< enum cargobay_mode */
  int64_t tick;       /**< of the robot, 15 ms each, since the first frame */
  int64_t time_ns;    /**< the robot's time at `tick` */
  int64_t arrival_ns; /**< of the frame: CLOCK_MONOTONIC; in virtual time, time since the virtual
                           Create was opened */
  struct cargobay_wheels target;   /**< as requested; 0 if there was no valid request */
  struct cargobay_wheels set;      /**< after the limits of acceleration and jerk */
  struct cargobay_wheels estimate; /**< estimated true speeds */
  struct cargobay_wheels command;  /**< as sent to the robot */
  double velocity_mm_s;            /**< forward speed, of the estimate */
  double turn_rate_rad_s;          /**< of the estimate */
  double x_mm;                     /**< odometry, since the start or cargobay_reset_odometry() */
  double y_mm;                     /**< odometry */
  double heading_rad;              /**< not wrapped */
  double distance_mm;              /**< travelled; driving backwards counts negative */
  double covariance[9];            /**< of x, y, heading, row by row: mm^2, mm rad, rad^2 */
  int32_t remainder;               /**< enum cargobay_remainder: which kind of robot this is */
  int32_t setpoint_lapsed;         /**< 1: it was not renewed in time */
  uint32_t hazards;                /**< bits of enum cargobay_hazard that this frame reports */
  uint32_t bumps;     /**< bits of enum cargobay_bump, as last reported: at most 3 frames ago */
  int32_t battery_mv; /**< as last reported; 0: not yet */
  int32_t reserved;   /**< 0 */
};

/**
 * The state of the newest tick.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_TIMEOUT before the first frame. Any
 * thread; real-time safe.
 */
int cargobay_get_state(struct cargobay_robot* robot, struct cargobay_state* state);

/**
 * Waits for the next frame that this thread has not seen yet. In virtual time, advances time until
 * that frame has been answered.
 * @param timeout_ns 0: does not wait; negative: waits for ever. Real time or, in virtual time,
 * virtual time; a frame that is on its way is then not cut short.
 * @param state receives the newest state; may be NULL.
 * @return 0; CARGOBAY_E_TIMEOUT; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before
 * cargobay_start(), after cargobay_stop(), in the control function, and if cargobay_request_stop()
 * ended the loop. If the loop has ended by itself, the code that cargobay_stop() will return:
 * CARGOBAY_E_ROBOT, CARGOBAY_E_PORT, CARGOBAY_E_MODE, CARGOBAY_E_CONTROL, CARGOBAY_E_STALLED,
 * CARGOBAY_E_GUARD. CARGOBAY_E_STALLED also if the loop has made no progress for
 * `guard_deadline_ms`: its control function does not return, or others took the CPU. Any thread but
 * the control thread; blocks. While a thread waits, the loop makes one more system call per frame.
 */
int cargobay_wait(struct cargobay_robot* robot, int64_t timeout_ns, struct cargobay_state* state);

/**
 * Sets the pose of the odometry, with no uncertainty, from the next frame on.
 * @param x_mm, y_mm -1e9 to 1e9.
 * @param heading_rad -1e6 to 1e6.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start() and
 * after the loop has ended; CARGOBAY_E_FULL. Any thread; locks.
 */
int cargobay_reset_odometry(struct cargobay_robot* robot, double x_mm, double y_mm,
                            double heading_rad);

/* --------------------------------------------------------------------------------------- drive */

/**
 * Computes the wheel speeds. The loop calls it once a frame, on the control thread (see callbacks
 * above), while the robot is in its mode.
 * @param context as passed to cargobay_set_control().
 * @param state of this frame: estimate, odometry, sensors; target, set and command are not decided
 * yet, and 0. Valid during the call.
 * @param wheels the result, 0, 0 on entry. If a speed is not a number or beyond 500 mm/s the wheels
 * stop, and the statistics count it.
 */
typedef void (*cargobay_control)(void* context, const struct cargobay_state* state,
                                 struct cargobay_wheels* wheels);

/**
 * Sets a control function, which the loop calls instead of reading setpoints.
 * @param control NULL: setpoints again.
 * @param context must outlive the loop or, if the function does not return, last until the process
 * ends.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE after cargobay_start(). Owner.
 */
int cargobay_set_control(struct cargobay_robot* robot, cargobay_control control, void* context);

/**
 * Starts the guard and the control thread; in virtual time it only gets ready. Only once.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE if it was started before; CARGOBAY_E_RIGHTS;
 * CARGOBAY_E_SYSTEM if the guard or the thread cannot be started, or the recording cannot be
 * written. After a failure the robot is stopped, in Passive mode, and must be closed. Owner; blocks
 * for some ms, allocates.
 */
int cargobay_start(struct cargobay_robot* robot);

/**
 * Ends the loop, stops the wheels, goes Passive.
 * @return 0 if the loop was asked to end (here or by cargobay_request_stop()) and the robot reports
 * that it is Passive; otherwise why the loop ended: CARGOBAY_E_ROBOT (silent, or did not confirm),
 * CARGOBAY_E_PORT (unplugged), CARGOBAY_E_MODE, CARGOBAY_E_CONTROL, CARGOBAY_E_STALLED,
 * CARGOBAY_E_GUARD, CARGOBAY_E_SYSTEM (the recording could not be written). CARGOBAY_E_HANDLE;
 * CARGOBAY_E_STATE before cargobay_start() and from the control function. A second call returns the
 * same. Owner; blocks for up to 1 s; for up to 2 s if the control function does not return (see
 * callbacks above).
 */
int cargobay_stop(struct cargobay_robot* robot);

/**
 * Asks the loop to end; the wheels stop within a frame. cargobay_stop() must still be called.
 * @return 0; CARGOBAY_E_HANDLE. Any thread; real-time safe, and the only function allowed in a
 * signal handler.
 */
int cargobay_request_stop(struct cargobay_robot* robot);

/**
 * Sets the speed of each wheel. The setpoint lapses after `setpoint_lapse_ms`; the wheels then stop
 * until the next one.
 * @param left_mm_s, right_mm_s -500 to 500.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start(),
 * after the loop has ended, and if a control function is set; CARGOBAY_E_MODE if the robot has lost
 * its mode: the event with the reason follows a few frames later. Any thread; real-time safe.
 */
int cargobay_drive_wheels(struct cargobay_robot* robot, double left_mm_s, double right_mm_s);

/**
 * The same, as velocity and turn rate. CARGOBAY_E_ARGUMENT if a wheel would have to go faster than
 * 500 mm/s.
 * @return as cargobay_drive_wheels().
 */
int cargobay_drive(struct cargobay_robot* robot, double velocity_mm_s, double turn_rate_rad_s);

/**
 * The same, as an arc (OI p. 9): the centre of the robot moves at this velocity around a point
 * `radius_mm` to the left (positive) or right.
 * @param radius_mm INFINITY: straight ahead; 0: turns in place, counter-clockwise if the velocity
 * is positive; the velocity is then that of the wheels.
 * @return as cargobay_drive_wheels().
 */
int cargobay_drive_radius(struct cargobay_robot* robot, double velocity_mm_s, double radius_mm);

/**
 * Converts velocity and turn rate to wheel speeds; needs no robot.
 * @param wheel_base_mm 258 for the Create.
 * @return the speeds, not limited to any range. Any thread; real-time safe.
 */
struct cargobay_wheels cargobay_wheels_of(double velocity_mm_s, double turn_rate_rad_s,
                                          double wheel_base_mm);

/**
 * Tells the robot to go back to its mode after losing it. Only with CARGOBAY_HOLD_ON_MODE_LOSS. An
 * event reports the result.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE if the loop does not run. Any thread; real-time
 * safe.
 */
int cargobay_rearm(struct cargobay_robot* robot);

/**
 * For this long from now, silence of the robot does not count as a lost link: for instance while it
 * plays a script that waits.
 * @param duration_ns 0 to 86400000000000, a day.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE if the loop does not run. Any
 * thread; real-time safe.
 */
int cargobay_expect_silence(struct cargobay_robot* robot, int64_t duration_ns);

/* -------------------------------------------------------------------------------------- events */

/** What happened. Numbers are never reused; new ones may be added. */
enum cargobay_event_kind {
  CARGOBAY_EVENT_MODE_LOST = 0,    /**< the robot left its mode by itself: `mode`, `hazards` */
  CARGOBAY_EVENT_REARMED = 1,      /**< it is back in its mode, as requested */
  CARGOBAY_EVENT_REARM_FAILED = 2, /**< it did not go back: `mode`, `hazards` */
  CARGOBAY_EVENT_BATTERY_LOW = 3,  /**< `voltage_mv`, `charge_mah`, `capacity_mah` */
  CARGOBAY_EVENT_BATTERY_RECOVERED = 4,
  CARGOBAY_EVENT_OVERCURRENT_BEGAN = 5, /**< `overcurrents` */
  CARGOBAY_EVENT_OVERCURRENT_ENDED = 6,
  CARGOBAY_EVENT_CHARGING_BEGAN = 7,
  CARGOBAY_EVENT_CHARGING_ENDED = 8,
  CARGOBAY_EVENT_FRAMES_LOST = 9,    /**< `frames`: how many were damaged or never arrived */
  CARGOBAY_EVENT_SILENCE_BEGAN = 10, /**< the wheels were told to stop */
  CARGOBAY_EVENT_SILENCE_ENDED = 11,
  CARGOBAY_EVENT_SETPOINT_LAPSED = 12, /**< it was not renewed: the wheels stop */
  CARGOBAY_EVENT_CONTROL_REFUSED = 13, /**< the control function asked for impossible speeds */
  CARGOBAY_EVENT_BUMP_BEGAN = 14,      /**< `bumps`: the new ones */
  CARGOBAY_EVENT_BUMP_ENDED = 15,      /**< the last of them has ended */
  CARGOBAY_EVENT_PORT_SHARED = 16 /**< frames are missing, and `process` has the port open too */
};

/** An event. Members that its kind does not name are 0. */
struct cargobay_event {
  uint32_t size;         /**< sizeof(struct cargobay_event) */
  int32_t kind;          /**< enum cargobay_event_kind */
  int64_t tick;          /**< as in cargobay_state */
  int64_t time_ns;       /**< on the clock of cargobay_state.arrival_ns */
  int32_t mode;          /**< enum cargobay_mode */
  uint32_t hazards;      /**< bits of enum cargobay_hazard: the causes; 0 if no sensor says */
  uint32_t overcurrents; /**< as in packet 14 */
  uint32_t frames;       /**< how many */
  uint32_t bumps;        /**< bits of enum cargobay_bump */
  int32_t voltage_mv;    /**< of the battery */
  int32_t charge_mah;    /**< charge of the battery */
  int32_t capacity_mah;  /**< capacity of the battery; 0 with ordinary batteries */
  int32_t process;       /**< its process ID */
  char process_name[16]; /**< the kernel's name for it, NUL-terminated */
  uint32_t reserved;     /**< 0 */
};

/**
 * Takes the oldest event that nobody took yet. 256 are kept; further ones are dropped, and the
 * statistics count them.
 * @return 1 and the event, or 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread; locks.
 */
int cargobay_next_event(struct cargobay_robot* robot, struct cargobay_event* event);

/**
 * Describes an event in one line: "the robot went from its mode to passive: a cliff at the front
 * left". For CARGOBAY_EVENT_PORT_SHARED it adds what to do about the process, if it still runs.
 * @param text receives it, NUL-terminated; truncated if it does not fit.
 * @return its full length; CARGOBAY_E_ARGUMENT. Any thread; allocates.
 */
int cargobay_describe_event(const struct cargobay_event* event, char* text, size_t text_size);

/* ------------------------------------------------------------------------------------- sensors */

/** Lists that the loop may stream in turn, besides the packets that it needs itself; bits. */
enum cargobay_extra {
  CARGOBAY_EXTRA_SIGNALS_LEFT = 1 << 0,  /**< packets 27, 28, 29: wall, cliffs left, front left */
  CARGOBAY_EXTRA_SIGNALS_RIGHT = 1 << 1, /**< packets 30 to 33: cliffs front right, right, inputs */
  CARGOBAY_EXTRA_OUTPUTS = 1 << 2        /**< packets 36 to 42: song, stream, requested speeds */
};

/** Packets by their numbers (OI p. 17 to 21). */
enum cargobay_packet {
  CARGOBAY_PACKET_BUMPS_AND_WHEEL_DROPS = 7,
  CARGOBAY_PACKET_WALL = 8,
  CARGOBAY_PACKET_CLIFF_LEFT = 9,
  CARGOBAY_PACKET_CLIFF_FRONT_LEFT = 10,
  CARGOBAY_PACKET_CLIFF_FRONT_RIGHT = 11,
  CARGOBAY_PACKET_CLIFF_RIGHT = 12,
  CARGOBAY_PACKET_VIRTUAL_WALL = 13,
  CARGOBAY_PACKET_OVERCURRENTS = 14,
  CARGOBAY_PACKET_UNUSED_1 = 15,
  CARGOBAY_PACKET_UNUSED_2 = 16,
  CARGOBAY_PACKET_INFRARED_BYTE = 17,
  CARGOBAY_PACKET_BUTTONS = 18,
  CARGOBAY_PACKET_DISTANCE = 19, /**< as last read by the loop; do not sum it: use the odometry */
  CARGOBAY_PACKET_ANGLE = 20,    /**< the same */
  CARGOBAY_PACKET_CHARGING_STATE = 21,
  CARGOBAY_PACKET_VOLTAGE = 22,
  CARGOBAY_PACKET_CURRENT = 23,
  CARGOBAY_PACKET_BATTERY_TEMPERATURE = 24,
  CARGOBAY_PACKET_BATTERY_CHARGE = 25,
  CARGOBAY_PACKET_BATTERY_CAPACITY = 26,
  CARGOBAY_PACKET_WALL_SIGNAL = 27,
  CARGOBAY_PACKET_CLIFF_LEFT_SIGNAL = 28,
  CARGOBAY_PACKET_CLIFF_FRONT_LEFT_SIGNAL = 29,
  CARGOBAY_PACKET_CLIFF_FRONT_RIGHT_SIGNAL = 30,
  CARGOBAY_PACKET_CLIFF_RIGHT_SIGNAL = 31,
  CARGOBAY_PACKET_DIGITAL_INPUTS = 32,
  CARGOBAY_PACKET_ANALOG_SIGNAL = 33,
  CARGOBAY_PACKET_CHARGING_SOURCES = 34,
  CARGOBAY_PACKET_OI_MODE = 35,
  CARGOBAY_PACKET_SONG_NUMBER = 36,
  CARGOBAY_PACKET_SONG_PLAYING = 37,
  CARGOBAY_PACKET_STREAM_PACKETS = 38,
  CARGOBAY_PACKET_REQUESTED_VELOCITY = 39,
  CARGOBAY_PACKET_REQUESTED_RADIUS = 40,
  CARGOBAY_PACKET_REQUESTED_RIGHT_VELOCITY = 41,
  CARGOBAY_PACKET_REQUESTED_LEFT_VELOCITY = 42,
  CARGOBAY_PACKETS = 43 /**< one more than the last */
};

/**
 * The name of a packet, as "wall_signal"; "" if the number is not that of a single packet.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_packet_name(int packet);

/** The value of each packet, as last reported. */
struct cargobay_sensors {
  uint32_t size;                   /**< sizeof(struct cargobay_sensors) */
  uint32_t reserved;               /**< 0 */
  int32_t value[CARGOBAY_PACKETS]; /**< indexed by packet number, in the manual's units; 0 to 6 are
                                        groups, and unused */
  int32_t reserved_2;              /**< 0 */
  int64_t tick[CARGOBAY_PACKETS];  /**< of the frame that reported it, as in cargobay_state; -1:
                                        none has yet */
};

/**
 * All sensors, as far as frames have reported them. Packets 7 to 26, 34 and 35 are always included:
 * bumps and wheel drops, buttons and the infrared byte in every other frame or more often, the
 * battery every second. For the others use cargobay_subscribe() or cargobay_query().
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_TIMEOUT before the first frame. Any
 * thread; real-time safe.
 */
int cargobay_get_sensors(struct cargobay_robot* robot, struct cargobay_sensors* sensors);

/**
 * Chooses which extra lists are streamed from now on, each of them 5 to 30 times a second.
 * @param extras bits of enum cargobay_extra; 0: none.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE if the loop does not run;
 * CARGOBAY_E_FULL. Any thread; locks.
 */
int cargobay_subscribe(struct cargobay_robot* robot, uint32_t extras);

/**
 * Asks for one packet, and waits for a frame that reports it, sampled after the call.
 * @param packet 7 to 42, except 19 and 20, which the loop reads itself.
 * @param timeout_ns as for cargobay_wait(); about 0.3 s is enough if the line loses nothing.
 * @param value receives it, in the manual's units.
 * @return as cargobay_wait(), and CARGOBAY_E_FULL. Any thread but the control thread; blocks,
 * locks.
 */
int cargobay_query(struct cargobay_robot* robot, int packet, int64_t timeout_ns, int32_t* value);

/* ------------------------------------------------------------------------- outputs and commands */

/** Bits of `leds` for cargobay_leds() (OI p. 9). */
enum cargobay_led { CARGOBAY_LED_PLAY = 1 << 1, CARGOBAY_LED_ADVANCE = 1 << 3 };

/** A note of a song (OI p. 11). */
struct cargobay_note {
  uint8_t number;   /**< MIDI number, 31 (G, 49 Hz) to 127; others are rests */
  uint8_t duration; /**< in 1/64 s */
};

/** Bits of `how` for cargobay_command() and its like. */
enum cargobay_how {
  CARGOBAY_PAUSE_DRIVING = 1 << 0 /**< send the command even if it is too long for the line beside
                                       the loop's own; meanwhile the wheels keep turning as last
                                       commanded */
};

/**
 * @name Commands beside the loop's own
 * Each command waits in a queue of 32 and is sent right after the loop's own command in one of the
 * next frames, one per frame, if it fits in what the line carries beside it: 52 bytes at 57600
 * baud, 12 at 19200. A longer one is sent only while the wheels stand still, or with
 * CARGOBAY_PAUSE_DRIVING; songs that need the pause take it by themselves.
 *
 * They return 0; CARGOBAY_E_ARGUMENT for values out of range; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE
 * if the loop does not run; CARGOBAY_E_MODE if the robot's mode does not allow the command;
 * CARGOBAY_E_FULL if the queue is full, or for a long command while the wheels turn. Any thread;
 * they lock.
 * @{
 */

/** LEDs (OI p. 9). @param leds bits of enum cargobay_led. @param power_color 0 green to 255 red. */
int cargobay_leds(struct cargobay_robot* robot, uint32_t leds, uint8_t power_color,
                  uint8_t power_intensity);
/** Digital Outputs (OI p. 10). @param outputs bits 0 to 2. */
int cargobay_digital_outputs(struct cargobay_robot* robot, uint32_t outputs);
/** Low Side Drivers (OI p. 10). @param drivers bits 0 to 2. */
int cargobay_low_side_drivers(struct cargobay_robot* robot, uint32_t drivers);
/** PWM Low Side Drivers (OI p. 10). @param driver_0, driver_1, driver_2 duty cycle, 0 to 128. */
int cargobay_pwm_low_side_drivers(struct cargobay_robot* robot, uint8_t driver_0, uint8_t driver_1,
                                  uint8_t driver_2);
/** Send IR (OI p. 11): an infrared byte through low side driver 1. */
int cargobay_send_ir(struct cargobay_robot* robot, uint8_t byte);
/** Song (OI p. 11). @param slot 0 to 15. @param count 1 to 16. @param notes borrowed for the call.
 */
int cargobay_song(struct cargobay_robot* robot, uint8_t slot, const struct cargobay_note* notes,
                  size_t count);
/** Play Song (OI p. 12); the robot ignores it while a song plays. @param slot 0 to 15. */
int cargobay_play_song(struct cargobay_robot* robot, uint8_t slot);
/**
 * Stores a tune in RTTTL ("scale:d=8,o=5,b=120:c,d,e,f") in the song slots from `slot` on.
 * @param durations_64 receives the duration of each song in 1/64 s, after which the next may be
 * played; room for 16; may be NULL.
 * @return the number of slots used; errors as above.
 */
int cargobay_tune(struct cargobay_robot* robot, uint8_t slot, const char* rtttl,
                  int32_t* durations_64);
/**
 * Stores a script (OI p. 15), as text: "drive 300 straight; wait_distance 400; drive 0 0".
 * @param how bits of enum cargobay_how.
 */
int cargobay_script(struct cargobay_robot* robot, const char* text, uint32_t how);
/**
 * Play Script (OI p. 15). While the script waits, the robot neither listens nor answers, and what
 * it drives is not the loop's command; as soon as it listens again, the loop's command applies.
 * @param expected_ns how long the script may take, 0 to 86400000000000; see
 * cargobay_expect_silence().
 */
int cargobay_play_script(struct cargobay_robot* robot, int64_t expected_ns);
/**
 * Sends any command, given as text in the words of docs/protocol.md: "leds play 0 255". Commands
 * that would take the robot out of the loop's hands (mode, baud, drive, stream, sensors, demos) are
 * CARGOBAY_E_ARGUMENT: use the functions for them.
 * @param how bits of enum cargobay_how.
 */
int cargobay_command(struct cargobay_robot* robot, const char* text, uint32_t how);
/** The same, as bytes: one or more whole commands with values in range, 124 bytes at most. */
int cargobay_raw(struct cargobay_robot* robot, const uint8_t* bytes, size_t count, uint32_t how);
/** @} */

/* ----------------------------------------------------------------------------------- statistics */

/** What the loop has counted since cargobay_start(). */
struct cargobay_statistics {
  uint32_t size;              /**< sizeof(struct cargobay_statistics) */
  int32_t scheduler;          /**< 1: SCHED_FIFO; 0: not granted, or virtual time */
  int32_t priority;           /**< of SCHED_FIFO; 0: none */
  int32_t memory_locked;      /**< 1: all of it, or at least what the loop needs */
  int64_t ticks;              /**< of the robot */
  uint64_t frames_good;       /**< that arrived intact */
  uint64_t frames_bad;        /**< damaged on the way */
  uint64_t frames_lost;       /**< that never arrived */
  uint64_t frames_late;       /**< deadlines that passed without a frame */
  uint64_t overruns_wait;     /**< the frame reached the loop over 5 ms behind its time */
  uint64_t overruns_read;     /**< reading the frame took more than 1 ms */
  uint64_t overruns_control;  /**< the control function took more than its budget */
  uint64_t overruns_write;    /**< control and sending took more than 1 ms */
  uint64_t controls_refused;  /**< results of the control function that no robot can follow */
  uint64_t commands_unsent;   /**< that the port did not take whole */
  uint64_t commands_withheld; /**< that might have been the second within one tick of the robot */
  uint64_t events_dropped;    /**< that no thread took in time */
};

/**
 * The counters as of the newest frame.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start(). Any
 * thread; real-time safe.
 */
int cargobay_get_statistics(struct cargobay_robot* robot, struct cargobay_statistics* statistics);

/**
 * Lists the rights that the kernel refused the loop: one line each, with the reason and what to do
 * about it, worded for the place where the program runs (a login, a service, a container). Empty if
 * nothing was refused, and in virtual time. 1500 characters are enough.
 * @param text receives the lines, NUL-terminated; truncated if they do not fit.
 * @return their full length; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before
 * cargobay_start(). Any thread; reads some files; allocates.
 */
int cargobay_missing_rights(struct cargobay_robot* robot, char* text, size_t text_size);

/** A histogram of times in fixed memory: log-linear, exact to 0.8 %. It belongs to the program. */
struct cargobay_histogram;

/** What the loop measures about itself. */
enum cargobay_measure {
  CARGOBAY_MEASURE_PERIOD = 0,          /**< from one frame to the next */
  CARGOBAY_MEASURE_FRAME_TO_COMMAND = 1 /**< from its arrival until the command is written */
};

/** The distribution of the times in a histogram. */
struct cargobay_distribution {
  uint32_t size;     /**< sizeof(struct cargobay_distribution) */
  uint32_t reserved; /**< 0 */
  uint64_t count;    /**< number of times recorded */
  int64_t min_ns;    /**< the shortest; exact, like max_ns and mean_ns */
  int64_t p50_ns;    /**< half of the times do not exceed it */
  int64_t p90_ns;    /**< 90 % of the times do not exceed it */
  int64_t p99_ns;    /**< 99 % of the times do not exceed it */
  int64_t p999_ns;   /**< 99.9 % of the times do not exceed it */
  int64_t max_ns;    /**< the longest */
  double mean_ns;    /**< the mean */
};

/**
 * Creates an empty histogram.
 * @param histogram receives the handle, to be passed to cargobay_histogram_close().
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_SYSTEM. Any thread; allocates.
 */
int cargobay_histogram_open(struct cargobay_histogram** histogram);
/** Frees it. @return 0; CARGOBAY_E_HANDLE. Any thread. */
int cargobay_histogram_close(struct cargobay_histogram* histogram);
/**
 * Records a time; a negative time counts as 0, one of more than a day as a day.
 * @return 0; CARGOBAY_E_HANDLE. One thread at a time; real-time safe.
 */
int cargobay_histogram_record(struct cargobay_histogram* histogram, int64_t time_ns);
/**
 * Reads the distribution of the recorded times.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread, even while another records.
 */
int cargobay_histogram_get(struct cargobay_histogram* histogram,
                           struct cargobay_distribution* distribution);
/**
 * The time that `percent` of the recorded times do not exceed.
 * @param percent 0 to 100.
 * @param time_ns receives it; 0 if the histogram is empty.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread, even while another records.
 */
int cargobay_histogram_percentile(struct cargobay_histogram* histogram, double percent,
                                  int64_t* time_ns);
/**
 * Copies what the loop has measured so far into the program's histogram, replacing its contents.
 * @param measure enum cargobay_measure.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start(). Any
 * thread.
 */
int cargobay_copy_histogram(struct cargobay_robot* robot, int measure,
                            struct cargobay_histogram* histogram);

#ifdef __cplusplus
}
#endif

#endif
