#!/usr/bin/env python3
"""Two coroutines beside each other: one drives a circle, the other watches; each sees every frame.

usage: two_coroutines.py [PORT]; without a port on a virtual Create.
"""

import asyncio
import math
import sys

from cargobay import Robot, aio

SPEED_MM_S = 150.0
RADIUS_MM = 200.0


async def drive(robot: Robot) -> int:
    frames = 0
    async for state in aio.states(robot):
        frames += 1
        if state.heading_rad >= 2.0 * math.pi:
            break
        robot.drive_radius(SPEED_MM_S, RADIUS_MM)
    robot.request_end()  # which ends the other coroutine too
    return frames


async def watch(robot: Robot) -> int:
    frames = 0
    async for state in aio.states(robot):
        if frames % 100 == 0:
            print(f"{state.robot_time}  {state.x_mm:6.1f} {state.y_mm:6.1f} mm")
        frames += 1
    return frames


async def main(port: str | None) -> None:
    with await aio.open_robot(port) as robot:
        robot.start()
        driven, watched = await asyncio.gather(drive(robot), watch(robot))
        robot.end()
        print(f"frames seen: {driven} while driving, {watched} while watching")


asyncio.run(main(sys.argv[1] if len(sys.argv) > 1 else None))
