#!/usr/bin/env python3
"""The drawing of the robot's connectors has each pin where the manual has it (OI p. 4).

usage: wiring_pins.py [ROOT]
       wiring_pins.py --self-test

Reads the texts of docs/wiring-connectors.svg in their order: a pin's number and then its label, the
table of signals with its columns, and what is said of supplies. Prints what is wrong, exit status 1.
"""

import pathlib
import re
import sys
import xml.etree.ElementTree

DB25 = {
    "1": "RXD", "2": "TXD", "3": "power", "4": "AI", "5": "DI1", "6": "DI3", "7": "DO1", "8": "5 V",
    "9": "Vpwr", "10": "Vsw", "11": "Vsw", "12": "Vsw", "13": "charge", "14": "GND", "15": "BRC",
    "16": "GND", "17": "DI0", "18": "DI2", "19": "DO0", "20": "DO2", "21": "GND", "22": "LD0",
    "23": "LD1", "24": "LD2", "25": "GND",
}
MINI_DIN = {"1": "Vpwr", "2": "Vpwr", "3": "RXD", "4": "TXD", "5": "BRC", "6": "GND", "7": "GND"}
# Signal, DB-25, mini-DIN.
SIGNALS = [
    ("robot’s RXD", "1", "3"), ("robot’s TXD", "2", "4"), ("BRC", "15", "5"),
    ("power toggle", "3", "none"), ("ground", "14, 16, 21, 25", "6, 7"),
]
SAID = [
    "pins 5, 6, 7 lie towards the rim", "RXD is the robot’s input, TXD its output",
    "switched 5 V out (100 mA)", "pin 9: 0.5 A", "pins 10 to 12: 1.5 A",
]


def texts_of(drawing):
    found = (node for node in xml.etree.ElementTree.fromstring(drawing).iter() if node.tag.endswith("}text"))
    return ["".join(node.itertext()).strip() for node in found]


def faults(drawing):
    texts = texts_of(drawing)
    joined = "\n".join(texts)
    heads = [next((i for i, text in enumerate(texts) if head in text), None)
             for head in ("DB-25: ", "Mini-DIN: ", "pins 5, 6, 7")]
    if None in heads:
        return ["the DB-25, the mini-DIN or what is said of its rim is gone"]
    wrong = []
    for name, pins, begin, end in (("DB-25", DB25, heads[0], heads[1]), ("mini-DIN", MINI_DIN, heads[1], heads[2])):
        drawn = [(number, label) for number, label in zip(texts[begin:end], texts[begin + 1:end])
                 if re.fullmatch(r"\d+", number)]
        wrong += [f"{name} pin {number} is {dict(drawn).get(number)!r}, not {label!r}"
                  for number, label in pins.items() if dict(drawn).get(number) != label]
        if len(drawn) != len(pins):
            wrong.append(f"{name} has {len(drawn)} pins, not {len(pins)}")
    wrong += [f"{signal} is not at DB-25 {db25} and mini-DIN {mini_din}" for signal, db25, mini_din in SIGNALS
              if not any(tuple(texts[i:i + 3]) == (signal, db25, mini_din) for i in range(len(texts)))]
    wrong += [f"it does not say: {words}" for words in SAID if words not in joined]
    return wrong


def self_test(drawing):
    failures = [f"complains of what is sound: {what}" for what in faults(drawing)]
    planted = 0
    for label in sorted(set(DB25.values()) | set(MINI_DIN.values())):
        planted += 1
        if not faults(drawing.replace(f">{label}<", ">?<", 1)):
            failures.append(f"{label} drawn wrong is not seen")
    for words in SAID:
        planted += 1
        if not faults(drawing.replace(words, "?")):
            failures.append(f"{words!r} left out is not seen")
    print("\n".join(f"FAILED: {failure}" for failure in failures) or f"all {planted} planted faults are found")
    return 1 if failures else 0


def main(arguments):
    root = pathlib.Path(__file__).resolve().parents[2]
    if arguments and arguments != ["--self-test"]:
        root = pathlib.Path(arguments[0])
    drawing = (root / "docs/wiring-connectors.svg").read_text(encoding="utf-8")
    if arguments == ["--self-test"]:
        return self_test(drawing)
    wrong = faults(drawing)
    print("\n".join(wrong) or f"{len(DB25) + len(MINI_DIN)} pins, each where the manual has it")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
