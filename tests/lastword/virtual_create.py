"""A `cargobay sim` process for a test, watched through its control socket.

What is asserted is the truth of the virtual Create: what its wheels do and what it was told, by its
own clock, so that a busy machine is not taken for a slow stop.
"""

import bisect
import contextlib
import fcntl
import json
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import termios
import threading
import time

REST_MM_S = 2.0
SAMPLE_S = 0.008
# How long a Robot may take from the death of its program to the stop: the guard's deadline and two
# tries.
STOP_S = 0.5
# Between the last sample before an event and the event, on a busy machine.
ALLOWANCE_S = 0.35
_TIOCGEXCL = 0x80045440


class Sample:
    """What the robot did at one moment of its own time."""

    def __init__(self, state):
        self.time_s = state["time_s"]
        self.mode = state["mode"]
        self.streaming = state["streaming"]
        self.told_to_stop = not any(state["commanded_mm_s"].values())
        self.fastest = max(abs(speed) for speed in state["wheel_mm_s"].values())
        self.unknown_opcodes = state["counters"]["unknown_opcodes"]
        # At another rate, as while the bring-up looks for the robot's, bytes can be anything.
        self.framing_errors = state["counters"]["robot_framing_errors"]
        self.bytes_received = state["counters"]["bytes_received"]

    def quiet(self):
        return self.told_to_stop and self.mode in ("passive", "off")

    def __str__(self):
        told = "told to stop" if self.told_to_stop else "told to drive"
        return (f"{self.mode}, {told}, wheels at {self.fastest:.0f} mm/s, "
                f"{'streaming' if self.streaming else 'silent'}")


class VirtualCreate:
    """Owns the process, a folder with its link, and a thread that looks at it all the while."""

    def __init__(self, command, *arguments):
        self._folder = tempfile.mkdtemp(prefix="cargobay-test-")
        os.chmod(self._folder, 0o755)
        self.link = os.path.join(self._folder, "create")
        control = os.path.join(self._folder, "control")
        self._sim = subprocess.Popen(
            [command, "sim", "--link", self.link, "--control", control, *arguments],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            start_new_session=True)
        if b"listening" not in self._sim.stdout.readline():
            raise RuntimeError("the virtual Create does not start")
        self._socket = socket.socket(socket.AF_UNIX)
        self._socket.connect(control)
        self._lines = self._socket.makefile("rw", newline="\n")
        self._lock = threading.Lock()
        self._samples = []  # (CLOCK_MONOTONIC, Sample)
        self._closing = threading.Event()
        self.device = os.stat(self.link).st_rdev
        self._found = self._set_up_port()
        self._sample()
        self._watcher = threading.Thread(target=self._watch, daemon=True)
        self._watcher.start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._closing.set()
        self._watcher.join()
        for process in self.users():  # left by a test that failed
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        self._sim.terminate()
        try:
            self._sim.wait(5.0)
        except subprocess.TimeoutExpired:
            self._sim.kill()
            self._sim.wait()
        self._socket.close()
        shutil.rmtree(self._folder, ignore_errors=True)

    @property
    def folder(self):
        return self._folder

    def unplug(self):
        """The port goes. Its number may be another's at once: nothing is looked for any more."""
        self.device = None
        self.say("fault unplugged")

    def say(self, line):
        with self._lock:
            self._lines.write(line + "\n")
            self._lines.flush()
            return self._lines.readline().rstrip("\n")

    def _sample(self):
        sample = Sample(json.loads(self.say("state")))
        self._samples.append((time.monotonic(), sample))
        return sample

    def _watch(self):
        while not self._closing.wait(SAMPLE_S):
            with contextlib.suppress(ValueError, OSError):
                self._sample()

    def now(self):
        return self._samples[-1][1]

    def _own_time(self, moment):
        """The robot's time at a moment of CLOCK_MONOTONIC."""
        return moment - min(at - sample.time_s for at, sample in self._samples)

    def wait_for(self, holds, timeout_s=10.0):
        """Whether it comes to hold of a sample; looks at those of now and later only."""
        limit = time.monotonic() + timeout_s
        while time.monotonic() < limit:
            if holds(self.now()):
                return True
            time.sleep(SAMPLE_S / 2)
        return False

    def drives(self, timeout_s=10.0):
        """Waits until its wheels turn."""
        return self.wait_for(lambda sample: sample.fastest > 50.0, timeout_s)

    def settles(self, since, quiet=Sample.quiet):
        """Waits until it stands, and goes on standing.

        `since`: CLOCK_MONOTONIC. Returns the seconds, by its own clock, from then to the first
        moment from which on it was told to stop and Passive or Off; None if it is not at rest by
        the time it should be.
        """
        self.wait_for(quiet, STOP_S + ALLOWANCE_S)
        # From full speed its wheels take half a second. Anything that comes later shows too.
        self.wait_for(lambda sample: sample.fastest < REST_MM_S, 3.0)
        time.sleep(0.1)
        last = self.now()
        if not quiet(last) or last.fastest >= REST_MM_S:
            return None
        begin_s = self._own_time(since)
        samples = [sample for _, sample in list(self._samples)]
        times = [sample.time_s for sample in samples]
        quiet_s = begin_s
        for sample in samples[bisect.bisect_left(times, begin_s):]:
            if not quiet(sample):
                quiet_s = sample.time_s + SAMPLE_S
        return quiet_s - begin_s

    def users(self):
        """Processes, apart from the virtual Create, that have its port open."""
        found = []
        if self.device is None:
            return found
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit() or int(entry.name) in (self._sim.pid, os.getpid()):
                continue
            with contextlib.suppress(OSError):
                for descriptor in (entry / "fd").iterdir():
                    with contextlib.suppress(OSError):
                        target = os.readlink(descriptor)
                        if target.startswith("/dev/pts/") and os.stat(target).st_rdev == self.device:
                            found.append(int(entry.name))
                            break
        return found

    def guard(self, timeout_s=5.0):
        """The process number of the guard over this robot."""
        limit = time.monotonic() + timeout_s
        while time.monotonic() < limit:
            for process in self.users():
                with contextlib.suppress(OSError):
                    if pathlib.Path(f"/proc/{process}/comm").read_text().strip() == "cargobay-guard":
                        return process
            time.sleep(0.01)
        raise RuntimeError("no guard has the port open")

    def _set_up_port(self):
        """Gives the port settings that nothing of ours would choose; returns them."""
        with self._open() as port:
            settings = termios.tcgetattr(port)
            settings[0] |= termios.ISTRIP
            settings[3] |= termios.NOFLSH
            settings[4] = settings[5] = termios.B9600
            termios.tcsetattr(port, termios.TCSANOW, settings)
            return termios.tcgetattr(port)

    def _port_troubles(self, settings_too):
        troubles = []
        with self._open() as port:
            try:
                fcntl.flock(port, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                troubles.append(f"the port is locked by {self.users()}")
            exclusive = struct.unpack("i", fcntl.ioctl(port, _TIOCGEXCL, b"\0" * 4))[0]
            if exclusive:
                troubles.append("the port is exclusive")
            if settings_too and termios.tcgetattr(port) != self._found:
                troubles.append("the port is not set as it was found")
        return troubles

    def wait_for_port(self, settings_too=True, timeout_s=1.5):
        """Waits until the port is free, and set as the program had found it: what is wrong then."""
        limit = time.monotonic() + timeout_s
        while (troubles := self._port_troubles(settings_too)) and time.monotonic() < limit:
            time.sleep(0.02)
        return troubles

    @contextlib.contextmanager
    def _open(self):
        port = os.open(self.link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        try:
            yield port
        finally:
            os.close(port)
