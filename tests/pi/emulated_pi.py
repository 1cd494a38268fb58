"""A Raspberry Pi 3 in qemu, running Debian's own kernel: its PL011 is wired to a virtual Create outside,
its GPIO pins to that robot's pins.
"""

import gzip
import json
import os
import re
import select
import shutil
import socket
import subprocess
import termios
import threading
import time
import tty
from pathlib import Path

from debian import Suite

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


def lacks(tools: list[str]) -> bool:
    """Says which of them, and what to do about it."""
    missing = [tool for tool in tools if shutil.which(tool) is None]
    if missing:
        print(f"SKIPPED: no {', '.join(missing)}; run .ci/packages.sh test")
    return bool(missing)


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


def connect(path: Path) -> socket.socket:
    """To a socket that may not be there yet."""
    deadline = time.monotonic() + 20
    while True:
        link = socket.socket(socket.AF_UNIX)
        try:
            link.connect(str(path))
            return link
        except OSError:
            link.close()
            if time.monotonic() > deadline:
                raise
            time.sleep(0.05)


class VirtualCreate:
    """`cargobay sim`, with its remote control."""

    def __init__(self, command: Path, folder: Path, *options: str):
        self.port = folder / "create"
        control = folder / "control"
        self.process = subprocess.Popen(
            [command, "sim", "--link", self.port, "--control", control, *options],
            stdout=subprocess.DEVNULL,
        )
        self.link = connect(control).makefile("rw")
        self.lock = threading.Lock()

    def ask(self, line: str) -> str:
        with self.lock:
            self.link.write(line + "\n")
            self.link.flush()
            return self.link.readline().rstrip("\n")

    def tell(self, line: str) -> None:
        answer = self.ask(line)
        if answer != "ok":
            raise RuntimeError(f"the virtual Create answers `{line}` with: {answer}")

    def state(self) -> dict:
        return json.loads(self.ask("state"))

    def close(self) -> None:
        self.link.close()
        self.process.terminate()
        self.process.wait()


class Monitor:
    """qemu's, over QMP: reads the Pi's registers from outside."""

    def __init__(self, path: Path):
        self.link = connect(path).makefile("rw")
        self.link.readline()  # the greeting
        self.execute("qmp_capabilities")

    def execute(self, command: str, **arguments) -> object:
        self.link.write(json.dumps({"execute": command, "arguments": arguments}) + "\n")
        self.link.flush()
        while True:
            answer = json.loads(self.link.readline())
            if "return" in answer:
                return answer["return"]
            if "error" in answer:
                raise RuntimeError(answer["error"])

    def words(self, address: int, count: int) -> list[int]:
        text = self.execute("human-monitor-command", **{"command-line": f"xp /{count}wx {address:#x}"})
        return [int(word, 16) for word in re.findall(r"0x([0-9a-f]{8})\b", text)][-count:]


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
        self.console = connect(sockets["console"])
        self.port = os.open(robot.port, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self.port)
        self.sent, sending = os.pipe()  # what the Pi sends
        self.pump = threading.Thread(target=self.run_pump, args=(sending,))
        self.pump.start()
        self.stopping = False
        self.failure: Exception | None = None
        self.wires = threading.Thread(target=self.run_wires)
        self.wires.start()
        self.heard = ""

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

    # The console.

    def wait_for(self, pattern: str, timeout_s: float) -> re.Match:
        """What the Pi prints up to there; it is taken."""
        deadline = time.monotonic() + timeout_s
        while True:
            found = re.search(pattern, self.heard, re.MULTILINE)
            if found:
                self.heard = self.heard[found.end() :]
                return found
            left = deadline - time.monotonic()
            if self.failure:
                raise self.failure
            if left <= 0:
                raise TimeoutError(f"no {pattern!r} within {timeout_s} s; the Pi said:\n{self.heard}")
            if select.select([self.console], [], [], min(left, 0.5))[0]:
                self.heard += self.console.recv(4096).decode(errors="replace").replace("\r", "")

    def booted(self, timeout_s: float = 180) -> None:
        self.wait_for(r"@@booted\n(?:.*\n)*?Enter .help. .*\n", timeout_s)

    def start(self, line: str) -> None:
        """Runs the line; its end is waited for by end()."""
        self.console.sendall(f"{line}; code=$?; echo; echo @@ended $code\n".encode())

    def end(self, timeout_s: float) -> tuple[int, str]:
        """The exit code, and what was printed."""
        ended = self.wait_for(r"\A((?:.*\n)*?)@@ended (\d+)\n", timeout_s)
        return int(ended[2]), ended[1]

    def run(self, line: str, timeout_s: float = 60) -> tuple[int, str]:
        self.start(line)
        return self.end(timeout_s)

    def close(self) -> None:
        self.stopping = True
        self.wires.join()
        if self.process.poll() is None:
            self.monitor.execute("quit")
        self.process.wait()
        self.pump.join()  # ends when qemu ends
        for link in (self.uart, self.console):
            link.close()
        os.close(self.sent)
        os.close(self.port)
