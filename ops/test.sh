#!/usr/bin/env bash
# Installs what is missing, builds everything and runs all tests.
#
# usage: ops/test.sh [ctest options]      e.g. ops/test.sh -L physics, ops/test.sh -R store
set -euo pipefail
cd "$(dirname "$0")/.."
SECONDS=0
ops/build.sh
built_s=$SECONDS
result=0
ctest --preset release --parallel "${IRSIG_TEST_JOBS:-2}" "$@" || result=$?
echo "set-up and build $built_s s, tests $((SECONDS - built_s)) s, together $SECONDS s"
exit "$result"
