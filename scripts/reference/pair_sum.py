#!/usr/bin/env python3
"""The score of a pose as a plain double sum over pairs of atoms: an independent witness of tests/scoring_table.

    python3 scripts/reference/pair_sum.py target/release/knotdock

The program gives the atoms that it keeps and their radii (`inspect --atoms`); all else is computed here, by the
formulae of docs/research/effects.md and the default options. Distances in Å, frequencies in cycles per Å:

    slice(rho) = sum_ij kappa(d_ij, r_i + s_j + rho),  kappa^(w) = W(w) sigma^3 psi^(w sigma), times a window V(d)
    shape      = -lambda^2 slice(0) + 2 lambda slice(r0) - slice(2 r0)
    effect     = -weight sum_ij a_i M_ij b_j k(d_ij), k through the same W and V

Charges are written out here for the residues of the made-up cases; `nucleic` and `example` are compared without them.
Each column must agree within DIGITS of the largest value of its case. Exit code 0: all do; 1: one does not.

Needs Python 3.9 or later and NumPy.
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import ROOT

FOLDER = ROOT / "tests/scoring_table"
DIGITS = 1e-8
LAMBDA, OFFSET, RESOLUTION = 9.0, 2.2, 4.5
STOP, PASS = 1 / RESOLUTION, 1 / (2 * RESOLUTION)
CONTACT_WEIGHT, ELECTROSTATICS_WEIGHT = 2.0, 24.0
COULOMB = 332.0637  # kcal Å / (mol e^2)
# United atoms of CHARMM's PARAM19 (Brooks et al., J. Comput. Chem. 4 (1983) 187-217), at pH 7.
BACKBONE = {"N": -0.10, "CA": 0.10, "C": 0.55, "O": -0.55}
FIRST, LAST = {"N": 0.75, "CA": 0.25}, {"C": 0.14, "O": -1.14}  # charged ends; no second oxygen in these files
SIDE_CHAINS = {
    "ASP": {"CB": -0.16, "CG": 0.36, "OD1": -0.60, "OD2": -0.60},
    "GLU": {"CG": -0.16, "CD": 0.36, "OE1": -0.60, "OE2": -0.60},
    "LYS": {"CE": 0.25, "NZ": 0.75},
    "ARG": {"CD": 0.10, "NE": -0.10, "CZ": 0.50, "NH1": 0.25, "NH2": 0.25},
    "SER": {"CB": 0.25, "OG": -0.25},
}
UNCHARGED = ("nucleic", "example")


def step_down(x, start, stop):
    """C-infinity step from 1 at `start` to 0 at `stop`."""
    u = np.clip((x - start) / (stop - start), 1e-3, 1 - 1e-3)
    step = 1 / (1 + np.exp(np.minimum(1 / (1 - u) - 1 / u, 700)))
    return np.where(x <= start, 1.0, np.where(x >= stop, 0.0, step))


def psi(x):
    """The bump function of B&I eq. (10), alpha = 2."""
    inside = np.minimum(np.abs(x), 1 - 1e-12)
    return np.where(np.abs(x) < 1, np.exp(-(inside**2) / (1 - inside**2)), 0.0)


def transform(function, support, frequencies):
    """4 pi int d^2 f(d) sinc(2 w d), by the trapezoidal rule."""
    d = np.linspace(0, support, 2001)[1:]
    values = d**2 * function(d) * np.sinc(2 * np.outer(frequencies, d))
    return 4 * np.pi * d[0] * values.sum(axis=1)


class Filter:
    """Low-pass W and window V for kernels that end at `support`; the sum over frequencies is part of the definition."""

    def __init__(self, support):
        ring = 1 / (STOP - PASS)
        self.window = (support + 0.15 * ring, support + 1.30 * ring)
        step = 1 / (8 * self.window[1])
        self.frequencies = np.arange(0, STOP, step)
        self.weights = 4 * np.pi * self.frequencies**2 * step_down(self.frequencies, PASS, STOP) * step

    def __call__(self, distances, transforms):
        """Filtered kernels at some distances, a column for each transform."""
        waves = np.sinc(2 * np.outer(distances, self.frequencies))
        return (waves * self.weights) @ np.transpose(transforms) * step_down(distances, *self.window)[:, None]


def energy(d):
    """Coulomb energy of two unit charges by Mehler and Solmajer's dielectric, smoothed over 2 Å, ending at 12 Å."""
    s = np.hypot(d, 2.0)
    dielectric = -8.5525 + 86.9525 / (1 + 7.7839 * np.exp(-0.003627 * 86.9525 * s))
    return COULOMB / (dielectric * s) * step_down(d, 6.0, 12.0)


def read_table(path):
    """Rows of a CSV file, lines of # left out."""
    with open(path, newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def atoms(knotdock, path):
    """The atoms that the program keeps of a file."""
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "atoms.csv"
        subprocess.run([knotdock, "inspect", str(path), "--atoms", str(table), "--quiet"], check=True)
        return [row for row in read_table(table) if not row["dropped"]]


def charges(rows):
    """Charge of each atom, in e; a file without a whole residue (CB alone) has none."""
    places = [(row["chain"], int(row["number"])) for row in rows]
    ends = {chain: [number for c, number in places if c == chain] for chain, _ in places}
    found = []
    for row, (chain, number) in zip(rows, places):
        charge = {**BACKBONE, **SIDE_CHAINS.get(row["residue"], {})}
        if len(rows) > 1:
            charge |= FIRST if number == min(ends[chain]) else {}
            charge |= LAST if number == max(ends[chain]) else {}
        found.append(charge.get(row["atom"], 0.0))
    return np.array(found)


class Body:
    """Centres, radii, contact types (-1: none) and charges of one side."""

    def __init__(self, knotdock, path, types, charged):
        rows = atoms(knotdock, path)
        self.centres = np.array([[float(row[axis]) for axis in "xyz"] for row in rows])
        self.radii = np.array([float(row["radius"]) for row in rows])
        self.types = np.array([types.get((row["residue"], row["atom"]), -1) for row in rows])
        self.charges = charges(rows) if charged else np.zeros(len(rows))


def scores(receptor, ligand, potential, quaternion, translation):
    """The columns of a pose."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    placed = ligand.centres @ rotation.T + translation
    distances = np.linalg.norm(receptor.centres[:, None] - placed[None], axis=2)
    filtered = Filter(receptor.radii.max() + ligand.radii.max() + 2 * OFFSET)
    slices, unfiltered = np.zeros(3), np.zeros(3)
    for r in np.unique(receptor.radii):
        for s in np.unique(ligand.radii):
            d = distances[np.ix_(receptor.radii == r, ligand.radii == s)].ravel()
            sigmas = r + s + OFFSET * np.arange(3)
            d = d[d < filtered.window[1]]
            kernels = [sigma**3 * transform(psi, 1.0, filtered.frequencies * sigma) for sigma in sigmas]
            slices += filtered(d, kernels).sum(axis=0)
            unfiltered += [psi(d / sigma).sum() for sigma in sigmas]
    first, second = np.nonzero(distances < filtered.window[1])
    near = distances[first, second]
    contact = transform(lambda d: step_down(d, 5.0, 7.0), 7.0, filtered.frequencies)
    coulomb = transform(energy, 12.0, filtered.frequencies)
    counts, energies = filtered(near, [contact, coulomb]).T
    a, b = receptor.types[first], ligand.types[second]
    typed = (a >= 0) & (b >= 0)
    weights = np.array([-(LAMBDA**2), 2 * LAMBDA, -1.0])
    return {
        "shape": weights @ slices,
        "electrostatics": -ELECTROSTATICS_WEIGHT * (receptor.charges[first] * ligand.charges[second]) @ energies,
        "contact": -CONTACT_WEIGHT * potential[a[typed], b[typed]] @ counts[typed],
        **dict(zip(("slice_0", "slice_r0", "slice_2r0"), slices)),
        "unfiltered": weights @ unfiltered,
    }


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    table = read_table(ROOT / "scoring/src/terms/effect/contact_potential.csv")
    names = [row["type"] for row in table]
    potential = np.array([[float(row[name]) for name in names] for row in table])
    kinds = read_table(ROOT / "structures/src/molecule/chemistry/amino_acids.csv")
    types = {(row["residue"], row["atom"]): names.index(row["type"]) for row in kinds}
    poses = {
        (row["case"], row["pose"]): [float(value) for value in list(row.values())[2:]]
        for row in read_table(FOLDER / "poses.csv")
    }
    bodies, errors, largest = {}, {}, {}
    for row in read_table(FOLDER / "scores.csv"):
        case = row["case"].replace("blocked_", "")
        if case not in bodies:
            files = [FOLDER / f"cases/{case}_{side}.pdb" for side in ("receptor", "ligand")]
            if case == "example":
                files = [ROOT / f"structures/examples/1ppe_{side}_unbound.pdb" for side in ("receptor", "ligand")]
            bodies[case] = [Body(sys.argv[1], file, types, case not in UNCHARGED) for file in files]
        pose = np.array(poses[case, row["pose"]])
        for column, value in scores(*bodies[case], potential, pose[:4], pose[4:]).items():
            if not row.get(column) or (column == "electrostatics" and case in UNCHARGED):
                continue
            key = (row["case"], column)
            largest[key] = max(largest.get(key, 0.0), abs(float(row[column])))
            errors[key] = max(errors.get(key, 0.0), abs(value - float(row[column])))
    shares = {key: error / largest[key] if largest[key] else error for key, error in errors.items()}
    wrong = {key: share for key, share in shares.items() if not share <= DIGITS}
    for (case, column), share in wrong.items():
        print(f"pair_sum: {case}, {column}: off by {share:.1e} of the case's largest value", file=sys.stderr)
    columns = sorted({column for _, column in errors})
    worst = max(shares.values())
    print(f"pair sum: {', '.join(columns)} of {len(bodies)} cases within {worst:.0e} of their largest values")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
