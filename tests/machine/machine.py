"""A PC in qemu: Debian with systemd and PREEMPT_RT, and an FTDI adapter at its USB whose other end is a
virtual Create outside.
"""

import os
import resource
import subprocess
import time
from pathlib import Path

from emulator.qemu import Monitor, Shell
from emulator.virtual_create import VirtualCreate

from image import Disk

BOOT_S = 900
# KVM's clock and interrupts are those of a real PC; without it qemu takes ten times as long.
ACCELERATORS = {True: ["-accel", "kvm", "-cpu", "host"], False: ["-accel", "tcg,thread=multi", "-cpu", "max"]}
# Work, to see how slow the machine is.
WORK = "i=0; while [ $i -lt 100000 ]; do i=$((i+1)); done"
PORTS = {"": 1, " elsewhere": 2}  # of the USB controller


class Machine:
    """Boots. `share` is a disk that the machine finds at /share."""

    def __init__(self, made: Disk, disk: Path, share: Path, folder: Path, robot: VirtualCreate):
        self.robot = robot
        sockets = {name: folder / name for name in ("shell", "monitor")}
        for path in sockets.values():
            path.unlink(missing_ok=True)
        self.log = folder / "console.log"
        accelerator = ACCELERATORS[bool(os.environ.get("CARGOBAY_KVM"))]
        self.process = subprocess.Popen(
            ["qemu-system-x86_64", "-M", "q35", *accelerator, "-smp", "2", "-m", "1024", "-nic", "none",
             "-display", "none", "-vga", "none", "-kernel", made.kernel, "-initrd", made.initrd,
             "-append", "root=/dev/vda rw console=ttyS0 quiet",
             "-drive", f"file={disk},if=virtio,cache=unsafe",
             "-drive", f"file={share},if=virtio,format=raw,read-only=on",
             "-serial", f"file:{self.log}",
             "-serial", f"unix:{sockets['shell']},server=on,wait=off",
             "-qmp", f"unix:{sockets['monitor']},server=on,wait=off",
             "-device", "qemu-xhci,id=usb", "-chardev", f"serial,id=robot,path={robot.port}"],
            stdin=subprocess.DEVNULL,
        )  # fmt: skip
        self.monitor = Monitor(sockets["monitor"])
        self.shell = Shell(sockets["shell"], self.look)
        self.plugged = False
        self.cable("plug")

    def look(self) -> None:
        if self.process.poll() is not None:
            raise RuntimeError(f"qemu has ended: {self.process.returncode}")

    def slowness(self) -> float:
        """How many times longer the machine takes now than a processor of this host by itself."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        subprocess.run(["sh", "-c", WORK], check=True)
        alone = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        begin = time.monotonic()
        self.shell.run(WORK, BOOT_S)
        return (time.monotonic() - begin) / alone

    def booted(self) -> None:
        self.shell.wait_for(r"@@booted\n", BOOT_S)

    def cable(self, what: str) -> None:
        """plug, plug elsewhere: into another USB port; pull."""
        self.plugged = what != "pull"
        if not self.plugged:
            self.monitor.execute("device_del", id="adapter")
            return
        self.monitor.execute(
            "device_add", driver="usb-serial", id="adapter", bus="usb.0", chardev="robot",
            port=str(PORTS[what.removeprefix("plug")]), **{"always-plugged": True},
        )  # fmt: skip

    def mend_cable(self) -> None:
        if not self.plugged:
            self.cable("plug")

    def reset(self) -> None:
        """As by its button: nothing in it can do anything about it."""
        self.monitor.execute("system_reset")

    def close(self) -> None:
        if self.process.poll() is None:
            self.monitor.execute("quit")
        self.process.wait()
        self.monitor.close()
        self.shell.close()
