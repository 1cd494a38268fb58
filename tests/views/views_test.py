#!/usr/bin/env python3
"""The command on a terminal, as tmux shows it: live views in windows of several sizes, what is left
when they end, and what terminals get that cannot show one.
usage: views_test.py CARGOBAY [--write] | --self-test; --write keeps what is shown as what should
be, --self-test shows that views which leave something are caught."""

import os
import re
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

from terminal import Terminal

SCREENS = Path(__file__).with_name("screens.txt")
SIZES = [(60, 15), (80, 24), (200, 50)]
# What each view shows once it is under way, and is shown in no other.
# The drive is to survive a machine that stands still.
VIEWS = {"sensors": r"^sensors +([2-9]|\d{2,})\.\d s",
         "drive --duration 900 --guard-deadline 10000": r"^drive +([2-9]|\d{2,})\.\d of 900 s",
         "top": r"^top +([3-9]|\d{2,})\.\d s",
         "teleop": r"^You steer[^\n]*\n[^\n]*\nMode +safe"}
SKIPPED = 77
# With packet 6; in a large window by their whole names.
SEEN_OF_ALL = [*(rf"(cliff {short}|Cliff {name}) 1\b" for short, name in
                 (("L", "Left"), ("FL", "Front Left"), ("FR", "Front Right"), ("R", "Right"))),
               r"(charger|Charging Sources Available) internal_charger"]  # fmt: skip
CLIFFS = ("left", "front_left", "front_right", "right")
HAZARDS = ["bump both", "charger on", *(f"cliff {where} on" for where in CLIFFS),
           "wheeldrop left on", "wheeldrop right on", "wheeldrop caster on",
           *(f"overcurrent {what} on" for what in ("left_wheel", "right_wheel", "ld0", "ld1", "ld2"))]  # fmt: skip
SEEN = ["bumps left, right", "wheel drops left, right, front",
        "low_side_driver_1, low_side_driver_0, low_side_driver_2, right_wheel, left_wheel"]  # fmt: skip


def normal(screen: str, view: str) -> str:
    """What does not depend on the moment: without numbers, and how wide they are."""
    lines = [re.sub(r"-?\d+(\.\d+)?", "#", line).rstrip() for line in screen.splitlines()]
    lines = [re.sub(r" {2,}", "  ", line) for line in lines]
    lines = [re.sub(r"(virtual Create on) .*", r"\1 ...", line) for line in lines]
    # Histograms are what they are.
    lines = [re.sub(r" \[[ .:=+*#-]*\]", " [...]", line) for line in lines]
    if view == "top":
        lines = [line for line in lines if line and not re.match(r" *# ms  #", line)]
    if view.startswith("drive"):
        # Events come when they come, and limits go.
        lines = [*lines[:11], *lines[-1:]]
        lines = [re.sub(r"held by .*", "held by ...", line) for line in lines]
    return "\n".join(lines) + "\n"


def kept() -> dict[str, str]:
    parts = re.split(r"^=== (.*)\n", SCREENS.read_text(), flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2]))


class Test:
    def __init__(self, binary: str, folder: Path):
        self.binary = binary
        self.folder = folder
        self.open: list[Terminal] = []
        self.shown: dict[str, str] = {}
        self.faults: list[str] = []

    def terminal(self, columns: int, rows: int, environment: str = "") -> Terminal:
        terminal = Terminal(columns, rows, self.folder, environment)
        self.open.append(terminal)
        return terminal

    def expect(self, good: bool, what: str) -> None:
        if not good:
            self.faults.append(what)

    def compare(self, name: str, terminal: Terminal, view: str, wanted: dict[str, str]) -> None:
        """What is wanted comes, if not at once: a busy machine draws late."""
        def shown() -> str:
            return normal(terminal.screen(), view)

        try:
            terminal.until(lambda: not wanted or shown() == wanted.get(name), f"what {name} should show")
        except AssertionError:
            self.faults.append(f"{name} shows:\n{shown()}and should:\n{wanted.get(name)}")
        self.shown.setdefault(name, shown())

    def leaves_nothing(self, terminal: Terminal, view: str, grown: bool = False) -> None:
        """The shell's screen is back, with all that was on it, and nothing of the view. In a window
        that has grown meanwhile tmux 3.3 itself keeps rows of the other screen, of `less` too."""
        terminal.prompts()
        everything = terminal.screen("-S", "-")
        self.expect("before the view" in everything, f"{view} wiped what was there:\n{everything}")
        self.expect(grown or not re.search(VIEWS[view], everything, re.MULTILINE),
                    f"{view} left something:\n{everything}")  # fmt: skip
        self.expect(terminal.state() == "0 1", f"{view} leaves the terminal in {terminal.state()}")

    def views_in_windows(self, wanted: dict[str, str]) -> None:
        running = []
        for view in VIEWS:
            for columns, rows in SIZES:
                terminal = self.terminal(columns, rows)
                terminal.type("echo before the view; stty -a > stty.before")
                terminal.type(f"{self.binary} {view}")
                running.append((view, columns, rows, terminal))
        for view, columns, rows, terminal in running:
            terminal.shows(VIEWS[view])
            self.compare(f"{view.split()[0]} {columns}x{rows}", terminal, view, wanted)
        self.resized(running, wanted)
        for view, columns, rows, terminal in running:
            terminal.key("C-c")
        for view, columns, rows, terminal in running:
            self.leaves_nothing(terminal, view, grown=(columns, rows) == SIZES[1])

    def resized(self, running: list, wanted: dict[str, str]) -> None:
        """The smallest becomes the largest, and small again; the middle one small, and in the end
        larger than it began."""
        small, middle, large = SIZES
        for sizes in ({small: large, middle: small}, {small: small, middle: large}):
            chosen = [(view, sizes[columns, rows], terminal)
                      for view, columns, rows, terminal in running if (columns, rows) in sizes]  # fmt: skip
            for _, size, terminal in chosen:
                terminal.resize(*size)
            for view, (columns, rows), terminal in chosen:
                if not wanted:
                    time.sleep(1.0)
                self.compare(f"{view.split()[0]} {columns}x{rows}", terminal, view, wanted)

    def suspended(self) -> None:
        view = "sensors"
        terminal = self.terminal(80, 24)
        terminal.type("echo before the view")
        settings = terminal.run("stty -a")
        terminal.type("clear; echo before the view")
        terminal.type(f"{self.binary} {view}")
        terminal.shows(VIEWS[view])
        terminal.key("C-z")
        terminal.shows("Stopped")
        self.leaves_nothing(terminal, view)
        terminal.type("fg")
        terminal.shows(r"^sensors +\d")
        terminal.key("C-c")
        self.leaves_nothing(terminal, view)
        self.expect(terminal.run("stty -a") == settings, "Ctrl-Z and Ctrl-C change the terminal")

    def killed(self) -> None:
        running = []
        for signal in ["TERM", "SEGV", "ABRT"]:
            for view in VIEWS:
                terminal = self.terminal(80, 24)
                settings = terminal.run("stty -a")
                terminal.type("clear; echo before the view")
                terminal.type(f"{self.binary} {view}")
                running.append((signal, view, terminal, settings))
        for signal, view, terminal, _ in running:
            terminal.shows(VIEWS[view])
            pane = terminal.tmux("display-message", "-p", "#{pane_pid}").strip()
            found = subprocess.run(["pgrep", "-P", pane], capture_output=True, text=True, check=True)
            subprocess.run(["kill", f"-{signal}", *found.stdout.split()], check=True)
        for signal, view, terminal, settings in running:
            self.leaves_nothing(terminal, view)
            now = terminal.run("stty -a")
            self.expect(now == settings, f"SIG{signal} in {view}: stty\n{settings}{now}")

    def colours(self) -> None:
        colour = re.compile(r"\x1b\[[0-9;]*3[0-7]")
        for environment, has in [("", True), ("NO_COLOR=1", False)]:
            terminal = self.terminal(80, 24, environment)
            terminal.type(f"{self.binary} drive --duration 900 --guard-deadline 10000")
            terminal.shows(VIEWS["drive --duration 900 --guard-deadline 10000"])
            found = bool(colour.search(terminal.screen("-e")))
            self.expect(found == has, f"{environment or 'usually'}: colours {found}")
            terminal.key("C-c")
            terminal.prompts()

    def other_terminals(self) -> None:
        """One without another screen gets no delay to read; one with it is switched once."""
        terminal = self.terminal(80, 24, "TERM=vt100")
        terminal.type(f"{self.binary} sensors")
        terminal.shows(r"^sensors +\d")
        terminal.key("C-c")
        terminal.prompts()
        self.expect("$<" not in terminal.screen(), f"TERM=vt100 shows:\n{terminal.screen()}")
        terminal = self.terminal(80, 24)
        terminal.type(f"script -qc '{self.binary} sensors' sent")
        terminal.shows(r"^sensors +\d")
        terminal.key("C-c")
        terminal.prompts()
        sent = (self.folder / "sent").read_bytes()
        for what in (b"\x1b[?1049h", b"\x1b[?1049l"):
            self.expect(sent.count(what) == 1, f"{what!r} is sent {sent.count(what)} times")

    def hazards(self) -> None:
        """Whatever the window is: all bumps, wheel drops and overcurrents are seen in full."""
        control = self.folder / "control"
        serve = subprocess.Popen([self.binary, "sim", "--control", str(control)], text=True,
                                 stdout=subprocess.PIPE)  # fmt: skip
        port = re.search(r"/dev/pts/\d+", serve.stdout.readline()).group(0)
        with socket.socket(socket.AF_UNIX) as peer:
            peer.connect(str(control))
            for line in HAZARDS:
                peer.sendall(line.encode() + b"\n")
                answer = peer.recv(1000).decode()
                self.expect(answer.startswith("ok"), f"{line}: {answer}")
        self.cliffs_of_a_drive(port)
        for columns, rows, packets in [(60, 15, "6"), (80, 24, "6"), (80, 50, "6"), (80, 24, "7,14")]:
            terminal = self.terminal(columns, rows)
            terminal.type(f"{self.binary} sensors --port {port} --packets {packets}")
            terminal.shows(r"^sensors +\d")
            words = " ".join(terminal.screen().split())
            for wanted in SEEN:
                self.expect(wanted in words, f"{columns}x{rows} has no '{wanted}':\n{terminal.screen()}")
            for wanted in SEEN_OF_ALL if packets == "6" else []:
                self.expect(bool(re.search(wanted, words)),
                            f"{columns}x{rows} has no '{wanted}':\n{terminal.screen()}")  # fmt: skip
            terminal.key("C-c")
            terminal.prompts()
        serve.terminate()
        serve.wait()

    def cliffs_of_a_drive(self, port: str) -> None:
        """In Full mode it drives on, and says so in every picture, though not in every frame."""
        terminal = self.terminal(60, 15)
        terminal.type(f"{self.binary} drive --full --drive-on --duration 900 --guard-deadline 10000 --port {port}")
        terminal.shows(r"^Cliffs +left, front left, front right, right$")
        terminal.shows(r"Charger +plugged in")
        pictures = 10
        for _ in range(pictures):
            first = terminal.screen()
            self.expect(bool(re.search(r"^Cliffs +left, front left, front right, right$", first, re.MULTILINE)),
                        f"the drive no longer shows the cliffs:\n{first}")  # fmt: skip
            terminal.until(lambda: terminal.screen() != first, "another picture")
        terminal.key("C-c")
        terminal.prompts()

    def plain(self) -> None:
        terminal = self.terminal(100, 50, "TERM=dumb")
        screen = terminal.run(f"{self.binary} sensors 2>&1 | cat")
        self.expect("OI Mode" in screen, f"no terminal: {screen}")
        terminal.type(f"{self.binary} sensors > out; {self.binary} drive --duration 0.5")
        terminal.shows("Wheel speed")
        terminal.type(f"script -qc '{self.binary} drive --duration 0.5' dumb > out2; echo ov''er")
        terminal.shows("^over$")
        typescript = (self.folder / "dumb").read_text(errors="replace")
        self.expect("\x1b" not in typescript, f"TERM=dumb gets {typescript!r}")

    def lines(self) -> None:
        """Progress stays one line, and advice is broken at words."""
        terminal = self.terminal(60, 15)
        terminal.type(f"clear; {self.binary} calibrate")
        terminal.shows(r"^ +\d+\.\d / [\d.]+ s +speed")
        self.expect(len(re.findall("speed", terminal.screen())) == 1, terminal.screen())
        terminal.key("C-c")
        terminal.prompts()
        terminal.type(f"clear; {self.binary} jitter --channels sleep --duration 5")
        terminal.shows("^measuring, +[0-9]+ %")
        first = terminal.screen()
        terminal.until(lambda: terminal.screen() != first, "progress")
        self.expect(len(re.findall("measuring", terminal.screen())) == 1, terminal.screen())
        terminal.key("C-c")
        terminal.prompts()
        # The clock of a search at each rate: nothing answers a terminal that nobody serves.
        terminal.type(f"clear; {self.binary} drive --port $(readlink -f silent)")
        terminal.shows(r"^\d\.\d s: bring-up: ")
        self.expect(len(re.findall("bring-up", terminal.screen())) == 1, terminal.screen())
        terminal.key("C-c")
        terminal.prompts()
        wide = self.terminal(300, 50)
        words = wide.run(f"{self.binary} doctor | cat").split()
        narrow = self.terminal(60, 200)
        screen = narrow.run(f"{self.binary} doctor")
        self.expect(screen.split() == words, f"a word is broken:\n{screen}")

    def system_calls(self) -> None:
        """A client that reads byte by byte, as libcreate does, needs 103 a frame of these 20 packets
        (tests/sensors_cost)."""
        most = 6.0
        packets = "7,8,9,10,11,12,13,17,18,19,20,21,22,23,24,25,26,34,35,36"
        out, log = self.folder / "frames", self.folder / "calls"
        serve = subprocess.Popen([self.binary, "sim"], stdout=subprocess.PIPE, text=True)
        port = re.search(r"/dev/pts/\d+", serve.stdout.readline()).group(0)
        with open(out, "w") as frames:
            subprocess.run(
                ["strace", "-f", "-c", "-o", log, "timeout", "-s", "INT", "4", self.binary, "sensors",
                 "--port", port, "--packets", packets, "--json"], stdout=frames, check=False)  # fmt: skip
        serve.terminate()
        serve.wait()
        count = len(out.read_text().splitlines())
        calls = int(re.search(r"(\d+)\s+(\d+ )?\s*total", log.read_text()).group(1))
        start = 900  # of two programs, and the end
        print(f"{calls} system calls for {count} frames")
        self.expect(count > 100 and calls - start < most * count,
                    f"{calls} system calls for {count} frames")  # fmt: skip


# What a view may leave behind, as a shell prints it.
PLANTED = {
    "its picture": r"\nsensors  3.0 s\n",
    "a wiped screen": r"\033[H\033[2J\033[3Jsensors  3.0 s\n\033[H\033[2J\033[3J",
    "its other screen": r"\033[?1049h\nready> \nready> ",
    "no cursor": r"\033[?25l",
}


def self_test(folder: Path) -> int:
    missed = []
    for what, bytes_left in {"nothing": "", **PLANTED}.items():
        test = Test("", folder)
        terminal = test.terminal(80, 24)
        terminal.type("clear; echo before the view")
        terminal.type(f"printf '{bytes_left}'; touch over-{len(missed)}-{len(what)}")
        over = folder / f"over-{len(missed)}-{len(what)}"
        terminal.until(over.exists, "the end of the command")
        terminal.type("")
        test.leaves_nothing(terminal, "sensors")
        terminal.close()
        if bool(test.faults) != (what != "nothing"):
            missed.append(what)
    print(f"missed: {', '.join(missed) or 'none'}")
    return 1 if missed else 0


def main() -> int:
    binary = str(Path(sys.argv[1]).resolve())
    write = sys.argv[2:] == ["--write"]
    lacking = [tool for tool in ("tmux", "strace", "script", "pgrep") if not shutil.which(tool)]
    if lacking:
        print(f"skipped: this machine lacks {', '.join(lacking)}")
        return SKIPPED
    folder = Path(subprocess.run(["mktemp", "-d", "/tmp/cargobay-views-XXXXXX"], check=True,
                                 capture_output=True, text=True).stdout.strip())  # fmt: skip
    os.chdir(folder)
    if sys.argv[1] == "--self-test":
        try:
            return self_test(folder)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
    master, silent = os.openpty()
    os.symlink(os.ttyname(silent), "silent")
    test = Test(binary, folder)
    try:
        test.views_in_windows({} if write else kept())
        if write:
            SCREENS.write_text("".join(f"=== {name}\n{text}" for name, text in test.shown.items()))
        for part in (test.suspended, test.killed, test.colours, test.other_terminals, test.hazards,
                     test.plain, test.lines, test.system_calls):  # fmt: skip
            began = time.monotonic()
            part()
            print(f"{part.__name__}: {time.monotonic() - began:.1f} s")
    except AssertionError as fault:
        test.faults.append(str(fault))
    finally:
        for terminal in test.open:
            terminal.close()
        os.close(master)
        shutil.rmtree(folder, ignore_errors=True)
    for fault in test.faults:
        print(fault)
    print(f"{len(test.faults)} faults")
    return 1 if test.faults else 0


if __name__ == "__main__":
    sys.exit(main())
