#!/bin/sh
# Has ada, an ordinary user of dialout, steer the robot from now on.
# usage: steering.sh [FOLDER of the feed]
folder=${1:-/run/cargobay}
unit=steer${1:+-$(basename "$folder")}
systemctl is-active -q "$unit" ||
  systemd-run -q --collect "--unit=$unit" --uid=ada python3 /share/steer.py 150 "$folder"
