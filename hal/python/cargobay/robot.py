"""A robot."""

from __future__ import annotations

import ctypes
from collections.abc import Callable

from . import _arguments, _handles, _signals
from . import _structs as c
from ._arguments import Path, Seconds
from ._callbacks import Callbacks, Control, Progress, control_of
from ._inputs import Inputs
from ._library import library
from ._options import options_of
from ._outputs import Outputs
from .enums import Feature, Flag, Mode, Remainder
from .errors import HandleError, Stalled
from .records import Twist, Wheels
from .sim import Sim


class Robot(Inputs, Outputs):
    """A robot, brought up; a context manager. Without a port, a virtual Create.

        with Robot("/dev/ttyUSB0") as robot:
            robot.start()
            for state in robot.states(2.0):
                robot.drive(200.0, 0.0)
    """

    _closer = _handles.CLOSE_ROBOT

    def __init__(self, port: Path | None = None, *, flags: Flag = Flag(0), sim: Sim | None = None,
                 config: Path | None = None, settings: str | None = None,
                 record: Path | None = None, progress: Progress | None = None,
                 control_overruns: int = 0, port_fd: int = 0, baud: int = 0,
                 mode: Mode = Mode.SAFE, remainder: Remainder = Remainder.UNKNOWN,
                 priority: int = 0, cpu: int | None = None, setpoint_lapse_s: Seconds = 0.0,
                 control_budget_s: Seconds = 0.0, link_timeout_s: Seconds = 0.0,
                 guard_deadline_s: Seconds = 0.0, acceleration_mm_s2: float = 0.0,
                 jerk_mm_s3: float = 0.0, wheel_base_mm: float = 0.0, distance_scale: float = 0.0,
                 turn_scale: float = 0.0) -> None:
        """The members of struct cargobay_options; 0 and None are the defaults.

        `progress` is called with a step and its detail, both str, at each step and every 100 ms at
        least, here and when start() brings the robot up again. If it returns False, bring-up gives
        up: Cancelled. What it raises gives up too, and is raised; so is what a signal handler
        raises, as that of Ctrl-C. Whatever gives up, the robot was told to stop and go Passive.
        """
        if sim is not None:
            _arguments.instance("sim", sim, Sim)
            if sim._handle is None:
                raise HandleError("`sim` is closed; open another Sim")
        _arguments.function("progress", progress)
        self._sim = sim  # it must outlive this
        self._controls: list[object] = []  # what C calls must not be collected
        self._controlled = self._virtual = False
        self._callbacks = Callbacks(progress)
        options = options_of(
            flags=flags, settings=settings, cpu=cpu, port=port, config=config, record=record,
            control_overruns=control_overruns, port_fd=port_fd, baud=baud, mode=mode,
            remainder=remainder, priority=priority, setpoint_lapse_s=setpoint_lapse_s,
            control_budget_s=control_budget_s, link_timeout_s=link_timeout_s,
            guard_deadline_s=guard_deadline_s, acceleration_mm_s2=acceleration_mm_s2,
            jerk_mm_s3=jerk_mm_s3, wheel_base_mm=wheel_base_mm, distance_scale=distance_scale,
            turn_scale=turn_scale)
        options.sim = sim._handle if sim is not None else None
        options.progress = self._callbacks.progress
        try:
            self._bring_up(lambda: self._open("cargobay_open", ctypes.byref(options),
                                              sim=options.sim))
            self._virtual = Feature.VIRTUAL_TIME in self.info.features
        except BaseException:
            super().close()
            raise

    def _bring_up(self, call: Callable[[], object]) -> None:
        """A call in which C may call `progress`."""
        shared = self._callbacks
        try:
            with _signals.Deferred() as shared.deferred:
                call()
        finally:
            shared.deferred = None
            shared.reraise()

    def close(self) -> None:
        """Stops the robot if it has not been stopped yet, and frees everything.

        Raises what the control function had raised, if nothing has raised it again before. Stalled
        if the control function has not returned: the robot was stopped, and it is closed.
        """
        handle = self._handle
        try:
            super().close()
        finally:
            if _handles.has_stalled(handle):
                _handles.keep_for_ever(self._controls)
            self._callbacks.reraise()

    @_signals.entry
    def __del__(self) -> None:
        if self._handle is not None and _handles.has_stalled(self._handle):  # closed by that alone
            _handles.keep_for_ever(self._controls)
        super().__del__()

    def start(self) -> None:
        """Starts the loop; after it has ended, brings the robot up again first: to reconnect."""
        self._bring_up(lambda: library.cargobay_start(self._handle))

    def end(self) -> None:
        """Ends the loop: the robot stands still, in Passive mode.

        Raises what the control function had raised, or why the loop had ended by itself.
        """
        self._call(lambda: int(library.cargobay_end(self._handle)))
        self._callbacks.reraise()

    def request_end(self) -> None:
        """Asks the loop to end, from anywhere; end() must still be called."""
        library.cargobay_request_end(self._handle)

    def set_control(self, control: Control | None) -> None:
        """Sets, changes or (None) clears the control function, whether the loop runs or not.

        The loop calls it once a frame. It returns Wheels, a Twist, SETPOINT or FINISHED, and must
        not block. What it raises ends the loop and is raised again, once: by wait() and its like,
        end(), close(), or at the end of the `with`.
        """
        _arguments.function("control", control)
        wrapped = control_of(self._callbacks, control)
        self._controls.append(wrapped)  # and the one before, until it is known that C has let go
        self._controlled = True
        try:
            library.cargobay_set_control(self._handle, wrapped, None)
        except Stalled:
            _handles.keep_for_ever(self._controls)
            raise
        self._controls = [wrapped]
        self._controlled = control is not None

    def drive_wheels(self, left_mm_s: float, right_mm_s: float) -> None:
        """Sets the speed of each wheel, -500 to 500, until it lapses: after half a second."""
        library.cargobay_drive_wheels(self._handle, _arguments.real("left_mm_s", left_mm_s),
                                      _arguments.real("right_mm_s", right_mm_s))

    def drive(self, velocity_mm_s: float, turn_rate_rad_s: float) -> None:
        """The same, as velocity and turn rate, counter-clockwise; too much is scaled down."""
        library.cargobay_drive(self._handle, _arguments.real("velocity_mm_s", velocity_mm_s),
                               _arguments.real("turn_rate_rad_s", turn_rate_rad_s))

    def drive_radius(self, velocity_mm_s: float, radius_mm: float) -> None:
        """The same, as an arc: positive to the left; math.inf: straight ahead; 0: in place."""
        library.cargobay_drive_radius(
            self._handle, _arguments.real("velocity_mm_s", velocity_mm_s),
            _arguments.real("radius_mm", radius_mm))

    def stop(self) -> None:
        """Makes the robot stand still, and clears the control function; the loop goes on."""
        library.cargobay_stop(self._handle)

    def wheels_of(self, twist: Twist) -> Wheels:
        """The wheel speeds of a twist, with the robot's wheel base and within its speed."""
        _arguments.instance("twist", twist, Twist)
        wheels = c.Wheels()
        library.cargobay_wheels_of(
            self._handle, c.Twist(_arguments.real("velocity_mm_s", twist.velocity_mm_s),
                                  _arguments.real("turn_rate_rad_s", twist.turn_rate_rad_s)),
            ctypes.byref(wheels))
        return Wheels._of(wheels)

    def reset_odometry(self, x_mm: float = 0.0, y_mm: float = 0.0,
                       heading_rad: float = 0.0) -> None:
        """Sets the pose of the odometry, with no uncertainty, from the next frame on."""
        library.cargobay_reset_odometry(
            self._handle, _arguments.real("x_mm", x_mm), _arguments.real("y_mm", y_mm),
            _arguments.real("heading_rad", heading_rad))

    def rearm(self) -> None:
        """Tells the robot to go back to its mode (Flag.HOLD_ON_MODE_LOSS)."""
        library.cargobay_rearm(self._handle)

    def expect_silence(self, duration_s: Seconds) -> None:
        """For so long from now, silence of the robot does not count as a lost link."""
        library.cargobay_expect_silence(
            self._handle, _arguments.time_ns("duration_s", duration_s))

    def save_recording(self, path: Path) -> None:
        """Writes what the loop has received and done lately, for `cargobay replay`."""
        if path is None:
            raise TypeError("`path` must be a path, not NoneType")
        library.cargobay_save_recording(self._handle, _arguments.path("path", path))
