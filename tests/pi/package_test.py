#!/usr/bin/env python3
"""The arm64 packages on an emulated Raspberry Pi: installed by dpkg there, with its dependencies
checked; the first example, compiled against them, drives a virtual Create; removed again.

usage: package_test.py bookworm|trixie FOLDER PACKAGES
  FOLDER    for what is downloaded and built; kept for the next time
  PACKAGES  a folder with the packages for arm64, made by .ci/package.sh on that Debian
Exit 77, and says why, where something that it needs is missing.
"""

import gzip
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

from debian import Suite
from emulated_pi import EmulatedPi, VirtualCreate, lacks, libraries, make_initramfs, unpack_kernel

SOURCE = Path(__file__).resolve().parents[2]
KERNEL_SUITE = "bookworm"
# What a minimal Debian has anyway, and what the packages depend on.
BASE = ["busybox-static", "dpkg", "tar", "libc-bin", "libstdc++6"]
TOOLS = ["qemu-system-aarch64", "fdtput", "cpio", "dpkg-deb", "readelf", "aarch64-linux-gnu-gcc"]
DPKG = ["dpkg", "dpkg-deb", "dpkg-split", "dpkg-query", "dpkg-trigger", "tar", "start-stop-daemon", "ldconfig"]

MOST_GOES = 4
failures = 0


def check(holds: bool, what: str, else_tell: str = "") -> None:
    global failures
    print(f"  {'ok    ' if holds else 'FAILED'} {what}", flush=True)
    if not holds and else_tell:
        print(else_tell, flush=True)
    failures += not holds


def field(package: Path, name: str) -> str:
    return subprocess.run(
        ["dpkg-deb", "-f", package, name], capture_output=True, text=True, check=True
    ).stdout.strip()


def program(root: Path, name: str) -> Path:
    for folder in ("usr/bin", "bin", "usr/sbin", "sbin"):
        if (root / folder / name).exists():
            return root / folder / name
    raise FileNotFoundError(f"{name} is in none of the packages of {root}")


def compile_example(packages: list[Path], folder: Path) -> Path:
    """As a user would, against what the packages have."""
    unpacked = folder / "unpacked"
    shutil.rmtree(unpacked, ignore_errors=True)
    for package in packages:
        subprocess.run(["dpkg-deb", "-x", package, unpacked], check=True)
    target = folder / "first_drive"
    subprocess.run(
        ["aarch64-linux-gnu-gcc", f"-I{unpacked}/usr/include",
         unpacked / "usr/share/doc/libcargobay-dev/examples/first_drive.c", "-o", target,
         f"-L{unpacked}/usr/lib/aarch64-linux-gnu", "-lcargobay",
         "-Wl,--allow-shlib-undefined"],
        check=True,
    )  # fmt: skip
    return target


def status_of(suite: Suite, installed: list[str]) -> str:
    """dpkg's own book, as if these had been installed."""
    stanzas = []
    for name in installed:
        fields = suite.packages[name]
        keep = {key: fields[key] for key in ("Package", "Version", "Architecture", "Multi-Arch", "Provides")
                if key in fields}  # fmt: skip
        keep |= {"Status": "install ok installed", "Maintainer": "none", "Description": "unpacked"}
        stanzas.append("\n".join(f"{key}: {value}" for key, value in keep.items()))
    return "\n\n".join(stanzas) + "\n"


def make_image(suite: Suite, folder: Path, packages: list[Path], example: Path) -> Path:
    depends = [re.split(r"[ :(|]", item.strip())[0] for package in packages
               for item in field(package, "Depends").split(",") if item.strip()]  # fmt: skip
    ours = {field(package, "Package") for package in packages}
    names = suite.closure([*BASE, *(name for name in depends if name not in ours)], set())
    root = folder / "root"
    if not root.exists():
        part = folder / "root.part"
        shutil.rmtree(part, ignore_errors=True)
        suite.unpack(names, part)
        if not (part / "lib").exists():
            (part / "lib").symlink_to("usr/lib")
        part.rename(root)
    tools = [program(root, name) for name in DPKG]
    here = folder / "initramfs"
    make_initramfs(here, root, tools)
    shutil.copy(example, here / "bin")
    # The libraries that the packages need, where the loader and dpkg look for them.
    wanted = libraries([*(folder / "unpacked/usr/lib/aarch64-linux-gnu").glob("lib*.so.0"),
                        folder / "unpacked/usr/bin/cargobay"], root)  # fmt: skip
    for library in wanted:
        shutil.copy(library, here / "lib/aarch64-linux-gnu")
    for name in ("var/lib/dpkg/info", "var/lib/dpkg/updates", "var/lib/dpkg/triggers", "var/log", "packages",
                 "usr/bin", "usr/lib", "usr/share", "etc/ld.so.conf.d"):  # fmt: skip
        (here / name).mkdir(parents=True, exist_ok=True)
    (here / "var/lib/dpkg/status").write_text(status_of(suite, names))
    (here / "var/lib/dpkg/available").touch()
    (here / "etc/ld.so.conf").write_text("/lib/aarch64-linux-gnu\n/usr/lib/aarch64-linux-gnu\n")
    for package in packages:
        shutil.copy(package, here / "packages")
    archive = subprocess.run(["find", ".", "-print0"], cwd=here, capture_output=True, check=True).stdout
    packed = subprocess.run(
        ["cpio", "--quiet", "-0", "-o", "-H", "newc"], cwd=here, input=archive, capture_output=True, check=True
    ).stdout
    target = here.with_suffix(".cpio.gz")
    target.write_bytes(gzip.compress(packed, compresslevel=1))
    return target


def drives(pi: EmulatedPi, line: str) -> tuple[int, str]:
    """Where the machine holds the emulated Pi up for longer than its guard waits, once more."""
    for _ in range(MOST_GOES):
        code, text = pi.run(f"{line} < /dev/null 2>&1", 90)
        if code == 0:
            break
    return code, text


def installs_and_drives(pi: EmulatedPi) -> None:
    code, text = pi.run("dpkg --install /packages/*.deb < /dev/null 2>&1", 180)
    check(code == 0, "dpkg installs the packages, with their dependencies", text)
    code, text = pi.run("dpkg-query -W -f '${Package} ${db:Status-Status}\\n' 'libcargobay*' cargobay", 30)
    check(text.count(" installed") == 3, "three of them", text)
    code, text = pi.run("cargobay --version", 30)
    check(code == 0 and "cargobay " in text, f"the command runs: {text.strip()}", text)
    code, text = drives(pi, "first_drive")
    check(code == 0, f"the first example drives: {text.strip()}", text)
    code, text = drives(pi, "cargobay drive --duration 5")
    check(code == 0 and "Frames " in text, "cargobay drive drives, guarded by the installed guard", text)
    code, text = pi.run("dpkg --purge cargobay libcargobay-dev libcargobay0 < /dev/null 2>&1", 120)
    check(code == 0, "dpkg removes them", text)
    code, text = pi.run("find / -xdev -name '*cargobay*' ! -path '/packages/*' ! -path '/proc/*'", 60)
    left = [line for line in text.split("\n") if line.startswith("/")]
    check(not left, "nothing is left of them", "\n".join(left))


def main() -> int:
    if len(sys.argv) != 4 or sys.argv[1] not in ("bookworm", "trixie"):
        print(__doc__, file=sys.stderr)
        return 2
    if lacks(TOOLS):
        return 77
    name, folder = sys.argv[1], Path(sys.argv[2]).resolve()
    packages = sorted(Path(sys.argv[3]).resolve().glob("*_arm64.deb"))
    # What the page needs is not in the machine.
    packages = [package for package in packages if not package.name.startswith("cargobay-web_")]
    if len(packages) != 3:
        print(f"SKIPPED: {len(packages)} of three packages in {sys.argv[3]}; make them with .ci/package.sh arm64")
        return 77
    cache, here = folder / "packages", folder / f"package-{name}"
    here.mkdir(parents=True, exist_ok=True)
    example = compile_example(packages, here)
    kernel, tree = unpack_kernel(Suite(KERNEL_SUITE, cache), folder / "kernel")
    image = make_image(Suite(name, cache), here, packages, example)
    # A line to the UART that is not needed here.
    command = SOURCE / "build/dev/cargobay"
    robot = VirtualCreate(command, here)
    try:
        pi = EmulatedPi(kernel, tree, image, here, robot, {})
        try:
            begin = time.monotonic()
            pi.booted()
            print(f"booted with the user space of {name} in {time.monotonic() - begin:.1f} s")
            installs_and_drives(pi)
        finally:
            pi.close()
    finally:
        robot.close()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
