"""A terminal of any size, by tmux."""

import re
import subprocess
import time
from pathlib import Path

PATIENCE_S = 60
PROMPT = "ready>"


class Terminal:
    """A shell in a tmux of its own."""

    def __init__(self, columns: int, rows: int, folder: Path, environment: str = ""):
        self.socket = str(folder / f"tmux-{time.monotonic_ns()}")
        # Another's feed is not to be found: `top` would show that robot.
        feeds = f"CARGOBAY_FEED_DIR={self.socket}-feeds"
        shell = f"env -u NO_COLOR {feeds} {environment} PS1='{PROMPT} ' bash --norc --noprofile"
        self.tmux("-f", "/dev/null", "new-session", "-d", "-x", str(columns), "-y", str(rows), shell)
        self.until(lambda: PROMPT in self.screen(), "a prompt")

    def tmux(self, *words: str) -> str:
        command = ["tmux", "-S", self.socket, *words]
        result = subprocess.run(command, capture_output=True, text=True, check=True)
        return result.stdout

    def screen(self, *options: str) -> str:
        return self.tmux("capture-pane", "-p", *options)

    def type(self, text: str) -> None:
        self.tmux("send-keys", "-l", text)
        self.tmux("send-keys", "Enter")

    def key(self, name: str) -> None:
        self.tmux("send-keys", name)

    def resize(self, columns: int, rows: int) -> None:
        self.tmux("resize-window", "-x", str(columns), "-y", str(rows))

    def state(self) -> str:
        """Whether it shows its other screen, and a cursor."""
        return self.tmux("display-message", "-p", "#{alternate_on} #{cursor_flag}").strip()

    def until(self, condition, what: str) -> None:
        limit = time.monotonic() + PATIENCE_S
        while not condition():
            if time.monotonic() > limit:
                raise AssertionError(f"waited for {what} in vain; there is:\n{self.screen()}")
            time.sleep(0.05)

    def shows(self, pattern: str) -> None:
        self.until(lambda: re.search(pattern, self.screen(), re.MULTILINE), pattern)

    def prompts(self) -> None:
        def back() -> bool:
            lines = self.screen().rstrip().splitlines()
            return bool(lines) and lines[-1].strip() == PROMPT

        self.until(back, "the prompt")

    def run(self, command: str) -> str:
        """What a command that ends prints."""
        self.type(f"clear; {command}; echo over: $?")
        self.shows(r"^over: \d+$")
        return re.split(r"^over: \d+$", self.screen(), flags=re.MULTILINE)[0]

    def close(self) -> None:
        subprocess.run(["tmux", "-S", self.socket, "kill-server"], capture_output=True, check=False)
