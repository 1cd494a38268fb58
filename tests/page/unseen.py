#!/usr/bin/python3
"""How soon the robot is told to stop when the page that drives it is no longer looked at: hidden,
closed, killed, or asleep (a telephone, a network that is cut, a client that stops reading).

usage: tests/page/unseen.py BUILD [TIMES]   prints a table; exit 1 if one took longer than allowed
"""

import os
import signal
import subprocess
import sys
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


# The browser takes its time to hide or close a page: when it was, the page itself notes.
NOTE = """for (const event of ["visibilitychange", "pagehide"]) addEventListener(event, () =>
    localStorage.setItem("unseen", localStorage.getItem("unseen") ?? Date.now()), true);"""


def noted(browser, served, page):
    others = [each for each in browser.driver.window_handles if each != page]
    browser.driver.switch_to.window(others[0])
    browser.driver.get(served.url + "icon.svg")
    return float(browser.run("return localStorage.getItem('unseen')")) / 1000


# What happens to the page.
HAPPENINGS = {
    "hidden": lambda driver, _: driver.switch_to.new_window("tab"),
    "closed": lambda driver, _: driver.close(),
    "killed": lambda _, victims: send(victims, signal.SIGKILL),
    "asleep": lambda _, victims: send(victims, signal.SIGSTOP),
}


def once(served, happening):
    """Seconds from the happening to the first state whose set speeds are 0."""
    feed = served.feed()
    feed.ask({"do": "control", "line": "place 1500 1000 90"})
    browser = Browser()
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
        HAPPENINGS[happening](browser.driver, victims)
        # The driver's answer may come late; the states have waited in the socket.
        feed.read_until(lambda: feed.newest["state"]["set_mm_s"] == {"left": 0, "right": 0})
        if happening in ("hidden", "closed"):
            began = noted(browser, served, page)
        return feed.newest["state"]["unix_time_s"] - began
    finally:
        victims = processes(browser.driver)
        send(victims, signal.SIGCONT)
        send(victims, signal.SIGKILL)
        browser.driver.service.process.kill()
        feed.close()


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
        for happening in HAPPENINGS:
            took = sorted(once(served, happening) for _ in range(times))
            late += sum(each > allowed for each in took)
            print(f"| {happening} | {times} | {took[len(took) // 2]:.2f} | {took[-1]:.2f} |",
                  flush=True)
        print(f"{late} of {times * len(HAPPENINGS)} took longer than {allowed:.2f} s")
    finally:
        served.close()
    sys.exit(late > 0)


if __name__ == "__main__":
    main()
