#!/usr/bin/env python3
"""What the documentation points at is there.

usage: links.py [ROOT]
       links.py --self-test

Looks into README.md, CHANGELOG.md, docs/**/*.md and examples/**/*.md. Checked are relative links
and images, the file and the #anchor as GitHub makes it of a heading; paths in backticks that begin
with a folder of the top level (`oi/units.hpp`, `tests/oi/*.cpp`); and words of ```sh blocks that do.
No page has a section twice, as a careless merge leaves it. Prints FILE:LINE: what, exit status 1,
or how many were looked at.
"""

import pathlib
import re
import sys
import tempfile
import urllib.parse

PAGES = ("README.md", "CHANGELOG.md", "docs/**/*.md", "examples/**/*.md")
NOT_OURS = {"build"}  # built, not committed

FENCE = re.compile(r"^ {0,3}(`{3,}|~{3,})\s*([\w+-]*)")
CODE = re.compile(r"(?<!`)(`+)(?!`)(.+?)(?<!`)\1(?!`)")
INLINE = re.compile(r"\]\(\s*(<[^>]*>|[^()\s]*(?:\([^()\s]*\)[^()\s]*)*)(?:\s+(?:\"[^\"]*\"|'[^']*'))?\s*\)")
DEFINED = re.compile(r"^ {0,3}\[[^\]]+\]:\s+(<[^>]*>|\S+)")
HTML = re.compile(r"\b(?:href|src)=\"([^\"]*)\"")
NAMED = re.compile(r"\b(?:id|name)=\"([^\"]*)\"")
SCHEME = re.compile(r"^[a-z][a-z0-9+.-]*:", re.IGNORECASE)
HEADING = re.compile(r"^ {0,3}(#{1,6})\s+(.*?)(?:\s+#+)?\s*$")
UNDERLINE = re.compile(r"^ {0,3}(=+|-+)\s*$")
LINE_OF_SOURCE = re.compile(r"^L\d+(-L?\d+)?$")


def pages(root):
    return sorted({page for pattern in PAGES for page in root.glob(pattern)})


def lines_of(page):
    """Number, text and, inside a fenced block, its language (else None) of each line."""
    fence, language = None, None
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        mark = FENCE.match(line)
        if fence is None and mark:
            fence, language = mark.group(1), mark.group(2)
        elif fence is not None:
            closes = mark and mark.group(1).startswith(fence) and not line.strip().strip(fence[0])
            if closes:
                fence, language = None, None
            else:
                yield number, line, language
        else:
            yield number, line, None


def anchor(heading):
    """As GitHub makes it: the visible text in lower case, spaces as hyphens, no other marks."""
    text = re.sub(r"!?\[([^\]]*)\](?:\([^)]*\)|\[[^\]]*\])", r"\1", heading)
    text = re.sub(r"<[^>]*>", "", text)
    text = re.sub(r"(?<!\w)_([^_]+)_(?!\w)", r"\1", text)
    text = re.sub(r"[^\w\- ]", "", text.strip().lower())
    return text.replace(" ", "-")


def anchors(page):
    found, before = set(), ""

    def add(heading):
        name = plain = anchor(heading)
        count = 0
        while name in found:
            count += 1
            name = f"{plain}-{count}"
        found.add(name)

    for _, line, language in lines_of(page):
        if language is not None:
            before = ""
            continue
        found.update(NAMED.findall(line))
        heading = HEADING.match(line)
        if heading:
            add(heading.group(2))
        elif before.strip() and UNDERLINE.match(line) and not before.startswith(("|", ">", "-", "*")):
            add(before)
        before = "" if heading else line
    return found


class Check:
    def __init__(self, root):
        self.root = root.resolve()
        self.folders = {
            entry.name
            for entry in self.root.iterdir()
            if entry.is_dir() and not entry.name.startswith(".") and entry.name not in NOT_OURS
        }
        self.known_anchors = {}
        self.complaints = []
        self.links = self.paths = 0

    def complain(self, page, number, what):
        self.complaints.append(f"{page.relative_to(self.root)}:{number}: {what}")

    def anchors_of(self, page):
        if page not in self.known_anchors:
            self.known_anchors[page] = anchors(page)
        return self.known_anchors[page]

    def link(self, page, number, target):
        target = target.strip("<>")
        if SCHEME.match(target) or target.startswith("//"):
            return
        self.links += 1
        if not target:
            self.complain(page, number, "an empty link")
            return
        path, _, fragment = target.partition("#")
        path = urllib.parse.unquote(path.partition("?")[0])
        if not path:
            file = page
        elif path.startswith("/"):
            file = self.root / path.lstrip("/")
        else:
            file = page.parent / path
        file = file.resolve()
        if file != self.root and self.root not in file.parents:
            self.complain(page, number, f"{target} leads out of the repository")
        elif not file.exists():
            self.complain(page, number, f"{target}: there is no {file.relative_to(self.root)}")
        elif fragment:
            self.fragment(page, number, file, urllib.parse.unquote(fragment))

    def fragment(self, page, number, file, fragment):
        name = file.relative_to(self.root)
        if file.suffix == ".md":
            if fragment not in self.anchors_of(file):
                self.complain(page, number, f"{name} has no heading for #{fragment}")
        elif file.is_dir() or not LINE_OF_SOURCE.match(fragment):
            self.complain(page, number, f"{name} has no anchors: #{fragment}")

    def path(self, page, number, word):
        if word.partition("/")[0] not in self.folders or "/" not in word:
            return
        word = re.sub(r":\d+(-\d+)?$", "", word.rstrip("/"))
        if not re.fullmatch(r"[\w./*@+-]+", word):
            return
        self.paths += 1
        if "*" in word:
            there = any(self.root.glob(word))
        else:
            there = (self.root / word).exists()
        if not there:
            self.complain(page, number, f"there is no {word}")

    def text(self, page, number, line):
        for code in CODE.finditer(line):
            # Words after a blank are arguments: `tests/run.sh --quick`.
            self.path(page, number, code.group(2).strip().partition(" ")[0])
        bare = CODE.sub(" ", line)  # a link whose text is code leaves its brackets
        for pattern in (INLINE, DEFINED, HTML):
            for found in pattern.finditer(bare):
                self.link(page, number, found.group(1))

    def run(self):
        for page in pages(self.root):
            sections = set()
            for number, line, language in lines_of(page):
                if language is None:
                    self.text(page, number, line)
                    if line.startswith("## "):
                        if line in sections:
                            self.complain(page, number, f"the section {line[3:]} is there twice")
                        sections.add(line)
                elif language == "sh":
                    for word in line.partition(" #")[0].split():
                        self.path(page, number, word.strip("'\";,()"))
        return self.complaints

    def summary(self):
        count = len(pages(self.root))
        return f"{count} pages: {self.links} links and {self.paths} paths, all there"


# --- The self-test: faults planted one at a time in a small repository ---

SOUND = {
    "README.md": "# Title\n\nSee [start](docs/start.md#first-steps-sim), ![way](docs/way.svg 'the way')\n"
    "and [ours](#title), [there](https://example.org/no#x). `oi/units.hpp` `oi/*.hpp` `rt::x/y`\n"
    "`tests/run.sh --quick` `build/x/y` `oi/units.hpp:12`\n\n```sh\ntests/run.sh --quick  # oi/no\n```\n",
    "CHANGELOG.md": "## [Unreleased]\n\n[`units`](oi/units.hpp#L3)\n",
    "docs/start.md": "# Start\n\n## First steps: `sim`\n\n### Twice\n\n### Twice\n\n[a](#twice-1) [b](/README.md)\n"
    "[c][c]\n\n[c]: ../README.md#title\n\n```c\n[no](link.md) `oi/no.hpp`\n```\n\n`[no](link.md)`\n",
    "docs/way.svg": "<svg/>\n",
    "docs/decisions/1.md": "# 1. A *strong*, [linked](../start.md) `code_name`\n\n[up](../start.md#twice)\n"
    "[me](#1-a-strong-linked-code_name)\n",
    "examples/world/README.md": "[root](../../README.md)\n",
    "oi/units.hpp": "// units\n",
    "tests/run.sh": "#!/bin/sh\n",
}

# File, line to be added, and the complaint about it.
PLANTED = [
    ("README.md", "[x](docs/no.md)", "there is no docs/no.md"),
    ("README.md", "![x](docs/no.svg)", "there is no docs/no.svg"),
    ("README.md", "[x](docs/Start.md)", "there is no docs/Start.md"),
    ("README.md", "[x](docs/start.md#twice-2)", "docs/start.md has no heading for #twice-2"),
    ("README.md", "[x](#no)", "README.md has no heading for #no"),
    ("README.md", "[x](docs/start.md#First-steps-sim)", "no heading for #First-steps-sim"),
    ("README.md", "[x]()", "an empty link"),
    ("README.md", "<a href=\"no.html\">x</a>", "there is no no.html"),
    ("README.md", "[`code`](no.md)", "there is no no.md"),
    ("CHANGELOG.md", "[x]: no.md", "there is no no.md"),
    ("CHANGELOG.md", "`oi/no.hpp`", "there is no oi/no.hpp"),
    ("CHANGELOG.md", "`tests/no.sh --quick`", "there is no tests/no.sh"),
    ("CHANGELOG.md", "`tests/*.py`", "there is no tests/*.py"),
    ("docs/decisions/1.md", "[x](start.md)", "there is no docs/decisions/start.md"),
    ("docs/decisions/1.md", "[x](../../../etc/passwd)", "leads out of the repository"),
    ("docs/decisions/1.md", "[x](../../oi/units.hpp#no)", "oi/units.hpp has no anchors"),
    ("docs/start.md", "## First steps: `sim`", "the section First steps: `sim` is there twice"),
    ("docs/start.md", "```sh\ntests/no.sh --quick\n```", "there is no tests/no.sh"),
    ("examples/world/README.md", "[x](README.txt)", "there is no examples/world/README.txt"),
]


def self_test():
    failures = []
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in SOUND.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text, encoding="utf-8")
        failures += [f"complains of what is sound: {what}" for what in Check(root).run()]
        for name, line, expected in PLANTED:
            (root / name).write_text(f"{SOUND[name]}\n{line}\n", encoding="utf-8")
            found = Check(root).run()
            at = SOUND[name].count("\n") + 2 + (1 if "\n" in line else 0)
            if len(found) != 1 or not found[0].startswith(f"{name}:{at}: ") or expected not in found[0]:
                failures.append(f"{name}: {line!r} should say {expected!r}, says {found}")
            (root / name).write_text(SOUND[name], encoding="utf-8")
    for failure in failures:
        print(f"FAILED: {failure}")
    if not failures:
        print(f"all {len(PLANTED)} planted faults are found")
    return 1 if failures else 0


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test()
    if len(arguments) > 1 or (arguments and arguments[0].startswith("-")):
        print(__doc__.strip(), file=sys.stderr)
        return 2
    here = pathlib.Path(__file__).resolve().parents[2]
    check = Check(pathlib.Path(arguments[0]) if arguments else here)
    complaints = check.run()
    for complaint in complaints:
        print(complaint)
    if not complaints:
        print(check.summary())
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
