#!/usr/bin/env python3
"""Calibrates the chance, told by `knotdock dock`, that one of a run's first ten clusters is acceptable.

    python3 scripts/calibrate_chance.py DIR RUNS [RUNS ...] --eval RUNS [--plot docs/images/reliability.svg] [--page docs/ranking.md]

DIR is the benchmark folder. RUNS are --out folders of `scripts/benchmark.py` with the default effects: on training pairs without a
relative in eval (split `fit`), each docked with contact potentials derived without it, and under --eval on eval pairs as the
program is. A training run whose tables name its pair is refused. All turns of a pair (seeds) stand or fall together, and each pair counts once.

A run is a success if the best pose of one of its first ten clusters has a ligand RMSD <= 10 A or an interface RMSD <= 4 A. Its chance
is a logistic regression on figures of those clusters (FEATURES), whose slopes, for features of unit variance, have a normal prior of
unit variance; the intercept has none. CANDIDATES, each written down before it was fitted, are compared by log loss with each pair left
out in turn. Taken is the one with the fewest features whose loss is within a standard error of the lowest (Breiman, Friedman, Olshen
and Stone, Classification and Regression Trees, 1984, section 3.4.3), fitted once more to all pairs. What choosing is worth on a pair
that had no say is told by choosing anew for each pair on the others. The AUC on training pairs leaves out both pairs of every
comparison (Airola et al., Comput. Stat. Data Anal. 55 (2011) 1828-1844): with one left out, a chance that knows nothing falls with
that pair's success and would rank backwards. On eval nothing is chosen or fitted.

Told, as Markdown, on standard output or as what follows "## Figures" on a page: each candidate's figures, those on eval, bins of the
plot, and the constants for src/search/chance.rs. probability_scores.py says how figures and intervals are taken.

Needs Python 3.9 or later and NumPy.
"""

import argparse
import csv
import hashlib
import json
import math
import sys
from pathlib import Path

import numpy as np

from probability_scores import bins, comparisons, log_loss, measures
from reliability_plot import draw
from whole_file import write

DEPTH = 10
# Tables that the program carries, used where a run names no other.
CARRIED = {
    "--contact-potential": "scoring/src/terms/effect/contact_potential.csv",
    "--fine-contact-potential": "scoring/src/terms/pose/fine_contact_potential.csv",
    "--atom-pair-potential": "scoring/src/terms/pose/atom_pair_potential.csv",
}
COLUMNS = ("cluster", "cluster_size", "cluster_score", "z_score", "rank_score", "contact", "fine_contact", "atom_pair", "relaxed")
ON = {"shape", "electrostatics", "contact"}  # as src/search/chance.rs has it
POTENTIALS = ("contact", "fine_contact", "atom_pair", "relaxed")
# Recorded options in which runs may differ.
FREE = {"contact_potential", "fine_contact_potential", "atom_pair_potential", "every_pose", "write_top"}
# Of the first ten clusters, best pose each, in order; none depends on the unit of the score.
FEATURES = {
    # How far the best cluster stands out of the run's poses.
    "top_z": lambda top, counts: top[0]["z_score"],
    # How far the ten do.
    "mean_z": lambda top, counts: sum(row["z_score"] for row in top) / DEPTH,
    # How far the tenth falls behind the first.
    "drop": lambda top, counts: 1 - top[-1]["cluster_score"] / top[0]["cluster_score"],
    # How many poses gathered about the ten.
    "company": lambda top, counts: math.log(sum(row["cluster_size"] for row in top) / DEPTH),
    # How many did about any.
    "crowding": lambda top, counts: math.log(counts["poses"] / counts["clusters"]),
    # How much of the ten's scores is contact potential, which was made to tell native contacts from others.
    "contacts": lambda top, counts: sum(sum(row[term] for term in POTENTIALS) / row["rank_score"] for row in top) / DEPTH,
}
# The first is the base rate. Those with `contacts` joined after a look at the others on 38 of the pairs.
CANDIDATES = (
    (),
    ("top_z",),
    ("mean_z",),
    ("drop",),
    ("company",),
    ("crowding",),
    ("top_z", "company"),
    ("top_z", "crowding"),
    ("drop", "company"),
    ("drop", "crowding"),
    ("top_z", "drop", "crowding"),
    ("contacts",),
    ("contacts", "crowding"),
)


def main():
    options = parse_arguments()
    with open(options.folder / "manifest.csv", newline="") as file:
        manifest = {row["id"]: row for row in csv.DictReader(file)}
    seen = {}
    train = Sample(read_runs(options.runs, manifest, "fit", seen))
    evaluation = Sample(read_runs(options.eval, manifest, "eval", seen))
    left_out = {candidate: predict_left_out(train, candidate, train.pairs) for candidate in CANDIDATES}
    best = choose(train, left_out, train.pairs)
    base = left_out[()]
    table = [(name(candidate), chances, comparisons_left_out(train, candidate)) for candidate, chances in left_out.items()]
    table.append(("chosen anew for each pair", predict_chosen(train), None))
    lines = [f"Training: {train.told()}. Each pair left out in turn:", "", *measures(train, table, base), ""]
    lines += [f"Chosen: {name(best)}.", "", f"Eval: {evaluation.told()}. Fitted to all training pairs:", ""]
    models = {name(candidate): fit(train, candidate, train.pairs) for candidate in ((), best)}
    told = {label: chance(evaluation, model) for label, model in models.items()}
    lines += measures(evaluation, [(label, chances, comparisons(evaluation, chances)) for label, chances in told.items()], told[name(())])
    series = [("training, each pair left out", bins(train, left_out[best])), ("eval", bins(evaluation, told[name(best)]))]
    if not best:
        # What it would look like to tell pairs apart all the same.
        tempting = min(CANDIDATES[1:], key=lambda candidate: losses(train, left_out[candidate], train.pairs).sum())
        series.append((f"training, by {name(tempting)}: not taken", bins(train, left_out[tempting])))
    lines += ["", "| pairs of | chance told | mean | share found | pairs |", "|---|---|---|---|---|"]
    for label, rows in series:
        for low, high, mean, share, interval, pairs in rows:
            found = f"{share:.0%} [{interval[0]:.0%}, {interval[1]:.0%}]"
            lines.append(f"| {label} | {low:.0%}-{high:.0%} | {mean:.0%} | {found} | {pairs:.1f} |")
    lines += ["", *rust(train, models[name(best)]), ""]
    tell(options, "\n".join(lines), draw(series))


def tell(options, text, plot):
    if options.plot:
        write(options.plot, plot)
    if options.page:
        head, heading, _ = options.page.read_text().partition("\n## Figures\n")
        if not heading:
            raise SystemExit(f'{options.page} has no heading "## Figures"')
        write(options.page, f"{head}{heading}\n{text}")
    else:
        print(text, end="")


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", type=Path, metavar="DIR", help="benchmark folder")
    parser.add_argument("runs", type=Path, nargs="+", metavar="RUNS", help="output folder of benchmark.py on training pairs")
    parser.add_argument("--eval", type=Path, nargs="+", required=True, metavar="RUNS", help="the same on eval pairs")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="write the reliability plot (SVG)")
    parser.add_argument("--page", type=Path, metavar="FILE", help="put the figures on this page")
    return parser.parse_args()


def name(candidate):
    return ", ".join(candidate) or "base rate"


def read_runs(folders, manifest, split, seen):
    """(pair, features, success) of every run in some folders; a turn of a pair counts once."""
    records = {record.parts[-3:]: record for folder in folders for record in folder.glob("*/seed_*/result.json")}
    for (pair, _, _), record in sorted(records.items()):
        result = json.loads(record.read_text())
        if "error" in result:
            print(f"{pair}, {record.parent.name} failed and is left out: {result['error']}", file=sys.stderr)
            continue
        row = manifest[pair]
        here = "eval" if row["split"] == "eval" else "train" if row["near_eval"].strip() else "fit"
        if here != split:
            raise SystemExit(f"{record} is of split {here}, not {split}")
        if split == "fit":
            refuse_leak(pair, result["settings"])
        run = json.loads((record.parent / "run/run.json").read_text())
        for option, value in run["options"].items():
            if option not in FREE and seen.setdefault(option, value) != value:
                raise SystemExit(f"{record} was docked with {option} {value}, another run with {seen[option]}")
        on = {effect["effect"] for effect in run["effects"] if effect["on"]}
        if on != ON:
            print(f"{pair} is left out: {', '.join(sorted(on ^ ON))} on or off where the others are not", file=sys.stderr)
            continue
        with open(record.parent / "run/poses.csv", newline="") as file:
            rows = [{key: float(row[key]) for key in COLUMNS} for row in csv.DictReader(file)]
        # Rows come best first, so the first of a cluster is its best.
        clusters = {}
        for row in rows:
            clusters.setdefault(row["cluster"], row)
        top = [clusters[number] for number in range(1, DEPTH + 1)]
        features = {feature: figure(top, run["results"]) for feature, figure in FEATURES.items()}
        yield pair, features, (result["clusters"]["acceptable"] or math.inf) <= DEPTH


def refuse_leak(pair, settings):
    """Ends where a potential was derived from the pair itself, or cannot be read as it was."""
    given, tables = settings["options"], settings.get("tables", {})
    for option, carried in CARRIED.items():
        path = Path(given[given.index(option) + 1]) if option in given else Path(__file__).parent.parent / carried
        if option in given and tables.get(str(path)) != hashlib.sha256(path.read_bytes()).hexdigest():
            raise SystemExit(f"{path} is no longer the table with which {pair} was docked")
        with open(path) as file:
            if any(pair in line.split() for line in file if line.startswith("#")):
                raise SystemExit(f"{path}, with which {pair} was docked, was derived from {pair}, too")


class Sample:
    """Runs as arrays: the `pair` (index), `success` and `features` of each, and its `weight`, which adds up to one for a pair."""

    def __init__(self, runs):
        rows = list(runs)
        names = sorted({pair for pair, _, _ in rows})
        self.pairs = np.arange(len(names))
        self.pair = np.array([names.index(pair) for pair, _, _ in rows])
        self.success = np.array([success for _, _, success in rows], dtype=float)
        self.features = {feature: np.array([features[feature] for _, features, _ in rows]) for feature in FEATURES}
        self.weight = 1 / np.bincount(self.pair)[self.pair]

    def columns(self, candidate):
        return np.column_stack([np.ones(len(self.pair)), *(self.features[feature] for feature in candidate)])

    def told(self):
        found = self.weight @ self.success
        return f"{len(self.pairs)} pairs in {len(self.pair)} runs, of which {found:.1f} pairs ({found / len(self.pairs):.0%}) succeed"


def fit(sample, candidate, pairs):
    """The candidate with its intercept and slopes, by Newton's method on the penalised log likelihood of some pairs."""
    inside = np.isin(sample.pair, pairs)
    columns, weight, success = sample.columns(candidate)[inside], sample.weight[inside], sample.success[inside]
    mean = weight @ columns / weight.sum()
    scale = np.sqrt(weight @ (columns - mean) ** 2 / weight.sum())
    mean[0], scale[0] = 0, 1
    columns = (columns - mean) / scale
    prior = np.diag([0.0] + [1.0] * len(candidate))
    slopes = np.zeros(len(prior))
    for _ in range(50):
        chances = logistic(columns @ slopes)
        gradient = columns.T @ (weight * (success - chances)) - prior @ slopes
        curvature = (columns * (weight * chances * (1 - chances))[:, None]).T @ columns + prior
        step = np.linalg.solve(curvature, gradient)
        slopes = slopes + step
        if np.abs(step).max() < 1e-10:
            break
    slopes = slopes / scale
    slopes[0] -= slopes[1:] @ mean[1:]
    return candidate, slopes


def logistic(logit):
    return 1 / (1 + np.exp(-logit))


def chance(sample, model):
    candidate, slopes = model
    return logistic(sample.columns(candidate) @ slopes)


def predict_left_out(sample, candidate, pairs):
    """Chance of each run by a fit to the other pairs of some; of runs of no such pair it is not a number."""
    chances = np.full(len(sample.pair), np.nan)
    for pair in pairs:
        runs = sample.pair == pair
        chances[runs] = chance(sample, fit(sample, candidate, pairs[pairs != pair]))[runs]
    return chances


def choose(sample, left_out, pairs):
    """The candidate with the fewest features within a standard error of the lowest loss; of several the one with the lowest."""
    of = {candidate: losses(sample, chances, pairs) for candidate, chances in left_out.items()}
    lowest = min(of.values(), key=np.sum)
    within = lambda loss: np.mean(loss - lowest) <= np.std(loss - lowest, ddof=1) / math.sqrt(len(pairs))
    return min((candidate for candidate in of if within(of[candidate])), key=lambda candidate: (len(candidate), of[candidate].sum()))


def losses(sample, chances, pairs):
    """Log loss of each of some pairs."""
    inside = np.isin(sample.pair, pairs)
    return np.bincount(sample.pair[inside], (sample.weight * log_loss(sample, chances))[inside])[pairs]


def predict_chosen(sample):
    """Chance of each run by the candidate that leaving out in turn chooses on the other pairs."""
    chances = np.empty(len(sample.pair))
    for pair in sample.pairs:
        others = sample.pairs[sample.pairs != pair]
        best = choose(sample, {candidate: predict_left_out(sample, candidate, others) for candidate in CANDIDATES}, others)
        runs = sample.pair == pair
        chances[runs] = chance(sample, fit(sample, best, others))[runs]
    return chances


def comparisons_left_out(sample, candidate):
    """The same, each by a fit to all but the two runs' pairs."""
    wins = np.empty((len(sample.pair), len(sample.pair)))
    for first in sample.pairs:
        for second in sample.pairs[: first + 1]:
            runs = np.isin(sample.pair, (first, second))
            chances = chance(sample, fit(sample, candidate, np.setdiff1d(sample.pairs, (first, second))))[runs]
            wins[np.ix_(runs, runs)] = comparisons(sample, chances)
    return wins


def rust(train, model):
    candidate, (intercept, *slopes) = model
    lines = [f"// {len(train.pairs)} pairs in {len(train.pair)} runs."]
    if candidate:
        lines.append(f"const INTERCEPT: f64 = {intercept:.4f};")
        lines += [f"const {feature.upper()}_SLOPE: f64 = {slope:.4f};" for feature, slope in zip(candidate, slopes)]
    else:
        lines.append(f"pub const SHARE: f64 = {logistic(intercept):.3f};")
    return ["For src/search/chance.rs:", "", "```rust", *lines, "```"]


if __name__ == "__main__":
    main()
