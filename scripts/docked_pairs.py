"""The docking benchmark as every script here uses it: its pairs, what counts as found, and mean log ranks.

A benchmark folder holds `manifest.csv` (columns `id` and `split`; others are optional) and for each pair a folder
named by its id. That has `receptor_unbound` and `ligand_unbound` (docked), and `receptor_bound` and `ligand_bound`
(the known complex), each `.pdb` or `.pdb.gz`.

Splits: `eval`, `train`, `all`, and `fit`: the pairs of `train` without a relative in `eval` (column `near_eval`).

A pose is acceptable, or near-native, where `knotdock evaluate` says so: the scripts have no criterion of their own.
What is not found counts as rank 3,000 in every mean log rank.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import csv
import gzip
import json
import math
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SPLITS = ("eval", "train", "fit", "all")
PARTS = ("receptor_unbound", "ligand_unbound", "receptor_bound", "ligand_bound")
# Names of `knotdock evaluate --json`, true or false of each pose.
CRITERIA = ("acceptable", "near_native")
DEPTHS = (1, 10, 100, 1000)
NOT_FOUND = 3000


def fold(text):
    """K/N of a command line as two numbers."""
    part, count = map(int, text.split("/"))
    if not 0 <= part < count:
        raise argparse.ArgumentTypeError(f"{text} is not K/N with 0 <= K < N")
    return part, count


def names(text):
    """Names on a command line, separated by commas."""
    return text.split(",")


def select(folder, split):
    """Rows of the manifest that are in a split, in its order."""
    manifest = folder / "manifest.csv"
    if not manifest.is_file():
        raise SystemExit(f"{folder} holds no manifest.csv; scripts/docked_pairs.py says how the folder is laid out")
    with open(manifest, newline="") as file:
        pairs = list(csv.DictReader(file))
    if split == "fit":
        pairs = [pair for pair in pairs if pair["split"] == "train" and not pair.get("near_eval", "").strip()]
    elif split != "all":
        pairs = [pair for pair in pairs if pair["split"] == split]
    if not pairs:
        raise SystemExit(f"no pair in split {split}")
    return pairs


def check_known(wanted, pairs, split):
    """Exits where a name is not among the pairs of a split."""
    unknown = set(wanted) - {pair["id"] for pair in pairs}
    if unknown:
        raise SystemExit(f"not in split {split} of the manifest: {', '.join(sorted(unknown))}")


def in_fold(pairs, part, count):
    """Of pairs in order of their ids every `count`-th from the `part`-th on, from 0."""
    return sorted(pairs, key=lambda pair: pair["id"])[part::count]


def find_part(folder, part):
    """The file of one of PARTS."""
    for ending in (".pdb", ".pdb.gz"):
        path = folder / (part + ending)
        if path.exists():
            return path
    raise FileNotFoundError(f"no {part}.pdb or {part}.pdb.gz in {folder}")


def read_text(path):
    """Text of a file, plain or gzip."""
    data = path.read_bytes()
    return (gzip.decompress(data) if path.suffix == ".gz" else data).decode("latin-1")


def evaluate(knotdock, run, native):
    """Quality of each row of a run's `poses.csv` by `knotdock evaluate`, in the table's order.

    `native` holds the options that name the known complex. Each row has `rank`, `irmsd`, `lrmsd`, `fnat`, `dockq`,
    `capri` and whether it meets each of CRITERIA.
    """
    command = [knotdock, "evaluate", str(run), *native, "--json", "--quiet"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"evaluate: {done.stderr.strip() or done.returncode}")
    return json.loads(done.stdout)["poses"]


def native_options(folder):
    """Options of `knotdock evaluate` that name the known complex of a pair's folder."""
    sides = ("receptor", "ligand")
    return [word for side in sides for word in (f"--native-{side}", str(find_part(folder, f"{side}_bound")))]


def verdicts(knotdock, folder, pair):
    """Whether each pose of a run meets each of CRITERIA, by rank: measured once and kept beside the run.

    `folder` holds the run as benchmark.py leaves it, `pair` the files of the pair.
    """
    table, cache = folder / "run/poses.csv", folder / "verdicts.json"
    if cache.exists() and cache.stat().st_mtime >= table.stat().st_mtime:
        return json.loads(cache.read_text())
    poses = evaluate(knotdock, folder / "run", native_options(pair))
    found = {str(pose["rank"]): [pose[criterion] for criterion in CRITERIA] for pose in poses}
    write(cache, json.dumps(found))
    return found


def first_ranks(qualities):
    """The number of poses, and the 1-based rank of the first that meets each criterion (None: none does)."""
    ranks = {"count": len(qualities), **dict.fromkeys(CRITERIA)}
    for rank, pose in enumerate(qualities, 1):
        for criterion in CRITERIA:
            if pose[criterion] and ranks[criterion] is None:
                ranks[criterion] = rank
    return ranks


def ranks_of_run(knotdock, run, native):
    """The first ranks of a run's `poses` and `clusters`, each cluster by its best pose.

    The run lists every pose (`--no-cluster`); `native` is as in `evaluate`.
    """
    qualities = evaluate(knotdock, run, native)
    with open(run / "poses.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    # Rows come best first, so the first of a cluster is its best; clusters are numbered in their own order.
    clusters = {}
    for row, quality in zip(rows, qualities):
        clusters.setdefault(int(row["cluster"]), quality)
    of_clusters = [quality for _, quality in sorted(clusters.items())]
    return {"poses": first_ranks(qualities), "clusters": first_ranks(of_clusters)}


def log_rank(rank):
    """Logarithm of a rank; None and infinity are ranks of poses that were not found."""
    return math.log(min(rank or math.inf, NOT_FOUND))


def write(path, text):
    """Writes a whole file: an interrupted script leaves the older one or none, and no part of one."""
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text)
    partial.replace(path)
