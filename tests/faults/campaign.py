#!/usr/bin/env python3
"""Makes each system call on the robot's port fail once, and looks what becomes of the robot.

usage: campaign.py BUILD [--runs N] [--seed SEED] [--lanes N] [--table FILE] [--again WORDS]

A run is a virtual Create, a program that drives it for half a second, and one fault, drawn by the
seed and the number of the run. One that failed is named by five words: --again 'c drive write 31
EIO' repeats it, as often as --runs says. Fails if a robot does not stand, a program claims a
success that was none, a port is not free or not as it was found, or anything but a whole command
reaches the robot.
"""

import argparse
import collections
import concurrent.futures
import errno
import os
import pathlib
import random
import re
import signal
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "lastword"))

from harness import Build, Watched, command, owner, watched  # noqa: E402
from virtual_create import ALLOWANCE_S, STOP_S, VirtualCreate  # noqa: E402

PHASES = ("bring_up", "drive", "leave")
# In these cases the guard meets the fault: its program was killed, or suspended.
GUARDED = ("killed", "hung")
# Half of them are the command; the linked ones all use one library.
DRIVERS = ("command", "command", "command", "c", "c", "cpp", "python")
# What a kernel may return to each, by its manual pages and the tty layer's sources; SHORT: one byte
# of those asked for, ZERO: returns 0, HUP and NVAL: what poll() finds.
ERRORS = {
    "open": ("EINTR", "EIO", "ENXIO", "ENODEV", "ENOMEM", "EMFILE", "ENFILE", "EACCES", "EBUSY"),
    "read": ("EIO", "EAGAIN", "EINTR", "EBADF", "ENXIO", "ENOMEM", "EINVAL", "SHORT", "ZERO"),
    "write": ("EIO", "EAGAIN", "EINTR", "EBADF", "ENXIO", "ENOSPC", "ENOMEM", "EPERM", "EINVAL",
              "ETIMEDOUT", "SHORT", "ZERO"),
    "poll": ("EINTR", "ENOMEM", "EINVAL", "ZERO", "HUP", "NVAL"),
    "ioctl": ("EIO", "EINTR", "ENOTTY", "EINVAL", "ENXIO", "EPERM", "ENOMEM", "EBADF"),
    "fcntl": ("EBADF", "EMFILE", "EINTR", "ENOMEM", "EINVAL"),
    "flock": ("EINTR", "ENOLCK", "EBADF", "EWOULDBLOCK"),
    "close": ("EINTR", "EIO"),
    "fstat": ("EIO", "EBADF", "ENOMEM"),
    "dup": ("EBADF", "EMFILE", "ENOMEM"),
    "tcgetattr": ("EIO", "EBADF", "ENOTTY", "ENXIO"),
    "tcsetattr": ("EIO", "EBADF", "EINTR", "ENOTTY", "ENXIO"),
    "tcflush": ("EIO", "EBADF", "ENOTTY"),
    "tcdrain": ("EIO", "EBADF", "EINTR", "ENOTTY"),
    "isatty": ("EIO", "EBADF"),
}
# These restore the port's settings, or report that it is the port: if they fail, they may not have.
SETTINGS = ("ioctl", "tcgetattr", "tcsetattr", "fcntl", "fstat")
# This share of the counted calls is not drawn: drives differ by a frame or so.
_SPARE = 0.1


def start(create, driver, phase, environment):
    """Drives for half a second; to be killed, for as long as it takes."""
    if driver == "command":
        duration = "30" if phase in GUARDED else "0.5"
        return command(create, "drive", "--duration", duration, environment=environment)
    way = "until_the_end" if phase in GUARDED else "finish"
    return owner(create, driver, "driving", way, environment=environment)


def count_calls(driver):
    """How often each call is made in each phase, and by a guard that is needed."""
    with VirtualCreate(Build.path("cargobay")) as create:
        with start(create, driver, "leave", watched(create)) as program:
            if code := program.end(20.0):
                raise RuntimeError(f"{driver} without a fault ends with {code}: {program.err}")
            create.settles(program.ended_at)
        counts = Watched(create).counts
    with VirtualCreate(Build.path("cargobay")) as create:
        with start(create, driver, "killed", watched(create)) as program:
            if not create.drives():
                raise RuntimeError(f"{driver} does not drive: {program.err}")
            program.send(signal.SIGKILL)
            program.end()
            create.settles(program.ended_at)
            create.wait_for_port()
        guard = Watched(create).counts
    calls = {key: count for key, count in counts.items() if key[0] in PHASES}
    for phase in GUARDED:
        calls |= {(phase, call): count for (who, call), count in guard.items() if who == "guard"}
    return calls


class Run:
    """One fault and what came of it."""

    def __init__(self, number, driver, phase, call, at, error):
        self.number = number
        self.driver = driver
        self.phase = phase
        self.call = call
        self.at = int(at)
        self.error = error
        self.deed_after_s = random.Random(number).uniform(0.05, 0.3)
        self.injected = self.guard_stopped = False
        self.exit_code = 0
        self.stop_s = 0.0
        self.troubles = []

    @classmethod
    def draw(cls, seed, number, counts):
        chance = random.Random(f"{seed} {number}")
        driver = chance.choice(DRIVERS)
        phase = chance.choice((*PHASES, *GUARDED))
        call = chance.choice(sorted(call for when, call in counts[driver] if when == phase))
        most = counts[driver][phase, call]
        at = chance.randint(1, max(1, round(most * (1.0 - _SPARE))))
        return cls(number, driver, phase, call, at, chance.choice(ERRORS[call]))

    def __str__(self):
        return f"{self.driver} {self.phase} {self.call} {self.at} {self.error}"

    def _plan(self, create):
        error = getattr(errno, self.error, self.error)
        if self.phase in GUARDED:
            return watched(create, who="guard", call=self.call, at=self.at, error=error)
        return watched(create, phase=self.phase, call=self.call, at=self.at, error=error)

    def carry_out(self):
        with VirtualCreate(Build.path("cargobay"), "--seed", str(self.number)) as create:
            with start(create, self.driver, self.phase, self._plan(create)) as program:
                try:
                    if self.phase in GUARDED:
                        create.drives()
                        time.sleep(self.deed_after_s)
                    if self.phase == "killed":
                        program.send(signal.SIGKILL)
                    if self.phase == "hung":
                        self.stop_s = create.settles(program.send(signal.SIGSTOP))
                        program.send(signal.SIGCONT)
                    self.exit_code = program.end(15.0)
                except AssertionError as hangs:
                    self.troubles.append(str(hangs))
                    return
                self._judge(create, program)

    def _judge(self, create, program):
        say = self.troubles.append
        ended_at = program.ended_at
        took_s = create.settles(ended_at)
        log = Watched(create)
        self.injected = log.fault_at is not None
        self.guard_stopped = log.guard_stops
        if self.phase != "hung":
            self.stop_s = took_s
        if self.phase == "drive" and self.injected and self.exit_code != 0:
            self.stop_s = create.settles(log.fault_at)  # older than the end of the program
        if took_s is None:
            say(f"the robot is {create.now()}")
        elif self.stop_s is None or self.stop_s > STOP_S + ALLOWANCE_S:
            say(f"told to stop after {self.stop_s} s only")
        for trouble in create.wait_for_port(settings_too=self.call not in SETTINGS):
            say(trouble)
        if create.now().unknown_opcodes > log.zeros and not create.now().framing_errors:
            say(f"{create.now().unknown_opcodes} bytes were no command, {log.zeros} of them filled")
        if self.phase == "killed":
            return
        if self.exit_code < 0 or self.exit_code > 1:
            say(f"exit code {self.exit_code}")
        if self.exit_code != 0 and not re.search(r"\S+ \S+", program.err):
            say("it fails without a word")
        if self.exit_code == 0 and create.now().mode != "passive":
            say(f"it reports success, and the robot is {create.now()}")


def worst(runs):
    """The longest until a robot was told to stop, ms."""
    if any(run.stop_s is None for run in runs):
        return "never"
    return f"{1e3 * max((run.stop_s for run in runs), default=0.0):.0f}"


def table(runs):
    """Markdown: a row for each call, error and phase."""
    phases = (*PHASES, *GUARDED)
    rows = collections.defaultdict(list)
    for run in runs:
        rows[phases.index(run.phase), run.call, run.error].append(run)
    lines = ["| phase | call | error | runs | met | drove on | reported | stopped by guard "
             "| worst, ms | failed |", "|" + "---|" * 10]
    for (phase, call, error), some in sorted(rows.items()):
        met = [run for run in some if run.injected]
        cells = (phases[phase].replace("_", "-"), f"`{call}`", error, len(some), len(met),
                 sum(run.exit_code == 0 for run in met), sum(run.exit_code > 0 for run in met),
                 sum(run.guard_stopped for run in met),
                 worst(met),
                 sum(bool(run.troubles) for run in some))
        lines.append("| " + " | ".join(str(cell or "") for cell in cells) + " |")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", help="the build's folder")
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--again", help="DRIVER PHASE CALL NUMBER ERROR, as a failed run was named")
    parser.add_argument("--lanes", type=int, default=8, help="runs at a time")
    parser.add_argument("--table", help="a file for the table")
    options = parser.parse_args()
    Build.folder = pathlib.Path(options.build).resolve()
    begin = time.monotonic()
    if options.again:
        runs = [Run(number, *options.again.split()) for number in range(options.runs)]
    else:
        counts = {driver: count_calls(driver) for driver in sorted(set(DRIVERS))}
        runs = [Run.draw(options.seed, number, counts) for number in range(options.runs)]

    def carry_out(run):
        try:
            run.carry_out()
        except Exception as failure:  # of the campaign's own
            run.troubles.append(f"{type(failure).__name__}: {failure}")
        if run.troubles:
            print(f"{run} (run {run.number}): exit code {run.exit_code}: {'; '.join(run.troubles)}", flush=True)

    with concurrent.futures.ThreadPoolExecutor(options.lanes) as lanes:
        list(lanes.map(carry_out, runs))
    if options.table:
        pathlib.Path(options.table).write_text(table(runs))
    failed = sum(bool(run.troubles) for run in runs)
    met = sum(run.injected for run in runs)
    print(f"{len(runs)} runs of seed {options.seed}, {met} met their fault, {failed} failed, "
          f"in {time.monotonic() - begin:.0f} s")
    # A campaign that hardly injects anything proves nothing.
    return 1 if failed or met < len(runs) / 2 else 0


sys.exit(main())
