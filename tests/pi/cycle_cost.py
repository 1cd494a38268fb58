#!/usr/bin/env python3
"""What a whole cycle costs beside its parts, in instructions, those of the kernel included: on an
emulated ARM machine of one core whose clock goes by instructions.

usage: cycle_cost.py FOLDER
  FOLDER  for what is downloaded and built; kept for the next time
Prints the table, and fails where a cycle on a pseudo-terminal takes more than 1.15 times what a bare
echo there (poll, read, write), the decoder and the loop take by themselves.
Exit 77, and says why, where something that it needs is missing.
"""

import re
import subprocess
import sys
from pathlib import Path

import cross_build
from debian import Suite
from emulated_pi import lacks, make_initramfs, unpack_kernel

SUITE = "bookworm"
TOOLS = ["qemu-system-aarch64", "fdtput", "cpio", "readelf", *cross_build.TOOLS]
KINDS = ["carried", "lost"]
PARTS = ["pty_cycle", "pty_echo", "decode", "loop"]
FRAMES = 20_000
BOUND = 1.15
# Each instruction takes a nanosecond, and waiting takes none.
CLOCK = ["-icount", "shift=0,sleep=off"]

INIT = """#!/bin/busybox sh
/bin/busybox --install -s /bin
mount -t proc proc /proc
mount -t devtmpfs devtmpfs /dev
mkdir /dev/pts
mount -t devpts devpts /dev/pts
dmesg -n 1
for kind in {kinds}; do
  for part in {parts}; do
    echo "@@ $kind $part $(cycle_cost $kind $part {frames})"
  done
done
poweroff -f
"""


def run(kernel: Path, initramfs: Path) -> str:
    machine = subprocess.run(
        ["qemu-system-aarch64", "-M", "virt", "-cpu", "cortex-a53", "-smp", "1", "-m", "1G", *CLOCK,
         "-nic", "none", "-display", "none", "-no-reboot", "-serial", "stdio", "-kernel", kernel, "-initrd", initramfs,
         "-append", "console=ttyAMA0 rdinit=/init quiet"],
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace", timeout=1800,
    )  # fmt: skip
    return machine.stdout


def main() -> int:
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    if lacks(TOOLS):
        return 77
    folder = Path(sys.argv[1]).resolve()
    cache, here = folder / "packages", folder / SUITE
    here.mkdir(parents=True, exist_ok=True)
    suite = Suite(SUITE, cache)
    kernel, _ = unpack_kernel(suite, folder / "kernel")
    root, built = cross_build.cross_build(suite, SUITE, here, ["cycle_cost"], "-O3")
    init = INIT.format(kinds=" ".join(KINDS), parts=" ".join(PARTS), frames=FRAMES)
    initramfs = make_initramfs(here / "cycle_cost", root, [built / "tests/cycle_cost"], init)
    text = run(kernel, initramfs)
    found = re.findall(r"@@ (\w+) (\w+) ([\d.]+) ns", text)
    each = {(kind, part): float(count) for kind, part, count in found}
    if len(each) != len(KINDS) * len(PARTS):
        print(f"the emulated machine did not measure all of it; it said:\n{text}")
        return 1
    holds = True
    for kind in KINDS:
        cycle, *parts = (each[kind, part] for part in PARTS)
        ratio = cycle / sum(parts)
        holds = holds and ratio <= BOUND
        print(f"{kind:8} cycle {cycle:6.0f}  echo {parts[0]:6.0f}  decode {parts[1]:5.0f}"
              f"  loop {parts[2]:5.0f}  cycle / parts = {ratio:.3f}, bound {BOUND}")  # fmt: skip
    return 0 if holds else 1


if __name__ == "__main__":
    sys.exit(main())
