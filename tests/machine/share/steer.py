"""A user's controller: steers the robot through the feed of `cargobay serve`, for as long as it lives.
Whatever ends the lease or the feed, it asks again, after a while: the robot is seen to stand.

usage: steer.py MM_S FOLDER
"""

import json
import socket
import sys
import time
from pathlib import Path

EVERY_S = 0.1
AGAIN_AFTER_S = 2.0


def steer(speed: float, folder: Path) -> None:
    """Until somebody ends it."""
    path = next((path for path in folder.iterdir() if path.is_socket()), None)
    if path is None:
        raise FileNotFoundError(f"no feed in {folder}")
    with socket.socket(socket.AF_UNIX) as link:
        link.connect(str(path))
        lines = link.makefile("rw", newline="\n")

        def ask(**request) -> dict:
            print(json.dumps({"id": 1, **request}), file=lines, flush=True)
            while (message := json.loads(lines.readline()))["type"] != "answer":
                pass
            return message

        ask(do="subscribe", types=["answer"])
        ask(do="hold", name="steer", take=True)
        while True:
            answer = ask(do="drive", left_mm_s=speed, right_mm_s=speed)
            if not answer["ok"]:
                raise ValueError(answer["error"])
            time.sleep(EVERY_S)


def main() -> None:
    while True:
        try:
            steer(float(sys.argv[1]), Path(sys.argv[2]))
        except (OSError, ValueError) as error:
            print(error, flush=True)
            time.sleep(AGAIN_AFTER_S)


main()
