"""What is opened in C is closed once, however the program lets go of it."""

from __future__ import annotations

import atexit
import contextlib
import ctypes
import os
import warnings
from types import TracebackType
from typing import Any, Self

from . import _signals
from ._library import library
from .errors import Error, HandleError, Stalled, StateError, ThreadError

# What is open in this process, by handle: the name of the function that closes it, and the handle
# of the virtual Create that it uses or is beside, if any. Handles are never used twice.
_opened: dict[int, tuple[str, int | None]] = {}
# Robots whose control function had not returned when they were closed, by their handles.
_stalled: set[int] = set()
CLOSE_ROBOT = "cargobay_close"


def _close(handle: int) -> None:
    """Closes it, once. A signal may come at any instruction: it is forgotten last."""
    if handle not in _opened:
        return
    try:
        getattr(library, _opened[handle][0])(handle)
    except (StateError, ThreadError):
        raise  # it is still open
    except HandleError:
        pass  # it was closed, and a signal kept this from being noted
    except Stalled:
        _stalled.add(handle)
        _opened.pop(handle, None)
        raise
    except Error:
        _opened.pop(handle, None)
        raise
    _opened.pop(handle, None)


def has_stalled(handle: int | None) -> bool:
    """Whether its control function may still be running, or come back."""
    return handle in _stalled


def keep_for_ever(what: Any) -> None:
    """Not even the end of the interpreter frees it."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(what))


def close_users(sim: int) -> None:
    """What must be closed before this virtual Create: its robot, and those beside it."""
    for handle, (_, used) in list(_opened.items()):
        if used == sim:
            close_users(handle)
            with contextlib.suppress(Error):
                _close(handle)


@atexit.register
def _close_all() -> None:
    """While there is still an interpreter for the control functions."""
    robots = [handle for handle, (closer, _) in _opened.items() if closer == CLOSE_ROBOT]
    for handle in robots + list(reversed(_opened)):
        with contextlib.suppress(Error):
            _close(handle)


# They belong to the parent, whose robots drive on.
os.register_at_fork(after_in_child=_opened.clear)


class Handle:
    """A context manager over a handle. After it is closed, its functions raise HandleError."""

    _closer: str
    _handle: int | None = None  # until it is open

    @_signals.entry
    def _open(self, name: str, *arguments: Any, sim: int | None = None) -> None:
        """Within Deferred: no signal comes between that it is open and that it is known to be."""
        handle = ctypes.c_void_p()
        getattr(library, name)(*arguments, ctypes.byref(handle))
        assert handle.value is not None
        _opened[handle.value] = (self._closer, sim)
        self._handle = handle.value

    @property
    def closed(self) -> bool:
        """Whether it is closed, or belongs to the parent of this process."""
        return self._handle not in _opened

    def close(self) -> None:
        """Frees it. Again: nothing."""
        handle = self._handle
        try:
            if handle is not None:
                _close(handle)
        finally:
            if handle not in _opened:
                self._handle = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        if error is None:
            self.close()
            return
        try:
            self.close()
        except Exception as second:  # the first one counts
            if second is not error:
                error.add_note(f"closing failed too: {second}")

    @_signals.entry
    def __del__(self) -> None:
        # In a collected cycle nothing is taken apart before each of these has run.
        if self._handle is None or self._handle not in _opened:
            return
        try:
            warnings.warn(f"{self!r} was not closed", ResourceWarning, source=self)
        finally:
            with contextlib.suppress(BaseException):  # nothing can catch it here
                self.close()
