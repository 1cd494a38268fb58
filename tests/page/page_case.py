"""What the tests of the page share: a server, browsers, and a client of the feed that sees the same
robot from elsewhere."""

import pathlib
import sys
import unittest

from browser import Browser
from served import Served, until

HERE = pathlib.Path(__file__).resolve().parent
sys.path.append(str(HERE.parent / "npm"))
import npm_packages  # noqa: E402

NEAR_MM = 50
build = None  # the folder of the programs, set by who runs the tests


class PageTest(unittest.TestCase):
    """One server and one browser for all tests of a class."""

    slower = 1

    @classmethod
    def setUpClass(cls):
        cls.served = Served(build)
        cls.addClassCleanup(cls.served.close)
        cls.browser = Browser(slower=cls.slower)
        cls.addClassCleanup(cls.browser.close)

    def setUp(self):
        self.feed = self.served.feed()
        self.addCleanup(lambda: self.feed.close())
        self.feed.ask({"do": "stop"})

    def page(self, **appearance):
        """In the browser of all tests; it leaves the page that it showed before."""
        self.browser.leave()
        self.browser.appear(**appearance)
        self.browser.open(self.served.url)
        self.addCleanup(self.browser.leave)
        return self.browser

    def page_of_its_own(self, **appearance):
        browser = Browser(slower=self.slower, **appearance)
        self.addCleanup(browser.close)
        browser.open(self.served.url)
        return browser

    def control(self, line):
        answer = self.feed.ask({"do": "control", "line": line})
        self.assertTrue(answer["ok"], answer)

    def moved(self, start, mm):
        """Waits until the robot is so far from where it was."""

        def far():
            pose = self.feed.now("truth")["pose"]
            return abs(pose["x_mm"] - start["x_mm"]) + abs(pose["y_mm"] - start["y_mm"]) > mm

        until(far, f"a robot that drove {mm} mm")

    def happened(self, what, since):
        return what in [event["what"] for event in self.feed.events[since:]]

    def steer_from_here(self, left, right, enough=lambda: True):
        """Without the page: what it would refuse, such as a setpoint that is not renewed."""
        self.feed.ask({"do": "hold", "name": "test", "take": True})

        def drive():
            self.feed.ask({"do": "drive", "left_mm_s": left, "right_mm_s": right})
            return enough()

        until(drive, f"what {left}, {right} mm/s brings about")

    def assert_stops(self, why):
        until(lambda: self.feed.now("state")["set_mm_s"] == {"left": 0, "right": 0},
              f"speeds set to 0 after {why}")
        self.feed.standing()

    def assert_on_the_map(self, browser):
        """Odometry and truth as drawn are where the robot is."""
        pose = self.feed.standing()["pose"]

        def there():
            drawn = [*browser.both_poses()]
            return all(each and abs(each[0] - pose["x_mm"]) <= NEAR_MM and
                       abs(each[1] - pose["y_mm"]) <= NEAR_MM for each in drawn)

        until(there, f"both within {NEAR_MM} mm of {pose}, not {browser.both_poses()}", 5)

    def axe(self):
        """The checker of roles and contrast; skips the test without npm or a registry."""
        folder = build / "tests/page_npm"
        if reason := npm_packages.missing(HERE, folder):
            self.skipTest(reason)
        return (folder / "node_modules/axe-core/axe.min.js").read_text()
