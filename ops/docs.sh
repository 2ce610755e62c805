#!/usr/bin/env bash
# Builds docs/ as web pages without a network: build/docs/index.html. The Debian package ships them
# (share/doc/irsig/html).
#
#   ops/docs.sh [FOLDER]      FOLDER: in place of build/docs
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
ops/setup.sh
python3 -B ops/docs_site.py "${1:-build/docs}"
