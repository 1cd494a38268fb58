#!/usr/bin/env bash
# A million frames in virtual time, then 20 minutes over a pseudo-terminal: the soak of
# docs/reliability.md, printed.
# usage: tests/campaign/soak.sh [SECONDS]
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../.."
cmake --preset dev > /dev/null
cmake --build --preset dev -j "$(nproc)" --target soak > /dev/null
uname -srm
exec build/dev/tests/soak --frames 1000000 --seconds "${1:-1200}"
