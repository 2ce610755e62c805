#!/usr/bin/env bash
# Disturbs farms for a long time, with what is built (ops/build.sh builds it): random faults, a coordinator killed at each call, a bad link that is
# cut again and again, a cluster of Slurm, damaged files, a thousand workers. Says what it does, and prints a table at the end. Half an hour and
# more; root, for what is mounted and for network namespaces: parts that a machine does not allow are named and left out.
#
# IRSIG_BUILD=asan (cmake --preset asan; cmake --build --preset asan): the same with the sanitizers' build. IRSIG_FUZZ_S=600: ten minutes of each
# test of damaged files and messages, instead of one.
#
# usage: ops/soak.sh [soak|crash_points|link|slurm|fuzz|farm_scale ...]      (default: all of them)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build=${IRSIG_BUILD:-release}
bin=build/$build/bin
tests=build/$build/tests
(($# > 0)) || set -- soak crash_points link slurm fuzz farm_scale
for part in "$@"; do
  case $part in
    soak | crash_points | link | slurm | fuzz | farm_scale) ;;
    *)
      echo "ops/soak.sh: no part \"$part\": soak, crash_points, link, slurm, fuzz, farm_scale" >&2
      exit 2
      ;;
  esac
done
if [[ ! -x $bin/irsig ]]; then
  echo "ops/soak.sh: $bin/irsig is not built: ops/build.sh, or cmake --preset $build; cmake --build --preset $build" >&2
  exit 2
fi
logs=$(mktemp -d)
echo "logs are in $logs"

table=()
result=0
# name of the part, command; its last words are the table's.
part() {
  local name=$1 begun=$SECONDS code=0
  shift
  echo "== $name: $*"
  "$@" > >(tee "$logs/$name.log") 2>&1 || code=$?
  wait
  local outcome=passed
  if ((code == 77)); then
    outcome=skipped
  elif ((code != 0)); then
    outcome="FAILED ($code)"
    result=1
  fi
  table+=("$(printf '%-14s %-12s %6d s' "$name" "$outcome" $((SECONDS - begun)))")
}
fuzz() {
  local code=0 program
  for program in "$tests"/fuzz_*; do
    echo "$program"
    IRSIG_FUZZ_S=${IRSIG_FUZZ_S:-60} "$program" --gtest_brief=1 || code=1
  done
  return $code
}

for part in "$@"; do
  case $part in
    soak) part soak /usr/bin/python3 tests/fault/soak_test.py "$bin" . 200 ;;
    crash_points) part crash_points env IRSIG_CRASH_POINTS=all "$tests/fault_crash_points" ;;
    link) part link /usr/bin/python3 tests/fault/link_test.py "$bin" . 600 40 ;;
    slurm) part slurm /usr/bin/python3 tests/system/slurm_run_test.py "$bin" . 2000 ;;
    fuzz) part fuzz fuzz ;;
    farm_scale) part farm_scale "$bin/farm_scale_bench" --folder "$logs" --require ;;
  esac
done
printf '\n'
printf '%s\n' "${table[@]}"
exit "$result"
