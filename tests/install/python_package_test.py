#!/usr/bin/env python3
"""The Python package as it is installed: metadata, types, and how it finds the library.

usage: python_package_test.py [LIBRARY], in a build folder that cmake --install can use
"""

import importlib.util
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from python_support import BARE, EXAMPLES, LIBRARY, PACKAGE, ROOT

VERSION = ".".join(re.search(rf"CARGOBAY_VERSION_{part} (\d+)", BARE)[1]
                   for part in ("MAJOR", "MINOR", "PATCH"))
# Says which library is in use.
WHICH = """
import cargobay
print(next(line.split()[-1] for line in open("/proc/self/maps") if "libcargobay.so" in line))
"""


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not (LIBRARY.parent / "cmake_install.cmake").exists():
            raise unittest.SkipTest("not a build folder: nothing to install from")
        cls.prefix = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        for component in ("library", "python"):
            subprocess.run(["cmake", "--install", LIBRARY.parent, "--prefix", cls.prefix,
                            "--component", component], check=True, stdout=subprocess.DEVNULL)
        (package,) = cls.prefix.glob("lib/python3*/*-packages/cargobay")
        cls.packages = package.parent

    def run_python(self, program, **environment):
        bare = {name: value for name, value in os.environ.items()
                if not name.startswith("CARGOBAY_")}
        return subprocess.run(
            [sys.executable, "-c", program], text=True, cwd="/", stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**bare, "PYTHONPATH": str(self.packages), **environment})

    def succeeds(self, program, **environment):
        done = self.run_python(program, **environment)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout.strip()

    def test_has_its_metadata(self):
        said = self.succeeds("import cargobay, importlib.metadata as metadata\n"
                             "print(metadata.version('cargobay'), cargobay.version())\n"
                             "print(metadata.metadata('cargobay')['Requires-Python'])")
        self.assertEqual(said, f"{VERSION} {VERSION}\n>=3.11")

    def test_records_what_is_installed(self):
        (info,) = self.packages.glob("cargobay-*.dist-info")
        recorded = {line.split(",")[0] for line in (info / "RECORD").read_text().splitlines()}
        installed = {str(path.relative_to(self.packages)) for path in self.packages.rglob("*")
                     if path.is_file() and path.suffix != ".pyc"}
        self.assertEqual(recorded, installed)
        self.assertIn("cargobay/py.typed", installed)
        modules = {str(path.relative_to(PACKAGE)) for path in PACKAGE.glob("cargobay/**/*.py")}
        self.assertEqual({name for name in installed if name.endswith(".py")}, modules)

    def test_finds_the_library_of_its_own_prefix(self):
        self.assertTrue(self.succeeds(WHICH).startswith(f"{self.prefix}/lib"))

    def test_the_environment_comes_first(self):
        self.assertTrue(self.succeeds(WHICH, CARGOBAY_LIBRARY=str(LIBRARY)).startswith(
            str(LIBRARY.parent)))
        done = self.run_python(WHICH, CARGOBAY_LIBRARY="/no/such/library.so")
        self.assertIn("ImportError", done.stdout)
        self.assertIn("/no/such/library.so", done.stdout)

    def test_a_library_of_another_architecture_is_passed_over(self):
        with tempfile.TemporaryDirectory() as folder:
            prefix = pathlib.Path(folder)
            packages = prefix / self.packages.relative_to(self.prefix)
            shutil.copytree(self.packages, packages)
            (library,) = self.prefix.glob("lib*/**/libcargobay.so.0")
            for triplet in ("aaa-linux-gnu", "zzz-linux-gnu"):
                (prefix / "lib" / triplet).mkdir(parents=True)
            (prefix / "lib/aaa-linux-gnu/libcargobay.so.0").write_bytes(b"\x7fELF of another kind")
            shutil.copy(library, prefix / "lib/zzz-linux-gnu/libcargobay.so.0")
            self.assertIn("/zzz-linux-gnu/", self.succeeds(WHICH, PYTHONPATH=str(packages)))

    def test_then_the_loader_finds_it(self):
        with tempfile.TemporaryDirectory() as folder:
            (library,) = self.prefix.glob("lib*/**/libcargobay.so.0")
            where = self.succeeds(WHICH, PYTHONPATH=str(PACKAGE),
                                  LD_LIBRARY_PATH=str(library.parent))
            self.assertTrue(where.startswith(str(library.parent)), where)
            shutil.copytree(self.packages, f"{folder}/alone")
            done = self.run_python(WHICH, PYTHONPATH=f"{folder}/alone", LD_LIBRARY_PATH="/none")
            if done.returncode == 0:
                self.skipTest("a library is installed on this machine")
            self.assertIn("install libcargobay0, or name the library in CARGOBAY_LIBRARY",
                          done.stdout)

    def test_says_that_the_library_is_too_old(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "old.c")
            source.write_text("int cargobay_open(void) { return 0; }\n")
            subprocess.run(["cc", "-shared", "-o", f"{folder}/old.so", source], check=True)
            done = self.run_python(WHICH, CARGOBAY_LIBRARY=f"{folder}/old.so")
            self.assertIn(f"the library is older than this package, which needs {VERSION}",
                          done.stdout)


class Types(unittest.TestCase):
    def test_are_strict(self):
        if importlib.util.find_spec("mypy") is None:
            self.skipTest("mypy is not installed")
        with tempfile.TemporaryDirectory() as folder:
            for what in (PACKAGE / "cargobay", *sorted(EXAMPLES.glob("*.py"))):
                done = subprocess.run(
                    [sys.executable, "-m", "mypy", "--strict", "--cache-dir", folder, what],
                    text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, cwd=ROOT,
                    env={**os.environ, "MYPYPATH": str(PACKAGE)})
                self.assertEqual(done.returncode, 0, done.stdout)


class Sources(unittest.TestCase):
    def test_are_short(self):
        for path in (*PACKAGE.glob("cargobay/**/*.py"), *EXAMPLES.glob("*.py"),
                     *pathlib.Path(__file__).parent.glob("python*.py")):
            lines = path.read_text().splitlines()
            self.assertLessEqual(len(lines), 400, path)
            self.assertEqual([line for line in lines if len(line) > 100], [], path)


if __name__ == "__main__":
    unittest.main()
