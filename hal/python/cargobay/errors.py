"""What a call may raise, by what to do about it.

    try:
        robot = Robot("/dev/ttyUSB0")
    except (NoPort, Busy, NoAccess) as error:
        sys.exit(str(error))

cargobay.h says at each function which codes it returns; each code is an exception here, and each
group of codes a base class of them. All have `code` and `message`, which also says what to do. A
value of a wrong type is a TypeError that names the parameter.
"""

from __future__ import annotations

from .enums import ErrorCode


class Error(Exception):
    """A call failed."""

    code: ErrorCode = ErrorCode.OK  # of a class below, or of a newer library's own
    message: str

    def __init__(self, message: str) -> None:
        super().__init__(message)
        self.message = message

    def __str__(self) -> str:
        return f"{self.message} (CARGOBAY_E_{self.code.name})"


class ProgramError(Error):
    """Mend the program."""


class SettingError(Error):
    """Mend a file or a setting."""


class MachineError(Error):
    """Mend the machine."""


class LinkError(Error):
    """Mend the connection."""


class RobotError(Error):
    """Look at the robot."""


class LoopError(Error):
    """The loop or its guard was in trouble; the robot was stopped."""


class TryAgain(Error):
    """Later, or otherwise, it may work."""


class ArgumentError(ProgramError, ValueError):
    """A value is not a number, or out of its range."""

    code = ErrorCode.ARGUMENT


class HandleError(ProgramError):
    """It is closed, or belongs to the parent of this process."""

    code = ErrorCode.HANDLE


class StateError(ProgramError):
    """Called in the wrong order: before the start, after the end."""

    code = ErrorCode.STATE


class ThreadError(ProgramError):
    """Called from the control function, or beside the owner."""

    code = ErrorCode.THREAD


class UnsupportedError(ProgramError):
    """This robot, or this kind of time, has no such thing."""

    code = ErrorCode.UNSUPPORTED


class ControlError(ProgramError):
    """The control function failed, or was too slow."""

    code = ErrorCode.CONTROL


class ConfigError(SettingError):
    """The configuration file, `settings`, or a value in them."""

    code = ErrorCode.CONFIG


class FileError(SettingError):
    """A file cannot be read or written: a world, a recording."""

    code = ErrorCode.FILE


class RightsError(SettingError):
    """Required real-time rights were not granted."""

    code = ErrorCode.RIGHTS


class OutOfMemory(MachineError, MemoryError):
    """Memory ran out."""

    code = ErrorCode.MEMORY


class LimitReached(MachineError):
    """Of handles, threads or descriptors."""

    code = ErrorCode.LIMIT


class SystemRefused(MachineError):
    """The system refused something else."""

    code = ErrorCode.SYSTEM


class NoPort(LinkError):
    """There is no such port, or it is no terminal."""

    code = ErrorCode.NO_PORT


class Busy(LinkError):
    """Another program, or another robot here, uses it."""

    code = ErrorCode.BUSY


class NoAccess(LinkError):
    """This user may not open the port or the pin."""

    code = ErrorCode.ACCESS


class PinError(LinkError):
    """A pin is missing, in use, or does not follow."""

    code = ErrorCode.PIN


class Unplugged(LinkError):
    """The port hung up during the drive."""

    code = ErrorCode.UNPLUGGED


class Silent(LinkError):
    """The robot does not answer, or has gone silent."""

    code = ErrorCode.SILENT


class Unconfirmed(RobotError):
    """Told to stop, it did not confirm: it may be moving."""

    code = ErrorCode.UNCONFIRMED


class ModeLost(RobotError):
    """It left its mode, or is in one that does not allow this: a cliff, a wheel drop, a charger."""

    code = ErrorCode.MODE


class Stalled(LoopError):
    """The process hung, and its guard stopped the robot."""

    code = ErrorCode.STALLED


class GuardError(LoopError):
    """The guard cannot start, or died or was suspended."""

    code = ErrorCode.GUARD


class WheelsError(LoopError):
    """A wheel is stuck, or distance and angle cannot be true: its event says which."""

    code = ErrorCode.WHEELS


class LineFull(TryAgain):
    """No room on the line for this now."""

    code = ErrorCode.FULL


class TimedOut(TryAgain, TimeoutError):
    """The time ran out first."""

    code = ErrorCode.TIMEOUT


class NoFrame(TryAgain):
    """No frame has come yet."""

    code = ErrorCode.NO_FRAME


class Cancelled(TryAgain):
    """`progress` gave up."""

    code = ErrorCode.CANCELLED


def _leaves(kind: type[Error]) -> dict[int, type[Error]]:
    found = {int(kind.code): kind} if kind.code else {}
    for below in kind.__subclasses__():
        found |= _leaves(below)
    return found


_BY_CODE = _leaves(Error)


def error_of(code: int, message: str) -> Error:
    """The exception for a code; a plain Error for one that only a newer library knows."""
    kind = _BY_CODE.get(code)
    if kind is not None:
        return kind(message)
    error = Error(message)
    error.code = ErrorCode(code)
    return error
