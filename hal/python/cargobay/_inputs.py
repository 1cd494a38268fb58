"""What a robot reports: states, events, readings, and how its loop is."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Callable, Iterator
from typing import TypeVar

from . import _arguments, _handles, _signals
from . import _structs as c
from ._arguments import Seconds
from ._callbacks import Callbacks
from ._library import filled, library
from .enums import Measure, Packet
from .errors import ControlError, TimedOut
from .events import Event
from .histogram import Histogram
from .records import BringUp, EndReport, Info, Learnt, Reading, State, Statistics

_ENDED = 1
_HISTORY = 256
# After which Python may handle a signal, as that of Ctrl-C. A query is asked again after it.
_WAIT_SLICE_NS = 100_000_000
_QUERY_SLICE_NS = 500_000_000
_RIGHTS_SIZE = 4096

_S = TypeVar("_S", bound=ctypes.Structure)


class Inputs(_handles.Handle):
    """Whoever reads says what it has seen: a tick, or the number of an event.

    So any number of threads and coroutines may read side by side, and each sees every gap.
    """

    _callbacks: Callbacks
    _virtual: bool  # its time passes in wait(), which calls the control function
    _controlled: bool

    @property
    def state(self) -> State:
        """The state of the newest tick; NoFrame before the first."""
        return State._of(self._read("get_state", c.State()))

    def wait(self, after_tick: int = -1, timeout_s: Seconds | None = None) -> State | None:
        """Waits for a state newer than `after_tick` (-1: any) and returns the newest.

        None if no newer one will come because the loop was asked to end; TimedOut after
        `timeout_s` (None: never). If the loop has ended by itself, raises why. In virtual time it
        makes time pass, frame by frame; `timeout_s` is virtual, too.
        """
        seen = _arguments.after("after_tick", after_tick)
        state = c.State()

        def one(timeout_ns: int) -> int:
            result: int = library.cargobay_wait(
                self._handle, seen, timeout_ns, ctypes.byref(state))
            return result

        result = self._in_slices(one, _arguments.timeout_ns("timeout_s", timeout_s), _WAIT_SLICE_NS)
        return None if result == _ENDED else State._of(state, seen)

    def states(self, duration_s: Seconds | None = None, *, after_tick: int = -1) -> Iterator[State]:
        """The newest state, whenever there is one, until the loop is asked to end.

        If the loop body takes longer than a frame, some are left out: `skipped` of the next says
        how many; history() has them. With `duration_s`, ends after so long in the robot's time.
        """
        _arguments.after("after_tick", after_tick)
        return self._states(_arguments.timeout_ns("duration_s", duration_s), after_tick)

    def _states(self, duration_ns: int | None, after_tick: int) -> Iterator[State]:
        begin_ns: int | None = None
        while (state := self.wait(after_tick)) is not None:
            begin_ns = state.robot_time_ns if begin_ns is None else begin_ns
            if duration_ns is not None and state.robot_time_ns - begin_ns >= duration_ns:
                return
            after_tick = state.tick
            yield state

    def history(self, after_tick: int = -1, count: int = _HISTORY) -> list[State]:
        """The states after `after_tick`, oldest first, `count` at most; the newest 256 are kept."""
        seen = _arguments.after("after_tick", after_tick)
        states = (c.State * _arguments.whole("count", count, 1, _HISTORY))()
        states[0].size = ctypes.sizeof(c.State)
        written: int = library.cargobay_get_history(self._handle, seen, states, len(states))
        found = []
        for state in states[:written]:
            found.append(State._of(state, seen))
            seen = state.tick
        return found

    @property
    def fd(self) -> int:
        """Readable once a frame, an event or the end has come since 8 bytes were last read.

        For one reader: cargobay.aio is one. UnsupportedError in virtual time.
        """
        descriptor: int = library.cargobay_get_fd(self._handle)
        return descriptor

    def next_event(self, after_sequence: int = 0) -> Event | None:
        """The first event after the one of that number; None if there is none."""
        event = c.Event()
        found = library.cargobay_next_event(
            self._handle, _arguments.whole("after_sequence", after_sequence, 0, 2**63 - 1),
            ctypes.byref(event))
        return Event._of(event) if found else None

    def events(self, after_sequence: int = 0) -> Iterator[Event]:
        """The events after the one of that number, oldest first, as far as there are any."""
        while (event := self.next_event(after_sequence)) is not None:
            yield event
            after_sequence = event.sequence

    def readings(self, *packets: Packet) -> list[Reading]:
        """The latest readings of some packets, all as of the same frame."""
        numbers = _packets(packets)
        readings = (c.Reading * max(len(packets), 1))()
        library.cargobay_get_readings(self._handle, numbers, len(numbers), readings)
        return [Reading._of(reading) for reading in readings]

    def reading(self, packet: Packet) -> Reading:
        """The latest reading of one packet."""
        return self.readings(packet)[0]

    def subscribe(self, *packets: Packet) -> None:
        """Has these streamed from the next frames on; counted, until each is taken back."""
        numbers = _packets(packets)
        library.cargobay_subscribe(self._handle, numbers, len(numbers))

    def unsubscribe(self, *packets: Packet) -> None:
        """Takes one subscription of each packet back."""
        numbers = _packets(packets)
        library.cargobay_unsubscribe(self._handle, numbers, len(numbers))

    def query(self, packet: Packet, timeout_s: Seconds | None = 1.0) -> Reading | None:
        """Asks for one packet: its reading, sampled after the call. None and errors as wait()."""
        reading = c.Reading()
        number = _arguments.uint32("packet", packet)

        def one(timeout_ns: int) -> int:
            result: int = library.cargobay_query(
                self._handle, number, timeout_ns, ctypes.byref(reading))
            return result

        result = self._in_slices(
            one, _arguments.timeout_ns("timeout_s", timeout_s), _QUERY_SLICE_NS)
        return None if result == _ENDED else Reading._of(reading)

    @property
    def bring_up(self) -> BringUp:
        """How the last bring-up went."""
        return BringUp._of(self._read("get_bring_up", c.BringUp()))

    @property
    def info(self) -> Info:
        """What kind of robot it is."""
        return Info._of(self._read("get_info", c.Info()))

    @property
    def learnt(self) -> Learnt:
        """What the loop has learnt of the wheels."""
        return Learnt._of(self._read("get_learnt", c.Learnt()))

    @property
    def end_report(self) -> EndReport:
        """Why the loop ended, as soon as it has."""
        return EndReport._of(self._read("get_end", c.EndReport()))

    @property
    def statistics(self) -> Statistics:
        """The counters as of the newest frame."""
        return Statistics._of(self._read("get_statistics", c.Statistics()))

    @property
    def missing_rights(self) -> str:
        """The rights that the kernel refused the loop: a line each, with what to do about it."""
        return filled("get_missing_rights", self._handle, most=_RIGHTS_SIZE)

    def copy_histogram(self, measure: Measure, histogram: Histogram) -> None:
        """Copies what the loop has measured about itself so far, replacing what was there."""
        number = _arguments.int32("measure", measure)
        _arguments.instance("histogram", histogram, Histogram)
        library.cargobay_copy_histogram(self._handle, number, histogram._handle)

    def _read(self, name: str, struct: _S) -> _S:
        getattr(library, "cargobay_" + name)(self._handle, ctypes.byref(struct))
        return struct

    def _call(self, call: Callable[[], int]) -> int:
        """A call in which C may call the control function; raises what that has raised."""
        try:
            if not (self._virtual and self._controlled):
                return call()
            with _signals.Deferred():
                return call()
        except ControlError as error:
            self._callbacks.reraise_for(error)

    def _in_slices(self, call: Callable[[int], int], timeout_ns: int | None, slice_ns: int) -> int:
        """Waits in slices, between which Python handles signals."""
        begin_ns, left_ns = time.monotonic_ns(), timeout_ns
        while True:
            part_ns = slice_ns if left_ns is None else min(slice_ns, left_ns)
            try:
                return self._call(lambda: call(part_ns))
            except TimedOut:
                if left_ns is None or timeout_ns is None:
                    continue
                # Real time or, in virtual time, as much as the slice has let pass.
                left_ns = (left_ns - part_ns if self._virtual
                           else timeout_ns - (time.monotonic_ns() - begin_ns))
                if left_ns <= 0:
                    raise


def _packets(packets: tuple[Packet, ...]) -> ctypes.Array[ctypes.c_uint32]:
    numbers = [_arguments.uint32("packets", packet) for packet in packets]
    return (ctypes.c_uint32 * len(numbers))(*numbers)
