#!/usr/bin/env python3
"""Drives a square of half a metre, side by side, and prints where each corner was.

usage: square.py [PORT]; without a port on a virtual Create in virtual time: done at once, and the
same each time.
"""

import math
import sys

from cargobay import Robot, Sim, SimTime

SIDE_MM = 500.0
SPEED_MM_S = 250.0
TURN_RAD_S = 1.5


def drive_side(robot: Robot) -> None:
    end_mm = robot.state.distance_mm + SIDE_MM
    for state in robot.states():
        left_mm = end_mm - state.distance_mm
        if left_mm <= 0.0:
            return
        robot.drive(min(SPEED_MM_S, 30.0 + 2.0 * left_mm), 0.0)  # the closer, the slower


def turn_to(robot: Robot, end_rad: float) -> None:
    for state in robot.states():
        left_rad = end_rad - state.heading_rad
        if left_rad <= 0.0:
            return
        robot.drive(0.0, min(TURN_RAD_S, 0.1 + 3.0 * left_rad))


def drive_square(robot: Robot, sim: Sim | None = None) -> None:
    robot.start()
    print(robot.missing_rights, end="", file=sys.stderr)
    robot.wait()
    for corner in range(1, 5):
        drive_side(robot)
        turn_to(robot, corner * math.pi / 2.0)
        line = f"corner {corner}: {robot.state.x_mm:7.1f} {robot.state.y_mm:7.1f} mm"
        if sim is not None:
            line += f", in truth {sim.truth.x_mm:7.1f} {sim.truth.y_mm:7.1f} mm"
        print(line)
    robot.end()


if len(sys.argv) > 1:
    with Robot(sys.argv[1]) as real:
        drive_square(real)
else:
    with Sim(time=SimTime.VIRTUAL) as sim, Robot(sim=sim) as virtual:
        drive_square(virtual, sim)
