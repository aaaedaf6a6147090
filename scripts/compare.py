#!/usr/bin/env python3
"""Compares benchmark runs with different settings: success, its uncertainty, what each setting gains on the first, and its cost.

    python3 scripts/compare.py shape=runs/shape all=runs/fold0,runs/fold1 ... [--ranking poses] [--resamples 10000] [--output FILE]

Each folder (or several, with commas between them, which hold a setting's pairs together) is the --out of a `scripts/benchmark.py` run; pairs and seeds that all of them hold are compared. Success among the first N
is the number of pairs, as the mean over seeds; a folder with a run that failed is refused. Intervals are the middle 95% over pairs drawn anew with replacement (bootstrap);
a gain's interval is of the difference on the same draws, so that a pair that is easy for all counts for none. A second table has
the mean logarithm of the first rank, which a rank that is merely better moves, too: over turns, then over pairs; with its difference from
the first setting's and the standard error of that over pairs. What was not found counts as rank 3,000. Below it
stands how far a pair's turns disagree: the standard deviation of its log rank over them, averaged over pairs.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import csv
import math
import random
import statistics
import sys
from pathlib import Path

from whole_file import write

DEPTHS = (1, 10, 100, 1000)
CRITERIA = (("acceptable", "first_acceptable_rank"), ("near-native", "first_near_native_rank"))
NOT_FOUND = 3000


def main():
    options = parse_arguments()
    runs = {name: read(folders, options.ranking) for name, folders in options.runs}
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
    draws = draw_pairs(len(complete), options.resamples)
    lines = [
        f"{len(complete)} pairs, seeds {', '.join(seeds)}, ranking of {options.ranking}; in brackets 95% by bootstrap over pairs.",
        "",
        "| setting | " + " | ".join(f"{name} top {depth}" for name, _ in CRITERIA for depth in DEPTHS) + " | CPU s |",
        "|---" * (2 + len(CRITERIA) * len(DEPTHS)) + "|",
    ]
    first = None
    for name, rows in runs.items():
        columns = {}
        for _, column in CRITERIA:
            for depth in DEPTHS:
                columns[column, depth] = [
                    statistics.fmean(rows[pair, seed][column] <= depth for seed in seeds) for pair in complete
                ]
        cells = [cell(values, draws) for values in columns.values()]
        cpu = statistics.fmean(rows[pair, seed]["cpu_seconds"] for pair in complete for seed in seeds)
        lines.append(f"| {name} | " + " | ".join(cells) + f" | {cpu:.1f} |")
        if first is None:
            first = columns
        else:
            gains = [
                cell([a - b for a, b in zip(values, first[key])], draws, signed=True)
                for key, values in columns.items()
            ]
            lines.append("| gain | " + " | ".join(gains) + " | |")
    lines += ["", *log_ranks(runs, complete, seeds)]
    text = "\n".join(lines) + "\n"
    if options.output:
        write(options.output, text)
    print(text, end="")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("runs", nargs="+", type=named, metavar="NAME=FOLDER[,FOLDER]", help="a setting's name and the folder or folders of its runs")
    parser.add_argument("--ranking", default="poses", choices=("poses", "clusters"))
    parser.add_argument("--resamples", type=int, default=10000, help="draws of the bootstrap (default: 10000)")
    parser.add_argument("--output", type=Path, help="write the table to a file, too")
    return parser.parse_args()


def named(text):
    name, equals, folders = text.partition("=")
    if not (name and equals and folders):
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=FOLDER")
    return name, [Path(folder) for folder in folders.split(",")]


def read(folders, ranking="poses"):
    """Rows by pair and seed; what was not found has an infinite rank."""
    rows = {}
    for folder in folders:
        table = folder / f"{ranking}.csv"
        if not table.is_file():
            raise SystemExit(f"{folder} holds no {ranking}.csv; name the --out folder of a scripts/benchmark.py run")
        with open(table, newline="") as file:
            for row in csv.DictReader(file):
                if row["error"]:
                    raise SystemExit(f"{table}: {row['id']}, seed {row['seed']} failed; run scripts/benchmark.py again, which repeats what failed: {row['error']}")
                ranks = {column: float(row[column] or math.inf) for _, column in CRITERIA}
                rows[row["id"], row["seed"]] = {**ranks, "cpu_seconds": float(row["cpu_seconds"] or "nan")}
    return rows


def log_ranks(runs, pairs, seeds):
    """Table of mean log ranks, and of their differences from the first run's."""
    lines = ["| mean log rank | " + " | ".join(f"{name} | against the first" for name, _ in CRITERIA) + " |", "|---" * 5 + "|"]
    first = None
    for name, rows in runs.items():
        means = {
            column: [statistics.fmean(math.log(min(rows[pair, seed][column], NOT_FOUND)) for seed in seeds) for pair in pairs]
            for _, column in CRITERIA
        }
        cells = []
        for column, values in means.items():
            gain = ""
            if first is not None and len(pairs) > 1:
                gains = [a - b for a, b in zip(values, first[column])]
                gain = f"{statistics.fmean(gains):+.2f} ({statistics.stdev(gains) / math.sqrt(len(gains)):.2f})"
            cells += [f"{statistics.fmean(values):.2f}", gain]
        first = first or means
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    if len(seeds) > 1:
        lines += ["", "Spread of a pair's log rank over its turns (standard deviation, mean over pairs):", ""]
        for name, rows in runs.items():
            parts = []
            for criterion, column in CRITERIA:
                ranks = [[math.log(min(rows[pair, seed][column], NOT_FOUND)) for seed in seeds] for pair in pairs]
                parts.append(f"{criterion} {statistics.fmean(statistics.stdev(turns) for turns in ranks):.2f}")
            lines.append(f"- {name}: " + ", ".join(parts))
    return lines


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
