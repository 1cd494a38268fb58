#!/usr/bin/env bash
# Sends a million mutated frames to cargobay-web, which is to stand it and to grow by nothing.
# usage: tests/campaign/web_frames.sh [FRAMES [PROGRAM]]
#   FRAMES   1000000 by default: a minute
#   PROGRAM  by itself build/dev/cargobay-web
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
exec python3 "$root/tests/web/hostile_test.py" "${2:-$root/build/dev/cargobay-web}" \
  --frames "${1:-1000000}" Loopback.test_stands_mutated_frames
