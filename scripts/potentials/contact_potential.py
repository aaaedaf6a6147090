#!/usr/bin/env python3
"""Derives the contact potential of knotdock from complexes of known structure.

    python3 scripts/potentials/contact_potential.py DIR [--fine] [--decoys RUNS] [--split fit] [--without-fold K/N]
        [--exclude ID,...] [-o FILE]

DIR is a benchmark folder (scripts/docked_pairs.py); the pairs of the split give the statistics. Energies are
e_ab = -ln(n_ab / m_ab) in units of RT. The n_ab are the contacts of types a and b across the bound interfaces, each
complex with the same weight. They are counted as the score counts them: 1 up to 5 A, falling smoothly to 0 at 7 A. The
m_ab are those of a reference state with as many contacts:

- without --decoys: pairs of surface atoms at random, m_ab = s_a s_b, s the share of a type among the
  solvent-accessible surface areas;
- with --decoys: the contacts of docked poses, which keeps shape out of the potential (DARS, Chuang, Kozakov, Brenke,
  Comeau & Vajda, Biophys. J. 95 (2008) 4217-4227). RUNS is the --out folder of a `benchmark.py` run with
  `-- --effects shape` on the same pairs; the poses of --ranks are taken.

A pseudocount of --pseudocount expected contacts per pair of types tempers rare ones. The mean over all contacts of
the reference state is taken out, so that the potential does not count shape again. Of the table's eigenvectors (types
weighted by their share of the contacts) the strongest --rank are kept: each further one costs a transform in the
search.

With --fine the table has three ranges of distance, each with energies of its own and of full rank; poses are rescored
with it. Its decoys are best poses docked with all effects, since those are what it must separate from the answer.

Needs Python 3.9 or later and NumPy.
"""

import argparse
import csv
import datetime
import re
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import ROOT, check_known, find_part, fold, in_fold, names, read_text, select, write

TYPES_FILE = ROOT / "structures/src/molecule/chemistry/amino_acids.csv"
TYPES = "N CA C O GCA CB KNZ KCD DOD RNH NNN RNE SOG HNE YCZ FCZ LCD CSG".split()
TAPER = (5.0, 7.0)  # A, as in scoring/src/terms/effect/contact.rs
RANGES = {
    "near": (3.5, 4.5),
    "middle": (5.0, 6.0),
    "far": (7.0, 8.0),
}  # ends in A, as in scoring/src/terms/pose/fine_contact.rs
PROBE = 1.4  # A
RADII = {"C": 1.8, "N": 1.64, "O": 1.44, "S": 1.77}  # A


def main():
    options = parse_arguments()
    kinds = read_types()
    pairs = selected(options)
    count = fine_contacts if options.fine else contacts
    native, reference, used = [], [], []
    for pair in pairs:
        folder = options.folder / pair
        receptor, ligand = (read_atoms(find_part(folder, f"{side}_bound"), kinds) for side in ("receptor", "ligand"))
        counts = count(receptor, ligand)
        if (counts.sum(axis=(-2, -1)) == 0).any():
            print(f"{pair}: no contacts, left out", file=sys.stderr)
            continue
        if options.decoys:
            expected = decoy_contacts(options, folder, pair, kinds, count)
            if expected is None:
                print(f"{pair}: no decoys, left out", file=sys.stderr)
                continue
        else:
            expected = np.outer(surface(receptor), surface(ligand))
        used.append(pair)
        native.append(shares(counts))
        reference.append(shares(expected))
    if not used:
        sys.exit("no complex can be used")
    native, reference = (shares(sum(parts)) for parts in (native, reference))
    # Shares of all contacts, about 1,000 a complex and range. A pair of types that is expected less often than the
    # pseudocount counts for less.
    scale = 1000.0 * len(used)
    energies = -np.log((native * scale + options.pseudocount) / (reference * scale + options.pseudocount))
    energies -= (energies * reference).sum(axis=(-2, -1), keepdims=True)
    if not options.fine:
        energies = low_rank(energies, reference.sum(axis=0), options.rank)
    write_table(options, used, energies)


def shares(counts):
    """Symmetric, with a sum of one (in each range)."""
    return 0.5 * (counts + counts.swapaxes(-2, -1)) / counts.sum(axis=(-2, -1), keepdims=True)


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    pair_arguments(parser)
    parser.add_argument(
        "--decoys",
        type=Path,
        metavar="RUNS",
        help="output folder of benchmark.py; without, the reference is the surface",
    )
    parser.add_argument(
        "--ranks",
        type=lambda text: tuple(map(int, text.split("-"))),
        default=(1, 1000),
        help="ranks of the decoys (default: 1-1000)",
    )
    parser.add_argument(
        "--poses", type=int, default=50, help="decoys taken of each run, evenly over the ranks (default: 50)"
    )
    parser.add_argument("--fine", action="store_true", help="a table by ranges of distance, for rescoring")
    parser.add_argument("--pseudocount", type=float, help="expected contacts (default: 50, with --fine 20)")
    parser.add_argument("--rank", type=int, default=4, help="eigenvectors kept (default: 4)")
    parser.add_argument("-o", "--output", type=Path, help="default: the program's own table")
    options = parser.parse_args()
    if options.pseudocount is None:
        options.pseudocount = 20.0 if options.fine else 50.0
    if options.output is None:
        options.output = (
            ROOT
            / "scoring/src"
            / ("terms/pose/fine_contact_potential.csv" if options.fine else "terms/effect/contact_potential.csv")
        )
    return options


def pair_arguments(parser):
    """The options that say which pairs the statistics are of, for `select`."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="benchmark folder")
    parser.add_argument(
        "--split",
        default="fit",
        choices=("train", "fit"),
        help="pairs to use (default: fit, train without relatives in eval)",
    )
    parser.add_argument(
        "--without-fold",
        type=fold,
        help="K/N: leave out the pairs of `benchmark.py --fold K/N` (no --ids) of the same split, for cross-validation",
    )
    parser.add_argument("--exclude", type=names, default=[], help="pairs to leave out, for cross-validation")


def selected(options):
    """Ids of the pairs that the options choose, in order."""
    rows = select(options.folder, options.split)
    check_known(options.exclude, rows, options.split)
    left_out = set(options.exclude)
    if options.without_fold:
        left_out |= {pair["id"] for pair in in_fold(rows, *options.without_fold)}
    return sorted({pair["id"] for pair in rows} - left_out)


def read_types():
    with open(TYPES_FILE, newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {(row["residue"], row["atom"]): TYPES.index(row["type"]) for row in rows}


def read_atoms(path, kinds):
    """Positions, types (-1: none) and radii of the heavy atoms of the first model."""
    positions, types, radii = [], [], []
    for line in read_text(path).split("\nENDMDL")[0].splitlines():
        if not line.startswith(("ATOM  ", "HETATM")) or line[16] not in " A1":
            continue
        name, residue = line[12:16].strip(), line[17:20].strip()
        element = re.sub(r"[^A-Z]", "", name)[:1]
        if element in ("H", "D") or residue in ("HOH", "WAT", "DOD"):
            continue
        positions.append([float(line[start : start + 8]) for start in (30, 38, 46)])
        types.append(kinds.get((residue, name), -1))
        radii.append(RADII.get(element, 1.7))
    return np.array(positions), np.array(types), np.array(radii)


def smooth_step_down(x, start, stop):
    u = np.clip((x - start) / (stop - start), 1e-9, 1 - 1e-9)
    return 1.0 / (1.0 + np.exp(np.clip(1.0 / (1.0 - u) - 1.0 / u, -700, 700)))


def neighbours(points, others, reach):
    """Pairs (i, j) within reach, by a grid of cells."""
    low = np.minimum(points.min(0), others.min(0)) - reach
    cells = {}
    for index, cell in enumerate(map(tuple, ((others - low) // reach).astype(int))):
        cells.setdefault(cell, []).append(index)
    first, second = [], []
    for index, (x, y, z) in enumerate(((points - low) // reach).astype(int)):
        near = [
            member
            for dx in (-1, 0, 1)
            for dy in (-1, 0, 1)
            for dz in (-1, 0, 1)
            for member in cells.get((x + dx, y + dy, z + dz), ())
        ]
        first += [index] * len(near)
        second += near
    first, second = np.array(first, dtype=int), np.array(second, dtype=int)
    distances = np.linalg.norm(points[first] - others[second], axis=1)
    keep = distances < reach
    return first[keep], second[keep], distances[keep]


def contacts(receptor, ligand):
    """Smoothly counted contacts by type."""
    counts = np.zeros((len(TYPES), len(TYPES)))
    first, second, distances = neighbours(ligand[0], receptor[0], TAPER[1])
    a, b = receptor[1][second], ligand[1][first]
    known = (a >= 0) & (b >= 0)
    np.add.at(counts, (a[known], b[known]), smooth_step_down(distances[known], *TAPER))
    return counts


def step_down(x, start, stop):
    u = np.clip((x - start) / (stop - start), 0.0, 1.0)
    return 1.0 - u**3 * (10.0 + u * (6.0 * u - 15.0))


def fine_contacts(receptor, ligand):
    """Smoothly counted contacts by range and type."""
    counts = np.zeros((len(RANGES), len(TYPES), len(TYPES)))
    first, second, distances = neighbours(ligand[0], receptor[0], max(stop for _, stop in RANGES.values()))
    a, b = receptor[1][second], ligand[1][first]
    known = (a >= 0) & (b >= 0)
    before = 0.0
    for table, ends in zip(counts, RANGES.values()):
        step = step_down(distances[known], *ends)
        np.add.at(table, (a[known], b[known]), step - before)
        before = step
    return counts


def surface(atoms):
    """Accessible area by type (Shrake & Rupley, J. Mol. Biol. 79 (1973) 351-371, 60 points an atom)."""
    positions, types, radii = atoms
    k = np.arange(60) + 0.5
    height, turn = 1 - k / 30, np.pi * (1 + 5**0.5) * k
    side = np.sqrt(1 - height**2)
    sphere = np.stack([side * np.cos(turn), side * np.sin(turn), height], axis=1)
    grown = radii + PROBE
    first, second, _ = neighbours(positions, positions, 2 * grown.max())
    starts = np.searchsorted(first, np.arange(len(positions) + 1))
    shares = np.zeros(len(TYPES))
    for index, kind in enumerate(types):
        if kind < 0:
            continue
        near = second[starts[index] : starts[index + 1]]
        near = near[near != index]
        points = positions[index] + grown[index] * sphere
        gaps = np.linalg.norm(points[:, None] - positions[near][None], axis=2)
        free = (gaps >= grown[near]).all(axis=1).mean()
        shares[kind] += free * grown[index] ** 2
    return shares


def decoy_contacts(options, folder, pair, kinds, count):
    """Contacts over the poses of all runs of a pair."""
    total = 0.0
    for run in sorted((options.decoys / pair).glob("seed_*")):
        table = run / "run/poses.csv"
        if not table.exists():
            continue
        receptor = read_atoms(find_part(folder, "receptor_unbound"), kinds)
        positions, types, radii = read_atoms(run / "ligand_rotated.pdb", kinds)
        with open(table, newline="") as file:
            rows = [row for row in csv.DictReader(file) if options.ranks[0] <= int(row["rank"]) <= options.ranks[1]]
        for row in rows[:: max(1, len(rows) // options.poses)]:
            w, x, y, z = (float(row[f"q{axis}"]) for axis in "wxyz")
            rotation = np.array(
                [
                    [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                    [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                    [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
                ]
            )
            placed = positions @ rotation.T + [float(row[f"t{axis}"]) for axis in "xyz"]
            total = total + count(receptor, (placed, types, radii))
    return total if np.sum(total) > 0 else None


def low_rank(energies, shares, rank):
    """The symmetric table of a rank that is nearest in the mean over contacts of types with these shares."""
    root = np.sqrt(np.maximum(shares, 1e-6))
    values, vectors = np.linalg.eigh(root[:, None] * energies * root[None, :])
    kept = np.argsort(-np.abs(values))[:rank]
    nearest = (vectors[:, kept] * values[kept]) @ vectors[:, kept].T / root[:, None] / root[None, :]
    return 0.5 * (nearest + nearest.T)


def write_table(options, used, energies):
    reference = (
        f"docked poses of ranks {options.ranks[0]}-{options.ranks[1]}" if options.decoys else "surface composition"
    )
    detail = "full rank" if options.fine else f"rank {options.rank}"
    lines = [
        "# Contact potential in units of RT, -ln(observed / expected), mean removed; lower is better.",
        f"# Written by scripts/potentials/contact_potential.py on {datetime.date.today()}; reference: {reference}; "
        f"pseudocount {options.pseudocount:g}; {detail}.",
        f"# {len(used)} bound complexes of Docking Benchmark 5 (Vreven et al., J. Mol. Biol. 427 (2015) 3031-3041): "
        f"{' '.join(used)}",
        ("range," if options.fine else "") + "type," + ",".join(TYPES),
    ]
    tables = [(f"{name},", table) for name, table in zip(RANGES, energies)] if options.fine else [("", energies)]
    for prefix, table in tables:
        lines += [f"{prefix}{name}," + ",".join(f"{value:.6f}" for value in row) for name, row in zip(TYPES, table)]
    write(options.output, "\n".join(lines) + "\n")
    print(f"{len(used)} complexes; table in {options.output}", file=sys.stderr)


if __name__ == "__main__":
    main()
