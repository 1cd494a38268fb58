"""What a test does and expects, as data: a TOML file with a list of steps, in their order.

A step `says` what holds after it, and has one of
  run = "SHELL LINE"  on the machine, as root; with `code`, the exit code (0 if left out), and what it
                      must print (`prints`) or must not (`lacks`), both as regular expressions
  robot = "drives", "stands" or "is passive": what the virtual Create outside knows of itself; with
                      `run` too, already while the line runs
  cable = "pull", "plug" or "plug elsewhere"
  tell = "LINE"       to the control socket of the virtual Create, as from its user's hand
                      each for the first robot, or `which` = "second"
  reset = true        the machine's button
  boots = true        waits for the next boot
`within_s`: it may take so long; a line is run again and again meanwhile. `stays_s`: the robot must do
so for as long. What a busy host keeps the machine and the virtual Create from running is not counted
(emulator/held_up.py).

A `fault` is planted to see it found: `run` before the story, `fails` is the step that must fail then,
`mend` afterwards.
"""

import random
import re
import time
import tomllib
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

from emulator.held_up import Allowance
from machine import FIRST, Machine, without_input

RUN_S = 900
AGAIN_S = 0.5
MOVES_MM_S = 20.0
MOMENTS_S = 2.0  # what happens at a random moment does within this


@dataclass
class Step:
    says: str
    run: str = ""
    code: int = 0
    prints: str = ""
    lacks: str = ""
    robot: str = ""
    cable: str = ""
    which: str = FIRST
    tell: str = ""
    reset: bool = False
    boots: bool = False
    within_s: float = 0.0
    stays_s: float = 0.0
    shows: bool = False  # what was seen, for figures


@dataclass
class Fault:
    says: str
    run: str
    fails: str
    mend: str


@dataclass
class Story:
    title: str
    steps: list[Step] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)


def read(path: Path) -> Story:
    story = tomllib.loads(path.read_text())
    steps = [Step(**step) for step in story["step"]]
    faults = [Fault(**fault) for fault in story.get("fault", [])]
    for fault in faults:
        if fault.fails not in (step.says for step in steps):
            raise ValueError(f"{path}: no step says: {fault.fails}")
    return Story(story["title"], steps, faults)


class Outcome:
    """Whether it held, and what was seen last."""

    def __init__(self, holds: bool, seen: str = ""):
        self.holds, self.seen = holds, seen


def ran(machine: Machine, step: Step) -> Outcome:
    code, text = machine.shell.run(without_input(step.run), RUN_S)
    holds = (
        code == step.code
        and (not step.prints or re.search(step.prints, text, re.MULTILINE) is not None)
        and (not step.lacks or re.search(step.lacks, text, re.MULTILINE) is None)
    )
    return Outcome(holds, f"{step.run}\nexit code {code}\n{text}")


def robot_does(machine: Machine, step: Step) -> Outcome:
    state = machine.robots[step.which].state()
    speeds = [*state["wheel_mm_s"].values()]
    holds = {
        "drives": all(abs(speed) > MOVES_MM_S for speed in speeds),
        "stands": not any([*speeds, *state["commanded_mm_s"].values()]),
        "is passive": state["mode"] == "passive" and not any(speeds),
    }[step.robot]
    return Outcome(holds, f"mode {state['mode']}, wheels {speeds} mm/s")


def acts(machine: Machine, step: Step) -> Outcome:
    if step.cable:
        machine.cable(step.cable, step.which)
    elif step.tell:
        machine.robots[step.which].tell(step.tell)
    elif step.reset:
        machine.reset()
    else:
        machine.booted()
    return Outcome(True)


def carry_out(machine: Machine, step: Step) -> tuple[Outcome, float]:
    """And how long it took, in s."""
    look = robot_does if step.robot else ran if step.run else acts
    if step.robot and step.run:
        machine.shell.start(without_input(step.run))
    begin = time.monotonic()
    allowance = Allowance(machine.processes(), begin)
    waited = held = 0.0
    while True:
        outcome = look(machine, step)
        spent = allowance.passed(time.monotonic())
        waited += spent
        held = held + spent if outcome.holds and held else (1e-9 if outcome.holds else 0.0)
        if outcome.holds and held >= step.stays_s:
            break
        if waited > step.within_s + step.stays_s:
            outcome.holds = False
            break
        time.sleep(0.02 if step.robot else AGAIN_S)
    seconds = time.monotonic() - begin
    if step.robot and step.run:
        code, text = machine.shell.end(RUN_S)
        if code != step.code:
            outcome = Outcome(False, f"{step.run}\nexit code {code}\n{text}")
    return outcome, seconds


class Times:
    """How often each step of a story held that may take a while, and how long it took."""

    def __init__(self):
        self.steps: dict[tuple[int, str], list[float]] = {}
        self.failed: Counter[tuple[int, str]] = Counter()

    def note(self, number: int, says: str, holds: bool, seconds: float) -> None:
        self.steps.setdefault((number, says), []).append(seconds)
        self.failed[number, says] += not holds

    def table(self) -> str:
        lines = ["| step | times | failed | p50, s | longest, s |", "|---|---|---|---|---|"]
        for (number, says), seconds in sorted(self.steps.items()):
            middle = sorted(seconds)[len(seconds) // 2]
            failed = self.failed[number, says]
            lines.append(f"| {says} | {len(seconds)} | {failed} | {middle:.1f} | {max(seconds):.1f} |")
        return "\n".join(lines)


def tell_again(machine: Machine, story: Story, times: int) -> tuple[int, Times]:
    """The story so many times, what happens in it at random moments. How many of the steps failed."""
    failures, found = 0, Times()
    for time_of in range(times):
        print(f"  {time_of + 1} of {times}", flush=True)
        for number, step in enumerate(story.steps):
            if step.cable or (step.robot and step.run):
                time.sleep(random.uniform(0.0, MOMENTS_S))
            outcome, seconds = carry_out(machine, step)
            if step.within_s or step.boots:
                found.note(number, step.says, outcome.holds, seconds)
            if not outcome.holds:
                failures += 1
                print(f"  FAILED {step.says} ({seconds:.1f} s)\n{outcome.seen}", flush=True)
    return failures, found


def tell(machine: Machine, step: Step) -> bool:
    """Does the step, and prints one line, and what was seen if it does not hold."""
    outcome, seconds = carry_out(machine, step)
    took = f" ({seconds:.1f} s)" if step.within_s or step.boots else ""
    print(f"  {'ok    ' if outcome.holds else 'FAILED'} {step.says}{took}", flush=True)
    if not outcome.holds or step.shows:
        print(outcome.seen, flush=True)
    return outcome.holds


def is_found(machine: Machine, story: Story, fault: Fault) -> bool:
    """Plants the fault, and looks for the first step that fails."""
    planted, text = machine.shell.run(without_input(fault.run), RUN_S)
    failed = next((step for step in story.steps if not carry_out(machine, step)[0].holds), None)
    machine.mend_cables()
    mended, more = machine.shell.run(without_input(fault.mend), RUN_S)
    holds = planted == mended == 0 and failed is not None and failed.says == fault.fails
    found = f"fails: {failed.says}" if failed else "nothing fails"
    print(f"  {'ok    ' if holds else 'FAILED'} {fault.says}; {found}", flush=True)
    if not holds:
        print(f"planted: {planted}\n{text}\nmended: {mended}\n{more}", flush=True)
    return holds
