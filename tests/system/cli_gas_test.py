"""irsig show gas: a column of hot gas, alone and behind air.

usage: cli_gas_test.py <irsig executable>
"""
import csv
import io
import math
import pathlib
import subprocess
import sys
import unittest
import xml.etree.ElementTree

IRSIG = str(pathlib.Path(sys.argv[1]).resolve())
FUNNEL = ("--temperature-k", "650", "--co2", "0.07", "--h2o", "0.06", "--soot", "1e-9")


def irsig(*arguments, exit_code=0):
    done = subprocess.run([IRSIG, "show", "gas", *map(str, arguments)], capture_output=True, text=True, timeout=300)
    if done.returncode != exit_code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done.stdout if exit_code == 0 else done.stdout + done.stderr


def rows(text):
    return [{k: float(v) for k, v in r.items() if v} for r in csv.DictReader(io.StringIO(text))]


def at(table, wavenumber_cm1):
    return next(r for r in table if r["wavenumber_cm1"] == wavenumber_cm1)


def planck(lambda_um, temperature_k):
    return 1.191042972e8 / lambda_um ** 5 / math.expm1(14387.76877 / (lambda_um * temperature_k))


class Gas(unittest.TestCase):
    def test_column(self):
        table = rows(irsig(*FUNNEL))
        self.assertEqual([r["lambda_um"] for r in table], sorted(r["lambda_um"] for r in table))
        for r in table:
            self.assertAlmostEqual(r["emissivity"] + r["transmittance"], 1, places=6)
            self.assertAlmostEqual(r["radiance_w_m2_sr_um"],
                                   r["emissivity"] * planck(r["lambda_um"], 650), delta=1e-4 * r["radiance_w_m2_sr_um"] + 1e-12)
            self.assertLessEqual(r["emissivity"], min(1, r["absorption_per_m"] * 1.001))
        # Black at 4.3 um, nearly clear at 3.9 um.
        self.assertGreater(at(table, 2325)["emissivity"], 0.98)
        self.assertLess(at(table, 2565)["emissivity"], 0.02)
        longer = rows(irsig(*FUNNEL, "--length-m", "3"))
        # Absorption adds up at each wavenumber: a column three times as long takes more, and less than three times as much.
        for one, three in zip(table, longer):
            self.assertGreaterEqual(three["emissivity"], one["emissivity"] * (1 - 1e-6))
            self.assertLessEqual(three["emissivity"], 3 * one["emissivity"] * (1 + 1e-6))
        self.assertGreater(at(longer, 2235)["emissivity"], 1.3 * at(table, 2235)["emissivity"])
        thinner = rows(irsig(*FUNNEL, "--pressure-atm", "0.5"))
        self.assertLess(at(thinner, 2235)["emissivity"], at(table, 2235)["emissivity"])

    def test_background_air(self):
        table = rows(irsig(*FUNNEL, "--range-m", "1000", "--profile", "midlatitude_summer", "--aerosol", "none"))
        self.assertEqual(len(table), 275)
        spike = max(r["apparent_radiance_w_m2_sr_um"] for r in table if 2220 < r["wavenumber_cm1"] < 2290)
        core = at(table, 2345)
        # Air hides the middle of the band and leaves its red wing.
        self.assertGreater(core["radiance_w_m2_sr_um"], spike)
        self.assertLess(core["apparent_radiance_w_m2_sr_um"], 1e-3 * spike)
        # The air takes more of these lines than it takes of grey light, nowhere much less.
        for r in table:
            product = r["radiance_w_m2_sr_um"] * r["air_transmittance"]
            self.assertLessEqual(r["apparent_radiance_w_m2_sr_um"], product * 1.1 + 1e-9)
        red = at(table, 2265)
        self.assertLess(red["apparent_radiance_w_m2_sr_um"], red["radiance_w_m2_sr_um"] * red["air_transmittance"])

    def test_drawing(self):
        for extra in ((), ("--range-m", "5000", "--profile", "tropical", "--aerosol", "none")):
            svg = irsig(*FUNNEL, *extra, "--lambda-min-um", "3", "--lambda-max-um", "5.5", "--svg")
            xml.etree.ElementTree.fromstring(svg)
            self.assertEqual("behind air" in svg, bool(extra))

    def test_refusals(self):
        def refused(*arguments):
            return irsig(*arguments, exit_code=2)
        self.assertIn("--temperature-k is required", irsig("--co2", "0.1", exit_code=2))
        self.assertIn("nothing absorbs", refused("--temperature-k", "600"))
        self.assertIn("temperature_k 150", refused("--temperature-k", "150", "--co2", "0.1"))
        self.assertIn("pressure_pa 506625", refused(*FUNNEL, "--pressure-atm", "5"))
        self.assertIn("h2o + co2 + co 1.3", refused("--temperature-k", "600", "--co2", "0.7", "--h2o", "0.6"))
        self.assertIn("--range-m is missing", refused(*FUNNEL, "--profile", "tropical"))
        self.assertIn("--profile is missing", refused(*FUNNEL, "--range-m", "100"))
        self.assertIn("no band between", refused(*FUNNEL, "--lambda-min-um", "300", "--lambda-max-um", "400"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
