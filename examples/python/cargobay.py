"""Cargobay from Python: the iRobot Create, and a virtual Create to try everything on.

    from cargobay import Robot

    with Robot("/dev/ttyUSB0") as robot:
        robot.start()
        for state in robot.states(2.0):
            robot.drive(200.0, 0.0)

One file over the C API; cargobay.h is the manual of every function, and says what a call may raise
as CargobayError. Functions have its names, without `cargobay_`; times are seconds (`_s`) where they
are given, and as in C (`_ns`) in what is returned. $CARGOBAY_LIBRARY names the library where it is
not installed.

A value of a wrong type is a TypeError that names the parameter, one that is out of its range an
ArgumentError, which is a ValueError too. A robot that is no longer used is closed: at the end of its
`with`, when it is collected, or at the end of the program; not in a forked child, whose parent drives
on.

Python is no real-time language: write a controller as a loop over wait() or states(). A control
function works too, but on a robot the loop's thread has to wait for the interpreter, for up to 5 ms
while another Python thread computes. In virtual time this does not matter.
"""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import enum
import math
import operator
import os
import typing
import warnings
from types import TracebackType
from typing import Annotated, Any, Callable, Iterator, Optional, Sequence, TypeVar, Union

__all__ = [
    "ArgumentError", "BringUp", "Bump", "CargobayError", "Distribution", "Error", "Event",
    "EventKind", "Extra", "Hazard", "Histogram", "How", "Led", "Measure", "Mode", "Packet", "Remainder", "Robot",
    "Sensors", "SimTime", "State", "Statistics", "Truth", "VirtualCreate", "Wheels", "describe",
    "packet_name", "version", "wheels_of",
]


class Error(enum.IntEnum):
    """What went wrong, by who is to blame (enum cargobay_error)."""

    OK = 0
    ARGUMENT = -1
    HANDLE = -2
    STATE = -3
    CONFIG = -4
    SYSTEM = -5
    PORT = -6
    RIGHTS = -7
    ROBOT = -8
    MODE = -9
    CONTROL = -10
    STALLED = -11
    FULL = -12
    TIMEOUT = -13
    GUARD = -14


class SimTime(enum.IntEnum):
    REAL = 0
    VIRTUAL = 1


class Remainder(enum.IntEnum):
    UNKNOWN = 0
    CARRIED = 1
    LOST = 2


class Mode(enum.IntEnum):
    OFF = 0
    PASSIVE = 1
    SAFE = 2
    FULL = 3


class _Flag(enum.IntFlag):
    REQUIRE_REALTIME = 1 << 0
    NO_GUARD = 1 << 1
    HOLD_ON_MODE_LOSS = 1 << 2
    OPEN_LOOP = 1 << 3
    PIN_CPU = 1 << 4
    NO_CONFIG = 1 << 5


class Hazard(enum.IntFlag):
    WHEEL_DROP_LEFT = 1 << 0
    WHEEL_DROP_RIGHT = 1 << 1
    WHEEL_DROP_FRONT = 1 << 2
    CLIFF_LEFT = 1 << 3
    CLIFF_FRONT_LEFT = 1 << 4
    CLIFF_FRONT_RIGHT = 1 << 5
    CLIFF_RIGHT = 1 << 6
    CHARGER = 1 << 7


class Bump(enum.IntFlag):
    RIGHT = 1 << 0
    LEFT = 1 << 1


class EventKind(enum.IntEnum):
    MODE_LOST = 0
    REARMED = 1
    REARM_FAILED = 2
    BATTERY_LOW = 3
    BATTERY_RECOVERED = 4
    OVERCURRENT_BEGAN = 5
    OVERCURRENT_ENDED = 6
    CHARGING_BEGAN = 7
    CHARGING_ENDED = 8
    FRAMES_LOST = 9
    SILENCE_BEGAN = 10
    SILENCE_ENDED = 11
    SETPOINT_LAPSED = 12
    CONTROL_REFUSED = 13
    BUMP_BEGAN = 14
    BUMP_ENDED = 15
    PORT_SHARED = 16


class Extra(enum.IntFlag):
    """Lists that are streamed in turn: Robot.subscribe()."""

    NONE = 0
    SIGNALS_LEFT = 1 << 0
    SIGNALS_RIGHT = 1 << 1
    OUTPUTS = 1 << 2


class Packet(enum.IntEnum):
    """Packets by their numbers (OI p. 17 to 21)."""

    BUMPS_AND_WHEEL_DROPS = 7
    WALL = 8
    CLIFF_LEFT = 9
    CLIFF_FRONT_LEFT = 10
    CLIFF_FRONT_RIGHT = 11
    CLIFF_RIGHT = 12
    VIRTUAL_WALL = 13
    OVERCURRENTS = 14
    UNUSED_1 = 15
    UNUSED_2 = 16
    INFRARED_BYTE = 17
    BUTTONS = 18
    DISTANCE = 19
    ANGLE = 20
    CHARGING_STATE = 21
    VOLTAGE = 22
    CURRENT = 23
    BATTERY_TEMPERATURE = 24
    BATTERY_CHARGE = 25
    BATTERY_CAPACITY = 26
    WALL_SIGNAL = 27
    CLIFF_LEFT_SIGNAL = 28
    CLIFF_FRONT_LEFT_SIGNAL = 29
    CLIFF_FRONT_RIGHT_SIGNAL = 30
    CLIFF_RIGHT_SIGNAL = 31
    DIGITAL_INPUTS = 32
    ANALOG_SIGNAL = 33
    CHARGING_SOURCES = 34
    OI_MODE = 35
    SONG_NUMBER = 36
    SONG_PLAYING = 37
    STREAM_PACKETS = 38
    REQUESTED_VELOCITY = 39
    REQUESTED_RADIUS = 40
    REQUESTED_RIGHT_VELOCITY = 41
    REQUESTED_LEFT_VELOCITY = 42


_PACKETS = 43


class Led(enum.IntFlag):
    NONE = 0
    PLAY = 1 << 1
    ADVANCE = 1 << 3


class How(enum.IntFlag):
    BESIDE_THE_LOOP = 0
    PAUSE_DRIVING = 1 << 0


class Measure(enum.IntEnum):
    PERIOD = 0
    FRAME_TO_COMMAND = 1


# A type for the reader and type checkers, annotated with the one in C.
_I32 = Annotated[int, ctypes.c_int32]
_U32 = Annotated[int, ctypes.c_uint32]
_I64 = Annotated[int, ctypes.c_int64]
_U64 = Annotated[int, ctypes.c_uint64]
_Double = Annotated[float, ctypes.c_double]
_Text = Annotated[Optional[bytes], ctypes.c_char_p]
_Pointer = Annotated[Optional[int], ctypes.c_void_p]
_PROGRESS = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_char_p)
_Progress = Annotated[Any, _PROGRESS]
_Covariance = Annotated[Sequence[float], ctypes.c_double * 9]
_ProcessName = Annotated[bytes, ctypes.c_char * 16]
_Values = Annotated[Sequence[int], ctypes.c_int32 * _PACKETS]
_Ticks = Annotated[Sequence[int], ctypes.c_int64 * _PACKETS]

_S = TypeVar("_S", bound="_Struct")


class _Struct(ctypes.Structure):
    """Prints its members; `size`, where it has one, is set."""

    def __init__(self, **members: Any) -> None:
        super().__init__(**members)
        if self._fields_[0][0] == "size":
            self.size = ctypes.sizeof(self)

    def __repr__(self) -> str:
        shown = []
        for name, *_ in self._fields_:
            value = getattr(self, name)
            if name == "size" or name.startswith("reserved"):
                continue
            shown.append(f"{name}={list(value) if isinstance(value, ctypes.Array) else value!r}")
        return f"{type(self).__name__}({', '.join(shown)})"


def _struct(cls: type[_S]) -> type[_S]:
    """Makes the members in C of the annotations of a class."""
    hints = typing.get_type_hints(cls, include_extras=True)
    fields = []
    for name in cls.__annotations__:
        hint = hints[name]
        extra = getattr(hint, "__metadata__", None)
        fields.append((name, extra[0] if extra else hint))
    cls._fields_ = fields
    return cls


@_struct
class Wheels(_Struct):
    """Wheel speeds, -500 to 500 mm/s each."""

    left_mm_s: _Double
    right_mm_s: _Double


@_struct
class _SimOptions(_Struct):
    size: _U32
    time: _I32
    seed: _U64
    remainder: _I32
    boot_baud: _U32
    link: _Text
    world: _Text
    lag_s: _Double
    droop_left: _Double
    droop_right: _Double
    noise_mm_s: _Double
    wheel_base_mm: _Double


@_struct
class Truth(_Struct):
    """Where a virtual Create is: what no sensor tells."""

    size: _U32
    mode: _I32
    time_ns: _I64
    left_mm_s: _Double
    right_mm_s: _Double
    x_mm: _Double
    y_mm: _Double
    heading_rad: _Double
    commanded_left_mm_s: _I32
    commanded_right_mm_s: _I32


@_struct
class _Options(_Struct):
    size: _U32
    flags: _U32
    port: _Text
    sim: _Pointer
    config: _Text
    record: _Text
    baud: _U32
    mode: _I32
    remainder: _I32
    priority: _I32
    cpu: _I32
    setpoint_lapse_ms: _U32
    control_budget_us: _U32
    control_overruns: _U32
    link_timeout_ms: _U32
    guard_deadline_ms: _U32
    acceleration_mm_s2: _Double
    jerk_mm_s3: _Double
    wheel_base_mm: _Double
    distance_scale: _Double
    turn_scale: _Double
    progress: _Progress
    progress_context: _Pointer


@_struct
class BringUp(_Struct):
    """What became of the bring-up."""

    size: _U32
    found_baud: _U32
    baud: _U32
    rate_change: _I32
    powered_on: _I32
    resynchronised: _I32
    brc_pulses: _I32
    battery_mv: _I32
    took_ns: _I64


@_struct
class State(_Struct):
    """One tick of the loop."""

    size: _U32
    mode: _I32
    tick: _I64
    time_ns: _I64
    arrival_ns: _I64
    target: Wheels
    set: Wheels
    estimate: Wheels
    command: Wheels
    velocity_mm_s: _Double
    turn_rate_rad_s: _Double
    x_mm: _Double
    y_mm: _Double
    heading_rad: _Double
    distance_mm: _Double
    covariance: _Covariance
    remainder: _I32
    setpoint_lapsed: _I32
    hazards: _U32
    bumps: _U32
    battery_mv: _I32
    reserved: _U32


@_struct
class Event(_Struct):
    """Something that happened; what its kind does not name is 0. str() has it in words."""

    size: _U32
    kind: _I32
    tick: _I64
    time_ns: _I64
    mode: _I32
    hazards: _U32
    overcurrents: _U32
    frames: _U32
    bumps: _U32
    voltage_mv: _I32
    charge_mah: _I32
    capacity_mah: _I32
    process: _I32
    process_name: _ProcessName  # as bytes
    reserved: _U32

    def __str__(self) -> str:
        return describe(self)


@_struct
class Sensors(_Struct):
    """The value of each packet as last told, and the tick that told it (-1: none has yet)."""

    size: _U32
    reserved: _U32
    value: _Values
    reserved_2: _I32
    tick: _Ticks

    def __getitem__(self, packet: int) -> Optional[int]:
        """The value of one packet; None before a frame has told it."""
        packet = _whole("packet", packet, Packet.BUMPS_AND_WHEEL_DROPS, _PACKETS - 1)
        return self.value[packet] if self.tick[packet] >= 0 else None


@_struct
class Statistics(_Struct):
    """What the loop has counted since start()."""

    size: _U32
    scheduler: _I32
    priority: _I32
    memory_locked: _I32
    ticks: _I64
    frames_good: _U64
    frames_bad: _U64
    frames_lost: _U64
    frames_late: _U64
    overruns_wait: _U64
    overruns_read: _U64
    overruns_control: _U64
    overruns_write: _U64
    controls_refused: _U64
    commands_unsent: _U64
    commands_withheld: _U64
    events_dropped: _U64


@_struct
class Distribution(_Struct):
    """What a histogram holds."""

    size: _U32
    reserved: _U32
    count: _U64
    min_ns: _I64
    p50_ns: _I64
    p90_ns: _I64
    p99_ns: _I64
    p999_ns: _I64
    max_ns: _I64
    mean_ns: _Double


class _Note(ctypes.Structure):
    _fields_ = [("number", ctypes.c_uint8), ("duration", ctypes.c_uint8)]


class CargobayError(Exception):
    """A call failed: `code` says who is to blame, `message` what to do about it."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(code, message)
        self.code = code
        self.message = message

    def __str__(self) -> str:
        return f"{self.message} ({_library.cargobay_error_name(self.code).decode()})"


class ArgumentError(CargobayError, ValueError):
    """A value is out of its range; `code` is Error.ARGUMENT."""

    def __init__(self, message: str) -> None:
        super().__init__(Error.ARGUMENT, message)


_CONTROL = ctypes.CFUNCTYPE(
    None, ctypes.c_void_p, ctypes.POINTER(State), ctypes.POINTER(Wheels))


def _checked(result: int, _function: Any, _arguments: Any) -> int:
    if result < 0:
        message = _library.cargobay_error_message().decode(errors="replace")
        raise ArgumentError(message) if result == Error.ARGUMENT else CargobayError(result, message)
    return result


def _load() -> ctypes.CDLL:
    name = os.environ.get("CARGOBAY_LIBRARY") or "libcargobay.so.0"
    try:
        library = ctypes.CDLL(name)
    except OSError as error:
        raise ImportError(
            f"{error}; install libcargobay0, or name the library in CARGOBAY_LIBRARY") from error

    handle, text, size = ctypes.c_void_p, ctypes.c_char_p, ctypes.c_size_t
    integer, unsigned, byte = ctypes.c_int, ctypes.c_uint32, ctypes.c_uint8
    real, time_ns = ctypes.c_double, ctypes.c_int64
    pointer = ctypes.POINTER
    # Functions that return 0, a count or an error.
    functions: dict[str, list[Any]] = {
        "sim_open": [pointer(_SimOptions), pointer(handle)],
        "sim_close": [handle],
        "sim_path": [handle, text, size],
        "sim_inject": [handle, text, text, size],
        "sim_truth": [handle, pointer(Truth)],
        "sim_advance": [handle, time_ns],
        "open": [pointer(_Options), pointer(handle)],
        "close": [handle],
        "get_bring_up": [handle, pointer(BringUp)],
        "get_state": [handle, pointer(State)],
        "wait": [handle, time_ns, pointer(State)],
        "reset_odometry": [handle, real, real, real],
        "set_control": [handle, _CONTROL, handle],
        "start": [handle],
        "stop": [handle],
        "request_stop": [handle],
        "drive_wheels": [handle, real, real],
        "drive": [handle, real, real],
        "drive_radius": [handle, real, real],
        "rearm": [handle],
        "expect_silence": [handle, time_ns],
        "next_event": [handle, pointer(Event)],
        "describe_event": [pointer(Event), text, size],
        "get_sensors": [handle, pointer(Sensors)],
        "subscribe": [handle, unsigned],
        "query": [handle, integer, time_ns, pointer(ctypes.c_int32)],
        "leds": [handle, unsigned, byte, byte],
        "digital_outputs": [handle, unsigned],
        "low_side_drivers": [handle, unsigned],
        "pwm_low_side_drivers": [handle, byte, byte, byte],
        "send_ir": [handle, byte],
        "song": [handle, byte, pointer(_Note), size],
        "play_song": [handle, byte],
        "tune": [handle, byte, text, pointer(ctypes.c_int32)],
        "script": [handle, text, unsigned],
        "play_script": [handle, time_ns],
        "command": [handle, text, unsigned],
        "raw": [handle, text, size, unsigned],
        "get_statistics": [handle, pointer(Statistics)],
        "missing_rights": [handle, text, size],
        "histogram_open": [pointer(handle)],
        "histogram_close": [handle],
        "histogram_record": [handle, time_ns],
        "histogram_get": [handle, pointer(Distribution)],
        "histogram_percentile": [handle, real, pointer(time_ns)],
        "copy_histogram": [handle, integer, handle],
    }
    for name, arguments in functions.items():
        function = getattr(library, "cargobay_" + name)
        function.argtypes = arguments
        function.restype = integer
        function.errcheck = _checked
    library.cargobay_version.argtypes = []
    library.cargobay_version.restype = text
    library.cargobay_error_name.argtypes = [integer]
    library.cargobay_error_name.restype = text
    library.cargobay_packet_name.argtypes = [integer]
    library.cargobay_packet_name.restype = text
    library.cargobay_error_message.argtypes = []
    library.cargobay_error_message.restype = text
    library.cargobay_wheels_of.argtypes = [real, real, real]
    library.cargobay_wheels_of.restype = Wheels
    return library


_library = _load()
_ANSWER_SIZE = 64 * 1024


# ctypes truncates numbers to the size of their type, and text at its first NUL: check all of them
# first.

def _whole(name: str, value: Any, least: int, most: int) -> int:
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"`{name}` must be a whole number, not {type(value).__name__}") from None
    if not least <= number <= most:
        raise ArgumentError(f"`{name}` must be {least} to {most}, not {number}")
    return number


def _int32(name: str, value: Any) -> int:
    return _whole(name, value, -2**31, 2**31 - 1)


def _uint32(name: str, value: Any) -> int:
    return _whole(name, value, 0, 2**32 - 1)


def _byte(name: str, value: Any) -> int:
    return _whole(name, value, 0, 255)


def _real(name: str, value: Any) -> float:
    """What the library makes of NaN and infinities, it says itself."""
    if isinstance(value, (str, bytes, bytearray)) or not hasattr(type(value), "__float__") and (
            not hasattr(type(value), "__index__")):
        raise TypeError(f"`{name}` must be a number, not {type(value).__name__}")
    try:
        return float(value)
    except OverflowError:
        raise ArgumentError(f"`{name}` is larger than any number the library knows") from None


def _text(name: str, value: Any) -> bytes:
    if not isinstance(value, str):
        raise TypeError(f"`{name}` must be a str, not {type(value).__name__}")
    if "\0" in value:
        raise ArgumentError(f"`{name}` has a NUL in it, where the library would end it")
    return value.encode()


def _path(name: str, value: Union[str, os.PathLike[str], None]) -> Optional[bytes]:
    if value is None:
        return None
    try:
        path = os.fsencode(value)
    except TypeError:
        raise TypeError(f"`{name}` must be a path or None, not {type(value).__name__}") from None
    if not path:
        raise ArgumentError(f"`{name}` is empty; None is the default")
    if b"\0" in path:
        raise ArgumentError(f"`{name}` has a NUL in it, which no path may have")
    return path


def _seconds(name: str, value: Any) -> float:
    seconds = _real(name, value)
    if not 0.0 <= seconds < math.inf:
        raise ArgumentError(f"`{name}` must be 0 or more seconds, not {seconds}")
    return seconds


def _ns(name: str, value: Any) -> int:
    return min(round(_seconds(name, value) * 1e9), 2**63 - 1)


def _timeout_ns(name: str, value: Any) -> int:
    """None: for ever."""
    return -1 if value is None else _ns(name, value)


def _units(name: str, value: Any, per_second: float) -> int:
    """A time as a count that is not 0, the default, unless the time is."""
    seconds = _seconds(name, value)
    count = max(round(min(seconds * per_second, 2.0**33)), 1) if seconds > 0.0 else 0
    return _uint32(name, count)


def version() -> str:
    """The version of the library that runs."""
    name: bytes = _library.cargobay_version()
    return name.decode()


def packet_name(packet: Union[Packet, int]) -> str:
    """The name of a packet, as the command has it."""
    name: bytes = _library.cargobay_packet_name(_int32("packet", packet))
    return name.decode()


def wheels_of(velocity_mm_s: float, turn_rate_rad_s: float, wheel_base_mm: float = 258.0) -> Wheels:
    """Wheel speeds of velocity and turn rate."""
    wheels: Wheels = _library.cargobay_wheels_of(
        _real("velocity_mm_s", velocity_mm_s), _real("turn_rate_rad_s", turn_rate_rad_s),
        _real("wheel_base_mm", wheel_base_mm))
    return wheels


def describe(event: Event) -> str:
    """An event in words."""
    if not isinstance(event, Event):
        raise TypeError(f"`event` must be an Event, not {type(event).__name__}")
    text = ctypes.create_string_buffer(512)
    _library.cargobay_describe_event(ctypes.byref(event), text, len(text))
    return text.value.decode(errors="replace")


# What is open in this process, by handle: the name of the function that closes it, and the handle
# of the virtual Create that it uses, if any. Handles are never used twice.
_open: dict[int, tuple[str, Optional[int]]] = {}
# Robots whose control function had not returned when they were closed, by their handles.
_stalled: set[int] = set()


def _close(handle: int) -> None:
    """Closes it, once."""
    name, sim = _open.pop(handle, ("", None))
    if not name:
        return
    try:
        getattr(_library, name)(handle)
    except CargobayError as error:
        if error.code == Error.STALLED:
            _stalled.add(handle)
        if error.code == Error.STATE:
            _open[handle] = (name, sim)  # a failure leaves it open
        raise


def _keep_for_ever(what: Any) -> None:
    """Not even the end of the interpreter frees it."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(what))


def _close_robots(sim: Optional[int] = None) -> None:
    """All robots, or those that are this virtual Create."""
    for handle, (name, of) in list(_open.items()):
        if name == Robot._closer and sim in (None, of):
            with contextlib.suppress(CargobayError):
                _close(handle)


@atexit.register
def _close_all() -> None:
    """While there is still an interpreter for the control functions."""
    _close_robots()
    for handle in list(_open):
        with contextlib.suppress(CargobayError):
            _close(handle)


# They belong to the parent, whose robots drive on.
os.register_at_fork(after_in_child=_open.clear)


class _Handle:
    """What is closed once; after that its functions raise Error.HANDLE."""

    _closer: str
    _handle: Optional[int] = None  # until it is open

    def _opened(self, handle: ctypes.c_void_p, sim: Optional[int] = None) -> None:
        assert handle.value is not None
        _open[handle.value] = (self._closer, sim)
        self._handle = handle.value

    def close(self) -> None:
        """Again: nothing."""
        handle = self._handle
        try:
            if handle is not None:
                _close(handle)
        finally:
            if handle not in _open:
                self._handle = None

    def __del__(self) -> None:
        # In a collected cycle nothing is taken apart before each of these has run.
        if not _open or self._handle not in _open:
            return
        try:
            warnings.warn(f"{self!r} was not closed", ResourceWarning, source=self)
        finally:
            with contextlib.suppress(BaseException):  # nothing can catch it here
                self.close()


class VirtualCreate(_Handle):
    """A virtual Create: a context manager, to be left after the robot that is it."""

    _closer = "cargobay_sim_close"

    def __init__(self, *, time: SimTime = SimTime.REAL, seed: int = 0,
                 remainder: Remainder = Remainder.UNKNOWN, boot_baud: int = 0,
                 link: Union[str, os.PathLike[str], None] = None,
                 world: Union[str, os.PathLike[str], None] = None, lag_s: float = 0.0,
                 droop_left: float = 0.0, droop_right: float = 0.0, noise_mm_s: float = 0.0,
                 wheel_base_mm: float = 0.0) -> None:
        """0 and None are the defaults of struct cargobay_sim_options."""
        options = _SimOptions(
            time=_int32("time", time), seed=_whole("seed", seed, 0, 2**64 - 1),
            remainder=_int32("remainder", remainder), boot_baud=_uint32("boot_baud", boot_baud),
            link=_path("link", link), world=_path("world", world), lag_s=_real("lag_s", lag_s),
            droop_left=_real("droop_left", droop_left),
            droop_right=_real("droop_right", droop_right),
            noise_mm_s=_real("noise_mm_s", noise_mm_s),
            wheel_base_mm=_real("wheel_base_mm", wheel_base_mm))
        handle = ctypes.c_void_p()
        _library.cargobay_sim_open(ctypes.byref(options), ctypes.byref(handle))
        self._opened(handle)

    def __del__(self) -> None:
        # One that is collected together with its robot may come first.
        if _open and self._handle in _open:
            _close_robots(self._handle)
        super().__del__()

    def __enter__(self) -> VirtualCreate:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def path(self) -> str:
        """The pseudo-terminal that any OI client may open; not in virtual time."""
        path = ctypes.create_string_buffer(4096)
        _library.cargobay_sim_path(self._handle, path, len(path))
        return os.fsdecode(path.value)

    def inject(self, line: str) -> str:
        """Does something to it, as "bump left" or "fault lost 0.01"; returns its answer."""
        answer = ctypes.create_string_buffer(_ANSWER_SIZE)
        _library.cargobay_sim_inject(self._handle, _text("line", line), answer, len(answer))
        return answer.value.decode(errors="replace")

    def truth(self) -> Truth:
        """Where it truly is."""
        truth = Truth()
        _library.cargobay_sim_truth(self._handle, ctypes.byref(truth))
        return truth

    def advance(self, duration_s: float) -> None:
        """Lets time pass without a robot."""
        _library.cargobay_sim_advance(self._handle, _ns("duration_s", duration_s))


# Wheel speeds, or a pair of left and right.
Control = Callable[[State], Union[Wheels, "tuple[float, float]"]]


class _Shared:
    """What a robot and its control function know of each other, without holding each other."""

    def __init__(self) -> None:
        self.handle: Optional[int] = None
        self.raised: Optional[BaseException] = None

    def reraise(self) -> None:
        """What was raised there, once, where somebody can catch it."""
        raised, self.raised = self.raised, None
        if raised is not None:
            raise raised


class Robot(_Handle):
    """A robot, brought up: a context manager. Without a port, a virtual Create."""

    _closer = "cargobay_close"

    def __init__(self, port: Union[str, os.PathLike[str], None] = None, *,
                 sim: Optional[VirtualCreate] = None,
                 config: Union[str, os.PathLike[str], None] = None, use_config: bool = True,
                 baud: int = 0, mode: Union[Mode, int] = 0,
                 remainder: Remainder = Remainder.UNKNOWN, priority: int = 0,
                 cpu: Optional[int] = None, require_realtime: bool = False, guard: bool = True,
                 hold_on_mode_loss: bool = False, open_loop: bool = False,
                 setpoint_lapse_s: float = 0.0, control_budget_s: float = 0.0,
                 control_overruns: int = 0, link_timeout_s: float = 0.0,
                 guard_deadline_s: float = 0.0, acceleration_mm_s2: float = 0.0,
                 jerk_mm_s3: float = 0.0, wheel_base_mm: float = 0.0, distance_scale: float = 0.0,
                 turn_scale: float = 0.0, record: Union[str, os.PathLike[str], None] = None,
                 progress: Optional[Callable[[str, str], None]] = None) -> None:
        """0 and None are the defaults of struct cargobay_options."""
        if sim is not None and not isinstance(sim, VirtualCreate):
            raise TypeError(f"`sim` must be a VirtualCreate or None, not {type(sim).__name__}")
        if sim is not None and sim._handle is None:
            raise CargobayError(Error.HANDLE, "`sim` is closed; open another VirtualCreate")
        if progress is not None and not callable(progress):
            raise TypeError(f"`progress` must be a function or None, not {type(progress).__name__}")
        self._sim = sim  # it must outlive this
        self._control: Any = None  # what C calls must not be collected
        shared = self._shared = _Shared()
        flags = _Flag(0)
        for wanted, flag in ((require_realtime, _Flag.REQUIRE_REALTIME),
                             (not guard, _Flag.NO_GUARD),
                             (hold_on_mode_loss, _Flag.HOLD_ON_MODE_LOSS),
                             (open_loop, _Flag.OPEN_LOOP),
                             (cpu is not None, _Flag.PIN_CPU),
                             (not use_config, _Flag.NO_CONFIG)):
            if wanted:
                flags |= flag

        def tell(_context: Any, step: bytes, detail: bytes) -> None:
            if progress is None or shared.raised is not None:
                return
            try:
                progress((step or b"").decode(), (detail or b"").decode(errors="replace"))
            except BaseException as raised:  # nothing may escape into C
                shared.raised = raised

        options = _Options(
            flags=flags, port=_path("port", port), sim=sim._handle if sim is not None else None,
            config=_path("config", config), baud=_uint32("baud", baud), mode=_int32("mode", mode),
            remainder=_int32("remainder", remainder), priority=_int32("priority", priority),
            cpu=0 if cpu is None else _int32("cpu", cpu),
            setpoint_lapse_ms=_units("setpoint_lapse_s", setpoint_lapse_s, 1e3),
            control_budget_us=_units("control_budget_s", control_budget_s, 1e6),
            control_overruns=_uint32("control_overruns", control_overruns),
            link_timeout_ms=_units("link_timeout_s", link_timeout_s, 1e3),
            guard_deadline_ms=_units("guard_deadline_s", guard_deadline_s, 1e3),
            acceleration_mm_s2=_real("acceleration_mm_s2", acceleration_mm_s2),
            jerk_mm_s3=_real("jerk_mm_s3", jerk_mm_s3),
            wheel_base_mm=_real("wheel_base_mm", wheel_base_mm),
            distance_scale=_real("distance_scale", distance_scale),
            turn_scale=_real("turn_scale", turn_scale), record=_path("record", record),
            progress=_PROGRESS(tell) if progress else _PROGRESS(0))
        handle = ctypes.c_void_p()
        try:
            _library.cargobay_open(ctypes.byref(options), ctypes.byref(handle))
        except CargobayError:
            shared.reraise()
            raise
        self._opened(handle, sim._handle if sim is not None else None)
        shared.handle = self._handle
        if shared.raised is not None:
            self.close()

    def __enter__(self) -> Robot:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        if error is None:
            self.close()
            return
        with contextlib.suppress(BaseException):  # the first error counts
            self.close()

    def close(self) -> None:
        """Stops the robot if it was not. Raises what the control function had raised, if nobody
        else has seen it. Where that function does not return: Error.STALLED, and it is closed."""
        handle = self._handle
        try:
            super().close()
        finally:
            if handle in _stalled:
                _keep_for_ever(self._control)
            self._shared.reraise()

    def __del__(self) -> None:
        if _stalled and self._handle in _stalled:  # closed by its handle alone
            _keep_for_ever(self._control)
        super().__del__()

    def bring_up(self) -> BringUp:
        """How the bring-up went."""
        bring_up = BringUp()
        _library.cargobay_get_bring_up(self._handle, ctypes.byref(bring_up))
        return bring_up


    def set_control(self, control: Optional[Control]) -> None:
        """Gives the loop a control function in place of setpoints, before start().

        It is called once a frame and must not block. What it raises ends the loop, and is raised
        again by wait(), stop(), or at the end of the `with`. The state is valid during the call.
        """
        if control is not None and not callable(control):
            raise TypeError(f"`control` must be a function or None, not {type(control).__name__}")
        shared = self._shared

        def call(_context: Any, state: Any, wheels: Any) -> None:
            try:
                answer = control(state.contents) if control is not None else (0.0, 0.0)
                if not isinstance(answer, Wheels):
                    left_mm_s, right_mm_s = answer
                    answer = Wheels(left_mm_s=_real("left_mm_s", left_mm_s),
                                    right_mm_s=_real("right_mm_s", right_mm_s))
                wheels[0] = answer
            except BaseException as raised:  # nothing may escape into C
                shared.raised = shared.raised or raised
                with contextlib.suppress(CargobayError):
                    _library.cargobay_request_stop(shared.handle)

        wrapped = _CONTROL(call) if control is not None else _CONTROL(0)
        _library.cargobay_set_control(self._handle, wrapped, None)
        self._control = wrapped

    def start(self) -> None:
        """Starts the loop."""
        _library.cargobay_start(self._handle)

    def stop(self) -> None:
        """Ends the loop: the robot stands, in Passive mode. Raises what it had ended by."""
        try:
            _library.cargobay_stop(self._handle)
        finally:
            self._shared.reraise()

    def request_stop(self) -> None:
        """Asks the loop to end; stop() is still to be called."""
        _library.cargobay_request_stop(self._handle)

    def state(self) -> State:
        """The state of the newest tick."""
        state = State()
        _library.cargobay_get_state(self._handle, ctypes.byref(state))
        return state

    def wait(self, timeout_s: Optional[float] = None) -> State:
        """The state of the next frame that this thread has not seen; None: however long it takes.

        In virtual time it makes time pass.
        """
        state = State()
        try:
            _library.cargobay_wait(self._handle, _timeout_ns("timeout_s", timeout_s),
                                   ctypes.byref(state))
        except CargobayError:
            self._shared.reraise()
            raise
        return state

    def states(self, duration_s: Optional[float] = None) -> Iterator[State]:
        """The state of each frame, for so long in the robot's time, or until the loop ends."""
        duration_ns = None if duration_s is None else _ns("duration_s", duration_s)
        return self._states(duration_ns)

    def _states(self, duration_ns: Optional[int]) -> Iterator[State]:
        begin_ns: Optional[int] = None
        while True:
            state = self.wait()
            begin_ns = state.time_ns if begin_ns is None else begin_ns
            if duration_ns is not None and state.time_ns - begin_ns >= duration_ns:
                return
            yield state

    def reset_odometry(self, x_mm: float = 0.0, y_mm: float = 0.0,
                       heading_rad: float = 0.0) -> None:
        """Puts the odometry somewhere, from the next frame on."""
        _library.cargobay_reset_odometry(
            self._handle, _real("x_mm", x_mm), _real("y_mm", y_mm),
            _real("heading_rad", heading_rad))


    def drive_wheels(self, left_mm_s: float, right_mm_s: float) -> None:
        """Sets the speed of each wheel, until it lapses: after half a second."""
        _library.cargobay_drive_wheels(
            self._handle, _real("left_mm_s", left_mm_s), _real("right_mm_s", right_mm_s))

    def drive(self, velocity_mm_s: float, turn_rate_rad_s: float) -> None:
        """Sets velocity and turn rate, which is positive to the left."""
        _library.cargobay_drive(
            self._handle, _real("velocity_mm_s", velocity_mm_s),
            _real("turn_rate_rad_s", turn_rate_rad_s))

    def drive_radius(self, velocity_mm_s: float, radius_mm: float) -> None:
        """Sets velocity and radius: positive to the left; math.inf: straight on; 0: in place."""
        _library.cargobay_drive_radius(
            self._handle, _real("velocity_mm_s", velocity_mm_s), _real("radius_mm", radius_mm))

    def rearm(self) -> None:
        """Tells the robot to go back to its mode after it was lost (`hold_on_mode_loss`)."""
        _library.cargobay_rearm(self._handle)

    def expect_silence(self, duration_s: float) -> None:
        """For so long the robot's silence is no lost link."""
        _library.cargobay_expect_silence(self._handle, _ns("duration_s", duration_s))


    def events(self) -> list[Event]:
        """The events that nobody took yet, the oldest first."""
        taken = []
        event = Event()
        while _library.cargobay_next_event(self._handle, ctypes.byref(event)):
            taken.append(event)
            event = Event()
        return taken

    def sensors(self) -> Sensors:
        """All sensors, as far as the frames told of them: sensors()[Packet.VOLTAGE]."""
        sensors = Sensors()
        _library.cargobay_get_sensors(self._handle, ctypes.byref(sensors))
        return sensors

    def subscribe(self, extras: Union[Extra, int]) -> None:
        """Which of the extra lists are streamed from now on."""
        _library.cargobay_subscribe(self._handle, _uint32("extras", extras))

    def query(self, packet: Union[Packet, int], timeout_s: Optional[float] = 1.0) -> int:
        """Asks for one packet: its value, sampled after the call."""
        value = ctypes.c_int32()
        _library.cargobay_query(self._handle, _int32("packet", packet),
                                _timeout_ns("timeout_s", timeout_s), ctypes.byref(value))
        return value.value


    def leds(self, leds: Union[Led, int], power_color: int, power_intensity: int) -> None:
        """Power LED: colour 0 (green) to 255 (red), intensity 0 to 255."""
        _library.cargobay_leds(
            self._handle, _uint32("leds", leds), _byte("power_color", power_color),
            _byte("power_intensity", power_intensity))

    def digital_outputs(self, outputs: int) -> None:
        _library.cargobay_digital_outputs(self._handle, _uint32("outputs", outputs))

    def low_side_drivers(self, drivers: int) -> None:
        _library.cargobay_low_side_drivers(self._handle, _uint32("drivers", drivers))

    def pwm_low_side_drivers(self, driver_0: int, driver_1: int, driver_2: int) -> None:
        """Duty cycles, 0 to 128."""
        _library.cargobay_pwm_low_side_drivers(
            self._handle, _byte("driver_0", driver_0), _byte("driver_1", driver_1),
            _byte("driver_2", driver_2))

    def send_ir(self, byte: int) -> None:
        _library.cargobay_send_ir(self._handle, _byte("byte", byte))

    def song(self, slot: int, notes: Sequence[tuple[int, int]]) -> None:
        """Stores a song of pairs: MIDI number and duration in 1/64 s."""
        try:
            pairs = [(number, duration) for number, duration in notes]
        except (TypeError, ValueError):
            raise TypeError("`notes` must be pairs of MIDI number and duration in 1/64 s") from None
        array = (_Note * len(pairs))(*(
            _Note(_byte("number", number), _byte("duration", duration))
            for number, duration in pairs))
        _library.cargobay_song(self._handle, _byte("slot", slot), array, len(pairs))

    def play_song(self, slot: int) -> None:
        _library.cargobay_play_song(self._handle, _byte("slot", slot))

    def tune(self, slot: int, rtttl: str) -> list[int]:
        """Stores a tune in RTTTL in song slots from `slot` on: the duration of each in 1/64 s."""
        durations = (ctypes.c_int32 * 16)()
        count = _library.cargobay_tune(self._handle, _byte("slot", slot), _text("rtttl", rtttl),
                                        durations)
        return list(durations[:count])

    def script(self, text: str, how: Union[How, int] = How.BESIDE_THE_LOOP) -> None:
        """Stores a script, as "drive 300 straight; wait_distance 400; drive 0 0"."""
        _library.cargobay_script(self._handle, _text("text", text), _uint32("how", how))

    def play_script(self, expected_s: float) -> None:
        """Plays it; `expected_s` is how long it may take."""
        _library.cargobay_play_script(self._handle, _ns("expected_s", expected_s))

    def command(self, text: str, how: Union[How, int] = How.BESIDE_THE_LOOP) -> None:
        """Any command as text: "leds play 0 255"."""
        _library.cargobay_command(self._handle, _text("text", text), _uint32("how", how))

    def raw(self, data: bytes, how: Union[How, int] = How.BESIDE_THE_LOOP) -> None:
        """One or more whole commands as bytes."""
        if not isinstance(data, (bytes, bytearray, memoryview)):
            raise TypeError(f"`data` is bytes, not {type(data).__name__}")
        held = bytes(data)
        _library.cargobay_raw(self._handle, held, len(held), _uint32("how", how))


    def missing_rights(self) -> str:
        """What the kernel refused the loop, a line for each right, with what to do about it."""
        text = ctypes.create_string_buffer(2048)
        _library.cargobay_missing_rights(self._handle, text, len(text))
        return text.value.decode(errors="replace")

    def statistics(self) -> Statistics:
        """The loop's counters."""
        statistics = Statistics()
        _library.cargobay_get_statistics(self._handle, ctypes.byref(statistics))
        return statistics

    def histogram(self, measure: Union[Measure, int]) -> Histogram:
        """A copy of what the loop has measured of itself so far; to be closed."""
        histogram = Histogram()
        try:
            _library.cargobay_copy_histogram(
                self._handle, _int32("measure", measure), histogram._handle)
        except (CargobayError, TypeError):
            histogram.close()
            raise
        return histogram


class Histogram(_Handle):
    """A histogram of times with fixed memory: a context manager."""

    _closer = "cargobay_histogram_close"

    def __init__(self) -> None:
        handle = ctypes.c_void_p()
        _library.cargobay_histogram_open(ctypes.byref(handle))
        self._opened(handle)

    def __enter__(self) -> Histogram:
        return self

    def __exit__(self, kind: Optional[type[BaseException]], error: Optional[BaseException],
                 trace: Optional[TracebackType]) -> None:
        self.close()

    def record(self, time_ns: int) -> None:
        """Counts a time."""
        _library.cargobay_histogram_record(
            self._handle, _whole("time_ns", time_ns, -2**63, 2**63 - 1))

    def distribution(self) -> Distribution:
        """What it holds."""
        distribution = Distribution()
        _library.cargobay_histogram_get(self._handle, ctypes.byref(distribution))
        return distribution

    def percentile_ns(self, percent: float) -> int:
        """The time that `percent` of what it holds do not exceed."""
        time_ns = ctypes.c_int64()
        _library.cargobay_histogram_percentile(
            self._handle, _real("percent", percent), ctypes.byref(time_ns))
        return time_ns.value
