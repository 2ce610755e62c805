#!/usr/bin/env python3
"""Measures the example jobs and writes the table of docs/evidence/performance.md that stands between its marks.

usage: ops/performance_page.py <irsig> [--only NAME ...]     (all: about 15 minutes on 2 cores)

Each line is one run of `irsig run` in a folder of its own. CPU time is that of all its processes, memory the largest
resident size of any of them. The line above the table says the physics version, the date and the machine; a test compares
the version with the program's (tests/architecture/check_performance_page.py).
"""
import csv, datetime, io, os, pathlib, re, subprocess, sys, tempfile, time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/evidence/performance.md"
BEGIN, END = "<!-- measured by ops/benchmark.sh page -->", "<!-- end of what was measured -->"

# Name, changes of the example's text, numbers of workers.
JOBS = (
    ("quickstart", {}, (1,)),
    ("frigate", {"count = 191": "count = 24"}, (1, 2, 4, 16)),
    ("frigate_paper", {"count = 191": "count = 24"}, (1, 2)),
    ("frigate_plume", {}, (1,)),
    ("drone", {}, (1,)),
    ("frigate_day", {}, (1, 4)),
)


def machine():
    model = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())[1]
    flags = re.search(r"flags\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())[1].split()
    isa = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "SSE 4.2"
    return f"{os.cpu_count()} x {model}, {isa}"


def physics_version(irsig, database):
    rows = subprocess.run([irsig, "query", database, "--csv"], capture_output=True, text=True, check=True).stdout
    return int(next(csv.DictReader(io.StringIO(rows)))["physics_version"])


def measure(irsig, name, changes, workers):
    text = (ROOT / f"jobs/examples/{name}.toml").read_text()
    for old, new in changes.items():
        if old not in text:
            sys.exit(f"{name}.toml has no `{old}` any more: change JOBS")
        text = text.replace(old, new)
    with tempfile.TemporaryDirectory() as folder:
        # Files that the job names lie beside the examples, or in the folder next to the examples' folder.
        examples = pathlib.Path(folder, "examples")
        examples.mkdir()
        pathlib.Path(folder, "models").symlink_to(ROOT / "jobs/models")
        job, database = examples / f"{name}.toml", pathlib.Path(folder, "x.sigdb")
        for other in (ROOT / "jobs/examples").iterdir():
            if other.name != job.name:
                (examples / other.name).symlink_to(other)
        job.write_text(text)
        begun = time.monotonic()
        child = subprocess.Popen([irsig, "run", job, "--db", database, "--workers", str(workers)], cwd=folder, stdout=subprocess.PIPE,
                                 text=True)
        said = (child.stdout.read().strip().splitlines() or [""])[-1]
        _, status, used = os.wait4(child.pid, 0)  # with what its own children used
        if status != 0:
            sys.exit(f"{name}: irsig run ended with status {status}")
        cpu = used.ru_utime + used.ru_stime
        rays = re.search(r"([\d.]+ [kMG]?rays)", said)[1]
        worst = re.search(r"worst error ([\d.]+ %)", said)
        reached = re.search(r"\((\d+) of (\d+) rows reach", said)
        return (f"| `{name}.toml`{''.join(', ' + new for new in changes.values())} | {workers} | {time.monotonic() - begun:.1f} | "
                f"{cpu:.1f} | {rays} | {used.ru_maxrss / 1024:.0f} | "
                f"{f'{int(reached[2]) - int(reached[1])} of {reached[2]}' if reached else '0'} | {worst[1] if worst else ''} |",
                physics_version(irsig, database))


def main():
    irsig, only = pathlib.Path(sys.argv[1]).resolve(), sys.argv[3:] if "--only" in sys.argv else [job[0] for job in JOBS]
    lines, version = [], 0
    for name, changes, numbers in JOBS:
        for workers in numbers if name in only else ():
            line, version = measure(irsig, name, changes, workers)
            print(line, flush=True)
            lines.append(line)
    page = PAGE.read_text()
    head, rest = page.split(BEGIN)
    tail = rest.split(END)[1]
    PAGE.write_text("\n".join((
        head + BEGIN, f"Physics version {version}, {datetime.date.today()}, {machine()}, one run each, `ops/benchmark.sh page`:", "",
        "| job | workers | wall [s] | CPU [s] | rays | memory of a process [MB] | rows that miss | worst error |",
        "|---|---|---|---|---|---|---|---|", *lines, END)) + tail)


if __name__ == "__main__":
    main()
