#!/usr/bin/python3
"""How soon the robot is told to stop when the page that drives it is no longer looked at: hidden,
closed, killed, asleep as a telephone is, behind a network that was cut; and when a client of the
feed's own socket stands still, neither reading nor writing.

usage: tests/page/unseen.py BUILD [TIMES]   prints a table; exit 1 if one took longer than allowed
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
    """Between browser and server, until it is cut: then nothing passes, and nobody is told."""

    def __init__(self, server):
        super().__init__(daemon=True)
        self.server = server
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.port = self.listener.getsockname()[1]
        self.selector = selectors.DefaultSelector()
        self.selector.register(self.listener, selectors.EVENT_READ)
        self.whole = True
        self.start()

    def run(self):
        others = {}
        while self.whole:
            for key, _ in self.selector.select(0.2):
                if key.fileobj is self.listener:
                    pair = self.listener.accept()[0], socket.create_connection(self.server)
                    others[pair[0]], others[pair[1]] = pair[1], pair[0]
                    for each in pair:
                        self.selector.register(each, selectors.EVENT_READ)
                elif self.whole and key.fileobj in others:
                    self.pass_on(key.fileobj, others)
        self.kept = others  # neither end is closed

    def pass_on(self, end, others):
        try:
            data = end.recv(1 << 16)
            others[end].sendall(data)
        except OSError:
            data = b""
        if data:
            return
        for each in (end, others[end]):
            self.selector.unregister(each)
            del others[each]
            each.close()

    def cut(self):
        self.whole = False


# The browser takes its time to hide or close a page: when it was, the page itself notes.
NOTE = """for (const event of ["visibilitychange", "pagehide"]) addEventListener(event, () =>
    localStorage.setItem("unseen", localStorage.getItem("unseen") ?? Date.now()), true);"""


def noted(browser, served, page):
    """When the page noted it; None if it had no time to."""
    others = [each for each in browser.driver.window_handles if each != page]
    browser.driver.switch_to.window(others[0])
    browser.driver.get(served.url + "icon.svg")
    at = browser.run("return localStorage.getItem('unseen')")
    return at and float(at) / 1000


# What happens to the page.
HAPPENINGS = {
    "hidden": lambda driver, _victims, _network: driver.switch_to.new_window("tab"),
    "closed": lambda driver, _victims, _network: driver.close(),
    "killed": lambda _driver, victims, _network: send(victims, signal.SIGKILL),
    "asleep": lambda _driver, victims, _network: send(victims, signal.SIGSTOP),
    "cut off": lambda _driver, _victims, network: network.cut(),
}
STANDS_STILL = "not there, but a client of the socket stands still"


def stopped(feed, began):
    """Seconds until the first state whose set speeds are 0: those before have waited in the socket."""
    feed.read_until(lambda: feed.newest["state"]["set_mm_s"] == {"left": 0, "right": 0})
    return feed.newest["state"]["unix_time_s"] - began


def once(served, happening):
    """Seconds from the happening to the first state whose set speeds are 0."""
    feed = served.feed()
    feed.ask({"do": "control", "line": "place 1500 1000 90"})
    host, port = served.http.split(":")
    network = Network((host, int(port)))
    browser = Browser(arguments=[
        f"host-resolver-rules=MAP {host}:{port} {host}:{network.port}"])
    try:
        page = browser.driver.current_window_handle
        if happening == "closed":  # the last window of a browser is not closed
            browser.driver.switch_to.new_window("window")
            browser.driver.switch_to.window(page)
        browser.open(served.url)
        browser.run(NOTE)
        browser.steer()
        browser.key("a", down=True)
        until(lambda: feed.now("state")["set_mm_s"]["right"] > 50, "a robot that turns")
        victims = processes(browser.driver)
        feed.now("state")
        began = time.time()
        HAPPENINGS[happening](browser.driver, victims, network)
        if happening not in ("hidden", "closed"):
            return stopped(feed, began)
        stopped(feed, began)  # the driver's answer may come late
        at = feed.newest["state"]["unix_time_s"]
        return at - (noted(browser, served, page) or began)
    finally:
        network.cut()
        victims = processes(browser.driver)
        send(victims, signal.SIGCONT)
        send(victims, signal.SIGKILL)
        browser.driver.service.process.kill()
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
    served = Served(sys.argv[1])
    late = 0
    try:
        feed = served.feed()
        allowed = feed.newest["hello"]["setpoint_lapse_s"] + ALLOWED_BEYOND_LAPSE_S
        feed.close()
        print("| the page is | times | p50, s | longest, s |\n|---|---|---|---|")
        for happening in [*HAPPENINGS, STANDS_STILL]:
            took = sorted(once_of_the_socket(served) if happening is STANDS_STILL
                          else once(served, happening) for _ in range(times))
            late += sum(each > allowed for each in took)
            print(f"| {happening} | {times} | {took[len(took) // 2]:.2f} | {took[-1]:.2f} |",
                  flush=True)
        print(f"{late} of {times * (len(HAPPENINGS) + 1)} took longer than {allowed:.2f} s")
    finally:
        served.close()
    sys.exit(late > 0)


if __name__ == "__main__":
    main()
