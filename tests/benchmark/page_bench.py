"""How long the server of `irsig serve` takes for what a page asks: from the first byte sent to the last received, and its CPU time.

usage: page_bench.py <irsig executable> <database>        e.g. one that store_bench has left (its option keep)
"""
import os
import pathlib
import random
import sys
import time
import urllib.parse

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from serve_fixture import Server  # noqa: E402

REPEATS = 25


def cpu_ms(pid):
    """User and system time of a process so far."""
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return 1e3 * (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main():
    begin = time.perf_counter()
    server = Server(sys.argv[1], sys.argv[2])
    print(f"{'start to address':24} {1e3 * (time.perf_counter() - begin):8.1f} ms")
    sweep = server.json("/api/contents")["database"][0]["sweep"][0]
    print(f"{sweep['rows']} rows, {sweep['viewpoints']} viewpoints")
    chosen = random.Random(1)

    def selection():
        condition = chosen.choice(sweep["condition"])
        return {"sweep": sweep["name"], "season": condition["season"], "time": condition["time_utc"],
                "band": chosen.choice(sweep["band"])["name"], "at_range_m": sweep["range_m"][0]}

    def row():
        return {"sweep": sweep["name"], "row": chosen.randint(1, sweep["rows"])}

    asked = {
        "/": dict, "/www/main.js": dict, "/api/contents": dict, "/api/progress": dict, "/api/map": selection, "/api/row": row, "/api/spectrum": row,
        "/api/bands": selection, "/api/bands at 20 km": lambda: {**selection(), "range_m": 20000},
        "/api/cut": lambda: {**selection(), "elevation_deg": chosen.randint(2, 80)},
        "/api/compare": lambda: {**selection(), **{f"b_{k}": v for k, v in selection().items()}},
    }
    for path, parameters in asked.items():
        took_ms, before_ms = [], cpu_ms(server.process.pid)
        for _ in range(REPEATS):
            target = urllib.parse.urlencode(parameters())
            start = time.perf_counter()
            status, _, body = server.request(f"{path.split()[0]}?{target}")
            assert status == 200, body
            took_ms.append(1e3 * (time.perf_counter() - start))
        took_ms.sort()
        each_ms = (cpu_ms(server.process.pid) - before_ms) / REPEATS
        print(f"{path:24} {took_ms[REPEATS // 2]:8.1f} ms (median), {took_ms[-1]:.1f} ms (largest of {REPEATS}), {each_ms:.1f} ms CPU")
    server.end()


if __name__ == "__main__":
    main()
