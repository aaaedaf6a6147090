#!/usr/bin/env python3
"""What score a unit of log-odds is worth in a ranking, and what touching an active site says: the two figures behind --peptidase-weight.

    python3 scripts/score_odds.py DIR RUNS [RUNS ...] [--knotdock PROGRAM]

DIR is the benchmark folder; each RUNS is the --out folder of a `scripts/benchmark.py` run on training pairs. A pose of rank score s is taken to
be right with odds in proportion to exp(s / T), T the same for all pairs: printed is the T under which the right poses of all runs together are
most likely, each run's probabilities adding up to one over its poses, with a 95% interval by bootstrap over pairs. What active sites earned is taken off
the scores first. Then, of each pair whose run assumed a site, the share of its residues that all poses touch on average, the best hundred, and the
acceptable ones; the means of the first and the last, a pair without acceptable poses counting as 0; and the log-odds between a pose that touches and one that does not.

Needs Python 3.9 or later and NumPy.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from fit_weights import ACCEPTABLE, HELD, NEAR_NATIVE, SCORE, load

TEMPERATURES = np.geomspace(50.0, 2000.0, 149)
RESAMPLED = 2000


def main():
    options = parse_arguments()
    likelihoods = {"acceptable": {}, "near-native": {}}
    sites = {}
    for folder in sorted(folder for runs in options.runs for folder in runs.glob("*/seed_*") if (folder / "run/run.json").exists()):
        pair = folder.parent.name
        rows, _, _ = load(options, folder, pair)
        earned = rows[:, ACCEPTABLE - len(HELD) + HELD.index("active_residues")]
        scores = rows[:, SCORE] - earned
        for name, column in (("acceptable", ACCEPTABLE), ("near-native", NEAR_NATIVE)):
            right = rows[:, column] > 0
            if right.any():
                likelihoods[name].setdefault(pair, []).append([log_probability(scores / t, right) for t in TEMPERATURES])
        record = json.loads((folder / "run/run.json").read_text())
        if record.get("active_site"):
            shares = earned / record["options"]["peptidase_weight"]
            acceptable = shares[rows[:, ACCEPTABLE] > 0]
            best = shares[np.argsort(-scores, kind="stable")[:100]]
            sites.setdefault(pair, []).append((shares.mean(), best.mean(), acceptable.mean() if len(acceptable) else np.nan))
    for name, found in likelihoods.items():
        if not found:
            raise SystemExit(f"no run has {name} poses")
        likelihood = np.array([np.mean(turns, axis=0) for turns in found.values()])
        drawn = np.random.default_rng(0).integers(len(likelihood), size=(RESAMPLED, len(likelihood)))
        low, high = np.quantile([most_likely(likelihood[pairs]) for pairs in drawn], [0.025, 0.975])
        print(f"{name}: a unit of log-odds is worth {most_likely(likelihood):.0f} [{low:.0f}, {high:.0f}], {len(likelihood)} pairs")
    means = {pair: mean_over_turns(turns) for pair, turns in sorted(sites.items())}
    for pair, (every, best, acceptable) in means.items():
        print(f"{pair}: of its active site all poses touch {every:.2f}, the best 100 {best:.2f}, the acceptable ones {acceptable:.2f}")
    if means:
        every, _, right = np.nan_to_num(list(means.values())).mean(axis=0)
        units = np.log(right / every) + np.log((1 - every) / (1 - right))
        print(f"of {len(means)} pairs: all poses touch {every:.2f}, acceptable ones {right:.2f}; {units:.1f} units of log-odds")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=Path, metavar="DIR", help="benchmark folder")
    parser.add_argument("runs", type=Path, nargs="+", metavar="RUNS", help="output folder of benchmark.py")
    parser.add_argument("--knotdock", default="knotdock", help="the program (default: the one on the path)")
    return parser.parse_args()


def mean_over_turns(turns):
    """Means of a pair's shares, of acceptable poses over the turns that have any."""
    return [np.mean([share for share in shares if not np.isnan(share)] or np.nan) for shares in zip(*turns)]


def log_probability(scores, right):
    """Log of the share of exp(score) that the right poses have."""
    weights = np.exp(scores - scores.max())
    inside = scores[right].max()
    return inside - scores.max() + np.log(np.exp(scores[right] - inside).sum()) - np.log(weights.sum())


def most_likely(likelihood):
    """The temperature of the highest mean."""
    return TEMPERATURES[np.argmax(likelihood.mean(axis=0))]


if __name__ == "__main__":
    main()
