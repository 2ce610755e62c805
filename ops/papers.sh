#!/usr/bin/env bash
# Prints, for each finding of the five papers, the paper's value beside ours: a Markdown table for each part. Two busy
# cores need 4 to 6 minutes for ship, 3 for outdoor, and about one for each of the others.
#
# usage: ops/papers.sh [--bin FOLDER] [--write | --coarse] [ship|cavity|goniometer|outdoor|prisse ...]      (default: all five)
#        --bin     programs that are built already, instead of those of ops/build.sh
#        --write   puts the tables between their marks in docs/evidence/validation.md, too
#        --coarse  larger errors in cavity and goniometer, to try the script in seconds
set -euo pipefail
cd "$(dirname "$0")/.."
bin=
options=()
parts=()
while (($# > 0)); do
  case $1 in
    --bin)
      if [[ ! -x ${2-}/irsig ]]; then
        echo "ops/papers.sh: --bin \"${2-}\": no program irsig in this folder" >&2
        exit 2
      fi
      bin=$(realpath "$2")
      shift
      ;;
    --write | --coarse) options+=("$1") ;;
    ship | cavity | goniometer | outdoor | prisse) parts+=("$1") ;;
    *)
      echo "ops/papers.sh: no part \"$1\": ship, cavity, goniometer, outdoor, prisse" >&2
      exit 2
      ;;
  esac
  shift
done
if [[ " ${options[*]-} " == *" --write "* && " ${options[*]-} " == *" --coarse "* ]]; then
  echo "ops/papers.sh: --write keeps the numbers of full runs; leave --coarse out" >&2
  exit 2
fi
((${#parts[@]} > 0)) || parts=(ship cavity goniometer outdoor prisse)
if [[ -z $bin ]]; then
  ops/build.sh irsig irsig-coordinator irsig-worker irsig-picture paper_ship_bench >&2
  bin=$PWD/build/release/bin
fi
exec python3 -B ops/papers/report.py "$bin" ${options[@]+"${options[@]}"} "${parts[@]}"
