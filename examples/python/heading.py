#!/usr/bin/env python3
"""Turns to a heading and holds it for six seconds, whatever pushes the robot.

usage: heading.py [PORT]; without a port on a virtual Create.
"""

import math
import sys

from cargobay import Robot

WANTED_RAD = math.radians(90.0)
GAIN_PER_S = 2.0
MOST_RAD_S = 1.5

with Robot(sys.argv[1] if len(sys.argv) > 1 else None) as robot:
    robot.start()
    print(robot.missing_rights, end="", file=sys.stderr)
    for state in robot.states(6.0):
        error_rad = WANTED_RAD - state.heading_rad
        robot.drive(0.0, max(-MOST_RAD_S, min(MOST_RAD_S, GAIN_PER_S * error_rad)))
    robot.end()
    print(f"heading {math.degrees(state.heading_rad):.1f} degrees, wanted 90.0")
    sys.exit(abs(error_rad) > math.radians(2.0))
