"""What the page shows of a robot, and what can be done to a virtual one: a part of page_test.py."""

import re

from page_case import PageTest
from served import ROOT, until


class Showing(PageTest):
    # No client of the feed can bring them about: a control function of a program; another program
    # at the port; counters that fail, which tests/hal has.
    NOT_HERE = {"control_refused", "port_shared", "counters_implausible"}

    def test_each_event(self):
        browser = self.page()
        seen = len(self.feed.events)

        def provoke(what, *lines):
            for line in lines:
                self.control(line)
            until(lambda: self.feed.now("state") and self.happened(what, seen), what)

        provoke("bump_began", "bump left")
        provoke("bump_ended", "bump none")
        provoke("overcurrent_began", "overcurrent ld0 on")
        provoke("overcurrent_ended", "overcurrent ld0 off")
        provoke("battery_low", "battery 1")
        provoke("battery_recovered", "battery 2600")
        provoke("frames_lost", "fault garbled-frame 3")
        provoke("silence_began", "fault stalled-stream 250")
        provoke("silence_ended")
        self.steer_from_here(300, 300)
        provoke("setpoint_lapsed")
        provoke("mode_lost", "wheeldrop left on")
        browser.steer()
        browser.click("#rearm")
        provoke("rearm_failed")
        self.control("wheeldrop left off")
        browser.click("#rearm")
        provoke("rearmed")
        self.control("place 1500 1000 90")
        self.control("stuck left 2000")
        self.steer_from_here(200, -200, lambda: self.happened("wheel_stuck", seen))
        self.control("place 1500 1000 90")
        self.steer_from_here(-500, 500, lambda: self.happened("limit_began", seen))
        self.steer_from_here(0, 0, lambda: self.happened("limit_ended", seen))
        provoke("charging_began", "charger on")
        provoke("charging_ended", "charger off")
        for event in self.feed.events[seen:]:
            until(lambda: [event["what"], event["text"]] in browser.events(), event)
        rows = (ROOT / "hal/sensing/events.cpp").read_text()
        kinds = set(re.findall(r'\{EventKind::\w+, "(\w+)"', rows))
        self.assertGreater(len(kinds), 20)
        self.assertEqual(kinds - self.NOT_HERE, {each["what"] for each in self.feed.events[seen:]})
        self.assertEqual(browser.complaints(), [])

    def test_what_the_robot_feels(self):
        browser = self.page()
        sensors = lambda: browser.text("sensors")
        self.control("bump right")
        until(lambda: "bump right" in sensors(), "the bumper")
        self.control("bump none")
        self.control("ir 242")
        until(lambda: "242" in sensors(), "the infrared byte")
        self.control("ir 255")
        self.control("hold play")
        until(lambda: "play" in sensors(), "the button")
        self.control("release play")
        until(lambda: browser.run("return document.querySelectorAll('#latency-table td')[1]"
                                  ".textContent") not in ("", "–"), "latencies")

    def test_everything_that_can_be_done_to_a_virtual_create(self):
        browser = self.page()
        controls = self.feed.newest["controls"]
        self.assertGreater(len(controls["faults"]), 10)
        legends = browser.run("return [...document.querySelectorAll('#virtual legend')]"
                              ".map((each) => each.textContent)")
        shown = [each["name"] for each in controls["controls"]
                 if each["name"] not in ("fault", "state", "help")]
        shown += [each["name"] for each in controls["faults"]]
        self.assertEqual(legends, [name.replace("-", " ") for name in shown])
        seen = len(self.feed.events)
        browser.click("[data-line='bump both']")
        self.feed.read_until(lambda: "bump_began" in [each["what"] for each in
                                                      self.feed.events[seen:]])
        browser.click("[data-line='bump none']")

    def test_a_virtual_create_is_carried_on_the_map(self):
        browser = self.page()
        browser.click("#drag")
        before = self.feed.standing()["pose"]
        browser.touch("touchStart", "#map")
        browser.touch("touchMove", "#map", right=0.1)
        browser.touch("touchEnd")
        self.moved(before, 60)
        self.assert_on_the_map(browser)
        browser.click("#drag")
