#!/usr/bin/env python3
"""What `cargobay sensors --json` costs beside a client built like libcreate, which prints nothing
(like_libcreate.cpp): system calls and processor time a frame, on one virtual Create, in turns.
usage: against_libcreate.py CARGOBAY [ROUNDS]
Start and end are not counted: each figure is the difference of a long and a short run. The guard and
whatever else a client starts is counted. Fails if `sensors` needs more than half of the system
calls, or more than MOST_CPU of the processor time, in the median of the rounds. Exit 77, and says
why, without Boost.Asio or strace."""

import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

BAUD = 57600
PACKETS = "7,8,9,10,11,12,13,17,18,19,20,21,22,23,24,25,26,34,35,36"
SHORT_S, LONG_S = 2, 8
MOST_CALLS = 0.5
MOST_CPU = 0.9  # the aim is a half, which a calm machine shows; a busy one has cold caches
SKIPPED = 77


class Client:
    def __init__(self, name: str, line: list, frames, interrupted: bool):
        self.name, self.line, self.frames, self.interrupted = name, line, frames, interrupted

    def run(self, seconds: int, before: tuple = ()) -> tuple[int, float]:
        """How many frames it read, and its processor time in s, with that of its children."""
        words = [*before, *(str(seconds) if word == "SECONDS" else word for word in self.line)]
        with tempfile.TemporaryFile("w+") as out:
            process = subprocess.Popen(words, stdout=out, stderr=subprocess.DEVNULL)
            if self.interrupted:
                time.sleep(seconds)
                # strace passes a signal on only to what it started.
                found = [process.pid]
                if before:
                    children = f"/proc/{process.pid}/task/{process.pid}/children"
                    found = [int(word) for word in Path(children).read_text().split()]
                for pid in found:
                    os.kill(pid, 2)
            _, status, used = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            out.seek(0)
            return self.frames(out.read()), used.ru_utime + used.ru_stime

    def cpu_us(self) -> float:
        frames, seconds = zip(*(self.run(duration) for duration in (SHORT_S, LONG_S)))
        return 1e6 * (seconds[1] - seconds[0]) / (frames[1] - frames[0])

    def calls(self, folder: Path) -> float:
        frames, calls = [], []
        for duration in (SHORT_S, LONG_S):
            log = folder / "calls"
            frames.append(self.run(duration, ("strace", "-f", "-c", "-o", str(log)))[0])
            calls.append(int(re.search(r"(\d+)\s+(\d+ )?\s*total", log.read_text()).group(1)))
        return (calls[1] - calls[0]) / (frames[1] - frames[0])


def compare(binary: Path, rounds: int, folder: Path) -> bool:
    like = folder / "like_libcreate"
    source = Path(__file__).with_name("like_libcreate.cpp")
    subprocess.run(["g++", "-std=c++20", "-O2", "-o", like, source, "-pthread"], check=True)
    serve = subprocess.Popen([binary, "sim"], stdout=subprocess.PIPE, text=True)
    try:
        port = re.search(r"/dev/pts/\d+", serve.stdout.readline()).group(0)
        ours = Client("sensors", [binary, "sensors", "--port", port, "--packets", PACKETS, "--json"],
                      lambda text: len(text.splitlines()), True)  # fmt: skip
        theirs = Client("like libcreate", [like, port, str(BAUD), "SECONDS", *PACKETS.split(",")],
                        lambda text: int(text.split()[0]), False)  # fmt: skip
        calls = [client.calls(folder) for client in (ours, theirs)]
        print(f"system calls a frame: {calls[0]:.1f} and {calls[1]:.1f}, x {calls[0] / calls[1]:.3f}")
        ratios = []
        for _ in range(rounds):
            cpu = [client.cpu_us() for client in (ours, theirs)]
            ratios.append(cpu[0] / cpu[1])
            print(f"processor time a frame: {cpu[0]:.1f} us and {cpu[1]:.1f} us, x {ratios[-1]:.2f}", flush=True)
    finally:
        serve.terminate()
        serve.wait()
    ratio = statistics.median(ratios)
    print(f"median of {rounds}: x {ratio:.2f} (aim 0.5, bound {MOST_CPU})")
    return calls[0] <= MOST_CALLS * calls[1] and ratio <= MOST_CPU


def main() -> int:
    binary = Path(sys.argv[1]).resolve()
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    lacking = [tool for tool in ("g++", "strace") if not shutil.which(tool)]
    if not Path("/usr/include/boost/asio.hpp").exists():
        lacking.append("boost/asio.hpp (libboost-dev)")
    if lacking:
        print(f"skipped: this machine lacks {', '.join(lacking)}")
        return SKIPPED
    with tempfile.TemporaryDirectory(prefix="cargobay-cost-") as folder:
        return 0 if compare(binary, rounds, Path(folder)) else 1


if __name__ == "__main__":
    sys.exit(main())
