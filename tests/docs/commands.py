#!/usr/bin/env python3
"""Every command line of the documentation is one that the command takes.

usage: commands.py CARGOBAY [ROOT]
       commands.py --self-test

Looks into the fenced ```sh and ```console blocks of README.md, CHANGELOG.md, docs/**/*.md and
examples/**/*.md for lines that begin with cargobay, after `$ `, sudo and the like, and in the rest
of a line behind ; | or &&. The subcommand must be one of `CARGOBAY --help`, each --option one of
`CARGOBAY SUBCOMMAND --help`. Nothing is run but --help. In a block with `$ ` prompts all else is
output. Prints FILE:LINE: what, exit status 1, or how many were looked at.
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

PAGES = ("README.md", "CHANGELOG.md", "docs/**/*.md", "examples/**/*.md")
FENCE = re.compile(r"^ {0,3}(`{3,}|~{3,})\s*([\w+-]*)")
OPTION = re.compile(r"^ {1,6}(?:-\w,)?(--[\w-]+(?:,--[\w-]+)*)")  # further right is description
SUBCOMMAND = re.compile(r"^ {1,6}([a-z][\w-]*)(?:,|\s|$)")
HEADING = re.compile(r"^(\S.*):\s*$")
ENDS = {";", "|", "||", "&&", "&", "(", ")", "|&", ";;"}
# Words that may precede a command, and how many words of their own follow each.
BEFORE = {"sudo": 0, "exec": 0, "nohup": 0, "time": 0, "taskset": 2, "chrt": 2}


def pages(root):
    return sorted({page for pattern in PAGES for page in root.glob(pattern)})


def blocks(page):
    """The lines, with their numbers, of each block that holds commands."""
    fence, language, lines = None, "", []
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        mark = FENCE.match(line)
        if fence is None and mark:
            fence, language, lines = mark.group(1), mark.group(2), []
        elif fence is not None:
            if mark and mark.group(1).startswith(fence) and not line.strip().strip(fence[0]):
                if language in ("sh", "console"):
                    yield lines
                fence = None
            else:
                lines.append((number, line))


def command_lines(block):
    """Without prompts and output; what \\ continues is one line, with the number of its first."""
    prompted = any(line.lstrip().startswith("$ ") for _, line in block)
    first, joined = 0, ""
    for number, line in block:
        text = line.strip()
        if not joined:
            if prompted and not text.startswith("$ "):
                continue
            first = number
            text = text.removeprefix("$ ")
        joined += text
        if joined.endswith("\\"):
            joined = joined[:-1] + " "
            continue
        yield first, joined
        joined = ""
    if joined:
        yield first, joined


def commands(line):
    """The words of each simple command of a line."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    words = []
    for word in lexer:
        if word in ENDS:
            yield words
            words = []
        else:
            words.append(word)
    yield words


def of_cargobay(words):
    """What follows the name of the command; None where it is another."""
    words = list(words)
    while words:
        word = words.pop(0)
        if re.fullmatch(r"[A-Za-z_]\w*=.*", word):
            continue
        if word in BEFORE:
            del words[: BEFORE[word]]
            continue
        return words if word == "cargobay" or word.endswith("/cargobay") else None
    return None


class Help:
    """What --help says of the command and its subcommands; each is asked once."""

    def __init__(self, program):
        self.program = str(program)
        self.known = {}

    def of(self, names):
        if names not in self.known:
            told = subprocess.run(
                [self.program, *names, "--help"],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=60,
                check=False,
            )
            if told.returncode != 0:
                raise RuntimeError(f"{' '.join([self.program, *names])} --help fails: {told.stdout}")
            self.known[names] = (self.options(told.stdout), self.subcommands(told.stdout))
        return self.known[names]

    @staticmethod
    def options(text):
        found = set()
        for line in text.splitlines():
            option = OPTION.match(line)
            if option:
                found.update(option.group(1).split(","))
        return found

    @staticmethod
    def subcommands(text):
        found, inside = set(), False
        for line in text.splitlines():
            heading = HEADING.match(line)
            if heading:
                inside = heading.group(1).lower() == "subcommands"
            elif inside:
                name = SUBCOMMAND.match(line)
                if name:
                    found.add(name.group(1))
        return found


def faults(words, told):
    options, subcommands = told.of(())
    names = ()
    for word in words:
        if word == "--":
            return
        if word.startswith("--"):
            name = word.partition("=")[0]
            if name not in options:
                yield f"{' '.join(('cargobay', *names))} has no {name}"
                if not names:  # the next word may be its value
                    return
        elif word in subcommands and not word.startswith("-"):
            names += (word,)
            more, subcommands = told.of(names)
            options = options | more if len(names) > 1 else more
        elif not names and not word.startswith("-"):
            yield f"cargobay has no command {word}"
            return


def check(root, program):
    complaints, count, told = [], 0, Help(program)
    for page in pages(root):
        for block in blocks(page):
            for number, line in command_lines(block):
                at = f"{page.relative_to(root)}:{number}"
                try:
                    parts = list(commands(line))
                except ValueError as error:  # a quote that is not closed
                    if "cargobay" in line:
                        complaints.append(f"{at}: {error}")
                    continue
                for words in parts:
                    rest = of_cargobay(words)
                    if rest is None:
                        continue
                    count += 1
                    complaints += [f"{at}: {what}" for what in faults(rest, told)]
    return complaints, count


# --- The self-test: a command of two subcommands, and faults planted one at a time ---

PROGRAM = """#!/bin/sh
case "$*" in
  --help) cat <<'END'
A command.
Usage: cargobay [OPTIONS] SUBCOMMAND

Options:
  -h,--help                   Print this
  --version                   Print that

Subcommands:
  drive                       Drives.
                              plot is nothing here
  jitter                      Measures.

`cargobay COMMAND --help` tells more.
END
  ;;
  'drive --help') cat <<'END'
Options:
  -h,--help                   Print this
  --port TEXT                 Where; not with
                              --depth
  --reconnect{30}             For so long
Virtual:
  --lag FLOAT [0.1]           Of the wheels
END
  ;;
  'jitter --help') cat <<'END'
Options:
  --json TEXT                 To a file

Subcommands:
  compare                     Side by side
END
  ;;
  'jitter compare --help') cat <<'END'
Options:
  --only TEXT                 One
END
  ;;
  *) echo "not to be run: $*" >&2; exit 3 ;;
esac
"""

SOUND = [
    "cargobay drive",
    "cargobay --version",
    "sudo cargobay drive --port /dev/x --reconnect=60 --lag 0.2   # --no such",
    "A=1 sudo taskset -c 3 build/release/cargobay drive --help",
    "cargobay jitter --json a; cargobay jitter compare a b --only x --json y",
    "echo cargobay nothing --no",
    "cargobay drive -- --no",
    "cargobay drive \\\n  --port x",
    "examples/run.sh --no",
    "cargobay-guard --no",
]

# A line, and the complaint about it.
PLANTED = [
    ("cargobay dirve", "cargobay has no command dirve"),
    ("cargobay drive --prot /dev/x", "cargobay drive has no --prot"),
    ("cargobay drive --depth 3", "cargobay drive has no --depth"),
    ("cargobay drive --version", "cargobay drive has no --version"),
    ("cargobay drive --recon", "cargobay drive has no --recon"),
    ("cargobay jitter --port x", "cargobay jitter has no --port"),
    ("cargobay jitter compare a --lag 1", "cargobay jitter compare has no --lag"),
    ("cargobay plot", "cargobay has no command plot"),
    ("cargobay --port x", "cargobay has no --port"),
    ("sudo cargobay sim", "cargobay has no command sim"),
    ("true | cargobay sim", "cargobay has no command sim"),
    ("cargobay drive && cargobay drive --no", "cargobay drive has no --no"),
    ("cargobay drive 'x", "No closing quotation"),
]


def self_test():
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        program = root / "cargobay"
        program.write_text(PROGRAM, encoding="utf-8")
        program.chmod(0o755)
        page = root / "docs" / "page.md"
        page.parent.mkdir()

        def found(text):
            page.write_text(text, encoding="utf-8")
            return check(root, program)

        for language, prompt in (("sh", ""), ("console", "$ "), ("console", "")):
            sound = "".join(f"{prompt}{line}\n" for line in SOUND)
            complaints, count = found(f"```{language}\n{sound}```\n")
            failures += [f"complains of what is sound: {what}" for what in complaints]
            if count != 8:
                failures.append(f"{language}: looks at {count} commands, not at 8")
            for line, expected in PLANTED:
                complaints, _ = found(f"Text\n\n```{language}\ntrue\n{prompt}{line}\n```\n")
                if complaints != [f"docs/page.md:5: {expected}"]:
                    failures.append(f"{line!r} should say {expected!r}, says {complaints}")
        complaints, count = found("```console\n$ cargobay drive\ncargobay dirve\n```\n```c\ncargobay x\n```\n")
        if complaints or count != 1:
            failures.append(f"output or another language is taken for commands: {complaints}")
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
    program = pathlib.Path(arguments[0]).resolve()
    if not os.access(program, os.X_OK):
        print(f"commands.py: {program} cannot be run: build it first", file=sys.stderr)
        return 2
    root = pathlib.Path(arguments[1]) if len(arguments) > 1 else pathlib.Path(__file__).parents[2]
    complaints, count = check(root.resolve(), program)
    for complaint in complaints:
        print(complaint)
    if not complaints:
        print(f"{count} command lines, all as --help has them")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
