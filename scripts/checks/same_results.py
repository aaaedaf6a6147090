#!/usr/bin/env python3
"""Proves that a renaming changed no value: runs two builds of knotdock on the same cases and compares all results.

    python3 scripts/checks/same_results.py --before OLD --after NEW --pairs DIR [--keep DIR] [--only NAMES] [--time]

DIR of --pairs has a folder for each pair with receptor_unbound.pdb.gz, ligand_unbound.pdb.gz, and the same two with
"bound". Run the script in the repository, or name its examples by --examples. With --keep the results of OLD are kept,
and used again while OLD and the commands of a case stay the same; the results of NEW lie beside them.

Values are compared as text, to the last digit: tables by row and column, JSON by key, other files by line.
same_results_cases.py has the cases, and tables that map the names. Where NEW does not have a new name yet, the old
one stands: the script also serves between two renamings, and with one binary on both sides. Where a table has
`pose_score`, `score` must be the old `cluster_score`, with --no-cluster the old `rank_score`. The new `score` in
results.csv of a batch, which had no `cluster_score`, is not checked. Sentences and remarks may be reworded: of these
only numbers and single capital letters (chains) are compared.

Exit code: 0 all equal, 1 differences, 2 wrong use or a case that OLD cannot run. Needs Python 3.9 and nothing else.
"""

import argparse
import csv
import functools
import hashlib
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from same_results_cases import (
    ADDED_COLUMNS,
    ADDED_KEYS,
    CASES,
    COLUMNS,
    COMMANDS,
    DIAGNOSTICS,
    KEYS,
    NOT_COMPARED,
    OPTIONS,
    SENTENCES,
    VALUES,
    write_meshes,
)

# Running


@functools.cache
def options_of(binary, command):
    """Options that the help of a command names; None if the program has no such command."""
    done = subprocess.run([binary, command, "--help"], capture_output=True, text=True)
    return set(re.findall(r"--[a-z][a-z-]*", done.stdout)) if done.returncode == 0 else None


def new_words(binary, words, plain):
    """A command line in the new names, as far as the program has them."""
    command = COMMANDS.get(words[0])
    command = command if command and options_of(binary, command) else words[0]
    options = options_of(binary, command) or set()
    if command == "batch":
        options = options | options_of(binary, "dock")
    words = [OPTIONS.get(word) if OPTIONS.get(word) in options else word for word in words[1:]]
    table = command in ("dock", "batch") and "--diagnostics" in options and not plain and "--rerun" not in words
    return [command, *words, *(["--diagnostics"] if table else [])]


def run_case(binary, case, folder, places, new):
    """Runs the commands of a case in an empty folder. Gives processor seconds of each, and what a failed one said."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    if any("block.obj" in command for command in case.commands):
        write_meshes(folder)
    seconds = []
    for number, line in enumerate(case.commands, 1):
        words = shlex.split(line)
        name = f"{number}_{words[0]}.json"
        if new:
            words = new_words(binary, words, case.plain)
        words = [word.format(**places) for word in words]
        with open(folder / name, "wb") as output, tempfile.TemporaryFile() as talk:
            words.insert(1, "--json")
            process = subprocess.Popen([binary, *words], cwd=folder, stdout=output, stderr=talk)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            seconds.append(usage.ru_utime + usage.ru_stime)
            if process.returncode != 0:
                talk.seek(0)
                said = (folder / name).read_text() + talk.read().decode(errors="replace")
                return seconds, f"{shlex.join(words)}: exit code {process.returncode}: {said.strip()[-500:]}"
    return seconds, None


# Comparing


class Report:
    """Differences, printed as they are found (ten of each file), and notes for the end."""

    def __init__(self):
        self.count, self.files, self.notes = 0, Counter(), Counter()

    def differ(self, case, file, where, before, after):
        self.count += 1
        self.files[case.name, file] += 1
        if self.files[case.name, file] <= 10:
            print(f"DIFFERENT {case.name}, {file}, {where}: before {before}, after {after}", flush=True)

    def print_rest(self):
        for (case, file), count in self.files.items():
            if count > 10:
                print(f"{case}, {file}: {count} differences in all")
        for note, count in self.notes.items():
            print(f"note: {note} ({count} times)")


def expected_row(row, columns, case, report):
    """An old row in new names: what a table of the new `columns` must hold."""
    expected = {}
    is_new = "pose_score" in columns and "rank_score" in row
    for old, value in row.items():
        name = COLUMNS.get(old, old)
        if name not in columns and old in columns and not (old == "score" and is_new):
            report.notes[f"column {old} has its old name"] += 1
            name = old
        if name in columns:
            expected[name] = value
        elif name is None or case.plain and name in DIAGNOSTICS or name == "cluster_score" and case.clustered:
            continue
        elif value == "":
            report.notes[f"column {old} was empty and is gone"] += 1
        else:
            expected[name] = value
    if is_new and "cluster_score" in row:
        expected["score"] = row["cluster_score" if case.clustered else "rank_score"]
    return expected


def compare_rows(old, new, file, case, report):
    """Compares rows of a table: dictionaries from column to text."""
    if len(old) != len(new):
        report.differ(case, file, "number of rows", len(old), len(new))
    columns, known = set(new[0]) if new else set(), ADDED_COLUMNS | {"score"}
    for number, (row, found) in enumerate(zip(old, new), 1):
        expected = expected_row(row, columns, case, report)
        known |= set(expected)
        for column, value in expected.items():
            other = found.get(column, "no such column")
            if other not in (value, VALUES.get(value, value)):
                report.differ(case, file, f"row {number}, column {column}", value, other)
    for column in sorted(columns - known):
        report.differ(case, file, f"column {column}", "no such column", "present")


def compare_tables(before, after, file, case, report):
    with open(before, newline="") as old, open(after, newline="") as new:
        compare_rows(list(csv.DictReader(old)), list(csv.DictReader(new)), file, case, report)


class Number(str):
    """A number as a JSON file has it."""


def take_rows(value):
    """Takes rows of poses (`best` of a run, and of each pair of a batch) out of a JSON document."""
    if isinstance(value, list):
        return [row for entry in value for row in take_rows(entry)]
    if not isinstance(value, dict):
        return []
    best = value.pop("best", None) or []
    rows = [{name: "" if entry is None else str(entry) for name, entry in row.items()}
            for row in (best if isinstance(best, list) else [best])]  # fmt: skip
    return rows + take_rows(list(value.values()))


def flatten(value, path=""):
    """Path and text of each value in a JSON document; a list of plain values counts as one."""
    if isinstance(value, dict) and value:
        for key, entry in value.items():
            yield from flatten(entry, f"{path}.{key}" if path else key)
    elif isinstance(value, list) and any(isinstance(entry, (dict, list)) for entry in value):
        for index, entry in enumerate(value):
            yield from flatten(entry, f"{path}[{index}]")
    else:
        yield path, value if isinstance(value, Number) else json.dumps(value, ensure_ascii=False)


def renamed(path, names):
    """The path with its keys replaced, the longest match first; "" where one of them was dropped."""
    if not names:
        return path
    pattern = "|".join(map(re.escape, sorted(names, key=len, reverse=True)))
    parts = re.compile(rf"(?<![^.])(?:{pattern})(?![^.\[])")
    if any(names[key] is None for key in parts.findall(path)):
        return ""
    return parts.sub(lambda key: names[key[0]], path)


def new_path(path, new):
    """Where a value of the old document stands in the new one: "" if it was dropped, None if it is missing."""
    keys = {old[2:].replace("-", "_"): name[2:].replace("-", "_") for old, name in OPTIONS.items()} | KEYS
    candidates = [renamed(path, COLUMNS | keys), renamed(path, keys), path]
    for candidate in candidates:
        if candidate in new:
            return candidate
    if "" in candidates:
        return ""
    for candidate in candidates:
        group, options, name = candidate.rpartition("options.")
        moved = [other for other in new if other.startswith(group + options) and other.endswith("." + name)]
        if options and len(moved) == 1:
            return moved[0]
    return None


def compare_json(before, after, file, case, report):
    read = functools.partial(json.loads, parse_float=Number, parse_int=Number)
    old, new = read(before.read_text()), read(after.read_text())
    compare_rows(take_rows(old), take_rows(new), file, case, report)
    old, new = dict(flatten(old)), dict(flatten(new))
    known = set()
    for path, value in old.items():
        place = new_path(path, new)
        known.add(place)
        if place == "" or NOT_COMPARED.fullmatch(path):
            continue
        other = new.get(place, "no such key")
        if other in (value, json.dumps(VALUES.get(value[1:-1], value[1:-1]))):
            continue
        if SENTENCES.fullmatch(path) and place and figures(value) == figures(other):
            report.notes[f"reworded: {value} is {other}"] += 1
        else:
            report.differ(case, file, f"key {path}", value, other)
    for path in sorted(set(new) - known):
        if not NOT_COMPARED.fullmatch(path) and not ADDED_KEYS & set(re.split(r"[.\[\]]", path)):
            report.differ(case, file, f"key {path}", "no such key", new[path])


def figures(text):
    """Numbers and single capital letters of a sentence, without paths and the program's version."""
    return re.findall(r"-?\d+(?:\.\d+)?(?:e-?\d+)?|\b[A-Z]\b", re.sub(r"knotdock \d+\.\S*|\S*/\S*", "", text))


def split_remarks(path):
    """Lines of a structure or mesh, and its remarks: REMARK 99 of PDB, texts of mmCIF, comments of OBJ."""
    lines, remarks, in_text = [], [], False
    for line in path.read_text().splitlines():
        in_text ^= line.startswith(";")
        (remarks if in_text or re.match(r"REMARK +99|#|;", line) else lines).append(line)
    return lines, remarks


def compare_lines(before, after, file, case, report):
    """Compares structures and meshes line by line, of remarks (rank, motion, chains) only the figures."""
    (old, old_remarks), (new, new_remarks) = split_remarks(before), split_remarks(after)
    one, other = (figures(" ".join(remarks)) for remarks in (old_remarks, new_remarks))
    if one != other:
        report.differ(case, file, "figures of remarks", one, other)
    elif old_remarks != new_remarks:
        report.notes["remarks reworded, or of another version"] += 1
    if len(old) != len(new):
        report.differ(case, file, "number of lines", len(old), len(new))
    for number, (one, other) in enumerate(zip(old, new), 1):
        if one != other:
            report.differ(case, file, f"line {number} without remarks", repr(one), repr(other))


def compare_case(before, after, case, report):
    """Compares all files of a case; those that only one side has are differences."""
    files = [{str(path.relative_to(side)) for path in side.rglob("*") if path.is_file()} for side in (before, after)]
    for file in sorted(files[0] ^ files[1]):
        report.differ(case, file, "file", *("present" if file in side else "missing" for side in files))
    compare = {".csv": compare_tables, ".json": compare_json}
    for file in sorted(files[0] & files[1]):
        compare.get(Path(file).suffix, compare_lines)(before / file, after / file, file, case, report)
    return len(files[0] & files[1])


def time_cases(cases, options, places, folder):
    """Runs all cases three times with both programs in turn, and prints least processor seconds of each docking."""
    sums = [0.0, 0.0]
    for case in cases:
        docks = [index for index, command in enumerate(case.commands) if command.startswith("dock ")]
        if not docks:
            continue
        runs = [[], []]
        for _ in range(3):
            for side, binary in enumerate((options.before, options.after)):
                runs[side].append(run_case(binary, case, folder, places, side == 1)[0])
        for index in docks:
            if not all(len(run) > index for side in runs for run in side):
                continue
            least = [min(run[index] for run in side) for side in runs]
            sums = [total + value for total, value in zip(sums, least)]
            print(f"{case.name} {index + 1}: before {least[0]:.2f} s, after {least[1]:.2f} s", flush=True)
    print(f"all dockings: before {sums[0]:.2f} s, after {sums[1]:.2f} s, ratio {sums[1] / max(sums[0], 1e-9):.4f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--before", required=True, help="knotdock before the change")
    parser.add_argument("--after", required=True, help="knotdock after it")
    parser.add_argument("--pairs", required=True, type=Path, help="folder of benchmark pairs")
    parser.add_argument("--examples", type=Path, default=Path("structures/examples"), help="default: %(default)s")
    parser.add_argument("--keep", type=Path, help="folder for all results; those of --before are used again")
    parser.add_argument("--only", help="cases to run, with commas between them")
    parser.add_argument("--time", action="store_true", help="measure processor time too, three runs each in turn")
    options = parser.parse_args()
    places = {"pairs": options.pairs.resolve(), "examples": options.examples.resolve()}
    names = options.only.split(",") if options.only else [case.name for case in CASES]
    if unknown := set(names) - {case.name for case in CASES}:
        parser.error(f"no such case: {', '.join(sorted(unknown))}; there are {', '.join(case.name for case in CASES)}")
    for side in ("before", "after"):
        found = shutil.which(getattr(options, side))
        if not found:
            parser.error(f"--{side}: {getattr(options, side)} is no program")
        setattr(options, side, str(Path(found).resolve()))
    cases = [case for case in CASES if case.name in names]
    sha256 = hashlib.sha256(Path(options.before).read_bytes()).hexdigest()
    report = Report()
    with tempfile.TemporaryDirectory() as scratch:
        root = (options.keep or Path(scratch)).resolve()
        for case in cases:
            before, after = root / "before" / case.name, root / "after" / case.name
            done = {"sha256": sha256, "commands": case.commands}
            mark = before.with_suffix(".json")  # written last, with what the results came from
            old_seconds = None
            if not mark.exists() or json.loads(mark.read_text()) != done:
                seconds, error = run_case(options.before, case, before, places, False)
                if error:
                    print(f"{case.name}: the program before the change failed: {error}", file=sys.stderr)
                    sys.exit(2)
                mark.write_text(json.dumps(done))
                old_seconds = sum(seconds)
            seconds, error = run_case(options.after, case, after, places, True)
            if error:
                report.differ(case, "command", "exit code", 0, error)
                continue
            count = report.count
            files = compare_case(before, after, case, report)
            took = "kept" if old_seconds is None else f"{old_seconds:.1f} s"
            verdict = "equal" if report.count == count else f"{report.count - count} differences"
            print(f"{case.name}: {files} files, {verdict}; CPU before {took}, after {sum(seconds):.1f} s", flush=True)
        if options.time:
            time_cases(cases, options, places, Path(scratch) / "timed")
    report.print_rest()
    print(f"{len(cases)} cases, {report.count or 'no'} differences")
    sys.exit(1 if report.count else 0)


if __name__ == "__main__":
    main()
