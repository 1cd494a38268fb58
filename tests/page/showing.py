"""What the page shows of a robot, and what can be done to a virtual one: a part of page_test.py."""

import contextlib
import os
import re
import signal
import subprocess

import page_case
from page_case import PageTest
from served import ROOT, Controlled, Feed, until


@contextlib.contextmanager
def thief(port):
    """Another program that reads the robot's port, and so takes bytes from the loop."""
    script = f"exec 3<>{port}; while :; do head -c 5 <&3 >/dev/null; sleep 0.05; done"
    process = subprocess.Popen(["sh", "-c", script], start_new_session=True)
    try:
        yield
    finally:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


class Showing(PageTest):
    # Only root opens a port that another process has.
    NOT_HERE = set() if os.geteuid() == 0 else {"port_shared"}

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
        self.begin_another_loop()  # each reports only the first of what cannot be
        self.control("place 1500 1000 90")
        self.control("plant missed-left 1")
        self.steer_from_here(200, 200, lambda: self.happened("counters_implausible", seen))
        self.control("plant missed-left 0")
        provoke("charging_began", "charger on")
        provoke("charging_ended", "charger off")
        if "port_shared" not in self.NOT_HERE:
            with thief(self.feed.newest["hello"]["port"]):
                provoke("port_shared")
        happened = self.feed.events[seen:]
        for event in happened:
            until(lambda: [event["what"], event["text"]] in browser.events(), event)
        happened.append(self.event_of_a_controller("Wheels(float('nan'), 0.0)"))
        rows = (ROOT / "hal/sensing/events.cpp").read_text()
        kinds = set(re.findall(r'\{EventKind::\w+, "(\w+)"', rows))
        self.assertGreater(len(kinds), 20)
        self.assertEqual(kinds - self.NOT_HERE, {each["what"] for each in happened})
        self.assertEqual(browser.complaints(), [])

    def begin_another_loop(self):
        """The robot is lost for a moment, and brought up again."""
        self.control("fault stalled-stream 1500")
        for stage in ("lost", "driving"):
            self.feed.read_until(lambda: self.feed.newest["status"]["stage"] == stage)

    def event_of_a_controller(self, answer):
        """The first event of a program whose control function answers so, once its page shows it."""
        controlled = Controlled(page_case.build, answer)
        self.addCleanup(controlled.close)
        feed = Feed(controlled.feed)
        self.addCleanup(feed.close)
        feed.read_until(lambda: feed.events)
        self.browser.open(controlled.url)
        event = feed.events[0]
        until(lambda: [event["what"], event["text"]] in self.browser.events(), event)
        return event

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
