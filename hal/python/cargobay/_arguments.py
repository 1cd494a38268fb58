"""Checks what is passed to C: ctypes truncates numbers to the size of their type, and text at its
first NUL."""

from __future__ import annotations

import datetime
import math
import operator
import os
from typing import Any, SupportsFloat, SupportsIndex, TypeAlias

from .errors import ArgumentError

Seconds: TypeAlias = float | datetime.timedelta
Path: TypeAlias = str | os.PathLike[str]

_MOST_NS = 2**63 - 1


def whole(name: str, value: SupportsIndex, least: int, most: int) -> int:
    """A whole number in a range."""
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"`{name}` must be a whole number, not {type(value).__name__}") from None
    if not least <= number <= most:
        raise ArgumentError(f"`{name}` must be {least} to {most}, not {number}")
    return number


def int32(name: str, value: SupportsIndex) -> int:
    """What C has as int32_t or int."""
    return whole(name, value, -2**31, 2**31 - 1)


def uint32(name: str, value: SupportsIndex) -> int:
    """What C has as uint32_t."""
    return whole(name, value, 0, 2**32 - 1)


def after(name: str, value: SupportsIndex) -> int:
    """What a reader has seen: a tick, or the number of an event; -1: nothing."""
    return whole(name, value, -1, 2**63 - 1)


def real(name: str, value: SupportsFloat | SupportsIndex) -> float:
    """Any number; what the library makes of NaN and infinities, it says itself."""
    if isinstance(value, (str, bytes, bytearray)) or not hasattr(type(value), "__float__") and (
            not hasattr(type(value), "__index__")):
        raise TypeError(f"`{name}` must be a number, not {type(value).__name__}")
    try:
        return float(value)
    except OverflowError:
        raise ArgumentError(f"`{name}` is larger than any number the library knows") from None


def text(name: str, value: str) -> bytes:
    """Text that C sees the whole of."""
    if not isinstance(value, str):
        raise TypeError(f"`{name}` must be a str, not {type(value).__name__}")
    if "\0" in value:
        raise ArgumentError(f"`{name}` has a NUL in it, where the library would end it")
    return value.encode()


def path(name: str, value: Path | None) -> bytes | None:
    """A path, or None for the default."""
    if value is None:
        return None
    try:
        found = os.fsencode(value)
    except TypeError:
        raise TypeError(f"`{name}` must be a path or None, not {type(value).__name__}") from None
    if not found:
        raise ArgumentError(f"`{name}` is empty; None is the default")
    if b"\0" in found:
        raise ArgumentError(f"`{name}` has a NUL in it, which no path may have")
    return found


def time_ns(name: str, value: Seconds) -> int:
    """A time of 0 or more, in ns; not 0, the default of many, unless the time is."""
    if isinstance(value, datetime.timedelta):
        exact_ns = value // datetime.timedelta(microseconds=1) * 1000
    else:
        seconds = real(name, value)
        if not math.isfinite(seconds):
            raise ArgumentError(f"`{name}` must be 0 or more seconds, not {seconds}")
        exact_ns = round(seconds * 1e9) or (seconds > 0.0) - (seconds < 0.0)
    if exact_ns < 0:
        raise ArgumentError(f"`{name}` must be 0 or more seconds, not {value}")
    return min(exact_ns, _MOST_NS)


def timeout_ns(name: str, value: Seconds | None) -> int | None:
    """None: for ever."""
    return None if value is None else time_ns(name, value)


def instance(name: str, value: Any, kind: type) -> None:
    """Of a type of this package."""
    if not isinstance(value, kind):
        raise TypeError(f"`{name}` must be {_article(kind)}, not {type(value).__name__}")


def function(name: str, value: Any) -> None:
    """A function, or None."""
    if value is not None and not callable(value):
        raise TypeError(f"`{name}` must be a function or None, not {type(value).__name__}")


def _article(kind: type) -> str:
    return f"{'an' if kind.__name__[0] in 'AEIOU' else 'a'} {kind.__name__}"
