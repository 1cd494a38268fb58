#!/bin/sh
# Runs a script with a unit's user, rights and sandbox, in place of its program, and prints what it says.
# usage: in_place.sh UNIT SCRIPT
set -eu
unit=$1 script=$2
drop=/run/systemd/system/$unit.service.d
systemctl stop "$unit"
mkdir -p "$drop"
printf '[Service]\nType=oneshot\nExecStart=\nExecStart=/bin/sh %s\nRestart=no\nWatchdogSec=0\n' "$script" > "$drop/in_place.conf"
systemctl daemon-reload
begin=$(date '+%Y-%m-%d %H:%M:%S')
systemctl start "$unit" || true
journalctl --sync
journalctl -u "$unit" --since "$begin" -o cat --no-pager
rm "$drop/in_place.conf"
systemctl daemon-reload
systemctl start "$unit"
