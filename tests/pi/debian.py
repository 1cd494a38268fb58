"""Debian packages of another architecture, unpacked into folders: a kernel, a user space to cross-build
against and to run. Needs the archive and dpkg-deb; installs nothing.
"""

import lzma
import os
import re
import subprocess
import time
import urllib.request
from pathlib import Path

MIRROR = os.environ.get("CARGOBAY_MIRROR", "http://deb.debian.org/debian")
ARCHITECTURE = "arm64"


def download(url: str) -> bytes:
    """What is there; an archive that fails for a moment is asked again."""
    for attempt in range(4):
        try:
            with urllib.request.urlopen(url, timeout=120) as answer:
                return answer.read()
        except OSError as error:
            if attempt == 3:
                raise OSError(f"cannot get {url}: {error}") from error
            time.sleep(2**attempt)
    raise AssertionError


class Suite:
    """The packages of one Debian release."""

    def __init__(self, name: str, cache: Path):
        self.cache = cache
        cache.mkdir(parents=True, exist_ok=True)
        url = f"{MIRROR}/dists/{name}/main/binary-{ARCHITECTURE}/Packages.xz"
        index = cache / f"{name}-Packages.xz"
        if not index.exists():
            keep(index, download(url))
        text = lzma.decompress(index.read_bytes()).decode()
        self.packages = {}
        for stanza in text.split("\n\n"):
            fields = dict(re.findall(r"^([A-Za-z-]+): (.*)$", stanza, re.MULTILINE))
            if "Package" in fields:
                self.packages[fields["Package"]] = fields

    def closure(self, names: list[str], without: set[str]) -> list[str]:
        """The packages and what they depend on, the first of each set of alternatives."""
        wanted, found = list(names), []
        while wanted:
            name = wanted.pop()
            if name in found or name in without or name not in self.packages:
                continue  # missing: a virtual package, which a folder can do without
            found.append(name)
            fields = self.packages[name]
            depends = ", ".join(fields.get(key, "") for key in ("Pre-Depends", "Depends"))
            wanted += [re.split(r"[ :(|]", item.strip())[0] for item in depends.split(",")]
        return found

    def unpack(self, names: list[str], folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        for name in names:
            path = self.packages[name]["Filename"]
            package = self.cache / Path(path).name
            if not package.exists():
                keep(package, download(f"{MIRROR}/{path}"))
            subprocess.run(["dpkg-deb", "-x", package, folder], check=True)
        keep_links_inside(folder)


def keep_links_inside(folder: Path) -> None:
    """A link to /lib/... means the folder's own: followed as it stands it would leave the folder, and a
    program be linked with a library of the machine that builds it."""
    for path in folder.rglob("*"):
        if path.is_symlink() and path.readlink().is_absolute():
            target = folder / path.readlink().relative_to("/")
            path.unlink()
            path.symlink_to(os.path.relpath(target, path.parent))


def keep(path: Path, content: bytes) -> None:
    """Whole or not at all."""
    part = path.with_suffix(path.suffix + ".part")
    part.write_bytes(content)
    part.rename(path)
