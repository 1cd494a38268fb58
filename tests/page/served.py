"""`cargobay serve` on a virtual Create in a world, and a client of its feed without a browser."""

import json
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATIENCE_S = 30  # until something is given up, on however busy a machine


def until(condition, what, patience_s=PATIENCE_S):
    """Waits until `condition()` is true, and returns what it returned."""
    end = time.monotonic() + patience_s
    while True:
        found = condition()
        if found:
            return found
        if time.monotonic() > end:
            raise AssertionError(f"not seen: {what}")
        time.sleep(0.02)


class Feed:
    """One client of the feed: keeps the newest message of each type, and all events."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(PATIENCE_S)
        self.socket.connect(str(path))
        self.lines = self.socket.makefile("r")
        self.newest = {}
        self.events = []
        self.next_id = 0
        self.read_until(lambda: "hello" in self.newest)

    def read(self):
        line = self.lines.readline()
        if not line:
            raise AssertionError("the feed has ended")
        message = json.loads(line)
        self.newest[message["type"]] = message
        if message["type"] == "event":
            self.events.append(message)
        return message

    def read_until(self, condition, patience_s=PATIENCE_S):
        end = time.monotonic() + patience_s
        while not condition():
            if time.monotonic() > end:
                raise AssertionError("the feed did not say it")
            self.read()

    def now(self, kind):
        """The next message of that type: what was already waiting is older."""
        sent = self.ask({"do": "subscribe", "types": ["state", "truth", "statistics"]})
        assert sent["ok"], sent
        self.newest.pop(kind, None)
        self.read_until(lambda: kind in self.newest)
        return self.newest[kind]

    def ask(self, request):
        self.next_id += 1
        request = {**request, "id": self.next_id}
        self.socket.sendall((json.dumps(request) + "\n").encode())
        while True:
            message = self.read()
            if message["type"] == "answer" and message.get("id") == self.next_id:
                return message

    def standing(self):
        """The truth, once the wheels stand."""

        def still():
            speeds = self.now("truth")["wheel_mm_s"]
            return abs(speeds["left"]) < 3 and abs(speeds["right"]) < 3

        until(still, "wheels that stand")
        return self.newest["truth"]

    def holder(self):
        self.now("state")
        return self.newest["holder"]["name"]

    def close(self):
        self.lines.close()
        self.socket.close()


def sockets_in(folder):
    return [path for path in pathlib.Path(folder).iterdir() if path.is_socket()]


def url_of(process, said):
    """Where it serves, once it does."""
    for line in process.stdout:
        if line.startswith("serving "):
            return line.split()[1]
    raise AssertionError(f"it does not serve: {said()}")


class Served:
    """The server; each start() may be of another process, at the same address."""

    def __init__(self, build, world="room"):
        self.build = pathlib.Path(build)
        self.world = ROOT / "examples/worlds" / f"{world}.world"
        self.folder = tempfile.TemporaryDirectory(prefix="cargobay-page-")
        self.http = "127.0.0.1:0"
        self.log = tempfile.TemporaryFile("w+")
        self.start()

    def start(self):
        environment = {**os.environ, "CARGOBAY_FEED_DIR": self.folder.name}
        self.process = subprocess.Popen(
            [self.build / "cargobay", "serve", "--http", self.http, "--world", self.world,
             "--learnt", "none", "--drive-on",
             "--guard-deadline", "10000"],  # beside browsers, it may wait long
            stdout=subprocess.PIPE, stderr=self.log, text=True, env=environment)
        self.url = url_of(self.process, self.said)
        self.http = self.url.split("/")[2]

    def feed(self):
        return Feed(until(lambda: sockets_in(self.folder.name), "the feed's socket")[0])

    def said(self):
        """On its standard error, so far."""
        self.log.seek(0)
        return self.log.read()

    def stop(self):
        self.process.terminate()
        self.process.communicate(timeout=PATIENCE_S)

    def close(self):
        self.stop()
        self.folder.cleanup()


class Controlled:
    """A program with a control function of its own, which publishes a feed, and the web side."""

    PROGRAM = """
import sys
from cargobay import Flag, Robot, Wheels

with Robot(None, flags=Flag.PUBLISH | Flag.NO_CONFIG | Flag.NO_LEARNT) as robot:
    robot.set_control(lambda state: {answer})
    robot.start()
    sys.stdin.read()  # until the test is done with it
    robot.end()
"""

    def __init__(self, build, answer):
        build = pathlib.Path(build)
        self.folder = tempfile.TemporaryDirectory(prefix="cargobay-page-")
        environment = {**os.environ, "CARGOBAY_FEED_DIR": self.folder.name,
                       "CARGOBAY_LIBRARY": str(build / "libcargobay.so.0"),
                       "CARGOBAY_GUARD": str(build / "cargobay-guard"),
                       "PYTHONPATH": str(ROOT / "hal/python"), "PYTHONDONTWRITEBYTECODE": "1"}
        self.program = subprocess.Popen([sys.executable, "-c", self.PROGRAM.format(answer=answer)],
                                        stdin=subprocess.PIPE, env=environment)
        self.feed = until(lambda: sockets_in(self.folder.name), "the feed of a program")[0]
        self.web = subprocess.Popen(
            [build / "cargobay-web", "--feed", self.feed, "--http", "127.0.0.1:0"],
            stdout=subprocess.PIPE, text=True)
        self.url = url_of(self.web, lambda: "its error is above")

    def close(self):
        self.web.terminate()
        self.web.communicate(timeout=PATIENCE_S)
        self.program.communicate(timeout=PATIENCE_S)
        self.folder.cleanup()
