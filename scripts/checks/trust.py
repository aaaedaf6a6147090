#!/usr/bin/env python3
"""What the program promises, tried many times: prints a table of promises, trials and failures.

    scripts/checks/trust.py target/release/knotdock [--short] [--seed N] [--write docs/method/trust.md] [--json FILE]
    scripts/checks/trust.py target/release/knotdock --only kills --trial 17 --keep FOLDER     one trial again

Each trial runs the program in a folder of its own, on inputs that its seed fixes. promises/__init__.py lists the
promises, one function each. The short form is for continuous integration and takes about 20 seconds, the full one up
to 20 minutes: trials of all promises go in turn, and on a slow machine fewer of them are done. A failure is printed
with the calls that led to it and the command that repeats it.

--write replaces the table between two markers in a page. --json and --csv write it to files. A trial that the
platform does not allow (a small disk needs root) is skipped and not counted.

Exit code: 0 no failure, 1 a failure, 2 wrong use. Needs Linux, Python 3.9 or later and nothing else.
"""

import argparse
import csv
import json
import os
import shutil
import sys
import tempfile
import time
import traceback
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path

from promises import PROMISES
from promises.trial import Skipped, Trial

BEGIN, END = "<!-- just trust: begin -->", "<!-- just trust: end -->"


@dataclass
class Settings:
    """What all trials share."""

    knotdock: str
    seed: int
    full: bool
    keep: str


@dataclass
class Outcome:
    """What came of one trial; `skipped` is why it was not done."""

    name: str
    number: int
    seconds: float = 0.0
    failures: list = field(default_factory=list)
    commands: list = field(default_factory=list)
    skipped: str = ""


def one_trial(settings, place, number):
    """Does one trial of the promise at a place in the list."""
    promise, outcome = PROMISES[place], Outcome(PROMISES[place].name, number)
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="knotdock_trust_", ignore_cleanup_errors=True) as folder:
        folder = Path(settings.keep or folder).resolve()
        trial = Trial(settings.knotdock, promise.name, number, settings.seed, folder, settings.full)
        try:
            promise.trial(trial)
        except Skipped as why:
            outcome.skipped = str(why)
        except Exception:  # a trial that breaks off has not shown the promise
            trial.failures.append(traceback.format_exc(limit=-3))
    outcome.failures, outcome.commands = trial.failures, trial.commands
    outcome.seconds = time.monotonic() - began
    return outcome


@dataclass
class Row:
    """A row of the table."""

    name: str
    promise: str
    how: str
    trials: int = 0
    skipped: str = ""
    failures: int = 0
    seconds: float = 0.0


def print_failure(outcome, settings):
    print(f"\nFAILED {outcome.name}, trial {outcome.number}:", flush=True)
    for words in outcome.failures:
        print(f"    {words.strip()}")
    for command in outcome.commands[-4:]:
        print(f"    after: {command}")
    print(f"    again: {sys.argv[0]} {settings.knotdock} --seed {settings.seed} --only {outcome.name}"
          f" --trial {outcome.number} --keep NEW_FOLDER{'' if settings.full else ' --short'}", flush=True)  # fmt: skip


def in_turn(chosen):
    """Places and numbers of all trials, so that each promise has its share of them at any time."""
    trials = [((order + 0.5) / len(numbers), place, number)
              for place, numbers in chosen for order, number in enumerate(numbers)]  # fmt: skip
    return [(place, number) for _, place, number in sorted(trials)]


def run_trials(settings, chosen, jobs, minutes):
    """Rows of the promises, each a place in the list and numbers of trials, and how many were left out.

    Failures are printed as they come. When the given minutes have passed no further trial starts.
    """
    rows = {place: Row(PROMISES[place].name, *PROMISES[place].words) for place, _ in chosen}
    end, left_out = time.monotonic() + 60 * minutes, 0
    with ProcessPoolExecutor(jobs) as pool:
        trials = {pool.submit(one_trial, settings, *trial): trial for trial in in_turn(chosen)}
        for done in as_completed(trials):
            if time.monotonic() > end:
                for trial in trials:
                    trial.cancel()
            if done.cancelled():
                left_out += 1
                continue
            row, outcome = rows[trials[done][0]], done.result()
            row.seconds += outcome.seconds
            if outcome.skipped:
                row.skipped = outcome.skipped
                continue
            row.trials += 1
            if outcome.failures:
                row.failures += 1
                print_failure(outcome, settings)
    return list(rows.values()), left_out


def markdown(rows):
    """The table; seconds are those of the trials, of which as many run at once as there are cores."""
    lines = ["| promise | how it is tested | trials | failures | seconds |", "|---|---|---|---|---|"]
    for row in rows:
        trials = f"{row.trials:,}" if row.trials else "none: " + (row.skipped or "no time")
        lines.append(f"| {row.promise} | {row.how} | {trials} | {row.failures} | {row.seconds:.0f} |")
    trials, failures = sum(row.trials for row in rows), sum(row.failures for row in rows)
    lines.append(f"| all | | {trials:,} | {failures} | {sum(row.seconds for row in rows):.0f} |")
    return "\n".join(lines)


def write_into_page(path, table):
    """Replaces the text between the two markers of a page."""
    page = path.read_text()
    if BEGIN not in page or END not in page:
        sys.exit(f"trust: {path} has no lines {BEGIN} and {END}")
    before, after = page.split(BEGIN)[0], page.split(END)[1]
    path.write_text(f"{before}{BEGIN}\n\n{table}\n\n{END}{after}")


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("knotdock", help="the program")
    parser.add_argument("--short", action="store_true", help="few trials, in about 20 seconds")
    parser.add_argument("--seed", type=int, default=1, help="other inputs; default: %(default)s")
    parser.add_argument("--only", help="promises to test, with commas between their names")
    parser.add_argument("--trial", type=int, help="this trial alone")
    parser.add_argument("--keep", help="with --trial: a new folder for it, which stays")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="trials at once; default: %(default)s")
    parser.add_argument("--minutes", type=float, help="no trial starts later; default: 17, short 0.3")
    parser.add_argument("--write", type=Path, help="page that gets the table between its markers")
    parser.add_argument("--json", type=Path, help="file for the table as JSON")
    parser.add_argument("--csv", type=Path, help="file for the table as CSV")
    options = parser.parse_args()
    names = [promise.name for promise in PROMISES]
    options.names = options.only.split(",") if options.only else names
    if unknown := set(options.names) - set(names):
        parser.error(f"no such promise: {', '.join(sorted(unknown))}; there are {', '.join(names)}")
    if options.trial is not None and len(options.names) != 1:
        parser.error("--trial needs one promise: --only NAME")
    if options.keep and (options.trial is None or Path(options.keep).exists()):
        parser.error("--keep goes with --trial and names a folder that is not there yet")
    found = shutil.which(options.knotdock)
    if not found:
        parser.error(f"{options.knotdock} is no program")
    options.knotdock = str(Path(found).resolve())
    return options


def main():
    options = read_arguments()
    if options.keep:
        Path(options.keep).mkdir(parents=True)
    settings = Settings(options.knotdock, options.seed, not options.short, options.keep)
    chosen = []
    for place, promise in enumerate(PROMISES):
        if promise.name in options.names:
            numbers = range(promise.short if options.short else promise.full)
            chosen.append((place, numbers if options.trial is None else [options.trial]))
    began = time.monotonic()
    minutes = options.minutes or (0.3 if options.short else 17)
    rows, left_out = run_trials(settings, chosen, options.jobs, minutes)
    for row in rows:
        print(f"{row.name}: {row.trials} trials, {row.failures} failures, {row.seconds:.0f} s {row.skipped}")
    table = markdown(rows)
    print(f"\n{table}\n\nseed {options.seed}, {time.monotonic() - began:.0f} s on the clock", end="")
    print(f"; {left_out} trials were left out after {minutes:g} minutes" if left_out else "")
    if options.write:
        write_into_page(options.write, table)
    if options.json:
        options.json.write_text(json.dumps([vars(row) for row in rows], indent=2) + "\n")
    if options.csv:
        with open(options.csv, "w", newline="") as file:
            writer = csv.DictWriter(file, list(vars(rows[0])))
            writer.writeheader()
            writer.writerows(vars(row) for row in rows)
    sys.exit(any(row.failures for row in rows))


if __name__ == "__main__":
    main()
