"""Cargobay from Python: the iRobot Create, and a virtual Create to try everything on.

    from cargobay import Robot

    with Robot("/dev/ttyUSB0") as robot:
        robot.start()
        for state in robot.states(2.0):
            robot.drive(200.0, 0.0)

cargobay.h is the manual of every function and member. Names are those in C: `cargobay_drive()` is
`Robot.drive()`, `cargobay_get_state()` is `Robot.state`, `cargobay_sim_inject()` is `Sim.inject()`,
CARGOBAY_MODE_SAFE is `Mode.SAFE`, CARGOBAY_E_BUSY is the exception `Busy` (cargobay.errors).
`Robot.end()` ends the loop; why it has ended, `cargobay_get_end()`, is `Robot.end_report`. Times
are given in seconds or as timedelta (`_s`), and reported in ns (`_ns`). What is reported is a copy:
it may be kept. cargobay.aio is for asyncio, cargobay.tables for recorded drives as numpy arrays.

The library is searched for below the prefix of this package, then by the loader; $CARGOBAY_LIBRARY
names another instead.

A robot that is no longer used is closed: at the end of its `with`, when it is collected, or at the
end of the program; not in a forked child, whose parent drives on.

Python is not a real-time language: write a controller as a loop over states(). A control function
works too, but on a robot the loop's thread has to wait for the interpreter, for up to 5 ms while
another Python thread computes. In virtual time this does not matter.
"""

from __future__ import annotations

from ._callbacks import Control, Progress
from ._names import error_name, event_name, mode_name, packet_name, settings, version
from .enums import (FINISHED, SETPOINT, Answer, Bump, Button, ErrorCode, EventKind, Feature,
                    Finding, Flag, Hazard, How, Led, Limit, Measure, Mode, OutputKind, Overcurrent,
                    Packet, RateChange, Remainder, SimTime, Wheel)
from .errors import (ArgumentError, Busy, Cancelled, ConfigError, ControlError, Error, FileError,
                     GuardError, HandleError, LimitReached, LineFull, LinkError, LoopError,
                     MachineError, ModeLost, NoAccess, NoFrame, NoPort, OutOfMemory, PinError,
                     ProgramError, RightsError, RobotError, SettingError, Silent, Stalled,
                     StateError, SystemRefused, ThreadError, TimedOut, TryAgain, Unconfirmed,
                     Unplugged, UnsupportedError, WheelsError)
from .events import Event
from .histogram import Histogram
from .records import (BringUp, Distribution, EndReport, Info, Learnt, Note, Reading, Setting,
                      State, Statistics, Truth, Twist, Wheels)
from .robot import Robot
from .sim import Sim

__all__ = [
    "FINISHED", "SETPOINT", "Answer", "ArgumentError", "BringUp", "Bump", "Busy", "Button",
    "Cancelled", "ConfigError", "Control", "ControlError", "Distribution", "EndReport", "Error",
    "ErrorCode", "Event", "EventKind", "Feature", "FileError", "Finding", "Flag", "GuardError",
    "HandleError", "Hazard", "Histogram", "How", "Info", "Learnt", "Led", "Limit", "LimitReached",
    "LineFull", "LinkError", "LoopError", "MachineError", "Measure", "Mode", "ModeLost", "NoAccess",
    "NoFrame", "NoPort", "Note", "OutOfMemory", "OutputKind", "Overcurrent", "Packet", "PinError",
    "ProgramError", "Progress", "RateChange", "Reading", "Remainder", "RightsError", "Robot",
    "RobotError", "Setting", "SettingError", "Silent", "Sim", "SimTime", "Stalled", "State",
    "StateError", "Statistics", "SystemRefused", "ThreadError", "TimedOut", "Truth", "TryAgain",
    "Twist", "Unconfirmed", "Unplugged", "UnsupportedError", "Wheel", "Wheels", "WheelsError",
    "error_name", "event_name", "mode_name", "packet_name", "settings", "version",
]
