#!/usr/bin/env python3
"""Derives the atom pair potential of knotdock from the insides of proteins.

    python3 scripts/potentials/atom_pair_potential.py DIR [--split fit] [--without-fold K/N] [--exclude ID,...]
        [-o FILE]

DIR is a benchmark folder (scripts/docked_pairs.py); the unbound proteins of the split's pairs, each by itself, give
the statistics.

Kinds are the atoms of each amino acid by themselves, those alike by symmetry as one
(structures/src/molecule/chemistry/amino_acids.csv). Counted are pairs of atoms whose residues are at least
--separation places from each other in the file, in shells of 0.5 A about the table's distances, the first one down
to 0.

In each shell the energy of kinds a and b is e_ab = -ln((n_ab + c) / (m_ab + c)) in units of RT. Here n_ab counts the
pairs found, m_ab = p_a p_b n counts those of a reference state in which kinds pair at random, and c is a pseudocount.
Both counts take a pair from both sides.

p is the share of a kind, x^B y^(1 - B), with B the --burial:
- x, the share among all atoms (mole fractions of Zhang, Vasmatzis, Cornette & DeLisi, J. Mol. Biol. 267 (1997)
  707-726). Energies then also say how buried a kind is.
- y, the share among all partners of pairs (quasi-chemical approximation, Miyazawa & Jernigan, J. Mol. Biol. 256 (1996)
  623-644). Energies then say only which kinds prefer each other.
The core of a protein buries more than an interface does, so B is between.

Needs Python 3.9 or later and NumPy.
"""

import argparse
import csv
import datetime
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from contact_potential import TYPES_FILE, neighbours, pair_arguments, selected
from docked_pairs import ROOT, find_part, read_text, write

DISTANCES = (3.25, 3.75, 4.25, 4.75, 5.25, 5.75)  # A, as in scoring/src/terms/pose/atom_pair.rs
STEP = 0.5  # A


def main():
    options = parse_arguments()
    kinds, names = read_kinds()
    pairs = selected(options)
    found = np.zeros((len(DISTANCES), len(names), len(names)))
    atoms_of = np.zeros(len(names))
    for pair in pairs:
        for side in ("receptor", "ligand"):
            positions, types, residues = read_atoms(find_part(options.folder / pair, f"{side}_unbound"), kinds)
            atoms_of += np.bincount(types, minlength=len(names))
            found += count(positions, types, residues, options.separation, len(names))
    write_table(
        options, pairs, names, energies_of(found, atoms_of, options.burial, options.pseudocount), found.sum() / 2
    )


def energies_of(found, atoms_of, burial, pseudocount):
    """Energies in RT by shell and kinds, from pairs found (by shell and kinds, from both sides) and atoms by kind."""
    partners = found.sum(axis=(0, 1))
    shares = (atoms_of / atoms_of.sum()) ** burial * (partners / partners.sum()) ** (1.0 - burial)
    shares /= shares.sum()
    expected = np.outer(shares, shares) * found.sum(axis=(1, 2), keepdims=True)
    return -np.log((found + pseudocount) / (expected + pseudocount))


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    pair_arguments(parser)
    parser.add_argument(
        "--separation", type=int, default=10, help="residues between the two atoms' at least (default: 10)"
    )
    parser.add_argument(
        "--pseudocount", type=float, default=30.0, help="expected pairs, counted from both sides (default: 30)"
    )
    parser.add_argument(
        "--burial",
        type=float,
        default=0.5,
        metavar="B",
        help="share of burial that energies keep, 0 to 1 (default: 0.5)",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=ROOT / "scoring/src/terms/pose/atom_pair_potential.csv",
        help="default: the program's own table",
    )
    options = parser.parse_args()
    if not 0.0 <= options.burial <= 1.0:
        parser.error(f"--burial {options.burial:g} is not between 0 and 1")
    return options


def read_kinds():
    """Kind by residue and atom, and the names of the kinds."""
    with open(TYPES_FILE, newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    names = list(dict.fromkeys(row["kind"] for row in rows))
    return {(row["residue"], row["atom"]): names.index(row["kind"]) for row in rows}, names


def read_atoms(path, kinds):
    """Positions, kinds and places of the residues of the atoms that have a kind, of the first model."""
    positions, types, residues = [], [], []
    residue, last = -1, None
    for line in read_text(path).split("\nENDMDL")[0].splitlines():
        if not line.startswith(("ATOM  ", "HETATM")) or line[16] not in " A1":
            continue
        if line[17:27] != last:
            residue, last = residue + 1, line[17:27]
        kind = kinds.get((line[17:20].strip(), line[12:16].strip()))
        if kind is not None:
            positions.append([float(line[start : start + 8]) for start in (30, 38, 46)])
            types.append(kind)
            residues.append(residue)
    return np.array(positions), np.array(types), np.array(residues)


def count(positions, types, residues, separation, kinds):
    """Pairs by shell and kinds, each from both sides."""
    first, second, distances = neighbours(positions, positions, DISTANCES[-1] + STEP / 2)
    distant = np.abs(residues[first] - residues[second]) >= separation
    first, second, distances = first[distant], second[distant], distances[distant]
    shells = np.maximum(((distances - DISTANCES[0]) / STEP + 0.5).astype(int), 0)
    counts = np.zeros((len(DISTANCES), kinds, kinds))
    np.add.at(counts, (shells, types[first], types[second]), 1.0)
    return counts


def write_table(options, used, names, energies, pairs_counted):
    lines = [
        "# Atom pair potential in units of RT, -ln(found / expected) at distances in Angstrom; lower is better.",
        f"# Written by scripts/potentials/atom_pair_potential.py on {datetime.date.today()} from {pairs_counted:.0f} "
        f"pairs of atoms, residues {options.separation} or more "
        f"apart, of {2 * len(used)} proteins; pseudocount {options.pseudocount:g}, burial {options.burial:g}.",
        "# Unbound receptors and ligands of Docking Benchmark 5 (BM5-clean, haddocking, Apache-2.0; "
        "Vreven et al., J. Mol. Biol. 427 (2015) 3031-3041):",
        f"# {' '.join(used)}",
        "kind,kind," + ",".join(f"{distance:g}" for distance in DISTANCES),
    ]
    for a, name in enumerate(names):
        for b in range(a + 1):
            lines.append(
                f"{name},{names[b]}," + ",".join(f"{round(value, 2) + 0.0:.2f}" for value in energies[:, a, b])
            )
    write(options.output, "\n".join(lines) + "\n")
    print(f"{2 * len(used)} proteins; table in {options.output}", file=sys.stderr)


if __name__ == "__main__":
    main()
