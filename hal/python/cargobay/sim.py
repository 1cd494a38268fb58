"""A virtual Create."""

from __future__ import annotations

import ctypes
from types import TracebackType

from . import _arguments, _handles, _signals
from . import _structs as c
from ._arguments import Path, Seconds
from ._library import filled, library
from .enums import Remainder, SimTime
from .errors import HandleError
from .records import Truth

_ANSWER_SIZE = 64 * 1024
_PATH_SIZE = 4096
# After which Python may handle a signal: in real time 0.1 s, in virtual time some ms of computing.
_SLICE_NS = {SimTime.REAL: 100_000_000, SimTime.VIRTUAL: 10_000_000_000}


class Sim(_handles.Handle):
    """A virtual Create, switched on, in mode Off; a context manager.

        with Sim(time=SimTime.VIRTUAL) as sim, Robot(sim=sim) as robot:
            robot.start()

    Several in one world: Sim(beside=sim).
    """

    _closer = "cargobay_sim_close"
    _slice_ns: int

    def __init__(self, *, time: SimTime = SimTime.REAL, seed: int = 0,
                 remainder: Remainder = Remainder.UNKNOWN, boot_baud: int = 0,
                 link: Path | None = None, world: Path | None = None, beside: Sim | None = None,
                 plant: str | None = None, lag_s: Seconds = 0.0, gain_left: float = 0.0,
                 gain_right: float = 0.0, noise_mm_s: float = 0.0,
                 wheel_base_mm: float = 0.0) -> None:
        """The members of struct cargobay_sim_options; 0 and None are the defaults."""
        if beside is not None:
            _arguments.instance("beside", beside, Sim)
            if beside._handle is None:
                raise HandleError("`beside` is closed; open another Sim")
        self._beside = beside  # it must outlive this
        options = c.SimOptions(
            time=_arguments.int32("time", time),
            seed=_arguments.whole("seed", seed, 0, 2**64 - 1),
            remainder=_arguments.int32("remainder", remainder),
            boot_baud=_arguments.uint32("boot_baud", boot_baud),
            link=_arguments.path("link", link), world=_arguments.path("world", world),
            beside=beside._handle if beside is not None else None,
            plant=None if plant is None else _arguments.text("plant", plant),
            lag_ns=_arguments.time_ns("lag_s", lag_s),
            gain_left=_arguments.real("gain_left", gain_left),
            gain_right=_arguments.real("gain_right", gain_right),
            noise_mm_s=_arguments.real("noise_mm_s", noise_mm_s),
            wheel_base_mm=_arguments.real("wheel_base_mm", wheel_base_mm))
        with _signals.Deferred():
            self._open("cargobay_sim_open", ctypes.byref(options), sim=options.beside)
        self._slice_ns = beside._slice_ns if beside is not None else _SLICE_NS[SimTime(time)]

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        """First closes the robot that uses it, and those beside it, if the program has not."""
        if self._handle is not None:
            _handles.close_users(self._handle)
        super().__exit__(kind, error, trace)

    @_signals.entry
    def __del__(self) -> None:
        # One that is collected together with its robot may come first.
        if self._handle is not None and not self.closed:
            _handles.close_users(self._handle)
        super().__del__()

    @property
    def path(self) -> str:
        """The pseudo-terminal that any OI client may open; not in virtual time."""
        return filled("sim_get_path", self._handle, most=_PATH_SIZE)

    @property
    def truth(self) -> Truth:
        """Its true pose, speeds, mode and time."""
        truth = c.Truth()
        library.cargobay_sim_get_truth(self._handle, ctypes.byref(truth))
        return Truth._of(truth)

    def inject(self, line: str) -> str:
        """Does something to it, as "bump left" or "at 3.5 fault lost 0.01"; returns its answer."""
        answer = ctypes.create_string_buffer(_ANSWER_SIZE)
        library.cargobay_sim_inject(
            self._handle, _arguments.text("line", line), answer, len(answer))
        return answer.value.decode(errors="replace")

    def advance(self, duration_s: Seconds) -> None:
        """Lets time pass: at once in virtual time, where loops run meanwhile; else by sleeping."""
        left_ns = _arguments.time_ns("duration_s", duration_s)
        while True:  # once for 0, which may be refused too
            slice_ns = min(left_ns, self._slice_ns)
            library.cargobay_sim_advance(self._handle, slice_ns)
            left_ns -= slice_ns
            if not left_ns:
                return
