#!/usr/bin/env python3
"""However a Python program lets go of its robots: no crash, and the robot stands still.

usage: python_ends_test.py [LIBRARY]
"""

import unittest

from python_support import run, virtual

import cargobay
from cargobay import HandleError, Mode, Robot, Sim, StateError

BEGIN = """
PORT = sys.argv[1]
NOTHING = dict(flags=Flag.NO_CONFIG)
def follow(robot, seconds=0.5):
    for _ in robot.states(seconds): pass
class Owner:
    def __init__(self, port=PORT, **options):
        self.robot = Robot(port, **NOTHING, **options)
        self.robot.set_control(self.control)
        self.robot.start()
        follow(self.robot)
    def control(self, state):
        return Wheels(100.0, 100.0)
"""


class Programs(unittest.TestCase):
    def run_program(self, program, status=0, said=""):
        with Sim() as sim:
            ended = run(BEGIN + program, sim.path)
            self.assertEqual(ended.returncode, status, ended.stdout)
            self.assertIn(said, ended.stdout)
            truth = sim.truth
            self.assertIs(truth.mode, Mode.PASSIVE, ended.stdout)
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
    sim = Sim()
    owner = Owner(None, sim=sim)
    owner.sim, owner.self = sim, owner
    sim.owner = owner if first else None
    del sim, owner
    gc.collect()
Owner()
""")

    def test_a_cycle_of_virtual_creates_in_one_world_is_collected(self):
        self.run_program("""
for turned in (False, True):
    sims = [Sim()]
    sims.append(Sim(beside=sims[0]))
    robots = [Robot(sim=sim, **NOTHING) for sim in sims]
    for thing in (sims, robots):
        for one, other in zip(thing, reversed(thing)): one.other = other
    for sim, robot in zip(sims, robots): sim.robot = robot
    if turned: sims.reverse()
    del sims, robots, thing, one, other, sim, robot
    gc.collect()
sims = [Sim()]
sims += [Sim(beside=sims[0]) for _ in range(3)] # at the end, in any order
Owner()
""")

    def test_one_that_is_no_longer_used_is_closed_with_a_warning(self):
        said = self.run_program("""
import warnings
warnings.simplefilter("always")
def use():
    robot = Robot(PORT, **NOTHING)
    robot.start()
    follow(robot)
use()
robot = Robot(PORT, **NOTHING)  # its port is free at once
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
        owner.robot.wait(owner.robot.state.tick, 1.0)
threading.Thread(target=use, daemon=True).start()
time.sleep(0.2)
""")

    def test_the_program_is_interrupted_in_its_with(self):
        said = self.run_program("""
sim = Sim()
with Robot(PORT, **NOTHING) as robot, sim, Robot(sim=sim) as other:
    robot.start()
    other.start()
    for state in robot.states():
        robot.drive(200.0, 0.0)
        if state.tick == 30:
            signal.raise_signal(signal.SIGINT)
""", status=-2, said="KeyboardInterrupt")
        self.assertNotIn("Exception ignored", said)

    def test_its_control_function_does_not_return(self):
        for hang in ("while True: pass", "while True: time.sleep(100)", "threading.Event().wait()"):
            for end in ("", "del owner; gc.collect()", "owner.robot.close()"):
                with self.subTest(hang=hang, end=end):
                    self.run_program(f"""
class Hung(Owner):
    def __init__(self):
        self.robot = Robot(PORT, **NOTHING)
        self.robot.set_control(self.control)
        self.robot.start()
    def control(self, state):
        if state.tick > 30:
            {hang}
        return Wheels(100.0, 100.0)
owner = Hung()
try:
    follow(owner.robot, 100.0)
except Stalled:
    print("stalled")
try:
    {end or 'pass'}
except Stalled:
    pass
print("at its end")
""", said="stalled\nat its end")

    def test_a_forked_child_leaves_it_alone(self):
        self.run_program("""
owner = Owner()
child = os.fork()
if child == 0:
    assert owner.robot.closed
    try:
        owner.robot.drive(0.0, 0.0)
        sys.exit(3)
    except HandleError:
        pass
    with owner.robot:
        pass
    owner.robot.close()
    sys.exit(0)
_, status = os.waitpid(child, 0)
assert status == 0, status
assert not owner.robot.closed
follow(owner.robot)
assert owner.robot.statistics.commands_unsent == 0
""")

    def test_control_functions_are_changed_while_it_drives(self):
        self.run_program("""
robot = Robot(PORT, **NOTHING)
robot.start()
for number in range(200):
    def control(state, number=number, held=bytearray(100000)):
        return Wheels(number, number)
    robot.set_control(control if number % 3 else None)
    del control
    gc.collect(0)
follow(robot, 0.2)
robot.set_control(None)
robot.end()
""")


class Context(unittest.TestCase):
    def test_the_error_in_its_body_comes_out(self):
        for error in (KeyError("planted"), KeyboardInterrupt("planted"), SystemExit("planted")):
            with self.assertRaisesRegex(type(error), "planted"):
                with virtual() as sim, Robot(sim=sim) as robot:
                    robot.start()
                    robot.wait()
                    raise error
            self.assertTrue(robot.closed and sim.closed)

    def test_is_left_though_it_was_closed(self):
        with virtual() as sim:
            with Robot(sim=sim) as robot:
                robot.close()
                robot.close()
            robot.close()
            sim.close()
        sim.close()
        with self.assertRaises(HandleError):
            robot.start()
        with self.assertRaises(HandleError):
            sim.truth

    def test_of_a_virtual_create_closes_its_robot(self):
        with self.assertRaisesRegex(KeyError, "planted"):
            with virtual() as sim:
                robot = Robot(sim=sim)
                robot.start()
                raise KeyError("planted")
        self.assertTrue(robot.closed and sim.closed)
        with virtual() as sim:
            robot = Robot(sim=sim)
            with self.assertRaises(StateError):
                sim.close()
            self.assertFalse(sim.closed)
            self.assertIs(sim.truth.mode, Mode.SAFE)

    def test_of_a_virtual_create_closes_those_beside_it(self):
        with virtual() as sim:
            beside = Sim(beside=sim)
            robot = Robot(sim=beside)
            with self.assertRaises(StateError):
                sim.close()
            self.assertEqual(beside.truth.sim_time, sim.truth.sim_time)
        self.assertTrue(robot.closed and beside.closed and sim.closed)
        with self.assertRaisesRegex(HandleError, "beside"):
            Sim(beside=sim)

    def test_what_closing_says_too_is_a_note(self):
        with self.assertRaisesRegex(KeyError, "planted") as caught:
            with virtual() as sim, Robot(sim=sim) as robot:
                robot.set_control(lambda state: 1 / 0)
                robot.start()
                function = cargobay.robot.library.cargobay_wait
                checked, function.errcheck = function.errcheck, lambda result, *_: result
                function(robot._handle, 0, 100_000_000, None)
                function.errcheck = checked
                raise KeyError("planted")
        self.assertIn("division by zero", "".join(caught.exception.__notes__))


if __name__ == "__main__":
    unittest.main()
