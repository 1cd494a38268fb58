#!/usr/bin/python3
"""The page of `cargobay sim --view`: a virtual Create that another program drives.

usage: tests/page/simulator_test.py BUILD
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from browser import Browser
from served import PATIENCE_S, ROOT, until

build = None  # the folder of the programs


class Simulator(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="cargobay-view-")
        self.addCleanup(folder.cleanup)
        self.environment = {**os.environ, "CARGOBAY_FEED_DIR": folder.name}
        self.process = subprocess.Popen(
            [build / "cargobay", "sim", "--view", "--http", "127.0.0.1:0",
             "--world", ROOT / "examples/worlds/room.world"],
            stdout=subprocess.PIPE, text=True, env=self.environment)
        self.addCleanup(self.process.communicate, timeout=PATIENCE_S)
        self.addCleanup(self.process.terminate)
        words = self.process.stdout.readline().split() + self.process.stdout.readline().split()
        self.assertEqual(words[:2] + words[3:4], ["listening", "on", "serving"], words)
        self.port, self.url = words[2], words[4]

    def test_is_seen_and_handled_while_another_drives_it(self):
        browser = Browser()
        self.addCleanup(browser.close)
        browser.complaints()
        browser.driver.get(self.url)
        until(lambda: browser.text("link") == "simulator", "a page that is connected")
        before = until(lambda: browser.pose("truth"), "a robot on the map")
        self.assertEqual(browser.text("holder"), "only cargobay serve can be steered")
        for line in ("bump both", "bump none"):
            browser.click(f"[data-line='{line}']")
            until(lambda: browser.text("control-answer") == f"{line}: ok", line)
        self.assertTrue(browser.find("#drag").is_displayed())
        drive = subprocess.run(
            [build / "cargobay", "drive", "--port", self.port, "--duration", "3",
             "--learnt", "none", "--guard-deadline", "10000"],
            capture_output=True, text=True, env=self.environment, check=False)
        self.assertEqual(drive.returncode, 0, drive.stderr)
        self.assertNotIn("nobody can watch", drive.stderr)
        until(lambda: browser.pose("truth") != before, "the robot's way")
        self.assertEqual(browser.complaints(), [])


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    build = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main(verbosity=2)
