#!/usr/bin/env python3
"""What clients of the feed cost the loop: drives of a virtual Create with and without them.

usage: tests/bench/feed_clients.py [--cargobay PROGRAM] [--clients N] [--seconds S] [--rounds R]

Each round is a drive without clients, one with N that read everything, and another without: the two
without say what differs by chance. Prints the medians over the rounds, and their ratios. Needs the
machine for itself.
"""

import argparse
import json
import os
import pathlib
import selectors
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]


class Readers(threading.Thread):
    """Clients that read all that comes, until told otherwise."""

    def __init__(self, path, count):
        super().__init__()
        self.sockets = []
        for _ in range(count):
            client = socket.socket(socket.AF_UNIX)
            client.connect(path)
            client.setblocking(False)
            self.sockets.append(client)
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


def drive(program, seconds, clients):
    """One drive's JSON; and how many bytes its clients read."""
    with tempfile.TemporaryDirectory() as folder:
        environment = dict(os.environ, CARGOBAY_FEED_DIR=folder, TERM="dumb")
        os.chmod(folder, 0o700)
        process = subprocess.Popen(
            [program, "drive", "--duration", str(seconds), "--json", "-"],
            env=environment, stdout=subprocess.PIPE, text=True)
        readers = None
        if clients:
            while not os.listdir(folder):
                if process.poll() is not None:
                    sys.exit("the drive has failed")
                time.sleep(0.01)
            readers = Readers(os.path.join(folder, os.listdir(folder)[0]), clients)
            readers.start()
        out, _ = process.communicate()
        if readers:
            readers.over.set()
            readers.join()
        if process.returncode != 0:
            sys.exit(f"the drive ended with {process.returncode}")
        return json.loads(out), readers.bytes if readers else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cargobay", default=str(ROOT / "build/dev/cargobay"))
    parser.add_argument("--clients", type=int, default=20)
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    kinds = ("without", "with", "without again")
    figures = {kind: {} for kind in kinds}
    read = 0
    for round_number in range(options.rounds):
        for kind in kinds:
            print(f"\rround {round_number + 1} of {options.rounds}: {kind} clients   ",
                  end="", file=sys.stderr, flush=True)
            clients = options.clients if kind == "with" else 0
            report, more = drive(options.cargobay, options.seconds, clients)
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
