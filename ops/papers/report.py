"""The findings of the five papers beside ours, as Markdown tables (called by ops/papers.sh).

usage: report.py BIN [--write] [--coarse] PART...

A part is a module of this folder with a function `findings(lab)` that returns rows; `lab` runs the programs.
"""
import csv, dataclasses, importlib, io, pathlib, re, subprocess, sys, tempfile, time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
PAGE = ROOT / "docs/evidence/validation.md"
HEAD = ("| where | finding | paper | ours | agreement | part | remark |", "|---|---|---|---|---|---|---|")
# With --coarse: errors at which a part takes seconds, and its numbers lose their last digits.
COARSE = (("source_radiance_temperature_stderr_k", "0.05"), ("samples_per_replicate", "16"), ("relative_error", "0.05"))
AGREEMENTS = ("yes", "in order", "no", "not compared")


@dataclasses.dataclass
class Row:
    """One finding. `agreement` is one of AGREEMENTS: yes (the number or the fact), in order (sign or ranking, but not
    the number), no, not compared; the last two need a remark that says why."""
    where: str
    finding: str
    paper: str
    ours: str
    agreement: str
    remark: str = ""

    def cells(self, part):
        assert self.agreement in AGREEMENTS, self.agreement
        assert self.remark or self.agreement in AGREEMENTS[:2], self.finding
        return f"| {self.where} | {self.finding} | {self.paper} | {self.ours} | {self.agreement} | `{part}` | {self.remark} |"


def near(ours, paper, within):
    """"yes" if all of ours are within that fraction of the paper's, "in order" if both rise and fall alike."""
    if all(abs(a / b - 1) <= within for a, b in zip(ours, paper, strict=True)):
        return "yes"
    return in_order(ours, paper)


def in_order(ours, paper):
    def rank(values):
        return sorted(range(len(values)), key=lambda i: values[i])
    return "in order" if len(ours) > 1 and rank(ours) == rank(paper) else "no"


def fact(true):
    return "yes" if true else "no"


def joined(values, form="{:.1f}"):
    return ", ".join(form.format(v) for v in values)


class Lab:
    """Runs the programs on changed examples, in a folder of its own."""

    def __init__(self, binaries, folder, coarse=False):
        self.bin, self.folder, self.coarse = pathlib.Path(binaries), pathlib.Path(folder), coarse

    def example(self, name):
        """The example's text; the files that it names have absolute paths."""
        text = (ROOT / f"jobs/examples/{name}.toml").read_text()
        for key, value in COARSE if self.coarse else ():
            text = re.sub(rf"(?m)^{key} = .*$", f"{key} = {value}", text)
        return re.sub(r'"(\.\./models|land_day)/', lambda m: f'"{ROOT}/jobs/examples/{m[1]}/', text)

    def irsig(self, *words, fails_with=0):
        """What it prints; exit codes other than 0 and `fails_with` end the part."""
        done = subprocess.run([self.bin / "irsig", *map(str, words)], capture_output=True, text=True)
        if done.returncode not in (0, fails_with):
            sys.exit(f"irsig {' '.join(map(str, words))}: exit code {done.returncode}\n{done.stderr}")
        return done.stdout

    def tool(self, name, *words):
        return self.table(subprocess.run([self.bin / name, *map(str, words)], check=True, capture_output=True, text=True).stdout)

    @staticmethod
    def table(text):
        return list(csv.DictReader(line for line in io.StringIO(text) if not line.startswith("#")))

    def run(self, name, text):
        """Runs a sweep; returns its database."""
        sweep, database = self.folder / f"{name}.toml", self.folder / f"{name}.sigdb"
        sweep.write_text(text)
        self.irsig("run", sweep, "--db", database)
        return database

    def query(self, database, *options):
        return self.table(self.irsig("query", database, *options, "--csv"))


def change(text, *changes):
    """Replaces regular expressions (multi-line, dot matches newline); each must be found."""
    for pattern, new in changes:
        text, count = re.subn(f"(?ms){pattern}", new, text)
        if count == 0:
            sys.exit(f"ops/papers: `{pattern}` is not in the example any more: change the part")
    return text


def written(page, part, table):
    mark = re.compile(rf"(<!-- begin papers {part} -->\n).*?(<!-- end papers {part} -->)", re.S)
    page, count = mark.subn(lambda m: m[1] + table + m[2], page)
    if count != 1:
        sys.exit(f"{PAGE}: expected one pair of marks `papers {part}`, found {count}")
    return page


def main():
    words = sys.argv[2:]
    for part in (w for w in words if not w.startswith("--")):
        began = time.monotonic()
        with tempfile.TemporaryDirectory() as folder:
            rows = importlib.import_module(part).findings(Lab(sys.argv[1], folder, "--coarse" in words))
        table = "".join(line + "\n" for line in (*HEAD, *(row.cells(part) for row in rows)))
        print(table, flush=True)
        if "--write" in words:
            PAGE.write_text(written(PAGE.read_text(), part, table))
        print(f"ops/papers.sh: {part}: {len(rows)} findings in {time.monotonic() - began:.0f} s", file=sys.stderr)


if __name__ == "__main__":
    main()
