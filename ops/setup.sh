#!/usr/bin/env bash
# Installs the packages of ops/packages.txt that are missing (Debian 12, on which every change is
# tested, and 13). Does nothing, and needs no privileges, when none is.
#
# usage: ops/setup.sh [LIST]      LIST: another list of packages to install instead, e.g. ops/packages-docs.txt
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

list=${1:-ops/packages.txt}
if [[ ! -r $list ]]; then
  echo "ops/setup.sh: $list: no such list of packages (a path from the repository's folder)" >&2
  exit 2
fi
mapfile -t packages < <(grep -vE '^[[:space:]]*(#|$)' "$list")
if ! command -v dpkg-query >/dev/null; then
  echo "ops/setup.sh: this is no Debian system: install what corresponds to ops/packages.txt yourself" >&2
  exit 1
fi
# Read in a shell of its own: the file sets many variables.
release=$(. /etc/os-release 2>/dev/null && echo "${ID:-} ${VERSION_ID:-}" || true)
case $release in
  "debian 12") ;;
  "debian 13")
    echo "ops/setup.sh: /etc/os-release: irsig is tested on Debian 12; on 13 it takes Embree 4 and newer libraries" \
         "(docs/developers/debian-13.md: what was not tried)" >&2
    ;;
  *)
    echo "ops/setup.sh: /etc/os-release: this system is not Debian 12 (\"$release\"); packages may have other names" \
         "or versions: install what corresponds to ops/packages.txt if a step below fails" >&2
    ;;
esac
missing=()
for package in "${packages[@]}"; do
  state=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $state == installed ]] || missing+=("$package")
done
if ((${#missing[@]} == 0)); then
  exit 0
fi

as_root=()
if ((EUID != 0)); then
  if ! command -v sudo >/dev/null; then
    echo "ops/setup.sh: these packages are missing, and there is neither root nor sudo to install them:" >&2
    echo "  apt-get install --no-install-recommends ${missing[*]}" >&2
    exit 1
  fi
  as_root=(sudo)
fi
echo "Installing ${#missing[@]} missing packages: ${missing[*]}"
# Through env, because sudo does not pass the variable on.
apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -qq -o Dpkg::Use-Pty=0 -o Acquire::Retries=3)
"${apt[@]}" update
"${apt[@]}" install --yes --no-install-recommends "${missing[@]}"
