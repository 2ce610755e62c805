#!/usr/bin/env bash
# Builds the static site of docs/ into build/docs/html and checks its links; installs MkDocs if it is missing.
#
# usage: ops/docs.sh      then open build/docs/html/index.html; search needs a server, e.g. python3 -m http.server
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
ops/setup.sh
python3 -B ops/docs_site.py build/docs
