#!/usr/bin/env python3
"""Our packages on a whole PC in qemu: Debian with systemd, udev and PREEMPT_RT, an FTDI adapter that
comes and goes. What the virtual Create at the adapter saw of it is the witness.

usage: machine_test.py bookworm|trixie COMMAND FOLDER PACKAGES [--faults] [--times N] [STORY...]
  COMMAND   the cargobay of this machine, which serves the virtual Create
  FOLDER    for what is downloaded and built; kept for the next time
  PACKAGES  a folder with the packages, made by .ci/package.sh
  STORY     of tests/machine/stories; without one, all of them in their order, on one machine
  --faults  plants each fault of the stories, and fails if it is not found
  --times   tells each story so many times, what happens in it at random moments, and prints how
            long its steps took; 0-install always once, and first
Needs root, for debootstrap. Exit 77, and says why, where something that it needs is missing.
"""

import argparse
import contextlib
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.append(str(HERE.parent))

import story
from emulator.qemu import lacks
from emulator.virtual_create import VirtualCreate
from image import TOOLS, Disk, base, installed, overlay, pack
from machine import FIRST, SECOND, Machine

SHARE_BYTES = 64 << 20
INSTALL = "0-install"  # what a user does once


def share(folder: Path, packages: list[Path]) -> Path:
    """A disk with our packages and what the steps run."""
    content = folder / "share"
    shutil.rmtree(content, ignore_errors=True)
    shutil.copytree(HERE / "share", content)
    for package in packages:
        shutil.copy(package, content)
    disk = folder / "share.disk"
    pack(content, disk, SHARE_BYTES, folder / "share.log")
    return disk


def tell(
    names: list[str], made: Disk, folder: Path, packages: list[Path], command: Path, faults: bool,
    times: int,
) -> int:
    """How many of the steps failed, all on one machine."""
    failures = 0
    with contextlib.ExitStack() as ends:
        robots = {}
        for name in (FIRST, SECOND):
            (folder / name).mkdir(exist_ok=True)
            robots[name] = VirtualCreate(command, folder / name)
            ends.callback(robots[name].close)
        begin = time.monotonic()
        disk = overlay(made.disk, folder / "disk.qcow2")
        machine = Machine(made, disk, share(folder, packages), folder, robots)
        ends.callback(machine.close)
        machine.booted()
        print(f"booted in {time.monotonic() - begin:.1f} s", flush=True)
        for name in names:
            told = story.read(HERE / f"stories/{name}.toml")
            begin = time.monotonic()
            print(f"{name}: {told.title}", flush=True)
            if times > 1 and name != INSTALL:
                failed, found = story.tell_again(machine, told, times)
                failures += failed
                print(found.table(), flush=True)
            else:
                failures += sum(not story.tell(machine, step) for step in told.steps)
            if faults:
                failures += sum(not story.is_found(machine, told, fault) for fault in told.faults)
            print(f"  {time.monotonic() - begin:.0f} s", flush=True)
    return failures


def parse(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter,
                                     usage=argparse.SUPPRESS)  # fmt: skip
    parser.add_argument("suite", choices=["bookworm", "trixie"], help=argparse.SUPPRESS)
    for name in ("command", "folder", "packages"):
        parser.add_argument(name, type=lambda path: Path(path).resolve(), help=argparse.SUPPRESS)
    parser.add_argument("--faults", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--times", type=int, default=1, help=argparse.SUPPRESS)
    stories = sorted(path.stem for path in (HERE / "stories").glob("*.toml"))
    # None is one of the choices too.
    parser.add_argument("stories", nargs="*", choices=[*stories, []], help=argparse.SUPPRESS)
    given = parser.parse_intermixed_args(words)
    given.stories = given.stories or stories
    if given.times > 1 and INSTALL not in given.stories:
        given.stories.insert(0, INSTALL)
    return given


def main() -> int:
    given = parse(sys.argv[1:])
    if lacks(TOOLS, "machine"):
        return 77
    if os.geteuid() != 0:
        print("SKIPPED: needs root, for debootstrap")
        return 77
    architecture = subprocess.run(["dpkg", "--print-architecture"], capture_output=True, text=True,
                                  check=True).stdout.strip()  # fmt: skip
    packages = sorted(
        [*given.packages.glob(f"*_{architecture}.deb"), *given.packages.glob("*_all.deb")]
    )
    if len(packages) != 5:
        print(f"SKIPPED: {len(packages)} of five packages in {given.packages}; make them with .ci/package.sh")
        return 77
    begin = time.monotonic()
    made = installed(given.folder, base(given.folder, given.suite), packages)
    print(f"{given.suite}: {made.disk.parent.name}, {time.monotonic() - begin:.1f} s", flush=True)
    folder = given.folder / "run"
    folder.mkdir(exist_ok=True)
    failures = tell(
        given.stories, made, folder, packages, given.command, given.faults, given.times
    )
    print(f"{failures} failed" if failures else "all as it should be")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
