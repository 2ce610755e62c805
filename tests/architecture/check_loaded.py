"""Fail when a program loads, at its start, a library that only a program beside it may load.

usage: check_loaded.py <program> ...
"""

import re
import subprocess
import sys

APART = re.compile(r"lib(OpenImageIO|openvdb|opencv_\w+)[-.\w]*\.so")


def apart(loaded):
    return sorted({match[0] for match in APART.finditer(loaded)})


if __name__ == "__main__":
    failed = False
    for program in sys.argv[1:]:
        loaded = subprocess.run(["ldd", program], check=True, capture_output=True, text=True).stdout
        if found := apart(loaded):
            failed = True
            print(f"{program} loads {', '.join(found)}")
    sys.exit(failed)
