# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads the cases of cases.csv. make uses only the numbers of cases, so that no name and no setting reaches a shell.
The script does not import numpy, because make runs it often.

    cases.py numbers                   checks the table and prints the numbers of the cases: 1 2 3 ...
    cases.py names [CASE...]           prints the names of the given cases (names or numbers), or of all, one per line
    cases.py run NUMBER COMMAND...     runs the command with the settings of this case as further options
"""
import csv
import inspect
import os
import sys


def stop(message, code=1):
    """Ends the script with one line on stderr."""
    print(f"{os.path.basename(sys.argv[0])}: {message}", file=sys.stderr)
    sys.exit(code)


def commands(*functions):
    """Calls the function that the first word of the command line names (- for _), with the other words as arguments."""
    known = {function.__name__.replace("_", "-"): function for function in functions}
    name, *words = sys.argv[1:] or [""]
    if name not in known:
        stop(f"found command '{name}', expected one of: {' '.join(known)}", 64)
    try:
        inspect.signature(known[name]).bind(*words)
    except TypeError as error:
        stop(f"{name}: {error}, expected {name} {' '.join(inspect.signature(known[name]).parameters)}", 64)
    known[name](*words)


def sets(settings):
    """Returns options --set KEY=VALUE for a mapping of settings."""
    return [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]


def execute(command, settings):
    """Replaces this process by a command, with settings as its last options."""
    try:
        os.execv(command[0], [*command, *sets(settings)])
    except (OSError, ValueError) as error:
        stop(f"{command[0]}: found '{error}', expected a program that takes the settings of a case")


class Case:
    """A case, from a line of cases.csv: number (from 1), name, settings of the scene (key to text), title for pictures,
    and published values."""

    def __init__(self, number, record):
        given = {key: text for key, text in record.items() if text}
        self.number = number
        self.published = {key[len("published_"):]: text for key, text in given.items() if key.startswith("published_")}
        self.settings = {key: text for key, text in given.items()
                         if key not in ("name", "title") and not key.startswith("published_")}
        short = [(key.split(".")[-1], text) for key, text in self.settings.items()]
        self.name = _shown(given.get("name") or "-".join(key + text for key, text in short))
        self.title = _shown(given.get("title") or ", ".join(f"{key} = {text}" for key, text in short))

    @property
    def label(self):
        """The title for matplotlib, with each $ escaped: matplotlib would take a text between two $ as a formula."""
        return self.title.replace("$", r"\$")

    @property
    def options(self):
        return sets(self.settings)

    def file(self, folder, kind):
        """Returns the name of the result file; kind is `full` or the name of a model."""
        return f"{folder}/{kind}/{self.number}.h5"


def _shown(text):
    """Returns the text with all control characters and line breaks replaced."""
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in text)


def _without_comments(lines):
    """Yields the lines of a CSV file without blank lines and comments. Lines inside of quotes are kept."""
    quoted = False
    for line in lines:
        if quoted or (line.strip() and not line.lstrip().startswith("#")):
            quoted ^= line.count('"') % 2 == 1
            yield line


def _separator(header):
    """Returns a comma if the header has one outside of quotes, else a semicolon or a tab (as the programs do)."""
    unquoted = "".join(header.split('"')[::2])
    return next((mark for mark in ",;\t" if mark in unquoted), ",")


def read_cases(file="cases.csv"):
    """Returns the cases of a CSV file. The header contains settings of the scene (any keys, such as physical.load);
    each further line is a case. Commas, semicolons or tabs separate the fields. An empty field keeps the setting of the
    scene. The column `name` is optional. The columns `title` and `published_...` are not settings. Empty lines and
    lines that begin with # are skipped."""
    try:
        with open(file, newline="", encoding="utf-8-sig") as source:
            lines = list(_without_comments(source))
            header, *records = [[text.strip() for text in record] for record in
                                csv.reader(lines, strict=True, delimiter=_separator((lines or [""])[0]))] or [[]]
    except (OSError, ValueError, csv.Error) as error:
        stop(f"{file}: found '{getattr(error, 'strerror', None) or error}', expected a table of cases")
    for number, record in enumerate(records, 1):
        if any(record[len(header):]):
            stop(f"{file}: case {number}: found {len(record)} fields, expected the {len(header)} of the header")
    for key in header:
        if header.count(key) > 1 and key:
            stop(f"{file}: found two columns '{_shown(key)}', expected one")
    return [Case(number, dict(zip(header, record))) for number, record in enumerate(records, 1)]


def find_cases(wanted, file="cases.csv"):
    """Returns the cases with these names, in the order of the file. If no case has a name, it is taken as a number."""
    known = read_cases(file)
    names = {case.name for case in known}
    for word in wanted:
        if word not in names and word not in {str(case.number) for case in known}:
            stop(f"{file}: found no case '{word}', expected one of: {', '.join(case.name for case in known)}")
    return [case for case in known if case.name in wanted or (str(case.number) in {*wanted} - names)]


def numbers():
    known = read_cases()
    if not known:
        stop("cases.csv: found no cases, expected a line each below the header")
    print(*(case.number for case in known))


def names(*wanted):
    for case in find_cases(wanted) if wanted else read_cases():
        print(case.name)


def run(number, *command):
    execute(command, read_cases()[int(number) - 1].settings)


if __name__ == "__main__":
    commands(numbers, names, run)
