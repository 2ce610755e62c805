#!/bin/sh
# Makes the maps of land_day.toml beside this file: 720 m of hills, one sample each 6 m.
set -e
cd "$(dirname "$0")"
for layer in heights grass wheat bare_soil asphalt water; do
  "${IRSIG:-irsig}" model terrain --seed 7 --map-layer "$layer" --relief-m 30 --width-m 720 --spacing-m 6 -o "$layer.asc"
done
# Made-up land begins at 0 m: lifted to the place.
awk 'NR > 6 { for (i = 1; i <= NF; ++i) $i = sprintf("%.3f", $i + 399.2) } 1' heights.asc > lifted.asc
mv lifted.asc heights.asc
