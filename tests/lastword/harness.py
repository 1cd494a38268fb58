"""Runs a table of cases, several at a time: each with a virtual Create of its own."""

import argparse
import collections
import concurrent.futures
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

from virtual_create import ALLOWANCE_S, STOP_S, Sample, VirtualCreate

SOURCE = pathlib.Path(__file__).resolve().parents[2]
_cases = []


class Build:
    """Where the programs are; set by run()."""

    folder = pathlib.Path()

    @classmethod
    def path(cls, name):
        return str(cls.folder / name)


class Skip(Exception):
    """This machine or user cannot try it."""


def alone(function):
    """Of a case that takes a processor for itself: it is run when the others are done."""
    function.alone = True
    return function


def check(holds, words):
    if not holds:
        raise AssertionError(words)


def case(*arguments):
    """Registers a function as a case; `arguments` are told in its name and given to it."""

    def register(function):
        words = (" ".join(each) if isinstance(each, tuple) else str(each) for each in arguments)
        name = "/".join([function.__name__, *words])
        _cases.append((name, function, arguments))
        return function

    return register


class Program:
    """A process over the robot of a case, and what it has said."""

    def __init__(self, create, words, environment=None, closed="", **options):
        self._create = create
        count = sum(name.startswith("out.") for name in os.listdir(create.folder))
        self._out = pathlib.Path(create.folder, f"out.{count}")
        self._err = pathlib.Path(create.folder, f"err.{count}")
        if closed:  # the descriptors that it does not have
            shut = " ".join(f"{each}<&-" if each == "0" else f"{each}>&-" for each in closed)
            words = ["sh", "-c", f'exec "$@" {shut}', "sh", *words]
        environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", **(environment or {})}
        options.setdefault("stdin", subprocess.DEVNULL)
        with open(self._out, "wb") as out, open(self._err, "wb") as err:
            options.setdefault("stdout", out)
            self._process = subprocess.Popen(
                words, stderr=err, env=environment, start_new_session=True, **options)
        self.number = self._process.pid
        self.ended_at = None

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self._process.poll() is None:
            self._process.kill()
        self._process.wait()

    @property
    def out(self):
        return self._out.read_text(errors="replace")

    @property
    def err(self):
        return self._err.read_text(errors="replace")

    def says(self, line, timeout_s=15.0):
        """Waits for a line on standard output."""
        limit = time.monotonic() + timeout_s
        while line not in self.out.splitlines():
            check(time.monotonic() < limit and self._process.poll() is None,
                  f"it does not say '{line}': {self.out!r} {self.err!r}")
            time.sleep(0.005)

    def value(self, word):
        """The numbers behind a word that it said: None if it did not."""
        found = re.search(rf"^{word} (.*)$", self.out, re.MULTILINE)
        return [int(number) for number in found[1].split()] if found else None

    def send(self, number):
        """A signal; when it was sent."""
        self._process.send_signal(number)
        return time.monotonic()

    def running(self):
        return self._process.poll() is None

    def end(self, timeout_s=10.0):
        """Waits for its end: its exit code, or the signal as a negative number."""
        try:
            code = self._process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            raise AssertionError(
                f"it has not ended after {timeout_s} s: {self.out!r} {self.err!r}") from None
        self.ended_at = time.monotonic()
        return code


def owner(create, interface, when, way, *more, environment=None, **options):
    """The program that owns a robot, by one of the interfaces (tests/lastword/owner.*)."""
    words = {
        "c": [Build.path("tests/lastword_owner_c")],
        "cpp": [Build.path("tests/lastword_owner_cpp")],
        "python": [sys.executable, str(SOURCE / "tests/lastword/owner.py")],
    }[interface]
    environment = {
        "PYTHONPATH": str(SOURCE / "hal/python"),
        "CARGOBAY_LIBRARY": Build.path("libcargobay.so.0"),
        **(environment or {}),
    }
    return Program(create, [*words, create.link, when, way, *more], environment, **options)


def command(create, *words, **options):
    """The command, on the robot's port."""
    name, *rest = words
    return Program(create, [Build.path("cargobay"), name, "--port", create.link, *rest], **options)


def driver(create, interface, environment=None):
    """A program that drives until the library says that it is over."""
    if interface == "command":
        program = command(create, "drive", "--duration", "60", environment=environment)
        check(create.drives(), f"it does not drive: {program.err}")
    else:
        way = "until_the_end"
        program = owner(create, interface, "driving", way, environment=environment)
        program.says("driving")
    return program


def check_stands(create, since, quiet=Sample.quiet, settings_too=True):
    """Told to stop in time, at rest, the port free and, unless told otherwise, as it was found."""
    took_s = create.settles(since, quiet)
    check(took_s is not None, f"the robot is {create.now()}")
    check(took_s <= STOP_S + ALLOWANCE_S, f"told to stop after {1e3 * took_s:.0f} ms only")
    troubles = create.wait_for_port(settings_too)
    check(not troubles, "; ".join(troubles))


def check_at_rest(create, since, settings_too=True):
    """The last word: all of that, and silent."""
    check_stands(create, since, settings_too=settings_too)
    check(not create.now().streaming, f"the robot is {create.now()}")


def watched(create, **plan):
    """The environment by which the calls on the port are seen, and fail as planned."""
    return {"LD_PRELOAD": Build.path("tests/libport_faults.so"), "FAULT_PORT": create.link,
            "FAULT_LOG": os.path.join(create.folder, "faults"),
            **{f"FAULT_{name.upper()}": str(value) for name, value in plan.items()}}


class Watched:
    """What the library that is preloaded has told (tests/faults/port_faults.cpp)."""

    def __init__(self, create):
        path = pathlib.Path(create.folder, "faults")
        lines = [line.split() for line in path.read_text().splitlines()] if path.exists() else []
        faults = [words for words in lines if words[2] == "fault"]
        self.fault_at = float(faults[0][0]) if faults else None  # CLOCK_MONOTONIC
        self.guard_stops = any(words[1:3] == ["guard", "stops"] for words in lines)
        # Zeros complete what may have been cut: the only bytes that are not a command.
        self.zeros = sum(int(words[5]) for words in lines if words[2] == "fills")
        self.counts = collections.Counter()  # by who or phase, and call
        for words in lines:
            if words[2] == "count":
                when = "guard" if words[1] == "guard" else words[3]
                self.counts[when, words[4]] += int(words[5])


def _run(name, function, arguments):
    begin = time.monotonic()
    verdict = "ok", ""
    try:
        with VirtualCreate(Build.path("cargobay")) as create:
            function(create, *arguments)
    except Skip as reason:
        verdict = "skip", f": {reason}"
    except Exception as failure:  # of any kind: the others go on
        kind = "" if isinstance(failure, AssertionError) else f"{type(failure).__name__}: "
        verdict = "FAIL", f": {kind}{failure}"
    print(f"{verdict[0]:4} {name} {time.monotonic() - begin:.1f} s{verdict[1]}", flush=True)
    return verdict[0]


def run():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", help="the build's folder")
    parser.add_argument("--only", default="", help="cases whose name this expression finds")
    parser.add_argument("--lanes", type=int, default=6, help="cases at a time")
    options = parser.parse_args()
    Build.folder = pathlib.Path(options.build).resolve()
    chosen = [each for each in _cases if re.search(options.only, each[0])]
    begin = time.monotonic()
    beside = [each for each in chosen if not hasattr(each[1], "alone")]
    with concurrent.futures.ThreadPoolExecutor(options.lanes) as lanes:
        verdicts = list(lanes.map(lambda each: _run(*each), beside))
    verdicts += [_run(*each) for each in chosen if each not in beside]
    failed, skipped = verdicts.count("FAIL"), verdicts.count("skip")
    print(f"{len(verdicts) - failed - skipped} passed, {failed} failed, {skipped} skipped "
          f"in {time.monotonic() - begin:.0f} s")
    if failed or not verdicts:
        sys.exit(1)
    if skipped == len(verdicts):
        sys.exit(77)


SIGNALS = {name: getattr(signal, f"SIG{name}") for name in ("KILL", "TERM", "INT", "HUP", "QUIT")}
