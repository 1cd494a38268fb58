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
 * once a frame, every 15 ms; you may change from one to the other at any time. cargobay_stop()
 * makes the robot stand still, and the loop goes on. cargobay_end() ends the loop and leaves the
 * robot stopped, in Passive mode; cargobay_start() may then start it again, and ticks and odometry
 * continue. cargobay_close() frees everything. If the loop ends by itself (the link is lost, the
 * robot has left its mode, ...), it stops the robot first; cargobay_get_end() says why it ended.
 *
 * Without a port the robot is a virtual Create on a pseudo-terminal, in real time; everything works
 * as it does with a real robot. With `sim` the robot is the virtual Create that you opened, which
 * may run in virtual time. There is no control thread then: cargobay_wait() advances time frame by
 * frame, calls the control function itself, and returns as soon as the result is computed. That
 * makes unit tests of a controller possible, and of several robots in one world (`beside`).
 *
 * @section readers Readers
 * The library remembers nothing about who has read what. A reader says what it has already seen,
 * the tick of a state or the sequence number of an event, and gets what is newer. So any number of
 * threads, coroutines and programs' parts may read side by side, and each sees every gap: in ticks,
 * or in sequence numbers.
 *
 *     struct cargobay_state state = {.size = sizeof state, .tick = -1};
 *     while (cargobay_wait(robot, state.tick, 1000000000, &state) == 0) print(state.x_mm);
 *
 * @section errors Errors
 * Functions return 0, or a negative enum cargobay_error; a few return a count or a length, or
 * CARGOBAY_ENDED, and say so. Codes are told apart by what to do about them.
 * cargobay_error_message() returns one line for a person: what failed, and what to do about it. A
 * failed call changes nothing unless documented otherwise: after a setpoint that was refused, the
 * one before still counts until it lapses. The library never prints, exits, or installs a signal
 * handler.
 *
 * @section sizes Structs that grow
 * A struct whose first member is `size` may gain members at its end in a later version. Set `size`
 * to sizeof the struct, and every member that you do not use to 0, which always means the default.
 * If the program is older than the library, its struct is shorter: the missing members count as 0
 * on the way in and are not written on the way out. If the program is newer, its struct is longer:
 * the members that this library does not know must be 0 on the way in (else CARGOBAY_E_ARGUMENT),
 * and are set to 0 on the way out. A `size` below 4, or more than 4096 bytes above that of this
 * library's struct, was never set: CARGOBAY_E_ARGUMENT, and nothing is read or written. The `state`
 * and the `output` passed to a control function have the size that this library knows: a program
 * compiled against a newer header checks their `size` first. Structs without `size` never change.
 *
 * @section threads Threads
 * Each function says which threads may call it:
 * - *any thread*: several threads at once, too, and the control function. Those that are also
 *   *real-time safe* do not block, lock, allocate or enter the kernel, even if they fail, and even
 *   in a library loaded by dlopen().
 * - *owner*: one thread at a time, and not the control function; otherwise CARGOBAY_E_THREAD.
 *
 * In virtual time, all functions of the robots and virtual Creates of a world are for one thread at
 * a time.
 * A handle that is NULL, was closed, is of another kind (a virtual Create's instead of a robot's)
 * or belongs to the parent of a forked process is recognised: CARGOBAY_E_HANDLE. Close handles
 * before the process ends, or its guard will stop the robot.
 *
 * The guard is a child process of the program. It ends with the robot's handle. A program that
 * calls wait() or waitpid(-1) may be told of it, and ignores it.
 *
 * @section callbacks The control function
 * The control function runs on the control thread, at real-time priority if that was granted,
 * within a budget of 2 ms (`control_budget_ns`). It must not block. If it throws (in C++), the
 * exception goes no further: the wheels stop and the loop ends with CARGOBAY_E_CONTROL.
 *
 * If the control function does not return, or ends its thread, the guard stops the robot after
 * `guard_deadline_ns`; from then on nothing that the loop does reaches the robot. cargobay_wait()
 * returns CARGOBAY_E_STALLED. cargobay_end() and cargobay_close() stop the robot without the help
 * of the loop, unless the guard already has, and return CARGOBAY_E_STALLED too. If the function has
 * still not returned by then, its thread keeps running, and everything it may come back to is never
 * freed: the robot, its locked memory, and the descriptor of its port, which stays in use. So the
 * function's code and its `context` must stay valid too. The only way to get rid of such a thread
 * is to end the process. In virtual time it is the program's own thread that hangs, in
 * cargobay_wait(); a function that ends it there ends the process.
 *
 * @section stops Stops
 * Wheels that nobody steers (a setpoint that lapsed, cargobay_stop(), speeds that no robot can
 * follow) are told to stop at once, whatever the limits of acceleration and jerk; so they are if
 * one is stuck or distance and angle cannot be true, if the robot falls silent, or if the loop ends
 * by itself. To stop gently, drive with a speed of 0 until the robot stands.
 *
 * @section units Units
 * mm, mm/s, rad, rad/s and ns; sensor packets have the units of the manual. x points ahead, y to
 * the left, angles are counter-clockwise positive. Left comes before right. Times of three clocks
 * have names of their own: `robot_time_ns` counts the robot's ticks; `arrival_ns` is when a frame
 * arrived, on CLOCK_MONOTONIC or, in virtual time, since the world of the virtual Create
 * was opened; `sim_time_ns` is a virtual Create's own time.
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
/** The three as one number that grows: 1002003 is version 1.2.3. */
#define CARGOBAY_VERSION_NUMBER \
  (CARGOBAY_VERSION_MAJOR * 1000000 + CARGOBAY_VERSION_MINOR * 1000 + CARGOBAY_VERSION_PATCH)

/**
 * The version of the library in use, "0.1.0"; the macros give the version of the header.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_version(void);

/**
 * The same as a number, to be compared with CARGOBAY_VERSION_NUMBER.
 * @return as the macro. Any thread; real-time safe.
 */
uint32_t cargobay_version_number(void);

/* ------------------------------------------------------------------------------------- errors */

/** What a wait returns when no more frames will come because the loop was asked to end. */
#define CARGOBAY_ENDED 1

/** What a function returns when it fails. Codes are never renumbered; new ones may be added. */
enum cargobay_error {
  CARGOBAY_OK = 0,
  /* mend the program */
  CARGOBAY_E_ARGUMENT = -1,    /**< a value is NULL, not a number, or out of range */
  CARGOBAY_E_HANDLE = -2,      /**< a handle is NULL, closed, or of another kind */
  CARGOBAY_E_STATE = -3,       /**< called in the wrong order: before the start, after the end */
  CARGOBAY_E_THREAD = -4,      /**< called from the control function, or beside the owner */
  CARGOBAY_E_UNSUPPORTED = -5, /**< this robot, or this kind of time, has no such thing */
  CARGOBAY_E_CONTROL = -6,     /**< the control function failed, threw, or was too slow */
  /* mend a file or a setting */
  CARGOBAY_E_CONFIG = -7, /**< the configuration file, `settings`, or a value in them */
  CARGOBAY_E_FILE = -8,   /**< a file cannot be read or written: a world, a recording */
  CARGOBAY_E_RIGHTS = -9, /**< required real-time rights were not granted */
  /* mend the machine */
  CARGOBAY_E_MEMORY = -10, /**< memory ran out */
  CARGOBAY_E_LIMIT = -11,  /**< a limit is reached: of handles, threads, descriptors */
  CARGOBAY_E_SYSTEM = -12, /**< the system refused something else */
  /* mend the connection */
  CARGOBAY_E_NO_PORT = -13,   /**< there is no such port, or it is no terminal */
  CARGOBAY_E_BUSY = -14,      /**< another program, or another robot here, uses it */
  CARGOBAY_E_ACCESS = -15,    /**< this user may not open the port or the pin */
  CARGOBAY_E_PIN = -16,       /**< a pin is missing, in use, or does not follow */
  CARGOBAY_E_UNPLUGGED = -17, /**< the port hung up during the drive */
  CARGOBAY_E_SILENT = -18,    /**< the robot does not answer, or has gone silent */
  /* look at the robot */
  CARGOBAY_E_UNCONFIRMED = -19, /**< told to stop, it did not confirm: it may be moving */
  CARGOBAY_E_MODE = -20,        /**< it left its mode: a cliff, a wheel drop, a charger */
  /* the loop or its guard was in trouble; the robot was stopped */
  CARGOBAY_E_STALLED = -21, /**< the process hung, and its guard stopped the robot */
  CARGOBAY_E_GUARD = -22,   /**< the guard cannot start, or died or was suspended */
  /* try again */
  CARGOBAY_E_FULL = -23,      /**< no room on the line for this now */
  CARGOBAY_E_TIMEOUT = -24,   /**< the time ran out first */
  CARGOBAY_E_NO_FRAME = -25,  /**< no frame has come yet */
  CARGOBAY_E_CANCELLED = -26, /**< `progress` gave up */
  CARGOBAY_E_WHEELS = -27 /**< a wheel is stuck, or distance and angle cannot be true: its event */
};

/**
 * The name of a code, as "CARGOBAY_E_BUSY"; "CARGOBAY_E_?" for a code this library does not know.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_error_name(int error);

/**
 * Explains the last failed call on this thread, in one line, with the remedy.
 * @return a string that lives until the next failed call on this thread; "" before the first. Any
 * thread; real-time safe.
 */
const char* cargobay_error_message(void);

/* ---------------------------------------------------------------------------- virtual Create */

/** A virtual Create. The program opens and closes it; it outlives the robot that uses it. */
struct cargobay_sim;

/** How time passes for a virtual Create. */
enum cargobay_sim_time {
  CARGOBAY_SIM_TIME_REAL = 0,   /**< follows CLOCK_MONOTONIC; reached through a pseudo-terminal */
  CARGOBAY_SIM_TIME_VIRTUAL = 1 /**< passes only when advanced; every run is the same */
};

/** What happens to the fraction of a millimetre or degree that reading packet 19 or 20 leaves. */
enum cargobay_remainder {
  CARGOBAY_REMAINDER_FIND_OUT = -1, /**< as an option: the loop finds out, whatever a file says */
  CARGOBAY_REMAINDER_UNKNOWN = 0,   /**< not known yet; as an option: the default */
  CARGOBAY_REMAINDER_CARRIED = 1,   /**< it counts towards the next reading */
  CARGOBAY_REMAINDER_LOST = 2       /**< it is lost */
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
  struct cargobay_sim* beside; /**< an open virtual Create: this one is in its world and goes by its
                                    time; leave `time` and `world` 0. NULL: a world of its own */
  const char* plant; /**< how its wheels answer: a plant of docs/virtual-create.md, and values on
                          top, as in "slow sign true"; NULL: "default". Overridden by those below */
  void* reserved[2]; /**< NULL */
  int64_t lag_ns;    /**< time constant of the wheels, 1000000 to 1000000000; 0: 100000000 */
  double gain_left;  /**< part of the command that the wheel reaches, 0.1 to 1.5; 0: 0.94 */
  double gain_right; /**< the same for the right wheel, 0.1 to 1.5; 0: 0.9 */
  double noise_mm_s; /**< standard deviation of a wheel's speed, 0 to 100; 0: 1; negative: none */
  double wheel_base_mm; /**< its true wheel base, 50 to 1000; 0: 258 */
};

/** What really happens to a virtual Create; no sensor reports it. */
struct cargobay_truth {
  uint32_t size;                /**< sizeof(struct cargobay_truth) */
  int32_t mode;                 /**< enum cargobay_mode */
  int64_t sim_time_ns;          /**< since it, or in virtual time its world, was opened */
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
 *
 * With `beside` it joins the world of another one: they are in each other's way, see each other's
 * infrared, and hide from each other what is behind them. It stands at the world's next `start` or,
 * if there is none, half a metre to the left of the one before; to put it elsewhere, inject
 * "place X Y HEADING". In virtual time all of them have one clock: whatever moves it for one, the
 * loops of the others run meanwhile, each frame at its time and on the calling thread. So it does
 * not matter in which order a program waits for them.
 *
 * @param options NULL for the defaults; borrowed for the call, `beside` until this one is closed.
 * @param sim receives the handle, to be passed to cargobay_sim_close(); NULL after a failure.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE for `beside`; CARGOBAY_E_FILE if the world
 * cannot be read or the link not be made; CARGOBAY_E_LIMIT if 64 are open, or no pseudo-terminal or
 * thread is left; CARGOBAY_E_MEMORY; CARGOBAY_E_SYSTEM; CARGOBAY_E_THREAD. Owner; blocks for some
 * ms, allocates.
 */
int cargobay_sim_open(const struct cargobay_sim_options* options, struct cargobay_sim** sim);

/**
 * Closes a virtual Create. Close the robot that uses it first, and virtual Creates that were opened
 * `beside` it; otherwise CARGOBAY_E_STATE.
 * @param sim NULL: nothing happens.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE; CARGOBAY_E_THREAD. Owner; blocks for some ms.
 */
int cargobay_sim_close(struct cargobay_sim* sim);

/**
 * The path of its pseudo-terminal, which any OI client may open: "/dev/pts/3".
 * @param path receives it, NUL-terminated; truncated if it does not fit.
 * @return its full length; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_UNSUPPORTED in
 * virtual time, which has no pseudo-terminal. Any thread; locks.
 */
int cargobay_sim_get_path(struct cargobay_sim* sim, char* path, size_t path_size);

/**
 * Does something to a virtual Create: presses its buttons, puts things in front of its sensors,
 * makes something go wrong, now or later.
 * @param line a command of docs/virtual-create.md: "bump left", "cliff front_left on",
 * "battery 300", "fault lost 0.01", "place 0 0 90", "plant carpet", "state"; "at 3.5 bump left"
 * does it when the virtual Create's time is 3.5 s.
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
int cargobay_sim_get_truth(struct cargobay_sim* sim, struct cargobay_truth* truth);

/**
 * Lets time pass: at once in virtual time, where the loops of its world's robots run meanwhile; by
 * sleeping in real time.
 * @param duration_ns 0 to 86400000000000, a day.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_THREAD. Owner; in real time blocks
 * for `duration_ns`, or until the virtual Create is closed.
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

/**
 * The name of a mode: "off", "passive", "safe", "full"; "" for another number.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_mode_name(int mode);

/** Bits of cargobay_options.flags. */
enum cargobay_flag {
  CARGOBAY_FLAG_REQUIRE_REALTIME = 1 << 0,  /**< CARGOBAY_E_RIGHTS if the kernel refuses one */
  CARGOBAY_FLAG_NO_REALTIME = 1 << 1,       /**< ordinary scheduling, no locked memory, whatever the
                                           configuration says */
  CARGOBAY_FLAG_NO_GUARD = 1 << 2,          /**< no guard process; if this one dies, the wheels keep
                                        turning */
  CARGOBAY_FLAG_HOLD_ON_MODE_LOSS = 1 << 3, /**< the loop goes on but drives nothing:
                                                 cargobay_rearm() */
  CARGOBAY_FLAG_OPEN_LOOP = 1 << 4, /**< the command is the setpoint; the estimate plays no part */
  CARGOBAY_FLAG_PIN_CPU = 1 << 5,   /**< the control thread runs on `cpu` only */
  CARGOBAY_FLAG_NO_CONFIG = 1 << 6, /**< no configuration file is read */
  CARGOBAY_FLAG_NO_LEARNT = 1 << 7, /**< neither begins from what an earlier drive learnt of the
                                         wheels, nor keeps what this one does */
  CARGOBAY_FLAG_FORGET = 1 << 8,    /**< begins from nothing: the robot has other wheels now */
  CARGOBAY_FLAG_HOLD_HEADING = 1 << 9, /**< the heading follows what the wheels were asked for, also
                                            across stops, whatever the configuration says */
  CARGOBAY_FLAG_DRIVE_ON = 1 << 10, /**< if a wheel is stuck, or distance and angle cannot be true,
                                         the loop only reports it: `stop_if_implausible = false` */
  CARGOBAY_FLAG_PUBLISH = 1 << 11   /**< others may watch: states, sensors and events go to a Unix
                                         socket by the port's name (docs/feed.md), from an ordinary
                                         thread; CARGOBAY_E_FILE if there can be none */
};

/** How to reach and drive a robot. 0 and NULL are the default everywhere. */
struct cargobay_options {
  uint32_t size;    /**< sizeof(struct cargobay_options) */
  uint32_t flags;   /**< bits of enum cargobay_flag */
  const char* port; /**< serial port or pseudo-terminal; NULL: the configuration's or, if it names
                         none, a virtual Create of its own. The configuration's pins belong to its
                         own port: naming another leaves them alone */
  struct cargobay_sim*
      sim;              /**< the robot is this virtual Create; `port` must then be NULL; no pins,
                                 and no configuration file unless `config` names one */
  const char* config;   /**< configuration file (docs/wiring.md); NULL: /etc/cargobay.toml, then
                             $XDG_CONFIG_HOME/cargobay.toml over it, whichever of them exist */
  const char* settings; /**< more settings as the text of such a file, over the file's; the members
                             below are over these; NULL: none */
  const char* record;   /**< file to record the drive to, for `cargobay replay`; NULL: none.
                             cargobay_open() opens it; it gets this name once the loop runs. A
                             second start does not record: cargobay_save_recording() */
  int (*progress)(void* context, const char* step,
                  const char* detail); /**< called on the calling thread while the robot is brought
                                            up, at each step and at least every 100 ms; returns 0,
                                            or anything else to give up: CARGOBAY_E_CANCELLED. Must
                                            not throw. NULL: none */
  void* progress_context;    /**< the `context` passed to `progress`; valid while robot is open */
  char* message;             /**< receives what cargobay_error_message() would say if opening
                                   fails, else ""; NULL: nothing */
  uint32_t message_size;     /**< of `message`, in bytes; truncated if it does not fit */
  uint32_t control_overruns; /**< in a row that end the loop, 1 to 1000000; 0: 10 */
  int32_t port_fd;   /**< an open terminal to use instead of `port`, 3 or more; opened again,
                                   so the program may close it; 0: none */
  uint32_t baud;     /**< baud rate; 0: the configuration's, or 57600 */
  int32_t mode;      /**< to drive in: CARGOBAY_MODE_SAFE (or 0) or CARGOBAY_MODE_FULL */
  int32_t remainder; /**< enum cargobay_remainder; 0: the configuration's, or find out */
  int32_t priority;  /**< SCHED_FIFO priority, 1 to 98; 0: the configuration's, or 80;
                                   negative: ordinary scheduling */
  int32_t cpu;       /**< CPU for CARGOBAY_FLAG_PIN_CPU, 0 to 1023 */
  int64_t setpoint_lapse_ns; /**< age at which a setpoint lapses, 20000000 to 60000000000; 0:
                                   500000000 */
  int64_t control_budget_ns; /**< for a call of the control function, 10000 to 1000000000; 0:
                                   2000000 */
  int64_t link_timeout_ns;   /**< silence that ends the loop, 200000000 to 600000000000; 0:
                                   1000000000 */
  int64_t guard_deadline_ns; /**< after which the guard stops the robot, 40000000 to 10000000000;
                                   0: 150000000 */
  double acceleration_mm_s2; /**< limit, 10 to 100000; 0: the configuration's, or 1000 */
  double jerk_mm_s3;         /**< limit, 20 to 10000000; 0: the configuration's, or none; negative:
                                   none */
  double wheel_base_mm;      /**< between the wheels, 50 to 1000; 0: the configuration's, or 258 */
  double distance_scale;     /**< true distance per mm reported, 0.5 to 2; 0: the configuration's,
                                   or 1 */
  double turn_scale; /**< true angle per degree reported, 0.5 to 2; 0: the configuration's, or 1 */
};

/**
 * Opens the port and brings the robot up, whatever state it is in. Afterwards the robot stands
 * still, in its mode, and its loop does not run yet. With pins configured, bring-up includes power
 * and baud rate.
 * @param options NULL for the defaults; borrowed for the call, `sim` for the life of the robot.
 * @param robot receives the handle, to be passed to cargobay_close(); NULL after a failure: the
 * robot was then told to stop and go Passive, and nothing is left open.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_CONFIG; CARGOBAY_E_HANDLE for `sim`; CARGOBAY_E_BUSY
 * if another robot uses `sim` or another program the port; CARGOBAY_E_NO_PORT; CARGOBAY_E_ACCESS;
 * CARGOBAY_E_PIN; CARGOBAY_E_SILENT if the robot does not answer; CARGOBAY_E_MODE if it does not go
 * to its mode; CARGOBAY_E_UNCONFIRMED if it answered, but at last did not confirm that it stands;
 * CARGOBAY_E_UNPLUGGED; CARGOBAY_E_CANCELLED; CARGOBAY_E_FILE if `record` cannot be written;
 * CARGOBAY_E_GUARD; CARGOBAY_E_LIMIT if 64 are open; CARGOBAY_E_MEMORY; CARGOBAY_E_SYSTEM;
 * CARGOBAY_E_THREAD.
 * Owner; blocks for 0.2 s if the robot answers at once, for up to 40 s, or until `progress` gives
 * up; allocates.
 */
int cargobay_open(const struct cargobay_options* options, struct cargobay_robot** robot);

/**
 * Stops the robot if it has not been stopped yet, and frees everything. Waits for other threads
 * that are inside a function of this robot.
 * @param robot NULL: nothing happens.
 * @return 0, also if the loop had ended by itself; CARGOBAY_E_STALLED if the control function has
 * not returned: the robot was stopped and the handle is closed all the same, but not everything is
 * freed (see callbacks above); CARGOBAY_E_HANDLE; CARGOBAY_E_THREAD from the control function. Any
 * other thread; blocks for up to 2 s, for 3 s more if another thread is inside cargobay_start(),
 * cargobay_end() or, in virtual time, cargobay_wait().
 */
int cargobay_close(struct cargobay_robot* robot);

/** The result of the bring-up. */
struct cargobay_bring_up {
  uint32_t size;          /**< sizeof(struct cargobay_bring_up) */
  uint32_t found_baud;    /**< rate at which the robot first answered */
  uint32_t baud;          /**< rate in use now */
  int32_t rate_change;    /**< enum cargobay_rate_change */
  int32_t powered_on;     /**< 1: it was off, and the power toggle turned it on */
  int32_t resynchronised; /**< 1: it was waiting for the rest of a half-sent command */
  int32_t brc_pulses;     /**< number of pulses on the BRC pin */
  int32_t battery_mv;     /**< 0: not reported yet */
  int64_t took_ns;        /**< how long it took */
};

/** How the bring-up changed the baud rate. */
enum cargobay_rate_change {
  CARGOBAY_RATE_CHANGE_NONE = 0,   /**< none was needed */
  CARGOBAY_RATE_CHANGE_BRC = 1,    /**< by the Baud Rate Change pin */
  CARGOBAY_RATE_CHANGE_COMMAND = 2 /**< by the Baud command, opcode 129 */
};

/**
 * How the last bring-up went.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE while cargobay_start() brings
 * the robot up again. Any thread; real-time safe.
 */
int cargobay_get_bring_up(struct cargobay_robot* robot, struct cargobay_bring_up* bring_up);

/** What a robot has; bits of cargobay_info.features. */
enum cargobay_feature {
  CARGOBAY_FEATURE_LEDS = 1 << 0,             /**< cargobay_set_leds() */
  CARGOBAY_FEATURE_SONGS = 1 << 1,            /**< cargobay_store_song() */
  CARGOBAY_FEATURE_SCRIPTS = 1 << 2,          /**< cargobay_store_script() */
  CARGOBAY_FEATURE_DIGITAL_OUTPUTS = 1 << 3,  /**< cargobay_set_digital_outputs() */
  CARGOBAY_FEATURE_LOW_SIDE_DRIVERS = 1 << 4, /**< cargobay_set_low_side_drivers() */
  CARGOBAY_FEATURE_SEND_IR = 1 << 5,          /**< cargobay_send_ir() */
  CARGOBAY_FEATURE_VIRTUAL_TIME = 1 << 6      /**< its time passes only in cargobay_wait() */
};

/** What kind of robot it is, and what the library knows about it. */
struct cargobay_info {
  uint32_t size;         /**< sizeof(struct cargobay_info) */
  uint32_t features;     /**< bits of enum cargobay_feature */
  int64_t tick_ns;       /**< from one frame to the next */
  double wheel_base_mm;  /**< that the loop uses */
  double max_wheel_mm_s; /**< the highest speed of a wheel */
  uint32_t baud;         /**< rate in use now */
  uint32_t song_slots;   /**< songs that it stores */
  uint32_t song_notes;   /**< notes in each of them */
  uint32_t script_bytes; /**< longest script */
  uint32_t spare_bytes;  /**< that one frame's line carries beside the loop's own commands */
  uint32_t reserved;     /**< 0 */
  char model[32];        /**< "iRobot Create", NUL-terminated */
};

/**
 * What kind of robot it is.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE while cargobay_start() brings
 * the robot up again. Any thread; real-time safe.
 */
int cargobay_get_info(struct cargobay_robot* robot, struct cargobay_info* info);

/** What the loop has learnt of the robot's wheels, with standard deviations. */
struct cargobay_learnt {
  uint32_t size;              /**< sizeof(struct cargobay_learnt) */
  int32_t remainder;          /**< enum cargobay_remainder: which kind of robot this is */
  int32_t from_earlier;       /**< 1: this start began from what an earlier one learnt */
  uint32_t reserved;          /**< 0 */
  int64_t moved_ns;           /**< how long the wheels have been told to move since the start */
  int64_t lag_ns;             /**< in which a wheel comes within 37 % of a new speed */
  int64_t lag_sd_ns;          /**< its standard deviation */
  int64_t dead_time_ns;       /**< until a command begins to act */
  int64_t dead_time_sd_ns;    /**< its standard deviation */
  double ramp_s2_mm;          /**< 1 / the acceleration in mm/s^2 by which the robot approaches a
                                command; near 0: at once */
  double ramp_sd_s2_mm;       /**< its standard deviation */
  double gain_left;           /**< part of its command that the left wheel reaches */
  double gain_left_sd;        /**< its standard deviation */
  double gain_right;          /**< the same for the right wheel */
  double gain_right_sd;       /**< its standard deviation */
  double carried_probability; /**< that the remainder is carried, by the readings, 0 to 1 */
};

/**
 * What the loop has learnt of the wheels, a quarter of a second old at most. At the end of a drive,
 * and once a minute, it is kept in a file for the next start of a robot at the same port:
 * $STATE_DIRECTORY/learnt of a systemd service, else $XDG_STATE_HOME/cargobay/learnt or
 * ~/.local/state/cargobay/learnt. That is where the next loop begins, not what it believes. A
 * virtual Create, and any other pseudo-terminal, has no file unless the setting `learnt` names one.
 * A file that cannot be read or written is no error. cargobay_start() after cargobay_end() begins
 * from what the former loop learnt, with or without a file.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE while cargobay_start() brings
 * the robot up again; CARGOBAY_E_NO_FRAME before the first frame. Any thread; real-time safe.
 */
int cargobay_get_learnt(struct cargobay_robot* robot, struct cargobay_learnt* learnt);

/** A key that a configuration file, or `settings`, may have. */
struct cargobay_setting {
  uint32_t size;             /**< sizeof(struct cargobay_setting) */
  uint32_t reserved;         /**< 0 */
  const char* table;         /**< "robot", the table that the key stands in; "" for the top */
  const char* key;           /**< "acceleration_mm_s2" */
  const char* unit;          /**< "mm/s^2"; "" if it has none */
  const char* default_value; /**< "1000", or what holds without it: "the robot is a ..." */
  const char* words;         /**< what it means, in a line */
  const char* example;       /**< a value as TOML */
  double least;              /**< of its range; 0 if it is not a number */
  double most;               /**< the same */
};

/**
 * Lists what can be set, the pins apart, which are tables of their own (docs/wiring.md).
 * @param index from 0 on.
 * @param setting receives it; its strings are never freed.
 * @return 0; CARGOBAY_ENDED after the last; CARGOBAY_E_ARGUMENT. Any thread; real-time safe.
 */
int cargobay_get_setting(uint32_t index, struct cargobay_setting* setting);

/* ------------------------------------------------------------------------------------ the state */

/** What makes Safe mode stop the robot (OI p. 6); bits of cargobay_state.hazards. */
enum cargobay_hazard {
  CARGOBAY_HAZARD_WHEEL_DROP_LEFT = 1 << 0,
  CARGOBAY_HAZARD_WHEEL_DROP_RIGHT = 1 << 1,
  CARGOBAY_HAZARD_WHEEL_DROP_FRONT = 1 << 2,
  CARGOBAY_HAZARD_CLIFF_LEFT = 1 << 3,
  CARGOBAY_HAZARD_CLIFF_FRONT_LEFT = 1 << 4,
  CARGOBAY_HAZARD_CLIFF_FRONT_RIGHT = 1 << 5,
  CARGOBAY_HAZARD_CLIFF_RIGHT = 1 << 6,
  CARGOBAY_HAZARD_CHARGER = 1 << 7
};

/** Bits of cargobay_state.bumps. */
enum cargobay_bump { CARGOBAY_BUMP_LEFT = 1 << 0, CARGOBAY_BUMP_RIGHT = 1 << 1 };

/** Bits of cargobay_state.buttons. */
enum cargobay_button { CARGOBAY_BUTTON_PLAY = 1 << 0, CARGOBAY_BUTTON_ADVANCE = 1 << 1 };

/** What draws too much current; bits of cargobay_event.overcurrents. */
enum cargobay_overcurrent {
  CARGOBAY_OVERCURRENT_WHEEL_LEFT = 1 << 0,
  CARGOBAY_OVERCURRENT_WHEEL_RIGHT = 1 << 1,
  CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_0 = 1 << 2,
  CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_1 = 1 << 3,
  CARGOBAY_OVERCURRENT_LOW_SIDE_DRIVER_2 = 1 << 4
};

/** Wheels: bits of cargobay_event.wheels. */
enum cargobay_wheel { CARGOBAY_WHEEL_LEFT = 1 << 0, CARGOBAY_WHEEL_RIGHT = 1 << 1 };

/** What holds the wheels back from the speeds asked for: bits of `limits`. */
enum cargobay_limit {
  CARGOBAY_LIMIT_SPEED = 1 << 0,       /**< the weaker wheel cannot reach its speed, or may not be
                                            driven at it */
  CARGOBAY_LIMIT_ACCELERATION = 1 << 1 /**< the speeds are on their way: acceleration, jerk */
};

/** What is wrong with a wheel or its counter. Numbers are never reused; new ones may be added. */
enum cargobay_finding {
  CARGOBAY_FINDING_NOTHING = 0,
  CARGOBAY_FINDING_STILL = 1,    /**< it is driven, but counts nothing */
  CARGOBAY_FINDING_REVERSED = 2, /**< it counts against the direction in which it is driven */
  CARGOBAY_FINDING_FEW = 3,      /**< it counts much less than the other for its command */
  CARGOBAY_FINDING_JUMPS = 4     /**< counts that no robot can drive, again and again */
};

/** Wheel speeds, mm/s. Never changes. */
struct cargobay_wheels {
  double left_mm_s;  /**< of the left wheel */
  double right_mm_s; /**< of the right wheel */
};

/** Velocity and turn rate of the robot's centre. Never changes. */
struct cargobay_twist {
  double velocity_mm_s;   /**< ahead */
  double turn_rate_rad_s; /**< counter-clockwise */
};

/** The state of the loop at one tick. */
struct cargobay_state {
  uint32_t size;         /**< sizeof(struct cargobay_state) */
  int32_t mode;          /**< enum cargobay_mode */
  int64_t tick;          /**< of the robot, 15 ms each, since the first frame; from 0 on */
  int64_t robot_time_ns; /**< the robot's time at `tick` */
  int64_t elapsed_ns;    /**< robot time since the state before; 0 in the first of a start and,
                              in a control function, for a frame that had been given up */
  int64_t arrival_ns;    /**< when its frame arrived */
  struct cargobay_wheels target;   /**< as requested; 0 if there was no valid request */
  struct cargobay_wheels limited;  /**< the target after the limits of acceleration and jerk */
  struct cargobay_wheels estimate; /**< estimated true speeds */
  struct cargobay_wheels command;  /**< as sent to the robot */
  double velocity_mm_s;            /**< forward speed, of the estimate */
  double turn_rate_rad_s;          /**< of the estimate */
  double x_mm;             /**< odometry, since the first start or cargobay_reset_odometry() */
  double y_mm;             /**< odometry */
  double heading_rad;      /**< not wrapped */
  double distance_mm;      /**< travelled; driving backwards counts negative */
  double covariance[9];    /**< of x, y, heading, row by row: mm^2, mm rad, rad^2 */
  int32_t remainder;       /**< enum cargobay_remainder: which kind of robot this is */
  int32_t setpoint_lapsed; /**< 1: it was not renewed in time */
  uint32_t hazards;        /**< bits of enum cargobay_hazard that this frame reports */
  uint32_t bumps;     /**< bits of enum cargobay_bump, as last reported: at most 3 frames ago */
  uint32_t buttons;   /**< bits of enum cargobay_button, the same */
  int32_t battery_mv; /**< as last reported; 0: not yet */
  uint32_t limits;    /**< bits of enum cargobay_limit that hold the wheels back from `target`, both
                           by one factor, so that the robot keeps to its curve */
  uint32_t reserved;  /**< 0 */
};

/**
 * The state of the newest tick.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_NO_FRAME before the first frame.
 * Any thread; real-time safe.
 */
int cargobay_get_state(struct cargobay_robot* robot, struct cargobay_state* state);

/**
 * Waits for a state newer than `after_tick`, and returns the newest there is. In virtual time,
 * advances time frame by frame until there is one.
 * @param after_tick the last tick that the caller has seen; -1: any state will do.
 * @param timeout_ns 0: does not wait; negative: waits for ever. Real time or, in virtual time,
 * virtual time; a frame that is on its way is then not cut short.
 * @param state receives the state; its tick is greater than `after_tick`, and by more than 1 if
 * there were others in between: cargobay_get_history(). Unchanged unless 0 is returned. May be
 * NULL.
 * @return 0; CARGOBAY_ENDED if no newer state will come because the loop was asked to end, by
 * cargobay_end(), cargobay_request_end(), cargobay_close() or its control function;
 * CARGOBAY_E_TIMEOUT; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before
 * cargobay_start(); CARGOBAY_E_THREAD in the control function. If the loop has ended by itself, the
 * code of cargobay_get_end(). CARGOBAY_E_STALLED also if the loop has made no progress for
 * `guard_deadline_ns`: its control function does not return, or others took the CPU. Any thread but
 * the control thread; blocks. While a thread waits, the loop makes one more system call per frame.
 */
int cargobay_wait(struct cargobay_robot* robot, int64_t after_tick, int64_t timeout_ns,
                  struct cargobay_state* state);

/**
 * The states after `after_tick`, oldest first, one per tick that had a frame. The newest 256 are
 * kept, 3.8 s.
 * @param states room for `count` of them; states[0].size says how long each is.
 * @param count 1 to 256.
 * @return how many were written; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread; real-time
 * safe.
 */
int cargobay_get_history(struct cargobay_robot* robot, int64_t after_tick,
                         struct cargobay_state* states, size_t count);

/**
 * A descriptor to wait on with poll(), epoll or an event loop: readable once a frame, an event or
 * the end has come since it was last read. Read 8 bytes from it before you look at what came. The
 * robot has one, so it is for one reader, which tells the others.
 *
 *     struct pollfd one = {.fd = cargobay_get_fd(robot), .events = POLLIN};
 *     uint64_t ignored;
 *     while (poll(&one, 1, -1) > 0 && read(one.fd, &ignored, sizeof ignored) > 0) look(robot);
 *
 * @return the descriptor, non-blocking and close-on-exec, which the library owns and closes with
 * the robot; CARGOBAY_E_HANDLE; CARGOBAY_E_LIMIT; CARGOBAY_E_UNSUPPORTED in virtual time. Any
 * thread; the first call makes it, and from then on the loop makes two more system calls per frame.
 */
int cargobay_get_fd(struct cargobay_robot* robot);

/**
 * Sets the pose of the odometry, with no uncertainty, from the next frame on.
 * @param x_mm, y_mm -1e9 to 1e9.
 * @param heading_rad -1e6 to 1e6.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start() and
 * after the loop has ended; CARGOBAY_E_FULL. Any thread; locks.
 */
int cargobay_reset_odometry(struct cargobay_robot* robot, double x_mm, double y_mm,
                            double heading_rad);

/* ------------------------------------------------------------------------------ start and end */

/** What a control function wants; enum values of cargobay_output.kind. */
enum cargobay_output_kind {
  CARGOBAY_OUTPUT_WHEELS = 0,  /**< the speeds in `wheels` */
  CARGOBAY_OUTPUT_TWIST = 1,   /**< the velocity and turn rate in `twist`; both are scaled down
                                    together if a wheel would have to go too fast */
  CARGOBAY_OUTPUT_SETPOINT = 2 /**< the latest setpoint, as if there were no control function */
};

/** The result of a control function. */
struct cargobay_output {
  uint32_t size;                 /**< sizeof(struct cargobay_output), set by the library */
  int32_t kind;                  /**< enum cargobay_output_kind */
  struct cargobay_wheels wheels; /**< -500 to 500 each */
  struct cargobay_twist twist;   /**< any two numbers */
};

/**
 * Decides how to drive. The loop calls it once a frame, on the control thread (see callbacks
 * above), while the robot is in its mode.
 * @param context as passed to cargobay_set_control().
 * @param state of this frame: estimate, odometry, sensors; target, limited and command are not
 * decided yet, and 0. Valid during the call.
 * @param output the result; on entry, wheels at 0. If what it holds is not a number or beyond
 * 500 mm/s, the wheels stop, and the statistics count it.
 * @return 0: go on; 1: finished, the loop ends as asked; a negative number: failed, the loop ends
 * with CARGOBAY_E_CONTROL, and cargobay_get_end() has the number. Either way the robot is stopped.
 */
typedef int (*cargobay_control)(void* context, const struct cargobay_state* state,
                                struct cargobay_output* output);

/**
 * Sets, changes or clears the control function, which the loop calls instead of reading setpoints.
 * When this returns, the function set before is not called any more and its context may be freed.
 * @param control NULL: setpoints again; the latest counts if it has not lapsed.
 * @param context must be valid until the function is changed or cleared, or the robot is closed or,
 * if the function does not return, until the process ends.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_THREAD from the control function; CARGOBAY_E_STALLED if
 * the former function has not returned within `guard_deadline_ns`: the new one is set, the former
 * is not called again, but its context must stay. Owner; blocks while the former function runs;
 * allocates.
 */
int cargobay_set_control(struct cargobay_robot* robot, cargobay_control control, void* context);

/**
 * Starts the guard and the control thread; in virtual time it only gets ready. After
 * cargobay_end(), or after the loop ended by itself, it first brings the robot up again, which
 * opens the port again: that is how to reconnect. Ticks, odometry, events and subscriptions
 * continue.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE if the loop runs; CARGOBAY_E_RIGHTS;
 * CARGOBAY_E_GUARD; CARGOBAY_E_LIMIT if there is no thread; CARGOBAY_E_FILE if the recording cannot
 * be written; CARGOBAY_E_THREAD; the second time whatever cargobay_open() returns. After a failure
 * the robot is stopped, in Passive mode, and may be started again. Owner; blocks for some ms, the
 * second time as cargobay_open() does; allocates.
 */
int cargobay_start(struct cargobay_robot* robot);

/**
 * Ends the loop, stops the wheels, goes Passive.
 * @return 0 if the loop was asked to end (here, by cargobay_request_end() or by its control
 * function) and the robot reports that it is Passive; otherwise the code of cargobay_get_end().
 * CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start(); CARGOBAY_E_THREAD. A second call
 * returns the same. Owner; blocks for up to 1 s; for up to 2 s if the control function does not
 * return (see callbacks above).
 */
int cargobay_end(struct cargobay_robot* robot);

/**
 * Asks the loop to end; the wheels stop within a frame. cargobay_end() must still be called.
 * @return 0; CARGOBAY_E_HANDLE, without a message. Any thread; real-time safe, and the only
 * function allowed in a signal handler.
 */
int cargobay_request_end(struct cargobay_robot* robot);

/** Why and how the loop ended. */
struct cargobay_end_report {
  uint32_t size;          /**< sizeof(struct cargobay_end_report) */
  int32_t ended;          /**< 0: it has not, and everything below is 0; 1: it has */
  int32_t code;           /**< 0: as asked; else an enum cargobay_error: SILENT, UNPLUGGED, MODE,
                               CONTROL, STALLED, GUARD, WHEELS, UNCONFIRMED or, if the recording
                               could not be written, FILE */
  int32_t control_result; /**< what the control function returned when it ended the loop; else 0 */
  uint32_t hazards;       /**< bits of enum cargobay_hazard: the causes, if the mode was lost */
  int32_t passive_seen;   /**< 1: the robot has reported that it is Passive. Known after
                               cargobay_end() */
  int32_t guard_lost;     /**< 1: the guard had died, or was suspended */
  uint32_t reserved;      /**< 0 */
  char message[512];      /**< one line: why, and what to do; "" if it ended as asked */
};

/**
 * Why the loop ended, as soon as it has.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread; locks, allocates.
 */
int cargobay_get_end(struct cargobay_robot* robot, struct cargobay_end_report* end);

/**
 * Writes what the loop has received and done lately, up to some minutes, as a recording for
 * `cargobay replay`. While the loop runs, too.
 * @param path of the file; an existing one is replaced once the new one is complete.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start();
 * CARGOBAY_E_FILE; CARGOBAY_E_THREAD. Any thread but the control thread; blocks for the disk;
 * allocates.
 */
int cargobay_save_recording(struct cargobay_robot* robot, const char* path);

/* --------------------------------------------------------------------------------------- drive */

/**
 * Sets the speed of each wheel. The setpoint lapses after `setpoint_lapse_ns`; the wheels then stop
 * until the next one.
 * @param left_mm_s, right_mm_s -500 to 500.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start() and
 * after the loop has ended; CARGOBAY_E_MODE if the robot has lost its mode: the event with the
 * reason follows a few frames later. While a control function is set, the setpoint counts only if
 * that asks for it. Any thread; real-time safe.
 */
int cargobay_drive_wheels(struct cargobay_robot* robot, double left_mm_s, double right_mm_s);

/**
 * The same, as velocity and turn rate. If a wheel would have to go faster than it can, both are
 * scaled down together, so that the path stays the same.
 * @return as cargobay_drive_wheels().
 */
int cargobay_drive(struct cargobay_robot* robot, double velocity_mm_s, double turn_rate_rad_s);

/**
 * The same, as an arc (OI p. 9): the centre of the robot moves at this velocity around a point
 * `radius_mm` to the left (positive) or right; slower if a wheel would have to go too fast.
 * @param radius_mm INFINITY: straight ahead; 0: turns in place, counter-clockwise if the velocity
 * is positive; the velocity is then that of the wheels.
 * @return as cargobay_drive_wheels().
 */
int cargobay_drive_radius(struct cargobay_robot* robot, double velocity_mm_s, double radius_mm);

/**
 * Makes the robot stand still: whatever setpoint there is no longer counts, and a control function
 * that is set is cleared. The loop goes on, and the next setpoint drives. See stops above.
 * @return 0; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE before cargobay_start() and after the loop has
 * ended. Any thread; real-time safe.
 */
int cargobay_stop(struct cargobay_robot* robot);

/**
 * Converts velocity and turn rate to wheel speeds, with the robot's wheel base and within its
 * speed, as cargobay_drive() does.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread; real-time safe.
 */
int cargobay_wheels_of(struct cargobay_robot* robot, struct cargobay_twist twist,
                       struct cargobay_wheels* wheels);

/**
 * Tells the robot to go back to its mode after losing it. Only with
 * CARGOBAY_FLAG_HOLD_ON_MODE_LOSS. An event reports the result.
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
  CARGOBAY_EVENT_PORT_SHARED = 16,     /**< frames are missing, and `process` has the port open too,
                                        or had it open a moment ago */
  CARGOBAY_EVENT_WHEEL_STUCK = 17, /**< `wheels` draw too much current and do not turn: `finding`,
                                        `overcurrents`, `wanted`, `got`. The loop ends, unless
                                        CARGOBAY_FLAG_DRIVE_ON */
  CARGOBAY_EVENT_COUNTERS_IMPLAUSIBLE = 18, /**< distance and angle cannot be true: the same */
  CARGOBAY_EVENT_LIMIT_BEGAN = 19, /**< the wheels are held back: `limits`, `wanted`, `got`; by a
                                        limit of acceleration for a second already */
  CARGOBAY_EVENT_LIMIT_ENDED = 20  /**< not for half a second now: the same */
};

/**
 * The name of a kind of event, as "mode_lost"; "" for one that this library does not know.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_event_name(int kind);

/** An event. Members that its kind does not name are 0. */
struct cargobay_event {
  uint32_t size;         /**< sizeof(struct cargobay_event) */
  int32_t kind;          /**< enum cargobay_event_kind */
  int64_t sequence;      /**< 1, 2, 3, ... since cargobay_open() */
  int64_t tick;          /**< as in cargobay_state */
  int64_t arrival_ns;    /**< of the frame that showed it */
  int32_t mode;          /**< enum cargobay_mode */
  uint32_t hazards;      /**< bits of enum cargobay_hazard: the causes; 0 if no sensor says */
  uint32_t overcurrents; /**< bits of enum cargobay_overcurrent */
  uint32_t frames;       /**< how many */
  uint32_t bumps;        /**< bits of enum cargobay_bump */
  int32_t voltage_mv;    /**< of the battery */
  int32_t charge_mah;    /**< charge of the battery */
  int32_t capacity_mah;  /**< capacity of the battery; 0 with ordinary batteries */
  int32_t process;       /**< its process ID; 0 if it was too brief to be seen */
  uint32_t wheels;       /**< bits of enum cargobay_wheel: those concerned */
  char process_name[16]; /**< the kernel's name for it, NUL-terminated */
  int32_t finding;       /**< enum cargobay_finding */
  uint32_t limits;       /**< bits of enum cargobay_limit */
  struct cargobay_wheels wanted; /**< limits: asked for. Wheels: what one that reaches its command
                                      would have done, forward or back */
  struct cargobay_wheels got;    /**< limits: given. Wheels: counted, in the same direction */
};

/**
 * The first event after `after_sequence`. The newest 256 are kept and, beyond those, the newest of
 * each kind; if others are gone, the sequence numbers show it.
 *
 *     struct cargobay_event event = {.size = sizeof event};
 *     while (cargobay_next_event(robot, event.sequence, &event) == 1) handle(&event);
 *
 * @param after_sequence the last that the caller has seen; 0: none.
 * @param event receives it; unchanged unless 1 is returned.
 * @return 1; 0 if there is none; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE. Any thread; real-time
 * safe.
 */
int cargobay_next_event(struct cargobay_robot* robot, int64_t after_sequence,
                        struct cargobay_event* event);

/**
 * Describes an event in one line: "the robot went from its mode to passive: a cliff at the front
 * left". For CARGOBAY_EVENT_PORT_SHARED it adds what to do about the process, if it still runs.
 * @param text receives it, NUL-terminated; truncated if it does not fit.
 * @return its full length; CARGOBAY_E_ARGUMENT. Any thread; allocates.
 */
int cargobay_describe_event(const struct cargobay_event* event, char* text, size_t text_size);

/* ------------------------------------------------------------------------------------- sensors */

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
  CARGOBAY_PACKET_REQUESTED_LEFT_VELOCITY = 42
};

/**
 * The name of a packet, as "wall_signal"; "" if the number is not that of a single packet.
 * @return a string that is never freed. Any thread; real-time safe.
 */
const char* cargobay_packet_name(int packet);

/** What a packet last said. Never changes. */
struct cargobay_reading {
  int64_t tick;       /**< of the frame that reported it; -1: none has yet */
  int64_t arrival_ns; /**< of that frame, to within 2 ms; 0 if there is none */
  int32_t value;      /**< in the manual's units */
  uint32_t packet;    /**< enum cargobay_packet */
};

/**
 * The latest readings of some packets, all as of the same frame. Packets 7 to 26, 34 and 35 are
 * always included in what the robot sends: bumps and wheel drops, buttons and the infrared byte in
 * every other frame or more often, the battery every second. For the others use
 * cargobay_subscribe() or cargobay_query().
 *
 *     const uint32_t packets[] = {CARGOBAY_PACKET_WALL, CARGOBAY_PACKET_VOLTAGE};
 *     struct cargobay_reading readings[2];
 *     cargobay_get_readings(robot, packets, 2, readings);
 *
 * @param packets enum cargobay_packet, in any order; borrowed for the call.
 * @param count 1 to 64.
 * @param readings receives as many, in the order of `packets`.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_UNSUPPORTED for a packet that the
 * robot lacks; CARGOBAY_E_NO_FRAME before the first frame. Any thread; real-time safe.
 */
int cargobay_get_readings(struct cargobay_robot* robot, const uint32_t* packets, size_t count,
                          struct cargobay_reading* readings);

/**
 * Has these packets streamed from the next frames on, each 5 to 30 times a second. Subscriptions
 * are counted: a packet is streamed until each has been taken back.
 * @param packets enum cargobay_packet; borrowed for the call.
 * @param count 1 to 64.
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_HANDLE; CARGOBAY_E_UNSUPPORTED for a packet that the
 * robot lacks; CARGOBAY_E_STATE if the loop does not run; CARGOBAY_E_FULL. After an error no count
 * has changed. Any thread; locks.
 */
int cargobay_subscribe(struct cargobay_robot* robot, const uint32_t* packets, size_t count);

/**
 * Takes one subscription of each packet back.
 * @return as cargobay_subscribe(); CARGOBAY_E_ARGUMENT for a packet that is not subscribed. Any
 * thread; locks.
 */
int cargobay_unsubscribe(struct cargobay_robot* robot, const uint32_t* packets, size_t count);

/**
 * Asks for one packet, and waits for a frame that reports it, sampled after the call.
 * @param packet enum cargobay_packet, except 19 and 20, which the loop reads itself.
 * @param timeout_ns as for cargobay_wait(); about 0.3 s is enough if the line loses nothing.
 * @param reading receives it.
 * @return as cargobay_wait(), and CARGOBAY_E_UNSUPPORTED, CARGOBAY_E_FULL. Any thread but the
 * control thread; blocks, locks.
 */
int cargobay_query(struct cargobay_robot* robot, uint32_t packet, int64_t timeout_ns,
                   struct cargobay_reading* reading);

/* ------------------------------------------------------------------------- outputs and commands */

/** Bits of `leds` for cargobay_set_leds() (OI p. 9). */
enum cargobay_led { CARGOBAY_LED_PLAY = 1 << 0, CARGOBAY_LED_ADVANCE = 1 << 1 };

/** A note of a song (OI p. 11). Never changes. */
struct cargobay_note {
  int64_t duration_ns; /**< 0 to 3984375000; rounded to 1/64 s, as the robot counts */
  uint32_t number;     /**< MIDI number, 31 (G, 49 Hz) to 127; others up to 255 are rests */
  uint32_t reserved;   /**< 0 */
};

/** Bits of `how` for cargobay_send_command() and its like. */
enum cargobay_how {
  CARGOBAY_HOW_PAUSE_DRIVING = 1 << 0 /**< send the command even if it is too long for the line
                                           beside the loop's own; meanwhile the wheels keep turning
                                           as last commanded */
};

/**
 * @name Commands beside the loop's own
 * Each command waits in a queue of 32 and is sent right after the loop's own command in one of the
 * next frames, one per frame, if it fits in what the line carries beside it: 52 bytes at 57600
 * baud, 12 at 19200 (cargobay_info.spare_bytes). A longer one is sent only while the wheels stand
 * still, or with CARGOBAY_HOW_PAUSE_DRIVING; songs that need the pause take it by themselves.
 *
 * They return 0; CARGOBAY_E_ARGUMENT for values out of range; CARGOBAY_E_HANDLE; CARGOBAY_E_STATE
 * if the loop does not run; CARGOBAY_E_MODE if the robot's mode does not allow the command;
 * CARGOBAY_E_FULL if the queue is full, or for a long command while the wheels turn. Any thread;
 * they lock.
 * @{
 */

/** LEDs (OI p. 9). @param leds bits of enum cargobay_led. @param power_color 0 green to 255 red.
 * @param power_intensity 0 off to 255. */
int cargobay_set_leds(struct cargobay_robot* robot, uint32_t leds, uint32_t power_color,
                      uint32_t power_intensity);
/** Digital Outputs (OI p. 10). @param outputs bits 0 to 2. */
int cargobay_set_digital_outputs(struct cargobay_robot* robot, uint32_t outputs);
/** Low Side Drivers (OI p. 10). @param drivers bits 0 to 2. */
int cargobay_set_low_side_drivers(struct cargobay_robot* robot, uint32_t drivers);
/** PWM Low Side Drivers (OI p. 10). @param driver_0, driver_1, driver_2 duty cycle, 0 to 128. */
int cargobay_set_pwm_low_side_drivers(struct cargobay_robot* robot, uint32_t driver_0,
                                      uint32_t driver_1, uint32_t driver_2);
/** Send IR (OI p. 11): an infrared byte through low side driver 1. @param byte 0 to 255. */
int cargobay_send_ir(struct cargobay_robot* robot, uint32_t byte);
/** Song (OI p. 11). @param slot 0 to 15. @param count 1 to 16. @param notes borrowed for the call.
 */
int cargobay_store_song(struct cargobay_robot* robot, uint32_t slot,
                        const struct cargobay_note* notes, size_t count);
/** Play Song (OI p. 12); the robot ignores it while a song plays. @param slot 0 to 15. */
int cargobay_play_song(struct cargobay_robot* robot, uint32_t slot);
/**
 * Stores a tune in RTTTL ("scale:d=8,o=5,b=120:c,d,e,f") in the song slots from `slot` on, in any
 * of the forms that docs/protocol.md lists.
 * @param durations_ns receives the duration of each song, after which the next may be played; as
 * many as fit; may be NULL.
 * @param capacity how many fit; 16 is always enough.
 * @return the number of slots used; errors as above.
 */
int cargobay_store_tune(struct cargobay_robot* robot, uint32_t slot, const char* rtttl,
                        int64_t* durations_ns, size_t capacity);
/**
 * Stores a script (OI p. 15), as text: "drive 300 straight; wait_distance 400; drive 0 0".
 * @param how bits of enum cargobay_how.
 */
int cargobay_store_script(struct cargobay_robot* robot, const char* text, uint32_t how);
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
int cargobay_send_command(struct cargobay_robot* robot, const char* text, uint32_t how);
/** The same, as bytes: one or more whole commands with values in range, 124 bytes at most. */
int cargobay_send_bytes(struct cargobay_robot* robot, const uint8_t* bytes, size_t count,
                        uint32_t how);
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
  uint64_t events;            /**< reported so far: the newest sequence number */
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
int cargobay_get_missing_rights(struct cargobay_robot* robot, char* text, size_t text_size);

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
 * @return 0; CARGOBAY_E_ARGUMENT; CARGOBAY_E_LIMIT if 64 are open;
 * CARGOBAY_E_MEMORY. Any thread; allocates.
 */
int cargobay_histogram_open(struct cargobay_histogram** histogram);
/** Frees it. @param histogram NULL: nothing happens. @return 0; CARGOBAY_E_HANDLE. Any thread. */
int cargobay_histogram_close(struct cargobay_histogram* histogram);
/**
 * Records a time; a negative time counts as 0, one of more than a day as a day. Percentiles count
 * more than 2^40 ns, 18 minutes, as that.
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
int cargobay_histogram_get_percentile(struct cargobay_histogram* histogram, double percent,
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
