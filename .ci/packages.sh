#!/usr/bin/env bash
# Installs the Debian packages of one purpose, if any is missing.
# usage: .ci/packages.sh run|quick|test|machine|package|package-arm64|package-armhf [--list]
#   run      what examples/run.sh needs: to build the command
#   quick    what tests/run.sh --quick needs
#   test     what tests/run.sh needs: sanitizers, lint, cross compilers
#   machine  what tests/machine needs
#   package  what .ci/package.sh needs; package-arm64 and package-armhf to cross-compile
# Asks nothing. Uses sudo only if not root.
set -euo pipefail

# The -dev packages of two architectures exclude each other: to cross-compile, the library alone beside
# the headers of this machine's.
websockets=libwebsockets17
[[ $(. /etc/os-release && echo "${VERSION_CODENAME:-}") == bookworm ]] || websockets=libwebsockets19t64

run=(g++ cmake ninja-build pkg-config libc6-dev libeigen3-dev libserialport-dev libgpiod-dev
  libcli11-dev nlohmann-json3-dev libfmt-dev libtomlplusplus-dev libncurses-dev
  libwebsockets-dev libqrencode-dev libevdev-dev libjs-dygraphs)
quick=("${run[@]}" libgtest-dev libgmock-dev librsvg2-bin clang-format-22)
test=("${quick[@]}" librapidcheck-dev libbenchmark-dev libboost-dev spin help2man abigail-tools universal-ctags
  clang-22 clang-tidy-22 libclang-rt-22-dev llvm-22 strace tmux
  crossbuild-essential-arm64 libserialport-dev:arm64 libgpiod-dev:arm64 libfmt-dev:arm64
  libncurses-dev:arm64 "$websockets:arm64" libssl-dev:arm64 libqrencode-dev:arm64 libevdev-dev:arm64
  libgtest-dev:arm64 libgmock-dev:arm64 g++-arm-linux-gnueabihf python3 qemu-system-arm device-tree-compiler cpio
  doxygen debootstrap cargo bindgen mypy python3-numpy libglib2.0-dev qt6-base-dev zsh fish nodejs openssl
  chromium chromium-driver python3-selenium)
# Independent checkers for tests come from npm, which some packages of nodejs bring along.
command -v npm > /dev/null || test+=(npm)
machine=("${run[@]}" python3 debootstrap qemu-system-x86 qemu-utils e2fsprogs)
package=("${run[@]}" dpkg-dev file)
package_arm64=("${package[@]}" crossbuild-essential-arm64
  libserialport-dev:arm64 libgpiod-dev:arm64 libfmt-dev:arm64 libncurses-dev:arm64
  "$websockets:arm64" libssl-dev:arm64 libqrencode-dev:arm64 libevdev-dev:arm64)
package_armhf=("${package[@]}" crossbuild-essential-armhf
  libserialport-dev:armhf libgpiod-dev:armhf libfmt-dev:armhf libncurses-dev:armhf
  "$websockets:armhf" libssl-dev:armhf libqrencode-dev:armhf libevdev-dev:armhf)

case ${1:-} in
  run) wanted=("${run[@]}") ;;
  quick) wanted=("${quick[@]}") ;;
  test) wanted=("${test[@]}") ;;
  machine) wanted=("${machine[@]}") ;;
  package) wanted=("${package[@]}") ;;
  package-arm64) wanted=("${package_arm64[@]}") ;;
  package-armhf) wanted=("${package_armhf[@]}") ;;
  *)
    sed -n '2,9s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
if [[ ${2:-} == --list ]]; then
  printf '%s\n' "${wanted[@]}"
  exit
fi

if ! command -v apt-get > /dev/null; then
  echo "This is not Debian: install what corresponds to: ${wanted[*]}" >&2
  exit 1
fi

native=$(dpkg --print-architecture)
# installed NAME[:ARCHITECTURE]: a multiarch package has one line for each architecture.
installed() {
  local architecture=$native
  [[ $1 != *:* ]] || architecture=${1##*:}
  dpkg-query -W -f '${Architecture} ${db:Status-Status}\n' "${1%%:*}" 2> /dev/null |
    grep -qxE "($architecture|all) installed"
}

missing=()
for package in "${wanted[@]}"; do
  installed "$package" || missing+=("$package")
done
((${#missing[@]})) || exit 0

as_root=()
if (($(id -u) != 0)); then
  if ! command -v sudo > /dev/null || ! sudo -n true 2> /dev/null; then
    echo "Packages are missing, and this is neither root nor may it use sudo without a password." >&2
    echo "Install them once, as root: apt-get install ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo -n)
fi

added=() # foreign architectures, by this run
log=$(mktemp)
trap 'rm -f "$log"' EXIT
apt() {
  ${as_root[@]+"${as_root[@]}"} env DEBIAN_FRONTEND=noninteractive apt-get -q \
    -o DPkg::Lock::Timeout=300 -o Acquire::Retries=3 "$@" < /dev/null >> "$log" 2>&1 || {
    tail -n 25 "$log" >&2
    echo "apt-get $1 failed; wanted: ${missing[*]}" >&2
    # Whatever else is installed later does not trip over an index that is not available.
    local foreign
    for foreign in ${added[@]+"${added[@]}"}; do
      ${as_root[@]+"${as_root[@]}"} dpkg --remove-architecture "$foreign" || true
    done
    exit 1
  }
}

echo "installing ${#missing[@]} packages"
for foreign in arm64 armhf; do
  if [[ " ${missing[*]} " == *:$foreign* && $native != "$foreign" ]] &&
    ! dpkg --print-foreign-architectures | grep -qx "$foreign"; then
    ${as_root[@]+"${as_root[@]}"} dpkg --add-architecture "$foreign"
    added+=("$foreign")
  fi
done
apt update
# Debian 12 has clang 22 in its security archive, which a debootstrap root does not list.
if [[ " ${missing[*]} " == *-22* ]] && ! apt-cache show clang-22 > /dev/null 2>&1; then
  codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
  mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/* 2> /dev/null |
    grep -oE 'https?://[^ ]+/debian/?( |$)' | head -n 1 | sed -E 's| *$||; s|/$||') || true
  line="deb ${mirror:-http://deb.debian.org/debian}-security $codename-security main"
  echo "adding to the package sources: $line"
  ${as_root[@]+"${as_root[@]}"} tee /etc/apt/sources.list.d/debian-security.list <<< "$line" > /dev/null
  apt update
fi
apt install --yes --no-install-recommends "${missing[@]}"
