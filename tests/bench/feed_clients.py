#!/usr/bin/env python3
"""What clients of the feed cost the loop: drives of a virtual Create with and without them.

usage: tests/bench/feed_clients.py [--cargobay PROGRAM] [--clients N] [--seconds S] [--rounds R]
                                   [--websocket] [--cpu CPU]

Each round is a drive without clients, one with N that read everything, and another without: the two
without say what differs by chance. Prints the medians over the rounds, and their ratios. Needs the
machine for itself. --websocket: a `serve` that holds the robot still, with clients as the page is.
--cpu: the loop is pinned to that CPU, and the clients are kept off it, as if they were elsewhere.
"""

import argparse
import contextlib
import json
import os
import pathlib
import selectors
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests/page"))

from served import Feed, until  # noqa: E402


class Readers(threading.Thread):
    """Clients that read all that comes, until told otherwise."""

    def __init__(self, count, connect):
        super().__init__()
        self.sockets = [connect() for _ in range(count)]
        for client in self.sockets:
            client.setblocking(False)
        self.bytes = 0
        self.over = threading.Event()

    def run(self):
        selector = selectors.DefaultSelector()
        for client in self.sockets:
            selector.register(client, selectors.EVENT_READ)
        while not self.over.is_set():
            for key, _ in selector.select(0.1):
                data = key.fileobj.recv(1 << 16)
                self.bytes += len(data)
                if not data:
                    selector.unregister(key.fileobj)


def connected_to(path):
    client = socket.socket(socket.AF_UNIX)
    client.connect(str(path))
    return client


def web_socket(port):
    """RFC 6455, as far as a client must go that only listens."""
    client = socket.create_connection(("127.0.0.1", port))
    client.sendall(f"GET /api/feed HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
                   "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                   "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n".encode())
    if b" 101 " not in client.recv(64):
        sys.exit("the server refuses the WebSocket")
    return client


@contextlib.contextmanager
def running(command, name, *arguments):
    """Ended, if it still runs by then."""
    words = [command[0], name, *command[1:], *arguments]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield process
        finally:
            process.terminate()
            process.wait()  # before its output is closed, which would end it too


def drive(command, seconds, clients, folder):
    """One drive's report; and how many bytes its clients read."""
    readers = None
    with running(command, "drive", "--duration", str(seconds), "--json", "-") as process:
        if clients:
            feed = until(lambda: next(folder.iterdir(), None), "the drive's feed")
            readers = Readers(clients, lambda: connected_to(feed))
            readers.start()
        out, _ = process.communicate()
    if readers:
        readers.over.set()
        readers.join()
    if process.returncode != 0:
        sys.exit(f"the drive ended with {process.returncode}")
    return json.loads(out), readers.bytes if readers else 0


def serve(command, seconds, clients, folder):
    """The statistics of one `serve`; and how many bytes its clients read."""
    with running(command, "serve", "--http", "127.0.0.1:0") as process:
        port = int(process.stdout.readline().rstrip("/\n").rsplit(":", 1)[1])
        readers = Readers(clients, lambda: web_socket(port))
        readers.start()
        time.sleep(seconds)
        statistics_now = Feed(next(folder.iterdir())).now("statistics")
    readers.over.set()
    readers.join()
    if process.returncode != 128 + signal.SIGTERM:
        sys.exit(f"serve ended with {process.returncode}")
    return statistics_now, readers.bytes


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cargobay", default=str(ROOT / "build/dev/cargobay"))
    parser.add_argument("--clients", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--websocket", action="store_true")
    parser.add_argument("--cpu", type=int)
    options = parser.parse_args()
    command = [options.cargobay]
    if options.cpu is not None:
        command += ["--cpu", str(options.cpu)]
        os.sched_setaffinity(0, os.sched_getaffinity(0) - {options.cpu})
    run = serve if options.websocket else drive
    kinds = ("without", "with", "without again")
    figures = {kind: {} for kind in kinds}
    read = 0
    for round_number in range(options.rounds):
        for kind in kinds:
            print(f"\rround {round_number + 1} of {options.rounds}: {kind} clients   ",
                  end="", file=sys.stderr, flush=True)
            clients = options.clients if kind == "with" else 0
            with tempfile.TemporaryDirectory() as folder:
                os.environ.update(CARGOBAY_FEED_DIR=folder, TERM="dumb")
                report, more = run(command, options.seconds, clients, pathlib.Path(folder))
            read += more
            for what in ("period_ns", "frame_to_command_ns"):
                for percentile in ("p50", "p99"):
                    name = f"{what[:-3].replace('_', ' ')} {percentile}"
                    figures[kind].setdefault(name, []).append(report[what][percentile])
    print(file=sys.stderr)
    print(f"{options.clients} clients read {read / options.rounds / options.seconds / 1e6:.2f} MB/s"
          f" together; medians of {options.rounds} drives of {options.seconds:g} s")
    print(f"{'us':24}{'without':>12}{'with':>12}{'again':>12}{'with/without':>14}{'A/A':>8}")
    for name in figures["without"]:
        a, b, c = (statistics.median(figures[kind][name]) / 1000 for kind in kinds)
        print(f"{name:24}{a:12.1f}{b:12.1f}{c:12.1f}{2 * b / (a + c):14.3f}{c / a:8.3f}")


if __name__ == "__main__":
    main()
