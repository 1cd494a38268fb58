#!/usr/bin/env python3
"""Clients of `cargobay serve` that come, go, stall, talk nonsense and vanish, for as long as wanted:
its memory stays what it was, and each client can tell what it missed.

usage: tests/campaign/come_and_go.py [BUILD] [--minutes M] [--clients N] [--seed S]

Prints a line each minute, and a table at the end. Exit 1 if memory grew, descriptors were left
open, a message was lost without `missed`, or a program ended.
"""

import argparse
import json
import os
import pathlib
import random
import re
import socket
import statistics
import struct
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path += [str(ROOT / "tests/page"), str(ROOT / "tests/web")]
from served import Served  # noqa: E402
from web_client import WebSocket  # noqa: E402

WARM_UP = 0.2  # of the time: what is set aside once, and kept
GROWTH_KB = 1024  # from the median of the first third after it to that of the last
NONSENSE = (b"{}\n", b"\n", b"[1]\n", b'{"do":"fly","id":1}\n', b'{"do":\n', b"\xff\xfe\n",
            b'{"do":"drive","left_mm_s":1e400,"right_mm_s":0,"id":2}\n')


class Account:
    """What one client got: numbers that are missing must be those it was told of."""

    def __init__(self):
        self.last = self.gaps = self.missed = self.messages = 0

    def take(self, line):
        self.messages += 1
        # As the feed writes them; of whole messages only the few that matter are parsed.
        if line.startswith(b'{"type":"missed"'):
            self.missed += json.loads(line)["messages"]
            return
        found = re.search(rb'"seq":(\d+)', line)
        if not found:
            return
        sequence = int(found[1])
        if self.last and sequence > self.last:
            self.gaps += sequence - self.last - 1
        self.last = max(self.last, sequence)

    def right(self):
        return self.gaps == self.missed


class Local:
    """On the feed's own socket."""

    def __init__(self, herd):
        self.link = socket.socket(socket.AF_UNIX)
        self.link.settimeout(20)
        self.link.connect(herd.socket)
        self.rest = b""

    def lines(self):
        data = self.link.recv(1 << 16)
        if not data:
            raise ConnectionError("closed")
        *lines, self.rest = (self.rest + data).split(b"\n")
        return lines

    def send(self, data):
        self.link.sendall(data)


class Web:
    """As the page does."""

    PATH, PROTOCOL = "/api/feed", None

    def __init__(self, herd):
        self.socket = WebSocket(herd, self.PATH, self.PROTOCOL)
        if self.socket.status != 101:
            raise ConnectionError(f"handshake: {self.socket.status}")
        self.link = self.socket.link
        self.link.settimeout(20)

    def lines(self):
        opcode, payload = self.socket.receive()
        if opcode == 9:
            self.socket.send(payload, 10)
            return []
        if opcode == 8:
            raise ConnectionError("closed")
        return [payload]

    def send(self, data):
        self.socket.send(data.strip())


class Foxglove(Web):
    PATH, PROTOCOL = "/foxglove", "foxglove.websocket.v1"


class Herd:
    def __init__(self, served, seed):
        self.served = served
        self.host, port = served.url.split("/")[2].split(":")
        self.port = int(port)
        self.socket = str(next(path for path in pathlib.Path(served.folder.name).iterdir()
                               if path.is_socket()))
        self.seed = seed
        self.over = threading.Event()
        self.lock = threading.Lock()
        self.counts = {}
        self.faults = []

    def connect(self, timeout=10):  # for WebSocket
        return socket.create_connection((self.host, self.port), timeout)

    def count(self, what, number=1):
        with self.lock:
            self.counts[what] = self.counts.get(what, 0) + number

    def read_for(self, client, account, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end and not self.over.is_set():
            for line in client.lines():
                account.take(line)

    def stay(self, client, chance, account):
        self.read_for(client, account, chance.uniform(2, 30))

    def stall(self, client, chance, account):
        self.read_for(client, account, 1)
        self.over.wait(chance.uniform(2, 25))
        # What had waited comes first; with it, how much did not.
        self.read_for(client, account, 3)
        self.count("stalled and caught up")

    def stall_and_go(self, client, chance, account):
        self.over.wait(chance.uniform(2, 15))

    def talk_nonsense(self, client, chance, account):
        for _ in range(chance.randrange(1, 40)):
            client.send(chance.choice(NONSENSE))
            self.read_for(client, account, 0.05)

    def steer_and_go(self, client, chance, account):
        client.send(b'{"do":"hold","name":"one of many","take":true}\n')
        for _ in range(20):
            client.send(b'{"do":"drive","left_mm_s":60,"right_mm_s":-60}\n')
            self.read_for(client, account, 0.1)

    def vanish(self, client, chance, account):
        self.read_for(client, account, chance.uniform(0, 2))
        client.link.sendall(b'{"do"' if isinstance(client, Local) else b"\x81\xfe")
        if not isinstance(client, Local):
            client.link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))

    def one_after_another(self, number):
        chance = random.Random(self.seed * 1000 + number)
        behaviours = (self.stay, self.stay, self.stall, self.stall_and_go, self.talk_nonsense,
                      self.steer_and_go, self.vanish)
        while not self.over.is_set():
            kind = chance.choice((Local, Local, Web, Web, Foxglove))
            behaviour = chance.choice(behaviours)
            account = Account()
            client = None
            whole = False  # to the end, where all that it missed has been told
            try:
                client = kind(self)
                behaviour(client, chance, account)
                whole = kind is not Foxglove
            except (ConnectionError, TimeoutError, BrokenPipeError) as error:
                # Who talks nonsense or does not answer is sent away; so is who comes while it is full.
                self.count(f"sent away from {kind.__name__.lower()}")
                if kind is Local and behaviour is self.stay:
                    self.faults.append(f"a reader was sent away: {error}")
            finally:
                if client:
                    client.link.close()
            self.count("clients")
            self.count("messages", account.messages)
            self.count("missed, and told", account.missed)
            if whole and not account.right():
                self.faults.append(f"{kind.__name__} {behaviour.__name__}: {account.gaps} messages are missing, "
                                   f"and it was told of {account.missed}")


def children(process):
    with open(f"/proc/{process}/task/{process}/children", encoding="ascii") as file:
        return [int(each) for each in file.read().split()]


def name_of(process):
    return pathlib.Path(f"/proc/{process}/comm").read_text(encoding="ascii").strip()


def memory_kb(process):
    status = pathlib.Path(f"/proc/{process}/status").read_text(encoding="ascii")
    return int(re.search(r"VmRSS:\s+(\d+)", status)[1])


def descriptors(process):
    """What it has open, each as often as it has."""
    folder = f"/proc/{process}/fd"
    found = []
    for each in os.listdir(folder):
        try:
            found.append(re.sub(r"\d{3,}", "N", os.readlink(f"{folder}/{each}")))
        except FileNotFoundError:  # closed meanwhile
            pass
    return sorted(found)


def left_open(before, process):
    """What it has open beyond that; a client that has just gone may still be among it."""
    for _ in range(15):
        left = descriptors(process)
        for each in before:
            if each in left:
                left.remove(each)
        if not left:
            break
        time.sleep(2)
    return left


def grown(samples):
    """By how much, from the first third after the warm-up to the last."""
    kept = samples[int(len(samples) * WARM_UP):]
    third = max(1, len(kept) // 3)
    return statistics.median(kept[-third:]) - statistics.median(kept[:third])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", nargs="?", default=str(ROOT / "build/dev"))
    parser.add_argument("--minutes", type=float, default=60)
    parser.add_argument("--clients", type=int, default=20, help="at a time")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    served = Served(options.build)
    herd = Herd(served, options.seed)
    programs = {name_of(each): each for each in [served.process.pid, *children(served.process.pid)]}
    time.sleep(2)
    before = {name: descriptors(pid) for name, pid in programs.items()}
    samples = {name: [] for name in programs}
    threads = [threading.Thread(target=herd.one_after_another, args=(number,))
               for number in range(options.clients)]
    for thread in threads:
        thread.start()
    begin = time.monotonic()
    said = 0
    faults = herd.faults
    try:
        while time.monotonic() < begin + 60 * options.minutes:
            time.sleep(2)
            for name, pid in programs.items():
                samples[name].append(memory_kb(pid))
            if (time.monotonic() - begin) // 60 > said:
                said += 1
                print(f"{said:3} min: {herd.counts.get('clients', 0)} clients; " + ", ".join(
                    f"{name} {kb[-1]} KB" for name, kb in samples.items()), flush=True)
    except (FileNotFoundError, ProcessLookupError):
        faults.append(f"a program has ended: {served.said()[-500:]}")
    except KeyboardInterrupt:
        print("interrupted")
    herd.over.set()
    for thread in threads:
        thread.join()
    print(f"\n{options.clients} at a time, {(time.monotonic() - begin) / 60:.0f} minutes, "
          f"seed {options.seed}:", ", ".join(f"{what} {number}"
                                             for what, number in sorted(herd.counts.items())))
    print("| program | KB at first | KB at last | grown, KB | descriptors left |\n|---|---|---|---|---|")
    for name, kb in samples.items():
        left = left_open(before[name], programs[name])
        print(f"| {name} | {kb[0]} | {kb[-1]} | {grown(kb):.0f} | {len(left)} |")
        if grown(kb) > GROWTH_KB:
            faults.append(f"{name} has grown by {grown(kb):.0f} KB")
        if left:
            faults.append(f"{name} has these open too: {left}")
    served.close()
    for fault in faults[:20]:
        print("FAULT:", fault)
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
