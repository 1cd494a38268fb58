"""Disks of a PC with Debian, made once: debootstrap, a PREEMPT_RT kernel, and what else a user's machine
has that takes serial ports. Cached by content: of the recipe, and of our packages.
"""

import contextlib
import hashlib
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

MIRROR = os.environ.get("CARGOBAY_MIRROR", "http://deb.debian.org/debian")
# ModemManager takes serial adapters for modems.
PACKAGES = [
    "systemd-sysv", "udev", "dbus", "kmod", "procps", "initramfs-tools", "zstd", "linux-image-rt-amd64",
    "modemmanager", "iproute2",
]  # fmt: skip
DISK_BYTES = 3 << 30
TOOLS = ["debootstrap", "chroot", "mke2fs", "qemu-img", "qemu-system-x86_64", "dpkg-deb"]

# The second serial line, and the folder that the host gives, are the test's; all else is Debian's.
FILES = {
    "etc/systemd/system/test-shell.service": """[Unit]
Description=A shell for the test, on the second serial line
[Service]
ExecStart=/bin/sh -c 'stty -echo -onlcr; echo; echo "@@booted"; exec env PS1= PS2= HOME=/root LC_ALL=C.UTF-8 SYSTEMD_COLORS=0 sh'
StandardInput=tty
StandardOutput=tty
StandardError=tty
TTYPath=/dev/ttyS1
TTYReset=yes
IgnoreSIGPIPE=no
# A shell at a terminal takes no notice of SIGTERM.
KillSignal=SIGHUP
[Install]
WantedBy=basic.target
""",
    "etc/fstab": "/dev/vda / ext4 defaults 0 0\n/dev/vdb /share ext4 ro 0 0\n",
    "etc/hostname": "machine\n",
    "etc/hosts": "127.0.0.1 localhost machine\n",
    # A machine that is thrown away.
    "etc/dpkg/dpkg.cfg.d/unsafe": "force-unsafe-io\n",
}


@dataclass
class Disk:
    disk: Path
    kernel: Path
    initrd: Path


def digest(*parts: str | bytes) -> str:
    """A name for what is made of these."""
    total = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        total.update(len(data).to_bytes(8, "big") + data)
    return total.hexdigest()[:16]


def run(command: list, log: Path) -> None:
    with open(log, "a") as out:
        print("+", *command, file=out, flush=True)
        result = subprocess.run(
            command, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT, check=False
        )
    if result.returncode != 0:
        end = "\n".join(log.read_text(errors="replace").splitlines()[-30:])
        raise RuntimeError(f"{' '.join(map(str, command))} failed; the end of {log}:\n{end}")


@contextlib.contextmanager
def mounted(root: Path):
    """/proc, which installers look into; without it where mounting is forbidden."""
    done = subprocess.run(["mount", "-t", "proc", "proc", root / "proc"], capture_output=True, check=False)
    try:
        yield
    finally:
        if done.returncode == 0:
            subprocess.run(["umount", root / "proc"], check=True)


def inside(root: Path, *command: str) -> list:
    return ["chroot", root, "env", "-i", "PATH=/usr/sbin:/usr/bin:/sbin:/bin", "HOME=/root", "LC_ALL=C.UTF-8",
            "DEBIAN_FRONTEND=noninteractive", *command]  # fmt: skip


def install(root: Path, log: Path, *packages: str) -> None:
    run(inside(root, "apt-get", "-q", "-y", "--no-install-recommends", "install", *packages), log)


def base(folder: Path, suite: str) -> Path:
    """Debian as a folder, before our packages are installed; `folder` keeps it for the next time."""
    root = folder / f"{suite}-{digest(repr((suite, MIRROR, PACKAGES, sorted(FILES.items()))))}"
    if not root.exists():
        log, part = folder / f"{suite}.log", folder / f"{suite}.part"
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir(parents=True)
        log.unlink(missing_ok=True)
        run(["debootstrap", "--variant=minbase", suite, part, MIRROR], log)
        shutil.copy("/etc/resolv.conf", part / "etc/resolv.conf")
        for name, text in FILES.items():
            (part / name).parent.mkdir(parents=True, exist_ok=True)
            (part / name).write_text(text)
        (part / "share").mkdir()
        with mounted(part):
            run(inside(part, "apt-get", "-q", "update"), log)
            install(part, log, *PACKAGES)
        run(inside(part, "systemctl", "enable", "test-shell"), log)
        part.rename(root)
    return root


def installed(folder: Path, root: Path, packages: list[Path]) -> Disk:
    """The machine with our packages, installed by apt from a folder; kept as long as they are the same."""
    of = digest(*(package.read_bytes() for package in packages))
    here = folder / f"{root.name}-{of}"
    if not here.exists():
        for old in folder.glob(f"{root.name}-*"):
            shutil.rmtree(old)
        log, part = folder / "installed.log", folder / "installed.part"
        shutil.rmtree(part, ignore_errors=True)
        part.mkdir()
        log.unlink(missing_ok=True)
        run(["cp", "-a", root, part / "root"], log)
        for package in packages:
            shutil.copy(package, part / "root/share")
        with mounted(part / "root"):
            install(part / "root", log, *(f"/share/{package.name}" for package in packages))
        for name in ("vmlinuz", "initrd.img"):
            shutil.copy(next((part / "root/boot").glob(f"{name}-*")), part / name)
        pack(part / "root", part / "disk", DISK_BYTES, log)
        shutil.rmtree(part / "root")
        part.rename(here)
    return Disk(here / "disk", here / "vmlinuz", here / "initrd.img")


def pack(root: Path, disk: Path, size: int, log: Path) -> None:
    """A folder as a file system, owners and all; needs root."""
    disk.unlink(missing_ok=True)
    run(["mke2fs", "-q", "-t", "ext4", "-d", root, disk, f"{size >> 10}k"], log)


def overlay(below: Path, disk: Path) -> Path:
    """A disk that begins as the one below, which it leaves as it is."""
    disk.unlink(missing_ok=True)
    command = ["qemu-img", "create", "-q", "-f", "qcow2", "-F", "raw", "-b", below, disk]
    subprocess.run(command, check=True)
    return disk
