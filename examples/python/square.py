#!/usr/bin/env python3
"""Drives a square of half a metre, side by side, and prints where each corner was.

usage: square.py [PORT]; without a port on a virtual Create in virtual time: done at once, and the
same each time.
"""

import contextlib
import math
import sys

from cargobay import Robot, Sim, SimTime

SIDE_MM = 500.0
SPEED_MM_S = 250.0
TURN_RAD_S = 1.5

with contextlib.ExitStack() as stack:
    port = sys.argv[1] if len(sys.argv) > 1 else None
    sim = None if port else stack.enter_context(Sim(time=SimTime.VIRTUAL))
    robot = stack.enter_context(Robot(port, sim=sim))
    robot.start()
    print(robot.missing_rights, end="", file=sys.stderr)
    robot.wait()
    for corner in range(1, 5):
        end_mm = robot.state.distance_mm + SIDE_MM
        while (left_mm := end_mm - robot.state.distance_mm) > 0.0:
            robot.drive(min(SPEED_MM_S, 30.0 + 2.0 * left_mm), 0.0)  # the closer, the slower
            robot.wait(robot.state.tick)
        while (left_rad := corner * math.pi / 2.0 - robot.state.heading_rad) > 0.0:
            robot.drive(0.0, min(TURN_RAD_S, 0.1 + 3.0 * left_rad))
            robot.wait(robot.state.tick)
        line = f"corner {corner}: {robot.state.x_mm:7.1f} {robot.state.y_mm:7.1f} mm"
        if sim:
            line += f", in truth {sim.truth.x_mm:7.1f} {sim.truth.y_mm:7.1f} mm"
        print(line)
    robot.end()
