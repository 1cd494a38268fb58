#!/usr/bin/env python3
"""Programs that begin without some of the descriptors 0 to 2: what they print never reaches a robot.

usage: closed.py BUILD [--only EXPRESSION] [--lanes N]
"""

import os
import signal
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from harness import (Build, Program, Watched, case, check, check_at_rest,  # noqa: E402
                     check_stands, command, owner, run, watched)

CLOSED = ("", "0", "1", "2", "01", "02", "12", "012")
COMMANDS = (
    ("drive", "--duration", "0.5"), ("bringup",), ("sensors", "--once"), ("sensors", "--json"),
    ("send", "start; safe; sensors voltage"), ("calibrate",), ("jitter", "--duration", "1"),
    ("doctor",))
# How long a command may run before it is asked to end.
_LONGEST_S = 2.5


def check_commands_only(create):
    unknown = create.now().unknown_opcodes - Watched(create).zeros
    check(unknown <= 0, f"{unknown} bytes that are no command reached the robot")


def runs(create, words, closed):
    with command(create, *words, environment=watched(create), closed=closed) as program:
        limit = time.monotonic() + _LONGEST_S
        while program.running() and time.monotonic() < limit:
            time.sleep(0.02)
        if program.running():
            program.send(signal.SIGINT)
        code = program.end()
        if words[0] == "send":  # leaves the mode as requested
            check_stands(create, program.ended_at, lambda sample: sample.told_to_stop)
        else:
            check_at_rest(create, program.ended_at)
        check_commands_only(create)
        # Without a place for its results a command may fail, but not crash.
        check(0 <= code < 128 or code == 128 + signal.SIGINT,
              f"exit code {code}: {program.out[-200:]} {program.err[-200:]}")


def owner_prints(create, interface, closed):
    """A user's program that has closed what it does not need, and prints all the same."""
    with owner(create, interface, "driving", "return", environment=watched(create),
               closed=closed) as program:
        program.end()
        check_at_rest(create, program.ended_at)
        check_commands_only(create)


def sim_serves(create, closed):
    """The virtual Create itself: its words do not reach a client."""
    link = os.path.join(create.folder, "other")
    with Program(create, [Build.path("cargobay"), "sim", "--link", link], closed=closed) as program:
        limit = time.monotonic() + 10.0
        while not os.path.exists(link) and time.monotonic() < limit:
            time.sleep(0.02)
        with Program(create, [Build.path("cargobay"), "drive", "--port", link, "--duration", "0.3"],
                     ) as drive:
            code = drive.end()
            check(code == 0, f"a drive ends with {code}: {drive.err}")
        port = os.open(link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        time.sleep(0.3)
        try:
            said = os.read(port, 100)
        except BlockingIOError:
            said = b""
        os.close(port)
        check(not said, f"it says {said!r}")
        check(program.running(), f"it has ended: {program.err}")
        program.send(signal.SIGTERM)
        code = program.end(2.5)
        # It cannot print the name of its port: a write error, at the end.
        check(code == (1 if "1" in closed else 0), f"exit code {code}")


for shut in CLOSED:
    for words in COMMANDS:
        case(words, shut)(runs)
    for interface in ("c", "cpp", "python"):
        case(interface, shut)(owner_prints)
    case(shut)(sim_serves)

run()
