#!/usr/bin/env python3
"""Runs two builds of knotdock on the same cases (same_results_cases.py) and compares every value of their results.

    python3 scripts/checks/same_results.py --before OLD --after NEW --pairs DIR
    python3 scripts/checks/same_results.py --before OLD --after NEW --pairs DIR --ignore row --ignore '*/shard.json'

DIR has a folder for each pair with receptor_unbound.pdb.gz, ligand_unbound.pdb.gz, and the same two with "bound".

Values are compared as text, to the last digit: tables by column and row, JSON by key, other files by line. A file, key
or column that one side lacks is a difference. Times, memory, machine, version and commit are left out, and so is
a checksum if it is that of one file on both sides, which is compared itself. Messages are not compared.

Exit code: 0 all equal, 1 differences, 2 wrong use or a case that OLD cannot run. Needs Python 3.9 and nothing else.
"""

import argparse
import csv
import gzip
import hashlib
import io
import json
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
from fnmatch import fnmatchcase
from pathlib import Path

from same_results_cases import CASES, write_inputs

NOT_COMPARED = ["timing", "machine", "version", "commit", "knotdock", "*seconds*", "*bytes*"]  # keys and columns
# Of a line: version and commit; of a report also times in seconds and milliseconds, memory, and its own checksum.
NOT_IN_LINES = re.compile(
    r"knotdock \d+\.\d+\.\d+( \(\w+\))?|(<td>\d+\.\d\d</td>){1,2}</tr>|at most \d+ MB of memory|sha256 of all above.*"
)


def run_case(binary, commands, folder, places):
    """Runs commands in an empty folder. Returns processor seconds, and the error of a command that failed."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    start = resource.getrusage(resource.RUSAGE_CHILDREN)
    for number, command in enumerate(commands, 1):
        words = [word.format(**places) for word in shlex.split(command)]
        done = subprocess.run(["knotdock", "--json", *words], executable=binary, cwd=folder, capture_output=True)
        (folder / f"{number}_{words[0]}.json").write_bytes(done.stdout)
        if done.returncode != 0:
            printed = (done.stdout + done.stderr).decode(errors="replace").strip()
            return 0.0, f"{command}: exit code {done.returncode}: {printed[-500:]}"
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return end.ru_utime + end.ru_stime - start.ru_utime - start.ru_stime, None


def sha256(path):
    """Checksum of a file."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def read(path):
    """A JSON document with its numbers as text, the columns of a table, or lines."""
    data = path.read_bytes()
    text = (gzip.decompress(data) if path.suffix == ".gz" else data).decode(errors="surrogateescape")
    name = path.name.removesuffix(".gz")
    if name.endswith(".json"):
        return json.loads(text, parse_float=str, parse_int=str)
    if name.endswith(".csv"):
        table = csv.DictReader(io.StringIO(text, newline=""))
        rows = list(table)
        return {column: [row[column] for row in rows] for column in table.fieldnames or []}
    return [NOT_IN_LINES.sub("", line).rstrip() for line in text.splitlines()]


def presence(name, sides):
    """For each of the sides, whether it has the name."""
    return tuple("present" if name in side else "missing" for side in sides)


def differences(before, after, ignored, place=""):
    """Yields place and both values of each difference; `ignored` decides by the name of a key."""
    if isinstance(before, dict) and isinstance(after, dict):
        for key in filter(lambda key: not ignored(key), before | after):
            where = f"{place}.{key}" if place else key
            if key in before and key in after:
                yield from differences(before[key], after[key], ignored, where)
            else:
                yield where, *presence(key, (before, after))
    elif isinstance(before, list) and isinstance(after, list):
        if len(before) != len(after):
            yield f"length of {place or 'the file'}", len(before), len(after)
        for number, values in enumerate(zip(before, after), 1):
            yield from differences(*values, ignored, f"{place}[{number}]")
    elif before != after:
        yield place, before, after


def compare_case(before, after, ignored):
    """Compares two folders and prints up to ten differences of each file. Returns how many files and differences."""
    sides = [{str(path.relative_to(side)) for path in side.rglob("*") if path.is_file()} for side in (before, after)]
    both = sides[0] & sides[1]
    files = sorted(file for file in sides[0] | sides[1] if not ignored(f"{before.name}/{file}"))
    checksums = [tuple(sha256(side / file) for side in (before, after)) for file in both]
    count = 0
    for file in files:
        if file in both:
            found = list(differences(read(before / file), read(after / file), ignored))
            found = [entry for entry in found if entry[1:] not in checksums]
        else:
            found = [("the file", *presence(file, sides))]
        for place, *values in found[:10]:
            one, other = (repr(value)[:200] for value in values)
            print(f"DIFFERENT {before.name}/{file}, {place}: before {one}, after {other}", flush=True)
        if len(found) > 10:
            print(f"{before.name}/{file}: {len(found)} differences in all")
        count += len(found)
    return len(files), count


def time_cases(names, binaries, folder, places):
    """Runs each case three times with both builds in turn, and prints the least processor seconds of each build."""
    sums = [0.0, 0.0]
    for name in names:
        runs = [[run_case(binary, CASES[name], folder, places) for binary in binaries] for _ in range(3)]
        if any(error for turn in runs for _, error in turn):
            continue
        least = [min(seconds for seconds, _ in side) for side in zip(*runs)]
        sums = [total + value for total, value in zip(sums, least)]
        print(f"{name}: before {least[0]:.2f} s, after {least[1]:.2f} s", flush=True)
    print(f"all cases: before {sums[0]:.2f} s, after {sums[1]:.2f} s, ratio {sums[1] / max(sums[0], 1e-9):.4f}")


def program(name):
    """Absolute path of a program."""
    if not (found := shutil.which(name)):
        raise argparse.ArgumentTypeError(f"{name} is no program")
    return str(Path(found).resolve())


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--before", required=True, type=program, help="knotdock before the change")
    parser.add_argument("--after", required=True, type=program, help="knotdock after it")
    parser.add_argument("--pairs", required=True, type=Path, help="folder of benchmark pairs")
    parser.add_argument("--examples", type=Path, default=Path("structures/examples"), help="default: %(default)s")
    parser.add_argument("--keep", type=Path, help="folder for all results; those of --before are used again")
    parser.add_argument("--only", help="cases to run, with commas between them")
    ignore = "a JSON key, a column, or a file by its path CASE/FILE, not to be compared; * stands for any text"
    parser.add_argument("--ignore", action="append", default=[], metavar="KEY", help=ignore)
    parser.add_argument("--time", action="store_true", help="measure processor time too, three runs each in turn")
    options = parser.parse_args()
    names = options.only.split(",") if options.only else list(CASES)
    if unknown := set(names) - set(CASES):
        parser.error(f"no such case: {', '.join(sorted(unknown))}; there are {', '.join(CASES)}")

    def ignored(name):
        return any(fnmatchcase(name, pattern) for pattern in NOT_COMPARED + options.ignore)

    total = 0
    with tempfile.TemporaryDirectory() as scratch:
        root = (options.keep or Path(scratch)).resolve()
        places = {"pairs": options.pairs.resolve(), "examples": options.examples.resolve(), "inputs": root / "inputs"}
        write_inputs(places["inputs"], places["pairs"])
        running = root / "running"  # both builds run in one folder, so that paths in their files agree

        def run(binary, name, folder):
            seconds, error = run_case(binary, CASES[name], running, places)
            if error is None:
                shutil.rmtree(folder, ignore_errors=True)
                shutil.copytree(running, folder)
            return f"{seconds:.1f} s", error

        for name in names:
            before, after = root / "before" / name, root / "after" / name
            done = {"sha256": sha256(options.before), "commands": CASES[name]}
            mark = before.with_suffix(".json")  # written last, with what the results came from
            took = "kept"
            if not mark.exists() or json.loads(mark.read_text()) != done:
                took, error = run(options.before, name, before)
                if error:
                    print(f"{name}: the program before the change failed: {error}", file=sys.stderr)
                    sys.exit(2)
                mark.write_text(json.dumps(done))
            took_after, error = run(options.after, name, after)
            if error:
                print(f"DIFFERENT {name}: the program after the change failed: {error}", flush=True)
                total += 1
                continue
            files, count = compare_case(before, after, ignored)
            total += count
            print(f"{name}: {files} files, {count} differences; CPU before {took}, after {took_after}", flush=True)
        if options.time:
            time_cases(names, (options.before, options.after), running, places)
    print(f"{len(names)} cases, {total} differences")
    sys.exit(1 if total else 0)


if __name__ == "__main__":
    main()
