"""An FTDI cable at the emulated Pi's USB port, as qemu makes one: a virtual Create hangs on its data
lines, and that robot's BRC pin and power toggle on RTS and DTR.
"""

import re
import threading
import time
from pathlib import Path

from emulated_pi import POLL_S, VirtualCreate

# Of Debian's kernel, in the order in which they are loaded.
MODULES = [
    "usb-common", "roles", "usbcore", "udc-core", "phy-generic", "dwc2", "usbserial", "ftdi_sio",
]  # fmt: skip
# FTDI_SIO_SET_MODEM_CTRL: the levels in the low byte, which of them are meant in the high one.
SET_MODEM_CONTROL = re.compile(r"got control 0x4001, value 0x([0-9a-f]+)")
DTR, RTS = 1, 2
PINS = {RTS: "brc", DTR: "power-toggle"}


def modules(kernel: Path) -> list[Path]:
    return [next(kernel.rglob(f"{name}.ko")) for name in MODULES]


class UsbCable:
    """Give `arguments` to qemu, then start()."""

    def __init__(self, command: Path, folder: Path):
        folder.mkdir(exist_ok=True)
        self.robot = VirtualCreate(command, folder)
        self.trace = folder / "trace"
        self.trace.write_text("")
        self.arguments = [
            "-chardev", f"serial,id=cable,path={self.robot.port}",
            "-device", "usb-serial,chardev=cable,port=1,always-plugged=on",
            "-trace", "usb_serial_handle_control", "-D", str(self.trace),
        ]  # fmt: skip
        self.edges: list[tuple[float, int, bool]] = []  # time in s, line, level at the cable
        self.stopping = False
        self.failure: Exception | None = None
        self.wires = threading.Thread(target=self.run)

    def start(self) -> None:
        self.wires.start()

    def run(self) -> None:
        try:
            with open(self.trace) as trace:
                rest = ""
                while not self.stopping:
                    rest += trace.read()
                    *lines, rest = rest.split("\n")
                    for found in filter(None, map(SET_MODEM_CONTROL.search, lines)):
                        self.set(int(found[1], 16))
                    time.sleep(POLL_S)
        except Exception as error:  # raised by close()
            self.failure = error

    def set(self, value: int) -> None:
        for line, word in PINS.items():
            if value >> 8 & line:
                level = not value & line  # asserted is low at the cable
                self.edges.append((time.monotonic(), line, level))
                self.robot.tell(f"{word} {'high' if level else 'low'}")

    def lows(self, line: int, since: float) -> list[float]:
        """How long the line was low each time, in ms."""
        edges = [(at, level) for at, which, level in self.edges if which == line and at >= since]
        changes = [edge for before, edge in zip([(0.0, None), *edges], edges) if before[1] != edge[1]]
        return [1000 * (after - at) for (at, level), (after, _) in zip(changes, changes[1:]) if not level]

    def close(self) -> None:
        self.stopping = True
        self.wires.join()
        self.robot.close()
        if self.failure:
            raise self.failure
