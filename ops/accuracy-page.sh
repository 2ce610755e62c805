#!/usr/bin/env bash
# Remakes the pictures and tables of docs/accuracy.md, in under four minutes; nothing else should run on
# the machine meanwhile.
#
# usage: ops/accuracy-page.sh [path of the irsig executable]      (default: built by ops/build.sh)
set -euo pipefail
cd "$(dirname "$0")/.."
if (($# == 0)); then
  ops/build.sh irsig >&2
fi
irsig=${1:-$PWD/build/release/bin/irsig}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

study() {  # name, then options
  local name=$1
  shift
  "$irsig" accuracy "jobs/examples/$name.toml" --out "$work/$name" "$@" > /dev/null
  cp "$work/$name"/accuracy-"$name"-*.svg docs/images/
}
study frigate --seconds 90
study cavity --seconds 30
study quickstart --seconds 40 --band mwir

# Between the marks of each scene stands what the command wrote.
python3 - "$work" <<'EOF'
import pathlib
import re
import sys

page, work = pathlib.Path("docs/accuracy.md"), pathlib.Path(sys.argv[1])
text = page.read_text()
for name in ("frigate", "cavity", "quickstart"):
    tables = (work / name / "accuracy.md").read_text().strip()
    mark = re.compile(rf"(<!-- begin {name} -->\n).*?(<!-- end {name} -->)", re.S)
    text, count = mark.subn(lambda m: m.group(1) + tables + "\n" + m.group(2), text)
    if count != 1:
        sys.exit(f"{page}: expected one pair of marks for {name}, found {count}")
page.write_text(text)
EOF
