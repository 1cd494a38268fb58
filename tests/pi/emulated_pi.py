"""A Raspberry Pi 3 in qemu, running Debian's own kernel: its PL011 is wired to a virtual Create outside,
its GPIO pins to that robot's pins.
"""

import gzip
import os
import re
import select
import shutil
import subprocess
import sys
import termios
import threading
import time
import tty
from pathlib import Path

from debian import Suite

sys.path.append(str(Path(__file__).resolve().parents[1]))
from emulator.qemu import Monitor, Shell, connect, lacks  # noqa: F401: lacks is for the tests
from emulator.virtual_create import VirtualCreate

DEVICE_TREE = "bcm2837-rpi-3-b.dtb"
UART_CLOCK_HZ = 48_000_000
UART_DIVISORS = 0x3F201024  # IBRD, FBRD (PrimeCell UART manual, 3.3.5 and 3.3.6)
GPIO_FUNCTIONS = 0x3F200000  # GPFSEL0, ten pins a word (BCM2835 ARM peripherals, 6.1)
GPIO_LEVELS = 0x3F200034  # GPLEV0
POLL_S = 0.003
# The rates a client can set on a pseudo-terminal.
RATES = {
    int(name[1:]): getattr(termios, name) for name in dir(termios) if re.fullmatch(r"B[1-9]\d+", name)
}

INIT = """#!/bin/busybox sh
/bin/busybox --install -s /bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs devtmpfs /dev
mkdir /dev/pts
mount -t devpts devpts /dev/pts
exec < /dev/ttyS1 > /dev/ttyS1 2>&1
stty -echo -onlcr
dmesg -n 1
for module in /modules/*; do if [ -e $module ]; then insmod $module; fi; done
echo; echo '@@booted'
# Beside the tests' programs. The packages have theirs where they install it.
if [ -x /bin/cargobay-guard ]; then export CARGOBAY_GUARD=/bin/cargobay-guard; fi
exec env PS1= PS2= setsid -c sh
"""


def libraries(programs: list[Path], root: Path) -> list[Path]:
    """The shared libraries that the programs need, and those these need."""
    wanted, found = list(programs), {}
    while wanted:
        dynamic = subprocess.run(
            ["readelf", "-d", wanted.pop()], capture_output=True, text=True, check=True
        ).stdout
        for name in re.findall(r"NEEDED.*\[(.*)\]", dynamic):
            if name in found or name.startswith("ld-linux"):
                continue
            folders = [root / part for part in ("lib/aarch64-linux-gnu", "usr/lib/aarch64-linux-gnu")]
            path = next((folder / name for folder in folders if (folder / name).exists()), None)
            if path is None:
                raise FileNotFoundError(f"{name} is in none of the packages of {root}")
            found[name] = path
            wanted.append(path)
    return list(found.values())


def unpack_kernel(suite: Suite, folder: Path) -> tuple[Path, Path]:
    """The kernel and the device tree of a Pi 3 whose PL011 is free."""
    image = suite.packages["linux-image-arm64"]["Depends"].split()[0]
    if not (folder / "boot").exists():
        suite.unpack([image], folder)
    kernel = next((folder / "boot").glob("vmlinuz-*"))
    source = next((folder / "usr/lib").glob(f"linux-image-*/broadcom/{DEVICE_TREE}"))
    tree = folder / DEVICE_TREE
    shutil.copyfile(source, tree)
    # Otherwise the port belongs to the Bluetooth driver; this is what `dtoverlay=disable-bt` does.
    subprocess.run(["fdtput", "-r", tree, "/soc/serial@7e201000/bluetooth"], check=True)
    return kernel, tree


def make_initramfs(
    folder: Path, root: Path, programs: list[Path], init: str = INIT, modules: list[Path] = ()
) -> Path:
    """The user space of `root`, as small as it can be, with the programs in it, and the kernel's
    modules, which INIT loads in this order."""
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("bin", "lib/aarch64-linux-gnu", "proc", "sys", "dev", "tmp", "etc"):
        (folder / name).mkdir(parents=True)
    busybox = next(path for path in (root / "bin/busybox", root / "usr/bin/busybox") if path.exists())
    for program in (busybox, *programs):
        shutil.copy(program, folder / "bin")
    shutil.copy(root / "lib/ld-linux-aarch64.so.1", folder / "lib")
    for library in libraries(programs, root):
        shutil.copy(library, folder / "lib/aarch64-linux-gnu")
    (folder / "modules").mkdir()
    for number, module in enumerate(modules):
        shutil.copy(module, folder / f"modules/{number:02}-{module.name}")
    (folder / "etc/passwd").write_text("root:x:0:0::/:/bin/sh\nnobody:x:65534:65534::/:/bin/sh\n")
    (folder / "etc/group").write_text("root:x:0:\nnogroup:x:65534:\n")
    (folder / "init").write_text(init)
    (folder / "init").chmod(0o755)
    names = subprocess.run(["find", ".", "-print0"], cwd=folder, capture_output=True, check=True).stdout
    archive = subprocess.run(
        ["cpio", "--quiet", "-0", "-o", "-H", "newc", "-R", "0:0"],
        cwd=folder, input=names, capture_output=True, check=True,
    ).stdout  # fmt: skip
    target = folder.with_suffix(".cpio.gz")
    target.write_bytes(gzip.compress(archive, compresslevel=1))
    return target


class EmulatedPi:
    """Boots; wires the PL011 to the robot's port and each pin of `pins` (GPIO number to the robot's
    word for it, and its level while nobody drives it) to the robot's. `more`: for qemu.
    """

    def __init__(
        self, kernel, tree, initramfs, folder: Path, robot: VirtualCreate, pins: dict,
        more: list[str] = (),
    ):  # fmt: skip
        self.robot, self.pins = robot, pins
        self.levels: dict[int, bool] = {}
        self.edges: list[tuple[float, int, bool]] = []  # time in s, pin, level
        self.rates: list[int] = []  # in the order they were set
        sockets = {name: folder / name for name in ("uart", "console", "monitor")}
        for path in sockets.values():
            path.unlink(missing_ok=True)
        self.process = subprocess.Popen(
            ["qemu-system-aarch64", "-M", "raspi3b", "-display", "none", "-no-reboot",
             "-kernel", kernel, "-dtb", tree, "-initrd", initramfs,
             "-append", "console=ttyS1,115200 rdinit=/init quiet",
             "-serial", f"unix:{sockets['uart']},server=on,wait=off",
             "-serial", f"unix:{sockets['console']},server=on,wait=off",
             "-qmp", f"unix:{sockets['monitor']},server=on,wait=off", *more],
            stdin=subprocess.DEVNULL,
        )  # fmt: skip
        self.monitor = Monitor(sockets["monitor"])
        self.uart = connect(sockets["uart"])
        self.failure: Exception | None = None
        self.shell = Shell(sockets["console"], self.check)
        self.start, self.end, self.run = self.shell.start, self.shell.end, self.shell.run
        self.port = os.open(robot.port, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.port)
        self.sent, sending = os.pipe()  # what the Pi sends
        self.pump = threading.Thread(target=self.run_pump, args=(sending,))
        self.pump.start()
        self.stopping = False
        self.wires = threading.Thread(target=self.run_wires)
        self.wires.start()

    # The wires.

    def run_pump(self, sending: int) -> None:
        """qemu writes byte by byte, and stands still, its monitor too, after some 270 that nobody
        took: they are taken while the wires wait for the monitor."""
        while taken := self.uart.recv(4096):
            os.write(sending, taken)
        os.close(sending)

    def run_wires(self) -> None:
        try:
            next_look = 0.0
            while not self.stopping:
                patience = max(0.0, next_look - time.monotonic())
                ready, _, _ = select.select([self.sent, self.port], [], [], patience)
                # What the Pi sends went out at its present rate, not at that of the last look.
                if self.sent in ready or time.monotonic() >= next_look:
                    self.look()
                    next_look = time.monotonic() + POLL_S
                if self.sent in ready:
                    os.write(self.port, os.read(self.sent, 4096))
                if self.port in ready:
                    self.uart.sendall(os.read(self.port, 4096))
        except Exception as error:  # raised by the waiting thread
            if not self.stopping:
                self.failure = error

    def look(self) -> None:
        self.look_at_rate()
        functions = self.monitor.words(GPIO_FUNCTIONS, 6)
        levels = self.monitor.words(GPIO_LEVELS, 1)[0]
        for pin, (word, idle) in self.pins.items():
            driven = functions[pin // 10] >> (pin % 10 * 3) & 7 == 1
            level = bool(levels >> pin & 1) if driven else idle
            if self.levels.get(pin) == level:
                continue
            self.levels[pin] = level
            self.edges.append((time.monotonic(), pin, level))
            self.robot.tell(f"{word} {'high' if level else 'low'}")

    def look_at_rate(self) -> None:
        whole, parts = self.monitor.words(UART_DIVISORS, 2)
        if whole == 0:
            return
        exact = UART_CLOCK_HZ / (16 * (whole + parts / 64))
        rate = min(RATES, key=lambda rate: abs(rate - exact))
        if self.rates and self.rates[-1] == rate:
            return
        self.rates.append(rate)
        settings = termios.tcgetattr(self.port)
        settings[4] = settings[5] = RATES[rate]
        termios.tcsetattr(self.port, termios.TCSANOW, settings)

    def check(self) -> None:
        if self.failure:
            raise self.failure

    def booted(self, timeout_s: float = 180) -> None:
        self.shell.wait_for(r"@@booted\n(?:.*\n)*?Enter .help. .*\n", timeout_s)

    def close(self) -> None:
        self.stopping = True
        self.wires.join()
        if self.process.poll() is None:
            self.monitor.execute("quit")
        self.process.wait()
        self.pump.join()  # ends when qemu ends
        self.uart.close()
        self.shell.close()
        os.close(self.sent)
        os.close(self.port)
