"""As owner.c, in Python: with a garbage collector, and exceptions.

usage: owner.py PORT opened|driving return|exit|_exit|raise|raise_in_control|endless|cycle|drive|
       fork|until_the_end|close_range|finish
"""

import os
import resource
import sys
import time

from cargobay import Error, Flag, Robot, Wheels

resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
port, when, way = sys.argv[1:4]
deed = "drive"


def say(*words):
    print(*words, flush=True)


def control(state):
    while deed == "endless":
        pass
    if deed == "raise_in_control":
        raise RuntimeError("the controller has a bug")
    return Wheels(200.0, 200.0)


def until_the_end(robot):
    frames, code = 0, 0
    try:
        for _ in robot.states():
            if way not in ("endless", "raise_in_control"):
                robot.drive(200.0, 0.0)
            frames += 1
            if frames == 2000:
                break
    except Error as error:
        code = error.code
        print(f"wait: {error}", file=sys.stderr)
    say("wait", int(code), frames)
    return finish(robot) or int(code != 0)


def finish(robot):
    result = 0
    for name, call in (("stop", robot.end), ("close", robot.close)):
        begin, code = time.monotonic(), 0
        try:
            call()
        except Error as error:
            code, result = error.code, 1
            print(f"{name}: {error}", file=sys.stderr)
        say(name, int(code), round(1e3 * (time.monotonic() - begin)))
    return result


class Controller:
    """Holds a robot that calls it: a circle."""

    def __init__(self):
        self.robot = Robot(port, flags=Flag.NO_CONFIG)
        self.robot.set_control(self.decide)
        self.robot.start()

    def decide(self, state):
        return Wheels(200.0, 200.0)


if way == "cycle":
    controller = Controller()
    time.sleep(0.6)
    say("driving")
    del controller
    sys.exit(0)

robot = Robot(port, flags=Flag.NO_CONFIG)
say("open")
if when == "driving":
    if way in ("endless", "raise_in_control"):
        robot.set_control(control)
    robot.start()
    for state in robot.states():
        if way not in ("endless", "raise_in_control"):
            robot.drive(200.0, 0.0)
        if state.tick >= 40:
            break
    say("driving")
if way == "exit":
    sys.exit(3)
if way == "_exit":
    os._exit(3)
if way == "raise":
    raise RuntimeError("nobody catches this")
if way == "fork":
    child = os.fork()
    if child == 0:
        time.sleep(20.0)
        os._exit(0)
    say("child", child)
if way in ("drive", "fork"):
    while True:
        if when == "driving":
            robot.drive(200.0, 0.0)
        time.sleep(0.05)
if way == "close_range":
    os.closerange(3, 65536)
deed = way
if way == "finish":
    sys.exit(finish(robot))
if way != "return":
    sys.exit(until_the_end(robot))
