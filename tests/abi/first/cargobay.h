/**
 * @file cargobay.h
 * The C API of Cargobay: a real-time loop for the iRobot Create (2006), its Open Interface ("OI"),
 * and a virtual Create to try everything on.
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
 * cargobay_open() opens the port and brings the robot up; it stands still. cargobay_start() starts
 * the loop. From then on it is driven: by setpoints (cargobay_drive() and its like), which lapse
 * after half a second unless renewed, or by a control function that the loop calls once a frame,
 * every 15 ms. cargobay_stop() ends the loop and leaves the robot standing, in Passive mode;
 * cargobay_close() frees what is left. A loop that ends by itself (the link is lost, the robot has
 * left its mode, ...) has stopped the robot: cargobay_wait() and cargobay_stop() say why.
 *
 * Without a port the robot is a virtual Create, on a pseudo-terminal, in real time: everything is
 * as with a robot. With `sim` it is that virtual Create, which may be in virtual time: then there
 * is no control thread. cargobay_wait() makes time pass, frame by frame, calls the control function
 * itself and returns as soon as it is computed: a controller's unit test.
 *
 * @section errors Errors
 * Functions return 0, or a negative enum cargobay_error; some return what they count where they say
 * so. Each code has one culprit. cargobay_error_message() has one line for a person: what failed,
 * and what to do about it. A failed call changes nothing, unless it says so. Nothing here prints,
 * exits, or installs a signal handler.
 *
 * @section sizes Structs that grow
 * A struct whose first member is `size` may get further members at its end in a later version. Set
 * `size` to sizeof the struct and all members that you do not use to 0, which always means the
 * default. A struct of a program older than the library is short: what it lacks counts as 0 on the
 * way in and is not written on the way out. One of a newer program is long: what this library does
 * not know must be 0 on the way in (else CARGOBAY_E_ARGUMENT), and is set to 0 on the way out. The
 * `state` that a control function is given is as long as this library makes it: a program that was
 * compiled for a newer one looks at its `size` first.
 *
 * @section threads Threads
 * Each function says from where it may be called:
 * - *any thread*: also from several at once, and from the control function. Of these the ones
 *   marked *real-time safe* do not block, lock, allocate or enter the kernel.
 * - *owner*: one thread at a time, and not from the control function: CARGOBAY_E_STATE otherwise.
 * In virtual time every function of a robot and of its virtual Create is for one thread at a time.
 * A handle that was closed, is NULL or belongs to the parent of a forked process is recognised:
 * CARGOBAY_E_HANDLE. Close handles before the process ends, or its guard will stop the robot.
 *
 * @section callbacks The control function
 * It runs on the control thread, at real-time priority where that was granted, within a budget of
 * 2 ms (`control_budget_us`). It must not block. An exception (of a control function in C++) does
 * not leave it: the wheels stop and the loop ends, with CARGOBAY_E_CONTROL. Where it does not
 * return at all the guard stops the robot.
 *
 * @section units Units
 * mm, mm/s, rad, rad/s, ns, and the manual's for what a packet holds. x is ahead, y to the left,
 * angles are counter-clockwise positive. Left comes before right.
 */
#ifndef CARGOBAY_H
#define CARGOBAY_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ------------------------------------------------------------------------------------ version */

/** Version of this header: what was removed or changed its meaning. */
#define CARGOBAY_VERSION_MAJOR 0
/** What was added. */
#define CARGOBAY_VERSION_MINOR 1
/** What was mended. */
#define CARGOBAY_VERSION_PATCH 0

/**
 * The version of the library that runs, "0.1.0"; the macros are those of the header.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_version(void);

/* ------------------------------------------------------------------------------------- errors */

/** What a function returns where it fails. Codes are never renumbered; new ones may come. */
enum cargobay_error {
  CARGOBAY_OK = 0,
  CARGOBAY_E_ARGUMENT = -1, /**< the caller: a value that is NULL, no number or out of its range */
  CARGOBAY_E_HANDLE = -2,   /**< the caller: a handle that is NULL, closed, or another process's */
  CARGOBAY_E_STATE = -3,    /**< the caller: in a wrong order, or on a wrong thread */
  CARGOBAY_E_CONFIG = -4,   /**< the configuration file, or what it says */
  CARGOBAY_E_SYSTEM = -5,   /**< the machine: memory, threads, files */
  CARGOBAY_E_PORT = -6,     /**< the port or a pin: missing, busy, forbidden, unplugged */
  CARGOBAY_E_RIGHTS = -7,   /**< the machine's settings: real-time rights that were required */
  CARGOBAY_E_ROBOT = -8,    /**< the robot: it does not answer, or fell silent */
  CARGOBAY_E_MODE = -9, /**< what the robot met: it left its mode (cliff, wheel drop, charger) */
  CARGOBAY_E_CONTROL = -10, /**< the control function: over its budget too often, or it threw */
  CARGOBAY_E_STALLED = -11, /**< the process: it stood still, and its guard stopped the robot */
  CARGOBAY_E_FULL = -12,    /**< the line: no room now for what is to be sent; try again later */
  CARGOBAY_E_TIMEOUT = -13  /**< nobody: what was waited for did not come in time */
};

/**
 * The name of a code: "CARGOBAY_E_PORT"; "CARGOBAY_E_?" for one that this library does not know.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_error_name(int error);

/**
 * What the last failed call on this thread was about: one line, with the remedy.
 * @return a string that lives until the next failed call on this thread; "" before the first. Any
 * thread.
 */
const char* cargobay_error_message(void);

/* ---------------------------------------------------------------------------- virtual Create */

/** A virtual Create. Opened and closed by the program; it outlives the robot that is it. */
struct cargobay_sim;

/** How time passes for a virtual Create. */
enum cargobay_sim_time {
  CARGOBAY_SIM_REAL = 0,   /**< along CLOCK_MONOTONIC, behind a pseudo-terminal */
  CARGOBAY_SIM_VIRTUAL = 1 /**< when it is told to; the same each time */
};

/** What becomes of the part of a millimetre or degree that a read of packet 19 or 20 leaves. */
enum cargobay_remainder {
  CARGOBAY_REMAINDER_UNKNOWN = 0, /**< not found out yet; as an option: to be found out */
  CARGOBAY_REMAINDER_CARRIED = 1, /**< it counts towards the next reading */
  CARGOBAY_REMAINDER_LOST = 2     /**< it is gone */
};

/** A virtual Create to be opened. 0 is the default everywhere. */
struct cargobay_sim_options {
  uint32_t size;      /**< sizeof(struct cargobay_sim_options) */
  int32_t time;       /**< enum cargobay_sim_time */
  uint64_t seed;      /**< of its noise; 0: 1 */
  int32_t remainder;  /**< enum cargobay_remainder; 0: carried */
  uint32_t boot_baud; /**< that it talks after power-on: 57600 (0), 19200, ... */
  const char* link;   /**< symbolic link to its pseudo-terminal; NULL: none. Real time only */
  const char* world; /**< file of walls, cliffs and beams (docs/virtual-create.md); NULL: a plain */
  double lag_s;      /**< of the wheels; 0: 0.1 */
  double droop_left; /**< part of the command that the wheel falls short by, 0 to 0.9; 0: 0.06 */
  double droop_right;   /**< 0: 0.10 */
  double noise_mm_s;    /**< standard deviation of a wheel's speed; 0: 1; negative: none */
  double wheel_base_mm; /**< that it turns by, 50 to 1000; 0: 258 */
};

/** What no sensor tells. */
struct cargobay_truth {
  uint32_t size;                /**< sizeof(struct cargobay_truth) */
  int32_t mode;                 /**< enum cargobay_mode */
  int64_t time_ns;              /**< of the virtual Create, since it was opened */
  double left_mm_s;             /**< speed of the left wheel over the ground */
  double right_mm_s;            /**< of the right one */
  double x_mm;                  /**< where it is */
  double y_mm;                  /**< the same */
  double heading_rad;           /**< not wrapped */
  int32_t commanded_left_mm_s;  /**< the last command that it obeyed */
  int32_t commanded_right_mm_s; /**< the same */
};

/**
 * Opens a virtual Create, switched on, in mode Off. In real time it gets a thread of its own.
 * @param options NULL for the defaults; borrowed for the call.
 * @param sim gets the handle, to be given to cargobay_sim_close(); NULL after a failure.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_CONFIG for a world that cannot be read;
 * CARGOBAY_E_SYSTEM where no pseudo-terminal, link or thread is to be had. Owner; blocks for some
 * ms, allocates.
 */
int cargobay_sim_open(const struct cargobay_sim_options* options, struct cargobay_sim** sim);

/**
 * Ends it. The robot that is it is to be closed before: CARGOBAY_E_STATE otherwise.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE. Owner; blocks for some ms.
 */
int cargobay_sim_close(struct cargobay_sim* sim);

/**
 * The pseudo-terminal that any OI client may open: "/dev/pts/3".
 * @param path gets it, with its 0; cut off where it does not fit.
 * @return its length; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE in virtual time,
 * where there is none. Any thread; locks.
 */
int cargobay_sim_path(struct cargobay_sim* sim, char* path, size_t path_size);

/**
 * Does something to it: pushes its buttons, holds things in front of its sensors, makes something
 * go wrong. A line of docs/virtual-create.md: "bump left", "cliff front_left on", "battery 300",
 * "fault lost 0.01", "place 0 0 90", "state".
 * @param answer gets the answer, with its 0, cut off where it does not fit; may be NULL.
 * @return the length of the answer; CARGOBAY_E_ARGUMENT for a line that it does not know;
 * CARGOBAY_E_HANDLE. Any thread; locks, allocates.
 */
int cargobay_sim_inject(struct cargobay_sim* sim, const char* line, char* answer,
                        size_t answer_size);

/**
 * Where it truly is.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread; locks.
 */
int cargobay_sim_truth(struct cargobay_sim* sim, struct cargobay_truth* truth);

/**
 * Lets time pass without a robot: in virtual time at once, in real time by sleeping.
 * @param duration_ns 0 or more.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE in virtual time where an open
 * robot is it: there cargobay_wait() is what makes time pass. Owner; blocks.
 */
int cargobay_sim_advance(struct cargobay_sim* sim, int64_t duration_ns);

/* ------------------------------------------------------------------------------ open and close */

/** A robot. Opened and closed by the program. */
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
  CARGOBAY_REQUIRE_REALTIME = 1 << 0, /**< what the kernel refuses is CARGOBAY_E_RIGHTS */
  CARGOBAY_NO_GUARD = 1 << 1, /**< no guard process; the wheels turn on if this process dies */
  CARGOBAY_HOLD_ON_MODE_LOSS = 1 << 2, /**< the loop goes on, driving nothing: cargobay_rearm() */
  CARGOBAY_OPEN_LOOP = 1 << 3, /**< the command is the setpoint; the estimate has no part in it */
  CARGOBAY_PIN_CPU = 1 << 4,   /**< the control thread runs on `cpu` alone */
  CARGOBAY_NO_CONFIG = 1 << 5  /**< no configuration file is read */
};

/** How a robot is reached and driven. 0 and NULL are the default everywhere. */
struct cargobay_options {
  uint32_t size;    /**< sizeof(struct cargobay_options) */
  uint32_t flags;   /**< of enum cargobay_flag */
  const char* port; /**< serial port or pseudo-terminal; NULL: the configuration's; where that has
                         none either, a virtual Create of its own */
  struct cargobay_sim* sim; /**< the robot is this virtual Create; `port` is NULL then, and pins of
                               the configuration are left alone */
  const char* config; /**< configuration file (docs/wiring.md); NULL: /etc/cargobay.toml and on top
                           of it $XDG_CONFIG_HOME/cargobay.toml, as far as they exist */
  const char* record; /**< file that the drive is recorded to, for `cargobay replay`; NULL: none */
  uint32_t baud;      /**< rate to talk at; 0: the configuration's, or 57600 */
  int32_t mode;       /**< where it is driven: CARGOBAY_MODE_SAFE (or 0) or CARGOBAY_MODE_FULL */
  int32_t remainder;  /**< enum cargobay_remainder; 0: the configuration's, or found out */
  int32_t priority;   /**< SCHED_FIFO priority, 1 to 98; 0: the configuration's, or 80 */
  int32_t cpu;        /**< with CARGOBAY_PIN_CPU */
  uint32_t setpoint_lapse_ms; /**< after which a setpoint counts no more; 0: 500 */
  uint32_t control_budget_us; /**< of a call of the control function; 0: 2000 */
  uint32_t control_overruns;  /**< in a row, after which the loop ends; 0: 10 */
  uint32_t link_timeout_ms;   /**< of silence, after which the loop ends; 0: 1000 */
  uint32_t guard_deadline_ms; /**< after which the guard takes the robot, 40 and up; 0: 150 */
  double acceleration_mm_s2;  /**< limit; 0: the configuration's, or 500 */
  double jerk_mm_s3;          /**< limit; 0: the configuration's, or none */
  double wheel_base_mm;       /**< between the wheels, 50 to 1000; 0: the configuration's, or 258 */
  double distance_scale;      /**< true distance for each mm reported, 0.5 to 2; 0: the
                                   configuration's, or 1 */
  double turn_scale;          /**< the same for each degree; 0: the configuration's, or 1 */
  void (*progress)(void* context, const char* step, const char* detail); /**< told of each step of
   the bring-up, on the calling thread; it must not throw; NULL: nobody */
  void* progress_context;                                                /**< given to `progress` */
};

/**
 * Opens the port and brings the robot up, whatever state it is found in. It stands, in its mode,
 * and its loop does not run yet. With pins configured this includes power and baud rate.
 * @param options NULL for the defaults; borrowed for the call, `sim` for as long as the robot.
 * @param robot gets the handle, to be given to cargobay_close(); NULL after a failure, when the
 * robot was told to stop and go Passive, and nothing is left open.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_CONFIG; CARGOBAY_E_HANDLE for `sim`; CARGOBAY_E_STATE
 * where another robot is `sim` already; CARGOBAY_E_PORT; CARGOBAY_E_ROBOT; CARGOBAY_E_SYSTEM.
 * Owner; blocks for 0.2 s where the robot answers at once, for up to 40 s; allocates.
 */
int cargobay_open(const struct cargobay_options* options, struct cargobay_robot** robot);

/**
 * Stops the robot if it was not, and frees everything. Other threads that are inside a function of
 * this robot are waited for.
 * @return 0, also where the loop had ended by itself; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE from the
 * control function. Any other thread; blocks for up to 2 s.
 */
int cargobay_close(struct cargobay_robot* robot);

/** What became of the bring-up. */
struct cargobay_bring_up {
  uint32_t size;          /**< sizeof(struct cargobay_bring_up) */
  uint32_t found_baud;    /**< where the robot first answered */
  uint32_t baud;          /**< where it talks now */
  int32_t rate_change;    /**< 0: none was needed, 1: by the BRC pin, 2: by opcode 129 */
  int32_t powered_on;     /**< 1: it was off, and the toggle turned it on */
  int32_t resynchronised; /**< 1: it was freed from a half-sent command */
  int32_t brc_pulses;     /**< that were played on the BRC pin */
  int32_t battery_mv;     /**< 0: not heard yet */
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
  double right_mm_s; /**< of the right one */
};

/** One tick of the loop. */
struct cargobay_state {
  uint32_t size;      /**< sizeof(struct cargobay_state) */
  int32_t mode;       /**< enum cargobay_mode */
  int64_t tick;       /**< of the robot, 15 ms each, since the first frame */
  int64_t time_ns;    /**< robot time: of `tick` */
  int64_t arrival_ns; /**< of the frame: CLOCK_MONOTONIC, or since a virtual Create in virtual time
                           was opened */
  struct cargobay_wheels target;   /**< as asked for; 0 where nothing valid was */
  struct cargobay_wheels set;      /**< behind the limits of acceleration and jerk */
  struct cargobay_wheels estimate; /**< what the wheels do */
  struct cargobay_wheels command;  /**< as sent to the robot */
  double velocity_mm_s;            /**< of the estimate: ahead */
  double turn_rate_rad_s;          /**< of the estimate */
  double x_mm;                     /**< odometry, since the start or cargobay_reset_odometry() */
  double y_mm;                     /**< the same */
  double heading_rad;              /**< not wrapped */
  double distance_mm;              /**< travelled, going back counts backwards */
  double covariance[9];            /**< of x, y, heading, row by row: mm^2, mm rad, rad^2 */
  int32_t remainder;               /**< enum cargobay_remainder: what kind of robot it is */
  int32_t setpoint_lapsed;         /**< 1: nobody renewed it */
  uint32_t hazards;                /**< bits of enum cargobay_hazard that this frame tells of */
  uint32_t bumps;     /**< bits of enum cargobay_bump, as last told: at most 3 frames ago */
  int32_t battery_mv; /**< as last told; 0: not yet */
  int32_t reserved;   /**< 0 */
};

/**
 * The state of the newest tick.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_TIMEOUT before the first frame. Any
 * thread; real-time safe.
 */
int cargobay_get_state(struct cargobay_robot* robot, struct cargobay_state* state);

/**
 * Waits for the next frame that this thread has not seen yet. In virtual time it makes time pass
 * until that frame has been answered.
 * @param timeout_ns of real time; 0: does not wait; negative: for ever. In virtual time, of that,
 * and a frame that is on its way is not cut short.
 * @param state gets the newest state; may be NULL.
 * @return 0; CARGOBAY_E_TIMEOUT; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before
 * cargobay_start(), after cargobay_stop() and in the control function; where the loop has ended by
 * itself what cargobay_stop() will say: CARGOBAY_E_ROBOT, CARGOBAY_E_PORT, CARGOBAY_E_MODE,
 * CARGOBAY_E_CONTROL, CARGOBAY_E_STALLED. Where it ended by cargobay_request_stop():
 * CARGOBAY_E_STATE. Any thread but the control thread; blocks. While somebody waits the loop makes
 * one more system call a frame.
 */
int cargobay_wait(struct cargobay_robot* robot, int64_t timeout_ns, struct cargobay_state* state);

/**
 * Puts the odometry somewhere, certain of it, from the next frame on.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start() and
 * after the loop has ended; CARGOBAY_E_FULL. Any thread; locks.
 */
int cargobay_reset_odometry(struct cargobay_robot* robot, double x_mm, double y_mm,
                            double heading_rad);

/* --------------------------------------------------------------------------------------- drive */

/**
 * Computes the wheel speeds wanted; called once a frame, on the control thread (see callbacks
 * above), while the robot is in its mode.
 * @param context as given to cargobay_set_control().
 * @param state of this frame: estimate, odometry, sensors; target, set and command are not decided
 * yet and 0. Valid during the call.
 * @param wheels 0, 0: to be set. For speeds that are no number or beyond 500 mm/s the wheels stop,
 * and the statistics count it.
 */
typedef void (*cargobay_control)(void* context, const struct cargobay_state* state,
                                 struct cargobay_wheels* wheels);

/**
 * Gives the loop a control function in place of setpoints.
 * @param control NULL: setpoints.
 * @param context outlives the loop.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE after cargobay_start(). Owner.
 */
int cargobay_set_control(struct cargobay_robot* robot, cargobay_control control, void* context);

/**
 * Starts the guard and the control thread; in virtual time only makes ready. Once.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE where it was started before; CARGOBAY_E_RIGHTS;
 * CARGOBAY_E_SYSTEM for a guard or thread that cannot be started, or a recording that cannot be
 * written. After a failure the robot stands, in Passive mode, and is to be closed. Owner; blocks
 * for some ms, allocates.
 */
int cargobay_start(struct cargobay_robot* robot);

/**
 * Ends the loop, stops the wheels, goes Passive.
 * @return 0 where the loop was asked to end (here or by cargobay_request_stop()) and the robot says
 * that it is Passive; otherwise what it ended by: CARGOBAY_E_ROBOT (silent, or did not confirm),
 * CARGOBAY_E_PORT (unplugged), CARGOBAY_E_MODE, CARGOBAY_E_CONTROL, CARGOBAY_E_STALLED,
 * CARGOBAY_E_SYSTEM (a recording that could not be written). CARGOBAY_E_HANDLE; CARGOBAY_E_STATE
 * before cargobay_start() and from the control function. Again: the same. Owner; blocks for up to
 * 1 s.
 */
int cargobay_stop(struct cargobay_robot* robot);

/**
 * Asks the loop to end; the wheels stop within a frame. cargobay_stop() is still to be called.
 * @return 0; CARGOBAY_E_HANDLE. Any thread; real-time safe, and the one function for signal
 * handlers.
 */
int cargobay_request_stop(struct cargobay_robot* robot);

/**
 * Sets the speed of each wheel. It lapses after `setpoint_lapse_ms`: then the wheels stop until the
 * next.
 * @param left_mm_s, right_mm_s -500 to 500.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start(),
 * where the loop has ended and where a control function decides; CARGOBAY_E_MODE where the robot
 * has lost its mode: the event that says why comes a few frames later. Any thread; real-time safe.
 */
int cargobay_drive_wheels(struct cargobay_robot* robot, double left_mm_s, double right_mm_s);

/**
 * The same as velocity and turn rate. Where a wheel would have to be faster than 500 mm/s:
 * CARGOBAY_E_ARGUMENT.
 * @return as cargobay_drive_wheels().
 */
int cargobay_drive(struct cargobay_robot* robot, double velocity_mm_s, double turn_rate_rad_s);

/**
 * The same as an arc (OI p. 9): the middle of the robot at this velocity, around a point
 * `radius_mm` to the left (positive) or right.
 * @param radius_mm INFINITY: straight on; 0: turns in place, counter-clockwise with a positive
 * velocity, which is that of the wheels then.
 * @return as cargobay_drive_wheels().
 */
int cargobay_drive_radius(struct cargobay_robot* robot, double velocity_mm_s, double radius_mm);

/**
 * Wheel speeds of velocity and turn rate; no robot needed.
 * @param wheel_base_mm 258 for the Create.
 * @return the speeds, whatever their range. Any thread; real-time safe.
 */
struct cargobay_wheels cargobay_wheels_of(double velocity_mm_s, double turn_rate_rad_s,
                                          double wheel_base_mm);

/**
 * Tells the robot to go back to its mode after it was lost: with CARGOBAY_HOLD_ON_MODE_LOSS only.
 * What comes of it is an event.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE where the loop does not run. Any thread; real-time
 * safe.
 */
int cargobay_rearm(struct cargobay_robot* robot);

/**
 * For so long from now the robot's silence is no lost link, as while it plays a script that waits.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE where the loop does not run.
 * Any thread; real-time safe.
 */
int cargobay_expect_silence(struct cargobay_robot* robot, int64_t duration_ns);

/* -------------------------------------------------------------------------------------- events */

/** What happened. Numbers are never reused; new ones may come. */
enum cargobay_event_kind {
  CARGOBAY_EVENT_MODE_LOST = 0,    /**< by itself the robot left its mode: `mode`, `hazards` */
  CARGOBAY_EVENT_REARMED = 1,      /**< it is back in it, as asked for */
  CARGOBAY_EVENT_REARM_FAILED = 2, /**< it did not come: `mode`, `hazards` */
  CARGOBAY_EVENT_BATTERY_LOW = 3,  /**< `voltage_mv`, `charge_mah`, `capacity_mah` */
  CARGOBAY_EVENT_BATTERY_RECOVERED = 4,
  CARGOBAY_EVENT_OVERCURRENT_BEGAN = 5, /**< `overcurrents` */
  CARGOBAY_EVENT_OVERCURRENT_ENDED = 6,
  CARGOBAY_EVENT_CHARGING_BEGAN = 7,
  CARGOBAY_EVENT_CHARGING_ENDED = 8,
  CARGOBAY_EVENT_FRAMES_LOST = 9,    /**< `frames`: so many, damaged or never come */
  CARGOBAY_EVENT_SILENCE_BEGAN = 10, /**< the wheels were told to stop */
  CARGOBAY_EVENT_SILENCE_ENDED = 11,
  CARGOBAY_EVENT_SETPOINT_LAPSED = 12, /**< nobody renewed it: the wheels stop */
  CARGOBAY_EVENT_CONTROL_REFUSED = 13, /**< the control function asked for the impossible */
  CARGOBAY_EVENT_BUMP_BEGAN = 14,      /**< `bumps`: those that were not there before */
  CARGOBAY_EVENT_BUMP_ENDED = 15       /**< the last of them is gone */
};

/** An event. What its kind does not name is 0. */
struct cargobay_event {
  uint32_t size;         /**< sizeof(struct cargobay_event) */
  int32_t kind;          /**< enum cargobay_event_kind */
  int64_t tick;          /**< as in cargobay_state */
  int64_t time_ns;       /**< on the clock of cargobay_state.arrival_ns */
  int32_t mode;          /**< enum cargobay_mode */
  uint32_t hazards;      /**< bits of enum cargobay_hazard: the causes; 0 where no sensor says */
  uint32_t overcurrents; /**< as packet 14 has them */
  uint32_t frames;       /**< how many */
  uint32_t bumps;        /**< bits of enum cargobay_bump */
  int32_t voltage_mv;    /**< of the battery */
  int32_t charge_mah;    /**< what it holds */
  int32_t capacity_mah;  /**< what it can hold; 0 with ordinary batteries */
};

/**
 * Takes the oldest event that nobody took yet. 256 are kept; what finds them full is dropped and
 * counted by the statistics.
 * @return 1 and the event, or 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread; locks.
 */
int cargobay_next_event(struct cargobay_robot* robot, struct cargobay_event* event);

/**
 * In words, one line: "the robot went from its mode to passive: a cliff at the front left".
 * @param text gets it, with its 0; cut off where it does not fit.
 * @return its length; CARGOBAY_E_ARGUMENT. Any thread; allocates.
 */
int cargobay_describe_event(const struct cargobay_event* event, char* text, size_t text_size);

/* ------------------------------------------------------------------------------------- sensors */

/** Lists that the loop may stream in turn, beside what it needs itself; bits. */
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
  CARGOBAY_PACKET_DISTANCE = 19, /**< as last read by the loop; add nothing up: use the odometry */
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
 * A packet's name: "wall_signal"; "" for a number that is no single packet.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_packet_name(int packet);

/** The value of each packet, as last told. */
struct cargobay_sensors {
  uint32_t size;                   /**< sizeof(struct cargobay_sensors) */
  uint32_t reserved;               /**< 0 */
  int32_t value[CARGOBAY_PACKETS]; /**< by the packet's number, in the manual's units; 0 to 6 are
                                        groups, and unused */
  int32_t reserved_2;              /**< 0 */
  int64_t tick[CARGOBAY_PACKETS];  /**< of the frame that told it, as in cargobay_state; -1: none
                                        has yet */
};

/**
 * All sensors, as far as the frames told of them. 7 to 26, 34 and 35 come by themselves: bumps and
 * wheel drops, buttons and the infrared byte every other frame or more often, the battery each
 * second. The others come with cargobay_subscribe() or cargobay_query().
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_TIMEOUT before the first frame. Any
 * thread; real-time safe.
 */
int cargobay_get_sensors(struct cargobay_robot* robot, struct cargobay_sensors* sensors);

/**
 * Which of the extra lists are streamed from now on, each of them 5 to 30 times a second.
 * @param extras bits of enum cargobay_extra; 0: none.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE where the loop does not run;
 * CARGOBAY_E_FULL. Any thread; locks.
 */
int cargobay_subscribe(struct cargobay_robot* robot, uint32_t extras);

/**
 * Asks for one packet, and waits for a frame that tells it: sampled after the call.
 * @param packet 7 to 42, but 19 and 20: the loop reads these itself.
 * @param timeout_ns as for cargobay_wait(); about 0.3 s is enough on a whole line.
 * @param value gets it, in the manual's units.
 * @return as cargobay_wait(), and CARGOBAY_E_FULL. Any thread but the control thread; blocks,
 * locks.
 */
int cargobay_query(struct cargobay_robot* robot, int packet, int64_t timeout_ns, int32_t* value);

/* ------------------------------------------------------------------------- outputs and commands */

/** Bits of `leds` for cargobay_leds() (OI p. 9). */
enum cargobay_led { CARGOBAY_LED_PLAY = 1 << 1, CARGOBAY_LED_ADVANCE = 1 << 3 };

/** A note of a song (OI p. 11). */
struct cargobay_note {
  uint8_t number;   /**< 31 (G, 49 Hz) to 127, as MIDI counts; others are rests */
  uint8_t duration; /**< in 1/64 s */
};

/** Bits of `how` for cargobay_command() and its like. */
enum cargobay_how {
  CARGOBAY_PAUSE_DRIVING = 1 << 0 /**< a command too long for the line beside the loop's own is sent
                                       all the same, while the wheels turn on as last commanded */
};

/**
 * @name Commands beside the loop's own
 * Each of these waits in a queue of 32 and is sent behind the loop's own command of one of the next
 * frames, one a frame, within what the line carries beside it: 52 bytes at 57600 baud, 12 at 19200.
 * One that is longer is sent while the wheels stand, or with CARGOBAY_PAUSE_DRIVING; songs pause by
 * themselves where they must.
 *
 * They return 0; CARGOBAY_E_ARGUMENT for values out of range; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE
 * where the loop does not run; CARGOBAY_E_MODE where the robot's mode does not allow it;
 * CARGOBAY_E_FULL for a full queue, or a long command while the wheels turn. Any thread; lock.
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
/** Send IR (OI p. 11): an infrared byte by low side driver 1. */
int cargobay_send_ir(struct cargobay_robot* robot, uint8_t byte);
/** Song (OI p. 11). @param slot 0 to 15. @param count 1 to 16. `notes` are borrowed for the call.
 */
int cargobay_song(struct cargobay_robot* robot, uint8_t slot, const struct cargobay_note* notes,
                  size_t count);
/** Play Song (OI p. 12); ignored by the robot while it plays. @param slot 0 to 15. */
int cargobay_play_song(struct cargobay_robot* robot, uint8_t slot);
/**
 * Stores a tune in RTTTL ("scale:d=8,o=5,b=120:c,d,e,f") in song slots from `slot` on.
 * @param durations_64 gets the duration of each song in 1/64 s, which is when the next may be
 * played; room for 16; may be NULL.
 * @return the number of slots used; else as above.
 */
int cargobay_tune(struct cargobay_robot* robot, uint8_t slot, const char* rtttl,
                  int32_t* durations_64);
/**
 * Stores a script (OI p. 15), as text: "drive 300 straight; wait_distance 400; drive 0 0".
 * @param how bits of enum cargobay_how.
 */
int cargobay_script(struct cargobay_robot* robot, const char* text, uint32_t how);
/**
 * Play Script (OI p. 15). While it waits the robot is deaf and silent, and what it drives is not
 * the loop's: once it hears again the loop's command counts.
 * @param expected_ns how long it may take; see cargobay_expect_silence().
 */
int cargobay_play_script(struct cargobay_robot* robot, int64_t expected_ns);
/**
 * Any command as text, in the words of docs/protocol.md: "leds play 0 255". Commands that would
 * take the robot out of the loop's hands (mode, baud, drive, stream, sensors, demos) are
 * CARGOBAY_E_ARGUMENT: use the functions for them.
 * @param how bits of enum cargobay_how.
 */
int cargobay_command(struct cargobay_robot* robot, const char* text, uint32_t how);
/** The same as bytes: one or more whole commands with values in range, 124 bytes at most. */
int cargobay_raw(struct cargobay_robot* robot, const uint8_t* bytes, size_t count, uint32_t how);
/** @} */

/* ----------------------------------------------------------------------------------- statistics */

/** What the loop has counted since cargobay_start(). */
struct cargobay_statistics {
  uint32_t size;              /**< sizeof(struct cargobay_statistics) */
  int32_t scheduler;          /**< 1: SCHED_FIFO, 0: not granted, or virtual time */
  int32_t priority;           /**< of SCHED_FIFO; 0: none */
  int32_t memory_locked;      /**< 1: mlockall() */
  int64_t ticks;              /**< of the robot */
  uint64_t frames_good;       /**< that came whole */
  uint64_t frames_bad;        /**< damaged on the way */
  uint64_t frames_lost;       /**< never came */
  uint64_t frames_late;       /**< deadlines that passed without a frame */
  uint64_t overruns_wait;     /**< the frame was here over 5 ms behind its time */
  uint64_t overruns_read;     /**< taking it took more than 1 ms */
  uint64_t overruns_control;  /**< the control function took more than its budget */
  uint64_t overruns_write;    /**< control and sending took more than 1 ms */
  uint64_t controls_refused;  /**< answers of the control function that no robot can follow */
  uint64_t commands_unsent;   /**< that the port did not take whole */
  uint64_t commands_withheld; /**< that might have been the second in a tick of the robot */
  uint64_t events_dropped;    /**< that nobody took in time */
};

/**
 * The counters, as of the newest frame.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start(). Any
 * thread; real-time safe.
 */
int cargobay_get_statistics(struct cargobay_robot* robot, struct cargobay_statistics* statistics);

/** A histogram of times with fixed memory: log-linear, exact to 0.8 %. The program's own. */
struct cargobay_histogram;

/** What the loop measures of itself. */
enum cargobay_measure {
  CARGOBAY_MEASURE_PERIOD = 0,          /**< from frame to frame */
  CARGOBAY_MEASURE_FRAME_TO_COMMAND = 1 /**< from its arrival to the command's being written */
};

/** What a histogram holds. */
struct cargobay_distribution {
  uint32_t size;     /**< sizeof(struct cargobay_distribution) */
  uint32_t reserved; /**< 0 */
  uint64_t count;    /**< of the times counted */
  int64_t min_ns;    /**< the least; exact, as max_ns and mean_ns are */
  int64_t p50_ns;    /**< that half of them do not exceed */
  int64_t p90_ns;    /**< the same of 90 % */
  int64_t p99_ns;    /**< the same of 99 % */
  int64_t p999_ns;   /**< the same of 99.9 % */
  int64_t max_ns;    /**< the greatest */
  double mean_ns;    /**< their mean */
};

/**
 * Makes an empty histogram.
 * @param histogram gets the handle, for cargobay_histogram_close().
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_SYSTEM. Any thread; allocates.
 */
int cargobay_histogram_open(struct cargobay_histogram** histogram);
/** Frees it. @return 0; CARGOBAY_E_HANDLE. Any thread. */
int cargobay_histogram_close(struct cargobay_histogram* histogram);
/**
 * Counts a time; negative ones count as 0.
 * @return 0; CARGOBAY_E_HANDLE. One thread at a time; real-time safe.
 */
int cargobay_histogram_record(struct cargobay_histogram* histogram, int64_t time_ns);
/**
 * What it holds.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread, while another records.
 */
int cargobay_histogram_get(struct cargobay_histogram* histogram,
                           struct cargobay_distribution* distribution);
/**
 * The time that `percent` of what it holds do not exceed.
 * @param percent 0 to 100.
 * @param time_ns gets it; 0 where it holds nothing.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread, while another records.
 */
int cargobay_histogram_percentile(struct cargobay_histogram* histogram, double percent,
                                  int64_t* time_ns);
/**
 * Copies what the loop has measured of itself so far into the program's histogram, in place of what
 * that held.
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
