"""The functions of the program that C calls, and what they raise."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NoReturn, Optional, TypeAlias, Union

from . import _signals
from . import _structs as c
from .enums import FINISHED, SETPOINT, Answer, OutputKind
from .errors import ControlError
from .records import State, Twist, Wheels

Control: TypeAlias = Callable[[State], Union[Wheels, Twist, Answer]]
Progress: TypeAlias = Callable[[str, str], Optional[bool]]

_GO_ON, _FINISHED, _FAILED = 0, 1, -1
_GIVE_UP = 1


class Callbacks:
    """What a robot and the functions that C calls share, without holding each other."""

    def __init__(self, progress: Progress | None) -> None:
        self.raised: BaseException | None = None
        self.seen: BaseException | None = None  # the one that was raised again before
        self.deferred: _signals.Deferred | None = None
        self.progress = progress_of(self, progress)

    def reraise(self) -> None:
        """What was raised there, once, where somebody can catch it."""
        raised = self.raised
        if raised is not None:
            self.raised, self.seen = None, raised
            raise raised

    def reraise_for(self, error: ControlError) -> NoReturn:
        """The same for the error that C has made of it; the second time it is the cause."""
        self.reraise()
        raise error from self.seen


def progress_of(shared: Callbacks, progress: Progress | None) -> Any:
    """There is one even if the program has none: while C opens a port it makes Ctrl-C work."""

    @_signals.entry
    def call(_context: Any, step: bytes | None, detail: bytes | None) -> int:
        try:
            if shared.raised is not None:
                return _GIVE_UP
            if progress is not None:
                answer = progress((step or b"").decode(errors="replace"),
                                  (detail or b"").decode(errors="replace"))
                if answer is False:
                    return _GIVE_UP
            return _GIVE_UP if shared.deferred is not None and shared.deferred.noted else _GO_ON
        except BaseException as raised:  # nothing may escape into C
            shared.raised = raised
            return _GIVE_UP

    return c.PROGRESS(call)


def control_of(shared: Callbacks, control: Control | None) -> Any:
    """A function for C that calls the program's."""
    if control is None:
        return c.CONTROL(0)
    decide = control

    @_signals.entry
    def call(_context: Any, state: Any, output: Any) -> int:
        try:
            return _write(decide(State._of(state.contents)), output.contents)
        except BaseException as raised:  # nothing may escape into C
            if shared.raised is None:
                shared.raised = raised
            return _FAILED

    return c.CONTROL(call)


def _write(answer: object, output: c.Output) -> int:
    if isinstance(answer, Wheels):
        output.kind = OutputKind.WHEELS
        output.wheels.left_mm_s = answer.left_mm_s
        output.wheels.right_mm_s = answer.right_mm_s
    elif isinstance(answer, Twist):
        output.kind = OutputKind.TWIST
        output.twist.velocity_mm_s = answer.velocity_mm_s
        output.twist.turn_rate_rad_s = answer.turn_rate_rad_s
    elif answer is SETPOINT:
        output.kind = OutputKind.SETPOINT
    elif answer is FINISHED:
        return _FINISHED
    else:
        raise TypeError("a control function answers Wheels, Twist, SETPOINT or FINISHED, not "
                        f"{type(answer).__name__}")
    return _GO_ON

