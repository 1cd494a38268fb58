#!/usr/bin/env python3
"""The command and the examples with a container's rights, and with what they then ask for.

usage: rights_test.py BUILD; 77 where this is not run as root, who alone can give rights away.

Each program runs with the capabilities that Docker and podman leave to root, 8 MiB of locked memory
and no real-time priority, as root and as an ordinary user. It must do its work and say what it did
not get. What its message names is then granted, and it must get it.
"""

import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
LOCK_LIMIT = 8 << 20
NOBODY = 65534

CAPABILITIES = {
    "docker": "chown dac_override fsetid fowner mknod net_raw setgid setuid setfcap setpcap"
              " net_bind_service sys_chroot kill audit_write".split(),
    "podman": "chown dac_override fowner fsetid kill net_bind_service setfcap setgid setpcap setuid"
              " sys_chroot".split(),
}


class Container:
    """What a process in it may do: more than at first where options say so."""

    def __init__(self, engine, user, options=()):
        self.user = user
        self.capabilities = list(CAPABILITIES[engine])
        self.limits = {"memlock": LOCK_LIMIT, "rtprio": 0}
        self.added = []
        for option, value in options:
            if option == "cap-add":
                self.added.append(value.lower())
            else:
                name, number = value.split("=")
                self.limits[name] = resource.RLIM_INFINITY if number == "-1" else int(number)

    def _limit(self, name, number):
        """As much of it as may be had here: nobody may go above a hard limit without a capability."""
        kind = {"memlock": resource.RLIMIT_MEMLOCK, "rtprio": resource.RLIMIT_RTPRIO}[name]
        try:
            resource.setrlimit(kind, (number, number))
        except (ValueError, PermissionError):
            hard = resource.getrlimit(kind)[1]
            resource.setrlimit(kind, (hard, hard))

    def run(self, *command, **environment):
        kept = ",".join(["-all"] + ["+" + name for name in self.capabilities + self.added])
        # For an ordinary user they are ambient, as podman sets them.
        ambient = ",".join(["-all"] + ["+" + name for name in self.added if self.user])
        words = ["setpriv", "--bounding-set", kept, "--inh-caps", ambient, "--ambient-caps", ambient]
        if self.user:
            words += ["--reuid", str(self.user), "--regid", str(self.user), "--clear-groups"]

        def limit():
            for name, number in self.limits.items():
                self._limit(name, number)

        return subprocess.run(words + list(command), preexec_fn=limit, capture_output=True, text=True,
                              timeout=60, env={**os.environ, **environment})


def options_in(text):
    """--cap-add X and --ulimit NAME=NUMBER, as a message names them."""
    return re.findall(r"--(cap-add|ulimit) ([\w=-]+)", text)


class Rights(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        # A place that an ordinary user may read, and only root may write.
        cls.folder = tempfile.mkdtemp()
        os.chmod(cls.folder, 0o755)
        for name in ("cargobay", "cargobay-guard", "libcargobay.so.0",
                     "examples/example_first_drive_c", "tests/rights_allocates"):
            shutil.copy(BUILD / name, cls.folder)
        shutil.copytree(ROOT / "hal/python", pathlib.Path(cls.folder, "python"))
        shutil.copy(ROOT / "examples/python/heading.py", cls.folder)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    def run_in(self, container, *command):
        path = pathlib.Path(self.folder, command[0])
        words = [sys.executable, str(path)] if path.suffix == ".py" else [str(path)]
        done = container.run(*words, *command[1:], LD_LIBRARY_PATH=self.folder,
                             CARGOBAY_LIBRARY=self.folder + "/libcargobay.so.0",
                             CARGOBAY_GUARD=self.folder + "/cargobay-guard",
                             PYTHONPATH=self.folder + "/python",
                             PYTHONDONTWRITEBYTECODE="1")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done

    def in_each_container(self, body):
        for engine in CAPABILITIES:
            for user in (0, NOBODY):
                with self.subTest(engine=engine, user=user):
                    body(engine, user)

    def expect_remedies(self, said):
        self.assertIn("without CAP_SYS_NICE", said)
        self.assertIn("without CAP_IPC_LOCK", said)
        self.assertNotIn("real-time budget", said)
        options = options_in(said)
        for wanted in (("cap-add", "SYS_NICE"), ("ulimit", "rtprio=95"),
                       ("cap-add", "IPC_LOCK"), ("ulimit", "memlock=-1")):
            self.assertIn(wanted, options, said)
        return options

    def drive(self, engine, user):
        words = ("drive", "--duration", "1")
        done = self.run_in(Container(engine, user), "cargobay", *words)
        self.assertIn("ordinary scheduling", done.stdout)
        self.assertRegex(done.stdout, r"the loop's memory locked: [0-9.]+ of 8 MiB allowed")
        options = self.expect_remedies(done.stdout + done.stderr)
        granted = Container(engine, user, options)
        result = json.loads(self.run_in(granted, "cargobay", *words, "--json", "-").stdout)
        self.assertEqual(result["scheduler"], "SCHED_FIFO")
        self.assertTrue(result["memory_locked"])
        self.assertNotIn("memory", [finding["check"] for finding in result["findings"]
                                    if finding["verdict"] != "good"])

    def test_drive(self):
        self.in_each_container(self.drive)

    def library_program(self, name):
        def body(engine, user):
            done = self.run_in(Container(engine, user), name)
            options = self.expect_remedies(done.stderr)
            done = self.run_in(Container(engine, user, options), name)
            self.assertNotIn("SCHED_FIFO", done.stderr)
            self.assertNotIn("memory", done.stderr)

        self.in_each_container(body)

    def test_example_in_c(self):
        self.library_program("example_first_drive_c")

    def test_example_in_python(self):
        self.library_program("heading.py")

    def test_program_that_allocates(self):
        self.library_program("rights_allocates")


if __name__ == "__main__":
    if os.geteuid() != 0:
        sys.exit(77)
    unittest.main(verbosity=2)
