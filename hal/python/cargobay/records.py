"""What the library reports: copies that never change, member by member as in cargobay.h.

Numbers with names are enumerations, and what is 0 or 1 in C is a bool. Times are in ns, as in C;
those that are durations are there as timedelta too.
"""

from __future__ import annotations

import dataclasses
import datetime
from typing import Self

from . import _arguments
from . import _structs as c
from .enums import (Bump, Button, ErrorCode, Feature, Hazard, Limit, Mode, Packet, RateChange,
                    Remainder)


def timedelta_of(time_ns: int) -> datetime.timedelta:
    """To the microsecond."""
    return datetime.timedelta(microseconds=time_ns / 1e3)


@dataclasses.dataclass(frozen=True, slots=True)
class Wheels:
    """Wheel speeds, -500 to 500 mm/s each."""

    left_mm_s: float
    right_mm_s: float

    @classmethod
    def _of(cls, wheels: c.Wheels) -> Self:
        return cls(wheels.left_mm_s, wheels.right_mm_s)


@dataclasses.dataclass(frozen=True, slots=True)
class Twist:
    """Velocity ahead and turn rate, counter-clockwise, of the robot's centre."""

    velocity_mm_s: float
    turn_rate_rad_s: float


@dataclasses.dataclass(frozen=True, slots=True)
class State:
    """The state of the loop at one tick."""

    mode: Mode
    tick: int
    robot_time_ns: int
    elapsed_ns: int
    arrival_ns: int
    target: Wheels
    limited: Wheels
    estimate: Wheels
    command: Wheels
    velocity_mm_s: float
    turn_rate_rad_s: float
    x_mm: float
    y_mm: float
    heading_rad: float
    distance_mm: float
    covariance: tuple[float, ...]
    remainder: Remainder
    setpoint_lapsed: bool
    hazards: Hazard
    bumps: Bump
    buttons: Button
    battery_mv: int
    limits: Limit
    skipped: int = 0
    """How many ticks between the one that the reader had seen and this one it has missed."""

    @property
    def robot_time(self) -> datetime.timedelta:
        return timedelta_of(self.robot_time_ns)

    @property
    def elapsed(self) -> datetime.timedelta:
        return timedelta_of(self.elapsed_ns)

    @classmethod
    def _of(cls, state: c.State, after_tick: int = -1) -> Self:
        tick: int = state.tick
        return cls(
            Mode(state.mode), tick, state.robot_time_ns, state.elapsed_ns, state.arrival_ns,
            Wheels._of(state.target), Wheels._of(state.limited), Wheels._of(state.estimate),
            Wheels._of(state.command), state.velocity_mm_s, state.turn_rate_rad_s, state.x_mm,
            state.y_mm, state.heading_rad, state.distance_mm, tuple(state.covariance),
            Remainder(state.remainder), bool(state.setpoint_lapsed), Hazard(state.hazards),
            Bump(state.bumps), Button(state.buttons), state.battery_mv,
            Limit(state.limits), tick - after_tick - 1 if after_tick >= 0 else 0)


@dataclasses.dataclass(frozen=True, slots=True)
class Reading:
    """What a packet last said."""

    tick: int
    arrival_ns: int
    value: int | None
    """In the manual's units; None before a frame has reported it: `tick` is then -1."""
    packet: Packet

    @classmethod
    def _of(cls, reading: c.Reading) -> Self:
        return cls(reading.tick, reading.arrival_ns,
                   reading.value if reading.tick >= 0 else None, Packet(reading.packet))


@dataclasses.dataclass(frozen=True, slots=True)
class Note:
    """A note of a song (OI p. 11)."""

    duration_s: _arguments.Seconds
    """0 to 3.984375 s; rounded to 1/64 s, as the robot counts."""
    number: int
    """MIDI number, 31 (G, 49 Hz) to 127; others up to 255 are rests."""


@dataclasses.dataclass(frozen=True, slots=True)
class EndReport:
    """Why and how the loop ended."""

    ended: bool
    code: ErrorCode
    control_result: int
    hazards: Hazard
    passive_seen: bool
    guard_lost: bool
    message: str

    @classmethod
    def _of(cls, end: c.EndReport) -> Self:
        return cls(bool(end.ended), ErrorCode(end.code), end.control_result, Hazard(end.hazards),
                   bool(end.passive_seen), bool(end.guard_lost),
                   end.message.decode(errors="replace"))


@dataclasses.dataclass(frozen=True, slots=True)
class Truth:
    """What really happens to a virtual Create; no sensor reports it."""

    mode: Mode
    sim_time_ns: int
    left_mm_s: float
    right_mm_s: float
    x_mm: float
    y_mm: float
    heading_rad: float
    commanded_left_mm_s: int
    commanded_right_mm_s: int

    @property
    def sim_time(self) -> datetime.timedelta:
        return timedelta_of(self.sim_time_ns)

    @classmethod
    def _of(cls, truth: c.Truth) -> Self:
        return cls(Mode(truth.mode), truth.sim_time_ns, truth.left_mm_s, truth.right_mm_s,
                   truth.x_mm, truth.y_mm, truth.heading_rad, truth.commanded_left_mm_s,
                   truth.commanded_right_mm_s)


@dataclasses.dataclass(frozen=True, slots=True)
class BringUp:
    """The result of the bring-up."""

    found_baud: int
    baud: int
    rate_change: RateChange
    powered_on: bool
    resynchronised: bool
    brc_pulses: int
    battery_mv: int
    took_ns: int

    @property
    def took(self) -> datetime.timedelta:
        return timedelta_of(self.took_ns)

    @classmethod
    def _of(cls, bring_up: c.BringUp) -> Self:
        return cls(bring_up.found_baud, bring_up.baud, RateChange(bring_up.rate_change),
                   bool(bring_up.powered_on), bool(bring_up.resynchronised), bring_up.brc_pulses,
                   bring_up.battery_mv, bring_up.took_ns)


@dataclasses.dataclass(frozen=True, slots=True)
class Info:
    """What kind of robot it is, and what the library knows about it."""

    features: Feature
    tick_ns: int
    wheel_base_mm: float
    max_wheel_mm_s: float
    baud: int
    song_slots: int
    song_notes: int
    script_bytes: int
    spare_bytes: int
    model: str

    @property
    def tick(self) -> datetime.timedelta:
        """From one frame to the next."""
        return timedelta_of(self.tick_ns)

    @classmethod
    def _of(cls, info: c.Info) -> Self:
        return cls(Feature(info.features), info.tick_ns, info.wheel_base_mm, info.max_wheel_mm_s,
                   info.baud, info.song_slots, info.song_notes, info.script_bytes,
                   info.spare_bytes, info.model.decode(errors="replace"))


@dataclasses.dataclass(frozen=True, slots=True)
class Learnt:
    """What the loop has learnt of the robot's wheels, with standard deviations."""

    remainder: Remainder
    from_earlier: bool
    moved_ns: int
    lag_ns: int
    lag_sd_ns: int
    dead_time_ns: int
    dead_time_sd_ns: int
    ramp_s2_mm: float
    ramp_sd_s2_mm: float
    gain_left: float
    gain_left_sd: float
    gain_right: float
    gain_right_sd: float
    carried_probability: float

    @property
    def lag(self) -> datetime.timedelta:
        return timedelta_of(self.lag_ns)

    @property
    def dead_time(self) -> datetime.timedelta:
        return timedelta_of(self.dead_time_ns)

    @classmethod
    def _of(cls, learnt: c.Learnt) -> Self:
        return cls(Remainder(learnt.remainder), bool(learnt.from_earlier), learnt.moved_ns,
                   learnt.lag_ns, learnt.lag_sd_ns, learnt.dead_time_ns, learnt.dead_time_sd_ns,
                   learnt.ramp_s2_mm, learnt.ramp_sd_s2_mm, learnt.gain_left, learnt.gain_left_sd,
                   learnt.gain_right, learnt.gain_right_sd, learnt.carried_probability)


@dataclasses.dataclass(frozen=True, slots=True)
class Setting:
    """A key that a configuration file, or `settings`, may have."""

    table: str
    key: str
    unit: str
    default_value: str
    words: str
    example: str
    least: float
    most: float

    @classmethod
    def _of(cls, setting: c.Setting) -> Self:
        return cls(setting.table.decode(), setting.key.decode(), setting.unit.decode(),
                   setting.default_value.decode(), setting.words.decode(),
                   setting.example.decode(), setting.least, setting.most)


@dataclasses.dataclass(frozen=True, slots=True)
class Statistics:
    """What the loop has counted since start()."""

    scheduler: int
    priority: int
    memory_locked: bool
    ticks: int
    frames_good: int
    frames_bad: int
    frames_lost: int
    frames_late: int
    overruns_wait: int
    overruns_read: int
    overruns_control: int
    overruns_write: int
    controls_refused: int
    commands_unsent: int
    commands_withheld: int
    events: int

    @classmethod
    def _of(cls, counted: c.Statistics) -> Self:
        return cls(
            counted.scheduler, counted.priority, bool(counted.memory_locked), counted.ticks,
            counted.frames_good, counted.frames_bad, counted.frames_lost, counted.frames_late,
            counted.overruns_wait, counted.overruns_read, counted.overruns_control,
            counted.overruns_write, counted.controls_refused, counted.commands_unsent,
            counted.commands_withheld, counted.events)


@dataclasses.dataclass(frozen=True, slots=True)
class Distribution:
    """The distribution of the times in a histogram."""

    count: int
    min_ns: int
    p50_ns: int
    p90_ns: int
    p99_ns: int
    p999_ns: int
    max_ns: int
    mean_ns: float

    @classmethod
    def _of(cls, held: c.Distribution) -> Self:
        return cls(held.count, held.min_ns, held.p50_ns, held.p90_ns, held.p99_ns, held.p999_ns,
                   held.max_ns, held.mean_ns)
