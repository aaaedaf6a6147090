#!/usr/bin/env python3
"""Ranks the poses of benchmark runs again with other weights, and chooses weights by cross-validation over pairs.

    python3 scripts/fit_weights.py DIR RUNS [RUNS ...] [--knotdock PROGRAM] [--lambdas 8,9,10] [--electrostatics 0,16,24,32] [--contact 0,1,2,3]
                                   [--fine 0,1,2,3] [--pairs 0,1,2,3]

DIR is the benchmark folder; each RUNS is the --out folder of a `scripts/benchmark.py` run on training pairs, best without refinement
(poses were climbed by the weights of their run). A pose's terms and slices are linear in the weights, and so are the fine contact
and atom pair potentials that it is rescored with, so its score under others needs no docking; the poses of a pair and turn in all RUNS are pooled. How near each pose is to the answer is measured once and kept
beside its run (`quality.json`).

Printed, for every combination: mean log rank of the first acceptable pose (5,000 where there is none), and pairs with one in the
first 1, 10, 100, 1000, as means over turns; then the same for weights chosen for each fold of the pairs on the others, which is what
a choice like this is worth on pairs that it has not seen; then a bootstrap interval over pairs of the difference between the two
best combinations. With --clusters temperatures are compared instead, at the runs' own weights: clusters ordered by
T ln sum exp(score / T), T a share of the run's best score (0: the best pose alone).

Needs Python 3.9 or later and NumPy.
"""

import argparse
import csv
import itertools
import json
import subprocess
from pathlib import Path

import numpy as np

from whole_file import write

DEPTHS = (1, 10, 100, 1000)
NOT_FOUND = 5000
FEATURES = ("slice_0", "slice_r0", "slice_2r0")
TEMPERATURES = (0.0, 0.02, 0.04, 0.06, 0.08, 0.1, 0.15, 0.2, 0.3)


def main():
    options = parse_arguments()
    pooled = {}
    for runs in options.runs:
        for record in sorted(runs.glob("*/seed_*/result.json")):
            pair, seed = record.parent.parent.name, record.parent.name
            if (record.parent / "run/run.json").exists():
                pooled.setdefault((pair, seed), []).append(load(options, record.parent, pair))
    decoys = {key: np.concatenate(parts) for key, parts in pooled.items() if len(parts) == len(options.runs)}
    if not decoys:
        raise SystemExit("no pair is in all runs")
    pairs = sorted({pair for pair, _ in decoys})
    print(f"{len(pairs)} pairs, {len(decoys)} runs, {sum(map(len, decoys.values()))} poses\n")
    compare_temperatures(decoys) if options.clusters else compare_weights(options, decoys, pairs)


def parse_arguments():
    numbers = lambda text: [float(part) for part in text.split(",")]
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=Path, metavar="DIR", help="benchmark folder")
    parser.add_argument("runs", type=Path, nargs="+", metavar="RUNS", help="output folder of benchmark.py")
    parser.add_argument("--knotdock", default="knotdock", help="the program (default: the one on the path)")
    parser.add_argument("--lambdas", type=numbers, default=[8.0, 9.0, 10.0, 11.0])
    parser.add_argument("--electrostatics", type=numbers, default=[0.0, 8.0, 16.0, 24.0, 32.0])
    parser.add_argument("--contact", type=numbers, default=[0.0, 0.8, 1.5, 2.0, 2.5, 3.0])
    parser.add_argument("--fine", type=numbers, default=[0.0, 1.0, 2.0, 3.0])
    parser.add_argument("--pairs", type=numbers, default=[0.0, 1.0, 2.0, 3.0])
    parser.add_argument("--folds", type=int, default=5)
    parser.add_argument("--clusters", action="store_true", help="compare temperatures of clusters")
    return parser.parse_args()


def load(options, folder, pair):
    """Rows of slices, unweighted electrostatics, contact, fine contact and atom pairs, acceptable (0 or 1), rank score, cluster."""
    quality = folder / "quality.json"
    table = folder / "run/poses.csv"
    if not quality.exists() or quality.stat().st_mtime < table.stat().st_mtime:
        native = []
        for side in ("receptor", "ligand"):
            paths = (options.folder / pair / f"{side}_bound{ending}" for ending in (".pdb", ".pdb.gz"))
            native += [f"--native-{side}", str(next(path for path in paths if path.exists()))]
        command = [options.knotdock, "evaluate", str(folder / "run"), *native, "--json", "--quiet"]
        answer = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
        near = lambda value, limit: value is not None and value <= limit
        found = {pose["rank"]: near(pose["lrmsd"], 10.0) or near(pose["irmsd"], 4.0) for pose in answer["poses"]}
        write(quality, json.dumps(found))
    found = json.loads(quality.read_text())
    weights = json.loads((folder / "run/run.json").read_text())["options"]
    rows = []
    with open(table, newline="") as file:
        for row in csv.DictReader(file):
            terms = [
                float(row.get(name) or 0) / (weights.get(f"{name}_weight") or 1.0)
                for name in ("electrostatics", "contact", "fine_contact", "atom_pair")
            ]
            score = float(row.get("rank_score") or row["score"])
            rows.append([*(float(row[name]) for name in FEATURES), *terms, found[row["rank"]], score, float(row["cluster"])])
    return np.array(rows, dtype=float)


def first_rank(scores, acceptable):
    ranked = np.flatnonzero(acceptable[np.argsort(-scores, kind="stable")])
    return ranked[0] + 1 if len(ranked) else NOT_FOUND


def summary(decoys, ranks):
    turns = len(decoys) / len({pair for pair, _ in decoys})
    values = np.array([ranks[key] for key in decoys], dtype=float)
    found = "  ".join(f"{np.sum(values <= depth) / turns:5.1f}" for depth in DEPTHS)
    return f"{np.mean(np.log(np.minimum(values, NOT_FOUND))):.3f}  {found}"


def compare_weights(options, decoys, pairs):
    grid = list(itertools.product(options.lambdas, options.electrostatics, options.contact, options.fine, options.pairs))
    ranks = {}
    for weights in grid:
        strength, *terms = weights
        factors = np.array([-strength * strength, 2 * strength, -1.0, *terms])
        ranks[weights] = {key: first_rank(rows[:, :7] @ factors, rows[:, 7]) for key, rows in decoys.items()}
    log = lambda weights, key: np.log(min(ranks[weights][key], NOT_FOUND))
    mean = lambda weights, keys: np.mean([log(weights, key) for key in keys])
    order = sorted(grid, key=lambda weights: mean(weights, decoys))
    print("lambda  electrostatics  contact     fine    pairs   mean log rank, top 1, 10, 100, 1000")
    for weights in order:
        print(f"{weights[0]:6g}  {weights[1]:14g}  {weights[2]:7g}  {weights[3]:7g}  {weights[4]:7g}   {summary(decoys, ranks[weights])}")
    chosen = {}
    for fold in range(options.folds):
        inside = {pair for index, pair in enumerate(pairs) if index % options.folds == fold}
        others = [key for key in decoys if key[0] not in inside]
        best = min(grid, key=lambda weights: mean(weights, others))
        chosen.update({key: ranks[best][key] for key in decoys if key[0] in inside})
        print(f"fold {fold}: {best} chosen on the others")
    print(f"cross-validated                                     {summary(decoys, chosen)}")
    if len(order) > 1:
        source = np.random.default_rng(1)
        gains = np.array(
            [np.mean([log(order[1], key) - log(order[0], key) for key in decoys if key[0] == pair]) for pair in pairs]
        )
        draws = source.choice(gains, (10000, len(pairs))).mean(axis=1)
        low, high = np.percentile(draws, [2.5, 97.5])
        print(f"best against second: {gains.mean():.3f} in mean log rank, 95% [{low:.3f}, {high:.3f}]")


def compare_temperatures(decoys):
    print("T / best   mean log rank, clusters in the first 1, 10, 100, 1000")
    for share in TEMPERATURES:
        ranks = {}
        for key, rows in decoys.items():
            scores, clusters = rows[:, 8], rows[:, 9]
            temperature = share * scores.max()
            values, acceptable = [], []
            for cluster in np.unique(clusters):
                members = np.flatnonzero(clusters == cluster)
                best = members[np.argmax(scores[members])]
                value = scores[best]
                if temperature > 0:
                    value += temperature * np.log(np.exp((scores[members] - value) / temperature).sum())
                values.append(value)
                acceptable.append(rows[best, 7])
            ranks[key] = first_rank(np.array(values), np.array(acceptable))
        print(f"{share:8g}   {summary(decoys, ranks)}")


if __name__ == "__main__":
    main()
