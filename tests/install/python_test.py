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
            # Of a declaration the last word, or that before "[" or, of a function, in "(*)".
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
            # The names in C begin with what they are of.
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
            # Refused at once; why, the next frames tell.
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
