#!/usr/bin/env python3
"""Checks `knotdock interface` against biotite (PyPI).

    python scripts/checks/check_interface.py target/release/knotdock structures/examples

Needs biotite and numpy (requirements_biotite.txt) in the running Python. The complexes are the known one of the example
pair, and the first poses of docking its free partners. What is compared, with the tolerance:

    contacts    pairs of residues with heavy atoms within 5 Å, exactly; their distances within 1e-4 Å
    buried      accessible area that both sides lose, by the points of Shrake and Rupley on ProtOr's radii, within 2%
                or 10 Å^2

At the end each comparison is made again with a figure spoilt on purpose, which must fail.
Exit code 0: all agree; 1: a figure drifted; 2: the check could not be made.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import biotite.structure as structure
import numpy as np
from biotite.structure.io.pdb import PDBFile

CONTACT = 5.0
PROBE = 1.4


def reference(path, chains):
    """Contacts as {(residue, residue): distance}, and the buried area, as biotite has them."""
    atoms = PDBFile.read(path).get_structure(model=1)
    atoms = atoms[(atoms.element != "H") & (atoms.res_name != "HOH")]
    sides = [atoms[np.isin(atoms.chain_id, names)] for names in chains]
    cells = structure.CellList(sides[0], CONTACT)
    found = {}
    for atom, near in zip(sides[1], cells.get_atoms(sides[1].coord, CONTACT), strict=True):
        for index in near[near >= 0]:
            other = sides[0][index]
            pair = tuple(f"{one.chain_id}:{one.res_id}{one.ins_code}" for one in (other, atom))
            # Files have three decimals; biotite holds single precision.
            distance = float(np.linalg.norm(other.coord.astype(float) - atom.coord.astype(float)))
            found[pair] = min(distance, found.get(pair, np.inf))

    def area(part):
        return float(np.nansum(structure.sasa(part, probe_radius=PROBE, point_number=1000, vdw_radii="ProtOr")))

    return found, area(sides[0]) + area(sides[1]) - area(sides[0] + sides[1])


def ours(knotdock, path):
    """The same as `knotdock interface` has them, and the chains of both sides."""
    words = [knotdock, "interface", path, "--json"]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    (found,) = json.loads(done.stdout)["complexes"]
    pairs = {}
    for pair in found["pairs"]:
        names = [f"{residue['chain']}:{residue['number']}" for residue in pair["residues"]]
        pairs[tuple(names)] = pair["distance"]
    chains = [found[f"chains_{side}"].split(",") for side in (1, 2)]
    return pairs, found["buried_area"], chains


def differences(name, own, other):
    """What differs by more than its tolerance, in words."""
    (pairs, buried), (expected_pairs, expected_buried) = own, other
    wrong = []
    # At the very limit rounding decides.
    for pair in set(pairs) ^ set(expected_pairs):
        distance = pairs.get(pair, expected_pairs.get(pair))
        if abs(distance - CONTACT) > 1e-4:
            wrong.append(f"{name}: {pair} at {distance:.4f} Å is a contact of one alone")
    for pair in set(pairs) & set(expected_pairs):
        if abs(pairs[pair] - expected_pairs[pair]) > 1e-4:
            wrong.append(f"{name}: {pair} is at {pairs[pair]:.5f} Å, biotite has {expected_pairs[pair]:.5f}")
    if abs(buried - expected_buried) > max(0.02 * expected_buried, 10.0):
        wrong.append(f"{name}: {buried:.1f} Å^2 buried, biotite has {expected_buried:.1f}")
    return wrong


def complexes(knotdock, examples, folder):
    """Complex files: the known one, and poses."""
    bound = [examples / f"1ppe_{side}_bound.pdb" for side in ("receptor", "ligand")]
    known = folder / "known.pdb"
    lines = [line for path in bound for line in path.read_text().splitlines() if line.startswith(("ATOM", "TER"))]
    known.write_text("\n".join([*lines, "END", ""]))
    free = [examples / f"1ppe_{side}_unbound.pdb" for side in ("receptor", "ligand")]
    words = [knotdock, "dock", *free, "--rotations", "60", "--sharp", "off", "--no-report", "-o", folder / "run", "-q"]
    subprocess.run(words, check=True)
    return [known, *sorted((folder / "run/top").glob("*.pdb"))]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("knotdock", type=Path)
    parser.add_argument("examples", type=Path)
    given = parser.parse_args()
    wrong, made, spoilt = [], 0, []
    with tempfile.TemporaryDirectory() as folder:
        try:
            for path in complexes(given.knotdock, given.examples, Path(folder)):
                pairs, buried, chains = ours(given.knotdock, path)
                expected = reference(path, chains)
                wrong += differences(path.name, (pairs, buried), expected)
                made += len(pairs) + 1
                one = next(iter(pairs))
                fewer = {pair: distance for pair, distance in pairs.items() if pair != one}
                for changed in (
                    (fewer, buried),
                    ({**pairs, one: pairs[one] + 0.01}, buried),
                    (pairs, 1.05 * buried + 10),
                ):
                    spoilt.append(bool(differences(path.name, changed, expected)))
        except (OSError, subprocess.CalledProcessError, ValueError) as error:
            print(f"The check could not be made: {error}", file=sys.stderr)
            return 2
    print("\n".join(wrong) or f"Interfaces: {made} contacts and areas agree with biotite")
    if not all(spoilt):
        print("A spoilt figure passed: the check proves nothing")
        return 1
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
