#!/usr/bin/env python3
"""A minute of a loop that is closed in Python over the virtual Create: no frame is lost.

usage: python_minute.py [SECONDS]; $CARGOBAY_LIBRARY and $CARGOBAY_GUARD as for the module
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "hal/python"))

from cargobay import Robot  # noqa: E402

with Robot() as robot:
    robot.start()
    seen = skipped = 0
    for state in robot.states(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0):
        robot.drive(150.0, -2.0 * state.heading_rad)
        seen += 1
        skipped += state.skipped
    counted = robot.statistics
    robot.end()
print(f"{seen} states seen of {counted.frames_good} frames, {skipped} skipped; "
      f"{counted.frames_bad} bad, {counted.frames_lost} lost; heading {state.heading_rad:.3f} rad")
sys.exit(counted.frames_lost + counted.frames_bad > 0 or abs(state.heading_rad) > 0.05)
