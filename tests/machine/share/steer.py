"""A user's controller: steers the robot through the feed of `cargobay serve`, for as long as it lives.
Whatever ends the lease or the feed, it asks again.

usage: steer.py MM_S
"""

import json
import socket
import sys
import time
from pathlib import Path

FOLDER = Path("/run/cargobay")
EVERY_S = 0.1


def steer(speed: float) -> None:
    """Until somebody ends it."""
    path = next((path for path in FOLDER.iterdir() if path.is_socket()), None)
    if path is None:
        raise FileNotFoundError(f"no feed in {FOLDER}")
    with socket.socket(socket.AF_UNIX) as link:
        link.connect(str(path))
        lines = link.makefile("rw", newline="\n")

        def ask(**request) -> dict:
            print(json.dumps({"id": 1, **request}), file=lines, flush=True)
            while (message := json.loads(lines.readline()))["type"] != "answer":
                pass
            return message

        ask(do="subscribe", types=["answer"])
        while True:
            answer = ask(do="drive", left_mm_s=speed, right_mm_s=speed)
            if not answer["ok"]:
                print(answer["error"], flush=True)
                ask(do="hold", name="steer", take=True)
            time.sleep(EVERY_S)


def main() -> None:
    while True:
        try:
            steer(float(sys.argv[1]))
        except (OSError, ValueError) as error:
            print(error, flush=True)
            time.sleep(EVERY_S)


main()
