"""The numbers of cargobay.h by name: each enumeration has its name in C, without `cargobay_`."""

from __future__ import annotations

import enum
from typing import Final, Self


class _Number(enum.IntEnum):
    """A number that a newer library added has a name too, and is no error."""

    @classmethod
    def _missing_(cls, value: object) -> Self | None:
        if not isinstance(value, int):
            return None
        member = int.__new__(cls, value)
        member._name_ = f"UNKNOWN_{value}".replace("-", "MINUS_")
        member._value_ = value
        return member


class ErrorCode(_Number):
    """Why a call failed; cargobay.errors has an exception for each."""

    OK = 0
    ARGUMENT = -1
    HANDLE = -2
    STATE = -3
    THREAD = -4
    UNSUPPORTED = -5
    CONTROL = -6
    CONFIG = -7
    FILE = -8
    RIGHTS = -9
    MEMORY = -10
    LIMIT = -11
    SYSTEM = -12
    NO_PORT = -13
    BUSY = -14
    ACCESS = -15
    PIN = -16
    UNPLUGGED = -17
    SILENT = -18
    UNCONFIRMED = -19
    MODE = -20
    STALLED = -21
    GUARD = -22
    FULL = -23
    TIMEOUT = -24
    NO_FRAME = -25
    CANCELLED = -26
    WHEELS = -27


class SimTime(_Number):
    """How time passes for a virtual Create."""

    REAL = 0
    VIRTUAL = 1


class Remainder(_Number):
    """What happens to the fraction that reading packet 19 or 20 leaves."""

    FIND_OUT = -1
    UNKNOWN = 0
    CARRIED = 1
    LOST = 2


class Mode(_Number):
    """OI mode, packet 35 (OI p. 6)."""

    OFF = 0
    PASSIVE = 1
    SAFE = 2
    FULL = 3


class Flag(enum.IntFlag):
    """How to drive a robot: Robot(flags=...)."""

    REQUIRE_REALTIME = 1 << 0
    NO_REALTIME = 1 << 1
    NO_GUARD = 1 << 2
    HOLD_ON_MODE_LOSS = 1 << 3
    OPEN_LOOP = 1 << 4
    PIN_CPU = 1 << 5
    NO_CONFIG = 1 << 6
    NO_LEARNT = 1 << 7
    FORGET = 1 << 8
    HOLD_HEADING = 1 << 9
    DRIVE_ON = 1 << 10
    PUBLISH = 1 << 11


class RateChange(_Number):
    """How the bring-up changed the baud rate."""

    NONE = 0
    BRC = 1
    COMMAND = 2


class Feature(enum.IntFlag):
    """What a robot has."""

    LEDS = 1 << 0
    SONGS = 1 << 1
    SCRIPTS = 1 << 2
    DIGITAL_OUTPUTS = 1 << 3
    LOW_SIDE_DRIVERS = 1 << 4
    SEND_IR = 1 << 5
    VIRTUAL_TIME = 1 << 6


class Hazard(enum.IntFlag):
    """What makes Safe mode stop the robot (OI p. 6)."""

    WHEEL_DROP_LEFT = 1 << 0
    WHEEL_DROP_RIGHT = 1 << 1
    WHEEL_DROP_FRONT = 1 << 2
    CLIFF_LEFT = 1 << 3
    CLIFF_FRONT_LEFT = 1 << 4
    CLIFF_FRONT_RIGHT = 1 << 5
    CLIFF_RIGHT = 1 << 6
    CHARGER = 1 << 7


class Bump(enum.IntFlag):
    """Which bumpers are pressed."""

    LEFT = 1 << 0
    RIGHT = 1 << 1


class Button(enum.IntFlag):
    """Which buttons are pressed."""

    PLAY = 1 << 0
    ADVANCE = 1 << 1


class Overcurrent(enum.IntFlag):
    """What draws too much current."""

    WHEEL_LEFT = 1 << 0
    WHEEL_RIGHT = 1 << 1
    LOW_SIDE_DRIVER_0 = 1 << 2
    LOW_SIDE_DRIVER_1 = 1 << 3
    LOW_SIDE_DRIVER_2 = 1 << 4


class Wheel(enum.IntFlag):
    """Which wheels."""

    LEFT = 1 << 0
    RIGHT = 1 << 1


class Limit(enum.IntFlag):
    """What holds the wheels back from the speeds asked for."""

    SPEED = 1 << 0
    ACCELERATION = 1 << 1


class Finding(_Number):
    """What is wrong with a wheel or its counter."""

    NOTHING = 0
    STILL = 1
    REVERSED = 2
    FEW = 3
    JUMPS = 4


class OutputKind(_Number):
    """What a control function wants; in Python the type of its answer says so."""

    WHEELS = 0
    TWIST = 1
    SETPOINT = 2


class EventKind(_Number):
    """What happened; Event says which of its members belong to which kind."""

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
    WHEEL_STUCK = 17
    COUNTERS_IMPLAUSIBLE = 18
    LIMIT_BEGAN = 19
    LIMIT_ENDED = 20


class Packet(_Number):
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


class Led(enum.IntFlag):
    """LEDs beside the power LED (OI p. 9)."""

    PLAY = 1 << 0
    ADVANCE = 1 << 1


class How(enum.IntFlag):
    """How a command that is too long for the line beside the loop's own is sent."""

    PAUSE_DRIVING = 1 << 0


class Measure(_Number):
    """What the loop measures about itself."""

    PERIOD = 0
    FRAME_TO_COMMAND = 1


class Answer(enum.Enum):
    """What a control function may answer instead of speeds."""

    SETPOINT = "the latest setpoint, as if there were no control function"
    FINISHED = "the loop ends as asked"


SETPOINT: Final = Answer.SETPOINT
FINISHED: Final = Answer.FINISHED
