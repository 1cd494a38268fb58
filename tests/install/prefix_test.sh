#!/usr/bin/env bash
# An installation with another prefix than was configured is whole, and stays so if it is moved:
# pkg-config's paths are its own, and programs and the command start its guard. A guard that others
# have put there, or could, is not run.
# usage: tests/install/prefix_test.sh BUILD_DIR
set -euo pipefail

build=$(realpath "${1:?usage: tests/install/prefix_test.sh BUILD_DIR}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
chmod 755 "$work"
unset CARGOBAY_GUARD PKG_CONFIG_PATH
export XDG_CONFIG_HOME=$work/none

for component in library development command; do
  cmake --install "$build" --prefix "$work/first" --component "$component" > /dev/null
done
mv "$work/first" "$work/moved"
prefix=$work/moved
pc=$(find "$prefix" -name cargobay.pc)
guard=$(find "$prefix" -name cargobay-guard)
libraries=${pc%/pkgconfig/*}
export PKG_CONFIG_PATH=${pc%/*}

# Prints which guard runs, or why none does.
cat > "$work/which_guard.c" << 'END'
#include <cargobay.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int main(void) {
  const struct cargobay_options options = {.size = sizeof options,
                                           .flags = CARGOBAY_FLAG_NO_CONFIG};
  struct cargobay_robot* robot;
  char command[120];
  if (cargobay_open(&options, &robot) != 0) return puts(cargobay_error_message());
  snprintf(command, sizeof command,
           "for child in $(cat /proc/%d/task/*/children); do readlink /proc/$child/exe; done",
           (int)getpid());
  (void)!system(command);
  return cargobay_close(robot);
}
END

failed=0
# says WHAT WANTED COMMAND...: the output has these words.
says() {
  local what=$1 wanted=$2 said
  shift 2
  said=$("$@" 2>&1 < /dev/null) || true
  if [[ $said == *"$wanted"* ]]; then
    echo "ok      $what"
  else
    printf 'FAILED  %s: no "%s" in:\n%s\n' "$what" "$wanted" "$said"
    failed=1
  fi
}
folders() { for flag in $(pkg-config "$1" cargobay); do realpath "${flag#-[IL]}"; done; }
program() { LD_LIBRARY_PATH=$libraries "$work/which_guard"; }
# command_in PREFIX: prints the guard that it starts, and what it says.
command_in() {
  "$1/bin/cargobay" drive --virtual --duration 2 > "$work/said" 2>&1 &
  local drive=$! child guards=""
  for ((i = 0; i < 100 && ${#guards} == 0; ++i)); do
    sleep 0.02
    # shellcheck disable=SC2013 # they are words of one line
    for child in $(cat /proc/$drive/task/*/children 2> /dev/null); do
      guards+=$(readlink "/proc/$child/exe" || true)
    done
  done
  echo "$guards"
  wait "$drive" || true
  cat "$work/said"
}

says "pkg-config --cflags" "$prefix/include" folders --cflags-only-I
says "pkg-config --libs" "$libraries" folders --libs-only-L
# shellcheck disable=SC2046 # several words
cc -std=gnu11 -Wall -Werror "$work/which_guard.c" -o "$work/which_guard" \
  $(pkg-config --cflags --libs cargobay)
says "a program starts its guard" "$guard" program
says "the command does too" "$guard" command_in "$prefix"

# Planted: the folder of the guard is another user's, or everybody's.
for mode in 0777 01777 0775; do
  chmod "$mode" "${guard%/*}"
  says "not from a folder of mode $mode" "others may write to its folder ${guard%/*}" program
done
chmod 755 "${guard%/*}"
chmod 0777 "$prefix"
says "not below a folder that others may write" "others may write to $prefix" program
says "nor does the command" "others may write to $prefix" command_in "$prefix"
chmod 755 "$prefix"
if (($(id -u) == 0)); then
  chown 65534 "$guard"
  says "not one of another user" "belongs to user 65534" program
  chown 0 "$guard"
fi
# S1: beside or above the program, nothing is looked for.
mkdir -p "$work/x/priv/cargobay" "$work/x/cargobay"
cp "$work/which_guard" "$libraries"/libcargobay.so.0 "$work/x/priv"
for place in x/priv x/priv/cargobay x x/cargobay; do
  printf '#!/bin/sh\ntouch %s/was_run\n' "$work" > "$work/$place/cargobay-guard"
  chmod 755 "$work/$place/cargobay-guard"
done
beside() { LD_LIBRARY_PATH=$work/x/priv "$work/x/priv/which_guard"; }
says "not beside a program" "cargobay-guard" beside
# The layout is that of an installation, but the folder that holds it is another user's.
if (($(id -u) == 0)); then
  mkdir -p "$work/y"
  cp -r "$prefix/." "$work/y"
  planted=$work/y/${guard#"$prefix/"}
  printf '#!/bin/sh\ntouch %s/was_run\n' "$work" > "$planted"
  chown 65534 "$work/y"
  says "not from another user's folder" "belongs to user 65534" command_in "$work/y"
fi
[[ ! -e $work/was_run ]] || { echo "FAILED  a planted guard was run"; failed=1; }
((!failed)) && echo "prefix_test.sh: all as it should be"
