#!/usr/bin/env bash
# Installs the packages on a minimal Debian in a folder, uses them, and removes them again.
# usage: tests/install/package_test.sh FOLDER_WITH_DEBS [bookworm|trixie]
# Without a release: the one of this machine. Needs root and debootstrap. CARGOBAY_ROOT=FOLDER keeps
# the root there: an empty folder is filled, a filled one reused. CARGOBAY_MIRROR is the package
# archive.
set -euo pipefail

usage() {
  sed -n '2,6s/^# \{0,1\}//p' "$0" >&2
  exit 2
}
(($# == 1 || $# == 2)) || usage
architecture=$(dpkg --print-architecture)
release=${2:-$(. /etc/os-release && echo "${VERSION_CODENAME:-}")}
shopt -s nullglob
packages=("$1"/*cargobay*_"$architecture".deb "$1"/python3-cargobay_*_all.deb)
shopt -u nullglob
((${#packages[@]} == 5)) ||
  { echo "package_test.sh: $1 has ${#packages[@]} packages for $architecture, not 5" >&2; exit 2; }
(($(id -u) == 0)) || { echo "package_test.sh: needs root, for debootstrap and chroot" >&2; exit 1; }

mirror=${CARGOBAY_MIRROR:-http://deb.debian.org/debian}
root=${CARGOBAY_ROOT:-}
keep=1
if [[ -z $root ]]; then
  root=$(mktemp -d)
  keep=0
fi
log=$(mktemp)
mounted=()
leave() {
  local folder
  for folder in ${mounted[@]+"${mounted[@]}"}; do umount -l "$folder"; done
  rm -f "$log"
  # Never through a mount that still exists.
  ((keep)) || rm -rf --one-file-system "$root"
}
trap leave EXIT

# step WHAT COMMAND...: one line, and the log if it fails.
step() {
  local what=$1
  shift
  "$@" > "$log" 2>&1 < /dev/null || {
    echo "FAILED  $what"
    tail -n 60 "$log"
    exit 1
  }
  echo "ok      $what"
}

if [[ ! -x $root/bin/bash ]]; then
  command -v debootstrap > /dev/null ||
    { echo "package_test.sh: debootstrap is missing: apt-get install debootstrap" >&2; exit 1; }
  mkdir -p "$root"
  chmod 755 "$root"
  # A container may forbid what it needs.
  debootstrap --variant=minbase "$release" "$root" "$mirror" > "$log" 2>&1 < /dev/null || {
    echo "SKIPPED: debootstrap cannot make a minimal $release here: $(tail -n 1 "$log")"
    exit 77
  }
  echo "ok      debootstrap --variant=minbase $release"
fi
cp /etc/resolv.conf "$root/etc/resolv.conf"
rm -rf "$root/packages"
mkdir -p "$root/packages"
cp "${packages[@]}" "$root/packages"

try_mount() {
  local target=${*: -1}
  mountpoint -q "$target" && return
  mkdir -p "$target"
  if mount "$@" 2> /dev/null; then
    mounted=("$target" ${mounted[@]+"${mounted[@]}"})
  else
    echo "could not mount $target"
  fi
}
try_mount -t proc proc "$root/proc"
try_mount -t sysfs -o ro sysfs "$root/sys"
try_mount -t devpts -o newinstance,ptmxmode=0666,mode=0620 devpts "$root/dev/pts"
[[ -e $root/dev/ptmx ]] || ln -s pts/ptmx "$root/dev/ptmx"
try_mount -t tmpfs tmpfs "$root/dev/shm"

# inside SCRIPT: a bare environment, nothing of the build tree.
inside() {
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
    DEBIAN_FRONTEND=noninteractive setsid bash -euo pipefail -c "cd /tmp; $1"
}
# All files, except the package managers' own records.
files() {
  chroot "$root" find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp \
    -o -path /packages -o -path /var/cache -o -path /var/lib/apt -o -path /var/lib/dpkg \
    -o -path /var/log \) -prune -o -print | sort
}
nothing_left() {
  files > "$log.after"
  diff "$log.before" "$log.after"
  local same=$?
  rm -f "$log.after"
  return "$same"
}

install='apt-get install -q -y --no-install-recommends /packages/*.deb'
purge='apt-get purge -q -y --autoremove cargobay cargobay-web python3-cargobay libcargobay-dev libcargobay0'

# First, what the packages pull in themselves.
step "package lists" inside 'apt-get update -q'
inside "! dpkg -s libcargobay0 > /dev/null 2>&1 || $purge" > /dev/null
files > "$log.before"
trap 'rm -f "$log.before"; leave' EXIT
step "apt-get install, nothing else there" inside "$install"
step "cargobay --version" inside 'cargobay --version'
step "cargobay drive, a second on a virtual Create" inside 'cargobay drive --duration 1'
# Bash's own sockets: there is no client in a minimal Debian.
step "cargobay-web serves its page" inside 'cargobay-web --version
  cargobay-web --http 127.0.0.1:8099 > web.log & web=$!
  trap "kill $web" EXIT
  for _ in $(seq 50); do grep -q serving web.log && break; sleep 0.1; done
  exec 3<> /dev/tcp/127.0.0.1/8099
  printf "GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n" >&3
  grep -q "</html>" <&3'
guard=$(inside 'find /usr/lib -name cargobay-guard')
step "the guard is where the library looks for it: $guard" \
  inside "mv $guard $guard.away; ! cargobay drive --duration 1 || exit 1; mv $guard.away $guard
    dpkg --verify libcargobay0"
step "apt-get purge" inside "$purge"
step "nothing is left" nothing_left

# Then, what is needed to build programs.
step "compiler, CMake, Python, lintian" \
  inside 'apt-get install -q -y --no-install-recommends gcc g++ make cmake pkg-config python3 lintian'
files > "$log.before"
step "apt-get install" inside "$install"
examples=/usr/share/doc/libcargobay-dev/examples
step "first_drive.c by pkg-config" \
  inside "cc $examples/first_drive.c \$(pkg-config --cflags --libs cargobay) -o first_drive"
step "./first_drive" inside './first_drive'
step "first_drive.cpp by pkg-config" inside \
  "c++ -std=c++20 $examples/first_drive.cpp \$(pkg-config --cflags --libs cargobay) -o first_drive"
step "./first_drive, in C++" inside './first_drive'
step "all examples by CMake" inside "rm -rf examples; cp -r $examples .
  cmake -S examples -B examples/build && cmake --build examples/build"
step "all examples, on virtual Creates" inside 'ctest --test-dir examples/build --output-on-failure'
for example in heading one_world square teleop_and_back two_coroutines; do
  step "$example.py" inside "python3 /usr/share/doc/python3-cargobay/examples/$example.py"
done
step "the Python package says its version" inside "python3 -c 'import cargobay, importlib.metadata
assert importlib.metadata.version(\"cargobay\") == cargobay.version()'"
cat > "$root/tmp/killed.py" << 'END'
import subprocess, sys, time
from cargobay import Mode, Sim

DRIVER = """
import os, signal, sys
from cargobay import Flag, Robot
robot = Robot(sys.argv[1], flags=Flag.NO_CONFIG)
robot.start()
for state in robot.states(1.0):
    robot.drive(200.0, 0.0)
os.kill(os.getpid(), signal.SIGKILL)
"""
with Sim() as sim:
    driver = subprocess.run([sys.executable, "-c", DRIVER, sim.path])
    time.sleep(1.0)
    truth = sim.truth
    print(driver, truth)
    assert driver.returncode == -9 and truth.x_mm > 100.0
    assert truth.mode == Mode.PASSIVE and abs(truth.left_mm_s) < 10.0
END
step "a Python program is killed: its guard stops the robot" inside 'python3 killed.py'
step "man pages" inside "for page in cargobay.1 cargobay-drive.1 cargobay-web.1; do
  zcat /usr/share/man/man1/\$page.gz | grep -q '^.TH CARGOBAY'; done
  zcat /usr/share/man/man5/cargobay.toml.5.gz | grep -q '^.TH CARGOBAY'"
step "lintian" inside \
  'lintian --allow-root --fail-on error,warning --info --tag-display-limit 0 /packages/*.deb'
cat "$log"
step "apt-get purge" inside "$purge"
step "nothing is left" nothing_left
rm -f "$log.before"
echo "packages: as they should be on $release"
