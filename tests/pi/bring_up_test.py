#!/usr/bin/env python3
"""The 19200-baud bring-up and the closed loop on an emulated Raspberry Pi; what the virtual Create
outside saw of it is the witness.

usage: bring_up_test.py bookworm|trixie COMMAND FOLDER [--built BUILT] [--build]
  COMMAND  the native cargobay, which serves the virtual Create
  FOLDER   for what is downloaded and built; kept for the next time
  BUILT    where the programs for that Debian have been built; without it they are built here
  --build  downloads and builds it, and ends
Exit 77, and says why, where something that it needs is missing.
"""

import argparse
import fcntl
import json
import re
import sys
import time
from pathlib import Path

import cross_build
from debian import Suite
from emulated_pi import EmulatedPi, VirtualCreate, lacks, make_initramfs, unpack_kernel
from usb_cable import DTR, RTS, UsbCable, modules

KERNEL_SUITE = "bookworm"
# Those of the project's tests that touch the kernel and the libraries of the Pi.
TESTS = ["test_gpio", "test_serial"]
# What they need on a Debian whose programs have been built elsewhere: the names of the libraries'
# packages change, those of the packages that need them do not.
RUN_TIME = [
    "busybox-static", "libserialport-dev", "libgpiod-dev", "libfmt-dev", "libncurses-dev",
    "libstdc++6",
]  # fmt: skip
TOOLS = ["qemu-system-aarch64", "fdtput", "cpio", "readelf", *cross_build.TOOLS]

CHIP = "pinctrl-bcm2835"
BRC, POWER = 17, 27
PINS = {BRC: ("brc", True), POWER: ("power-toggle", False)}
OPTIONS = (
    f"--port /dev/ttyAMA0 --baud 19200 --brc-chip {CHIP} --brc-line {BRC}"
    f" --power-chip {CHIP} --power-line {POWER}"
)
SPEED_MM_S = 200
# Twice the bound of the deterministic test for a robot that carries the remainder.
STEADY_ERROR_MM_S = 2 * 1.5
# If the rest of a frame is this late, the frame is given up and counted as bad: three ticks without
# one are not the fault of line or program, but of the machine that emulates both.
DISTURBED_MS = 45
MOST_DRIVES = 5

failures = 0


def check(holds: bool, what: str, else_tell: str = "") -> None:
    global failures
    print(f"  {'ok    ' if holds else 'FAILED'} {what}", flush=True)
    if not holds and else_tell:
        print(else_tell, flush=True)
    failures += not holds


def lows(pi: EmulatedPi, since: float) -> list[float]:
    """The widths in ms of the low pulses of the BRC pin."""
    edges = [(at, level) for at, pin, level in pi.edges if pin == BRC and at >= since]
    return [
        1000 * (after - at) for (at, level), (after, _) in zip(edges, edges[1:]) if not level
    ]


def passes_its_tests(pi: EmulatedPi, _robot: VirtualCreate) -> None:
    print("the tests of lines and ports, on the Pi")
    for test in TESTS:
        code, text = pi.run(f"{test} --gtest_color=no < /dev/null", 120)
        summary = re.search(r"\[  PASSED  \] \d+ tests", text)
        check(code == 0 and summary is not None, f"{test}: {summary[0] if summary else code}", text)


def brings_up_at_19200(pi: EmulatedPi, robot: VirtualCreate) -> None:
    print("bring-up at 19200 baud by BRC, from Off, powered on by its toggle")
    robot.tell("power")  # off
    begin = time.monotonic()
    code, text = pi.run(f"cargobay bringup {OPTIONS}", 90)
    check(code == 0, "cargobay bringup succeeds", text)
    widths = lows(pi, begin)
    check(len(widths) == 3, f"three low pulses: {len(widths)}")
    check(all(50 <= width <= 500 for width in widths), f"of 50 to 500 ms: {widths}")
    on = [at for at, pin, level in pi.edges if pin == POWER and level and at >= begin]
    first = [at for at, pin, level in pi.edges if pin == BRC and not level and at >= begin]
    waited = first[0] - on[-1] if on and first else 0.0
    check(waited >= 2.0, f"2 s after power-on: {waited:.3f} s")
    state = robot.state()
    check(state["baud"] == 19200, f"the robot is at {state['baud']} baud")
    check(state["mode"] == "passive", f"and in mode {state['mode']}")


def drives_at_19200(pi: EmulatedPi, robot: VirtualCreate) -> None:
    print("closed loop at 19200 baud for 10 s")
    for drives in range(1, MOST_DRIVES + 1):
        last = drives == MOST_DRIVES
        result, text = drive_at_19200(pi, robot)
        held_up_ms = result["period_ns"]["max"] / 1e6 if result else 0.0
        stopped = result and any(event["what"] == "silence_began" for event in result["events"])
        if result and not result["succeeded"] and stopped and held_up_ms >= DISTURBED_MS and not last:
            print(f"  it ended; the machine held the Pi up for {held_up_ms:.0f} ms: once more")
            check_stopped(robot)
            continue
        check(result is not None and result["succeeded"], "cargobay drive succeeds", text)
        if not result or not result["succeeded"]:
            return
        check_end(robot, result)
        bad = result["frames_bad"]
        disturbed = stopped or (bad > 0 and held_up_ms >= DISTURBED_MS)
        # Also for a drive that is not the last, unless the loop stopped the wheels in it, as it
        # must.
        if not stopped or last:
            for name, error in zip(("left", "right"), result["true_error_mm_s"]):
                check(error <= STEADY_ERROR_MM_S, f"steady error, {name}: {error:.2f} mm/s (true - set)",
                      f"remainder {result['remainder']}, events {result['events']}")  # fmt: skip
        if not disturbed or last:
            break
        print(f"  {bad} frames bad; the machine held the Pi up for {held_up_ms:.0f} ms: once more")
    check(bad == 0, f"frames bad: {bad}; the longest wait for a frame {held_up_ms:.0f} ms")


def check_end(robot: VirtualCreate, result: dict) -> None:
    check(result["frames_good"] > 300, f"frames good: {result['frames_good']}")
    check(robot.state()["mode"] == "passive", f"left in mode {robot.state()['mode']}")
    check_stopped(robot)
    lost = result["bytes_lost"]
    check(lost == 0, f"bytes the robot could not read: {lost}")


def check_stopped(robot: VirtualCreate) -> None:
    speeds = robot.state()["commanded_mm_s"].values()
    check(all(speed == 0 for speed in speeds), "with the wheels stopped")


def drive_at_19200(pi: EmulatedPi, robot: VirtualCreate) -> tuple[dict | None, str]:
    """What the command measured, and how far the wheels' true speed was off; and all that it said."""
    robot.tell("place 0 0 0")
    before = robot.state()["counters"]
    pi.start(
        f"cargobay drive {OPTIONS} --speed {SPEED_MM_S} --duration 10 --json /tmp/drive.json < /dev/null"
        " > /tmp/drive.txt 2>&1"
    )
    speeds = []
    deadline = time.monotonic() + 60
    while robot.state()["commanded_mm_s"]["left"] == 0 and time.monotonic() < deadline:
        time.sleep(0.05)
    begin = time.monotonic()
    while time.monotonic() < begin + 9:
        state = robot.state()
        if time.monotonic() > begin + 2 and state["commanded_mm_s"]["left"] != 0:
            speeds.append((state["wheel_mm_s"]["left"], state["wheel_mm_s"]["right"]))
        time.sleep(0.02)
    code, _ = pi.end(60)
    _, text = pi.run("cat /tmp/drive.txt /tmp/drive.json")
    if "\n{" not in text:
        return None, text
    result = json.loads(text[text.index("\n{") :])
    result["succeeded"] = code == 0
    result["true_error_mm_s"] = [
        abs(sum(speed[side] for speed in speeds) / max(1, len(speeds)) - SPEED_MM_S)
        for side in (0, 1)
    ]
    counters = robot.state()["counters"]
    result["bytes_lost"] = sum(
        counters[name] - before[name] for name in ("robot_framing_errors", "bytes_overrun")
    )
    return result, text


def recovers_from_a_kill(pi: EmulatedPi, robot: VirtualCreate) -> None:
    print("SIGKILL in the middle of the pulse train, then a second bring-up")
    robot.tell("power")  # off
    begin = time.monotonic()
    pi.start(f"cargobay bringup {OPTIONS} > /tmp/killed.txt 2>&1 & echo")
    pi.end(10)
    while len(lows(pi, begin)) < 1 and time.monotonic() < begin + 30:
        time.sleep(0.01)
    pi.run("killall -KILL cargobay; sleep 1")
    widths = lows(pi, begin)
    check(1 <= len(widths) < 3, f"it was killed behind pulse {len(widths)}")
    check(pi.levels[BRC], "the kernel released the pin")
    code, text = pi.run(f"cargobay bringup {OPTIONS}", 90)
    check(code == 0, "the second succeeds without a human", text)
    state = robot.state()
    check(state["baud"] == 19200, f"the robot is at {state['baud']} baud")
    check(pi.levels[BRC], "the pin is released")


def is_stopped_by_its_guard(pi: EmulatedPi, robot: VirtualCreate) -> None:
    print("SIGKILL in the middle of a drive")
    pi.start(f"cargobay drive {OPTIONS} --duration 60 > /tmp/killed.txt 2>&1 & echo")
    pi.end(10)
    deadline = time.monotonic() + 60
    while robot.state()["commanded_mm_s"]["left"] == 0 and time.monotonic() < deadline:
        time.sleep(0.05)
    check(robot.state()["commanded_mm_s"]["left"] != 0, "it drives")
    pi.run("killall -KILL cargobay; sleep 1")
    state = robot.state()
    check(all(speed == 0 for speed in state["commanded_mm_s"].values()), "the wheels are stopped")
    check(state["mode"] == "passive", f"the robot is in mode {state['mode']}")
    code, text = pi.run(f"cargobay bringup {OPTIONS}", 90)
    check(code == 0, "the port is free for the next", text)


def says_what_is_wrong(pi: EmulatedPi, _robot: VirtualCreate) -> None:
    print("lines that are not available")
    command = "cargobay bringup --port /dev/ttyAMA0 --baud 19200"
    line = f"--brc-chip {CHIP} --brc-line"
    base = f"$(($(grep -l {CHIP} /sys/class/gpio/*/label | tr -dc 0-9) + {BRC + 1}))"
    wrong = [
        ("no such chip", f"{command} --brc-chip nosuch --brc-line 17", CHIP),
        ("no such line", f"{command} {line} 99", "99"),
        ("busy", f"echo {base} > /sys/class/gpio/export; {command} {line} {BRC + 1}", "sysfs"),
        ("no permission", f"su -s /bin/sh nobody -c '{command} {line} {BRC}'", "permission"),
    ]
    for name, text, says in wrong:
        code, printed = pi.run(text + " 2>&1", 30)
        complaint = printed.strip()
        single = complaint.startswith("cargobay: error: ") and "\n" not in complaint
        check(code == 1 and single and says in complaint, f"{name}: {complaint}", f"exit code {code}")


def watches_a_pin_into_head(pi: EmulatedPi, _robot: VirtualCreate) -> None:
    print("cargobay pins --watch | head -1")
    line = f"{{ cargobay pins --chip {CHIP} --watch {BRC + 2}; echo $? > /tmp/code; }} 2> /tmp/says | head -1"
    _, printed = pi.run(line, 20)
    code = pi.run("cat /tmp/code")[1].strip()
    check(printed.strip() in ("high", "low"), f"it prints the level: {printed.strip()}")
    check(code == "1", f"and ends when head has ended: {code}", pi.run("cat /tmp/says")[1])
    _, listed = pi.run("cargobay pins --json", 20)
    (chip,) = [one for one in json.loads(listed) if one.get("label") == CHIP]
    check(not chip["lines"][BRC + 2]["used"], "and the line is free")


def brings_up_by_a_usb_cable(pi: EmulatedPi, cable: UsbCable) -> None:
    print("bring-up at 19200 baud, power toggle and BRC on DTR and RTS of an FTDI cable")
    pi.run("for i in 1 2 3 4 5 6 7 8 9 10; do [ -e /dev/ttyUSB0 ] || sleep 1; done", 20)
    cable.robot.tell("power")  # off
    begin = time.monotonic()
    command = "cargobay bringup --port /dev/ttyUSB0 --baud 19200 --brc-line rts --power-line dtr"
    code, text = pi.run(command, 90)
    check(code == 0, "cargobay bringup succeeds", text)
    widths = cable.lows(RTS, begin)[-3:]
    check(len(widths) == 3 and all(50 <= width <= 500 for width in widths),
          f"RTS is low three times, for 50 to 500 ms: {widths}")  # fmt: skip
    toggles = [at for at, line, level in cable.edges if line == DTR and level and at >= begin]
    check(len(toggles) == 1, f"DTR is released once: {len(toggles)}")
    state = cable.robot.state()
    check(state["baud"] == 19200, f"the robot is at {state['baud']} baud")
    check(state["mode"] == "passive", f"and in mode {state['mode']}: closing the port released nothing")
    # The lines are the configuration's: another command must not switch the robot off.
    config = r'port = "/dev/ttyUSB0"\nbaud = 19200\n[pins.brc]\nline = "rts"\n[pins.power]\nline = "dtr"\n'
    pi.run(f"printf '{config}' > /tmp/usb.toml")
    code, text = pi.run("cargobay sensors --config /tmp/usb.toml --once --packets oi_mode", 30)
    check(code == 0 and "passive" in text, "sensors reads it over the cable", text)
    check(cable.robot.state()["mode"] == "passive", "and leaves it on")


def prepare(name: str, folder: Path, built: Path | None) -> tuple[Path, Path, Path, Path]:
    """Downloads and builds what is not there yet, one process at a time: kernel, device tree, the
    user space of that Debian, and the folder with what was built for it."""
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        cache, here = folder / "packages", folder / name
        here.mkdir(exist_ok=True)
        kernel, tree = unpack_kernel(Suite(KERNEL_SUITE, cache), folder / "kernel")
        suite = Suite(name, cache)
        if built:
            return kernel, tree, cross_build.user_space(suite, RUN_TIME, here / "runtime"), built
        targets = ["cargobay", "cargobay_guard", *TESTS]
        return kernel, tree, *cross_build.cross_build(suite, name, here, targets)


def main() -> int:
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1])
    parser.add_argument("suite", choices=cross_build.COMPILER_PACKAGES)
    parser.add_argument("command", type=lambda path: Path(path).resolve())
    parser.add_argument("folder", type=lambda path: Path(path).resolve())
    parser.add_argument("--built", type=lambda path: Path(path).resolve())
    parser.add_argument("--build", action="store_true")
    given = parser.parse_args()
    if lacks(TOOLS):
        return 77
    name, command, here = given.suite, given.command, given.folder / given.suite
    kernel, tree, root, built = prepare(name, given.folder, given.built)
    if given.build:
        return 0
    programs = [built / "cargobay", built / "cargobay-guard", *(built / "tests" / test for test in TESTS)]
    initramfs = make_initramfs(
        here / "initramfs", root, programs, modules=modules(given.folder / "kernel")
    )
    robot = VirtualCreate(command, here)
    cable = UsbCable(command, here / "usb")
    try:
        pi = EmulatedPi(kernel, tree, initramfs, here, robot, PINS, cable.arguments)
        cable.start()
        try:
            begin = time.monotonic()
            pi.booted()
            print(f"booted {kernel.name} with the user space of {name} in {time.monotonic() - begin:.1f} s")
            for scenario in (passes_its_tests, brings_up_at_19200, drives_at_19200, recovers_from_a_kill,
                             is_stopped_by_its_guard, says_what_is_wrong, watches_a_pin_into_head):
                scenario(pi, robot)
            brings_up_by_a_usb_cable(pi, cable)
            print(f"rates of the PL011: {pi.rates}")
        finally:
            pi.close()
    finally:
        cable.close()
        robot.close()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
