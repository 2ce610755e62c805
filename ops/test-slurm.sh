#!/usr/bin/env bash
# Sets up, builds, starts a cluster of Slurm on this machine (a controller, two nodes) and runs sweeps of about a minute on it with
# `irsig run --launcher slurm`, while a node and the coordinator are killed, workers cancelled, the command interrupted: the digests of local runs.
# usage: ops/test-slurm.sh [viewpoints]      (2000)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
ops/build.sh all
/usr/bin/python3 tests/system/slurm_run_test.py build/release/bin . "${1:-2000}"
