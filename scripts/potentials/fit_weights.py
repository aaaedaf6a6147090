#!/usr/bin/env python3
"""Ranks the poses of benchmark runs again with other weights, and chooses weights by cross-validation over pairs.

    python3 scripts/potentials/fit_weights.py DIR RUNS [RUNS ...] [--lambdas 8,9,10] [--electrostatics 0,16,24,32]
        [--contact 0,1,2,3] [--fine 0,1,2,3] [--pairs 0,1,2,3] [--relaxed 0,3] [--clusters]

DIR is the benchmark folder. Each RUNS is the --out folder of a `benchmark.py` run on training pairs, docked with
`--diagnostics` (for the slices) and best without refinement: refined poses were maximized under their run's weights.

A pose's slices and terms are linear in the weights, so its score under others needs no docking. The poses of a pair
and seed in all RUNS are pooled. `knotdock evaluate` is run once to find whether each pose is acceptable and
near-native. Its output is kept beside the run (`verdicts.json`).

Printed are:

- For every combination the mean log rank of the first acceptable pose, and the pairs with one in the first 1, 10, 100
  and 1000, as means over seeds, then over pairs. Beside them is the mean log rank of the first near-native pose. Both
  are compared with the weights of the first run.
- The same for weights chosen for each fold of the pairs on the others, which estimates the gain on new pairs.
- A bootstrap interval over pairs of the difference between the two best.

With --clusters temperatures are compared instead, at the runs' own weights: clusters ordered by
T ln sum exp(score / T), T a share of the run's best score (0: the best pose alone).

Needs Python 3.9 or later and NumPy.
"""

import argparse
import csv
import itertools
import json
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import DEPTHS, NOT_FOUND, log_rank, verdicts

FEATURES = ("slice_0", "slice_r0", "slice_2r0")
TERMS = ("electrostatics", "contact", "fine_contact", "atom_pair", "relaxed")
SUMMED = len(FEATURES) + len(TERMS) + 1
ACCEPTABLE, NEAR_NATIVE, SCORE, CLUSTER = range(SUMMED, SUMMED + 4)
TEMPERATURES = (0.0, 0.02, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3)


def main():
    options = parse_arguments()
    pooled, weights, computed = {}, [], []
    for runs in options.runs:
        computed.append(set())
        for record in sorted(runs.glob("*/seed_*/result.json")):
            pair, seed = record.parent.parent.name, record.parent.name
            if (record.parent / "run/run.json").exists():
                rows, own, terms = load(options, record.parent, pair)
                computed[-1] |= terms
                pooled.setdefault((pair, seed), []).append(rows)
                weights.append(own)
    decoys = {key: np.concatenate(parts) for key, parts in pooled.items() if len(parts) == len(options.runs)}
    if not decoys:
        raise SystemExit("no pair is in all runs")
    print(f"{len({pair for pair, _ in decoys})} pairs, {len(decoys)} runs, {sum(map(len, decoys.values()))} poses\n")
    if options.clusters:
        compare_temperatures(decoys)
    else:
        compare_weights(options, decoys, weights[0], set(TERMS).intersection(*computed))


def numbers(text):
    """Numbers separated by commas."""
    return [float(part) for part in text.split(",")]


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=Path, metavar="DIR", help="benchmark folder")
    parser.add_argument("runs", type=Path, nargs="+", metavar="RUNS", help="output folder of benchmark.py")
    parser.add_argument("--knotdock", default="knotdock", help="the program (default: the one on the path)")
    parser.add_argument("--lambdas", type=numbers, default=[8.0, 9.0, 10.0, 11.0])
    parser.add_argument("--electrostatics", type=numbers, default=[0.0, 8.0, 16.0, 24.0, 32.0])
    parser.add_argument("--contact", type=numbers, default=[0.0, 0.8, 1.5, 2.0, 2.5, 3.0])
    parser.add_argument("--fine", type=numbers, default=[0.0, 1.0, 2.0, 3.0])
    parser.add_argument("--pairs", type=numbers, default=[0.0, 1.0, 2.0, 3.0])
    parser.add_argument("--relaxed", type=numbers, default=[0.0, 2.0, 3.0, 4.0])
    parser.add_argument("--folds", type=int, default=5)
    parser.add_argument("--clusters", action="store_true", help="compare temperatures of clusters")
    options = parser.parse_args()
    if options.clusters and len(options.runs) > 1:
        parser.error("--clusters takes one RUNS: each run numbers its clusters from 1")
    return options


def load(options, folder, pair):
    """The poses of a run as rows, the weights of the run, and the names of the terms that it has.

    A row holds slices, unweighted terms, the sum of all other terms, acceptable and near-native (0 or 1), pose score
    and cluster. The other terms are restraint and the pose terms that run.json names, at the weights of the run.
    """
    table = folder / "run/poses.csv"
    found = verdicts(options.knotdock, folder, options.folder / pair)
    run = json.loads((folder / "run/run.json").read_text())
    recorded = {"lambda": run["options"]["kernel"]["lambda"], **run["options"]["terms"]}
    held = ["restraint", *(term["id"] for term in run["pose_terms"] if term["id"] not in TERMS)]
    rows, computed = [], set()
    with open(table, newline="") as file:
        for row in csv.DictReader(file):
            if "slice_0" not in row:
                raise SystemExit(f"{table} has no slices; dock the pairs with `benchmark.py ... -- --diagnostics`")
            computed.update(name for name in TERMS if row.get(name))
            terms = [float(row.get(name) or 0) / (recorded.get(f"{name}_weight") or 1.0) for name in TERMS]
            terms.append(sum(float(row.get(name) or 0) for name in held))
            slices = (float(row[name]) for name in FEATURES)
            rows.append([*slices, *terms, *found[row["rank"]], float(row["pose_score"]), float(row["cluster"])])
    weights = tuple(float(recorded.get(name) or 0) for name in ("lambda", *(f"{name}_weight" for name in TERMS)))
    return np.array(rows, dtype=float), weights, computed


def first_rank(scores, wanted):
    """1-based rank of the first wanted pose by falling score, at most NOT_FOUND."""
    ranked = np.flatnonzero(wanted[np.argsort(-scores, kind="stable")])
    return min(ranked[0] + 1, NOT_FOUND) if len(ranked) else NOT_FOUND


def by_pair(ranks, measure):
    """Mean over the seeds of each pair of a measure of its ranks, pairs in order."""
    values = {}
    for (pair, _), rank in ranks.items():
        values.setdefault(pair, []).append(measure(rank))
    return np.array([np.mean(values[pair]) for pair in sorted(values)])


def summary(ranks):
    """Mean log rank, and pairs with one in the first few, as means over seeds."""
    found = "  ".join(f"{by_pair(ranks, lambda rank: rank <= depth).sum():5.1f}" for depth in DEPTHS)
    return f"{by_pair(ranks, log_rank).mean():.3f}  {found}"


def against(ranks, reference):
    """Difference in mean log rank from others, with its standard error over pairs."""
    gains = by_pair(ranks, log_rank) - by_pair(reference, log_rank)
    error = gains.std(ddof=1) / np.sqrt(len(gains)) if len(gains) > 1 else np.nan
    return f"{gains.mean():+.3f} ({error:.3f})"


def compare_weights(options, decoys, own, computed):
    choices = dict(zip(TERMS, (options.electrostatics, options.contact, options.fine, options.pairs, options.relaxed)))
    for name in TERMS:
        if name not in computed:
            print(f"{name}: not every RUNS has it, so no weight of it is tried")
            choices[name] = [0.0]
    own = (own[0], *(weight if name in computed else 0.0 for name, weight in zip(TERMS, own[1:])))
    grid = list(itertools.product(options.lambdas, *choices.values()))
    if own not in grid:
        grid.append(own)
    acceptable, near_native = {}, {}
    for weights in grid:
        strength, *terms = weights
        factors = np.array([-strength * strength, 2 * strength, -1.0, *terms, 1.0])
        scores = {key: rows[:, : len(factors)] @ factors for key, rows in decoys.items()}
        acceptable[weights] = {key: first_rank(scores[key], rows[:, ACCEPTABLE]) for key, rows in decoys.items()}
        near_native[weights] = {key: first_rank(scores[key], rows[:, NEAR_NATIVE]) for key, rows in decoys.items()}
    mean = {weights: by_pair(acceptable[weights], log_rank) for weights in grid}
    order = sorted(grid, key=lambda weights: mean[weights].mean())
    print(
        "Against: difference from the weights of the first run in mean log rank, with its standard error over pairs.\n"
    )
    print(
        "lambda  electrostatics  contact     fine    pairs  relaxed   acceptable: mean log rank, top 1, 10, 100, 1000; "
        "against   near-native: mean log rank; against"
    )

    def show(name, ranks, near_ranks):
        near_summary = f"{by_pair(near_ranks, log_rank).mean():.3f}  {against(near_ranks, near_native[own])}"
        print(f"{name}   {summary(ranks)}  {against(ranks, acceptable[own])}   {near_summary}")

    for weights in order:
        name = f"{weights[0]:6g}  {weights[1]:14g}  {weights[2]:7g}  {weights[3]:7g}  {weights[4]:7g}  {weights[5]:7g}"
        show(name, acceptable[weights], near_native[weights])
    pairs = sorted({pair for pair, _ in decoys})
    chosen, chosen_near = {}, {}
    for fold in range(options.folds):
        inside = np.arange(len(pairs)) % options.folds == fold
        best = min(grid, key=lambda weights: mean[weights][~inside].mean())
        members = {pair for pair, held in zip(pairs, inside) if held}
        chosen.update({key: rank for key, rank in acceptable[best].items() if key[0] in members})
        chosen_near.update({key: rank for key, rank in near_native[best].items() if key[0] in members})
        print(f"fold {fold}: {best} chosen on the others")
    show(f"{'cross-validated':>58}", chosen, chosen_near)
    if len(order) > 1:
        source = np.random.default_rng(1)
        gains = mean[order[1]] - mean[order[0]]
        draws = source.choice(gains, (10000, len(pairs))).mean(axis=1)
        low, high = np.percentile(draws, [2.5, 97.5])
        print(f"best against second: {gains.mean():.3f} in mean log rank, 95% [{low:.3f}, {high:.3f}]")


def compare_temperatures(decoys):
    print("T / best   mean log rank, clusters in the first 1, 10, 100, 1000")
    for share in TEMPERATURES:
        ranks = {}
        for key, rows in decoys.items():
            scores, clusters = rows[:, SCORE], rows[:, CLUSTER]
            temperature = share * scores.max()
            values, acceptable = [], []
            for cluster in np.unique(clusters):
                members = np.flatnonzero(clusters == cluster)
                best = members[np.argmax(scores[members])]
                value = scores[best]
                if temperature > 0:
                    value += temperature * np.log(np.exp((scores[members] - value) / temperature).sum())
                values.append(value)
                acceptable.append(rows[best, ACCEPTABLE])
            ranks[key] = first_rank(np.array(values), np.array(acceptable))
        print(f"{share:8g}   {summary(ranks)}")


if __name__ == "__main__":
    main()
