#!/usr/bin/env python3
"""A controller that others watch while it drives a figure of eight: run `cargobay top` beside it.

usage: watched.py [PORT [SECONDS]]; without a port on a virtual Create.
"""

import math
import sys

from cargobay import Flag, Robot

EIGHT_S = 8.0

port = sys.argv[1] if len(sys.argv) > 1 else None
seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 2.0
flags = Flag.PUBLISH  # is all that it takes
if port is None:
    flags |= Flag.NO_CONFIG  # a virtual Create
with Robot(port, flags=flags) as robot:
    robot.start()
    robot.wait()
    while (now_s := robot.state.robot_time_ns / 1e9) < seconds:
        side = 1.0 if now_s / EIGHT_S % 1.0 < 0.5 else -1.0
        robot.drive(150.0, side * 4.0 * math.pi / EIGHT_S)
        robot.wait(robot.state.tick)
    robot.end()
