#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fails on a link of a Markdown file, or a README and its section named in a comment, that leads nowhere.

    tests/links.py [FOLDER]

Links are checked that are relative: the file has to be there, and the heading of an anchor. A comment names
a README as "room/README.md, Section": by its path from the root, or without a path the one beside the source;
the section is the beginning of a heading, or of a paragraph's lead in bold or italics.
"""
import os
import re
import sys

PASSED_OVER = {".git", "build", "out", "__pycache__"}
SOURCES = (".c", ".h", ".py", ".sh", ".bash", ".awk", ".mk", ".yml", "Makefile")
LINK = re.compile(r"\]\(([^()\s]+)\)")
NAMED = re.compile(r"((?:[\w.-]+/)*README\.md)(?:, ([A-Z][^;:().\n]*))?")
LEAD = re.compile(r"^(?:[-|] )?\*{1,2}([^*]+)\*{1,2}", re.MULTILINE)
problems = []


def files_below(root):
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(f for f in folders if f not in PASSED_OVER and not f.startswith("out-"))
        yield from (os.path.join(folder, name) for name in sorted(names))


def read(path):
    with open(path, encoding="utf-8", errors="replace") as file:
        return file.read()


def without_code(text):
    """Blocks and spans of code become blanks, so that lines keep their numbers."""
    text = re.sub(r"^```.*?^```", lambda block: re.sub(r"[^\n]", " ", block[0]), text, flags=re.S | re.M)
    text = re.sub(r"^( {4}|\t).*$", "", text, flags=re.M)
    return re.sub(r"`[^`\n]*`", "", text)


def headings(path):
    text = re.sub(r"^```.*?^```", "", read(path), flags=re.S | re.M)
    return re.findall(r"^#+ +(.*?) *$", text, flags=re.M)


def anchors(path):
    """What GitHub makes of headings: no punctuation, hyphens for spaces, -1 … where one comes again."""
    seen = {}
    for heading in headings(path):
        heading = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading)
        name = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        count = seen[name] = seen.get(name, -1) + 1
        yield f"{name}-{count}" if count else name


def complain(path, text, position, found, expected):
    line = text.count("\n", 0, position) + 1
    problems.append(f"{os.path.relpath(path, root)}:{line}: found {found}, expected {expected}")


def check_links(path):
    text = without_code(read(path))
    for link in LINK.finditer(text):
        target, _, anchor = link[1].partition("#")
        if re.match(r"[a-z]+:", target):
            continue
        other = os.path.normpath(os.path.join(os.path.dirname(path), target)) if target else path
        if not os.path.exists(other):
            complain(path, text, link.start(), link[1], "a file or folder")
        elif anchor and (not other.endswith(".md") or anchor not in anchors(other)):
            complain(path, text, link.start(), link[1], "a heading of that name")


def check_comments(path):
    # a comment goes on in the next line behind its mark
    text = re.sub(r"\n[ \t]*(\*|//|#)(?!/) ?", lambda mark: "\f" + " " * (len(mark[0]) - 1), read(path))
    for named in NAMED.finditer(text):
        if text[named.start() - 1] in "\"'`$/}":  # a path that a script makes
            continue
        other = os.path.join(root if "/" in named[1] else os.path.dirname(path), named[1])
        section = re.sub(r"\s+", " ", named[2] or "").strip()
        lines = text.replace("\f", "\n")
        if not os.path.exists(other):
            other = os.path.join(os.path.dirname(path), named[1])  # a relative path
        if not os.path.exists(other):
            complain(path, lines, named.start(), named[1], "a file")
        elif section and not any(title.lower().startswith(section.lower())
                                 for title in headings(other) + LEAD.findall(read(other))):
            complain(path, lines, named.start(), f"{named[1]}, {section}", "a section of that name")


root = sys.argv[1] if len(sys.argv) > 1 else "."
for name in files_below(root):
    if name.endswith(".md"):
        check_links(name)
    elif name.endswith(SOURCES):
        check_comments(name)
print(*problems, sep="\n", end="\n" if problems else "")
sys.exit(bool(problems))
