#!/usr/bin/env python3
"""The Python package against cargobay.h: structs, numbers and functions.

usage: python_layout_test.py [LIBRARY]
"""

import ctypes
import enum
import pathlib
import re
import subprocess
import tempfile
import unittest

from python_support import BARE, LIBRARY, PACKAGE, ROOT

from cargobay import _library, _structs, enums, errors

SCALARS = {
    "int": ctypes.c_int, "int32_t": ctypes.c_int32, "int64_t": ctypes.c_int64,
    "uint8_t": ctypes.c_uint8, "uint32_t": ctypes.c_uint32, "uint64_t": ctypes.c_uint64,
    "size_t": ctypes.c_size_t, "double": ctypes.c_double,
}
HANDLES = ("sim", "robot", "histogram")


def python_name(name):
    return "".join(word.title() for word in name.split("_"))


def ctypes_of(words):
    """The type of a parameter or result, as ctypes has it: "const char*"."""
    words = re.sub(r"\bconst\b", "", words).replace(" ", "")
    if words == "void*":
        return ctypes.c_void_p
    if words == "char*":
        return ctypes.c_char_p
    if words == "cargobay_control":
        return _structs.CONTROL
    stars = words.count("*")
    words = words.rstrip("*")
    if words.startswith("structcargobay_"):
        name = words.removeprefix("structcargobay_")
        if name in HANDLES:
            kind, stars = ctypes.c_void_p, stars - 1
        else:
            kind = getattr(_structs, python_name(name))
    else:
        kind = SCALARS[words]
    for _ in range(stars):
        kind = ctypes.POINTER(kind)
    return kind


def parameters_of(words):
    """Their types: the last word of each is its name."""
    if words.strip() == "void":
        return []
    return [ctypes_of(re.sub(r"\w+$", "", word.strip())) for word in words.split(",")]


def structs():
    """Each struct with its members."""
    for name, body in re.findall(r"struct cargobay_(\w+) \{(.*?)\n\};", BARE, flags=re.S):
        # The last word of a declaration, or the one before "[" or, for a function, in "(*)".
        members = []
        for text in filter(str.strip, body.split(";")):
            pointer = re.search(r"\(\*(\w+)\)", text)
            members.append(pointer[1] if pointer else re.search(r"(\w+)(\[\w+\])?\s*$", text)[1])
        yield name, members


class Layout(unittest.TestCase):
    def test_structs_are_laid_out_as_in_c(self):
        found = list(structs())
        self.assertGreaterEqual(len(found), 16)
        lines = []
        for name, members in found:
            lines.append(f'printf("{name} %zu\\n", sizeof(struct cargobay_{name}));')
            lines += [f'printf("{name}.{member} %zu %zu\\n",'
                      f' offsetof(struct cargobay_{name}, {member}),'
                      f' sizeof(((struct cargobay_{name} *)0)->{member}));' for member in members]
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder, "layout.c")
            source.write_text('#include <cargobay.h>\n#include <stdio.h>\nint main(void) {\n'
                              + "\n".join(lines) + "\n}\n")
            subprocess.run(["cc", "-I", ROOT / "hal/c", source, "-o", f"{folder}/layout"],
                           check=True)
            in_c = subprocess.run([f"{folder}/layout"], check=True, text=True,
                                  stdout=subprocess.PIPE).stdout.splitlines()
        in_python = []
        for name, _ in found:
            struct = getattr(_structs, python_name(name))
            in_python.append(f"{name} {ctypes.sizeof(struct)}")
            for member, *_ in struct._fields_:
                descriptor = getattr(struct, member)
                in_python.append(f"{name}.{member} {descriptor.offset} {descriptor.size}")
        self.assertEqual(in_c, in_python)

    def test_members_have_the_type_of_c(self):
        bodies = dict(re.findall(r"struct cargobay_(\w+) \{(.*?)\n\};", BARE, flags=re.S))
        for name, body in bodies.items():
            for member, kind, *_ in getattr(_structs, python_name(name))._fields_:
                declared = re.search(rf"([\w ]+[\w*])\s+\*?{member}(?:\[(\d+)\])?;", body)
                if declared is None:  # a function
                    self.assertIs(kind, _structs.PROGRESS, f"{name}.{member}")
                    continue
                with self.subTest(struct=name, member=member):
                    words = declared[1].strip()
                    if declared[2]:
                        element = ctypes.c_char if words == "char" else ctypes_of(words)
                        self.assertIs(kind, element * int(declared[2]))
                    else:
                        self.assertIs(kind, ctypes_of(words))

    def test_no_struct_is_only_in_python(self):
        ours = {name for name, kind in vars(_structs).items()
                if isinstance(kind, type) and issubclass(kind, ctypes.Structure)
                and kind.__module__ == _structs.__name__ and hasattr(kind, "_fields_")}
        self.assertEqual(ours, {python_name(name) for name, _ in structs()})

    def test_functions_have_the_parameters_of_c(self):
        declared = dict()
        for result, name, parameters in re.findall(
                r"^((?:const )?\w+\*?) cargobay_(\w+)\(([^)]*)\);", BARE, flags=re.M):
            declared[name] = (ctypes_of(result), parameters_of(parameters))
        self.assertGreater(len(declared), 55)
        ours = {**_library.PLAIN,
                **{name: (ctypes.c_int, kinds) for name, kinds in _library.CHECKED.items()}}
        self.assertEqual(set(declared), set(ours))
        for name, types in declared.items():
            self.assertEqual(types, ours[name], name)

    def test_callbacks_have_the_parameters_of_c(self):
        pointers = dict(re.findall(r"int \(\*(\w+)\)\(([^)]*)\)", BARE))
        for name, ours in (("progress", _structs.PROGRESS), ("cargobay_control", _structs.CONTROL)):
            self.assertEqual(list(ours._argtypes_), parameters_of(pointers[name]), name)
            self.assertIs(ours._restype_, ctypes.c_int)

    def test_what_the_library_exports_is_declared(self):
        symbols = subprocess.run(["nm", "-D", "--defined-only", LIBRARY], check=True, text=True,
                                 stdout=subprocess.PIPE).stdout
        exported = set(re.findall(r" T cargobay_(\w+)", symbols))
        self.assertEqual(exported, {*_library.PLAIN, *_library.CHECKED})

    def test_each_function_is_called(self):
        code = "".join(path.read_text() for path in PACKAGE.glob("cargobay/*.py")
                       if path.name not in ("_library.py", "_structs.py"))
        code += (PACKAGE / "cargobay/_library.py").read_text().split("def _places")[1]
        unused = {name for name in {*_library.CHECKED, *_library.PLAIN}
                  if f"cargobay_{name}" not in code and f'"{name}"' not in code}
        self.assertEqual(unused, {"version_number"})


class Numbers(unittest.TestCase):
    PREFIXES = {"error": "E", "event_kind": "EVENT", "output_kind": "OUTPUT"}
    NAMES = {"error": "ErrorCode"}

    def test_are_those_of_c(self):
        seen = set()
        for name, body in re.findall(r"enum cargobay_(\w+) \{(.*?)\}", BARE, flags=re.S):
            ours = getattr(enums, self.NAMES.get(name, python_name(name)))
            prefix = self.PREFIXES.get(name, name.upper()) + "_"
            in_c = {key.removeprefix(prefix): eval(value) for key, value in
                    re.findall(r"CARGOBAY_(\w+) = ([-0-9< ]+)", body)}
            self.assertEqual(in_c, {member.name: int(member) for member in ours}, name)
            seen.add(ours)
        self.assertGreaterEqual(len(seen), 16)
        ours = {kind for kind in vars(enums).values() if isinstance(kind, type)
                and issubclass(kind, enum.Enum) and kind.__module__ == enums.__name__}
        self.assertEqual(ours - seen, {enums.Answer, enums._Number})

    def test_each_code_has_its_exception(self):
        for code in enums.ErrorCode:
            if code == enums.ErrorCode.OK:
                continue
            error = errors.error_of(int(code), "words")
            self.assertIs(error.code, code)
            self.assertNotIn(type(error), (errors.Error, *errors.Error.__subclasses__()), code)
            self.assertEqual(str(error), f"words (CARGOBAY_E_{code.name})")

    def test_of_a_newer_library_are_no_errors(self):
        self.assertEqual(enums.EventKind(99), 99)
        self.assertEqual(enums.EventKind(99).name, "UNKNOWN_99")
        self.assertEqual(int(enums.Hazard(1 << 20)), 1 << 20)
        error = errors.error_of(-99, "words")
        self.assertIs(type(error), errors.Error)
        self.assertEqual(error.code, -99)
        with self.assertRaises(ValueError):
            enums.Mode("safe")

    def test_version_is_that_of_the_header(self):
        numbers = tuple(int(re.search(rf"CARGOBAY_VERSION_{part} (\d+)", BARE)[1])
                        for part in ("MAJOR", "MINOR", "PATCH"))
        self.assertEqual(_library.VERSION, numbers)


if __name__ == "__main__":
    unittest.main()
