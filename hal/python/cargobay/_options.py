"""Options of a robot, as C has them."""

from __future__ import annotations

from typing import Any

from . import _arguments
from . import _structs as c
from .enums import Flag

# How the options are checked, by their names in Python; those in C that are times end in _ns.
_CHECKS: dict[str, Any] = {
    "port": _arguments.path, "config": _arguments.path, "record": _arguments.path,
    "control_overruns": _arguments.uint32, "port_fd": _arguments.int32, "baud": _arguments.uint32,
    "mode": _arguments.int32, "remainder": _arguments.int32, "priority": _arguments.int32,
    "setpoint_lapse_s": _arguments.time_ns, "control_budget_s": _arguments.time_ns,
    "link_timeout_s": _arguments.time_ns, "guard_deadline_s": _arguments.time_ns,
    "acceleration_mm_s2": _arguments.real, "jerk_mm_s3": _arguments.real,
    "wheel_base_mm": _arguments.real, "distance_scale": _arguments.real,
    "turn_scale": _arguments.real,
}


def options_of(*, flags: Flag, settings: str | None, cpu: int | None, **others: Any) -> c.Options:
    """All but the virtual Create and the functions."""
    bits = _arguments.uint32("flags", flags)
    options = c.Options(
        settings=None if settings is None else _arguments.text("settings", settings),
        cpu=0 if cpu is None else _arguments.int32("cpu", cpu),
        flags=bits if cpu is None else bits | Flag.PIN_CPU)
    for name, value in others.items():
        checked = _CHECKS[name](name, value)
        member = name[:-2] + "_ns" if _CHECKS[name] is _arguments.time_ns else name
        setattr(options, member, checked)
    return options
