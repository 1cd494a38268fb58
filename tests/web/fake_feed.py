"""A feed for tests: a Unix socket that sends messages as docs/feed.md has them, and notes requests."""
import json
import os
import socket
import threading
import time

HELLO = {"type": "hello", "seq": 1, "feed": 1, "cargobay": "0", "program": "fake", "pid": os.getpid(),
         "port": "/dev/fake", "baud": 57600, "robot": "virtual Create", "steerable": True,
         "wheel_base_mm": 258.0, "max_speed_mm_s": 500, "tick_s": 0.015, "setpoint_lapse_s": 0.5,
         "lease_s": 2.0}
WORLD = {"type": "world", "seq": 2, "walls": [{"x1_mm": 0, "y1_mm": 0, "x2_mm": 1000, "y2_mm": 0}],
         "boxes": [], "posts": [], "cliffs": [], "virtual_walls": [], "home_base": None,
         "robot_radius_mm": 165}


class FakeFeed:
    """Listens at `path`; each client gets HELLO, WORLD, and a tick's messages each `period_s`."""

    def __init__(self, path, period_s=0.015):
        self.path, self.period_s = path, period_s
        self.requests = []  # (number of the client, line)
        self.gone = []  # numbers of clients that closed, with the time
        self.sent = {}  # number of the client: lines
        self.ending = False
        self.clients = []
        self.lock = threading.Lock()
        self.listener = socket.socket(socket.AF_UNIX)
        self.listener.bind(path)
        self.listener.listen(128)
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while True:
            try:
                client, _ = self.listener.accept()
            except OSError:
                return
            with self.lock:
                number = len(self.clients)
                self.clients.append(client)
                self.sent[number] = []
            threading.Thread(target=self.read, args=(number, client), daemon=True).start()
            threading.Thread(target=self.write, args=(number, client), daemon=True).start()

    def read(self, number, client):
        try:
            for line in client.makefile("rb"):
                with self.lock:
                    self.requests.append((number, line.decode()))
                try:
                    request = json.loads(line)
                except ValueError:
                    continue
                if isinstance(request, dict) and "id" in request:
                    answer = {"type": "answer", "id": request["id"], "ok": True}
                    if request.get("do") == "hold":
                        answer["result"] = {"lease": 1}
                    client.sendall(json.dumps(answer).encode() + b"\n")
        except (OSError, ValueError):
            pass
        self.gone.append((number, time.monotonic()))
        client.close()

    def messages(self, tick):
        time_s = tick * 0.015
        speeds = {"left": 100.125, "right": 1 / 3}
        yield {"type": "state", "seq": 3 * tick + 3, "tick": tick, "robot_time_s": time_s,
               "unix_time_s": 1.7e9 + time_s, "mode": "safe", "set_mm_s": speeds,
               "estimate_mm_s": speeds, "pose": {"x_mm": tick * 1.5, "y_mm": 0.1, "heading_rad": 0.0},
               "battery_mv": 16000}
        yield {"type": "sensors", "seq": 3 * tick + 4, "tick": tick, "robot_time_s": time_s, "wall": False}
        yield {"type": "truth", "seq": 3 * tick + 5, "time_s": time_s,
               "pose": {"x_mm": tick * 1.5, "y_mm": 0, "heading_deg": 0}, "wheel_mm_s": speeds}
        if tick % 20 == 0:
            yield {"type": "statistics", "seq": 0, "unsent": tick, "frames": {"good": tick}}
            yield {"type": "event", "seq": 0, "sequence": tick, "what": "bump_began", "tick": tick,
                   "robot_time_s": time_s, "text": "bump, left"}
            yield {"type": "holder", "seq": 0, "name": "Ada", "lease": 1}
            yield {"type": "status", "seq": 0, "stage": "driving", "text": "driving"}
            yield {"type": "virtual_create", "seq": 0, "state": {"powered": True}}
            yield {"type": "missed", "messages": 1}

    def write(self, number, client):
        tick = 0
        try:
            for message in (HELLO, WORLD):
                self.send(number, client, message)
            while not self.ending:
                for message in self.messages(tick):
                    self.send(number, client, message)
                tick += 1
                time.sleep(self.period_s)
        except OSError:
            pass

    def send(self, number, client, message):
        line = json.dumps(message, separators=(",", ":"))
        self.sent[number].append(line)
        client.sendall(line.encode() + b"\n")

    def end(self):
        """Closes everything, as a process that dies."""
        self.ending = True
        self.listener.close()
        os.unlink(self.path)
        for client in self.clients:
            try:
                client.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
