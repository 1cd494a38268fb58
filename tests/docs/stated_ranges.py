#!/usr/bin/env python3
"""Each range that the help of the command states is the one that it takes.

usage: stated_ranges.py CARGOBAY
       stated_ranges.py --self-test

Looks into `CARGOBAY SUBCOMMAND --help` of each subcommand for options whose line says "A to B" or
"in [A - B]". A and B must be taken, what lies beyond must be refused by name. Nothing is
driven: what is taken fails by a port, a link or a file that is not there. Prints what is wrong, exit
status 1, or how many ranges were looked at.
"""

import re
import subprocess
import sys

OPTION = re.compile(r"^ {1,6}(?:-\w,\s*)?(--[\w-]+)")
RANGE = re.compile(r"in \[(\S+) - (\S+?)\]|(?<![\w.])(-?\d[\d.e+]*) to (-?\d[\d.e+]*)")
NOWHERE = "/no/such/folder/there"
# Makes each subcommand fail early and harmlessly once it has accepted the value.
FAILS = {
    "drive": ["--port", NOWHERE], "jitter": ["--port", NOWHERE],
    "calibrate": ["--json", NOWHERE],  # warns for 3 s before it opens a port
    "send": ["--port", NOWHERE, "start"], "bringup": ["--port", NOWHERE],
    "sensors": ["--port", NOWHERE], "doctor": ["--port", NOWHERE], "sim": ["--link", NOWHERE],
    "serve": ["--port", NOWHERE, "--no-http"], "teleop": ["--port", NOWHERE],
    "plot": ["--live", NOWHERE], "replay": [NOWHERE], "decode": ["--binary", NOWHERE],
}


def ranges(help_text):
    """Option, least, most and whether it is a whole number, of each that states a range."""
    option, block = None, ""
    blocks = []
    for line in help_text.splitlines() + [""]:
        match = OPTION.match(line)
        if match or not line.strip():
            if option:
                blocks.append((option, block))
            option, block = (match.group(1), line) if match else (None, "")
        elif option:
            block += " " + line.strip()
    for option, block in blocks:
        match = RANGE.search(block)
        if match:
            least, most = [text for text in match.groups() if text]
            yield option, least, most, not re.search(r"FLOAT", block)


def beyond(text, step, whole):
    value = float(text)
    return str(int(value) + step) if whole else repr(value + step * max(abs(value) * 1e-3, 1e-3))


def check(program, subcommand):
    run = lambda *arguments: subprocess.run(
        [program, subcommand, *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT, text=True, timeout=30)
    wrong, count = [], 0
    for option, least, most, whole in ranges(run("--help").stdout):
        if subcommand not in FAILS:
            wrong.append(f"{subcommand}: {option} has a range, and this test cannot try it")
            continue
        count += 1
        for value, taken in ((least, True), (most, True), (beyond(least, -1, whole), False),
                             (beyond(most, 1, whole), False)):
            ended = run(f"{option}={value}", *FAILS[subcommand])
            said = ended.stdout.strip()
            refused = ended.returncode != 0 and option in said and NOWHERE not in said
            if refused == taken:
                wrong.append(f"{subcommand}: {option} is {least} to {most}, and {value} is "
                             f"{'refused' if refused else 'taken'}: {said[-200:]}")
    return wrong, count


def self_test():
    stated = list(ranges("  -a,--lag FLOAT:FLOAT in [0.001 - 10]=0.1\n        Words\n"
                         "  --speed FLOAT=200  Speed in mm/s,\n        -500 to 500\n  --other  None\n"))
    assert stated == [("--lag", "0.001", "10", False), ("--speed", "-500", "500", False)], stated
    assert beyond("98", 1, True) == "99" and float(beyond("0.001", -1, False)) < 0.001
    print("stated_ranges.py: as it should be")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    program = sys.argv[1]
    listed = subprocess.run([program, "--help"], stdout=subprocess.PIPE, text=True).stdout
    names = re.findall(r"^  ([a-z][a-z-]*)  ", listed[listed.lower().index("subcommands:"):], re.M)
    assert len(names) > 10, names
    wrong, count = [], 0
    for name in names:
        more, looked_at = check(program, name)
        wrong += more
        count += looked_at
    print("\n".join(wrong) or f"{count} ranges, each as stated")
    sys.exit(1 if wrong or count < 30 else 0)


if __name__ == "__main__":
    main()
