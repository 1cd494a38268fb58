"""Keeps what a signal handler raises from getting lost in C.

Python runs the handlers of signals, as that of Ctrl-C, between two instructions of the main thread,
so also at the first one of a function that C has called. Nothing there can catch what a handler
raises: ctypes prints it and goes on. While C may call functions of this package on the main thread,
a signal that comes at such a place is therefore noted, and handled as soon as C has returned.
Anywhere else, as in the control function of a program that is in virtual time, it is handled at
once.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable
from types import CodeType, FrameType, TracebackType
from typing import Any, TypeVar

_F = TypeVar("_F", bound=Callable[..., Any])
_entries: set[CodeType] = set()
# Those whose handlers commonly raise. A look at each costs time, and this happens at each frame.
_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGALRM,
            signal.SIGUSR1, signal.SIGUSR2)


def entry(function: _F) -> _F:
    """Marks a function that C calls. It catches everything that the functions it calls raise."""
    _entries.add(function.__code__)
    return function


class Deferred:
    """`with` it, C may call functions that are marked; at its end the noted signals are handled."""

    def __init__(self) -> None:
        self.noted: list[tuple[int, FrameType | None]] = []
        self._handlers: dict[int, Callable[[int, FrameType | None], Any]] = {}
        self._swapping = False

    def __enter__(self) -> Deferred:
        if threading.current_thread() is threading.main_thread():  # the only one that handles them
            self._swapping = True
            try:
                self._swap()
            except BaseException:  # a handler has raised that was not swapped yet
                self._leave()
                raise
            self._swapping = False
        return self

    @entry
    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self._swapping = True
        self._leave()

    def _leave(self) -> None:
        try:
            self._restore()
        except BaseException:
            self._restore()  # a handler has raised that was restored before the others
            raise
        finally:
            for number, frame in self.noted:
                self._handlers[number](number, frame)

    def _swap(self) -> None:
        for number in _SIGNALS:
            handler = signal.getsignal(number)
            if callable(handler):
                self._handlers[number] = handler
                signal.signal(number, self._note)

    def _restore(self) -> None:
        for number, handler in self._handlers.items():
            signal.signal(number, handler)

    def _note(self, number: int, frame: FrameType | None) -> None:
        if self._swapping or frame is not None and frame.f_code in _entries:
            self.noted.append((number, frame))
        else:
            self._handlers[number](number, frame)
