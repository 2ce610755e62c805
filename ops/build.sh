#!/usr/bin/env bash
# Installs what is missing and builds everything into build/release.
#
# usage: ops/build.sh [ninja targets]
set -euo pipefail
cd "$(dirname "$0")/.."
ops/setup.sh
cmake --preset release
cmake --build --preset release ${@:+--target "$@"}
