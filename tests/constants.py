#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Prints docs/constants.md: the named numbers that decide how the programs compute, with their reasons.

    tests/constants.py [FOLDER]

Fails if a number has no reason, or if a reason names a test, a benchmark, a study or a page that does not exist.
The page itself states what counts as such a number and as a reason.
"""
import os
import re
import sys

# common/program and common/artefact compute nothing.
ROOMS = ("common/algebra", "common/physics", "common/settings", "common/time", "common/output", "common/training",
         "fullrun", "romrun", "podbuild", "deimselect", "snapgen")
PAGE = """\
# Constants

`make constants` prints this page. It lists the named numbers in the sources that decide how the programs compute:
tolerances, thresholds, factors, limits of iterations. The reason of a number is its comment. It stands behind the
number, above it, or in the header that declares the number. Numbers without a blank line between them share the comment
above. The comment gives the meaning, the unit, and the measurement or argument that chose the number. It names at least
one of

- a unit test, as `test_march.c, kinks_are_hit_exactly`,
- a pipeline test, as `fmu.bats, "name"`, by the beginning of its name or all of it,
- a benchmark, as `bench_gmres.c`,
- a study or an example, as `scenes/studies/parts`,
- a page with its section: the README of a folder, or one of `schemas/`.

`make check` fails if one of them does not exist, if a number has no reason, or if this page is out of date.

The page lists

- `const double`, `const size_t` and similar constants that are set to a number, and `#define` of a number,
- `enum` constants whose comment names a test, a benchmark, a study or a page. C needs an `enum` for the length of an array.

The page does not list

- other `enum` constants: positions, lengths of texts and arrays, portions of work and memory,
- numbers from a publication or a norm, or of mathematics: their comment begins with `Source:`,
- bounds of the content of a file or a scene: their comment begins with `Bounds of`,
- 0 and 1 in functions, where a variable is needed for its address, and -1 as a mark.
"""

NUMBER = r"[-+]?(?:0[xX][0-9a-fA-F.]+(?:p[-+]?\d+)?|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)[uULlf]*"
VALUE = re.compile(rf"(?:{NUMBER}|DBL_EPSILON)(?: (?:[-+*/]|<<) (?:{NUMBER}|DBL_EPSILON))*")
CONST = re.compile(r"^ *(?:static )?const (?:double|float|int|long|unsigned|size_t|u?int\d+_t) (?=\w)")
DEFINE = re.compile(r"^#define +(\w+) +(\S+)")
ENUM = re.compile(r"^ *enum \{")
DECLARED = re.compile(r"(\w+) = ((?:[^,()]|\([^()]*\))*)")
MEMBER = re.compile(r"(\w+) = ([^,}]+)")
BEHIND = re.compile(r" {8,}//")

UNIT_TEST = re.compile(r"\b((?:test|long)_\w+\.c), (\w+)")
PIPELINE = re.compile(r"\b(\w+\.bats), \"([^\"]+)\"")
OTHER = re.compile(r"\b(bench_\w+\.c|scenes/(?:studies|examples)/[\w-]+|(?:[\w.-]+/)*\w+\.md)")


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def sources(root):
    for room in ROOMS:
        for folder, folders, names in os.walk(os.path.join(root, room)):
            folders.sort()
            for name in sorted(names):
                path = os.path.join(folder, name)
                if name.endswith((".c", ".h")) and not os.path.islink(path):
                    yield os.path.relpath(path, root)


def behind(lines, i):
    """Returns the comment behind line i, with the lines below that continue it."""
    text = lines[i].partition("//")[2]
    while text and i + 1 < len(lines) and BEHIND.match(lines[i + 1]):
        i += 1
        text += " " + lines[i].partition("//")[2]
    return text


def above(lines, i):
    """Returns the comment above line i, past other numbers without a blank line between them."""
    i -= 1
    while i >= 0 and any(kind.match(lines[i]) for kind in (CONST, ENUM, DEFINE, BEHIND)):
        i -= 1
    end = i + 1
    if i >= 0 and lines[i].rstrip().endswith("*/"):
        while i > 0 and "/*" not in lines[i]:
            i -= 1
        return " ".join(re.sub(r"^\s*(/\*+|\*(?!/))|\*/\s*$", "", line) for line in lines[i:end])
    while i >= 0 and re.match(r"\s*//", lines[i]):
        i -= 1
    return " ".join(line.partition("//")[2] for line in lines[i + 1:end])


def comment_at(lines, first, own):
    """Returns the comment above the declaration that begins at line `first`, and the one behind line `own`."""
    return re.sub(r"\s+", " ", above(lines, first) + " " + behind(lines, own)).strip()


def names_evidence(reason):
    return UNIT_TEST.search(reason) or PIPELINE.search(reason) or OTHER.search(reason)


def in_statement(lines, i, end, pattern):
    """Yields name, value and line of what matches in the statement from line i up to `end`."""
    code, starts = "", []
    while i < len(lines) and end not in code:
        starts.append((len(code), i))
        code += lines[i].partition("//")[0] + " "
        i += 1
    for found in pattern.finditer(code.partition(end)[0]):
        yield found[1], found[2].strip(), max(line for start, line in starts if start <= found.start())


def numbers(lines, declared):
    """Yields name, value and comment of each number. `declared`: comments of names in headers."""
    for i, line in enumerate(lines):
        define = DEFINE.match(line)
        if CONST.match(line):
            for name, value, own in in_statement(lines, i, ";", DECLARED):
                marks = ("0", "1", "-1") if line.startswith(" ") else ("-1",)
                if VALUE.fullmatch(value) and value not in marks:
                    yield name, value, comment_at(lines, i, own) or declared.get(name, "")
        elif define and re.fullmatch(NUMBER, define[2].strip("()")) and "VERSION" not in define[1]:
            yield define[1], define[2], comment_at(lines, i, i)
        elif ENUM.match(line):
            for name, value, own in in_statement(lines, i, "}", MEMBER):
                reason = comment_at(lines, i, own)
                if VALUE.fullmatch(value) and names_evidence(reason):
                    yield name, value, reason


def declarations(root):
    """Returns the comments of numbers that headers declare, by name."""
    found = {}
    for path in sources(root):
        lines = read(os.path.join(root, path)).split("\n")
        for i, line in enumerate(lines):
            names = re.match(r"extern const \w+ ([\w, ]+);", line)
            for name in names[1].split(", ") if names else ():
                found[name] = comment_at(lines, i, i)
    return found


def missing(root, path, reason):
    """Returns what a reason lacks; None: nothing."""
    if not names_evidence(reason):
        return "no test, benchmark, study or page"
    for name, function in UNIT_TEST.findall(reason):
        file = os.path.join(root, "tests/unit", name)
        if not os.path.exists(file) or not re.search(rf"\b{function}\b", read(file)):
            return f"{name}, {function}"
    for name, title in PIPELINE.findall(reason):
        files = [os.path.join(root, "tests", folder, name) for folder in ("pipeline", "fault")]
        if not any(os.path.exists(f) and re.search(f'^@test "{re.escape(title)}', read(f), re.M) for f in files):
            return f'{name}, "{title}"'
    for name in OTHER.findall(reason):
        places = (name, os.path.join(os.path.dirname(path), name), os.path.join("tests/bench", name))
        if not any(os.path.exists(os.path.join(root, place)) for place in places):
            return name
    return None


def main():
    root = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
    declared = declarations(root)
    count, without, folder, printed = 0, 0, None, None
    print(PAGE, end="")
    for path in sources(root):
        for name, value, reason in numbers(read(os.path.join(root, path)).split("\n"), declared):
            if reason.startswith(("Source:", "Bounds of")):
                continue
            count += 1
            if os.path.dirname(path) != folder:
                folder = os.path.dirname(path)
                print(f"\n## {folder}\n\n| name | value | file | reason |\n|---|---|---|---|")
            text = "as above" if (path, reason) == printed else reason.replace("|", chr(92) + "|")
            printed = path, reason
            print(f"| `{name}` | {value} | `{os.path.basename(path)}` | {text} |")
            lacking = missing(root, path, reason)
            if lacking:
                print(f"{path}: {name}: found {lacking}, expected a reason that exists", file=sys.stderr)
                without += 1
    print(f"\n{count} constants.")
    sys.exit(without > 0)


main()
