"""A PC in qemu: Debian with systemd and PREEMPT_RT, and an FTDI adapter at its USB whose other end is a
virtual Create outside.
"""

import contextlib
import os
import subprocess
import time
from pathlib import Path

from emulator.qemu import Monitor, Shell
from emulator.virtual_create import VirtualCreate

from image import Disk

BOOT_S = 900
# KVM's clock and interrupts are those of a real PC; without it qemu takes ten times as long.
ACCELERATORS = {True: ["-accel", "kvm", "-cpu", "host"], False: ["-accel", "tcg,thread=multi", "-cpu", "max"]}
NICE = -10
RELEASED_S = 30  # by qemu: what was pulled out lets go of its line when the last reader of it has ended
FIRST, SECOND = "first", "second"  # robots
PORTS = {FIRST: 1, f"{FIRST} elsewhere": 2, SECOND: 3}  # of the USB controller


def without_input(line: str) -> str:
    """A line whose programs do not read the lines that follow it."""
    return f"{{ {line}\n}} < /dev/null"


def goes_first(process: int) -> None:
    """It emulates in real time, so it goes before what else is computed here. Where the scheduler groups
    by session (sched(7), autogroup), a process's own nice value does not count outside. Without the right
    to it the machine is slower."""
    with contextlib.suppress(OSError):
        Path(f"/proc/{process}/autogroup").write_text(str(NICE))


class Machine:
    """Boots. `share` is a disk that the machine finds at /share. `robots` are outside, by their names, each
    at an adapter of its own; that of FIRST is plugged in."""

    def __init__(self, made: Disk, disk: Path, share: Path, folder: Path, robots: dict[str, VirtualCreate]):
        self.robots = robots
        sockets = {name: folder / name for name in ("shell", "monitor")}
        for path in sockets.values():
            path.unlink(missing_ok=True)
        self.log = folder / "console.log"
        accelerator = ACCELERATORS[bool(os.environ.get("CARGOBAY_KVM"))]
        self.process = subprocess.Popen(
            ["nice", "-n", str(NICE), "qemu-system-x86_64", "-M", "q35", *accelerator, "-smp", "2", "-m", "1024", "-nic", "none",
             "-display", "none", "-vga", "none", "-kernel", made.kernel, "-initrd", made.initrd,
             "-append", "root=/dev/vda rw console=ttyS0 quiet",
             "-drive", f"file={disk},if=virtio,cache=unsafe",
             "-drive", f"file={share},if=virtio,format=raw,read-only=on",
             "-serial", f"file:{self.log}",
             "-serial", f"unix:{sockets['shell']},server=on,wait=off",
             "-qmp", f"unix:{sockets['monitor']},server=on,wait=off",
             "-device", "qemu-xhci,id=usb",
             *(word for name, robot in robots.items()
               for word in ("-chardev", f"serial,id={name},path={robot.port}"))],
            stdin=subprocess.DEVNULL, start_new_session=True,
        )  # fmt: skip
        goes_first(self.process.pid)
        self.monitor = Monitor(sockets["monitor"])
        self.shell = Shell(sockets["shell"], self.look)
        self.plugged = set()
        self.cable("plug", FIRST)

    def look(self) -> None:
        if self.process.poll() is not None:
            raise RuntimeError(f"qemu has ended: {self.process.returncode}")

    def booted(self) -> None:
        self.shell.wait_for(r"@@booted\n", BOOT_S)

    def processes(self) -> list[int]:
        """That have to run for the machine to get on."""
        return [self.process.pid, *(robot.process.pid for robot in self.robots.values())]

    def cable(self, what: str, name: str) -> None:
        """plug, plug elsewhere: into another USB port; pull."""
        if what == "pull":
            self.plugged.discard(name)
            self.monitor.execute("device_del", id=f"adapter-{name}")
            return
        self.plugged.add(name)
        deadline = time.monotonic() + RELEASED_S
        while True:
            try:
                self.monitor.execute(
                    "device_add", driver="usb-serial", id=f"adapter-{name}", bus="usb.0", chardev=name,
                    port=str(PORTS[name + what.removeprefix("plug")]), **{"always-plugged": True},
                )  # fmt: skip
                return
            except RuntimeError:
                if time.monotonic() > deadline:
                    raise
                time.sleep(0.1)

    def mend_cables(self) -> None:
        """As they were at first."""
        for name in self.robots:
            if (name == FIRST) != (name in self.plugged):
                self.cable("plug" if name == FIRST else "pull", name)

    def reset(self) -> None:
        """As by its button: nothing in it can do anything about it."""
        self.monitor.execute("system_reset")

    def close(self) -> None:
        if self.process.poll() is None:
            self.monitor.execute("quit")
        self.process.wait()
        self.monitor.close()
        self.shell.close()
