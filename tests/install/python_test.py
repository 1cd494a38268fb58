#!/usr/bin/env python3
"""The Python module against the header and against the library.

usage: python_test.py [LIBRARY]; by itself build/release/libcargobay.so.0, its guard beside it.
"""

import ctypes
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
LIBRARY = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-")
                       else ROOT / "build/release/libcargobay.so.0").resolve()
os.environ["CARGOBAY_LIBRARY"] = str(LIBRARY)
os.environ.setdefault("CARGOBAY_GUARD", str(LIBRARY.parent / "cargobay-guard"))
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "examples/python"))

import cargobay  # noqa: E402
from cargobay import (CargobayError, Error, EventKind, Histogram, Measure, Mode, Packet, Robot,
                      SimTime, VirtualCreate)  # noqa: E402

HEADER = (ROOT / "hal/c/cargobay.h").read_text()
BARE = re.sub(r"/\*.*?\*/", "", HEADER, flags=re.S)


def virtual():
    """A virtual Create in virtual time."""
    return VirtualCreate(time=SimTime.VIRTUAL)


class Header(unittest.TestCase):
    NAMES = {"sim_options": "_SimOptions", "options": "_Options", "note": "_Note"}

    def structs(self):
        for name, body in re.findall(r"struct cargobay_(\w+) \{(.*?)\n\};", BARE, flags=re.S):
            # The last word of a declaration, or the one before "[" or, for a function, in "(*)".
            members = []
            for text in filter(str.strip, body.split(";")):
                pointer = re.search(r"\(\*(\w+)\)", text)
                members.append(pointer[1] if pointer else re.search(r"(\w+)(\[\w+\])?\s*$", text)[1])
            python = self.NAMES.get(name, "".join(word.title() for word in name.split("_")))
            yield name, members, getattr(cargobay, python)

    def test_structs_are_laid_out_as_in_c(self):
        structs = list(self.structs())
        self.assertGreaterEqual(len(structs), 11)
        lines = []
        for name, members, _ in structs:
            lines.append(f'printf("{name} %zu\\n", sizeof(struct cargobay_{name}));')
            lines += [f'printf("{name}.{member} %zu %zu\\n", offsetof(struct cargobay_{name}, {member}),'
                      f' sizeof(((struct cargobay_{name} *)0)->{member}));' for member in members]
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "layout.c")
            source.write_text('#include <cargobay.h>\n#include <stdio.h>\nint main(void) {\n'
                              + "\n".join(lines) + "\n}\n")
            subprocess.run(["cc", "-I", ROOT / "hal/c", source, "-o", f"{folder}/layout"], check=True)
            in_c = subprocess.run([f"{folder}/layout"], check=True, text=True,
                                  stdout=subprocess.PIPE).stdout.splitlines()
        in_python = []
        for name, _, struct in structs:
            in_python.append(f"{name} {ctypes.sizeof(struct)}")
            for member, *_ in struct._fields_:
                descriptor = getattr(struct, member)
                in_python.append(f"{name}.{member} {descriptor.offset} {descriptor.size}")
        self.assertEqual(in_c, in_python)

    def test_constants_are_those_of_c(self):
        enums = {"flag": "_Flag", "packet": "Packet", "error": "Error"}
        seen = 0
        for name, body in re.findall(r"enum cargobay_(\w+) \{(.*?)\}", BARE, flags=re.S):
            python = getattr(cargobay,
                             enums.get(name, "".join(word.title() for word in name.split("_"))))
            in_c = {key: eval(value) for key, value in
                    re.findall(r"CARGOBAY_(\w+) = ([-0-9< ]+)", body)}
            in_c.pop("PACKETS", None)
            # The names in C begin with what they belong to.
            for key, value in in_c.items():
                member = python(value).name
                self.assertTrue(key == member or key.endswith("_" + member), f"{key}: {member}")
            self.assertEqual(len(in_c), len([m for m in python if m or 0 in in_c.values()]), name)
            seen += 1
        self.assertGreaterEqual(seen, 13)

    def test_each_function_is_used(self):
        module = (ROOT / "examples/python/cargobay.py").read_text()
        functions = set(re.findall(r"\b(cargobay_\w+)\(", BARE))
        self.assertGreater(len(functions), 45)
        unused = {name for name in functions
                  if f"_library.{name}(" not in module and f'"{name}"' not in module}
        self.assertEqual(unused, set())


class InVirtualTime(unittest.TestCase):
    def test_drives(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            for state in robot.states(2.0):
                robot.drive(200.0, 0.0)
            robot.stop()
            self.assertGreater(state.x_mm, 300.0)
            self.assertEqual(state.mode, Mode.SAFE)
            self.assertAlmostEqual(state.x_mm, sim.truth().x_mm, delta=20.0)
            self.assertEqual(sim.truth().mode, Mode.PASSIVE)
            self.assertGreater(robot.statistics().frames_good, 100)
            self.assertEqual(robot.bring_up().baud, 57600)

    def test_a_control_function_is_called_with_each_frame(self):
        ticks = []

        def control(state):
            ticks.append(state.tick)
            return 100.0, -100.0

        with virtual() as sim, Robot(sim=sim) as robot:
            robot.set_control(control)
            robot.start()
            state = list(robot.states(1.0))[-1]
            self.assertLess(state.heading_rad, -0.3)
            self.assertGreater(len(ticks), 50)

    def test_what_a_control_function_raises_comes_out(self):
        def control(state):
            raise KeyError("planted")

        with self.assertRaisesRegex(KeyError, "planted"):
            with virtual() as sim, Robot(sim=sim) as robot:
                robot.set_control(control)
                robot.start()
                for _ in robot.states(1.0):
                    pass

    def test_errors_have_code_and_remedy(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            with self.assertRaises(CargobayError) as caught:
                robot.drive(200.0, 0.0)  # not started
            self.assertEqual(caught.exception.code, Error.STATE)
            self.assertTrue(caught.exception.message)
            self.assertIn("CARGOBAY_E_STATE", str(caught.exception))
            robot.start()
            with self.assertRaises(CargobayError) as caught:
                robot.drive(math.nan, 0.0)
            self.assertEqual(caught.exception.code, Error.ARGUMENT)
        with self.assertRaises(CargobayError) as caught:
            robot.state()
        self.assertEqual(caught.exception.code, Error.HANDLE)

    def test_a_cliff_is_an_event_and_ends_the_loop(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            with self.assertRaises(CargobayError) as caught:
                for state in robot.states(3.0):
                    robot.drive(100.0, 0.0)
                    if state.tick == 50:
                        sim.inject("cliff front_left on")
            self.assertEqual(caught.exception.code, Error.MODE)
            # Refused at once; the next frames say why.
            with self.assertRaises(CargobayError) as caught:
                for state in robot.states(1.0):
                    pass
            self.assertEqual(caught.exception.code, Error.MODE)
            lost = [event for event in robot.events() if event.kind == EventKind.MODE_LOST]
            self.assertEqual(len(lost), 1)
            self.assertIn("cliff", str(lost[0]))

    def test_sensors_commands_and_songs(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            robot.start()
            for _ in robot.states(1.5):
                pass
            self.assertIsNone(robot.sensors()[Packet.WALL_SIGNAL])
            self.assertGreater(robot.sensors()[Packet.VOLTAGE], 10000)
            self.assertIsInstance(robot.query(Packet.WALL_SIGNAL, 1.0), int)
            robot.leds(cargobay.Led.PLAY, 0, 255)
            robot.song(0, [(60, 16), (64, 16)])
            self.assertEqual(len(robot.tune(1, "scale:d=8,o=5,b=120:c,d,e,f")), 1)
            robot.command("leds advance 128 128")
            robot.raw(bytes([139, 2, 0, 255]))
            with self.assertRaises(CargobayError) as caught:
                robot.command("no_such_command")
            self.assertEqual(caught.exception.code, Error.ARGUMENT)

    def test_examples(self):
        for name in ("square.py",):
            subprocess.run([sys.executable, ROOT / "examples/python" / name], check=True,
                           stdout=subprocess.DEVNULL)


class Arguments(unittest.TestCase):
    """Of a wrong type, out of range, or cut short on the way to C: refused by name."""

    def refused(self, error, name, call, *arguments, **named):
        with self.assertRaises(error, msg=f"{call}{arguments}{named}") as caught:
            call(*arguments, **named)
        self.assertIn(f"`{name}`", str(caught.exception))

    def test_of_every_method(self):
        with virtual() as sim, Robot(sim=sim) as robot, Histogram() as histogram:
            robot.start()
            robot.wait()
            whole = [
                ("leds", robot.leds, (0, 0, 0)), ("power_color", robot.leds, (0, 0, 0)),
                ("power_intensity", robot.leds, (0, 0, 0)),
                ("outputs", robot.digital_outputs, (0,)),
                ("drivers", robot.low_side_drivers, (0,)),
                ("driver_0", robot.pwm_low_side_drivers, (0, 0, 0)),
                ("driver_1", robot.pwm_low_side_drivers, (0, 0, 0)),
                ("driver_2", robot.pwm_low_side_drivers, (0, 0, 0)),
                ("byte", robot.send_ir, (0,)), ("slot", robot.play_song, (0,)),
                ("slot", robot.song, (0, [(60, 16)])), ("slot", robot.tune, (0, "t:d=4:c")),
                ("how", robot.script, ("leds none 0 0", 0)),
                ("how", robot.command, ("leds none 0 0", 0)), ("how", robot.raw, (b"", 0)),
                ("extras", robot.subscribe, (0,)), ("packet", robot.query, (27,)),
                ("measure", robot.histogram, (0,)), ("time_ns", histogram.record, (0,)),
                ("packet", cargobay.packet_name, (7,)),
            ]
            real = [
                ("left_mm_s", robot.drive_wheels, (0.0, 0.0)),
                ("right_mm_s", robot.drive_wheels, (0.0, 0.0)),
                ("velocity_mm_s", robot.drive, (0.0, 0.0)),
                ("turn_rate_rad_s", robot.drive, (0.0, 0.0)),
                ("velocity_mm_s", robot.drive_radius, (0.0, 0.0)),
                ("radius_mm", robot.drive_radius, (0.0, 0.0)),
                ("x_mm", robot.reset_odometry, (0.0, 0.0, 0.0)),
                ("y_mm", robot.reset_odometry, (0.0, 0.0, 0.0)),
                ("heading_rad", robot.reset_odometry, (0.0, 0.0, 0.0)),
                ("duration_s", robot.expect_silence, (0.0,)),
                ("expected_s", robot.play_script, (0.0,)),
                ("duration_s", robot.states, (0.0,)), ("timeout_s", robot.wait, (0.0,)),
                ("timeout_s", robot.query, (27, 0.0)), ("duration_s", sim.advance, (0.0,)),
                ("percent", histogram.percentile_ns, (50.0,)),
                ("velocity_mm_s", cargobay.wheels_of, (0.0, 0.0)),
            ]
            text = [
                ("rtttl", robot.tune, (0, "t:d=4:c")), ("text", robot.script, ("leds none 0 0",)),
                ("text", robot.command, ("leds none 0 0",)), ("line", sim.inject, ("state",)),
            ]

            def with_one(call, arguments, name, value):
                place = list(call.__code__.co_varnames).index(name) if not hasattr(
                    call, "__self__") else list(call.__func__.__code__.co_varnames).index(name) - 1
                return (*arguments[:place], value, *arguments[place + 1:])

            for name, call, arguments in whole:
                for value in (1.0, "1", None, [1], b"1"):
                    self.refused(TypeError, name, call, *with_one(call, arguments, name, value))
                for value in (-2**70, 2**70, 2**63):
                    self.refused(ValueError, name, call, *with_one(call, arguments, name, value))
            for name, call, arguments in real:
                for value in ("1", b"1", [1.0]):
                    self.refused(TypeError, name, call, *with_one(call, arguments, name, value))
                self.refused(ValueError, name, call,
                             *with_one(call, arguments, name, 10**400))
                if name.endswith("_s") and "_mm_" not in name and "_rad_" not in name:
                    for value in (-1.0, math.nan, math.inf, -math.inf):
                        self.refused(ValueError, name, call,
                                     *with_one(call, arguments, name, value))
            for name, call, arguments in text:
                for value in (1, b"bytes", None):
                    self.refused(TypeError, name, call, *with_one(call, arguments, name, value))
                self.refused(ValueError, name, call, *with_one(call, arguments, name, "a\0b"))
            self.refused(ValueError, "power_color", robot.leds, 0, -1, 999)
            self.refused(ValueError, "power_intensity", robot.leds, 0, 0, 256)
            self.refused(ValueError, "byte", robot.send_ir, 256)
            self.refused(ValueError, "number", robot.song, 0, [(256, 1)])
            self.refused(ValueError, "duration", robot.song, 0, [(60, -1)])
            for notes in (5, [5], [(1, 2, 3)], None):
                self.refused(TypeError, "notes", robot.song, 0, notes)
            for data in (5, "text", [1, 2], None):
                self.refused(TypeError, "data", robot.raw, data)
            robot.raw(bytearray([139, 2, 0, 255]))
            for control in (5, "text"):
                with self.assertRaisesRegex(TypeError, "`control`"):
                    Robot.set_control(robot, control)
            with self.assertRaisesRegex(ValueError, "`packet`"):
                robot.sensors()[-1]
            with self.assertRaisesRegex(TypeError, "`event`"):
                cargobay.describe(5)

    def test_of_what_is_opened(self):
        for path in ("port", "config", "record"):
            self.refused(ValueError, path, Robot, **{path: ""})
            self.refused(ValueError, path, Robot, **{path: "\0"})
            self.refused(ValueError, path, Robot, **{path: "/dev/ttyS0\0/x"})
            self.refused(TypeError, path, Robot, **{path: 5})
        for path in ("link", "world"):
            self.refused(ValueError, path, VirtualCreate, **{path: ""})
            self.refused(ValueError, path, VirtualCreate, **{path: "a\0b"})
            self.refused(TypeError, path, VirtualCreate, **{path: 5.0})
        for time in ("setpoint_lapse_s", "control_budget_s", "link_timeout_s", "guard_deadline_s"):
            for value in (-1.0, math.nan, math.inf, 1e12):
                self.refused(ValueError, time, Robot, **{time: value})
            self.refused(TypeError, time, Robot, **{time: "1"})
            # So short that it would round to 0, the default.
            with virtual() as sim, self.assertRaises(ValueError):
                Robot(sim=sim, **{time: 1e-9})
        for whole in ("baud", "mode", "remainder", "priority", "cpu", "control_overruns"):
            self.refused(ValueError, whole, Robot, **{whole: 2**40})
            self.refused(TypeError, whole, Robot, **{whole: 1.0})
        for whole in ("time", "remainder", "boot_baud", "seed"):
            self.refused(ValueError, whole, VirtualCreate, **{whole: 2**70})
            self.refused(TypeError, whole, VirtualCreate, **{whole: "1"})
        for real in ("acceleration_mm_s2", "jerk_mm_s3", "wheel_base_mm", "distance_scale",
                     "turn_scale"):
            self.refused(TypeError, real, Robot, **{real: "1"})
            with virtual() as sim:
                self.refused(ValueError, real, Robot, sim=sim, **{real: -1.0})
                self.refused(ValueError, real, Robot, sim=sim, **{real: math.nan})
        for real in ("lag_s", "droop_left", "droop_right", "noise_mm_s", "wheel_base_mm"):
            self.refused(TypeError, real, VirtualCreate, **{real: None})
        self.refused(TypeError, "sim", Robot, sim=5)
        self.refused(TypeError, "progress", Robot, progress=5)
        sim = virtual()
        sim.close()
        with self.assertRaises(CargobayError) as caught:
            Robot(sim=sim)  # not its own one instead
        self.assertEqual(caught.exception.code, Error.HANDLE)

    def test_what_progress_raises_comes_out(self):
        def progress(step, detail):
            raise KeyError("planted")

        with virtual() as sim:
            with self.assertRaisesRegex(KeyError, "planted"):
                Robot(sim=sim, progress=progress)
            self.assertEqual(sim.truth().mode, Mode.PASSIVE)

    def test_what_nobody_saw_a_control_function_raise_comes_out_of_close(self):
        def control(state):
            raise KeyError("planted")

        with virtual() as sim:
            robot = Robot(sim=sim)
            robot.set_control(control)
            robot.start()
            robot.wait(1.0)
            with self.assertRaisesRegex(KeyError, "planted"):
                robot.close()
            robot.close()  # once
            robot = Robot(sim=sim)
            robot.set_control(lambda state: "no speeds")
            robot.start()
            robot.wait(1.0)
            with self.assertRaises(ValueError):
                robot.close()


class Ends(unittest.TestCase):
    """However a program lets go of its robots: no crash, and the robot stands."""

    def run_program(self, program, status=0, said="", timeout=60):
        with VirtualCreate() as sim:
            begin = ("import atexit, gc, os, sys, threading, time\n"
                     "from cargobay import *\n"
                     f"PORT = {sim.path()!r}\n"
                     "def follow(robot, seconds=0.5):\n"
                     "    for _ in robot.states(seconds): pass\n"
                     "class Owner:\n"
                     "    def __init__(self, port=PORT, **options):\n"
                     "        self.robot = Robot(port, use_config=False, **options)\n"
                     "        self.robot.set_control(self.control)\n"
                     "        self.robot.start()\n"
                     "        follow(self.robot)\n"
                     "    def control(self, state):\n"
                     "        return 100.0, 100.0\n")
            environment = dict(os.environ, PYTHONFAULTHANDLER="1",
                               PYTHONPATH=str(ROOT / "examples/python"),
                               PYTHONDONTWRITEBYTECODE="1")
            ended = subprocess.run([sys.executable, "-c", begin + program], text=True,
                                   timeout=timeout, env=environment, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT)
            self.assertEqual(ended.returncode, status, ended.stdout)
            self.assertIn(said, ended.stdout)
            truth = sim.truth()
            self.assertEqual(truth.mode, Mode.PASSIVE, ended.stdout)
            self.assertEqual(truth.commanded_left_mm_s, 0)
            return ended.stdout

    def test_its_owner_is_collected(self):
        self.run_program("""
owner = Owner()
del owner
gc.collect()
rubbish = [bytearray(1000) for _ in range(10000)]
time.sleep(0.3)
print("collected")
""", said="collected")

    def test_a_cycle_with_its_virtual_create_is_collected(self):
        self.run_program("""
for first in (True, False):
    sim = VirtualCreate()
    owner = Owner(None, sim=sim)
    owner.sim, owner.self = sim, owner
    sim.owner = owner if first else None
    del sim, owner
    gc.collect()
Owner()
""")

    def test_one_that_is_no_longer_used_is_closed_with_a_warning(self):
        said = self.run_program("""
import warnings
warnings.simplefilter("always")
def use():
    robot = Robot(PORT, use_config=False)
    robot.start()
    follow(robot)
use()
robot = Robot(PORT, use_config=False)  # its port is free at once
robot.close()
""")
        self.assertIn("ResourceWarning", said)

    def test_the_program_ends(self):
        for end in ("", "sys.exit(0)", "raise SystemExit(0)"):
            self.run_program(f"owner = Owner()\n{end}")
        self.run_program("owner = Owner()\nraise KeyError('planted')", status=1, said="planted")
        # While a thread that does not end is using it.
        self.run_program("""
owner = Owner()
def use():
    while True:
        owner.robot.wait(1.0)
threading.Thread(target=use, daemon=True).start()
time.sleep(0.2)
""")

    def test_its_control_function_does_not_return(self):
        for hang in ("while True: pass", "while True: time.sleep(100)", "threading.Event().wait()"):
            for end in ("", "del owner; gc.collect()", "owner.robot.close()"):
                with self.subTest(hang=hang, end=end):
                    self.run_program(f"""
class Hung(Owner):
    def __init__(self):
        self.robot = Robot(PORT, use_config=False)
        self.robot.set_control(self.control)
        self.robot.start()
    def control(self, state):
        if state.tick > 30:
            {hang}
        return 100.0, 100.0
owner = Hung()
try:
    follow(owner.robot, 100.0)
except CargobayError as error:
    assert error.code == Error.STALLED, error
try:
    {end or 'pass'}
except CargobayError as error:
    assert error.code == Error.STALLED, error
print("at its end")
""", said="at its end")

    def test_a_forked_child_leaves_it_alone(self):
        self.run_program("""
owner = Owner()
child = os.fork()
if child == 0:
    try:
        owner.robot.drive(0.0, 0.0)
        sys.exit(3)
    except CargobayError as error:
        assert error.code == Error.HANDLE
    owner.robot.close()
    sys.exit(0)
_, status = os.waitpid(child, 0)
assert status == 0, status
follow(owner.robot)
assert owner.robot.statistics().commands_unsent == 0
""")


class InRealTime(unittest.TestCase):
    def test_holds_a_heading(self):
        shown = subprocess.run([sys.executable, ROOT / "examples/python/heading.py"], text=True,
                               stdout=subprocess.PIPE)
        self.assertEqual(shown.returncode, 0, shown.stdout)

    def test_measures_itself(self):
        steps = []
        with VirtualCreate() as sim:
            with Robot(sim.path(), use_config=False,
                       progress=lambda step, detail: steps.append(step)) as robot:
                robot.start()
                for _ in robot.states(0.5):
                    robot.drive(100.0, 0.0)
                robot.stop()
                with robot.histogram(Measure.PERIOD) as histogram:
                    self.assertGreater(histogram.distribution().count, 20)
                    self.assertGreater(histogram.percentile_ns(50.0), 10_000_000)
        self.assertTrue(steps)


class Histograms(unittest.TestCase):
    def test_count_times(self):
        with Histogram() as histogram:
            for time_ns in (1000, 2000, 3000):
                histogram.record(time_ns)
            held = histogram.distribution()
            self.assertEqual((held.count, held.min_ns, held.max_ns), (3, 1000, 3000))
            self.assertAlmostEqual(histogram.percentile_ns(50.0), 2000, delta=40)


class Rest(unittest.TestCase):
    def test_version(self):
        self.assertRegex(cargobay.version(), r"^\d+\.\d+\.\d+$")

    def test_wheels_of(self):
        wheels = cargobay.wheels_of(100.0, 1.0)
        self.assertAlmostEqual(wheels.right_mm_s - wheels.left_mm_s, 258.0)


if __name__ == "__main__":
    unittest.main()
