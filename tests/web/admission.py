"""Whom cargobay-web lets in, and what it refuses to serve with: a part of hostile_test.py."""

import os
import shutil
import subprocess
import tempfile
import unittest

import web_case
from web_case import WebTest
from web_client import WebSocket


class Beyond(WebTest):
    """Outside the loopback."""

    def listen(self):
        return "0.0.0.0:0"

    def test_makes_a_token_and_asks_for_it(self):
        token = self.server.token
        self.assertRegex(token, "^[0-9a-f]{32}$")
        for wrong in ("", token[1:], token + "0", "0" * 32, token.upper() + "x"):
            for headers in ({"Cookie": f"cargobay_{self.server.port}={wrong}"},
                            {"Authorization": f"Bearer {wrong}"}):
                self.assertEqual(self.get("/api/state", **headers)[0], 401)
                self.assertEqual(self.get("/", **headers)[0], 401)
                self.assertEqual(WebSocket(self.server, **headers).status, 401)
            self.assertEqual(self.get(f"/api/state?token={wrong}")[0], 401)
            self.assertEqual(self.get(f"/?token={wrong}")[0], 401)
            self.assertEqual(WebSocket(self.server, f"/api/feed?token={wrong}").status, 401)
            self.assertEqual(
                WebSocket(self.server, f"/foxglove?token={wrong}", "foxglove.websocket.v1").status,
                401)
            self.assertEqual(self.server.request("/login", "POST", b"token=" + wrong.encode())[0],
                             401)
        self.assertEqual(self.requests(), [])
        self.assertEqual(len(self.feed.clients), 1)

    def test_lets_in_by_link_once_then_by_cookie(self):
        token = self.server.token
        status, headers, _ = self.get(f"/?token={token}")
        self.assertEqual((status, headers["location"]), (303, "/"))
        self.assertIn("HttpOnly", headers["set-cookie"])
        self.assertIn("SameSite=Strict", headers["set-cookie"])
        cookie = headers["set-cookie"].split(";")[0]
        self.assertEqual(self.get("/", Cookie=cookie)[0], 200)
        self.assertEqual(WebSocket(self.server, Cookie=cookie).status, 101)
        self.assertEqual(WebSocket(self.server, Authorization=f"Bearer {token}").status, 101)
        self.assertEqual(WebSocket(self.server, f"/api/feed?token={token}").status, 101)
        # What the page of a link with a fragment does.
        self.assertEqual(self.get("/login.js")[0], 200)
        status, headers, _ = self.server.request("/login", "POST", b"token=" + token.encode())
        self.assertEqual((status, headers["set-cookie"].split(";")[0]), (303, cookie))

    def test_warns_that_it_is_not_encrypted(self):
        self.assertEqual(self.server.end(), 0)
        self.assertIn("not encrypted", self.server.errors)


class Token(WebTest):
    env = {"CARGOBAY_TOKEN": "from-the-environment"}

    def test_can_be_asked_for_on_the_loopback_too(self):
        self.assertEqual(self.server.token, "from-the-environment")
        self.assertEqual(self.get("/api/state")[0], 401)
        self.assertNotEqual(self.get("/api/state", Authorization="Bearer from-the-environment")[0],
                            401)


class TokenOption(WebTest):
    options = ("--token", "in-the-arguments")

    def test_cannot_be_read_by_others(self):
        with open(f"/proc/{self.server.process.pid}/cmdline", "rb") as arguments:
            self.assertNotIn(b"in-the-arguments", arguments.read())
        self.assertEqual(self.server.token, "in-the-arguments")


class Encrypted(WebTest):
    def setUp(self):
        self.keys = tempfile.mkdtemp()
        pem = os.path.join(self.keys, "both.pem")
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt",
                        "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2", "-subj",
                        "/CN=localhost", "-keyout", pem, "-out", pem + ".crt"],
                       check=True, capture_output=True)
        with open(pem, "ab") as both, open(pem + ".crt", "rb") as certificate:
            both.write(certificate.read())
        self.options = ("--cert", pem)
        super().setUp()

    def tearDown(self):
        super().tearDown()
        shutil.rmtree(self.keys)

    def listen(self):
        return "0.0.0.0:0"

    def test_serves_and_does_not_warn(self):
        token = self.server.token
        status, headers, _ = self.get(f"/?token={token}")
        self.assertEqual(status, 303)
        self.assertIn("; Secure", headers["set-cookie"])
        socket = WebSocket(self.server, Cookie=headers["set-cookie"].split(";")[0],
                           Origin=f"https://127.0.0.1:{self.server.port}")
        self.assertEqual(socket.status, 101)
        self.assertEqual([socket.receive()[0] for _ in range(100)], [1] * 100)
        self.assertEqual(self.server.end(), 0)
        self.assertEqual(self.server.errors, "")


class Refused(unittest.TestCase):
    def test_says_what_is_wrong(self):
        for options, words in ((("--http", "robot.local:1"), "numeric"),
                               (("--http", "127.0.0.1:70000"), "port"),
                               (("--http", "192.0.2.1:0"), "cannot listen"),
                               (("--token", "short"), "8 to 128"),
                               (("--cert", "/dev/null", "--http", "0"), "PEM"),
                               (("--nothing",), "--help")):
            done = subprocess.run([web_case.program, "--feed", "/nowhere", *options], capture_output=True,
                                  text=True, timeout=20)
            self.assertNotEqual(done.returncode, 0, options)
            self.assertIn(words, done.stderr, options)
            self.assertEqual(done.stdout, "")
