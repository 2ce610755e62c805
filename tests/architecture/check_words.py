"""Fail on words that do not belong in a source tree.

usage: check_words.py <source root>

Checked in every text file: paths of one machine or of one workplace, marks of unfinished work, and names that have been
replaced by a term of the field.
Checked in C++: no comment opens as a fragment ("Of ...", "What ...", "Whether ...", "The same ...").
Checked in headers: a comment of a function begins with a verb ("Returns ...", or "Return ..." for several functions).
Checked in Markdown: no line above 120 columns (rows of tables, headings and pictures cannot be broken, and are exempt).
Checked in Markdown and comments: files of the tree that are named exist.
Checked in names: folders and files that say nothing (STYLE: a folder is a noun and a layer).
"""

import pathlib
import re
import sys

MACHINE_PATH = re.compile(r"(?<![\w.$}])/(work|home|root|Users)(/|\b)")
UNFINISHED = re.compile(r"\b(TODO|FIXME|XXX|HACK)\b")
EMPTY_NAME = re.compile(r"(^|_)(utils?|common|misc|helpers?|managers?)(_|$)")
SKIPPED_FOLDERS = {".git", "build", "out", "__pycache__"}
TEXT = {".c", ".cc", ".cmake", ".cpp", ".css", ".csv", ".h", ".html", ".inc", ".js", ".json", ".md", ".proto", ".py", ".service",
        ".sh", ".sql", ".supp", ".svg", ".toml", ".txt", ""}

# Names that a term of the field has replaced: old name -> the name to use. Pages on former versions may name them
# (FORMER_NAMES_IN).
FORMER_NAMES = {
    "AirBeforeGas": "ForegroundAir", "BehindNodes": "BackgroundDirections", "EstimatorKnobs": "EstimatorOptions",
    "GasOnRays": "RayMedium", "GasSurvey": "ColumnCollector", "LightAround": "IncidentRadiance",
    "LowerSpec": "SurfaceBoundary", "MadeOnce": "Lazy", "WeatherLight": "ThermalSurroundings", "emittance": "exitance",
    "escaped_to_lower": "escaped_to_surface", "guarded_path_limit": "truncated_paths", "hat_fit": "linear_basis_fit",
    "import_apart": "import_subprocess", "keep_aside": "store_conflicting_result",
    "no_second_hit": "skip_self_intersection", "parts_reflected_w_sr": "interreflected_w_sr", "plume_on_hull": "plume_reflected",
    "release_what_nobody_holds": "release_orphaned_leases", "run_apart": "run_subprocess",
    "sea_reflected": "surface_reflected", "sky_bound_w_sr": "direction_interpolation_bound_w_sr",
    "target_missed": "accuracy_not_reached", "target_reached": "accuracy_reached",
    "unseen_bound_w_sr": "undersampling_bound_w_sr", "unseen_stderr_w_sr": "undersampling_stderr_w_sr",
    "vdb_apart": "vdb_subprocess",
}
FORMER_NAME = re.compile(rf"\b({'|'.join(FORMER_NAMES)})\b")
FORMER_NAMES_IN = ("schema/README.md", "docs/decisions/", "tests/")

# A comment that opens so is no sentence: its subject or its verb is missing.
FRAGMENT = re.compile(r"(Of|What|Whether|The same)\b")
VERBLESS_ALLOWED_IN = ("tests/",)
COMMENT = re.compile(r"^\s*///?\s?(.*)$")

# A function's comment begins with a verb in the third person, "Like f(), ..." or, for several functions, "Return ...".
VERB = re.compile(r"([A-Z][a-z]+s\b(?!:)|Like |(Return|Compute|Implement|Encode|Add|Read|Write|Set)\b)")
FUNCTION = re.compile(r"(template <.*?> )?(\[\[nodiscard\]\] )?((static|virtual|explicit|inline|friend|constexpr) )*"
                      r"(?!struct |class |enum |using |namespace |const |constexpr |inline constexpr )"
                      r"[\w:<>,&* ]+?[ &*]\w+\(")
CONSTRUCTOR = re.compile(r"(explicit )?[A-Z]\w*\(")

COLUMNS = 120
UNBREAKABLE = re.compile(r"^\s*(\||#|!\[[^]]*\]\([^)]*\)$)")

# A file of the tree, as comments and pages name it: from the root, or from the folder of the page.
ENDING = r"(?:bib|cmake|cpp|css|csv|h|html|inc|js|json|md|png|proto|py|service|sh|sql|svg|toml|txt)"
PATH = re.compile(rf"(?<![\w./$}}*-])((?:[\w.-]+/)+[\w.-]+\.{ENDING})(?![\w/*])")
CODED_PATH = re.compile(rf"`((?:[\w.-]+/)+[\w.-]+\.{ENDING})`")
CODED_FILES = re.compile(r"`((?:[\w.-]+/)+[\w-]+\.\*)`")  # a header and its source: `core/base/table.*`
# Made by a command or by the build, or a pattern for names.
GENERATED = re.compile(r"NAME|^pictures/|^build/|\.pb\.h$")
COMMENTS = {".h": "//", ".cpp": "//", ".proto": "//", ".py": "#", ".sh": "#", ".cmake": "#", ".txt": "#", ".sql": "--",
            ".toml": "#"}


def fragments(path):
    """(number, line) of comments that open as a fragment; a comment goes on over lines that hold nothing else."""
    inside = False
    for number, line in enumerate(path.read_text().splitlines(), 1):
        whole = COMMENT.match(line)
        opening = whole[1] if whole else line.partition("  // ")[2]
        if not inside and FRAGMENT.match(opening):
            yield number, opening
        # A comment behind code goes on in lines that hold a comment alone, far to the right.
        inside = bool(whole) or (inside and not line.strip()) or bool(opening and "  // " in line)


def without_verb(path):
    """(number, line) of comments of functions that do not begin with a verb; lists of parameters alone are exempt."""
    lines = path.read_text().splitlines()
    start = None
    for number, line in enumerate(lines):
        if whole := COMMENT.match(line):
            if start is None:
                start, opening = number, whole[1]
            continue
        if start is not None and line.strip() and not opening.startswith("  ") and not FRAGMENT.match(opening) and not VERB.match(opening):
            code = " ".join(part.strip() for part in lines[number:number + 3])
            if FUNCTION.match(code) and not CONSTRUCTOR.match(code):
                yield start + 1, opening
        start = None


def long_lines(text):
    for number, line in enumerate(text.splitlines(), 1):
        if len(line) > COLUMNS and not UNBREAKABLE.match(line):
            yield number, len(line)


def stale_paths(root, name, text, rooms):
    """(number, path) of files that are named and do not exist. rooms: the folders at the root."""
    page = name.suffix == ".md"
    mark = COMMENTS.get(name.suffix)
    for number, line in enumerate(text.splitlines(), 1):
        comment = line if page else line.partition(mark)[2] if mark else ""
        named = {m[1] for m in PATH.finditer(comment) if m[1].split("/")[0] in rooms}
        if page:
            named |= {m[1] for m in CODED_PATH.finditer(line)}
            named |= {m[1] for m in CODED_FILES.finditer(line) if m[1].split("/")[0] in rooms and not any(root.glob(m[1]))}
        for path in sorted(named):
            if not (GENERATED.search(path) or (root / path).exists() or (root / name.parent / path).exists()):
                yield number, path


def files_below(root):
    for path in sorted(root.iterdir()):
        if path.name in SKIPPED_FOLDERS:
            continue
        yield path
        if path.is_dir():
            yield from files_below(path)


def check(root):
    findings = []
    rooms = {path.name for path in root.iterdir() if path.is_dir()} - SKIPPED_FOLDERS
    for path in files_below(root):
        name = path.relative_to(root)
        if EMPTY_NAME.search(path.name.split(".")[0].lower()):
            findings.append(f"{name}: a name that says nothing about what is in it")
        if path.is_dir() or path.suffix not in TEXT:
            continue
        if name.parts[:2] == ("tests", "architecture"):  # the words stand here to be searched for
            continue
        text = path.read_text(errors="replace")
        former = not str(name).startswith(FORMER_NAMES_IN)
        for number, line in enumerate(text.splitlines(), 1):
            for pattern, what in ((MACHINE_PATH, "a path of one machine"), (UNFINISHED, "unfinished work")):
                if found := pattern.search(line):
                    findings.append(f"{name}:{number}: {what}: {found[0]}")
            if former and (found := FORMER_NAME.search(line)):
                findings.append(f"{name}:{number}: {found[0]} is a former name; use {FORMER_NAMES[found[0]]}")
        if path.suffix in (".h", ".cpp"):
            findings += [f"{name}:{number}: a comment opens as a fragment; begin with \"Returns ...\" or a noun with its "
                         f"unit: {line[:50]}" for number, line in fragments(path)]
        if path.suffix == ".h" and not str(name).startswith(VERBLESS_ALLOWED_IN):
            findings += [f"{name}:{number}: a function's comment begins without a verb; begin with \"Returns ...\": {line[:50]}"
                         for number, line in without_verb(path)]
        if path.suffix == ".md":
            findings += [f"{name}:{number}: {length} columns, more than {COLUMNS} (only rows of tables, headings and "
                         f"pictures may be longer)" for number, length in long_lines(text)]
        findings += [f"{name}:{number}: names {path}, which does not exist"
                     for number, path in stale_paths(root, name, text, rooms)]
    return findings


if __name__ == "__main__":
    findings = check(pathlib.Path(sys.argv[1]))
    print("\n".join(findings))
    sys.exit(bool(findings))
