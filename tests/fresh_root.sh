#!/usr/bin/env bash
# Proves that the scripts work on a bare machine: a minimal Debian in a folder.
# usage: tests/fresh_root.sh bookworm|trixie [quick|full|example] [--worktree]
#   quick    examples/run.sh, then tests/run.sh --quick (the default)
#   full     examples/run.sh, then tests/run.sh
#   example  examples/run.sh only
#   --worktree  the files as they are, not as committed
# Needs root and debootstrap. CARGOBAY_ROOT=FOLDER keeps the root there: an empty folder is filled,
# a filled one reused. CARGOBAY_MIRROR is the package archive.
set -euo pipefail

usage() {
  sed -n '2,9s/^# \{0,1\}//p' "$0" >&2
  exit 2
}

release='' what=quick worktree=0
for argument in "$@"; do
  case $argument in
    bookworm | trixie) release=$argument ;;
    quick | full | example) what=$argument ;;
    --worktree) worktree=1 ;;
    *) usage ;;
  esac
done
[[ -n $release ]] || usage
(($(id -u) == 0)) || { echo "fresh_root.sh: needs root, for debootstrap and chroot" >&2; exit 1; }

source_tree=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
mirror=${CARGOBAY_MIRROR:-http://deb.debian.org/debian}
root=${CARGOBAY_ROOT:-}
keep=1
if [[ -z $root ]]; then
  root=$(mktemp -d)
  keep=0
fi
mounted=()

leave() {
  local folder
  for folder in ${mounted[@]+"${mounted[@]}"}; do umount -l "$folder"; done
  # Never through a mount that still exists.
  ((keep)) || rm -rf --one-file-system "$root"
}
trap leave EXIT

if [[ ! -x $root/bin/bash ]]; then
  command -v debootstrap > /dev/null ||
    { echo "fresh_root.sh: debootstrap is missing: apt-get install debootstrap" >&2; exit 1; }
  echo "debootstrap --variant=minbase $release"
  mkdir -p "$root"
  chmod 755 "$root"
  log=$(mktemp)
  debootstrap --variant=minbase "$release" "$root" "$mirror" > "$log" 2>&1 ||
    { tail -n 20 "$log" >&2; rm -f "$log"; exit 1; }
  rm -f "$log"
fi
cp /etc/resolv.conf "$root/etc/resolv.conf"
[[ -e $root/etc/hosts ]] || echo "127.0.0.1 localhost" > "$root/etc/hosts"

# The tree, without what a build left behind.
rm -rf "$root/src/cargobay"
mkdir -p "$root/src/cargobay"
if ((worktree)); then
  git -C "$source_tree" ls-files --cached --others --exclude-standard -z |
    (cd "$source_tree" && while IFS= read -r -d '' file; do [[ ! -e $file ]] || printf '%s\0' "$file"; done) |
    tar -C "$source_tree" --null -T - -c | tar -C "$root/src/cargobay" -x
else
  git -C "$source_tree" archive HEAD | tar -C "$root/src/cargobay" -x
fi

# A container may forbid mounts; the tests that need /proc or a pty then say what is missing.
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

# No terminal, no input, a bare environment, started outside the repository.
inside() {
  echo "== $release: $*"
  chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root \
    setsid bash -c 'cd / && exec "$@"' _ "$@" < /dev/null
}
inside /src/cargobay/examples/run.sh
case $what in
  quick) inside /src/cargobay/tests/run.sh --quick ;;
  full) inside /src/cargobay/tests/run.sh ;;
esac
echo "== $release: $what works on a fresh root"
