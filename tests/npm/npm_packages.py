"""Independent checkers from npm: what a lock file names, put into the build folder once."""

import pathlib
import shutil
import subprocess

_failures = {}  # by folder: a registry that cannot be reached is not waited for twice


def missing(manifests, folder):
    """Installs what package.json and package-lock.json in `manifests` name into `folder`, unless it
    is there. Returns why it could not, for who skips a test; None if it is there."""
    folder = pathlib.Path(folder)
    if folder not in _failures:
        _failures[folder] = _install(pathlib.Path(manifests), folder)
    return _failures[folder]


def _install(manifests, folder):
    if shutil.which("npm") is None or shutil.which("node") is None:
        return "npm and node are missing: .ci/packages.sh test"
    folder.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "package-lock.json"):
        wanted = (manifests / name).read_bytes()
        there = folder / name
        if not there.exists() or there.read_bytes() != wanted:
            shutil.rmtree(folder / "node_modules", ignore_errors=True)
            there.write_bytes(wanted)
    if (folder / "node_modules/.package-lock.json").exists():
        return None
    done = subprocess.run(
        ["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", "--fetch-retries=1",
         "--fetch-retry-mintimeout=2000"],
        cwd=folder, capture_output=True, text=True, check=False)
    return None if done.returncode == 0 else f"npm ci: {done.stderr.strip()[-300:]}"
