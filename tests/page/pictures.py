#!/usr/bin/python3
"""Takes the pictures of docs/watching.md, after a short drive.

usage: tests/page/pictures.py BUILD [FOLDER]   writes to docs by default
"""

import pathlib
import sys

from browser import PHONE, Browser
from served import ROOT, Served, until


def drive(browser, feed):
    """Forward, a turn, forward until it bumps into something."""
    browser.steer()
    browser.key("w", down=True)
    wait(feed, 1.5)
    browser.key("a", down=True)
    wait(feed, 1.2)
    browser.key("a", down=False)
    seen = len(feed.events)
    until(lambda: feed.now("state") and "bump_began" in
          [event["what"] for event in feed.events[seen:]], "a bump")
    browser.key("w", down=False)
    browser.key("s", down=True)
    wait(feed, 1.0)
    browser.key("s", down=False)
    wait(feed, 1.0)


def wait(feed, seconds):
    """Of the robot's time."""
    end = feed.now("state")["robot_time_s"] + seconds
    feed.read_until(lambda: feed.newest["state"]["robot_time_s"] > end)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "docs"
    served = Served(sys.argv[1])
    try:
        for name, options in (("desktop", {"size": (1200, 1000)}),
                              ("phone", {"size": PHONE, "dark": True})):
            feed = served.feed()
            feed.ask({"do": "control", "line": "place 500 1500 0"})
            browser = Browser(**options)
            browser.open(served.url)
            drive(browser, feed)
            browser.picture(folder / f"watching-{name}.png")
            browser.close()
            feed.close()
    finally:
        served.close()


if __name__ == "__main__":
    main()
