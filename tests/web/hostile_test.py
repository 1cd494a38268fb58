#!/usr/bin/env python3
"""cargobay-web before clients that mean harm, in front of a feed that notes what reaches it.
usage: hostile_test.py PROGRAM [--frames N]"""
import argparse
import json
import os
import random
import struct
import sys
import time
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import web_case  # noqa: E402
from admission import (  # noqa: E402, F401: parts of this test
    Beyond, Encrypted, Refused, Token, TokenOption)
from fake_feed import FakeFeed  # noqa: E402
from web_case import WebTest, eventually  # noqa: E402
from web_client import WebSocket, frame, read_all  # noqa: E402

FRAMES = 0


def mutated(chance, data, lowest, beyond):
    """With some bytes changed, to one of that range."""
    data = bytearray(data)
    for _ in range(chance.choice((0, 1, 1, 2, 8))):
        data[chance.randrange(len(data))] = chance.randrange(lowest, beyond)
    return bytes(data)


class Loopback(WebTest):
    def test_serves_page_and_state(self):
        status, headers, body = self.get("/")
        self.assertEqual(status, 200)
        self.assertIn(b"</html>", body)
        self.assertEqual(headers["content-type"], "text/html; charset=utf-8")
        self.assertIn("default-src 'self'", headers["content-security-policy"])
        self.assertIn("frame-ancestors 'none'", headers["content-security-policy"])
        self.assertEqual(headers["x-content-type-options"], "nosniff")
        self.assertEqual(headers["referrer-policy"], "no-referrer")
        self.assertNotIn("server", headers)
        self.assertTrue(eventually(lambda: self.get("/api/state")[0] == 200))
        status, headers, body = self.get("/api/state")
        self.assertEqual(headers["cache-control"], "no-store")
        self.assertEqual(json.loads(body)["type"], "state")
        status, headers, body = self.get("/", method="HEAD")
        self.assertEqual((status, body), (200, b""))

    def test_pipes_lines_both_ways(self):
        socket = WebSocket(self.server)
        self.assertEqual(socket.status, 101)
        received = [socket.receive() for _ in range(50)]
        self.assertEqual({opcode for opcode, _ in received}, {1})
        number = max(self.feed.sent)
        self.assertEqual([payload.decode() for _, payload in received],
                         self.feed.sent[number][:50])
        socket.send('{"do":"stop","id":"x"}')
        self.assertTrue(eventually(lambda: self.requests() == ['{"do":"stop","id":"x"}\n']))
        while b'"answer"' not in socket.receive()[1]:
            pass
        # In fragments, with a ping between.
        socket.send('{"do":', fin=False)
        socket.send("p", 9)
        socket.send('"stop"}', 0)
        self.assertTrue(eventually(lambda: self.requests()[1:] == ['{"do":"stop"}\n']))

    def test_refuses_other_hosts(self):
        for host in ("evil.example", f"evil.example:{self.server.port}", "10.0.0.1", "", None):
            self.assertEqual(self.get("/", Host=host)[0], 403, host)
            self.assertEqual(self.get("/api/state", Host=host)[0], 403, host)
            self.assertEqual(WebSocket(self.server, Host=host).status, 403, host)
        self.assertEqual(self.requests(), [])
        self.assertEqual(len(self.feed.clients), 1)

    def test_refuses_other_origins(self):
        for origin in ("http://evil.example", "null", "http://127.0.0.1:1", "file://",
                       f"https://127.0.0.1:{self.server.port}"):
            for path, protocol in (("/api/feed", None), ("/foxglove", "foxglove.websocket.v1")):
                self.assertEqual(WebSocket(self.server, path, protocol, Origin=origin).status, 403)
            self.assertEqual(self.get("/api/state", Origin=origin)[0], 403)
            self.assertEqual(self.server.request("/login", "POST", b"token=x", Origin=origin)[0], 403)
        self.assertEqual(len(self.feed.clients), 1)
        own = f"http://127.0.0.1:{self.server.port}"
        self.assertEqual(WebSocket(self.server, Origin=own).status, 101)

    def test_refuses_hostile_handshakes(self):
        for head in (b"", b"\r\n\r\n", b"GET\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n", b"\0" * 100,
                     b"BREW / HTTP/1.1\r\nHost: localhost\r\n\r\n",
                     b"CONNECT localhost:22 HTTP/1.1\r\nHost: localhost\r\n\r\n",
                     b"GET http://evil.example/ HTTP/1.1\r\nHost: localhost\r\n\r\n",
                     b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n",
                     b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: h2c\r\nConnection: Upgrade\r\n"
                     b"HTTP2-Settings: AAMAAABkAAQAAP__\r\n\r\n",
                     b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n",
                     b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: smoke\r\nConnection: Upgrade\r\n\r\n",
                     b"GET /" + b"a" * 10000 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n",
                     b"GET / HTTP/1.1\r\nHost: localhost\r\nX: " + b"a" * 10000 + b"\r\n\r\n",
                     b"GET / HTTP/1.1\r\n" + b"A: b\r\n" * 10000 + b"\r\n",
                     b"GET /../../etc/passwd HTTP/1.1\r\nHost: localhost\r\n\r\n",
                     b"GET /%2e%2e/%00 HTTP/1.1\r\nHost: localhost\r\n\r\n",
                     b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"):
            with self.server.connect(2) as link:
                try:
                    link.sendall(head)
                    answer = read_all(link)
                except (BrokenPipeError, ConnectionResetError):
                    answer = b""
            self.assertNotIn(b"HTTP/1.1 200", answer.split(b"\r\n")[0] if b"Host: localhost\r\n\r\n"
                             not in head else b"", head[:60])
            self.assertNotIn(b"root:", answer)
            self.assertNotIn(b"101 ", answer[:20])
        self.assert_alive()
        for headers in ({"Sec_WebSocket_Version": "8"}, {"Sec_WebSocket_Key": None},
                        {"Connection": None}):
            self.assertNotEqual(WebSocket(self.server, **headers).status, 101, headers)
        self.assertNotEqual(WebSocket(self.server, "/foxglove").status, 101)
        self.assertNotEqual(WebSocket(self.server, "/api/feed", "foxglove.websocket.v1").status, 101)
        self.assertNotEqual(WebSocket(self.server, "/foxglove", "chat").status, 101)
        self.assertEqual(WebSocket(self.server, "/").status, 404)
        self.assertEqual(self.requests(), [])

    def test_bounds_posts(self):
        self.assertEqual(self.server.request("/api/state", "POST", b"x")[0], 405)
        self.assertEqual(self.server.request("/login", "POST", b"x" * 100000)[0], 0)
        self.assertEqual(self.server.request("/", "DELETE")[0], 405)
        self.assert_alive()

    def test_closes_over_oversized_messages(self):
        for send in (lambda s: s.send(b"x" * 4097), lambda s: s.send(b"x" * 70000),
                     lambda s: [s.send(b"x" * 100, 0 if i else 1, fin=False) for i in range(42)]):
            socket = WebSocket(self.server)
            try:
                send(socket)
            except OSError:
                pass
            self.assertIn(socket.until_closed(), (1009, None))
        # Only the head of a frame of 2^62 bytes: nothing is set aside for it.
        before = self.server.memory_kb()
        sockets = [WebSocket(self.server) for _ in range(20)]
        for socket in sockets:
            socket.link.sendall(frame(b"", length=1 << 62) + b"x" * 4000)
        self.assert_alive()
        self.assertLess(self.server.memory_kb() - before, 8000)
        self.assertEqual(self.requests(), [])
        limit = WebSocket(self.server)
        limit.send('{"x":"' + "y" * (4096 - 8) + '"}')
        self.assertTrue(eventually(lambda: len(self.requests()) == 1))

    def test_closes_over_what_is_no_message(self):
        for arguments, codes in (((b"{}\n{}",), (1008, None)), ((b"{}", 2), (1003, None)),
                                 ((b"\xff\xfe",), (1007, None)), ((b"x", 3), (1002, None)),
                                 ((b"x" * 126, 9), (1002, None)), ((b"x", 0), (1002, None)),
                                 ((b"x", 1, True, True, 0x40), (1002, None))):
            socket = WebSocket(self.server)
            socket.send(*arguments)
            self.assertIn(socket.until_closed(), codes, arguments)
        self.assertEqual(self.requests(), [])
        self.assert_alive()

    def test_closes_the_feed_of_a_client_that_goes(self):
        socket = WebSocket(self.server)
        socket.receive()
        self.assertEqual(len(self.feed.clients), 2)
        socket.close()
        self.assertTrue(eventually(lambda: [number for number, _ in self.feed.gone] == [1], 1))
        # One that stays connected, but does not answer: neither pings nor anything else.
        silent = WebSocket(self.server)
        begin = time.monotonic()
        self.assertTrue(eventually(lambda: len(self.feed.gone) == 2, 12))
        self.assertGreater(time.monotonic() - begin, 3)
        silent.close()

    def test_keeps_one_that_answers_pings(self):
        socket = WebSocket(self.server)
        pings, end = 0, time.monotonic() + 8
        while time.monotonic() < end:
            opcode, payload = socket.receive()
            self.assertNotEqual(opcode, 8)
            if opcode == 9:
                pings += 1
                socket.send(payload, 10)
        self.assertGreaterEqual(pings, 2)
        self.assertEqual(self.feed.gone, [])

    def test_stalled_clients_hold_up_nobody(self):
        stalled = [WebSocket(self.server) for _ in range(10)]
        reader = WebSocket(self.server)
        begin, count = time.monotonic(), 0
        while count < 600:
            opcode, payload = reader.receive()
            count += opcode == 1
            if opcode == 9:
                reader.send(payload, 10)
        number = max(self.feed.sent)
        # Nothing lies between the feed and the one who reads.
        self.assertLess(len(self.feed.sent[number]) - count, 200)
        self.assertGreater(time.monotonic() - begin, 1)
        for socket in stalled:
            socket.close()

    def test_bounds_its_clients(self):
        before = self.server.descriptors()
        sockets = [WebSocket(self.server) for _ in range(48)]
        self.assertEqual([socket.status for socket in sockets], [101] * 48)
        self.assertEqual(WebSocket(self.server).status, 503)
        self.assertEqual(self.get("/")[0], 200)
        for socket in sockets:
            socket.close()
        self.assertTrue(eventually(lambda: WebSocket(self.server).status == 101))
        self.assertTrue(eventually(lambda: self.server.descriptors() <= before + 4))

    def test_bounds_handshakes(self):
        # Begun, and never finished.
        slow = [self.server.connect() for _ in range(300)]
        for link in slow:
            link.sendall(b"GET / HTTP/1.1\r\nHo")
        begin = time.monotonic()
        self.assertTrue(eventually(lambda: self.get("/")[0] == 200, 60))
        self.assertLess(self.server.descriptors(), 300)
        for link in slow:
            link.close()
        self.assertTrue(eventually(lambda: self.server.descriptors() < 20))
        self.assertLess(time.monotonic() - begin, 60)

    def test_ends_when_it_is_told(self):
        socket = WebSocket(self.server)
        socket.receive()
        self.server.process.terminate()
        self.assertEqual(socket.until_closed(), 1001)
        self.assertEqual(self.server.process.wait(5), 0)
        self.server.process.stdout.close()
        self.server.process.stderr.close()

    def test_comes_back_with_the_feed(self):
        socket = WebSocket(self.server)
        self.assertTrue(eventually(lambda: self.get("/api/state")[0] == 200))
        self.feed.end()
        self.assertEqual(socket.until_closed(), 1012)
        self.assertTrue(eventually(lambda: self.get("/api/state")[0] == 503))
        self.assertIn(b"error", self.get("/api/state")[2])
        self.feed = FakeFeed(self.feed.path)
        self.assertTrue(eventually(lambda: self.get("/api/state")[0] == 200))
        self.assertEqual(WebSocket(self.server).receive()[0], 1)

    def test_stands_mutated_frames(self):
        if not FRAMES:
            self.skipTest("--frames")
        seeds = (b'{"do":"subscribe","types":["state"]}', b'{"do":"stop"}', b"{}",
                 b'{"op":"subscribe","subscriptions":[{"id":1,"channelId":3}]}',
                 b'{"op":"advertise","channels":[{"id":1,"topic":"/cmd_vel","encoding":"json"}]}',
                 struct.pack("<BI", 1, 1) + b"{}", struct.pack("<BIII", 2, 9, 1, 4) + b"json{}")
        chance = random.Random(1)
        sent, reached, before, checked = 0, 0, None, 0
        attached = len(self.feed.clients)
        while sent < FRAMES:
            foxglove = chance.random() < 0.7
            socket = WebSocket(self.server, "/foxglove" if foxglove else "/api/feed",
                               "foxglove.websocket.v1" if foxglove else None)
            self.assertEqual(socket.status, 101)
            # Feed and clients are of one process here: without a look at it the feed would fall
            # behind, and refuse the server.
            attached += 1
            self.assertTrue(eventually(lambda: len(self.feed.clients) == attached))
            # Whole frames of what is hardly JSON; the last one is no frame any more.
            batch = b""
            for _ in range(chance.randrange(40)):
                binary = foxglove and chance.random() < 0.3
                payload = mutated(chance, chance.choice(seeds), 0 if binary else 32,
                                  256 if binary else 127)
                batch += frame(payload, 2 if binary else chance.choice((1, 1, 1, 1, 9, 10)))
                sent += 1
            last = mutated(chance, frame(chance.choice(seeds), chance.randrange(16)), 0, 256)
            batch += last[:chance.choice((len(last), chance.randrange(len(last) + 1)))]
            sent += 1
            try:
                socket.link.sendall(batch)
                socket.link.shutdown(1)
                read_all(socket.link)
            except OSError:
                pass
            socket.close()
            if sent // 2000 > checked:
                checked = sent // 2000
                self.assert_alive()
                before = before or self.server.memory_kb()
                reached += len(self.feed.requests)
                for line in self.requests():
                    self.assertLessEqual(len(line), 4097)
                self.feed.requests.clear()
                for lines in list(self.feed.sent.values()):
                    lines.clear()
        self.assert_alive()
        some = FRAMES // 50  # that were still whole
        self.assertTrue(eventually(lambda: reached + len(self.feed.requests) > some), reached)
        print(f"{sent} frames, {reached + len(self.feed.requests)} requests reached the feed, "
              f"{self.server.memory_kb() - (before or 0)} KB more")
        self.assertLess(self.server.memory_kb() - (before or 0), 20000)
        self.assertTrue(eventually(lambda: self.server.descriptors() < 20))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--frames", type=int, default=0)
    arguments, rest = parser.parse_known_args()
    web_case.program, FRAMES = os.path.abspath(arguments.program), arguments.frames
    unittest.main(argv=[sys.argv[0], *rest], warnings="ignore")
