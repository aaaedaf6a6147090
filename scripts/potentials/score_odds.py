#!/usr/bin/env python3
"""The pose score that equals one nat of evidence that a pose is acceptable.

    python3 scripts/potentials/score_odds.py DIR RUNS [RUNS ...]

DIR is the benchmark folder. Each RUNS is the --out folder of a `benchmark.py` run. Within a run, the chance that the
one pose drawn with weights exp(b s) is acceptable is that of a softmax over the scores s of its poses, sharp fits left
out. The slope b with the greatest likelihood over the runs that have an acceptable pose is printed, with its standard
error from the curvature there, and 1 / b: the score that a nat of independent evidence should count.

`knotdock evaluate` is run once to find whether each pose is acceptable, and its output is kept beside the run.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import csv
import math
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import verdicts


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=Path, metavar="DIR", help="benchmark folder")
    parser.add_argument("runs", type=Path, nargs="+", metavar="RUNS", help="output folder of benchmark.py")
    parser.add_argument("--knotdock", default="knotdock", help="the program (default: knotdock)")
    options = parser.parse_args()
    folders = [folder for runs in options.runs for folder in sorted(runs.glob("*/seed_*")) if (folder / "run").exists()]
    runs = [run for run in (load(options, folder) for folder in folders) if any(good for _, good in run)]
    if not runs:
        sys.exit("no run has an acceptable pose")
    slope = steepest(runs)
    _, curvature = derivatives(runs, slope)
    error = (-curvature) ** -0.5
    print(f"{len(runs)} of {len(folders)} runs have an acceptable pose")
    print(f"slope {slope:.5f} ({error:.5f}) a unit of score; a nat is worth {1 / slope:.0f}")


def load(options, folder):
    """Score without the sharp fit, and whether it is acceptable, of each pose of a run."""
    found = verdicts(options.knotdock, folder, options.folder / folder.parent.name)
    with open(folder / "run/poses.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    return [(float(row["pose_score"]) - float(row.get("sharp") or 0), found[row["rank"]][0]) for row in rows]


def derivatives(runs, slope):
    """First and second derivative of the log-likelihood: means and variances of the scores, acceptable less all."""
    first = second = 0.0
    for run in runs:
        for sign, poses in ((1, [score for score, good in run if good]), (-1, [score for score, _ in run])):
            top = max(poses)
            weights = [math.exp(slope * (score - top)) for score in poses]
            total = sum(weights)
            mean = sum(weight * score for weight, score in zip(weights, poses)) / total
            first += sign * mean
            second += sign * sum(weight * (score - mean) ** 2 for weight, score in zip(weights, poses)) / total
    return first, second


def steepest(runs):
    """The slope at which the likelihood is greatest, by bisection: above it the best poses count too much."""
    low, high = 0.0, 1.0
    for _ in range(40):
        middle = (low + high) / 2
        if derivatives(runs, middle)[0] > 0:
            low = middle
        else:
            high = middle
    return (low + high) / 2


if __name__ == "__main__":
    main()
