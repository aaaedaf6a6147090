#!/usr/bin/env python3
"""Makes the small cases of tests/scoring_table from scratch: idealised molecules, by arithmetic alone.

    python3 scripts/reference/scoring_cases.py tests/scoring_table

Writes cases/NAME_receptor.pdb and cases/NAME_ligand.pdb, and poses.csv: a fixed sequence of pseudo-random moves of
each case, and of the example pair about its native pose. The cases look like molecules to a score and are none: names,
radii and charges are real, geometry is rough. Run it only to add or change a case; then bless the tables as
tests/scoring_table.rs says.
"""

import csv
import math
import sys
from pathlib import Path

# Cylinder coordinates of an alpha helix (radius, angle in degrees, height), rounded from Arnott & Dover,
# J. Mol. Biol. 30 (1967) 209.
BACKBONE = [
    ("N", 1.55, -27.8, -0.87),
    ("CA", 2.29, 0.0, 0.0),
    ("C", 1.69, 26.4, 1.07),
    ("O", 2.02, 24.0, 2.28),
    ("CB", 3.30, -19.2, -0.60),
]
# Side chains beyond CB: each atom as steps (outward, sideways) in Å from CB.
SIDE_CHAINS = {
    "ALA": [],
    "SER": [("OG", 1.0, 1.0)],
    "LEU": [("CG", 1.2, 0.8), ("CD1", 2.6, 0.3), ("CD2", 1.4, 2.3)],
    "ASP": [("CG", 1.2, 0.9), ("OD1", 2.3, 0.4), ("OD2", 1.2, 2.1)],
    "GLU": [("CG", 1.2, 0.9), ("CD", 2.7, 0.6), ("OE1", 3.5, 1.5), ("OE2", 3.2, -0.5)],
    "LYS": [("CG", 1.2, 0.9), ("CD", 2.7, 0.6), ("CE", 3.9, 1.5), ("NZ", 5.3, 1.2)],
    "ARG": [
        ("CG", 1.2, 0.9),
        ("CD", 2.7, 0.6),
        ("NE", 3.8, 1.5),
        ("CZ", 5.1, 1.3),
        ("NH1", 5.7, 0.2),
        ("NH2", 5.8, 2.4),
    ],
    "PHE": [
        ("CG", 1.2, 0.9),
        ("CD1", 2.5, 0.4),
        ("CD2", 1.3, 2.3),
        ("CE1", 3.7, 1.2),
        ("CE2", 2.5, 3.1),
        ("CZ", 3.7, 2.6),
    ],
}
# A nucleotide about the axis of a strand, likewise in cylinder coordinates: a rough B-DNA.
ADENOSINE = [
    ("P", 8.9, 0, 0.0),
    ("OP1", 10.2, 3, 0.5),
    ("OP2", 8.8, -8, -0.9),
    ("O5'", 7.8, 8, 0.7),
    ("C5'", 7.9, 18, 1.3),
    ("C4'", 7.5, 26, 0.6),
    ("O4'", 6.2, 24, 0.2),
    ("C3'", 8.2, 31, -0.6),
    ("O3'", 8.9, 40, -0.5),
    ("C2'", 7.2, 30, -1.7),
    ("C1'", 5.9, 32, -1.1),
    ("N9", 4.6, 26, -0.7),
    ("C8", 4.6, 8, -0.6),
    ("N7", 3.6, -4, -0.5),
    ("C5", 2.6, 12, -0.5),
    ("C6", 1.3, 10, -0.4),
    ("N6", 1.2, -50, -0.4),
    ("N1", 0.9, 75, -0.4),
    ("C2", 2.0, 80, -0.5),
    ("N3", 3.1, 58, -0.6),
    ("C4", 3.3, 34, -0.6),
]


def helix(sequence, chain, first, axis):
    """A helix along z whose axis crosses z = 0 at `axis`."""
    atoms = []
    for index, residue in enumerate(sequence):

        def at(radius, angle, height, side=0.0):
            return (
                axis[0]
                + radius * math.cos(math.radians(angle + 100 * index))
                - side * math.sin(math.radians(angle + 100 * index)),
                axis[1]
                + radius * math.sin(math.radians(angle + 100 * index))
                + side * math.cos(math.radians(angle + 100 * index)),
                height + 1.5 * index,
            )

        for name, radius, angle, height in BACKBONE:
            atoms.append(("ATOM", name, residue, chain, first + index, at(radius, angle, height)))
        for name, outward, sideways in SIDE_CHAINS[residue]:
            atoms.append(("ATOM", name, residue, chain, first + index, at(3.30 + outward, -19.2, -0.60, sideways)))
    return atoms


def strand(count, chain, turn):
    """A strand of adenosines about z."""
    atoms = []
    for index in range(count):
        for name, radius, angle, height in ADENOSINE:
            angle = math.radians(angle + turn + 36 * index)
            atoms.append(
                (
                    "ATOM",
                    name,
                    "DA",
                    chain,
                    1 + index,
                    (radius * math.cos(angle), radius * math.sin(angle), height + 3.38 * index),
                )
            )
    return atoms


def lone(record, name, residue, position=(0.0, 0.0, 0.0), number=1):
    return [(record, name, residue, "A", number, position)]


CASES = {
    # One atom each: the sums have closed forms.
    "two_atoms": (lone("ATOM", "CB", "ALA"), lone("ATOM", "CB", "ALA"), 3.8),
    # A lysine and an aspartate whose side chains meet head on in the first pose.
    "salt_bridge": (helix(["LYS"], "A", 1, (0, 0)), helix(["ASP"], "A", 1, (0, 0)), 9.0),
    # A helix of alanine in the groove of two: shape and contact, no charges but the ends.
    "helices": (
        helix(["ALA"] * 16, "A", 1, (0, 0)) + helix(["ALA"] * 14, "B", 101, (9.5, 0)),
        helix(["ALA"] * 12, "A", 1, (4.75, 8.2)),
        0.0,
    ),
    # Two helices with charges, hydroxyls and rings.
    "charged_helices": (
        helix("LEU LYS ALA GLU PHE ARG SER LYS LEU ALA ASP LYS".split(), "A", 1, (0, 0)),
        helix("GLU ALA LEU ASP SER GLU PHE ALA GLU LYS".split(), "A", 1, (0, 0)),
        12.0,
    ),
    # Two strands of adenosine with a zinc ion, and a helix of lysine and arginine: no contact types, large radii among
    # small ones.
    "nucleic": (
        strand(6, "A", 0) + strand(6, "B", 150) + lone("HETATM", "ZN", "ZN", (0.0, 12.0, 8.0), 50),
        helix("LYS ARG ALA LYS ARG SER LYS".split(), "A", 1, (0, 0)),
        15.0,
    ),
}


# First poses that are not just a shift along x.
FIRST = {"salt_bridge": (0.0, 0.0, 0.0, 1.0, 17.0, -3.1, 0.0)}


def write(path, atoms):
    with open(path, "w") as file:
        for serial, (record, name, residue, chain, number, (x, y, z)) in enumerate(atoms, 1):
            element = "ZN" if name == "ZN" else name[0]
            column = f"{name:<4}" if name == "ZN" else f" {name:<3}"
            file.write(
                f"{record:<6}{serial:5d} {column} {residue:>3} {chain}{number:4d}    {x:8.3f}{y:8.3f}{z:8.3f}"
                f"  1.00 10.00          {element:>2}\n"
            )
        file.write("END\n")


class Random:
    """Knuth's 64-bit linear congruential numbers, 0 to 1."""

    def __init__(self, seed):
        self.state = seed

    def __call__(self):
        self.state = (6364136223846793005 * self.state + 1442695040888963407) % 2**64
        return (self.state >> 11) / 2**53


def near(ligand, seed):
    """A real ligand at its place, and ten poses about that: rotated by up to 40 degrees, moved by up to 3 Å."""
    lines = [line for line in open(ligand) if line.startswith("ATOM")]
    middle = [sum(float(line[a : a + 8]) for line in lines) / len(lines) for a in (30, 38, 46)]
    random = Random(seed)
    rows = [(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)]
    for _ in range(10):
        axis = [2 * random() - 1 for _ in range(3)]
        length = math.sqrt(sum(x * x for x in axis))
        half = math.radians(20) * random()
        w, x, y, z = math.cos(half), *(math.sin(half) * a / length for a in axis)
        rotation = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
        turned = [sum(r * m for r, m in zip(row, middle)) for row in rotation]
        rows.append((w, x, y, z, *(m - t + 6 * random() - 3 for m, t in zip(middle, turned))))
    return rows


def poses(name, distance, seed):
    """The ligand beside the receptor, eight moves about `distance` Å away, one on top and one far away."""
    random = Random(seed)
    rows = [FIRST.get(name, (1.0, 0.0, 0.0, 0.0, distance, 0.0, 0.0))]
    for _ in range(8):
        quaternion = [2 * random() - 1 for _ in range(4)]
        length = math.sqrt(sum(x * x for x in quaternion))
        quaternion = [x / length * (1 if quaternion[0] >= 0 else -1) for x in quaternion]
        rows.append((*quaternion, distance + 2 * random() - 1, 4 * random() - 2, 4 * random() - 2))
    rows.append((1.0, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0))
    rows.append((1.0, 0.0, 0.0, 0.0, 0.0, 300.0, 0.0))
    return rows


def main():
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    (folder / "cases").mkdir(parents=True, exist_ok=True)
    table = folder / "poses.csv"
    columns = ["case", "pose", "qw", "qx", "qy", "qz", "tx", "ty", "tz"]
    with open(table, "w", newline="") as file:
        rows = csv.DictWriter(file, columns, lineterminator="\n")
        rows.writeheader()
        example = near(Path(__file__).parent / "../../structures/examples/1ppe_ligand_unbound.pdb", 11)
        for number, pose in enumerate(example, 1):
            rows.writerow(dict(zip(columns, ["example", number, *(f"{x:.6f}" for x in pose)])))
        for seed, (name, (receptor, ligand, distance)) in enumerate(CASES.items(), 1):
            write(folder / "cases" / f"{name}_receptor.pdb", receptor)
            write(folder / "cases" / f"{name}_ligand.pdb", ligand)
            for number, pose in enumerate(poses(name, distance, seed), 1):
                rows.writerow(dict(zip(columns, [name, number, *(f"{x:.6f}" for x in pose)])))


if __name__ == "__main__":
    main()
