#!/usr/bin/env python3
"""Every program of the documentation compiles without a warning, runs, and exits with 0.

usage: cookbook.py BUILD_DIR [ROOT]
       cookbook.py --self-test

BUILD_DIR has libcargobay.so and cargobay-guard. In docs/cookbook.md each heading that asks has a
program, and each ```c, ```cpp or ```python block is one; a ```rust block is a piece of
examples/rust. In README.md and docs/start.md the blocks with `int main(` are programs, and the
```python ones; a block without it that begins with #include belongs to the next of its language; one
that begins with `static` is a piece of an example. Programs run in a folder of their own, for 20 s
at most. Those of the cookbook must not read the machine's configuration: it names no port there is.
Prints FILE:LINE: what, exit status 1, or how many programs have run.
"""

import dataclasses
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

COOKBOOK = "docs/cookbook.md"
TUTORIALS = ("README.md", "docs/start.md")
MACHINES_OWN = pathlib.Path("/etc/cargobay.toml")
LONGEST_S = 20
FENCE = re.compile(r"^```(\w*)\s*$")
HEADING = re.compile(r"^#+ (.*)$")
MAIN = re.compile(r"^int main\(", re.MULTILINE)
COMPILERS = {"c": ("CC", "cc", []), "cpp": ("CXX", "c++", ["-std=c++20"])}
EXAMPLES = {
    "c": "examples/*.c",
    "cpp": "examples/*.cpp",
    "rust": "examples/rust/src/*.rs",
}


@dataclasses.dataclass
class Block:
    line: int  # of its fence
    language: str
    text: str = ""


def contents(page):
    """The headings, as (line, text), and the blocks of a page."""
    headings, blocks, inside = [], [], False
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        fence, heading = FENCE.match(line), HEADING.match(line)
        if fence:
            inside = not inside
            if inside:
                blocks.append(Block(number, fence.group(1)))
        elif inside:
            blocks[-1].text += line + "\n"
        elif heading:
            headings.append((number, heading.group(1)))
    return headings, blocks


def unanswered(headings, blocks):
    """The headings that ask, and no program follows."""
    ends = [number for number, _ in headings[1:]] + [sys.maxsize]
    for (number, text), end in zip(headings, ends):
        answers = [block for block in blocks if number < block.line < end and block.language != "sh"]
        if text.endswith("?") and not answers:
            yield number, f"no program answers: {text}"


def joined(blocks):
    """The programs and pieces of a tutorial."""
    beginnings = {}
    for block in blocks:
        if block.language == "python":
            yield block
        elif block.language not in COMPILERS:
            continue
        elif MAIN.search(block.text):
            block.text = beginnings.pop(block.language, "") + block.text
            yield block
        elif block.text.startswith("#include"):
            beginnings[block.language] = block.text
        elif block.text.startswith("static"):
            yield block


class Check:
    def __init__(self, root, build):
        self.root, self.build = root.resolve(), build.resolve()
        self.complaints = []
        self.count = 0

    def complain(self, page, line, what):
        self.complaints.append(f"{page}:{line}: {what}")

    def compiled(self, block, folder):
        """The program, and what is wrong with it if it does not compile."""
        variable, compiler, flags = COMPILERS[block.language]
        source, program = folder / f"recipe.{block.language}", folder / "recipe"
        source.write_text(block.text, encoding="utf-8")
        command = [os.environ.get(variable, compiler), *flags, "-Wall", "-Wextra", "-Werror",
                   "-I", str(self.root / "hal/c"), str(source), "-o", str(program),
                   str(self.build / "libcargobay.so"), f"-Wl,-rpath,{self.build}", "-lm", "-pthread"]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              check=False)
        return [str(program)], "" if done.returncode == 0 else f"does not compile:\n{done.stdout}"

    def python(self, block, folder):
        source = folder / "recipe.py"
        source.write_text(block.text, encoding="utf-8")
        return [sys.executable, str(source)], ""

    def run(self, command, folder):
        """What is wrong with a run."""
        home = folder / "configuration"
        environment = os.environ | {
            "XDG_CONFIG_HOME": str(home), "CARGOBAY_LIBRARY": str(self.build / "libcargobay.so"),
            "PYTHONPATH": str(self.root / "hal/python"), "PYTHONDONTWRITEBYTECODE": "1"}
        with subprocess.Popen(command, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", start_new_session=True) as process:
            try:
                output, _ = process.communicate(timeout=LONGEST_S)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)  # its own session, so its own group
                output, _ = process.communicate()
                return f"takes more than {LONGEST_S} s:\n{output}"
        return "" if process.returncode == 0 else f"exits with {process.returncode}:\n{output}"

    def program(self, page, block, configuration):
        with tempfile.TemporaryDirectory() as place:
            folder = pathlib.Path(place)
            (folder / "configuration").mkdir()
            (folder / "configuration/cargobay.toml").write_text(configuration, encoding="utf-8")
            make = self.python if block.language == "python" else self.compiled
            command, wrong = make(block, folder)
            wrong = wrong or self.run(command, folder)
        self.count += 1
        if wrong:
            self.complain(page, block.line, f"this program {wrong.rstrip()}")

    def piece(self, page, block):
        texts = [path.read_text(encoding="utf-8")
                 for path in self.root.glob(EXAMPLES[block.language])]
        if not any(block.text in text for text in texts):
            self.complain(page, block.line, f"not a piece of {EXAMPLES[block.language]}")

    def cookbook(self):
        headings, blocks = contents(self.root / COOKBOOK)
        for line, what in unanswered(headings, blocks):
            self.complain(COOKBOOK, line, what)
        for block in blocks:
            if block.language == "rust":
                self.piece(COOKBOOK, block)
            elif block.language == "python" or block.language in COMPILERS:
                self.program(COOKBOOK, block, 'port = "/dev/no_robot_here"\n')
            elif block.language != "sh":
                self.complain(COOKBOOK, block.line, f"a program in {block.language or 'no language'}?")

    def tutorials(self):
        for page in TUTORIALS:
            for block in joined(contents(self.root / page)[1]):
                if block.language != "python" and not MAIN.search(block.text):
                    self.piece(page, block)
                elif MACHINES_OWN.exists():
                    print(f"{page}:{block.line}: not run: {MACHINES_OWN} may name a robot")
                else:
                    self.program(page, block, "")

    def all(self):
        self.cookbook()
        self.tutorials()
        return self.complaints


# --- The self-test: a library of nothing, small pages, and faults planted one at a time ---

GOOD = "int main(void) { return 0; }\n"
PAGES = {
    COOKBOOK: f"# Cookbook\n\n## A part\n\n### How?\n\n```c\n{GOOD}```\n\n### And how?\n\n"
              "```python\nimport os\n```\n\n### In Rust?\n\n```rust\nfn drive() {}\n```\n",
    "README.md": f"# Title\n\n```c\n{GOOD}```\n\n```sh\nfalse\n```\n",
    "docs/start.md": "```c\n#include <stdlib.h>\nstatic int half(int i) { return i / 2; }\n```\n\n"
                     "```c\nstatic int piece(void);\n```\n\n```c\nno_program();\n```\n\n"
                     "```c\nint main(void) { return abs(half(0)); }\n```\n",
    "examples/a.c": "static int piece(void);\n",
    "examples/rust/src/main.rs": "use cargobay;\nfn drive() {}\n",
    "hal/c/cargobay.h": "",
}

# A page, what is replaced by what, and the beginning of the complaint.
PLANTED = [
    (COOKBOOK, "return 0", "return 3", ":7: this program exits with 3"),
    (COOKBOOK, "return 0", "abort()", ":7: this program does not compile"),
    (COOKBOOK, "{ return", "{ int unused; return", ":7: this program does not compile"),
    (COOKBOOK, "return 0", "for (;;) {}", ":7: this program takes more than"),
    (COOKBOOK, "import os", "import no_such_module", ":13: this program exits with 1"),
    (COOKBOOK, "import os", "import os; print(os.environ['XDG_CONFIG_HOME']); os.abort()",
     ":13: this program exits with -6"),
    (COOKBOOK, "import os", "import os; home = os.environ['XDG_CONFIG_HOME']\n"
     "assert 'no_robot' not in open(home + '/cargobay.toml').read()", ":13: this program exits with 1"),
    (COOKBOOK, "```c\n" + GOOD + "```\n", "", ":5: no program answers: How?"),
    (COOKBOOK, "```c\n" + GOOD + "```\n", "```sh\ntrue\n```\n", ":5: no program answers: How?"),
    (COOKBOOK, "```c\n", "```\n", ":7: a program in no language?"),
    (COOKBOOK, "fn drive", "fn halt", ":19: not a piece of examples/rust"),
    ("README.md", "return 0", "return 1", ":3: this program exits with 1"),
    ("docs/start.md", "return abs", "return 1 + abs", ":14: this program exits with 1"),
    ("docs/start.md", "int i", "int", ":14: this program does not compile"),
    ("docs/start.md", "int piece", "int part", ":6: not a piece of examples/*.c"),
]


def self_test():
    global LONGEST_S, MACHINES_OWN
    LONGEST_S, MACHINES_OWN = 2, pathlib.Path("/no/such/file")
    failures = []
    with tempfile.TemporaryDirectory() as place:
        root = pathlib.Path(place)
        for name, text in PAGES.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        subprocess.run([os.environ.get("CC", "cc"), "-shared", "-x", "c", "/dev/null", "-o",
                        str(root / "libcargobay.so")], check=True)
        check = Check(root, root)
        failures += [f"complains of what is sound: {what}" for what in check.all()]
        if check.count != 4:
            failures.append(f"runs {check.count} programs, not 4")
        for name, old, new, expected in PLANTED:
            text = PAGES[name].replace(old, new, 1)
            (root / name).write_text(text, encoding="utf-8")
            found = Check(root, root).all()
            if text == PAGES[name] or len(found) != 1 or not found[0].startswith(name + expected):
                failures.append(f"{name}: {new!r} should say {expected!r}, says {found}")
            (root / name).write_text(PAGES[name], encoding="utf-8")
    for failure in failures:
        print(f"FAILED: {failure}")
    if not failures:
        print(f"all {len(PLANTED)} planted faults are found")
    return 1 if failures else 0


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test()
    if len(arguments) not in (1, 2) or arguments[0].startswith("-"):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    build = pathlib.Path(arguments[0])
    if not (build / "libcargobay.so").exists():
        print(f"cookbook.py: {build} has no libcargobay.so: build it first", file=sys.stderr)
        return 2
    root = pathlib.Path(arguments[1]) if len(arguments) > 1 else pathlib.Path(__file__).parents[2]
    check = Check(root, build)
    for complaint in check.all():
        print(complaint)
    if not check.complaints:
        print(f"{check.count} programs, all exit with 0")
    return 1 if check.complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
