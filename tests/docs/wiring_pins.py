#!/usr/bin/env python3
"""The drawing of the robot's connectors has each pin where the manual has it (OI p. 4), and the text
below it the manual's circuits at the others (p. 10, 11, 20, 23).

usage: wiring_pins.py [ROOT]
       wiring_pins.py --self-test

Reads the texts of docs/wiring-connectors.svg in their order: a pin's number and then its label, the
table of signals with its columns, and what is said of supplies; and docs/wiring.md for what belongs
to each pin. Prints what is wrong, exit status 1.
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

# From docs/wiring.md: what a line that begins like this says.
CIRCUITS = [
    ("| 19, 7, 20: digital outputs", "20 mA"),
    ("| 19, 7, 20: digital outputs", "an LED with its resistor"),
    ("| 19, 7, 20: digital outputs", "by a transistor only, 1 k to its base"),
    ("| 17, 5, 18, 6: digital inputs", "a switch and 10 k"),
    ("| 4: analog input", "a light dependent resistor and 10 k"),
    ("| 22, 23: low side drivers 0, 1", "0.5 A each"),
    ("| 22, 23: low side drivers 0, 1", "the load between Vpwr (10 to 12) and the pin"),
    ("| 24: low side driver 2", "1.5 A"),
    ("- **A motor, relay or valve needs a diode**", "1N4001"),
    ("- **An IR LED for Send IR**", "driver 1 (pin 23"),
    ("- **An IR LED for Send IR**", "in series with a resistor"),
    ("- **An IR LED for Send IR**", "preload resistor, 100 ohm"),
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


def missing_circuits(text):
    # A table row, or a list entry with its continuation lines.
    lines = re.sub(r"\n  (?=\S)", " ", text).splitlines()
    return [f"docs/wiring.md does not say {words!r} at {begin!r}" for begin, words in CIRCUITS
            if not any(line.startswith(begin) and words in line for line in lines)]


def self_test(drawing, text):
    failures = [f"complains of what is sound: {what}" for what in faults(drawing) + missing_circuits(text)]
    planted = 0
    for label in sorted(set(DB25.values()) | set(MINI_DIN.values())):
        planted += 1
        if not faults(drawing.replace(f">{label}<", ">?<", 1)):
            failures.append(f"{label} drawn wrong is not seen")
    for words in SAID:
        planted += 1
        if not faults(drawing.replace(words, "?")):
            failures.append(f"{words!r} left out is not seen")
    for begin, words in CIRCUITS:
        planted += 1
        if not missing_circuits(re.sub(r"\n  (?=\S)", " ", text).replace(words, "?")):
            failures.append(f"{words!r} left out at {begin!r} is not seen")
    print("\n".join(f"FAILED: {failure}" for failure in failures) or f"all {planted} planted faults are found")
    return 1 if failures else 0


def main(arguments):
    root = pathlib.Path(__file__).resolve().parents[2]
    if arguments and arguments != ["--self-test"]:
        root = pathlib.Path(arguments[0])
    drawing = (root / "docs/wiring-connectors.svg").read_text(encoding="utf-8")
    text = (root / "docs/wiring.md").read_text(encoding="utf-8")
    if arguments == ["--self-test"]:
        return self_test(drawing, text)
    wrong = faults(drawing) + missing_circuits(text)
    print("\n".join(wrong) or f"{len(DB25) + len(MINI_DIN)} pins, each where the manual has it, and what belongs to them")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
