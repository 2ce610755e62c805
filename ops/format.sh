#!/usr/bin/env bash
# clang-format over the sources (Debian package clang-format, not needed to build).
#
# usage: ops/format.sh [--check]      --check changes nothing and fails when something would change
set -euo pipefail
cd "$(dirname "$0")/.."
case "${1:-}" in
  "") mode=(-i) ;;
  --check) mode=(--dry-run --Werror) ;;
  *)
    echo "usage: ops/format.sh [--check]" >&2
    exit 2
    ;;
esac
command -v clang-format >/dev/null || {
  echo "ops/format.sh: clang-format is missing (apt-get install clang-format)" >&2
  exit 1
}
git ls-files -z --cached --others --exclude-standard '*.cpp' '*.h' | xargs -0 clang-format "${mode[@]}"
