#!/usr/bin/env python3
"""Values of a wrong type, out of range, or cut short on the way to C: refused by name.

usage: python_arguments_test.py [LIBRARY]
"""

import datetime
import inspect
import math
import unittest

from python_support import virtual

import cargobay
from cargobay import Error, Flag, HandleError, Histogram, Note, Robot, Sim, Twist

DAY = datetime.timedelta(days=1)


class Refused(unittest.TestCase):
    def refused(self, error, name, call, *arguments, **named):
        with self.assertRaises(error, msg=f"{call}{arguments}{named}") as caught:
            call(*arguments, **named)
        self.assertIn(f"`{name}`", str(caught.exception))

    def refused_as(self, error, call, arguments, name, value):
        """With one of the arguments changed."""
        place = list(inspect.signature(call).parameters).index(name)
        self.refused(error, name, call, *arguments[:place], value, *arguments[place + 1:])

    def setUp(self):
        self.sim = self.enterContext(virtual())
        self.robot = self.enterContext(Robot(sim=self.sim))
        self.histogram = self.enterContext(Histogram())
        self.robot.start()
        self.robot.wait()


class Whole(Refused):
    def test_numbers(self):
        robot = self.robot
        for name, call, arguments in (
                ("leds", robot.set_leds, (0, 0, 0)), ("power_color", robot.set_leds, (0, 0, 0)),
                ("power_intensity", robot.set_leds, (0, 0, 0)),
                ("outputs", robot.set_digital_outputs, (0,)),
                ("drivers", robot.set_low_side_drivers, (0,)),
                ("driver_0", robot.set_pwm_low_side_drivers, (0, 0, 0)),
                ("driver_1", robot.set_pwm_low_side_drivers, (0, 0, 0)),
                ("driver_2", robot.set_pwm_low_side_drivers, (0, 0, 0)),
                ("byte", robot.send_ir, (0,)), ("slot", robot.play_song, (0,)),
                ("slot", robot.store_song, (0, [Note(0.25, 60)])),
                ("slot", robot.store_tune, (0, "t:d=4:c")),
                ("how", robot.store_script, ("leds none 0 0", 0)),
                ("how", robot.send_command, ("leds none 0 0", 0)),
                ("how", robot.send_bytes, (b"\x8b\0\0\0", 0)), ("packet", robot.query, (27,)),
                ("measure", robot.copy_histogram, (0, self.histogram)),
                ("time_ns", self.histogram.record, (0,)),
                ("packet", cargobay.packet_name, (7,)), ("after_tick", robot.wait, (-1,)),
                ("after_tick", robot.history, (-1,)), ("count", robot.history, (-1, 1)),
                ("after_sequence", robot.next_event, (0,))):
            for value in (1.0, "1", None, [1], b"1"):
                self.refused_as(TypeError, call, arguments, name, value)
            for value in (-2**70, 2**70, 2**63):
                self.refused_as(ValueError, call, arguments, name, value)
        self.refused(TypeError, "packets", robot.subscribe, "wall")
        self.refused(TypeError, "packets", robot.readings, None)
        self.refused(ValueError, "packets", robot.readings, -1)
        self.refused(ValueError, "count", robot.readings)

    def test_do_not_wrap(self):
        for value in (-1, 256, 2**32):
            with self.assertRaises(ValueError):
                self.robot.set_leds(0, value, 0)
            with self.assertRaises(ValueError):
                self.robot.send_ir(value)
            with self.assertRaises(ValueError):
                self.robot.play_song(value)
            with self.assertRaises(ValueError):
                self.robot.store_song(0, [Note(0.25, value)])


class Real(Refused):
    def test_numbers(self):
        robot = self.robot
        for name, call, arguments in (
                ("left_mm_s", robot.drive_wheels, (0.0, 0.0)),
                ("right_mm_s", robot.drive_wheels, (0.0, 0.0)),
                ("velocity_mm_s", robot.drive, (0.0, 0.0)),
                ("turn_rate_rad_s", robot.drive, (0.0, 0.0)),
                ("velocity_mm_s", robot.drive_radius, (0.0, 0.0)),
                ("radius_mm", robot.drive_radius, (0.0, 0.0)),
                ("x_mm", robot.reset_odometry, (0.0, 0.0, 0.0)),
                ("y_mm", robot.reset_odometry, (0.0, 0.0, 0.0)),
                ("heading_rad", robot.reset_odometry, (0.0, 0.0, 0.0)),
                ("percent", self.histogram.percentile_ns, (50.0,))):
            for value in ("1", b"1", [1.0], None):
                self.refused_as(TypeError, call, arguments, name, value)
            self.refused_as(ValueError, call, arguments, name, 10**400)
        with self.assertRaises(ValueError):
            robot.wheels_of(Twist(math.nan, 0.0))
        self.refused(TypeError, "twist", robot.wheels_of, (1.0, 2.0))

    def test_times(self):
        robot = self.robot
        for name, call, arguments in (
                ("duration_s", robot.expect_silence, (0.0,)),
                ("expected_s", robot.play_script, (0.0,)), ("duration_s", robot.states, (0.0,)),
                ("timeout_s", robot.wait, (-1, 0.0)), ("timeout_s", robot.query, (27, 0.0)),
                ("duration_s", self.sim.advance, (0.0,))):
            for value in ("1", b"1", [1.0]):
                self.refused_as(TypeError, call, arguments, name, value)
            for value in (-5, -1.0, -1e-12, math.nan, math.inf, -math.inf, 10**400, -DAY,
                          datetime.timedelta(microseconds=-1)):
                self.refused_as(ValueError, call, arguments, name, value)

    def test_a_negative_wait_does_not_wait_for_ever(self):
        for arguments in ((-5,), (-1, -5), (-1, -5.0), (-1, -DAY)):
            with self.assertRaises(ValueError):
                self.robot.wait(*arguments)
        with self.assertRaises(ValueError):
            self.robot.states(-1.0)
        with self.assertRaises(ValueError):
            self.robot.states(after_tick=-2)

    def test_times_are_seconds_or_timedelta(self):
        for hour in (3600, 3600.0, datetime.timedelta(hours=1)):
            self.robot.expect_silence(hour)
            self.robot.wait(self.robot.state.tick, hour)


class Other(Refused):
    def test_text(self):
        for name, call, arguments in (
                ("rtttl", self.robot.store_tune, (0, "t:d=4:c")),
                ("text", self.robot.store_script, ("leds none 0 0",)),
                ("text", self.robot.send_command, ("leds none 0 0",)),
                ("line", self.sim.inject, ("state",))):
            for value in (1, b"bytes", None):
                self.refused_as(TypeError, call, arguments, name, value)
            self.refused_as(ValueError, call, arguments, name, "a\0b")

    def test_things(self):
        robot = self.robot
        for notes in ([5], [(1, 2)], [None]):
            self.refused(TypeError, "notes", robot.store_song, 0, notes)
        for data in (5, "text", [1, 2], None):
            self.refused(TypeError, "data", robot.send_bytes, data)
        self.refused(ValueError, "data", robot.send_bytes, b"")
        robot.send_bytes(bytearray([139, 2, 0, 255]))
        for control in (5, "text"):
            self.refused(TypeError, "control", robot.set_control, control)
        self.refused(TypeError, "histogram", robot.copy_histogram, 0, 5)
        for path in (None, 5):
            self.refused(TypeError, "path", robot.save_recording, path)
        for path in ("", "a\0"):
            self.refused(ValueError, "path", robot.save_recording, path)


class Options(Refused):
    def setUp(self):
        pass

    def test_paths(self):
        for kind, paths in ((Robot, ("port", "config", "record")), (Sim, ("link", "world"))):
            for path in paths:
                self.refused(ValueError, path, kind, **{path: ""})
                self.refused(ValueError, path, kind, **{path: "\0"})
                self.refused(ValueError, path, kind, **{path: "/dev/ttyS0\0/x"})
                self.refused(TypeError, path, kind, **{path: 5})
        self.refused(TypeError, "plant", Sim, plant=5)
        self.refused(ValueError, "plant", Sim, plant="slow\0")
        self.refused(TypeError, "settings", Robot, settings=5)
        self.refused(ValueError, "settings", Robot, settings="a\0")

    def test_times(self):
        for time in ("setpoint_lapse_s", "control_budget_s", "link_timeout_s", "guard_deadline_s"):
            for value in (-1.0, math.nan, math.inf, -DAY):
                self.refused(ValueError, time, Robot, **{time: value})
            self.refused(TypeError, time, Robot, **{time: "1"})
            # So short that it would round to 0, the default; and too long for the library.
            for value in (1e-12, 1e12, 1000 * DAY):
                with virtual() as sim, self.assertRaises(ValueError):
                    Robot(sim=sim, **{time: value})
        self.refused(ValueError, "lag_s", Sim, lag_s=-0.1)
        with virtual() as sim:
            Robot(sim=sim, setpoint_lapse_s=datetime.timedelta(seconds=2)).close()

    def test_numbers(self):
        for whole in ("baud", "remainder", "mode", "priority", "cpu", "control_overruns",
                      "port_fd", "flags"):
            self.refused(ValueError, whole, Robot, **{whole: 2**40})
            self.refused(TypeError, whole, Robot, **{whole: 1.0})
        for whole in ("time", "remainder", "boot_baud", "seed"):
            self.refused(ValueError, whole, Sim, **{whole: 2**70})
            self.refused(TypeError, whole, Sim, **{whole: "1"})
        for real in ("acceleration_mm_s2", "wheel_base_mm", "distance_scale", "turn_scale"):
            self.refused(TypeError, real, Robot, **{real: "1"})
            with virtual() as sim:
                self.refused(ValueError, real, Robot, sim=sim, **{real: -1.0})
                self.refused(ValueError, real, Robot, sim=sim, **{real: math.nan})
        # What the library says is what Python says.
        for value, meant in (({"wheel_base_mm": 0.258}, "metres\\? did you mean 258"),
                             ({"acceleration_mm_s2": 0.5}, "m/s\\^2\\? did you mean 500"),
                             ({"jerk_mm_s3": 10.0}, "m/s\\^3\\? did you mean 10000"),
                             ({"turn_scale": 98.0}, "percent\\? did you mean 0.98"),
                             ({"guard_deadline_s": 1.5e-7}, "milliseconds\\? did you mean"),
                             ({"settings": "[robot]\nlag_s = 100"},
                              "milliseconds\\? did you mean 0.1")):
            with virtual() as sim, self.assertRaisesRegex(Error, meant):
                Robot(sim=sim, **value)
        for real in ("gain_left", "gain_right", "noise_mm_s", "wheel_base_mm"):
            self.refused(TypeError, real, Sim, **{real: None})

    def test_things(self):
        self.refused(TypeError, "sim", Robot, sim=5)
        self.refused(TypeError, "progress", Robot, progress=5)
        self.refused(TypeError, "beside", Sim, beside=5)
        sim = virtual()
        sim.close()
        with self.assertRaises(HandleError):
            Robot(sim=sim)  # not its own one instead

    def test_are_those_of_c_in_its_order(self):
        from cargobay import _structs
        for kind, struct in ((Robot, _structs.Options), (Sim, _structs.SimOptions)):
            in_c = [name.removesuffix("_ns") for name, *_ in struct._fields_ if name not in
                    ("size", "progress_context", "message", "message_size", "reserved")]
            ours = [name.removesuffix("_s") if name.removesuffix("_s") in in_c else name
                    for name in inspect.signature(kind).parameters]
            # The port comes first, as what most programs give.
            self.assertEqual(sorted(ours), sorted(in_c))
            in_c.remove("port") if kind is Robot else None
            ours.remove("port") if kind is Robot else None
            self.assertEqual(ours, in_c)

    def test_a_cpu_is_pinned(self):
        with virtual() as sim:
            Robot(sim=sim, cpu=0).close()
            Robot(sim=sim, flags=Flag.NO_REALTIME | Flag.NO_GUARD).close()


if __name__ == "__main__":
    unittest.main()
