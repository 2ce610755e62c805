#!/usr/bin/env python3
"""Draw docs/images/atmosphere-*.svg: our level paths beside MODTRAN's (tests/physics/values/atmosphere_modtran_*.csv).

usage: ops/atmosphere_plots.py [irsig executable]      default: build/release/bin/irsig
"""
import csv
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
VALUES = ROOT / "tests/physics/values"
NAVY = ("--profile", "midlatitude_summer", "--aerosol", "navy_maritime", "--air-mass", "3", "--wind-speed-m-s", "2",
        "--wind-speed-24h-m-s", "4.1")
# The aerosol's thermal scattering is emission in their runs: surroundings at air temperature.
PLOTS = {
    "atmosphere-5km-tropical.svg": ("atmosphere_modtran_tropical.csv", 0, 5000, ("--profile", "tropical", "--aerosol",
                                    "rural", "--visibility-m", "23000")),
    "atmosphere-5km-at-5km.svg": ("atmosphere_modtran_level.csv", 5000, 5000,
                                  (*NAVY, "--surroundings-temperature-k", "267.2", "--lambda-min-um", "3",
                                   "--lambda-max-um", "5.5")),
    "atmosphere-2km-at-1km.svg": ("atmosphere_modtran_level.csv", 1000, 2000,
                                  (*NAVY, "--surroundings-temperature-k", "289.7", "--lambda-min-um", "3",
                                   "--lambda-max-um", "5.5")),
}


def reference(name, height_m, range_m):
    """The rows of a table of reference values as a CSV that irsig imports."""
    lines = [line for line in (VALUES / name).read_text().splitlines() if not line.startswith("#")]
    table = [r for r in csv.DictReader(lines) if float(r.get("height_m", height_m)) == height_m]
    radiance = "radiance" in table[0]
    out = [f"# observer_height_m: {height_m}", f"# target_height_m: {height_m}", f"# range_m: {range_m}",
           "wavenumber_cm1,transmittance" + (",radiance_w_m2_sr_um" if radiance else "")]
    for r in table:  # band means; straight lines between the centres give them back where they are smooth
        centre = float(r["centre_cm1"])
        row = [r.get("transmittance") or r["total"]] + ([r["radiance"]] if radiance else [])
        out += [",".join([f"{nu:.3f}", *row]) for nu in (centre - 4.999, centre + 4.999)]
    return "\n".join(out) + "\n"


def main():
    irsig = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "build/release/bin/irsig"
    for image, (values, height_m, range_m, air) in PLOTS.items():
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
            file.write(reference(values, height_m, range_m))
            file.flush()
            subprocess.run([irsig, "show", "atmosphere", *air, "--co2-ppmv", "330", "--level", "--observer-m",
                            str(height_m), "--range-m", str(range_m), "--modtran", file.name, "--out",
                            ROOT / "docs/images" / image], check=True)
        print(f"docs/images/{image}")


if __name__ == "__main__":
    main()
