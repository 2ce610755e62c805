#!/usr/bin/env bash
# Makes the Debian package, installs it into a bare Debian 12 (mmdebstrap, in a temporary folder) as a user would, and runs the quickstart
# there: the same digest as here. Needs root, or user namespaces, and the network.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
if ! command -v mmdebstrap > /dev/null; then
  ((EUID == 0)) || { echo "ops/test-package.sh: mmdebstrap is missing (apt-get install mmdebstrap)" >&2; exit 1; }
  DEBIAN_FRONTEND=noninteractive apt-get -q install --yes --no-install-recommends mmdebstrap
fi
ops/package.sh
package=$(ls build/release/package/*.deb)
scratch=$(mktemp -d)
trap 'rm -rf -- "$scratch"' EXIT
cat /etc/apt/sources.list /etc/apt/sources.list.d/*.sources /etc/apt/sources.list.d/*.list > "$scratch/sources" 2> /dev/null || :
# As this machine reaches its packages.
options=()
while read -r line; do options+=(--aptopt="$line"); done < <(apt-config dump --format '%f "%v";%n' 'Acquire::http' 'Acquire::https' | grep -v '""')
echo "A bare Debian 12 with $(basename "$package") ..."
cp "$package" "$scratch/irsig.deb"
chmod 755 "$scratch"
mmdebstrap --quiet --variant=minbase "${options[@]}" --include=ca-certificates \
  --customize-hook='copy-in '"$scratch"'/irsig.deb /srv' \
  --customize-hook='chroot "$1" sh -c "apt-get -q install --yes --no-install-recommends /srv/irsig.deb > /srv/install.log 2>&1 || { cat /srv/install.log; exit 1; }"' \
  --customize-hook='chroot "$1" sh -c "cd /srv && irsig run /usr/share/irsig/jobs/examples/quickstart.toml --db quickstart.sigdb && irsig query quickstart.sigdb --season summer --nearest 1 --aspect 90,10 && irsig plot quickstart.sigdb --kind polar --band lwir --out quickstart.svg && irsig digest quickstart.sigdb > digest"' \
  --customize-hook='copy-out /srv/digest /srv/quickstart.svg '"$scratch" \
  bookworm /dev/null "$scratch/sources"
build/release/bin/irsig run jobs/examples/quickstart.toml --db "$scratch/here.sigdb" 2> /dev/null
here=$(build/release/bin/irsig digest "$scratch/here.sigdb") there=$(cat "$scratch/digest")
[[ ${here%% *} == "${there%% *}" ]] || { echo "the digests differ: $here here, $there there" >&2; exit 1; }
grep -q '</svg>' "$scratch/quickstart.svg"
echo "The package runs the quickstart in a bare Debian 12: ${there%% *}"
