"""Events of a robot."""

from __future__ import annotations

import ctypes
import dataclasses
from typing import Self

from . import _structs as c
from ._library import filled
from .enums import Bump, EventKind, Finding, Hazard, Limit, Mode, Overcurrent, Wheel
from .records import Wheels


@dataclasses.dataclass(frozen=True, slots=True)
class Event:
    """Something that happened. Members that its kind does not name are 0. str() has it in words."""

    kind: EventKind
    sequence: int
    tick: int
    arrival_ns: int
    mode: Mode = Mode.OFF
    hazards: Hazard = Hazard(0)
    overcurrents: Overcurrent = Overcurrent(0)
    frames: int = 0
    bumps: Bump = Bump(0)
    voltage_mv: int = 0
    charge_mah: int = 0
    capacity_mah: int = 0
    process: int = 0
    wheels: Wheel = Wheel(0)
    process_name: str = ""
    finding: Finding = Finding.NOTHING
    limits: Limit = Limit(0)
    wanted: Wheels = Wheels(0.0, 0.0)
    got: Wheels = Wheels(0.0, 0.0)

    def __str__(self) -> str:
        other = ("process_name", "wanted", "got")
        event = c.Event(**{field.name: getattr(self, field.name)
                           for field in dataclasses.fields(self) if field.name not in other})
        event.wanted = c.Wheels(self.wanted.left_mm_s, self.wanted.right_mm_s)
        event.got = c.Wheels(self.got.left_mm_s, self.got.right_mm_s)
        event.process_name = self.process_name.encode(errors="surrogateescape")[:15]
        return filled("describe_event", ctypes.byref(event), most=1024)

    @classmethod
    def _of(cls, event: c.Event) -> Self:
        return cls(
            EventKind(event.kind), event.sequence, event.tick, event.arrival_ns, Mode(event.mode),
            Hazard(event.hazards), Overcurrent(event.overcurrents), event.frames,
            Bump(event.bumps), event.voltage_mv, event.charge_mah, event.capacity_mah,
            event.process, Wheel(event.wheels),
            event.process_name.decode(errors="surrogateescape"), Finding(event.finding),
            Limit(event.limits), Wheels._of(event.wanted), Wheels._of(event.got))
