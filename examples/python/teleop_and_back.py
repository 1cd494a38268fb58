#!/usr/bin/env python3
"""Hands the robot from setpoints to a controller and back; ticks and odometry go on.

A remote control is played by a loop here: it drives ahead, lets a controller turn the robot round,
and drives back to where it began.

usage: teleop_and_back.py [PORT]; without a port on a virtual Create in virtual time.
"""

import contextlib
import math
import sys

from cargobay import SETPOINT, Answer, Robot, Sim, SimTime, State, Twist


def turn_round(state: State) -> Twist | Answer:
    left_rad = math.pi - state.heading_rad
    return SETPOINT if left_rad < 0.02 else Twist(0.0, min(1.5, 2.0 * left_rad))


with contextlib.ExitStack() as stack:
    if len(sys.argv) > 1:
        robot = stack.enter_context(Robot(sys.argv[1]))
    else:
        sim = stack.enter_context(Sim(time=SimTime.VIRTUAL))
        robot = stack.enter_context(Robot(sim=sim))
    robot.start()
    for state in robot.states(3.0):
        robot.drive(200.0, 0.0)
    robot.stop()
    robot.set_control(turn_round)
    for state in robot.states(4.0):
        pass
    robot.set_control(None)
    for state in robot.states(3.0):
        robot.drive(200.0, 0.0)
    robot.end()
    print(f"back at {state.x_mm:.0f} {state.y_mm:.0f} mm after {state.distance_mm:.0f} mm")
