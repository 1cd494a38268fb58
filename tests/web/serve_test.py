#!/usr/bin/env python3
"""`cargobay serve` with its page: who is let in, by names, origins and the token of a file; the
newest state, and none of a loop that has ended.
usage: serve_test.py COMMAND"""
import json
import os
import stat
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.request

COMMAND = None


class Serve(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="cargobay-serve-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def serve(self, *options, port=None):
        environment = {**os.environ, "CARGOBAY_FEED_DIR": os.path.join(self.folder, "feeds")}
        environment.pop("CARGOBAY_TOKEN", None)
        words = ["--port", port] if port else []
        server = subprocess.Popen(
            [COMMAND, "serve", "--http", "127.0.0.1:0", "--config", "/dev/null", "--learnt", "none",
             *words, *options], stdout=subprocess.PIPE, text=True, env=environment)
        self.addCleanup(self.end, server)
        line = server.stdout.readline().split()
        self.assertEqual(line[:1], ["serving"])
        self.url = line[1].split("login")[0].rstrip("/")
        return line[1]

    def end(self, process):
        if process.poll() is None:
            process.terminate()
        process.communicate(timeout=30)

    def status(self, path, **headers):
        request = urllib.request.Request(
            self.url + path, headers={key.replace("_", "-"): value for key, value in headers.items()})
        try:
            with urllib.request.urlopen(request, timeout=30) as answer:
                return answer.status, answer.read().decode()
        except urllib.error.HTTPError as error:
            return error.code, error.read().decode()

    def until(self, condition, what):
        deadline = time.monotonic() + 30
        while not condition():
            self.assertLess(time.monotonic(), deadline, what)
            time.sleep(0.05)

    def test_answers_to_the_names_and_pages_it_is_told(self):
        self.serve("--name", "robot.example", "--name", "other.example",
                   "--origin", "https://app.example")
        for name in ("robot.example", "other.example"):
            self.assertEqual(self.status("/", Host=name)[0], 200, name)
        self.assertEqual(self.status("/", Host="third.example")[0], 403)
        self.assertNotEqual(self.status("/", Origin="https://app.example")[0], 403)
        self.assertEqual(self.status("/", Origin="https://third.example")[0], 403)

    def test_lets_in_on_this_machine_who_has_read_the_file(self):
        path = os.path.join(self.folder, "token")
        link = self.serve("--token-file", path)
        with open(path, encoding="ascii") as file:
            token = file.read().strip()
        self.assertEqual(stat.S_IMODE(os.stat(path).st_mode), 0o640)
        self.assertTrue(link.endswith("/login#token=" + token), link)
        self.assertEqual(self.status("/api/state")[0], 401)
        self.assertEqual(self.status("/api/state", Authorization="Bearer " + token[:-1] + "_")[0], 401)
        self.until(lambda: self.status("/api/state", Authorization="Bearer " + token)[0] == 200,
                   "a state")

    def test_has_no_state_of_a_loop_that_has_ended(self):
        port = os.path.join(self.folder, "create")
        simulator = subprocess.Popen([COMMAND, "sim", "--link", port], stdout=subprocess.PIPE,
                                     text=True)
        self.addCleanup(self.end, simulator)
        self.assertIn("listening", simulator.stdout.readline())
        self.serve(port=port)
        self.until(lambda: self.status("/api/state")[0] == 200, "a state")
        self.assertEqual(json.loads(self.status("/api/state")[1])["type"], "state")
        simulator.kill()
        self.until(lambda: self.status("/api/state")[0] == 503, "no state")
        for _ in range(20):
            code, text = self.status("/api/state")
            self.assertEqual(code, 503)
            self.assertTrue(text.strip())


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    COMMAND = sys.argv.pop(1)
    unittest.main()
