#!/usr/bin/env python3
"""cargobay.hpp has everything that cargobay.h has: each function is called, each enumerator has its
twin in the same order, each member of a struct is copied, and to the member of the same name.
Expected has no member that std::expected lacks.

usage: tests/capi/cpp_coverage.py [--self-test]
"""
import pathlib
import re
import sys

_FOLDER = pathlib.Path(__file__).resolve().parents[2] / "hal" / "c"
# What has another name, or no twin: texts of C go into std::string or into Error.
_RENAMED = {"real": "real_time", "virtual": "virtual_time"}
_WITHOUT_TWIN = {"size", "reserved", "message_size", "progress_context"}
_OPTIONS_WITHOUT_TWIN = {"message", "progress"}
_IN_EXPECTED = {"Expected", "has_value", "bool", "error", "value_or", "value_or_null"}


def _code(text):
    text = re.sub(r"/\*.*?\*/", " ", text, flags=re.DOTALL)
    return re.sub(r"//[^\n]*", "", text)


def _members(body):
    for declaration in body.split(";"):
        named = re.search(r"\(\*(\w+)\)", declaration) or re.search(
            r"(\w+)(?:\[\d+\])?\s*$", declaration)
        if named and not named[1].startswith("reserved"):
            yield named[1]


def _pairs(body):
    """(member of C, member of C++) of each copy in a function."""
    for line in re.sub(r"\s+", " ", body).replace(" .", "\n.").replace(";", ";\n").splitlines():
        if copied := re.search(r"\.(\w+) = .*?\bplain\.(\w+)", line):
            yield copied[2], copied[1]
        elif copied := re.search(r"\bplain\.(\w+) = .*?\b(?:options|event)\.(\w+)", line):
            yield copied[1], copied[2]
        elif copied := re.search(r"\.(\w+) = (?:wheels|twist)\.(\w+)", line):
            yield copied[1], copied[2]
        elif copied := re.search(r"memcpy\(plain\.(\w+), event\.(\w+)", line):
            yield copied[1], copied[2]
        elif copied := re.search(r"memcpy\(\w+\.(\w+)(?:\.data\(\))?, plain\.(\w+)", line):
            yield copied[2], copied[1]
        elif copied := re.search(r"\boutput\.(\w+) = .*?\b(\w+)_\b", line):
            yield copied[1], copied[2]


def _functions(wrapper):
    """{struct of C: [the functions that copy it]}"""
    found = {}
    for start, struct in ((m.start(), m[1]) for m in re.finditer(
            r"typed\(const (cargobay_\w+)& plain\)", wrapper)):
        found.setdefault(struct, []).append(wrapper[start:wrapper.index("\n}\n", start)])
    for struct, start, end in (
            ("cargobay_event", "cargobay_event plain_of(", "\n}\n"),
            ("cargobay_wheels", "cargobay_wheels plain_of(", "\n}\n"),
            ("cargobay_twist", "cargobay_twist plain_of(", "\n}\n"),
            ("cargobay_sim_options", "sized<cargobay_sim_options>()", "\n  }\n"),
            ("cargobay_options", "sized<cargobay_options>()", "\n  }\n"),
            ("cargobay_output", "int fill(cargobay_output& output)", "\n  }\n")):
        at = wrapper.index(start)
        found.setdefault(struct, []).append(wrapper[at:wrapper.index(end, at)])
    return found


def _complaints_about_structs(header, wrapper):
    functions = _functions(wrapper)
    for struct, body in re.findall(r"struct (cargobay_\w+) \{(.*?)\};", header, re.DOTALL):
        if struct == "cargobay_note":  # by position; a test plays a song
            continue
        if struct not in functions:
            yield f"nothing copies {struct}"
        for function in functions.get(struct, []):
            pairs = dict(_pairs(function))
            for member in _members(body):
                if member in _WITHOUT_TWIN or (
                        struct == "cargobay_options" and member in _OPTIONS_WITHOUT_TWIN):
                    continue
                twin = pairs.get(member)
                if twin is None:
                    yield f"{struct}.{member} is not copied"
                elif twin not in (member, member.removesuffix("_ns")):
                    yield f"{struct}.{member} is copied to {twin}"


def _complaints_about_enumerators(header, wrapper):
    twins = [re.findall(r"(\w+) = (CARGOBAY_\w+)", body)
             for body in re.findall(r"enum class \w+ : [\w:]+ \{(.*?)\}", wrapper, re.DOTALL)]
    for enum, body in re.findall(r"enum (cargobay_\w+) \{(.*?)\}", header, re.DOTALL):
        wanted = re.findall(r"(CARGOBAY_\w+) =", body)
        if wanted not in [[name for _, name in twin] for twin in twins]:
            yield f"no enum class is {enum}, in its order"
    for twin, name in (pair for each in twins for pair in each):
        words = name.lower()
        if not any(words.endswith("_" + end) for end, other in _RENAMED.items() if other == twin):
            if not re.fullmatch(r"cargobay_([a-z]+_)*?" + twin, words):
                yield f"{twin} is {name}"


def complaints(header, wrapper):
    header, wrapper = _code(header), _code(wrapper)
    functions = set(re.findall(r"^[a-z].*?\b(cargobay_\w+)\(", header, re.MULTILINE))
    if len(functions) < 50:
        yield "found hardly any function"
    for function in sorted(functions):
        if not re.search(rf"\b{function}\b(?! )", wrapper):
            yield f"nothing calls {function}()"
    yield from _complaints_about_structs(header, wrapper)
    yield from _complaints_about_enumerators(header, wrapper)
    bodies = re.findall(r"class \[\[nodiscard\]\] Expected(?:<void>)? \{(.*?)\n\};", wrapper,
                        re.DOTALL)
    if len(bodies) != 2:
        yield "found no Expected"
    for name in re.findall(r"^  (?! )[\w:&*<> ]*?(?<!operator)\b(\w+)\([^;{]*\)[^;{]*[{;:]",
                           "".join(bodies), re.MULTILINE):
        if name not in _IN_EXPECTED | {"requires"}:
            yield f"std::expected has no {name}()"


_FAULTS = (
    ("a function that is missing", r"cargobay_rearm\(handle\(\)\)", "0"),
    ("an enumerator that is missing", r"  charger = CARGOBAY_HAZARD_CHARGER,\n", ""),
    ("an enumerator of another name", r"safe = CARGOBAY_MODE_SAFE", "save = CARGOBAY_MODE_SAFE"),
    ("two enumerators out of order", r"(  off = \w+,\n)(  passive = \w+,\n)", r"\2\1"),
    ("a member that is not read", r"\.bumps = Bumps\{plain\.bumps\},", ""),
    ("a member that is copied to another", r"(\.frames_bad = plain\.frames_)bad", r"\1lost"),
    ("a member that is given from another", r"(plain\.charge_mah = event\.)charge", r"\1capacity"),
    ("an option that is given from another", r"(plain\.turn_scale = options\.)turn", r"\1distance"),
    ("an option that is not given", r"plain\.port_fd = options\.port_fd;", ""),
    ("an output that is not given", r"output\.twist = [^;]*;", ""),
    ("a wheel that is the other", r"(\.left_mm_s = wheels\.)left", r"\1right"),
    ("a member that std::expected lacks", r"(  bool has_value\(\))", r"  int code() const;\n\1"),
)


def self_test(header, wrapper):
    failed = 0
    without = set(complaints(header, wrapper))
    for fault, pattern, instead in _FAULTS:
        planted = re.sub(pattern, instead, wrapper, count=1)
        if not set(complaints(header, planted)) - without:
            print(f"cpp_coverage.py does not find {fault}", file=sys.stderr)
            failed = 1
    return failed


def main():
    header = (_FOLDER / "cargobay.h").read_text()
    wrapper = (_FOLDER / "cargobay.hpp").read_text()
    if sys.argv[1:] == ["--self-test"]:
        return self_test(header, wrapper)
    found = list(complaints(header, wrapper))
    for complaint in found:
        print(f"cpp_coverage.py: {complaint}", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
