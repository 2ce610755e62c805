#!/usr/bin/env bash
# Sets up, builds, makes the site of docs/ and makes the Debian package: build/release/package/irsig_VERSION_ARCHITECTURE.deb.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
ops/build.sh all
ops/docs.sh
(cd build/release && cpack > package.log) || { cat build/release/package.log >&2; exit 1; }
ls build/release/package/*.deb
