"""qemu from outside: the sockets that it listens at, its monitor, a line to the machine's shell."""

import codecs
import json
import re
import select
import shutil
import socket
import time
from collections.abc import Callable
from pathlib import Path


def lacks(tools: list[str], purpose: str = "test") -> bool:
    """Says which of them, and what to do about it: packages of that purpose."""
    missing = [tool for tool in tools if shutil.which(tool) is None]
    if missing:
        print(f"SKIPPED: no {', '.join(missing)}; run .ci/packages.sh {purpose}")
    return bool(missing)


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


class Monitor:
    """qemu's, over QMP."""

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
        """Of the machine's memory, its registers too."""
        text = self.execute("human-monitor-command", **{"command-line": f"xp /{count}wx {address:#x}"})
        return [int(word, 16) for word in re.findall(r"0x([0-9a-f]{8})\b", text)][-count:]

    def close(self) -> None:
        self.link.close()


class Shell:
    """On a serial line of the machine. `look` is called while waiting; what it raises ends that."""

    def __init__(self, path: Path, look: Callable[[], None] = lambda: None):
        self.link = connect(path)
        self.look = look
        self.heard = ""
        self.decoder = codecs.getincrementaldecoder("utf-8")(errors="replace")

    def wait_for(self, pattern: str, timeout_s: float) -> re.Match:
        """What the machine prints up to there; it is taken."""
        deadline = time.monotonic() + timeout_s
        while True:
            found = re.search(pattern, self.heard, re.MULTILINE)
            if found:
                self.heard = self.heard[found.end() :]
                return found
            left = deadline - time.monotonic()
            self.look()
            if left <= 0:
                raise TimeoutError(f"no {pattern!r} within {timeout_s} s; the machine said:\n{self.heard}")
            if select.select([self.link], [], [], min(left, 0.5))[0]:
                self.heard += self.decoder.decode(self.link.recv(4096)).replace("\r", "")

    def start(self, line: str) -> None:
        """Runs the line; its end is waited for by end()."""
        self.link.sendall(f"{line}; code=$?; echo; echo @@ended $code\n".encode())

    def end(self, timeout_s: float) -> tuple[int, str]:
        """The exit code, and what was printed."""
        ended = self.wait_for(r"\A((?:.*\n)*?)@@ended (\d+)\n", timeout_s)
        return int(ended[2]), ended[1]

    def run(self, line: str, timeout_s: float = 60) -> tuple[int, str]:
        self.start(line)
        return self.end(timeout_s)

    def close(self) -> None:
        self.link.close()
