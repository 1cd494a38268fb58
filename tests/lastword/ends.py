#!/usr/bin/env python3
"""Each end of a program that owns a robot, by each interface: whatever it is, the robot stands.

usage: ends.py BUILD [--only EXPRESSION] [--lanes N]
"""

import errno
import fcntl
import os
import pathlib
import random
import signal
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from harness import (SIGNALS, Watched, alone, case, check, check_at_rest, check_stands,  # noqa: E402
                     command, driver, owner, run, watched)
from virtual_create import ALLOWANCE_S  # noqa: E402

INTERFACES = ("command", "c", "cpp", "python")
OWNERS = ("c", "cpp", "python")
_STALLED = -21
# How long cargobay_stop() may take by its header, with a margin for the machine.
_BLOCKS_MS = 1000 + 1000


def each(*lists):
    """Registers a case for each combination."""

    def register(function):
        combinations = [()]
        for options in lists:
            combinations = [(*first, last) for first in combinations for last in options]
        for combination in combinations:
            case(*combination)(function)
        return function

    return register


def ends_by_itself(create, interface, when, way):
    with owner(create, interface, when, way) as program:
        program.end()
        check_at_rest(create, program.ended_at)


each(("c",), ("opened", "driving"), ("return", "exit", "_exit", "abort", "segv"))(ends_by_itself)
each(("cpp",), ("opened", "driving"), ("return", "exit", "throw", "bad_alloc"))(ends_by_itself)
each(("python",), ("opened", "driving"), ("return", "exit", "_exit", "raise"))(ends_by_itself)


@each(OWNERS, ("opened", "driving"), ("KILL", "TERM"))
def is_killed(create, interface, when, name):
    with owner(create, interface, when, "drive") as program:
        program.says("driving" if when == "driving" else "open")
        since = program.send(SIGNALS[name])
        program.end()
        check_at_rest(create, since)


@each(("KILL", "TERM", "INT", "HUP", "QUIT"))
def drive_is_killed(create, name):
    with command(create, "drive", "--duration", "60") as program:
        check(create.drives(), program.err)
        since = program.send(SIGNALS[name])
        code = program.end(3.0)
        check(name == "KILL" or code > 0, f"exit code {code}")
        check_at_rest(create, since)


@each(("bringup", "drive", "c"), range(8))
def is_killed_in_bring_up(create, which, seed):
    starts = owner(create, "c", "opened", "drive") if which == "c" else command(create, which)
    with starts as program:
        check(create.wait_for(lambda sample: sample.bytes_received > 0), "it sends nothing")
        time.sleep(random.Random(f"{which} {seed}").uniform(0.0, 0.25))
        since = program.send(signal.SIGKILL)
        program.end()
        # Before there is a guard, and once it has been released, nothing else restores the port.
        check_at_rest(create, since, settings_too=False)


@each(("KILL", "TERM", "INT"))
def calibrate_is_killed(create, name):
    with command(create, "calibrate") as program:
        check(create.drives(), f"it does not drive: {program.out} {program.err}")
        since = program.send(SIGNALS[name])
        program.end(3.0)
        check_at_rest(create, since)


@each(("start; safe; drive 200 straight", "start; full; drive_direct 200 200"),
      ("KILL", "TERM", "INT"))
def send_is_killed(create, text, name):
    """The mode is what its user wanted; that the wheels turn on is not."""
    with command(create, "send", "--duration", "30", text) as program:
        check(create.drives(), f"it does not drive: {program.out} {program.err}")
        since = program.send(SIGNALS[name])
        program.end(3.0)
        check_stands(create, since, lambda sample: sample.told_to_stop)


@each((("sensors", "--json"), ("jitter", "--duration", "30")), ("KILL", "TERM", "INT"))
def watcher_is_killed(create, words, name):
    with command(create, *words) as program:
        time.sleep(1.5)
        check(program.running(), f"it does not run: {program.out[-300:]} {program.err}")
        since = program.send(SIGNALS[name])
        program.end(3.0)
        check_at_rest(create, since)


@each(OWNERS)
def is_suspended(create, interface):
    """Its guard stops the robot, and it has nothing more to say when it is woken."""
    with driver(create, interface) as program:
        since = program.send(signal.SIGSTOP)
        took_s = create.settles(since)
        check(took_s is not None, f"the robot is {create.now()}")
        program.send(signal.SIGCONT)
        told(program, "guard")
        check(program.value("wait")[0] == _STALLED, f"not STALLED: {program.out}")
        check_at_rest(create, program.ended_at)


@each(INTERFACES)
def is_suspended_and_killed(create, interface):
    """The guard has stopped the robot when its program dies: the port is still to be put back."""
    with driver(create, interface) as program:
        took_s = create.settles(program.send(signal.SIGSTOP))
        check(took_s is not None, f"the robot is {create.now()}")
        program.send(signal.SIGKILL)
        program.end()
        check_at_rest(create, program.ended_at)


@each(INTERFACES)
def port_is_gone(create, interface):
    """For everybody: no stop can reach the robot, and nothing claims that it did."""
    with driver(create, interface) as program:
        guard = pathlib.Path("/proc", str(create.guard()))
        create.unplug()
        told(program, "port")
        check(not guard.exists(), "the guard waits for the port")


def told(program, word):
    """Its own loop's end has a cause that names the word, and its calls come back in time."""
    code = program.end()
    check(code > 0, f"exit code {code}: {program.out} {program.err}")
    check(word in program.err, f"it does not say '{word}': {program.out!r} {program.err!r}")
    for name in ("stop", "close"):
        values = program.value(name)
        check(values is None or values[1] <= _BLOCKS_MS, f"{name} took {values} ms")


@each(INTERFACES, ("KILL", "STOP"))
def guard_is_lost(create, interface, name):
    with driver(create, interface) as program:
        os.kill(create.guard(), {"KILL": signal.SIGKILL, "STOP": signal.SIGSTOP}[name])
        since = time.monotonic()
        told(program, "guard")
        check_at_rest(create, since)


@case()
def guard_is_lost_before_the_start(create):
    """Without one nothing is driven: there is a new one, or the start fails."""
    with owner(create, "c", "opened", "start_late") as program:
        program.says("open")
        guard = create.guard()
        os.kill(guard, signal.SIGKILL)
        if create.drives(2.0):
            check(create.guard() != guard, "it drives without a guard")
            program.send(signal.SIGKILL)
            program.end()
        else:
            told(program, "guard")
        check_at_rest(create, program.ended_at)


@each(("opened", "driving"))
def program_becomes_another(create, when):
    """execve(): the process lives on under its number, and its robot has no owner."""
    with owner(create, "c", when, "exec") as program:
        program.says("driving" if when == "driving" else "open")
        since = time.monotonic()
        check_at_rest(create, since)
        check(program.running(), program.err)


@each(INTERFACES)
def guard_is_suspended_and_program_killed(create, interface):
    with driver(create, interface) as program:
        os.kill(create.guard(), signal.SIGSTOP)
        since = time.monotonic()
        time.sleep(0.4)
        if program.running():
            program.send(signal.SIGKILL)
        program.end()
        took_s = create.settles(since)
        check(took_s is not None, f"the robot is {create.now()}")


@each(INTERFACES)
def program_is_killed_and_then_guard(create, interface):
    with driver(create, interface) as program:
        guard = create.guard()
        since = program.send(signal.SIGKILL)
        time.sleep(0.1)
        try:
            os.kill(guard, signal.SIGKILL)
        except ProcessLookupError:
            pass
        program.end()
        took_s = create.settles(since)
        check(took_s is not None, f"the robot is {create.now()}")


@each(INTERFACES, ("read", "write", "poll"), ("EIO", "ENOMEM"))
def call_fails_once(create, interface, call, error):
    plan = watched(create, phase="drive", call=call, at=80, error=getattr(errno, error))
    with driver(create, interface, plan) as program:
        limit = time.monotonic() + 5.0
        while (since := Watched(create).fault_at) is None:
            check(time.monotonic() < limit, "no fault was injected")
            time.sleep(0.01)
        time.sleep(1.0)
        if program.running() and create.now().fastest > 100.0:
            return  # it did not react, and drives
        code = program.end(3.0)
        check(code > 0 and program.err, f"exit code {code}: {program.err!r}")
        check_at_rest(create, since)


@each(OWNERS)
def descriptors_are_closed(create, interface):
    with owner(create, interface, "driving", "close_range") as program:
        program.says("driving")
        since = time.monotonic()
        told(program, "port")
        check_at_rest(create, since)


@each(("opened", "driving"))
def descriptors_are_used_for_a_file(create, when):
    file = pathlib.Path(create.folder, "file")
    with owner(create, "c", when, "reuse", str(file)) as program:
        program.says("driving" if when == "driving" else "open")
        since = time.monotonic()
        program.end()
        text = file.read_bytes()
        check(not text, f"{len(text)} bytes of the OI are in the user's file: {text[:32].hex(' ')}")
        told(program, "")
        check_at_rest(create, since)


@case()
def descriptors_are_used_for_a_terminal(create):
    with owner(create, "c", "driving", "reuse_terminal") as program:
        program.says("driving")
        since = time.monotonic()
        told(program, "")
        check(program.value("terminal") == [0], f"bytes at the terminal: {program.out}")
        check_at_rest(create, since)


@each(OWNERS)
@alone
def control_never_returns(create, interface):
    with owner(create, interface, "driving", "endless") as program:
        program.says("driving")
        since = time.monotonic()
        told(program, "")
        check(program.value("wait")[0] == _STALLED, f"not STALLED: {program.out}")
        check_at_rest(create, since)


@each(("throw_in_control",), ("cpp",))
@each(("raise_in_control",), ("python",))
def control_throws(create, way, interface):
    with owner(create, interface, "driving", way) as program:
        program.says("driving")
        since = time.monotonic()
        check(program.end() != 0, "it says that all went well")
        check_at_rest(create, since)


@each(("c",), ("opened", "driving"), ("fork", "fork_return"))
@each(("python",), ("driving",), ("fork",))
def child_outlives_its_parent(create, interface, when, way):
    with owner(create, interface, when, way) as program:
        limit = time.monotonic() + 10.0
        while program.value("child") is None and time.monotonic() < limit:
            time.sleep(0.01)
        child = program.value("child")[0]
        try:
            since = program.send(signal.SIGKILL) if way == "fork" else time.monotonic()
            program.end()
            check_at_rest(create, since)
            with command(create, "drive", "--duration", "0.3") as following:
                check(following.end() == 0, following.err)
        finally:
            os.kill(child, signal.SIGKILL)


@case()
def python_object_holds_its_robot(create):
    with owner(create, "python", "driving", "cycle") as program:
        program.says("driving")
        since = time.monotonic()
        code = program.end()
        check(code == 0, f"exit code {code}: {program.err}")
        check_at_rest(create, since)


@each(("--record", "--plot", "--json"), ("INT", "TERM", "KILL"))
def output_is_a_pipe_without_reader(create, option, name):
    pipe = os.path.join(create.folder, "pipe")
    os.mkfifo(pipe)
    with command(create, "drive", "--duration", "1", option, pipe) as program:
        time.sleep(2.5)
        since = program.send(SIGNALS[name])
        program.end(2.0 + ALLOWANCE_S)
        check_at_rest(create, since)


@each((("drive", "--duration", "60"), ("sensors",), ("sensors", "--json"),
       ("jitter",)),
      ("INT", "TERM", "KILL"))
def output_is_a_full_pipe(create, words, name):
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    fcntl.fcntl(writer, fcntl.F_SETPIPE_SZ, 4096)
    try:
        while True:
            os.write(writer, b"x" * 512)
    except BlockingIOError:
        os.set_blocking(writer, True)
    try:
        with command(create, *words, stdout=writer) as program:
            time.sleep(2.0)
            since = program.send(SIGNALS[name])
            program.end(2.0 + ALLOWANCE_S)
            check_at_rest(create, since)
    finally:
        os.close(reader)
        os.close(writer)


run()
