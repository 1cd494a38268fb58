"""The project's programs for a Debian of another architecture, built against its own packages."""

import shutil
import subprocess
import sys
from pathlib import Path

from debian import Suite

SOURCE = Path(__file__).resolve().parents[2]
COMPILER_PACKAGES = {"bookworm": "libstdc++-12-dev", "trixie": "libstdc++-14-dev"}
PACKAGES = [
    "busybox-static", "libc6-dev", "libgpiod-dev", "libserialport-dev", "libfmt-dev",
    "libtomlplusplus-dev", "libeigen3-dev", "libcli11-dev", "nlohmann-json3-dev",
    "libncurses-dev", "libgtest-dev", "libgmock-dev",
]  # fmt: skip
NOT_NEEDED = {"libnsl-dev", "pkg-config", "libc-dev-bin", "rpcsvc-proto"}
TOOLS = ["clang++-22", "cmake", "ninja", "dpkg-deb"]


def run_quietly(command: list) -> None:
    """What it prints is of interest only where it fails."""
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))} failed:\n{result.stdout}")


def user_space(suite: Suite, packages: list[str], root: Path) -> Path:
    """The packages and what they depend on, in a folder; kept as long as they are the same."""
    kept = root.with_suffix(".packages")
    names = "\n".join([*packages, *sorted(NOT_NEEDED)])
    if not root.exists() or not kept.exists() or kept.read_text() != names:
        part = root.with_suffix(".part")
        for old in (root, part):
            shutil.rmtree(old, ignore_errors=True)
        suite.unpack(suite.closure(packages, NOT_NEEDED), part)
        if not (part / "lib").exists():
            (part / "lib").symlink_to("usr/lib")
            # clang reaches its headers by lib/../include, of which ninja, without a look at the links,
            # makes include: without that, it would compile everything again each time.
            (part / "include").symlink_to("usr/include")
        part.rename(root)
        kept.write_text(names)
    return root


def cross_build(
    suite: Suite, name: str, folder: Path, targets: list[str], optimise: str = "-O1"
) -> tuple[Path, Path]:
    """The user space of that Debian, and the folder with what was built for it."""
    root = user_space(suite, [*PACKAGES, COMPILER_PACKAGES[name]], folder / "root")
    target = folder / f"build{optimise}"
    # Not a Release: the command, which is no concern of the tests, would be optimised too.
    run_quietly(
        ["cmake", "-S", SOURCE, "-B", target, "-G", "Ninja",
         f"--toolchain={SOURCE}/tests/pi/toolchain.cmake", f"-DCMAKE_SYSROOT={root}", "-DCARGOBAY_WEB=OFF",
         "-DCMAKE_BUILD_TYPE=RelWithDebInfo", f"-DCMAKE_CXX_FLAGS_RELWITHDEBINFO={optimise} -DNDEBUG",
         "-DCMAKE_EXE_LINKER_FLAGS=-s", "-DCMAKE_UNITY_BUILD=ON", "-DCARGOBAY_WERROR=ON"]
    )  # fmt: skip
    run_quietly(["cmake", "--build", target, "--target", *targets])
    return root, target
