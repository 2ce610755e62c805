#!/bin/sh
# Makes the maps of vehicle_land.toml beside this file: 2 km of hills 60 m high, one sample each 20 m.
set -e
cd "$(dirname "$0")"
for layer in heights grass wheat bare_soil asphalt water; do
  "${IRSIG:-irsig}" model terrain --seed 7 --map-layer "$layer" --relief-m 60 --width-m 2000 --spacing-m 20 -o "$layer.asc"
done
