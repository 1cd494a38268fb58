#!/usr/bin/env python3
"""Exported drives in the hands of others: Foxglove's reader (npm @mcap/core), the package's
cargobay.tables, and whoever plants a fault.

usage: others_read_it.py BUILD
  BUILD  the build folder, with cargobay, libcargobay.so.0 and the test's virtual_drive
"""

import csv
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import warnings
import zlib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]
SKIPPED = 77
MINUTES = 10
FRAMES = MINUTES * 4000
TOPICS = ("states", "sensors", "events", "commands")

BUILD = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else "build/dev").resolve()
os.environ["CARGOBAY_LIBRARY"] = str(BUILD / "libcargobay.so.0")
os.environ["CARGOBAY_COMMAND"] = str(BUILD / "cargobay")
sys.path[:0] = [str(ROOT / "hal/python"), str(ROOT / "tests/npm")]
import npm_packages  # noqa: E402

FOLDER = pathlib.Path(tempfile.mkdtemp())
MODULES = BUILD / "tests/export_npm"


def path(name):
    return str(FOLDER / name)


def run(*words, **options):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True,
                          check=False, **options)


def export(*words):
    done = run(BUILD / "cargobay", "export", *words)
    assert done.returncode == 0, done.stderr
    return done.stdout


def node(*words):
    return run("node", HERE / "read_mcap.mjs", MODULES / "node_modules", *words)


def install_modules():
    if reason := npm_packages.missing(HERE, MODULES):
        print(f"SKIPPED: {reason}")
        sys.exit(SKIPPED)


def setUpModule():
    done = run(BUILD / "tests/virtual_drive", FRAMES, path("drive.rec"))
    assert done.returncode == 0, done.stderr
    begin = time.monotonic()
    export(path("drive.rec"), "--csv", path("drive.csv"), "--jsonl", path("drive.jsonl"),
           "--mcap", path("drive.mcap"))
    print(f"{MINUTES} minutes were exported to three files in {time.monotonic() - begin:.1f} s")
    for name in ("drive.rec", "drive.csv", "drive.jsonl", "drive.mcap"):
        print(f"  {name} {os.path.getsize(path(name)) / 1e6:.1f} MB")


def tearDownModule():
    shutil.rmtree(FOLDER)


def flat(record, prefix=""):
    """As the cells of CSV, with the digits of the JSON."""
    for name, value in record.items():
        if isinstance(value, dict):
            yield from flat(value, f"{prefix}{name}.")
        elif isinstance(value, list):
            yield prefix + name, ";".join(value) or "none"
        elif isinstance(value, bool):
            yield prefix + name, "1" if value else "0"
        else:
            yield prefix + name, value


class Foxglove(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        done = node(path("drive.mcap"), path("messages.jsonl"))
        assert done.returncode == 0, done.stderr
        cls.found = json.loads(done.stdout)

    def test_its_reader_finds_every_record(self):
        counts = self.found["counts"]
        self.assertEqual(counts["/states"], FRAMES)
        self.assertGreaterEqual(counts["/sensors"], FRAMES)
        self.assertGreaterEqual(counts["/commands"], FRAMES)
        self.assertGreaterEqual(counts["/events"], 2 * (FRAMES // 1000) - 1)
        self.assertEqual(counts["/pose"], FRAMES)
        self.assertEqual(counts["/tf"], FRAMES)
        self.assertEqual(counts["/log"], counts["/events"])
        self.assertGreater(counts["/path"], 10)
        self.assertGreater(self.found["chunks"], 10)
        self.assertEqual(self.found["metadata"], [{"baud": "57600", "note": "to and fro",
                                                   "software": "test"}])

    def test_what_it_reads_is_the_csv_to_the_last_digit(self):
        with open(path("messages.jsonl"), encoding="utf-8") as messages, \
             open(path("drive.csv"), encoding="utf-8", newline="") as table:
            rows = csv.reader(table)
            header = next(rows)
            compared = 0
            for line in messages:
                record = json.loads(line, parse_float=str, parse_int=str)
                if record["topic"] not in TOPICS:
                    continue
                cells = {name: cell for name, cell in zip(header, next(rows), strict=True) if cell}
                self.assertEqual(cells, dict(flat(record)))
                compared += 1
            self.assertEqual(next(rows, None), None)
        self.assertGreater(compared, 3 * FRAMES)

    def test_the_lines_of_json_are_the_same_too(self):
        with open(path("messages.jsonl"), encoding="utf-8") as messages, \
             open(path("drive.jsonl"), encoding="utf-8") as lines:
            own = (line for line in messages
                   if line.startswith(tuple(f'{{"topic":"{topic}"' for topic in TOPICS)))
            for one, other in zip(own, lines, strict=True):
                self.assertEqual(one, other)


class Tables(unittest.TestCase):
    """The reader in Python; without numpy it says what is missing."""

    @classmethod
    def setUpClass(cls):
        try:
            import numpy
        except ImportError:
            raise unittest.SkipTest("no numpy: apt-get install python3-numpy") from None
        from cargobay import tables
        cls.numpy, cls.tables = numpy, tables
        cls.drive = tables.read(path("drive.mcap"))

    def test_they_have_a_row_for_each_record(self):
        states = self.drive["states"]
        self.assertEqual({len(column) for column in states.values()}, {FRAMES})
        self.assertEqual(states["tick"].dtype, self.numpy.int64)
        self.assertEqual(states["target_mm_s.left"].dtype, self.numpy.float64)
        self.assertEqual(states["setpoint_lapsed"].dtype, self.numpy.bool_)
        self.assertTrue((self.numpy.diff(states["tick"]) == 1).all())
        self.assertTrue(self.numpy.isnan(states["reading.distance_mm"]).any())
        self.assertIn(("bump_left",), list(states["bumps"]))
        self.assertGreater(abs(states["pose.x_mm"][-1]), 0.0)

    def test_they_are_the_same_from_each_format(self):
        for name in ("drive.jsonl", "drive.rec"):
            other = self.tables.read(path(name))
            for topic in TOPICS:
                self.assertEqual(other[topic].keys(), self.drive[topic].keys())
                for column, values in self.drive[topic].items():
                    self.numpy.testing.assert_array_equal(other[topic][column], values)

    def test_they_have_other_channels_if_asked(self):
        found = self.tables.read(path("drive.mcap"), ["pose"])
        self.assertEqual(len(found["pose"]["pose.position.x"]), FRAMES)

    def test_csv_and_others_are_refused_with_what_to_do(self):
        for name, words in (("drive.csv", "pandas.read_csv"), ("x.txt", "neither MCAP nor")):
            pathlib.Path(path("x.txt")).write_text("hello")
            with self.assertRaisesRegex(ValueError, words):
                self.tables.read(path(name))
        pathlib.Path(path("y.jsonl")).write_text('{"topic":"states","tick":1}\n{"tick":\n')
        with self.assertRaisesRegex(ValueError, "no record in line 2"):
            self.tables.read(path("y.jsonl"))


class WithoutNumpy(unittest.TestCase):
    def test_it_says_what_to_install(self):
        code = ("import sys; sys.modules['numpy'] = None\n"
                "from cargobay import tables\n"
                f"tables.read({path('drive.mcap')!r})")
        done = run(sys.executable, "-c", code, env=dict(os.environ, PYTHONPATH=sys.path[0]))
        self.assertEqual(done.returncode, 1)
        self.assertIn("ImportError: cargobay.tables makes numpy arrays", done.stderr)
        self.assertIn("apt-get install python3-numpy", done.stderr)


class Faults(unittest.TestCase):
    """What is damaged is found, by Foxglove's reader and by ours."""

    @classmethod
    def setUpClass(cls):
        done = run(BUILD / "tests/virtual_drive", 3000, path("short.rec"))
        assert done.returncode == 0, done.stderr
        export(path("short.rec"), "--mcap", path("short.mcap"))
        cls.sound = pathlib.Path(path("short.mcap")).read_bytes()

    def refused(self, data, by_ours, by_node=True):
        from cargobay.tables import _mcap
        with self.assertRaisesRegex(_mcap.Damaged, by_ours):
            for _ in _mcap.File(bytes(data)).messages():
                pass
        if by_node:
            pathlib.Path(path("bad.mcap")).write_bytes(data)
            self.assertNotEqual(node(path("bad.mcap")).returncode, 0)

    def record(self, wanted, number=0):
        """The offset of a record with this opcode."""
        at = 8
        while True:
            opcode, length = struct.unpack_from("<BQ", self.sound, at)
            if opcode == wanted:
                if number == 0:
                    return at
                number -= 1
            at += 9 + length

    def with_summary_checksum(self, data):
        footer = len(data) - 8 - 29
        begin = struct.unpack_from("<Q", data, footer + 9)[0]
        struct.pack_into("<I", data, footer + 25, zlib.crc32(data[begin:footer + 25]))
        return data

    def test_the_file_itself_is_sound(self):
        from cargobay.tables import _mcap
        file = _mcap.File(self.sound)
        self.assertTrue(file.finished)
        self.assertGreater(len(list(file.messages())), 3 * 3000)
        self.assertEqual(node(path("short.mcap")).returncode, 0)

    def test_a_byte_of_a_chunk(self):
        data = bytearray(self.sound)
        data[self.record(0x06) + 1000] ^= 1
        self.refused(data, "wrong checksum")

    def test_the_checksum_of_a_chunk(self):
        data = bytearray(self.sound)
        data[self.record(0x06) + 9 + 24] ^= 1
        self.refused(data, "wrong checksum")

    def test_a_byte_between_the_chunks(self):
        data = bytearray(self.sound)
        data[self.record(0x03) + 9 + 20] ^= 1
        self.refused(data, "its data are not what was written", by_node=False)

    def test_a_byte_of_the_summary(self):
        data = bytearray(self.sound)
        data[self.record(0x08) + 9] ^= 1
        self.refused(data, "its index is not what was written", by_node=False)

    def test_the_offset_of_a_chunk_in_the_index(self):
        data = bytearray(self.sound)
        struct.pack_into("<Q", data, self.record(0x08) + 9 + 16, 4711)
        self.refused(self.with_summary_checksum(data), "a chunk is at byte 4711")

    def test_the_offset_of_a_message_in_its_index(self):
        data = bytearray(self.sound)
        at = self.record(0x07)
        struct.pack_into("<Q", data, at + 9 + 6 + 8, 7)
        end = self.record(0x0F)
        struct.pack_into("<I", data, end + 9, zlib.crc32(data[:end]))
        self.refused(data, "leads to no message")

    def test_the_length_of_a_message_index(self):
        data = bytearray(self.sound)
        at = self.record(0x07) + 9 + 2
        struct.pack_into("<I", data, at, struct.unpack_from("<I", data, at)[0] - 1)
        self.refused(data, "not as long as it should be", by_node=False)

    def test_the_offset_of_a_message_index(self):
        data = bytearray(self.sound)
        struct.pack_into("<Q", data, self.record(0x08) + 9 + 32 + 4 + 2, 9)
        self.refused(self.with_summary_checksum(data), "is at byte 9")

    def test_the_number_of_messages(self):
        data = bytearray(self.sound)
        struct.pack_into("<Q", data, self.record(0x0B) + 9, 1)
        self.refused(self.with_summary_checksum(data), "it should have 1 messages")

    def test_an_end_that_is_missing_is_no_damage(self):
        from cargobay import tables
        from cargobay.tables import _mcap
        cut = self.sound[:self.record(0x06, 2) + 100]
        file = _mcap.File(cut)
        self.assertFalse(file.finished)
        self.assertGreater(len(list(file.messages())), 100)
        pathlib.Path(path("cut.mcap")).write_bytes(cut)
        try:
            import numpy  # noqa: F401
        except ImportError:
            return
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            tables.read(path("cut.mcap"))
        self.assertIn("was not finished", str(caught[0].message))


if __name__ == "__main__":
    install_modules()
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
