"""Commands beside the loop's own."""

from __future__ import annotations

import ctypes
import datetime
from collections.abc import Iterable

from . import _arguments, _handles
from . import _structs as c
from ._arguments import Seconds
from ._library import library
from .enums import How, Led
from .errors import ArgumentError
from .records import Note, timedelta_of

_MOST_SONGS = 16


class Outputs(_handles.Handle):
    """Each command waits in a queue of 32 and is sent in one of the next frames, one per frame.

    LineFull if the queue is full, or for a long command while the wheels turn; ModeLost if the
    robot's mode does not allow it; StateError if the loop does not run.
    """

    def set_leds(self, leds: Led, power_color: int, power_intensity: int) -> None:
        """LEDs (OI p. 9): colour of the power LED 0 (green) to 255 (red), intensity 0 to 255."""
        library.cargobay_set_leds(
            self._handle, _arguments.uint32("leds", leds),
            _arguments.uint32("power_color", power_color),
            _arguments.uint32("power_intensity", power_intensity))

    def set_digital_outputs(self, outputs: int) -> None:
        """Digital Outputs (OI p. 10): bits 0 to 2."""
        library.cargobay_set_digital_outputs(
            self._handle, _arguments.uint32("outputs", outputs))

    def set_low_side_drivers(self, drivers: int) -> None:
        """Low Side Drivers (OI p. 10): bits 0 to 2."""
        library.cargobay_set_low_side_drivers(
            self._handle, _arguments.uint32("drivers", drivers))

    def set_pwm_low_side_drivers(self, driver_0: int, driver_1: int, driver_2: int) -> None:
        """PWM Low Side Drivers (OI p. 10): duty cycles, 0 to 128."""
        library.cargobay_set_pwm_low_side_drivers(
            self._handle, _arguments.uint32("driver_0", driver_0),
            _arguments.uint32("driver_1", driver_1), _arguments.uint32("driver_2", driver_2))

    def send_ir(self, byte: int) -> None:
        """Send IR (OI p. 11): an infrared byte through low side driver 1."""
        library.cargobay_send_ir(self._handle, _arguments.uint32("byte", byte))

    def store_song(self, slot: int, notes: Iterable[Note]) -> None:
        """Song (OI p. 11): 1 to 16 notes in slot 0 to 15."""
        stored = []
        for note in notes:
            _arguments.instance("notes", note, Note)
            stored.append(c.Note(duration_ns=_arguments.time_ns("duration_s", note.duration_s),
                                 number=_arguments.uint32("number", note.number)))
        library.cargobay_store_song(self._handle, _arguments.uint32("slot", slot),
                                    (c.Note * len(stored))(*stored), len(stored))

    def play_song(self, slot: int) -> None:
        """Play Song (OI p. 12); the robot ignores it while a song plays."""
        library.cargobay_play_song(self._handle, _arguments.uint32("slot", slot))

    def store_tune(self, slot: int, rtttl: str) -> list[datetime.timedelta]:
        """Stores a tune in RTTTL, as "scale:d=8,o=5,b=120:c,d,e,f", in the slots from `slot` on.

        Returns the duration of each song, after which the next may be played.
        """
        durations = (ctypes.c_int64 * _MOST_SONGS)()
        count: int = library.cargobay_store_tune(
            self._handle, _arguments.uint32("slot", slot), _arguments.text("rtttl", rtttl),
            durations, len(durations))
        return [timedelta_of(duration_ns) for duration_ns in durations[:count]]

    def store_script(self, text: str, how: How = How(0)) -> None:
        """Stores a script (OI p. 15): "drive 300 straight; wait_distance 400; drive 0 0"."""
        library.cargobay_store_script(
            self._handle, _arguments.text("text", text), _arguments.uint32("how", how))

    def play_script(self, expected_s: Seconds) -> None:
        """Play Script (OI p. 15), which may take so long. Meanwhile the robot may be silent."""
        library.cargobay_play_script(self._handle, _arguments.time_ns("expected_s", expected_s))

    def send_command(self, text: str, how: How = How(0)) -> None:
        """Any command as text, in the words of docs/protocol.md: "leds play 0 255"."""
        library.cargobay_send_command(
            self._handle, _arguments.text("text", text), _arguments.uint32("how", how))

    def send_bytes(self, data: bytes, how: How = How(0)) -> None:
        """The same as bytes: one or more whole commands."""
        if not isinstance(data, (bytes, bytearray, memoryview)):
            raise TypeError(f"`data` must be bytes, not {type(data).__name__}")
        held = bytes(data)
        if not held:
            raise ArgumentError("`data` is empty; give at least one command")
        library.cargobay_send_bytes(self._handle, (ctypes.c_uint8 * len(held))(*held), len(held),
                                    _arguments.uint32("how", how))
