#!/usr/bin/env python3
"""Drives a square of half a metre, side by side, and tells where each corner was.

usage: square.py [PORT]; without a port on a virtual Create in virtual time: done in no time, and
the same each time.
"""

import contextlib
import math
import sys

from cargobay import Robot, SimTime, VirtualCreate

SIDE_MM = 500.0
SPEED_MM_S = 250.0
TURN_RAD_S = 1.5

with contextlib.ExitStack() as stack:
    sim = None
    if len(sys.argv) > 1:
        robot = stack.enter_context(Robot(sys.argv[1]))
    else:
        sim = stack.enter_context(VirtualCreate(time=SimTime.VIRTUAL))
        robot = stack.enter_context(Robot(sim=sim))
    robot.start()
    print(robot.missing_rights(), end="", file=sys.stderr)
    state = robot.wait()
    for corner in range(1, 5):
        end_mm = state.distance_mm + SIDE_MM
        while state.distance_mm < end_mm:
            # The closer, the slower.
            robot.drive(min(SPEED_MM_S, 30.0 + 2.0 * (end_mm - state.distance_mm)), 0.0)
            state = robot.wait()
        end_rad = corner * math.pi / 2.0
        while state.heading_rad < end_rad:
            robot.drive(0.0, min(TURN_RAD_S, 0.1 + 3.0 * (end_rad - state.heading_rad)))
            state = robot.wait()
        line = f"corner {corner}: {state.x_mm:7.1f} {state.y_mm:7.1f} mm"
        if sim is not None:
            truth = sim.truth()
            line += f", in truth {truth.x_mm:7.1f} {truth.y_mm:7.1f} mm"
        print(line)
    robot.stop()
