"""`irsig selftest` as a user types it. usage: front_door_test.py <irsig>"""

import csv
import io
import os
import re
import subprocess
import sys

irsig = sys.argv[1]


def run(*arguments, **environment):
    return subprocess.run([irsig, "selftest", *arguments], capture_output=True, text=True,
                          env={**os.environ, **environment})


def require(holds, what):
    if not holds:
        sys.exit(f"front_door_test: {what}")


table = run("--hard", "--cases", "planck")
require(table.returncode == 0, f"exit code {table.returncode}\n{table.stdout}{table.stderr}")
require(re.search(r"^planck/spectral +\S+ +2.5e-13 +yes ", table.stdout, re.M), f"no row:\n{table.stdout}")
require(re.search(r"^\d+ cases, 0 failed, ", table.stdout, re.M), f"no summary:\n{table.stdout}")

rows = list(csv.DictReader(io.StringIO(run("--hard", "--csv", "--cases", "planck/*").stdout)))
require(len(rows) >= 6, f"{len(rows)} rows")
for row in rows:
    require(row["pass"] == "yes" and float(row["worst_error"]) <= float(row["bound"]), f"{row}")
    require(int(row["checks"]) > 0 and len(row["reason"]) > 10, f"{row}")

for wrong in (["--hard", "--cases", "no such case"], [], ["--hard", "extra"]):
    refused = run(*wrong)
    require(refused.returncode == 2 and refused.stderr, f"{wrong}: exit code {refused.returncode}")


def determinism_class(tunables):
    out = run("--hard", "--cases", "determinism/fingerprint", GLIBC_TUNABLES=tunables).stdout
    return re.search(r"^determinism class: (\S+)$", out, re.M)[1]


# The same processor with another libm: where FMA is there to be hidden, the name must change.
plain = determinism_class("")
require(plain == determinism_class(""), "the class changes from run to run")
with open("/proc/cpuinfo") as cpuinfo:
    has_fma = re.search(r"^flags\s*:.*\bfma\b", cpuinfo.read(), re.M)
if has_fma:
    other = determinism_class("glibc.cpu.hwcaps=-FMA_Usable,-AVX2_Usable,-FMA,-AVX2,-FMA4")
    require(other != plain, f"{plain} with and without FMA in libm")
