#!/usr/bin/env bash
# Builds and runs the benchmarks; prints their CSV. Nothing else should run on the machine meanwhile.
#
# usage: ops/benchmark.sh [core|store|farm|farm_scale|atmosphere|heat|gas|plume|ray_facet|paper_ship|watertight ...]      (default: all but
#        watertight, which takes an hour)
#        ops/benchmark.sh page     measures the examples and writes their table into docs/evidence/performance.md
set -euo pipefail
cd "$(dirname "$0")/.."
if [[ "$*" == page ]]; then
  ops/build.sh irsig irsig-coordinator irsig-worker >&2
  exec ops/performance_page.py build/release/bin/irsig
fi
(($# > 0)) || set -- core store farm farm_scale atmosphere heat gas plume ray_facet
for room in "$@"; do
  if [[ ! -f tests/benchmark/${room}_bench.cpp ]]; then
    echo "ops/benchmark.sh: no benchmark \"$room\": core, store, farm, farm_scale, atmosphere, heat, gas, plume, ray_facet, paper_ship, watertight" >&2
    exit 2
  fi
done
ops/build.sh "${@/%/_bench}" irsig-coordinator >&2
# The databases that they write and remove: on the disk of the build, not in a /tmp in memory.
bin=$PWD/build/release/bin
mkdir -p build/benchmark
cd build/benchmark
for room in "$@"; do
  echo "# $room"
  "$bin/${room}_bench"
done
