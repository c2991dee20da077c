# SPDX-License-Identifier: GPL-3.0-or-later
"""The cases of cases.csv. Make knows their numbers only; names and settings never reach a shell. Without numpy, since make
runs this often.

    cases.py numbers                   1 2 3 ..., after a check of the table
    cases.py names [CASE...]           a line each, of these (names or numbers) or of all
    cases.py run NUMBER COMMAND...     the command with the settings of that case as options behind it
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
    """Calls the function that the first word of the command line names (- for _) with the other words."""
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
    """Options --set KEY=VALUE for a mapping of settings."""
    return [word for key, value in settings.items() for word in ("--set", f"{key}={value}")]


def execute(command, settings):
    """Replaces this process by a command, with settings as its last options."""
    try:
        os.execv(command[0], [*command, *sets(settings)])
    except (OSError, ValueError) as error:
        stop(f"{command[0]}: found '{error}', expected a program that takes the settings of a case")


class Case:
    """A line of cases.csv: number (from 1), name, settings (of the scene, key to text), title for a picture, and what was
    published."""

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
        """The title for matplotlib, which takes what stands between two $ for a formula."""
        return self.title.replace("$", r"\$")

    @property
    def options(self):
        return sets(self.settings)

    def file(self, folder, kind):
        """Its result: kind is full, or the name of a model."""
        return f"{folder}/{kind}/{self.number}.h5"


def _shown(text):
    """A text on one line, without control characters."""
    return "".join(letter if letter.isprintable() else "\N{REPLACEMENT CHARACTER}" for letter in text)


def _without_comments(lines):
    """The lines of a CSV file, without blank lines and comments. Lines within quotes stay."""
    quoted = False
    for line in lines:
        if quoted or (line.strip() and not line.lstrip().startswith("#")):
            quoted ^= line.count('"') % 2 == 1
            yield line


def _separator(header):
    """Returns a comma if the header has one outside of quotes, else a semicolon or a tab. The programs have the same rule."""
    unquoted = "".join(header.split('"')[::2])
    return next((mark for mark in ",;\t" if mark in unquoted), ",")


def read_cases(file="cases.csv"):
    """Cases of a CSV file: a line each under a header of settings of the scene (any keys, such as physical.load), with
    commas, semicolons or tabs between them. An empty field leaves what the scene says; the column `name`, which there
    need not be, names the cases; columns title and published_... are no settings; lines that begin with # and empty ones
    are left out."""
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
    """Finds cases by name or, if no case has that name, by number; in the order of the file."""
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
