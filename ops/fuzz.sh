#!/usr/bin/env bash
# Looks for files that break a reader: libFuzzer, which keeps what reaches new branches, with AddressSanitizer and UndefinedBehaviorSanitizer.
# Installs Debian's clang 19 if it is not there, builds fuzz_guided, searches some time for each reader, as many at a time as there are cores, and
# keeps the inputs that together reach all that was reached in tests/fuzz/corpus, which the suite replays. What broke a reader stays in out/fuzz.
#
# usage: ops/fuzz.sh [SECONDS [READER ...]]      (default: 600 seconds for each of them)
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
seconds=${1:-600}
shift $(($# > 0 ? 1 : 0))
missing=()
for package in clang-19 libclang-rt-19-dev libomp-19-dev; do
  dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q '^install ok installed$' || missing+=("$package")
done
if ((${#missing[@]} > 0)); then
  apt-get update -qq
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
fi
cmake --preset guided >/dev/null
cmake --build --preset guided
guided=$PWD/build/guided/tests/fuzz_guided
readers=("$@")
((${#readers[@]} > 0)) || mapfile -t readers < <("$guided" --readers)
found=$PWD/out/fuzz
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$found" tests/fuzz/corpus

search() {
  local reader=$1 begin=$2/$1 code=0
  export IRSIG_FUZZ_READER=$reader
  mkdir -p "$begin/all" "$begin/few"
  "$guided" --unpack "$reader" "$begin/all"
  # In its own folder: what a reader writes is no concern of this one.
  (cd "$begin" && "$guided" all -max_total_time="$3" -max_len=20000 -timeout=20 -rss_limit_mb=3000 -print_final_stats=1 \
    -artifact_prefix="$4/$reader-") >"$begin/log" 2>&1 || code=$?
  "$guided" -merge=1 "$begin/few" "$begin/all" >"$begin/merge.log" 2>&1 || code=$?
  "$guided" --pack "$reader" "$begin/few"
  printf '%-18s %s executions, %s\n' "$reader" "$(sed -n 's/^stat::number_of_executed_units: *//p' "$begin/log")" \
    "$( ((code == 0)) && echo 'nothing found' || echo "FAILED ($code): $4/$reader-*")"
  ((code == 0)) || grep -v "^#" "$begin/log" | tail -40
  return $((code != 0))
}
export -f search
export guided
printf '%s\n' "${readers[@]}" | xargs -P "$(nproc)" -I{} bash -c 'search "$@"' search {} "$work" "$seconds" "$found"
