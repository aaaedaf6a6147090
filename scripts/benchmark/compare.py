#!/usr/bin/env python3
"""Compares benchmark runs with different settings: success, the gain of each setting over the first one, and its cost.

    python3 scripts/benchmark/compare.py shape=runs/shape all=runs/fold0,runs/fold1 ... [--ranking poses]

Each folder is the --out of a `benchmark.py` run; several, with commas between them, hold a setting's pairs together.
Pairs and seeds that all settings hold are compared; a folder with a run that failed is refused.

First table: pairs that succeed among the first N, as the mean over seeds. Intervals are the middle 95% over pairs
drawn anew with replacement (bootstrap). A gain's interval is of the difference on the same draws, so a pair that is
easy for all counts for none.

Second table: the mean logarithm of the first rank, over seeds, then over pairs. Any better rank changes it, too.
Beside it are its difference from the first setting's, and the standard error of that over pairs. Below it: how far a
pair's start orientations disagree, as the standard deviation of its log rank over them, averaged over pairs.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import math
import random
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import CRITERIA, DEPTHS, log_rank, write
from tables import RANKINGS, read_ranks

LABELS = {criterion: criterion.replace("_", "-") for criterion in CRITERIA}


def main():
    options = parse_arguments()
    runs = {name: read_ranks(folders, options.ranking) for name, folders in options.runs}
    if len(runs) < len(options.runs):
        raise SystemExit("two settings have one name")
    shared = set.intersection(*(set(rows) for rows in runs.values()))
    pairs = sorted({pair for pair, _ in shared})
    seeds = sorted({seed for _, seed in shared})
    complete = [pair for pair in pairs if all((pair, seed) in shared for seed in seeds)]
    for pair in set(pairs) - set(complete):
        print(f"{pair} is left out: not every run has all of its seeds", file=sys.stderr)
    if not complete:
        raise SystemExit("no pair with all its seeds is in every run")
    lines = [
        f"{len(complete)} pairs, seeds {', '.join(seeds)}, ranking of {options.ranking}; "
        "in brackets 95% by bootstrap over pairs.",
        "",
        *successes(runs, complete, seeds, draw_pairs(len(complete), options.resamples)),
        "",
        *log_ranks(runs, complete, seeds),
    ]
    if len(seeds) > 1:
        lines += ["", "Spread of a pair's log rank over its seeds (standard deviation, mean over pairs):", ""]
        lines += spreads(runs, complete, seeds)
    text = "\n".join(lines) + "\n"
    if options.output:
        write(options.output, text)
    print(text, end="")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    add = parser.add_argument
    add(
        "runs", nargs="+", type=named, metavar="NAME=FOLDER[,FOLDER]", help="a setting's name and its folder or folders"
    )
    add("--ranking", default="poses", choices=RANKINGS)
    add("--resamples", type=int, default=10000, help="draws of the bootstrap (default: 10000)")
    add("--output", type=Path, help="write the tables to a file, too")
    return parser.parse_args()


def named(text):
    """NAME=FOLDER[,FOLDER] as name and folders."""
    name, equals, folders = text.partition("=")
    if not (name and equals and folders):
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=FOLDER")
    return name, [Path(folder) for folder in folders.split(",")]


def successes(runs, pairs, seeds, draws):
    """Table of pairs that succeed, and of the gains on the first setting."""
    columns = [(criterion, depth) for criterion in CRITERIA for depth in DEPTHS]
    head = " | ".join(f"{LABELS[criterion]} top {depth}" for criterion, depth in columns)
    lines = [f"| setting | {head} | CPU s |", "|---" * (2 + len(columns)) + "|"]
    first = None
    for name, rows in runs.items():
        found = {
            (criterion, depth): [
                statistics.fmean(rows[pair, seed][criterion] <= depth for seed in seeds) for pair in pairs
            ]
            for criterion, depth in columns
        }
        cpu = statistics.fmean(rows[pair, seed]["cpu_seconds"] for pair in pairs for seed in seeds)
        cells = " | ".join(cell(values, draws) for values in found.values())
        lines.append(f"| {name} | {cells} | {cpu:.1f} |")
        if first is None:
            first = found
            continue
        differences = ([a - b for a, b in zip(values, first[key])] for key, values in found.items())
        gains = " | ".join(cell(values, draws, signed=True) for values in differences)
        lines.append(f"| gain | {gains} | |")
    return lines


def log_ranks(runs, pairs, seeds):
    """Table of mean log ranks, and of their differences from the first setting's."""
    head = " | ".join(f"{LABELS[criterion]} | against the first" for criterion in CRITERIA)
    lines = [f"| mean log rank | {head} |", "|---" * (1 + 2 * len(CRITERIA)) + "|"]
    first = None
    for name, rows in runs.items():
        means = {
            criterion: [statistics.fmean(log_rank(rows[pair, seed][criterion]) for seed in seeds) for pair in pairs]
            for criterion in CRITERIA
        }
        cells = []
        for criterion, values in means.items():
            gain = ""
            if first is not None and len(pairs) > 1:
                gains = [a - b for a, b in zip(values, first[criterion])]
                gain = f"{statistics.fmean(gains):+.2f} ({statistics.stdev(gains) / math.sqrt(len(gains)):.2f})"
            cells += [f"{statistics.fmean(values):.2f}", gain]
        first = first or means
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return lines


def spreads(runs, pairs, seeds):
    """A line for each setting: how far log ranks of one pair differ between seeds."""
    for name, rows in runs.items():
        parts = []
        for criterion in CRITERIA:
            ranks = [[log_rank(rows[pair, seed][criterion]) for seed in seeds] for pair in pairs]
            parts.append(f"{LABELS[criterion]} {statistics.fmean(map(statistics.stdev, ranks)):.2f}")
        yield f"- {name}: " + ", ".join(parts)


def draw_pairs(count, resamples):
    """Pairs drawn anew with replacement, the same ones every time."""
    source = random.Random(1)
    return [[source.randrange(count) for _ in range(count)] for _ in range(resamples)]


def interval(values, draws):
    """The middle 95% of the sum over pairs."""
    sums = sorted(sum(values[index] for index in draw) for draw in draws)
    return tuple(sums[int(share * (len(sums) - 1))] for share in (0.025, 0.975))


def cell(values, draws, signed=False):
    """Sum over pairs with its interval."""
    low, high = interval(values, draws)
    sign = "+" if signed else ""
    return f"{sum(values):{sign}.1f} [{low:{sign}.1f}, {high:{sign}.1f}]"


if __name__ == "__main__":
    main()
