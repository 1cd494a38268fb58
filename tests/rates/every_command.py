#!/usr/bin/env python3
"""Every command that talks to a robot, at each of its twelve rates: it works, or refuses with the
reason and the way out, before the robot hears anything; and leaves the robot where the next command
finds it.

usage: every_command.py BUILD [--only EXPRESSION] [--lanes N]
"""

import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "lastword"))

from harness import case, check, command, run  # noqa: E402

RATES = (300, 600, 1200, 2400, 4800, 9600, 14400, 19200, 28800, 38400, 57600, 115200)
# What a stream of this many bytes per tick needs (docs/protocol.md).
DRIVES_FROM, BRINGS_UP_FROM = 14400, 9600
# For each, the lowest rate at which it works. Any lower one is refused.
COMMANDS = (
    (("sensors", "--once"), 300),
    (("sensors", "--once", "--json"), 300),
    (("send", "start; sensors group_6; query_list distance angle oi_mode"), 300),
    (("send", "start; song 1 60:16 62:16; script { sensors oi_mode }; show_script"), 300),
    (("send", "--duration", "0.3", "start; safe; drive_direct 50 50"), 300),
    (("send", "--listen", "0.3", "start; stream oi_mode"), 4800),
    (("bringup",), BRINGS_UP_FROM),
    (("bringup", "--mode", "full"), BRINGS_UP_FROM),
    (("drive", "--duration", "0.5"), DRIVES_FROM),
    (("drive", "--profile", "spin", "--duration", "0.5"), DRIVES_FROM),
    (("calibrate",), DRIVES_FROM),
    (("jitter", "--channels", "robot", "--duration", "1"), DRIVES_FROM),
)
_PATIENCE_S = 90.0  # a calibration takes 50
# The reason, and what to do instead.
_WAY_OUT = re.compile(r"(does not fit|do not fit).*; (choose|take|send|ask)")


def end(create, *words):
    with command(create, *words) as program:
        return program.end(_PATIENCE_S), program.out, program.err


def is_found(create, baud):
    """By what looks at one rate, and by what looks everywhere."""
    code, _, err = end(create, "sensors", "--once", "--baud", str(baud))
    check(code == 0, f"the next command does not find the robot at {baud} baud: {err}")


def at_each_rate(create, words, baud, least):
    if baud != 57600:
        code, _, err = end(create, "send", f"start; baud {baud}")
        check(code == 0, f"send does not change the rate: {err}")
    before = create.now().bytes_received
    code, out, err = end(create, *words, "--baud", str(baud))
    if baud < least:
        check(code != 0, f"it works at {baud} baud, against what it is said to")
        check(_WAY_OUT.search(err), f"it refuses without a reason or a way out: {err}")
        if words[0] != "send":
            check(create.now().bytes_received == before, "it refuses when the robot has heard it")
    else:
        check(code == 0, f"exit code {code}: {out[-300:]} {err[-300:]}")
    check(create.now().told_to_stop, f"the robot is {create.now()}")
    is_found(create, baud)


def from_each_rate(create, words, baud):
    """A command that is not told where the robot was left."""
    code, _, err = end(create, "send", f"start; baud {baud}")
    check(code == 0, f"send does not change the rate: {err}")
    code, _, err = end(create, *words)
    if words[0] in ("sensors", "send"):  # these try one rate, and name what tries all
        check(code != 0 and "`cargobay bringup` finds it" in err, f"exit code {code}: {err}")
        code, _, err = end(create, "bringup")
    check(code == 0, f"exit code {code}: {err}")
    is_found(create, 57600)


for words, least in COMMANDS:
    for baud in RATES:
        case(words, baud, least)(at_each_rate)
for words in (("drive", "--duration", "0.3"), ("sensors", "--once"), ("send", "sensors oi_mode")):
    for baud in RATES:
        if baud != 57600:
            case(words, baud)(from_each_rate)

if __name__ == "__main__":
    run()
