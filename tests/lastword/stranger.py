#!/usr/bin/env python3
"""A stranger's `cargobay-guard`: wherever it was put, it is not run.

What is planted is a script that leaves a trace. Where the one at a trusted place is run the trace is
there: the trap works.

usage: stranger.py BUILD [--only EXPRESSION] [--lanes N]
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

from harness import Build, Program, Skip, case, check, run  # noqa: E402

_NOBODY = 65534


class Plant:
    """A folder of its own in a folder of its own, x/private, and a script that leaves a trace."""

    def __init__(self):
        self.above = pathlib.Path(tempfile.mkdtemp(prefix="cargobay-stranger-"))
        self.above.chmod(0o755)
        self.private = self.above / "private"
        self.private.mkdir()
        self._traces = self.above / "traces"
        self._traces.mkdir()
        self._traces.chmod(0o1777)
        self.trace = self._traces / "trace"

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.above, ignore_errors=True)

    def script(self, folder):
        path = folder / "cargobay-guard"
        # Another process writes it: a child forked meanwhile would keep it open, and "text busy".
        subprocess.run(["tee", path], input=f"#!/bin/sh\nid > {self.trace}\n".encode(),
                       stdout=subprocess.DEVNULL, check=True)
        path.chmod(0o755)
        return path

    def program(self, name):
        """A copy of a built program, in the private folder."""
        subprocess.run(["cp", Build.path(name), self.private], check=True)
        return str(self.private / os.path.basename(name))

    def check_not_run(self):
        check(not self.trace.exists(),
              f"it was run: {self.trace.read_text() if self.trace.exists() else ''}")


def drive(create, program, **options):
    """Drives by a copy of the command or of the C program: its exit code and its words."""
    name = os.path.basename(program)
    words = (["drive", "--port", create.link, "--duration", "0.3"] if name == "cargobay"
             else [create.link, "driving", "return"])
    with Program(create, [program, *words], **options) as process:
        code = process.end()
        took_s = create.settles(process.ended_at)
        check(took_s is not None, f"the robot is {create.now()}")
        return code, process.err


PROGRAMS = ("cargobay", "tests/lastword_owner_c")


def each_program(function):
    for name in PROGRAMS:
        case(name)(function)
    return function


@each_program
def beside_the_program(create, name):
    with Plant() as plant:
        plant.script(plant.private)
        drive(create, plant.program(name))
        plant.check_not_run()


@each_program
def above_the_program(create, name):
    with Plant() as plant:
        plant.script(plant.above)
        drive(create, plant.program(name))
        plant.check_not_run()


@each_program
def in_the_path_and_the_working_folder(create, name):
    with Plant() as plant:
        stranger = plant.above / "stranger"
        stranger.mkdir()
        plant.script(stranger)
        path = f"{stranger}:.:{os.environ['PATH']}"
        drive(create, plant.program(name), environment={"PATH": path}, cwd=stranger)
        plant.check_not_run()


@each_program
def beside_the_library_path(create, name):
    """What the dynamic linker is told is not what is asked for a guard either."""
    with Plant() as plant:
        plant.script(plant.above)
        plant.script(plant.private)
        drive(create, plant.program(name), environment={"LD_LIBRARY_PATH": str(plant.private)})
        plant.check_not_run()


@each_program
def named_by_its_user(create, name):
    """The one way to name another: it is run, so the trap works."""
    with Plant() as plant:
        drive(create, plant.program(name),
              environment={"CARGOBAY_GUARD": str(plant.script(plant.private))})
        check(plant.trace.exists(), "the guard that the user named was not run")


def refused(create, plant, name, path, *reasons):
    code, words = drive(create, plant.program(name), environment={"CARGOBAY_GUARD": str(path)})
    plant.check_not_run()
    check(code == 1, f"exit code {code}: {words}")
    check(str(path) in words or str(path.resolve().parent) in words,
          f"it does not say which: {words}")
    check(any(reason in words for reason in reasons), f"it does not say why: {words}")


@each_program
def writable_by_others(create, name):
    for mode in (0o757, 0o775, 0o777):
        with Plant() as plant:
            path = plant.script(plant.private)
            path.chmod(mode)
            refused(create, plant, name, path, "writable", "write")


@each_program
def in_a_folder_writable_by_others(create, name):
    for mode in (0o757, 0o775, 0o777):
        with Plant() as plant:
            path = plant.script(plant.private)
            plant.private.chmod(mode)
            refused(create, plant, name, path, "writable", "write")


@each_program
def below_a_folder_writable_by_others(create, name):
    with Plant() as plant:
        path = plant.script(plant.private)
        plant.above.chmod(0o777)
        refused(create, plant, name, path, "writable", "write")


def _root():
    if os.geteuid() != 0:
        raise Skip("only root can give a file to another user")


@each_program
def of_another_user(create, name):
    _root()
    with Plant() as plant:
        path = plant.script(plant.private)
        os.chown(path, _NOBODY, _NOBODY)
        refused(create, plant, name, path, "belongs to", "owned by", "owner")


@each_program
def in_a_folder_of_another_user(create, name):
    _root()
    with Plant() as plant:
        path = plant.script(plant.private)
        os.chown(plant.private, _NOBODY, _NOBODY)
        refused(create, plant, name, path, "belongs to", "owned by", "owner")


@each_program
def behind_a_link_to_another_users(create, name):
    """What counts is where the link leads."""
    _root()
    with Plant() as plant:
        stranger = plant.above / "stranger"
        stranger.mkdir()
        path = plant.script(stranger)
        link = plant.private / "cargobay-guard"
        link.symlink_to(path)
        os.chown(stranger, _NOBODY, _NOBODY)
        refused(create, plant, name, link, "belongs to", "owned by", "owner")


@case("environment")
@case("beside")
def of_a_program_with_more_rights_than_its_user(create, where):
    """AT_SECURE: set-user-ID root, run by nobody, who has planted a guard."""
    _root()
    probe = subprocess.run(["setpriv", "--reuid", str(_NOBODY), "--regid", str(_NOBODY),
                            "--clear-groups", "ls", Build.path("libcargobay.so.0")],
                           capture_output=True, check=False)
    if probe.returncode != 0:
        raise Skip("nobody may not read the build's folder")
    with Plant() as plant:
        stranger = plant.above / "stranger"
        stranger.mkdir()
        path = plant.script(stranger)
        if where == "beside":
            plant.script(plant.private)
        for each in (stranger, path):
            os.chown(each, _NOBODY, _NOBODY)
        program = plant.program("tests/lastword_owner_c")
        os.chmod(program, 0o4755)
        words = ["setpriv", "--reuid", str(_NOBODY), "--regid", str(_NOBODY), "--clear-groups",
                 program, create.link, "driving", "return"]
        environment = {"CARGOBAY_GUARD": str(path)} if where == "environment" else {}
        with Program(create, words, environment) as process:
            process.end()
            # It got as far as its guard: the one of its build, or none.
            check("open" in process.out.splitlines() or "no guard" in process.err,
                  f"it has no rights of root: {process.err}")
            took_s = create.settles(process.ended_at)
        plant.check_not_run()
        check(took_s is not None, f"the robot is {create.now()}")


run()
