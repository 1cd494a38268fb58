"""cargobay-web in front of a feed that notes what reaches it."""

import os
import shutil
import tempfile
import time
import unittest

from fake_feed import FakeFeed
from web_client import Server

program = None  # set by the test


def eventually(condition, seconds=10):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.01)
    return condition()


class WebTest(unittest.TestCase):
    options = ()
    env = {}

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.feed = FakeFeed(os.path.join(self.folder, "feed"))
        self.server = Server(program, "--feed", self.feed.path, "--http", self.listen(),
                             *self.options, env=self.env)
        self.assertTrue(eventually(lambda: self.feed.clients))

    def listen(self):
        return "127.0.0.1:0"

    def tearDown(self):
        if self.server.process.returncode is None:
            self.assertEqual(self.server.end(), 0)
        self.feed.end()
        shutil.rmtree(self.folder)

    def requests(self):
        """What clients asked of the feed; the server itself asks as number 0."""
        return [line for number, line in self.feed.requests if number != 0]

    def assert_alive(self):
        self.assertIsNone(self.server.process.poll(), "the server is gone")
        self.assertEqual(self.get("/")[0], 200)

    def get(self, path, **headers):
        return self.server.request(path, **headers)
