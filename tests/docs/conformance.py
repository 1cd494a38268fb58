#!/usr/bin/env python3
"""docs/conformance.md: every statement of the manual, and how it is tested.

usage: conformance.py                 writes docs/conformance.md
       conformance.py --check BUILD   the page and its table are whole
       conformance.py --self-test

The page is made of tests/conformance/statements.toml, which says what its keys mean. --check wants
each entry to have all it needs: an id of its own, an outcome, a test or a reason. The tests must be
among those of BUILD (`ctest --show-only`), and the page must be what the table yields. Prints what is
wrong, exit status 1, or how many statements there are; 77 where a test is not built.
"""

import collections
import json
import pathlib
import re
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
TABLE = ROOT / "tests/conformance/statements.toml"
PAGE = ROOT / "docs/conformance.md"

LEAST = 431  # rows; with fewer, some were lost
LAST_PAGE = 25
SIDES = ("host", "robot", "both", "wiring")
OUTCOMES = ("holds", "choice", "not testable", "not served", "deviates")
KEYS = ("about", "side", "text", "tests", "outcome", "note")
HEADER = re.compile(r"\[p(\d+)\.(\d+)\]")
LINE = re.compile(r"(\w+) = (\".*\"|\[.*\])")

INTRODUCTION = """\
<!-- Made by tests/docs/conformance.py from tests/conformance/statements.toml. Do not edit: a test
     compares. `python3 tests/docs/conformance.py` rewrites it. -->

# The manual, statement by statement

What the manual of the robot (*iRobot Create Open Interface*, 2006) says, in our own words, one
statement a row, by its pages. Each row says whose duty it is, what becomes of it here, and which
tests prove it: `ctest -R` takes their names.

- **Side.** *Host* is what Cargobay sends and reads, *robot* what the virtual Create does, *both*
  what the two agree on, *wiring* what is soldered (docs/wiring.md).
- **Outcome.** *Holds*: its tests prove it. *Choice*: the manual is silent, unclear or contradicts
  itself, and the row says what we do. *Not testable*: by no program, and why. *Not served*: what is
  missing. *Deviates*: how.

`test_conformance --port PATH` asks a real robot, or your own device, what can be asked over its
serial line ([the virtual Create](virtual-create.md#in-tests-of-your-own)); with `--rows` it says
which of these rows it judged. How the bytes look is in [the protocol](protocol.md).
"""


class Faulty(Exception):
    pass


def read_table(text):
    """The rows in their order, each a dictionary with `page`, `number` and `id`; what is wrong."""
    try:
        pages = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:  # an id that occurs twice is one
        raise Faulty(f"no TOML: {error}") from error
    rows, wrong = [], []
    for page, entries in pages.items():
        for number, entry in entries.items() if isinstance(entries, dict) else ():
            if not HEADER.fullmatch(f"[{page}.{number}]") or not isinstance(entry, dict):
                wrong.append(f"{page}.{number} is no id: it is p, the page, a dot and a number")
                continue
            rows.append({"id": f"{page}.{number}", "page": int(page[1:]), "number": int(number), **entry})
    # Programs without a TOML parser read it a line at a time.
    for number, line in enumerate(text.splitlines(), 1):
        if line and not line.startswith("#") and not HEADER.fullmatch(line) and not LINE.fullmatch(line):
            wrong.append(f"line {number} is neither an id, a key with its value nor a comment")
    return rows, wrong


def faults_of_row(row, known):
    name = row["id"]
    for key in row:
        if key not in KEYS + ("id", "page", "number"):
            yield f"{name}: no key is called {key}"
    if not 1 <= row["page"] <= LAST_PAGE:
        yield f"{name}: the manual has no page {row['page']}"
    if not row.get("text", "").strip():
        yield f"{name}: it says nothing"
    if row.get("side") not in SIDES:
        yield f"{name}: its side is one of {', '.join(SIDES)}"
    outcome = row.get("outcome")
    if outcome not in OUTCOMES:
        yield f"{name}: its outcome is one of {', '.join(OUTCOMES)}"
    tests, note = row.get("tests", []), row.get("note", "").strip()
    if not tests and not note:
        yield f"{name}: it has neither a test nor a reason"
    elif outcome == "holds" and not tests:
        yield f"{name}: it holds, and no test proves it"
    elif outcome != "holds" and not note:
        yield f"{name}: it does not simply hold, and gives no reason"
    for test in tests:
        if test not in known:
            yield f"{name}: no test is called {test}"
    for test, count in collections.Counter(tests).items():
        if count > 1:
            yield f"{name}: {test} is named twice"


def faults(text, page, known, least=LEAST):
    """What is wrong with a table, the page made of it, and its tests, of those that are known."""
    try:
        rows, wrong = read_table(text)
    except Faulty as fault:
        return [str(fault)]
    about = None
    for before, row in zip([None] + rows, rows):
        wrong += faults_of_row(row, known)
        if before and (before["page"], before["number"]) >= (row["page"], row["number"]):
            wrong.append(f"{row['id']}: it comes before {before['id']}")
        about = row.get("about") or (about if before and before["page"] == row["page"] else None)
        if not about:
            wrong.append(f"{row['id']}: the first of a page says what it is about")
    if len(rows) < least:
        wrong.append(f"{len(rows)} statements: there were {least}, and some are lost")
    if not wrong and page != made_of(rows):
        wrong.append("docs/conformance.md is not what the table yields: "
                     "python3 tests/docs/conformance.py rewrites it")
    return wrong


def summary(rows):
    lines = ["| outcome | " + " | ".join(SIDES) + " | all |", "|---|" + "---|" * (len(SIDES) + 1)]
    for outcome in OUTCOMES + ("all",):
        these = [row for row in rows if outcome in ("all", row["outcome"])]
        counts = [sum(row["side"] == side for row in these) for side in SIDES]
        lines.append(f"| {outcome} | " + " | ".join(map(str, counts + [len(these)])) + " |")
    return lines


def cell(text):
    return text.replace("|", "\\|")


def made_of(rows):
    lines = [INTRODUCTION, *summary(rows)]
    exceptions = [row for row in rows if row["outcome"] in ("not served", "deviates")]
    if exceptions:
        lines += ["", "## What is not as the manual says", "", "| | | statement | |", "|---|---|---|---|"]
        lines += [f"| {row['id']} | {row['outcome']} | {cell(row['text'])} | {cell(row['note'])} |"
                  for row in sorted(exceptions, key=lambda row: row["outcome"])]
    page = None
    for row in rows:
        if row["page"] != page or "about" in row:
            if row["page"] != page:
                page = row["page"]
                lines += ["", f"## Page {page}"]
            if "about" in row:
                lines += ["", f"### {row['about']} (p. {page})", "",
                          "| | statement | side | outcome | tests | |", "|---|---|---|---|---|---|"]
        tests = ", ".join(f"`{test}`" for test in row.get("tests", []))
        cells = (row["id"], row["text"], row["side"], row["outcome"], tests, row.get("note", ""))
        lines.append("| " + " | ".join(map(cell, cells)) + " |")
    return "\n".join(lines) + "\n"


def tests_of(build):
    """The names of all tests of a build, without the parameters of those that have some."""
    listed = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1"], check=True,
                            stdout=subprocess.PIPE, text=True).stdout
    return {plain(test["name"]) for test in json.loads(listed)["tests"]}


def plain(name):
    """All/ModeLoss.IsToldOnceWithItsCause/cliff_left is one of ModeLoss.IsToldOnceWithItsCause."""
    return re.sub(r"^(?:\w+/)?(\w+\.\w+)(?:/.*)?$", r"\1", name, flags=re.DOTALL)


def check(build):
    known = tests_of(build)
    wrong = faults(TABLE.read_text(encoding="utf-8"), PAGE.read_text(encoding="utf-8"), known)
    missing = sorted(name for name in known if name.endswith("_NOT_BUILT"))
    if wrong:
        print("\n".join(wrong))
        if missing and all("no test is called" in what for what in wrong):
            print("not all is built: " + ", ".join(missing))
            return 77
        return 1
    rows, _ = read_table(TABLE.read_text(encoding="utf-8"))
    counts = collections.Counter(row["outcome"] for row in rows)
    print(f"{len(rows)} statements: " + ", ".join(f"{counts[outcome]} {outcome}" for outcome in OUTCOMES))
    return 0


# --- The self-test: faults planted one at a time in a small table ---

SOUND = """\
# A comment.
[p7.1]
about = "Start (128)"
side = "both"
text = "Start is opcode 128."
tests = ["Encode.SendsStart", "Modes.BeginOff"]
outcome = "holds"

[p7.2]
side = "robot"
text = "It beeps | once."
outcome = "not served"
note = "Silent."

[p8.1]
about = "Demos"
side = "robot"
text = "A demo drives."
tests = ["Demos.Run"]
outcome = "choice"
note = "As we like."
"""
KNOWN = {"Encode.SendsStart", "Modes.BeginOff", "Demos.Run"}

# What is replaced, by what, and the complaint about it.
PLANTED = [
    ('"Modes.BeginOff"', '"Modes.BeginOf"', "p7.1: no test is called Modes.BeginOf"),
    ('tests = ["Encode.SendsStart", "Modes.BeginOff"]\n', "", "p7.1: it has neither a test nor a reason"),
    ('tests = ["Encode.SendsStart", "Modes.BeginOff"]', 'note = "Sure."', "p7.1: it holds, and no test proves it"),
    ('note = "Silent."\n', "", "p7.2: it has neither a test nor a reason"),
    ('note = "As we like."\n', "", "p8.1: it does not simply hold, and gives no reason"),
    ('"Encode.SendsStart", ', '"Modes.BeginOff", ', "p7.1: Modes.BeginOff is named twice"),
    ("[p7.2]", "[p7.1]", "no TOML"),
    ("[p7.2]", "[p7.0]", "p7.0: it comes before p7.1"),
    ("[p7.2]", "[p7.x]", "p7.x is no id"),
    ("[p8.1]", "[p26.1]", "p26.1: the manual has no page 26"),
    ('outcome = "not served"', "", "p7.2: its outcome is one of"),
    ('outcome = "choice"', 'outcome = "fine"', "p8.1: its outcome is one of"),
    ('side = "both"', 'side = "all"', "p7.1: its side is one of"),
    ('text = "A demo drives."', 'text = ""', "p8.1: it says nothing"),
    ('about = "Demos"\n', "", "p8.1: the first of a page says what it is about"),
    ('note = "Silent."', 'not = "Silent."', "p7.2: no key is called not"),
    ('note = "Silent."', 'note = """\nSilent."""', "is neither an id, a key with its value nor a comment"),
    (SOUND[SOUND.index("[p8.1]"):], "", "2 statements: there were 3"),
]


def self_test():
    rows, wrong = read_table(SOUND)
    page = made_of(rows)
    failures = [f"complains of what is sound: {what}" for what in wrong + faults(SOUND, page, KNOWN, 3)]
    for old, new, expected in PLANTED:
        found = faults(SOUND.replace(old, new, 1), page, KNOWN, 3)
        if not any(expected in what for what in found):
            failures.append(f"{old!r} as {new!r} should say {expected!r}, says {found}")
    for stale in (page.replace("Silent.", "Loud."), page + "\n", ""):
        found = faults(SOUND, stale, KNOWN, 3)
        if len(found) != 1 or "not what the table yields" not in found[0]:
            failures.append(f"a page out of date is not seen: {found}")
    names = {"Modes.BeginOff": "Modes.BeginOff", "All/ModeLoss.IsTold/cliff  # GetParam() = cliff": "ModeLoss.IsTold",
             "docs.links": "docs.links", "Each/Modes.Begin/0": "Modes.Begin", "examples.c/drive": "examples.c"}
    for name, expected in names.items():
        if plain(name) != expected:
            failures.append(f"{name} is {plain(name)}, not {expected}")
    for failure in failures:
        print(f"FAILED: {failure}")
    if not failures:
        print(f"all {len(PLANTED) + 3} planted faults are found")
    return 1 if failures else 0


def main(arguments):
    if arguments == ["--self-test"]:
        return self_test()
    if len(arguments) == 2 and arguments[0] == "--check":
        return check(arguments[1])
    if arguments:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    rows, wrong = read_table(TABLE.read_text(encoding="utf-8"))
    if wrong:
        print("\n".join(wrong))
        return 1
    PAGE.write_text(made_of(rows), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
