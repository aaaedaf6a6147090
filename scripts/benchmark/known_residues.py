"""Contact residues drawn from a known complex, as an experiment might find some of them.

Imported by benchmark.py, whose option --active gives them to each docking.
"""

import random
from collections import defaultdict
from itertools import product

CONTACT = 5.0  # Å, between heavy atoms, as native contacts are counted


def active_residues(texts, name, seed, count):
    """Options of `knotdock dock` for `count` active residues of each side, drawn by name and seed alone.

    `texts` holds the PDB text of receptor_bound, ligand_bound, receptor_unbound and ligand_unbound. Residues are
    matched by number; those that the unbound file lacks are not drawn. With fewer than `count` in the interface all
    are taken. A number that a file has in several chains is an error.
    """
    bound = {side: list(atoms(texts[f"{side}_bound"])) for side in ("receptor", "ligand")}
    # The seed's word is that of older runs, so that they can be repeated.
    source = random.Random(f"{name} {seed} attraction")
    options = []
    for side, other in (("receptor", "ligand"), ("ligand", "receptor")):
        touching = residues_within(bound[side], bound[other])
        chains_by_number(bound[side], f"{side}_bound of {name}")
        unbound = chains_by_number(atoms(texts[f"{side}_unbound"]), f"{side}_unbound of {name}")
        known = [number for number in sorted(touching, key=order) if number in unbound]
        drawn = sorted(source.sample(known, min(count, len(known))), key=order)
        if drawn:
            options += [f"--active-{side}", ",".join(f"{unbound[number]}:{number}" for number in drawn)]
    return options


def chains_by_number(rows, what):
    """The chain of each residue number; a number that is in several chains is refused."""
    chains = {}
    for chain, number, _ in rows:
        if chains.setdefault(number, chain) != chain:
            raise ValueError(
                f"{what} has residue {number} in chains {chains[number]} and {chain}: "
                "residues are matched by number alone"
            )
    return chains


def order(number):
    """Sort key: numbers in order, insertion codes after their number."""
    return int(number.rstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZ")), number


def atoms(text):
    """Chain, residue number with insertion code, and position of each heavy atom."""
    for line in text.splitlines():
        if line.startswith("ATOM") and not line[12:16].strip().lstrip("0123456789").startswith("H"):
            position = tuple(float(line[first : first + 8]) for first in (30, 38, 46))
            yield line[21].strip(), line[22:27].strip(), position


def residues_within(own, others):
    """Numbers of the residues with an atom within CONTACT of one of the others."""
    cells = defaultdict(list)
    for _, _, position in others:
        cells[tuple(int(x // CONTACT) for x in position)].append(position)
    found = set()
    for _, number, position in own:
        if number in found:
            continue
        home = tuple(int(x // CONTACT) for x in position)
        steps = product((-1, 0, 1), repeat=3)
        near = (other for step in steps for other in cells.get(tuple(map(sum, zip(home, step))), ()))
        if any(sum((a - b) ** 2 for a, b in zip(position, other)) <= CONTACT**2 for other in near):
            found.add(number)
    return found
