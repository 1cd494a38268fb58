#!/bin/sh
# Starts a unit again with other lines under [Service]; without lines, as it is installed.
# usage: drop_in.sh UNIT [LINE...]
set -eu
unit=$1
shift
folder=/run/systemd/system/$unit.service.d
rm -rf "$folder"
if [ $# -gt 0 ]; then
  mkdir -p "$folder"
  { echo '[Service]'; printf '%s\n' "$@"; } > "$folder/fault.conf"
fi
systemctl daemon-reload
systemctl reset-failed "$unit" || true
systemctl restart "$unit"
