"""Fail on pages whose sentences are long: WORDS_PER_SENTENCE on average over a page, LONGEST for each sentence; and if all
pages together have fewer than FEWEST_PER_SENTENCE on average, as fragments have.

usage: check_sentences.py <source root> [--report]      --report prints words, sentences, mean and longest of each page

Checked: README.md, tutorials, how-to pages and reference pages. A sentence ends at a full stop, question mark or exclamation
mark, and at the end of a paragraph or list item. Code, tables and headings do not count; a link counts as its text, code in
backticks as one word.
"""

import pathlib
import re
import sys

FEWEST_PER_SENTENCE, WORDS_PER_SENTENCE = 15, 22
LONGEST = 40
PAGES = ("README.md", "docs/tutorials/*.md", "docs/howto/*.md", "docs/reference/*.md")
ITEM = re.compile(r"^\s*(?:[-*+]|\d+\.)\s+")
# A stop ends a sentence before a space, not after an abbreviation.
END = re.compile(r"(?<!\be\.g)(?<!\bi\.e)(?<!\bcf)(?<!\bvs)[.!?](?:[\"')\]*_]*)(?=\s|$)")


def paragraphs(text):
    """(number of the first line, text) of every paragraph and list item."""
    fenced, start, current = False, 0, []
    for number, line in enumerate([*text.splitlines(), ""], 1):
        if re.match(r"^\s*(```|~~~)", line):
            fenced, line = not fenced, ""
        elif fenced:
            continue
        code = line.startswith("    ") and not current
        apart = not line.strip() or code or re.match(r"^\s*(\||#|<|!\[)", line)
        if (apart or ITEM.match(line)) and current:
            yield start, " ".join(current)
            current = []
        if not apart:
            start = start if current else number
            current.append(ITEM.sub("", line).strip())


def sentences(text):
    """(number of the line where its paragraph begins, number of words, beginning) of every sentence."""
    for number, paragraph in paragraphs(text):
        plain = re.sub(r"`[^`]*`", "Code", paragraph)
        plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", plain)
        for sentence in END.split(plain):
            words = [w for w in sentence.split() if re.search(r"[A-Za-z0-9]", w)]
            if words:
                yield number, len(words), " ".join(words[:6])


def pages_of(root):
    return [path for pattern in PAGES for path in sorted(root.glob(pattern))]


def check(root):
    findings, all_words, all_sentences = [], 0, 0
    for path in pages_of(root):
        name = path.relative_to(root)
        found = list(sentences(path.read_text()))
        findings += [f"{name}:{number}: a sentence of {words} words, more than {LONGEST}: {beginning} ..."
                     for number, words, beginning in found if words > LONGEST]
        mean = sum(words for _, words, _ in found) / max(1, len(found))
        if mean > WORDS_PER_SENTENCE:
            findings.append(f"{name}: {mean:.1f} words a sentence on average, more than {WORDS_PER_SENTENCE}")
        all_words, all_sentences = all_words + sum(words for _, words, _ in found), all_sentences + len(found)
    if all_words < FEWEST_PER_SENTENCE * all_sentences:
        findings.append(f"all pages: {all_words / all_sentences:.1f} words a sentence on average, fewer than {FEWEST_PER_SENTENCE}")
    return findings


def report(root):
    lines = ["page,words,sentences,mean,longest"]
    for path in pages_of(root):
        counts = [words for _, words, _ in sentences(path.read_text())]
        lines.append(f"{path.relative_to(root)},{sum(counts)},{len(counts)},{sum(counts) / max(1, len(counts)):.1f},{max(counts, default=0)}")
    return lines


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    lines = report(root) if sys.argv[2:] == ["--report"] else check(root)
    print("\n".join(lines))
    sys.exit(bool(lines) and sys.argv[2:] != ["--report"])
