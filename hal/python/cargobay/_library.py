"""Finds libcargobay.so.0 and declares its functions."""

from __future__ import annotations

import ctypes
import os
import pathlib
from collections.abc import Iterator
from ctypes import (POINTER, c_char_p, c_double, c_int, c_int64, c_size_t, c_uint8,
                    c_uint32, c_void_p)
from typing import Any

from . import _structs as c
from ._signals import entry
from .errors import error_of

NAME = "libcargobay.so.0"
LIBRARY_VARIABLE = "CARGOBAY_LIBRARY"
VERSION = (0, 1, 0)  # of cargobay.h, whose functions these are

_HANDLE = c_void_p
_PACKETS = POINTER(c_uint32)

# Functions that return 0, a count or an error, without `cargobay_`.
CHECKED: dict[str, list[Any]] = {
    "sim_open": [POINTER(c.SimOptions), POINTER(_HANDLE)],
    "sim_close": [_HANDLE],
    "sim_get_path": [_HANDLE, c_char_p, c_size_t],
    "sim_inject": [_HANDLE, c_char_p, c_char_p, c_size_t],
    "sim_get_truth": [_HANDLE, POINTER(c.Truth)],
    "sim_advance": [_HANDLE, c_int64],
    "open": [POINTER(c.Options), POINTER(_HANDLE)],
    "close": [_HANDLE],
    "get_bring_up": [_HANDLE, POINTER(c.BringUp)],
    "get_info": [_HANDLE, POINTER(c.Info)],
    "get_learnt": [_HANDLE, POINTER(c.Learnt)],
    "get_setting": [c_uint32, POINTER(c.Setting)],
    "get_state": [_HANDLE, POINTER(c.State)],
    "wait": [_HANDLE, c_int64, c_int64, POINTER(c.State)],
    "get_history": [_HANDLE, c_int64, POINTER(c.State), c_size_t],
    "get_fd": [_HANDLE],
    "reset_odometry": [_HANDLE, c_double, c_double, c_double],
    "set_control": [_HANDLE, c.CONTROL, c_void_p],
    "start": [_HANDLE],
    "end": [_HANDLE],
    "request_end": [_HANDLE],
    "get_end": [_HANDLE, POINTER(c.EndReport)],
    "save_recording": [_HANDLE, c_char_p],
    "drive_wheels": [_HANDLE, c_double, c_double],
    "drive": [_HANDLE, c_double, c_double],
    "drive_radius": [_HANDLE, c_double, c_double],
    "stop": [_HANDLE],
    "wheels_of": [_HANDLE, c.Twist, POINTER(c.Wheels)],
    "rearm": [_HANDLE],
    "expect_silence": [_HANDLE, c_int64],
    "next_event": [_HANDLE, c_int64, POINTER(c.Event)],
    "describe_event": [POINTER(c.Event), c_char_p, c_size_t],
    "get_readings": [_HANDLE, _PACKETS, c_size_t, POINTER(c.Reading)],
    "subscribe": [_HANDLE, _PACKETS, c_size_t],
    "unsubscribe": [_HANDLE, _PACKETS, c_size_t],
    "query": [_HANDLE, c_uint32, c_int64, POINTER(c.Reading)],
    "set_leds": [_HANDLE, c_uint32, c_uint32, c_uint32],
    "set_digital_outputs": [_HANDLE, c_uint32],
    "set_low_side_drivers": [_HANDLE, c_uint32],
    "set_pwm_low_side_drivers": [_HANDLE, c_uint32, c_uint32, c_uint32],
    "send_ir": [_HANDLE, c_uint32],
    "store_song": [_HANDLE, c_uint32, POINTER(c.Note), c_size_t],
    "play_song": [_HANDLE, c_uint32],
    "store_tune": [_HANDLE, c_uint32, c_char_p, POINTER(c_int64), c_size_t],
    "store_script": [_HANDLE, c_char_p, c_uint32],
    "play_script": [_HANDLE, c_int64],
    "send_command": [_HANDLE, c_char_p, c_uint32],
    "send_bytes": [_HANDLE, POINTER(c_uint8), c_size_t, c_uint32],
    "get_statistics": [_HANDLE, POINTER(c.Statistics)],
    "get_missing_rights": [_HANDLE, c_char_p, c_size_t],
    "histogram_open": [POINTER(_HANDLE)],
    "histogram_close": [_HANDLE],
    "histogram_record": [_HANDLE, c_int64],
    "histogram_get": [_HANDLE, POINTER(c.Distribution)],
    "histogram_get_percentile": [_HANDLE, c_double, POINTER(c_int64)],
    "copy_histogram": [_HANDLE, c_int, _HANDLE],
}
# Functions that cannot fail: what they return, and their parameters.
PLAIN: dict[str, tuple[Any, list[Any]]] = {
    "version": (c_char_p, []),
    "version_number": (c_uint32, []),
    "error_name": (c_char_p, [c_int]),
    "error_message": (c_char_p, []),
    "mode_name": (c_char_p, [c_int]),
    "event_name": (c_char_p, [c_int]),
    "packet_name": (c_char_p, [c_int]),
}


def _places() -> Iterator[str]:
    """The environment overrides all; then the prefix of this file, then the loader's path."""
    named = os.environ.get(LIBRARY_VARIABLE)
    if named:
        yield named
        return
    # PREFIX/lib/python3/dist-packages/cargobay/_library.py; multiarch has libraries one deeper.
    folders = pathlib.Path(__file__).resolve().parents
    if folders[2].name.startswith("python3") and folders[3].name.startswith("lib"):
        for pattern in (f"lib/{NAME}", f"lib64/{NAME}", f"lib/*-linux-*/{NAME}"):
            yield from (str(path) for path in sorted(folders[4].glob(pattern)))
    yield NAME


def _find() -> ctypes.CDLL:
    troubles = []
    for place in _places():
        try:
            return ctypes.CDLL(place)
        except OSError as error:  # for instance of another architecture
            troubles.append(str(error))
    raise ImportError(f"{'; '.join(troubles)}; install libcargobay0, or name the library in "
                      f"{LIBRARY_VARIABLE}", name="cargobay")


@entry
def _checked(result: int, _function: Any, _arguments: Any) -> int:
    if result < 0:
        raise error_of(result, library.cargobay_error_message().decode(errors="replace"))
    return result


def _load() -> ctypes.CDLL:
    found = _find()
    functions: dict[str, tuple[Any, list[Any]]] = {
        **PLAIN, **{name: (c_int, parameters) for name, parameters in CHECKED.items()}}
    try:
        for name, (result, parameters) in functions.items():
            function = getattr(found, "cargobay_" + name)
            function.argtypes = parameters
            function.restype = result
            if name in CHECKED:
                function.errcheck = _checked
    except AttributeError as error:
        wanted = ".".join(str(number) for number in VERSION)
        raise ImportError(f"the library is older than this package, which needs {wanted}: {error}",
                          name="cargobay") from None
    return found


library = _load()


def text_of(name: str, number: int) -> str:
    """What a function returns that gives a number its name."""
    found: bytes = getattr(library, "cargobay_" + name)(number)
    return found.decode()


def filled(name: str, *arguments: Any, most: int) -> str:
    """What a function writes into a text; `most` bytes are enough for it."""
    text = ctypes.create_string_buffer(most)
    getattr(library, "cargobay_" + name)(*arguments, text, len(text))
    return os.fsdecode(text.value)
