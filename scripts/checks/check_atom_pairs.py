#!/usr/bin/env python3
"""Checks the arithmetic of atom_pair_potential.py against pairs counted and energies worked out by hand.

    python3 scripts/checks/check_atom_pairs.py

Needs Python 3.9 or later and NumPy; exits with 1 and names the figure that is off.
"""

import math
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "potentials"))
from atom_pair_potential import DISTANCES, count, energies_of


def main():
    wrong = [what for what, right in (*pairs_by_hand(), *energies_by_hand()) if not right]
    for what in wrong:
        print(f"check_atom_pairs: {what}", file=sys.stderr)
    if wrong:
        sys.exit(1)
    print("atom pair potential: counts and energies as by hand")


def pairs_by_hand():
    """Five atoms on a line at 0, 3, 4, 8.1 and 12 A, of kinds 0 1 0 1 1, in residues 0, 10, 12, 30 and 31."""
    positions = np.array([[x, 0.0, 0.0] for x in (0.0, 3.0, 4.0, 8.1, 12.0)])
    found = count(positions, np.array([0, 1, 0, 1, 1]), np.array([0, 10, 12, 30, 31]), 10, 2)
    expected = np.zeros_like(found)
    # 0-3 A: a separation of ten residues, nearer than the first shell and counted in it. 0-4 A: nearest to 4.25 (as
    # near to 3.75: halves go up).
    expected[0, 0, 1] += 1
    expected[0, 1, 0] += 1
    expected[2, 0, 0] += 2
    # 3-8.1 A: 5.1, nearest to 5.25. 4-8.1 A: 4.1, nearest to 4.25. 3-4 A and 8.1-12 A: too near in sequence.
    expected[4, 1, 1] += 2
    expected[2, 0, 1] += 1
    expected[2, 1, 0] += 1
    yield "pairs by shell and kinds", len(DISTANCES) == 6 and np.array_equal(found, expected)


def energies_by_hand():
    """Two kinds, 3 atoms and 1; 20 pairs from both sides: 12 of 0 with 0, 6 of unlike ones, 2 of 1 with 1."""
    found = np.array([[[12.0, 3.0], [3.0, 2.0]]])
    atoms = np.array([3.0, 1.0])
    # All of burial: shares 3/4 and 1/4 of atoms. None: 15/20 and 5/20 of partners, the same here. So 20 * 9/16 = 11.25
    # are expected of 0 with 0.
    for burial in (0.0, 0.5, 1.0):
        energy = energies_of(found, atoms, burial, 1.0)[0]
        yield (
            f"energies, burial {burial:g}, alike shares",
            close(energy[0, 0], -math.log(13 / 12.25)) and close(energy[1, 1], -math.log(3 / 2.25)),
        )
    # Atoms half and half, partners 3 to 1: at half of burial shares go as sqrt(3) to 1.
    atoms = np.array([2.0, 2.0])
    first = {0.0: 3 / 4, 0.5: math.sqrt(3) / (math.sqrt(3) + 1), 1.0: 1 / 2}
    for burial, share in first.items():
        energy = energies_of(found, atoms, burial, 1.0)[0]
        unlike = -math.log(4 / (20 * share * (1 - share) + 1))
        yield (
            f"energies, burial {burial:g}",
            close(energy[0, 0], -math.log(13 / (20 * share**2 + 1)))
            and close(energy[0, 1], unlike)
            and close(energy[1, 0], unlike),
        )


def close(a, b):
    return abs(a - b) < 1e-12


if __name__ == "__main__":
    main()
