"""The structs of cargobay.h, member by member; tests/install/python_layout_test.py compares."""

from __future__ import annotations

import ctypes
from ctypes import (c_char, c_char_p, c_double, c_int, c_int32, c_int64, c_uint32, c_uint64,
                    c_void_p)
from typing import Any

PROGRESS = ctypes.CFUNCTYPE(c_int, c_void_p, c_char_p, c_char_p)


class Sized(ctypes.Structure):
    """A struct whose first member says how large it is."""

    def __init__(self, **members: Any) -> None:
        super().__init__(**members)
        self.size = ctypes.sizeof(self)


class Wheels(ctypes.Structure):
    _fields_ = [("left_mm_s", c_double), ("right_mm_s", c_double)]


class Twist(ctypes.Structure):
    _fields_ = [("velocity_mm_s", c_double), ("turn_rate_rad_s", c_double)]


class Reading(ctypes.Structure):
    _fields_ = [("tick", c_int64), ("arrival_ns", c_int64), ("value", c_int32),
                ("packet", c_uint32)]


class Note(ctypes.Structure):
    _fields_ = [("duration_ns", c_int64), ("number", c_uint32), ("reserved", c_uint32)]


class SimOptions(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("time", c_int32),
        ("seed", c_uint64),
        ("remainder", c_int32),
        ("boot_baud", c_uint32),
        ("link", c_char_p),
        ("world", c_char_p),
        ("beside", c_void_p),
        ("plant", c_char_p),
        ("reserved", c_void_p * 2),
        ("lag_ns", c_int64),
        ("gain_left", c_double),
        ("gain_right", c_double),
        ("noise_mm_s", c_double),
        ("wheel_base_mm", c_double),
    ]


class Truth(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("mode", c_int32),
        ("sim_time_ns", c_int64),
        ("left_mm_s", c_double),
        ("right_mm_s", c_double),
        ("x_mm", c_double),
        ("y_mm", c_double),
        ("heading_rad", c_double),
        ("commanded_left_mm_s", c_int32),
        ("commanded_right_mm_s", c_int32),
    ]


class Options(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("flags", c_uint32),
        ("port", c_char_p),
        ("sim", c_void_p),
        ("config", c_char_p),
        ("settings", c_char_p),
        ("record", c_char_p),
        ("progress", PROGRESS),
        ("progress_context", c_void_p),
        ("message", c_char_p),
        ("message_size", c_uint32),
        ("control_overruns", c_uint32),
        ("port_fd", c_int32),
        ("baud", c_uint32),
        ("mode", c_int32),
        ("remainder", c_int32),
        ("priority", c_int32),
        ("cpu", c_int32),
        ("setpoint_lapse_ns", c_int64),
        ("control_budget_ns", c_int64),
        ("link_timeout_ns", c_int64),
        ("guard_deadline_ns", c_int64),
        ("acceleration_mm_s2", c_double),
        ("jerk_mm_s3", c_double),
        ("wheel_base_mm", c_double),
        ("distance_scale", c_double),
        ("turn_scale", c_double),
    ]


class BringUp(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("found_baud", c_uint32),
        ("baud", c_uint32),
        ("rate_change", c_int32),
        ("powered_on", c_int32),
        ("resynchronised", c_int32),
        ("brc_pulses", c_int32),
        ("battery_mv", c_int32),
        ("took_ns", c_int64),
    ]


class Info(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("features", c_uint32),
        ("tick_ns", c_int64),
        ("wheel_base_mm", c_double),
        ("max_wheel_mm_s", c_double),
        ("baud", c_uint32),
        ("song_slots", c_uint32),
        ("song_notes", c_uint32),
        ("script_bytes", c_uint32),
        ("spare_bytes", c_uint32),
        ("reserved", c_uint32),
        ("model", c_char * 32),
    ]


class Learnt(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("remainder", c_int32),
        ("from_earlier", c_int32),
        ("reserved", c_uint32),
        ("moved_ns", c_int64),
        ("lag_ns", c_int64),
        ("lag_sd_ns", c_int64),
        ("dead_time_ns", c_int64),
        ("dead_time_sd_ns", c_int64),
        ("ramp_s2_mm", c_double),
        ("ramp_sd_s2_mm", c_double),
        ("gain_left", c_double),
        ("gain_left_sd", c_double),
        ("gain_right", c_double),
        ("gain_right_sd", c_double),
        ("carried_probability", c_double),
    ]


class Setting(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_uint32),
        ("table", c_char_p),
        ("key", c_char_p),
        ("unit", c_char_p),
        ("default_value", c_char_p),
        ("words", c_char_p),
        ("example", c_char_p),
        ("least", c_double),
        ("most", c_double),
    ]


class State(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("mode", c_int32),
        ("tick", c_int64),
        ("robot_time_ns", c_int64),
        ("elapsed_ns", c_int64),
        ("arrival_ns", c_int64),
        ("target", Wheels),
        ("limited", Wheels),
        ("estimate", Wheels),
        ("command", Wheels),
        ("velocity_mm_s", c_double),
        ("turn_rate_rad_s", c_double),
        ("x_mm", c_double),
        ("y_mm", c_double),
        ("heading_rad", c_double),
        ("distance_mm", c_double),
        ("covariance", c_double * 9),
        ("remainder", c_int32),
        ("setpoint_lapsed", c_int32),
        ("hazards", c_uint32),
        ("bumps", c_uint32),
        ("buttons", c_uint32),
        ("battery_mv", c_int32),
        ("limits", c_uint32),
        ("reserved", c_uint32),
    ]


class Output(Sized):
    _fields_ = [("size", c_uint32), ("kind", c_int32), ("wheels", Wheels), ("twist", Twist)]


class EndReport(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("ended", c_int32),
        ("code", c_int32),
        ("control_result", c_int32),
        ("hazards", c_uint32),
        ("passive_seen", c_int32),
        ("guard_lost", c_int32),
        ("reserved", c_uint32),
        ("message", c_char * 512),
    ]


class Event(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("kind", c_int32),
        ("sequence", c_int64),
        ("tick", c_int64),
        ("arrival_ns", c_int64),
        ("mode", c_int32),
        ("hazards", c_uint32),
        ("overcurrents", c_uint32),
        ("frames", c_uint32),
        ("bumps", c_uint32),
        ("voltage_mv", c_int32),
        ("charge_mah", c_int32),
        ("capacity_mah", c_int32),
        ("process", c_int32),
        ("wheels", c_uint32),
        ("process_name", c_char * 16),
        ("finding", c_int32),
        ("limits", c_uint32),
        ("wanted", Wheels),
        ("got", Wheels),
    ]


class Statistics(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("scheduler", c_int32),
        ("priority", c_int32),
        ("memory_locked", c_int32),
        ("ticks", c_int64),
        ("frames_good", c_uint64),
        ("frames_bad", c_uint64),
        ("frames_lost", c_uint64),
        ("frames_late", c_uint64),
        ("overruns_wait", c_uint64),
        ("overruns_read", c_uint64),
        ("overruns_control", c_uint64),
        ("overruns_write", c_uint64),
        ("controls_refused", c_uint64),
        ("commands_unsent", c_uint64),
        ("commands_withheld", c_uint64),
        ("events", c_uint64),
    ]


class Distribution(Sized):
    _fields_ = [
        ("size", c_uint32),
        ("reserved", c_uint32),
        ("count", c_uint64),
        ("min_ns", c_int64),
        ("p50_ns", c_int64),
        ("p90_ns", c_int64),
        ("p99_ns", c_int64),
        ("p999_ns", c_int64),
        ("max_ns", c_int64),
        ("mean_ns", c_double),
    ]


CONTROL = ctypes.CFUNCTYPE(c_int, c_void_p, ctypes.POINTER(State), ctypes.POINTER(Output))
