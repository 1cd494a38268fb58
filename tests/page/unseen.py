#!/usr/bin/python3
"""How soon the robot is told to stop when the page that drives it is no longer looked at: hidden,
closed, killed, asleep as a telephone is, behind a network that was cut; and when a client of the
feed's own socket stands still, neither reading nor writing.

usage: tests/page/unseen.py BUILD [TIMES [ENDING]...]
ENDING is hidden, closed, killed, asleep, cut-off, stalled: all, if none is named. Prints a table; exit 1
if one took longer than allowed.
"""

import os
import selectors
import signal
import socket
import subprocess
import sys
import threading
import time

from browser import Browser
from served import Served, until

ALLOWED_BEYOND_LAPSE_S = 0.1


def processes(driver):
    """The browser's, all of them."""
    parent = str(driver.service.process.pid)
    found, queue = [], [parent]
    while queue:
        children = subprocess.run(["pgrep", "-P", queue.pop()], capture_output=True, text=True,
                                  check=False).stdout.split()
        found += children
        queue += children
    return [int(each) for each in found]


def send(victims, what):
    for process in victims:
        try:
            os.kill(process, what)
        except ProcessLookupError:
            pass


class Network(threading.Thread):
    """Between browser and server. While it is cut nothing passes, and nobody is told."""

    def __init__(self, server):
        super().__init__(daemon=True)
        self.server = server
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.whole = True
        self.start()

    def run(self):
        while True:
            self.carry()
            while not self.whole:
                time.sleep(0.02)

    def carry(self):
        """Until it is cut. What was connected then is closed when the next begins."""
        self.others = {}
        with selectors.DefaultSelector() as self.selector:
            self.selector.register(self.listener, selectors.EVENT_READ)
            while self.whole:
                for key, _ in self.selector.select(0.2):
                    if key.fileobj is self.listener:
                        self.connect()
                    elif self.whole and key.fileobj in self.others:
                        self.pass_on(key.fileobj)
            self.kept = self.others

    def connect(self):
        pair = self.listener.accept()[0], socket.create_connection(self.server)
        self.others[pair[0]], self.others[pair[1]] = pair[1], pair[0]
        for each in pair:
            self.selector.register(each, selectors.EVENT_READ)

    def pass_on(self, end):
        try:
            data = end.recv(1 << 16)
            self.others[end].sendall(data)
        except OSError:
            data = b""
        if data:
            return
        for each in (end, self.others[end]):
            self.selector.unregister(each)
            del self.others[each]
            each.close()

    def cut(self):
        self.whole = False

    def mend(self):
        self.whole = True


# The browser takes its time to hide or close a page: when it was, the page itself notes.
NOTE = """localStorage.removeItem("unseen");
for (const event of ["visibilitychange", "pagehide"]) addEventListener(event, () =>
    localStorage.setItem("unseen", localStorage.getItem("unseen") ?? Date.now()), true);"""


class Looking:
    """A browser whose page drives the robot, again and again."""

    def __init__(self, served):
        self.served = served
        host, port = served.http.split(":")
        self.network = Network((host, int(port)))
        self.rules = f"host-resolver-rules=MAP {served.http} {host}:{self.network.port}"
        self.browser = None

    @property
    def driver(self):
        return self.browser.driver

    def drive(self, feed):
        """From a page that turns the robot, in a window beside another one."""
        self.network.mend()
        if self.browser is None:
            self.browser = Browser(arguments=[self.rules])
            self.processes = processes(self.driver)
        for window in self.driver.window_handles[1:]:
            self.driver.switch_to.window(window)
            self.driver.close()
        self.other = self.driver.window_handles[0]
        self.driver.switch_to.window(self.other)
        self.driver.get("about:blank")
        self.driver.switch_to.new_window("window")
        self.browser.open(self.served.url)
        self.browser.run(NOTE)
        self.browser.steer()
        self.browser.key("a", down=True)
        until(lambda: feed.now("state")["set_mm_s"]["right"] > 50, "a robot that turns")

    def noted(self):
        """When the page noted that it is not seen; None if it had no time to."""
        self.driver.switch_to.window(self.other)
        self.driver.get(self.served.url + "icon.svg")
        at = self.browser.run("return localStorage.getItem('unseen')")
        return at and float(at) / 1000

    def hide(self):
        self.driver.switch_to.new_window("tab")

    def close_page(self):
        self.driver.close()

    def kill(self):
        send(self.processes, signal.SIGKILL)

    def sleep(self):
        send(self.processes, signal.SIGSTOP)

    def wake(self):
        send(self.processes, signal.SIGCONT)

    def cut_off(self):
        self.network.cut()

    def leave(self):
        if self.browser is None:
            return
        self.wake()
        self.kill()
        self.driver.service.process.kill()
        self.browser = None


# What happens to the page, and what undoes it.
HAPPENINGS = {
    "hidden": (Looking.hide, None),
    "closed": (Looking.close_page, None),
    "killed": (Looking.kill, Looking.leave),
    "asleep": (Looking.sleep, Looking.wake),
    "cut-off": (Looking.cut_off, Looking.leave),
}
STALLED = "stalled"  # not a page: a client of the socket


def stopped(feed, began):
    """Seconds until the first state whose set speeds are 0: those before have waited in the socket."""
    feed.read_until(lambda: feed.newest["state"]["set_mm_s"] == {"left": 0, "right": 0})
    return feed.newest["state"]["unix_time_s"] - began


def once(served, looking, happening):
    """Seconds from the happening to the first state whose set speeds are 0."""
    happens, undo = HAPPENINGS[happening]
    feed = served.feed()
    feed.ask({"do": "control", "line": "place 1500 1000 90"})
    try:
        looking.drive(feed)
        feed.now("state")
        began = time.time()
        happens(looking)
        took = stopped(feed, began)
        if happening in ("hidden", "closed"):  # the driver's answer may come late
            took += began - (looking.noted() or began)
        return took
    finally:
        if undo:
            undo(looking)
        feed.close()


def once_of_the_socket(served):
    """The same where a client neither reads nor writes any longer."""
    feed = served.feed()
    feed.ask({"do": "control", "line": "place 1500 1000 90"})
    client = served.feed()
    client.ask({"do": "hold", "name": "one who stands still", "take": True})
    for _ in range(10):
        client.ask({"do": "drive", "left_mm_s": -100, "right_mm_s": 100})
        feed.now("state")
    began = time.time()
    took = stopped(feed, began)
    client.close()
    feed.close()
    return took


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    times = int(sys.argv[2]) if len(sys.argv) > 2 else 100
    endings = sys.argv[3:] or [*HAPPENINGS, STALLED]
    if not set(endings) <= {*HAPPENINGS, STALLED}:
        sys.exit(__doc__)
    served = Served(sys.argv[1])
    looking = Looking(served)
    late = 0
    try:
        feed = served.feed()
        allowed = feed.newest["hello"]["setpoint_lapse_s"] + ALLOWED_BEYOND_LAPSE_S
        feed.close()
        print("| the page is | times | p50, s | longest, s |\n|---|---|---|---|")
        for happening in endings:
            took = sorted(once_of_the_socket(served) if happening == STALLED
                          else once(served, looking, happening) for _ in range(times))
            late += sum(each > allowed for each in took)
            print(f"| {happening} | {times} | {took[len(took) // 2]:.2f} | {took[-1]:.2f} |",
                  flush=True)
        print(f"{late} of {times * len(endings)} took longer than {allowed:.2f} s")
    finally:
        looking.leave()
        served.close()
    sys.exit(late > 0)


if __name__ == "__main__":
    main()
