#!/usr/bin/env python3
"""What the loop learns of the wheels, and what becomes of it.

usage: python_learnt_test.py [LIBRARY]
"""

import pathlib
import tempfile
import unittest

from python_support import virtual

from cargobay import Flag, NoFrame, Remainder, Robot


def drive(robot, seconds):
    robot.start()
    for state in robot.states(seconds):
        robot.drive(200.0 if state.tick % 160 < 80 else 100.0, 0.3)


class Learnt(unittest.TestCase):
    def test_is_reported(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            with self.assertRaises(NoFrame):
                robot.learnt
            drive(robot, 8.0)
            learnt = robot.learnt
            self.assertAlmostEqual(learnt.gain_left, 0.94, delta=0.05)
            self.assertAlmostEqual(learnt.gain_right, 0.90, delta=0.05)
            self.assertAlmostEqual(learnt.lag.total_seconds(), 0.1, delta=0.05)
            self.assertGreater(learnt.lag_sd_ns, 0)
            self.assertIs(learnt.remainder, Remainder.CARRIED)
            self.assertFalse(learnt.from_earlier)

    def test_is_where_the_next_start_begins(self):
        with virtual() as sim, Robot(sim=sim) as robot:
            drive(robot, 8.0)
            robot.end()
            drive(robot, 0.1)
            self.assertTrue(robot.learnt.from_earlier)

    def test_is_kept_in_a_file_that_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder) / "it.toml"
            for flags, earlier, kept in (
                    (Flag.NO_LEARNT, False, False), (Flag(0), False, True), (Flag(0), True, True),
                    (Flag.FORGET, False, True), (Flag.NO_LEARNT, False, True)):
                with virtual() as sim, Robot(sim=sim, flags=flags,
                                             settings=f"[robot]\nlearnt = '{file}'") as robot:
                    drive(robot, 6.0)
                    self.assertEqual(robot.learnt.from_earlier, earlier)
                    robot.end()
                self.assertEqual(file.exists(), kept)


if __name__ == "__main__":
    unittest.main()
