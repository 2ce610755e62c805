"""Fail when two sources of a target define one name in their anonymous namespaces.

usage: check_unity.py <source root> <batches.txt>

A release compiles the sources of a target in batches (irsig_batches). In a batch, equal names are an error at best;
at worst a call finds the function of another file. Two `using` of one name may stand if both say the same;
operators are told apart by their types.
"""

import collections
import pathlib
import re
import sys

NOT_CODE = re.compile(r'R"\((?:.|\n)*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])+\'|//[^\n]*|/\*(?:.|\n)*?\*/|^\s*#(?:[^\n\\]|\\.|\\\n)*',
                      re.MULTILINE)
DIGITS_APART = re.compile(r"(?<=[0-9a-fA-F])'(?=[0-9a-fA-F])")


def without_brackets(text, open_, close):
    """`text` without what stands between `open_` and `close`."""
    out, depth = [], 0
    for c in text:
        depth += (c == open_) - (c == close and depth > 0)
        if depth == 0:
            out.append(" " if c == close else c)
    return "".join(out)


def names_of(head):
    """What the declaration that begins with `head` declares, each with what it is."""
    head = re.sub(r"\[\[.*?\]\]", " ", " ".join(head.split()))
    if alias := re.match(r"using (\w+) ?= ?(.+)", head):
        return [(alias[1], "using " + alias[2])]
    head = without_brackets(head.replace("->", " "), "<", ">").strip()
    head = re.sub(r"^template ", "", " ".join(head.split()))
    if type_ := re.match(r"(?:struct|class|union|enum class|enum) (\w+)", head):
        return [(type_[1], "type")]
    if re.match(r"(using|static_assert|friend|namespace|extern)\b", head):
        return []
    if function := re.match(r"[^=(]*[\w>&*\]] ?[ &*](\w+) ?\(", head):
        return [] if re.search(rf"(::|operator ?){function[1]} ?\(", head) else [(function[1], "function")]
    if "operator" in head or "(" in head.split("=")[0]:
        return []
    end = "=" if "=" in head else "$"
    declared = re.findall(r"[ ,&*]([A-Za-z_]\w*) ?(?:\[[^\]]*\] ?)*" + end, without_brackets(head, "(", ")"))
    return [(name, "variable") for name in declared]


def anonymous_names(text):
    """(name, what it is) of each declaration in an anonymous namespace of `text`."""
    text = NOT_CODE.sub(lambda m: '""' if m[0][0] in "\"'R" else " ", DIGITS_APART.sub("", text))
    out, stack, head = set(), [], ""
    for c in text:
        declares = bool(stack) and stack[-1] == "" and all(s is not None for s in stack)
        if c == "{":
            if space := re.search(r"namespace(?: ([\w:]+))? *$", " ".join(head.split())):
                stack.append(space[1] or "")
            else:
                if declares:
                    out.update(names_of(head))
                stack.append(None)
                continue
            head = ""
        elif c == "}":
            ended = stack.pop() if stack else None
            # Not after an initialiser, where more of the statement follows.
            if ended is not None or "=" not in head or not (stack and stack[-1] == ""):
                head = ""
        elif c == ";":
            if declares:
                out.update(names_of(head))
            if not stack or stack[-1] is not None:
                head = ""
        elif not stack or stack[-1] is not None:
            head += c
    return out


def check(root, batches):
    findings = []
    for line in batches.splitlines():
        target, files = line.split(" | ")
        found = collections.defaultdict(lambda: collections.defaultdict(set))
        for name in files.split():
            if (root / name).is_file():
                for declared, what in anonymous_names((root / name).read_text()):
                    found[declared][what].add(name)
        for declared, whats in sorted(found.items()):
            places = sorted({place for where in whats.values() for place in where})
            if len(places) > 1 and not (len(whats) == 1 and next(iter(whats)).startswith("using ")):
                findings.append(f"{places[1]}: {declared} is a name in an anonymous namespace of {places[0]}, too: "
                                f"a release compiles both as one ({target}); rename one of them")
    return findings


if __name__ == "__main__":
    findings = check(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).read_text())
    print("\n".join(findings))
    sys.exit(bool(findings))
