"""A histogram of times in fixed memory."""

from __future__ import annotations

import ctypes

from . import _arguments, _handles, _signals
from . import _structs as c
from ._library import library
from .records import Distribution


class Histogram(_handles.Handle):
    """Log-linear, exact to 0.8 %; a context manager."""

    _closer = "cargobay_histogram_close"

    def __init__(self) -> None:
        with _signals.Deferred():
            self._open("cargobay_histogram_open")

    def record(self, time_ns: int) -> None:
        """Counts a time; a negative one as 0, one of more than a day as a day."""
        library.cargobay_histogram_record(
            self._handle, _arguments.whole("time_ns", time_ns, -2**63, 2**63 - 1))

    @property
    def distribution(self) -> Distribution:
        """Of the recorded times."""
        distribution = c.Distribution()
        library.cargobay_histogram_get(self._handle, ctypes.byref(distribution))
        return Distribution._of(distribution)

    def percentile_ns(self, percent: float) -> int:
        """The time that `percent` of the recorded times do not exceed."""
        time_ns = ctypes.c_int64()
        library.cargobay_histogram_get_percentile(
            self._handle, _arguments.real("percent", percent), ctypes.byref(time_ns))
        return time_ns.value
