#!/usr/bin/python3
"""The page in Debian's chromium: it drives a virtual Create by keys and by touch, follows it, shows
what happens, survives its server, stops when nobody looks, and can be used by everybody.

usage: tests/page/page_test.py BUILD [unittest's arguments]
"""

import pathlib
import sys
import unittest

from selenium.webdriver.common.keys import Keys

import page_case
from browser import DESKTOP, PHONE
from loading import Loading  # noqa: F401: a part of this test
from page_case import NEAR_MM, PageTest
from served import until
from showing import Showing  # noqa: F401: a part of this test


class Driving(PageTest):
    def test_by_keys(self):
        browser = self.page()
        browser.steer()
        start = self.feed.now("truth")["pose"]
        browser.key("w", down=True)
        self.moved(start, 300)
        for _ in range(5):  # each picture shows both; they come from different messages
            odometry, truth = browser.both_poses()
            self.assertLessEqual(abs(odometry[0] - truth[0]), NEAR_MM)
            self.assertLessEqual(abs(odometry[1] - truth[1]), NEAR_MM)
        browser.key("w", down=False)
        self.assert_stops("a key was let go")
        self.assert_on_the_map(browser)
        heading = self.feed.now("truth")["pose"]["heading_deg"]
        browser.key(Keys.ARROW_LEFT, down=True)
        until(lambda: 20 < (self.feed.now("truth")["pose"]["heading_deg"] - heading) % 360 < 180,
              "a robot that turned left")
        browser.key(Keys.ARROW_LEFT, down=False)
        self.assert_stops("a key was let go")
        self.assert_on_the_map(browser)
        self.assertEqual(browser.complaints(), [])

    def test_by_touch(self):
        browser = self.page(size=PHONE)
        browser.steer()
        start = self.feed.now("truth")["pose"]
        browser.touch("touchStart", "#stick")
        browser.touch("touchMove", "#stick", down=-0.9)
        self.moved(start, 300)
        browser.touch("touchEnd")
        self.assert_stops("the stick was let go")
        self.assert_on_the_map(browser)
        self.assertEqual(browser.complaints(), [])

    def test_by_gamepad(self):
        browser = self.page()
        browser.run("""
            window.pad = {connected: true, axes: [0, 0], buttons: [{pressed: false},
                          {pressed: false}]};
            navigator.getGamepads = () => [window.pad];
            dispatchEvent(new Event("gamepadconnected"));""")
        browser.steer()
        start = self.feed.now("truth")["pose"]
        browser.run("window.pad.axes = [0, -1]")
        self.moved(start, 100)
        browser.run("window.pad.buttons[1].pressed = true")
        self.assert_stops("the gamepad's button")
        until(lambda: self.feed.holder() is None, "a free lease")
        browser.run("window.pad.buttons[1].pressed = false")
        # The stick was never let go: it does nothing until it was.
        browser.steer()
        until(lambda: self.feed.holder(), "a holder")
        self.assertEqual(browser.text("wanted"), "nothing is held")

    def test_keys_do_nothing_without_the_lease(self):
        browser = self.page()
        browser.key("w", down=True)
        self.assertEqual(browser.text("wanted"), "nothing is held")
        self.assertIsNone(self.feed.holder())
        browser.steer()
        browser.click("#release")
        until(lambda: self.feed.holder() is None, "a lease that was given back")


class Stopping(PageTest):
    def drive(self, browser):
        self.control("place 500 1500 0")  # there is room ahead
        browser.steer()
        browser.key("w", down=True)
        self.moved(self.feed.now("truth")["pose"], 60)
        return browser

    def test_by_escape_space_and_button(self):
        for stop in (lambda page: page.key(Keys.ESCAPE, down=True),
                     lambda page: page.key(Keys.SPACE, down=True),
                     lambda page: page.click("#stop")):
            browser = self.drive(self.page())
            stop(browser)
            self.assert_stops("a stop")
            until(lambda: self.feed.holder() is None, "a free lease")

    def test_from_a_page_that_does_not_steer(self):
        self.drive(self.page())
        other = self.page_of_its_own(size=PHONE)
        self.assertIn("steers", other.text("holder"))
        other.click("#stop")
        self.assert_stops("another page's stop")
        until(lambda: self.feed.holder() is None, "a free lease")

    def test_when_the_window_is_no_longer_looked_at(self):
        browser = self.drive(self.page())
        browser.run("dispatchEvent(new Event('blur'))")
        self.assert_stops("a blur")
        self.assertIsNotNone(self.feed.holder())

    def test_when_the_end_of_a_key_may_not_be_heard(self):
        for what in ("new Event('contextmenu')", "new Event('dragstart')",
                     "new KeyboardEvent('keydown', {key: 'Meta', metaKey: true})"):
            browser = self.drive(self.page())
            browser.run(f"dispatchEvent({what})")
            self.assert_stops(what)
            self.assertEqual(browser.text("wanted"), "nothing is held")
            self.assertIsNotNone(self.feed.holder())

    def test_while_the_lease_is_asked_for(self):
        browser = self.page()
        browser.run("for (const id of ['hold', 'stop']) document.getElementById(id).click()")
        until(lambda: browser.text("alert") == "Stopped.", "a stop")
        until(lambda: browser.text("holder") == "nobody steers", "a page that does not steer")
        self.assertIsNone(self.feed.holder())

    def test_when_nothing_answers(self):
        browser = self.drive(self.page())
        browser.run("""window.swallowed = [];
            WebSocket.prototype.send = (text) => window.swallowed.push(JSON.parse(text).do);""")
        self.assert_stops("a network that swallows all")
        until(lambda: browser.text("wanted") == "nothing is held", "a page that has given up")
        # Delivered later, they end with this, and take no lease.
        swallowed = browser.run("return window.swallowed")
        self.assertEqual(swallowed[-1], "release")
        self.assertNotIn("hold", swallowed)

    def test_when_the_tab_is_hidden(self):
        browser = self.drive(self.page_of_its_own())
        browser.driver.switch_to.new_window("tab")
        self.assert_stops("the tab was hidden")
        until(lambda: self.feed.holder() is None, "a free lease")

    def test_when_the_tab_is_closed(self):
        browser = self.drive(self.page_of_its_own())
        page = browser.driver.current_window_handle
        browser.driver.switch_to.new_window("window")
        other = browser.driver.current_window_handle
        browser.driver.switch_to.window(page)
        browser.driver.close()
        browser.driver.switch_to.window(other)
        self.assert_stops("the tab was closed")
        until(lambda: self.feed.holder() is None, "a free lease")

    def test_when_a_touch_is_cancelled(self):
        browser = self.page(size=PHONE)
        browser.steer()
        browser.touch("touchStart", "#stick")
        browser.touch("touchMove", "#stick", down=-0.9)
        self.moved(self.feed.now("truth")["pose"], 60)
        browser.touch("touchCancel")
        self.assert_stops("a touch was cancelled")


class Lease(PageTest):
    def test_is_taken_explicitly_and_from_whom_is_said(self):
        browser = self.page()
        self.assertTrue(self.feed.ask({"do": "hold", "name": "Ada"})["ok"])
        until(lambda: browser.text("hold") == "Take it from Ada", "from whom it takes")
        browser.click("#hold")
        until(lambda: browser.text("holder") == "you steer", "a page that steers")
        self.assertNotEqual(self.feed.holder(), "Ada")

    def test_taken_by_another_one_ends_the_steering(self):
        browser = self.page()
        browser.steer()
        browser.key("w", down=True)
        self.assertTrue(self.feed.ask({"do": "hold", "name": "Ada", "take": True})["ok"])
        until(lambda: browser.text("holder") == "Ada steers", "who steers")
        self.assertEqual(browser.text("alert"), "Ada steers now.")
        self.assertEqual(browser.text("wanted"), "nothing is held")
        self.assert_stops("the lease was taken")

    def test_taken_by_one_of_the_same_name_ends_the_steering(self):
        """Two tabs of a browser have one name."""
        for held in (True, False):
            browser = self.page()
            browser.steer()
            name = self.feed.holder()
            if held:
                browser.key("w", down=True)
                self.moved(self.feed.now("truth")["pose"], 30)
            self.assertTrue(self.feed.ask({"do": "hold", "name": name, "take": True})["ok"])
            until(lambda: browser.text("alert") == f"Another {name} steers now.", "who steers")
            self.assertEqual(browser.text("holder"), f"{name} steers")
            self.assertEqual(browser.text("wanted"), "nothing is held")
            self.assert_stops("the lease was taken")
            browser.key("w", down=True)
            self.assertEqual(browser.text("wanted"), "nothing is held")
            self.feed.ask({"do": "stop"})

    def test_is_not_asked_for_again_after_a_stop_by_another_one(self):
        browser = self.page()
        browser.run("""
            window.asked = [];
            const send = WebSocket.prototype.send;
            WebSocket.prototype.send = function (text) {
              window.asked.push(JSON.parse(text).do);
              return send.call(this, text);
            };""")
        browser.steer()
        until(lambda: browser.run("return window.asked").count("drive") > 10, "some renewals")
        self.assertTrue(self.feed.ask({"do": "stop"})["ok"])
        until(lambda: "robot was stopped" in browser.text("alert"), "why it does not steer")
        self.assertEqual(browser.text("holder"), "nobody steers")
        self.assertEqual(browser.run("return window.asked").count("hold"), 1)

    def test_lasts_while_the_page_stands_still(self):
        browser = self.page()
        browser.steer()
        seen = len(self.feed.events)
        tick = self.feed.now("state")["tick"]
        lapse_ticks = 4 * self.feed.newest["hello"]["lease_s"] / 0.015
        until(lambda: self.feed.now("state")["tick"] > tick + lapse_ticks, "some leases' time")
        self.assertEqual(browser.text("holder"), "you steer")
        self.assertIsNotNone(self.feed.holder())
        self.assertFalse(self.happened("setpoint_lapsed", seen))


class Everybody(PageTest):
    def violations(self, browser):
        browser.run("document.querySelectorAll('details').forEach((each) => each.open = true)")
        browser.cdp("Runtime.evaluate", expression=self.axe())
        found = browser.driver.execute_async_script(
            "axe.run({resultTypes: ['violations']}).then(arguments[0])")
        self.assertGreater(len(found["passes"]), 20)
        return [f"{each['id']}: {each['nodes'][0]['html']}" for each in found["violations"]]

    def test_roles_names_and_contrast(self):
        for size in (DESKTOP, PHONE):
            for dark in (False, True):
                with self.subTest(size=size, dark=dark):
                    browser = self.page(size=size, dark=dark)
                    browser.steer()
                    self.control("cliff left on")
                    until(lambda: "cliff left" in browser.text("hazards"), "a hazard")
                    # The frames are read in turns, and one in four has the cliffs.
                    self.assertTrue(all("cliff left" in browser.text("hazards")
                                        for _ in range(20)))
                    self.assertEqual(self.violations(browser), [])
                    self.control("cliff left off")
                    self.assertFalse(browser.run(
                        "return document.documentElement.scrollWidth > innerWidth"))

    def test_the_checker_finds_what_is_planted(self):
        browser = self.page()
        browser.run("""document.querySelector("main").insertAdjacentHTML("beforeend",
            "<section><button></button><p class='planted'>pale</p></section>");
            const pale = document.querySelector(".planted");
            pale.style.color = "#999"; pale.style.background = "#fff";""")
        found = " ".join(self.violations(browser))
        self.assertIn("button-name", found)
        self.assertIn("color-contrast", found)

    def test_who_steers_a_phone_sees_map_stick_and_buttons_at_once(self):
        browser = self.page(size=PHONE)
        browser.steer()
        until(lambda: browser.run("return scrollY") > 0, "a page that shows the map")
        boxes = browser.run("""return ["map", "stick", "rearm", "reset", "stop"].map((id) => {
            const {top, bottom} = document.getElementById(id).getBoundingClientRect();
            return [id, top, bottom]; })""")
        stop = boxes.pop()
        for name, top, bottom in boxes:
            self.assertGreaterEqual(top, 0, name)
            self.assertLessEqual(bottom, stop[1], name)

    def test_the_stop_can_always_be_pressed(self):
        for size in (DESKTOP, PHONE):
            browser = self.page(size=size)
            for where in (0, 0.5, 1):
                top = browser.run("""
                    scrollTo(0, arguments[0] * document.documentElement.scrollHeight);
                    const box = document.getElementById("stop").getBoundingClientRect();
                    return document.elementFromPoint(box.x + box.width / 2, box.y + box.height / 2)
                        ?.id""", where)
                self.assertEqual(top, "stop")


class OnASlowComputer(Driving):
    """The same with a quarter of the processor."""

    slower = 4

    def test_nothing_is_missed(self):
        browser = self.page()
        tick = self.feed.now("state")["tick"]
        until(lambda: self.feed.now("state")["tick"] > tick + 300, "some seconds of drive")
        self.assertEqual(browser.text("gap"), "This page has missed nothing.")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    page_case.build = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main(verbosity=2)
