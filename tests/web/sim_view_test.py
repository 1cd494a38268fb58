#!/usr/bin/env python3
"""`cargobay sim --view`: a page of the simulator, and nothing in the way of who drives its robot.
usage: sim_view_test.py COMMAND"""
import os
import subprocess
import sys
import tempfile
import unittest
import urllib.request

COMMAND = None


class SimView(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="cargobay-view-")
        self.addCleanup(self.folder.cleanup)
        self.port = os.path.join(self.folder.name, "create")
        self.feeds = os.path.join(self.folder.name, "feeds")
        self.environment = {**os.environ, "CARGOBAY_FEED_DIR": self.feeds}
        self.simulator = subprocess.Popen(
            [COMMAND, "sim", "--view", "--http", "127.0.0.1:0", "--link", self.port],
            stdout=subprocess.PIPE, text=True, env=self.environment)
        self.addCleanup(self.end)
        self.assertEqual(self.simulator.stdout.readline(), f"listening on {self.port}\n")
        serving, self.url = self.simulator.stdout.readline().split()
        self.assertEqual(serving, "serving")

    def end(self):
        if self.simulator.poll() is None:
            self.simulator.terminate()
        self.simulator.communicate(timeout=30)

    def run_command(self, *words):
        return subprocess.run([COMMAND, *words, "--port", self.port, "--config", "/dev/null"],
                              capture_output=True, text=True, timeout=60, check=False,
                              env=self.environment)

    def test_serves_the_page(self):
        with urllib.request.urlopen(self.url, timeout=30) as page:
            self.assertIn(b"</html>", page.read())

    def test_its_robot_can_be_read_and_driven_as_any(self):
        sensors = self.run_command("sensors", "--once")
        self.assertEqual(sensors.returncode, 0, sensors.stderr)
        self.assertNotIn("feed", sensors.stderr)
        drive = self.run_command("drive", "--duration", "0.5")
        self.assertEqual(drive.returncode, 0, drive.stderr)
        self.assertNotIn("nobody can watch", drive.stderr)

    def test_who_names_no_port_does_not_get_it(self):
        picture = os.path.join(self.folder.name, "live.svg")
        plot = subprocess.run([COMMAND, "plot", "--live", "-o", picture], capture_output=True,
                              text=True, timeout=60, check=False, env=self.environment)
        self.assertEqual(plot.returncode, 1)
        self.assertIn("nothing publishes a feed here", plot.stderr)

    def test_leaves_no_socket(self):
        self.assertEqual(len(os.listdir(self.feeds)), 1)
        self.end()
        self.assertEqual(self.simulator.returncode, 0)
        self.assertEqual(os.listdir(self.feeds), [])


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    COMMAND = sys.argv.pop(1)
    unittest.main()
