"""What the library says about itself."""

from __future__ import annotations

import ctypes

from . import _arguments
from . import _structs as c
from ._library import library, text_of
from .enums import ErrorCode, EventKind, Mode, Packet
from .records import Setting


def version() -> str:
    """The version of the library in use, as "0.1.0"."""
    found: bytes = library.cargobay_version()
    return found.decode()


def error_name(error: ErrorCode) -> str:
    """The name of a code, as "CARGOBAY_E_BUSY"."""
    return text_of("error_name", _arguments.int32("error", error))


def mode_name(mode: Mode) -> str:
    """The name of a mode, as "safe"; "" for another number."""
    return text_of("mode_name", _arguments.int32("mode", mode))


def event_name(kind: EventKind) -> str:
    """The name of a kind of event, as "mode_lost"; "" for one that the library does not know."""
    return text_of("event_name", _arguments.int32("kind", kind))


def packet_name(packet: Packet) -> str:
    """The name of a packet, as "wall_signal"; "" if it is not a single packet."""
    return text_of("packet_name", _arguments.int32("packet", packet))


def settings() -> list[Setting]:
    """What a configuration file, or `settings`, can set."""
    found: list[Setting] = []
    setting = c.Setting()
    while library.cargobay_get_setting(len(found), ctypes.byref(setting)) == 0:
        found.append(Setting._of(setting))
    return found
