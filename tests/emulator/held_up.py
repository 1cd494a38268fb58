"""How long the host has kept an emulated machine from running: its threads were ready, and others had
the processors. What the machine is given time for is judged without that."""

from pathlib import Path

NS_PER_S = 1e9
TICKS_PER_S = 100.0


def waiting_s(process: int) -> dict[str, float]:
    """For a processor, each of its threads so far; proc(5), schedstat."""
    waits = {}
    for thread in Path(f"/proc/{process}/task").glob("*/schedstat"):
        try:
            waits[thread.parent.name] = int(thread.read_text().split()[1]) / NS_PER_S
        except (OSError, IndexError):  # a thread that has ended, or a kernel that does not say
            continue
    return waits


def stolen_s() -> float:
    """From one processor of this host, if it is itself a virtual one."""
    lines = Path("/proc/stat").read_text().splitlines()
    processors = sum(line.startswith("cpu") for line in lines) - 1
    return int(lines[0].split()[8]) / TICKS_PER_S / max(1, processors)


class Allowance:
    """Time that a machine is given. It passes while the machine runs: what its processes waited for a
    processor, each as long as the thread that waited longest, is taken off, down to LEAST of the host's
    time, so that it ends in any case."""

    LEAST = 0.2
    # Nothing that waits so long was waiting for the machine: this host stood still.
    MOST_AT_ONCE_S = 2.0

    def __init__(self, processes: list[int], now: float):
        self.processes, self.last = processes, now
        self.waits, self.stolen = self.looks()

    def looks(self) -> tuple[list[dict[str, float]], float]:
        return [waiting_s(process) for process in self.processes], stolen_s()

    def passed(self, now: float) -> float:
        """Since the last call, in s."""
        seconds, self.last = now - self.last, now
        before, stolen_before = self.waits, self.stolen
        self.waits, self.stolen = self.looks()
        held_up = self.stolen - stolen_before
        for was, waits in zip(before, self.waits, strict=True):
            held_up += max((wait - was.get(thread, 0.0) for thread, wait in waits.items()), default=0.0)
        return min(max(seconds - held_up, self.LEAST * seconds), self.MOST_AT_ONCE_S)
