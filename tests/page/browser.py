"""Debian's chromium without a screen, on one page."""

import base64
import json
import re

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.remote.command import Command

from served import until

DESKTOP = (1400, 1000)
PHONE = (360, 740)


class Browser:
    def __init__(self, slower=1, arguments=(), logs=("browser",), **appearance):
        options = webdriver.ChromeOptions()
        options.binary_location = "/usr/bin/chromium"
        for argument in ("headless=new", "no-sandbox", "disable-gpu", "disable-dev-shm-usage",
                         f"window-size={DESKTOP[0]},{DESKTOP[1]}", *arguments):
            options.add_argument(f"--{argument}")
        options.set_capability("goog:loggingPrefs", {log: "ALL" for log in logs})
        self.driver = webdriver.Chrome(service=Service("/usr/bin/chromedriver"), options=options)
        self.cdp("Emulation.setCPUThrottlingRate", rate=slower)
        self.appear(**appearance)

    def appear(self, size=DESKTOP, dark=False):
        """As a desktop or a phone, light or dark."""
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        self.cdp("Emulation.setEmulatedMedia", features=[scheme])
        phone = size == PHONE
        self.cdp("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1],
                 deviceScaleFactor=2 if phone else 1, mobile=phone)
        self.cdp("Emulation.setTouchEmulationEnabled", enabled=phone)

    def cdp(self, command, **arguments):
        return self.driver.execute_cdp_cmd(command, arguments)

    def open(self, url):
        self.complaints()  # about pages before this one
        self.driver.get(url)
        until(lambda: self.text("link") == "connected", "a page that is connected")
        until(lambda: self.pose("pose"), "a robot on the map")

    def run(self, script, *arguments):
        return self.driver.execute_script(script, *arguments)

    def text(self, identifier):
        return self.run("return document.getElementById(arguments[0])?.textContent", identifier)

    def find(self, selector):
        return self.driver.find_element("css selector", selector)

    def click(self, selector):
        self.run("document.querySelector(arguments[0]).scrollIntoView({block: 'center'})", selector)
        self.find(selector).click()

    def pose(self, identifier):
        """(x, y, heading) in mm and degrees as the map shows it; None if it shows none."""
        return as_pose(self.text(identifier))

    def both_poses(self):
        """Odometry and truth of the same picture."""
        texts = self.run("return ['pose', 'truth'].map((id) => "
                         "document.getElementById(id).textContent)")
        return [as_pose(text) for text in texts]

    def key(self, key, down):
        actions = ActionChains(self.driver)
        (actions.key_down if down else actions.key_up)(key).perform()

    def touch(self, kind, selector=None, right=0.0, down=0.0):
        """A finger on the element, so far from its middle, in halves of its size."""
        points = []
        if selector:
            box = self.run("const b = document.querySelector(arguments[0]).getBoundingClientRect();"
                           "return [b.x, b.y, b.width, b.height]", selector)
            points = [{"x": box[0] + box[2] * (0.5 + right / 2),
                       "y": box[1] + box[3] * (0.5 + down / 2)}]
        self.cdp("Input.dispatchTouchEvent", type=kind, touchPoints=points)

    def steer(self):
        self.click("#hold")
        until(lambda: self.text("holder") == "you steer", "a page that steers")

    def events(self):
        return self.run("return [...document.querySelectorAll('#events li')]"
                        ".map((item) => [item.dataset.what, item.lastElementChild.textContent])")

    def complaints(self):
        """What its console has said since the last time."""
        return [entry["message"] for entry in self.driver.get_log("browser")
                if entry["level"] in ("SEVERE", "WARNING")]

    def asked_for_by(self):
        """Of each file that was asked for since the last time, what asked for it, as the browser
        has it: another file, or nothing. A browser that keeps the log "performance" knows."""
        askers = {}
        for entry in self.driver.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] != "Network.requestWillBeSent":
                continue
            initiator = message["params"]["initiator"]
            frames = initiator.get("stack", {}).get("callFrames", [])
            asker = initiator.get("url") or (frames[0]["url"] if frames else None)
            askers.setdefault(message["params"]["request"]["url"], asker)
        return askers

    def picture(self, path, height=None):
        """Of the part in view or, with a height, of so much of the page."""
        if height is None:
            self.driver.save_screenshot(str(path))
            return
        width = self.run("return innerWidth")
        shot = self.cdp("Page.captureScreenshot", captureBeyondViewport=True,
                        clip={"x": 0, "y": 0, "width": width, "height": height, "scale": 1})
        with open(path, "wb") as file:
            file.write(base64.b64decode(shot["data"]))

    def leave(self):
        """Lets go of all keys and fingers, and of the page."""
        self.driver.execute(Command.W3C_CLEAR_ACTIONS)
        self.driver.get("about:blank")

    def close(self):
        self.driver.quit()


def as_pose(text):
    found = re.fullmatch(r"x (-?\d+) mm, y (-?\d+) mm, (-?\d+)°", text or "")
    return tuple(int(part) for part in found.groups()) if found else None
