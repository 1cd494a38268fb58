"""What the tests of the Python package share.

Each of them is run as: python_NAME_test.py [LIBRARY]; by itself build/release/libcargobay.so.0, its
guard beside it.
"""

import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "hal/python"
EXAMPLES = ROOT / "examples/python"
LIBRARY = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 and not sys.argv[1].startswith("-")
                       else ROOT / "build/release/libcargobay.so.0").resolve()
os.environ["CARGOBAY_LIBRARY"] = str(LIBRARY)
os.environ.setdefault("CARGOBAY_GUARD", str(LIBRARY.parent / "cargobay-guard"))
os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
sys.dont_write_bytecode = True
sys.path.insert(0, str(PACKAGE))

HEADER = (ROOT / "hal/c/cargobay.h").read_text()
BARE = re.sub(r"/\*.*?\*/", "", HEADER, flags=re.S)

# Imported by a program of a test, which is run by run().
BEGIN = """
import atexit, datetime, fcntl, gc, os, pty, signal, struct, sys, tempfile
import threading, time
from cargobay import *
"""


def virtual():
    """A virtual Create in virtual time."""
    from cargobay import Sim, SimTime
    return Sim(time=SimTime.VIRTUAL)


def run(program, *arguments, timeout=60, **environment):
    """Runs a program that has the package's names; returns what became of it."""
    return subprocess.run(
        [sys.executable, "-c", BEGIN + program, *arguments], text=True, timeout=timeout,
        env={**os.environ, "PYTHONFAULTHANDLER": "1", "PYTHONPATH": str(PACKAGE), **environment},
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
