"""The virtual Create outside the emulated machine: the witness of what happens in it."""

import json
import subprocess
import threading
from pathlib import Path

from emulator.qemu import connect


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
