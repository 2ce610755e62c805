"""Fail when a program loads, at its start, a library that only the worker may load.

usage: check_loaded.py <program> ...
"""

import re
import subprocess
import sys

WORKER_ONLY = re.compile(r"lib(OpenImageIO|openvdb|opencv_\w+)[-.\w]*\.so")


def worker_only(loaded):
    return sorted({match[0] for match in WORKER_ONLY.finditer(loaded)})


if __name__ == "__main__":
    failed = False
    for program in sys.argv[1:]:
        loaded = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
        if found := worker_only(loaded):
            failed = True
            print(f"{program} loads {', '.join(found)}")
    sys.exit(failed)
