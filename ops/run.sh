#!/usr/bin/env bash
# From a fresh clone to a signature database, a picture and a table.
#
# usage: ops/run.sh [sweep.toml]      (default: jobs/examples/quickstart.toml)
#
# Leaves out/<name>.sigdb, out/<name>-polar.svg and .png. A sweep whose database is already there
# recomputes nothing that it holds.
set -euo pipefail
start=$(pwd)
cd "$(dirname "$0")/.."
sweep=jobs/examples/quickstart.toml
if (($# > 0)); then
  sweep=$(cd "$start" && realpath --relative-to="$OLDPWD" -- "$1")
fi
if (($# > 1)) || [[ ! -f $sweep ]]; then
  echo "usage: ops/run.sh [sweep.toml]: ${1:-$sweep} is no file, or there is more than one" >&2
  exit 2
fi

ops/build.sh irsig irsig-worker irsig-coordinator

irsig=build/release/bin/irsig
name=$(basename "$sweep" .toml)
db=out/$name.sigdb
mkdir -p out
resume=()
[[ -e $db ]] && resume=(--resume)
echo
echo "Computing $sweep into $db"
"$irsig" run "$sweep" --db "$db" "${resume[@]}"

# The row of viewpoints that is nearest to the bow, 30 deg above the horizon.
echo
echo "The three viewpoints nearest to the bow at 30 deg elevation"
"$irsig" query "$db" --aspect 0,30 --nearest 3
"$irsig" plot "$db" --kind polar --out "out/$name-polar.svg"
rsvg-convert --output "out/$name-polar.png" "out/$name-polar.svg"

echo
echo "database   $db    ($irsig query $db --help: what can be asked)"
echo "picture    out/$name-polar.svg, out/$name-polar.png"
