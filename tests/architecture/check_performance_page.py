"""The table of docs/evidence/performance.md that ops/benchmark.sh page writes is of the program's physics version.

usage: check_performance_page.py <repository>
"""
import pathlib, re, sys

BEGIN = "<!-- measured by ops/benchmark.sh page -->"


def complaint(page, header):
    """What is wrong; empty: nothing."""
    now = int(re.search(r"kPhysicsVersion = (\d+);", header)[1])
    if page.count(BEGIN) != 1:
        return f"docs/evidence/performance.md: expected one line `{BEGIN}`"
    said = re.match(r"\s*Physics version (\d+), \d{4}-\d\d-\d\d, ", page.split(BEGIN)[1])
    if not said:
        return "docs/evidence/performance.md: the measured table does not say its physics version and date"
    if int(said[1]) != now:
        return (f"docs/evidence/performance.md: its table was measured with physics version {said[1]}, the program has {now}: "
                "run `ops/benchmark.sh page`")
    return ""


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    wrong = complaint((root / "docs/evidence/performance.md").read_text(), (root / "core/signature/view/result.h").read_text())
    if wrong:
        sys.exit(wrong)
