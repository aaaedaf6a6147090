#!/usr/bin/env python3
"""Ranks the poses of benchmark runs again with other weights of one pose term.

    python3 scripts/potentials/pose_term_weight.py DIR RUNS [RUNS ...] --term restraints_penalty [--factors 0,0.5,1,2,4]

DIR is the benchmark folder. Each RUNS is the --out folder of a `benchmark.py` run. A term is a column of `poses.csv`,
and part of `pose_score`. With a factor of 2 it counts twice as much as in the runs. Poses are ranked one by one.

Printed are, for each factor, the mean log rank of the first acceptable and near-native pose, with the standard error
over pairs of its difference from a factor of 1, and the pairs with one in the first 1, 10 and 100.

`knotdock evaluate` is run once to find whether each pose is acceptable and near-native, and its output is kept beside
the run (`verdicts.json`, as by fit_weights.py).

Needs Python 3.9 or later and nothing else.
"""

import argparse
import csv
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import CRITERIA, log_rank, verdicts

DEPTHS = (1, 10, 100)


def main():
    options = parse_arguments()
    runs = [folder for runs in options.runs for folder in sorted(runs.glob("*/seed_*")) if (folder / "run").exists()]
    if not runs:
        sys.exit("there are no runs")
    poses = [load(options, folder) for folder in runs]
    names = [folder.parent.name for folder in runs]
    base = ranks(poses, 1.0)
    print(f"{len(poses)} runs of {len(set(names))} pairs; term {options.term}")
    print("| factor | " + " | ".join(f"{criterion}: mean log rank | top 1 / 10 / 100" for criterion in CRITERIA) + " |")
    print("|---|" + "---|---|" * len(CRITERIA))
    for factor in options.factors:
        print(f"| {factor:g} | " + " | ".join(summary(names, ranks(poses, factor), base)) + " |")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=Path, metavar="DIR", help="benchmark folder")
    parser.add_argument("runs", type=Path, nargs="+", metavar="RUNS", help="output folder of benchmark.py")
    parser.add_argument("--term", required=True, help="column of poses.csv")
    parser.add_argument(
        "--factors",
        type=lambda text: [float(factor) for factor in text.split(",")],
        default=[0, 0.25, 0.5, 1, 2, 4],
        help="factors of its weight (default: 0,0.25,0.5,1,2,4)",
    )
    parser.add_argument("--knotdock", default="knotdock", help="the program (default: knotdock)")
    return parser.parse_args()


def load(options, folder):
    """Score without the term, the term, and the verdicts of each pose of a run."""
    table = folder / "run/poses.csv"
    found = verdicts(options.knotdock, folder, options.folder / folder.parent.name)
    with open(table, newline="") as file:
        rows = list(csv.DictReader(file))
    if rows and options.term not in rows[0]:
        sys.exit(f"{table} has no column {options.term}")
    terms = [float(row[options.term] or 0) for row in rows]
    return [(float(row["pose_score"]) - term, term, found[row["rank"]]) for row, term in zip(rows, terms)]


def ranks(poses, factor):
    """First rank by each criterion of each run (None: none)."""
    found = []
    for run in poses:
        ordered = sorted(run, key=lambda pose: -(pose[0] + factor * pose[1]))
        first = [next((rank for rank, pose in enumerate(ordered, 1) if pose[2][k]), None) for k in range(len(CRITERIA))]
        found.append(first)
    return found


def summary(names, found, base):
    """Cells of a row: of each criterion the mean log rank with its difference, and the numbers of pairs."""
    for k in range(len(CRITERIA)):
        by_pair = {}
        for name, own, other in zip(names, found, base):
            by_pair.setdefault(name, []).append((log_rank(own[k]), log_rank(own[k]) - log_rank(other[k])))
        logs = [statistics.mean(log for log, _ in runs) for runs in by_pair.values()]
        moves = [statistics.mean(move for _, move in runs) for runs in by_pair.values()]
        error = statistics.stdev(moves) / len(moves) ** 0.5 if len(moves) > 1 else 0.0
        yield f"{statistics.mean(logs):.2f}, {statistics.mean(moves):+.2f} ({error:.2f})"
        hits = [sum(own[k] is not None and own[k] <= depth for own in found) for depth in DEPTHS]
        yield " / ".join(f"{hit * len(by_pair) / len(found):.1f}" for hit in hits)


if __name__ == "__main__":
    main()
