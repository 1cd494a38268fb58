#!/usr/bin/env python3
"""Foxglove's own client (npm @foxglove/ws-protocol) at cargobay-web: what it gets is what the feed
sent, byte by byte.
usage: foxglove_client_test.py PROGRAM FOLDER
FOLDER: where the npm packages are put. Exit 77 without node, npm, or a registry."""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(os.path.dirname(HERE), "npm")]
import npm_packages  # noqa: E402
from fake_feed import FakeFeed  # noqa: E402
from web_client import Server  # noqa: E402

OWN = ("hello", "status", "state", "sensors", "event", "statistics", "truth", "virtual_create",
       "world", "holder", "missed")
DRAWN = {"/odometry/pose": "foxglove.PoseInFrame", "/odometry/path": "foxglove.PosesInFrame",
         "/tf": "foxglove.FrameTransform", "/log": "foxglove.Log", "/scene": "foxglove.SceneUpdate",
         "/truth/pose": "foxglove.PoseInFrame"}


def install(folder):
    manifests = os.path.join(HERE, "npm")
    if reason := npm_packages.missing(manifests, folder):
        print(reason)
        sys.exit(77)
    shutil.copy(os.path.join(manifests, "client.mjs"), folder)


def check(condition, what):
    if not condition:
        print("FAILED:", what)
        sys.exit(1)


def check_data(seen, sent):
    of_type = {}
    for line in sent:
        of_type.setdefault(json.loads(line)["type"], []).append(line)
    for name in OWN:
        got = [m["text"] for m in seen["messages"] if m["topic"] == "/" + name]
        check(got, f"nothing on /{name}")
        check(all(text in of_type[name] for text in got), f"/{name}: not as the feed sent it")
        # In order, and without gaps from the first on: a client that keeps up loses nothing.
        begin = of_type[name].index(got[0])
        check(of_type[name][begin:begin + len(got)] == got or name in ("hello", "world", "missed",
              "holder", "status", "virtual_create"), f"/{name}: with gaps")
    states = [m for m in seen["messages"] if m["topic"] == "/state"]
    check(len(states) > 50, f"{len(states)} states")
    for message in states:
        want = json.loads(message["text"])["unix_time_s"]
        check(abs(int(message["ns"]) / 1e9 - want) < 1e-6, "the time of a state")
    for topic in DRAWN:
        check([m for m in seen["messages"] if m["topic"] == topic], f"nothing on {topic}")
    poses = [json.loads(m["text"]) for m in seen["messages"] if m["topic"] == "/odometry/pose"]
    xs = {json.loads(m["text"])["pose"]["x_mm"] for m in states}
    check(all(any(abs(p["pose"]["position"]["x"] * 1e3 - x) < 1e-6 for x in xs) for p in poses),
          "/odometry/pose: other than the state's")


def check_rest(seen, requests):
    check(not seen["errors"] and not seen["failures"], seen["errors"] + seen["failures"])
    check({c["topic"] for c in seen["channels"]} == {"/" + n for n in OWN} | set(DRAWN), "channels")
    for channel in seen["channels"]:
        check(DRAWN.get(channel["topic"], channel["schema"]) == channel["schema"], channel)
    check(seen["answers"] == [[7, '{"error":"","ok":true}']], seen["answers"])
    values = {p["name"]: p["value"] for p in seen["parameters"][-1]["parameters"]}
    check(values["wheel_base_mm"] == 258 and values["steer.name"] == "Ada", values)
    check(not seen["status"], seen["status"])
    asked = [json.loads(line) for line in requests]
    hold = [r for r in asked if r["do"] == "hold"]
    drive = [r for r in asked if r["do"] == "drive"]
    check(len(hold) == 1 and hold[0]["name"] == "Ada", asked)
    check(len(drive) == 1 and drive[0]["velocity_mm_s"] == 250 and
          drive[0]["turn_rate_rad_s"] == -0.5, asked)


def main():
    program, modules = sys.argv[1:3]
    install(modules)
    folder = tempfile.mkdtemp()
    feed = FakeFeed(os.path.join(folder, "feed"))
    server = Server(program, "--feed", feed.path, "--http", "127.0.0.1:0")
    try:
        while not feed.clients:  # the first is the server itself
            time.sleep(0.01)
        for protocol in ("foxglove.websocket.v1", "foxglove.sdk.v1"):
            first = len(feed.clients)
            url = f"ws://127.0.0.1:{server.port}/foxglove"
            done = subprocess.run(["node", os.path.join(modules, "client.mjs"), url, protocol],
                                  capture_output=True, text=True, timeout=120)
            check(done.returncode == 0, done.stderr)
            seen = json.loads(done.stdout)
            # What it asked has been read when its connection is at its end.
            end = time.monotonic() + 30
            while first not in [number for number, _ in feed.gone] and time.monotonic() < end:
                time.sleep(0.01)
            check_data(seen, feed.sent[first])
            check_rest(seen, [line for number, line in feed.requests if number == first])
            print(f"{protocol}: {len(seen['messages'])} messages on {len(seen['channels'])} channels")
        return 0 if server.end() == 0 else 1
    finally:
        server.process.kill()
        feed.end()
        shutil.rmtree(folder)


if __name__ == "__main__":
    sys.exit(main())
