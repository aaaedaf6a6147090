#!/usr/bin/env python3
"""Checks `knotdock evaluate` against DockQ 2.1.3 (PyPI) on poses about the native.

    python scripts/checks/check_dockq.py target/release/knotdock RECEPTOR LIGAND NATIVE_RECEPTOR NATIVE_LIGAND

Needs numpy and DockQ==2.1.3 in the running Python. Files are PDB, plain or gzip. The poses are made here, so that no
docking run is needed. They are the native one, small and large moves about it, random orientations, one with the
centres on top of each other, and some without any contact. Each side's chains are merged to one for DockQ. Poses reach
DockQ as coordinates in memory: three decimals of a PDB file would move a contact at 5.000 Å across the limit.

Residues: DockQ aligns them by sequence alone, and beside a gap it may pair the wrong one of two equal residues. Where
the files' numbers pair at least as many equal residues, DockQ gets the pairs that the numbers name. If its own differ,
what that would change in its score is printed and does not count.

Not for sides of several identical chains: knotdock gives each pose the best of their orders, merged chains have one.

Compared for every pose: dockq, fnat, irmsd and lrmsd, whichever of the two files is called the receptor.
Exit code 0: all differ by at most the tolerance; 1: one does not; 2: the check could not be made.
"""

import argparse
import csv
import gzip
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from Bio.SVDSuperimposer import SVDSuperimposer
from DockQ import DockQ

AMINO_ACID = {"N", "CA", "C"}


def residues_of(path):
    """Residues of a PDB file in its order, each (name, [atom line]): heavy atoms, first location, first model."""
    opener = gzip.open if str(path).endswith(".gz") else open
    residues, seen, last = [], set(), None
    with opener(path, "rt") as file:
        for line in file:
            if line.startswith("ENDMDL"):
                break
            if not line.startswith(("ATOM  ", "HETATM")):
                continue
            name = line[12:16].strip()
            # By name: element columns are not to be trusted, and no heavy atom of a residue begins so.
            if name.lstrip("0123456789")[:1] in ("H", "D"):
                continue
            key = line[17:20], line[21:27]
            if key != last or ((name, line[16]) in seen):
                residues.append((line[17:20].strip(), []))
                seen, last = set(), key
            if name not in {atom for atom, _ in seen}:
                residues[-1][1].append(line)
            seen.add((name, line[16]))

    def is_polymer(lines):
        return lines[0].startswith("ATOM") or AMINO_ACID <= {line[12:16].strip() for line in lines}

    return [(name, lines) for name, lines in residues if lines and is_polymer(lines)]


def merged(receptor, ligand, path):
    """Writes both sides as chains A and B, numbered from 1 so that no number comes twice, and loads them with DockQ."""
    with open(path, "w") as file:
        serial = 0
        for chain, residues in (("A", receptor), ("B", ligand)):
            for number, (_, lines) in enumerate(residues, 1):
                for line in lines:
                    serial += 1
                    file.write(
                        f"ATOM  {serial % 100000:5d} {line[12:16]} {line[17:20]} {chain}{number:4d} "
                        f"{line[27:66].rstrip()}\n"
                    )
            file.write("TER\n")
        file.write("END\n")
    return DockQ.load_PDB(str(path))


def positions(chain):
    """Coordinates in double precision: the parser's are single, of three written decimals."""
    return np.round(np.array([atom.coord for atom in chain.get_atoms()], dtype=float), 3)


def numbers_of(residues):
    """For each residue (chain by order of appearance, number and insertion code, how many of that were before)."""
    chains, seen, keys = [], {}, []
    for _, lines in residues:
        chain, number = lines[0][21], lines[0][22:27].strip()
        if chain not in chains:
            chains.append(chain)
        key = chains.index(chain), number
        seen[key] = seen.get(key, -1) + 1
        keys.append((*key, seen[key]))
    return keys


def pairs_by_number(model, native):
    """Places of equal residues of equal number; none where their order differs."""
    places = {key: place for place, key in enumerate(numbers_of(native))}

    def plain(name):
        return {"MSE": "MET", "CME": "CYS"}.get(name, name)

    pairs = [(i, places[key]) for i, key in enumerate(numbers_of(model)) if key in places]
    pairs = [(i, j) for i, j in pairs if plain(model[i][0]) == plain(native[j][0])]
    return pairs if all(a[1] < b[1] for a, b in zip(pairs, pairs[1:])) else []


def pairs_of(alignment):
    """Places of the residues that an alignment of DockQ's pairs."""
    pairs, i, j = [], 0, 0
    for first, match, second in zip(*alignment):
        if match == "|":
            pairs.append((i, j))
        i, j = i + (first != "-"), j + (second != "-")
    return pairs


def alignment_of(pairs, model_length, native_length):
    """Pairs of places as an alignment of the kind that DockQ takes."""
    first, match, second, i, j = "", "", "", 0, 0
    for to_i, to_j in [*pairs, (model_length, native_length)]:
        lone = to_i - i, to_j - j
        first += "X" * lone[0] + "-" * lone[1]
        match += " " * sum(lone)
        second += "-" * lone[0] + "X" * lone[1]
        if to_i < model_length:
            first, match, second = first + "X", match + "|", second + "X"
        i, j = to_i + 1, to_j + 1
    return first, match, second


def align(model_residues, native_residues, model, native):
    """The alignment to check with, DockQ's own, and the residues that the two pair differently."""
    own = tuple(DockQ.format_alignment(DockQ.align_chains(model, native)).values())
    by_sequence, by_number = pairs_of(own), pairs_by_number(model_residues, native_residues)
    if len(by_number) < len(by_sequence) or by_number == by_sequence:
        return own, own, []

    def label(residue):
        return f"{residue[0]} {residue[1][0][22:27].strip()}"

    others = [
        f"{label(model_residues[i])} with {label(native_residues[j])}" for i, j in sorted({*by_sequence} - {*by_number})
    ]
    return alignment_of(by_number, len(model_residues), len(native_residues)), own, others


def best_fit(model, native, alignment):
    """R and t that superpose a model's chain on the native's, by the alpha carbons aligned."""
    ours, theirs = DockQ.get_aligned_residues(model, native, alignment)
    pairs = [(a["CA"].coord, b["CA"].coord) for a, b in zip(ours, theirs) if "CA" in a and "CA" in b]
    imposer = SVDSuperimposer()
    imposer.set(np.array([b for _, b in pairs], dtype=float), np.array([a for a, _ in pairs], dtype=float))
    imposer.run()
    rotation, translation = imposer.get_rotran()
    return rotation.T, translation


def matrix(q):
    """Rotation matrix of a unit quaternion (w, x, y, z), active and right-handed."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def quaternion(rotation):
    """Unit quaternion (w, x, y, z) of a rotation matrix, w >= 0 (eigenvector form, Bar-Itzhack 2000)."""
    r = rotation
    k = np.array(
        [
            [r[0, 0] + r[1, 1] + r[2, 2], r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]],
            [r[2, 1] - r[1, 2], r[0, 0] - r[1, 1] - r[2, 2], r[1, 0] + r[0, 1], r[2, 0] + r[0, 2]],
            [r[0, 2] - r[2, 0], r[1, 0] + r[0, 1], r[1, 1] - r[0, 0] - r[2, 2], r[2, 1] + r[1, 2]],
            [r[1, 0] - r[0, 1], r[2, 0] + r[0, 2], r[2, 1] + r[1, 2], r[2, 2] - r[0, 0] - r[1, 1]],
        ]
    )
    q = np.linalg.eigh(k)[1][:, -1]
    return q if q[0] >= 0 else -q


def poses_about(native_rotation, native_translation, ligand_center, receptor_center, count, rng):
    """`count` rigid moves of the ligand's file: the native pose, edge cases, then random moves of growing size."""
    center = native_rotation @ ligand_center + native_translation

    def about(rotation, shift):
        turned = rotation @ native_rotation
        return turned, rotation @ (native_translation - center) + center + shift

    def random_turn(degrees):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        half = np.radians(degrees) / 2
        return matrix([np.cos(half), *(np.sin(half) * axis)])

    def random_shift(length):
        direction = rng.normal(size=3)
        return length * direction / np.linalg.norm(direction)

    outwards = (center - receptor_center) / max(np.linalg.norm(center - receptor_center), 1e-9)
    unmoved, here = np.eye(3), np.zeros(3)
    poses = [
        about(unmoved, here),  # the native itself
        about(unmoved, 1e-4 * outwards),  # hardly moved
        about(random_turn(0.01), here),
        about(unmoved, 500 * outwards),  # far away: no contact
        about(random_turn(180), 60 * outwards),  # turned round, no contact
        about(random_turn(180), here),  # turned round in its place
        about(unmoved, receptor_center - center),  # centres on top of each other
    ]
    random = max(count - len(poses), 0)
    for step in range(random):
        size = (step + 1) / random
        poses.append(about(random_turn(180 * size**2), random_shift(30 * size**2)))
    return poses


def knotdock_values(arguments, poses, folder):
    """Runs `knotdock evaluate` on the poses; one dictionary per pose, in order."""
    path = Path(folder) / "poses.csv"
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow("rank qw qx qy qz tx ty tz".split())
        for rank, (rotation, translation) in enumerate(poses, 1):
            writer.writerow([rank, *(repr(float(value)) for value in (*quaternion(rotation), *translation))])
    command = [arguments.knotdock, "evaluate", path, "--receptor", arguments.receptor, "--ligand", arguments.ligand]
    command += ["--native-receptor", arguments.native_receptor, "--native-ligand", arguments.native_ligand, "--json"]
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(fail(f"knotdock evaluate ended with exit code {done.returncode}:\n{done.stdout}{done.stderr}"))
    rows = sorted(json.loads(done.stdout)["poses"], key=lambda row: row["rank"])
    if len(rows) != len(poses):
        sys.exit(fail(f"knotdock evaluate gave {len(rows)} rows for {len(poses)} poses"))
    return rows


def dockq_values(model, native, alignments):
    """DockQ's own figures for the model as its atoms now lie."""
    for function in vars(DockQ).values():
        # Its caches go by chain name and would hand back the pose before; alignments depend on sequence alone.
        if hasattr(function, "cache_clear") and function is not DockQ.align_chains:
            function.cache_clear()
    values = DockQ.calc_DockQ((model["A"], model["B"]), (native["A"], native["B"]), alignments)
    if values is None:
        sys.exit(fail("DockQ finds no contact between the native's receptor and ligand"))
    return values


def fail(message):
    print(message, file=sys.stderr)
    return 2


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name in ("knotdock", "receptor", "ligand", "native_receptor", "native_ligand"):
        parser.add_argument(name, type=Path)
    parser.add_argument("--poses", type=int, default=60, help="number of poses (60)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the random poses (0)")
    parser.add_argument("--tolerance", type=float, default=1e-3, help="largest difference allowed (1e-3; Å for RMSDs)")
    arguments = parser.parse_args()

    rng = np.random.default_rng(arguments.seed)
    with tempfile.TemporaryDirectory() as folder:
        ours = residues_of(arguments.receptor), residues_of(arguments.ligand)
        theirs = residues_of(arguments.native_receptor), residues_of(arguments.native_ligand)
        model, native = merged(*ours, Path(folder) / "model.pdb"), merged(*theirs, Path(folder) / "native.pdb")
        sides = [align(a, b, model[chain], native[chain]) for a, b, chain in zip(ours, theirs, "AB")]
        alignments, own_alignments = tuple(side[0] for side in sides), tuple(side[1] for side in sides)
        others = sides[0][2] + sides[1][2]
        receptor_rotation, receptor_translation = best_fit(model["A"], native["A"], alignments[0])
        ligand_rotation, ligand_translation = best_fit(model["B"], native["B"], alignments[1])
        start = positions(model["B"])
        poses = poses_about(
            receptor_rotation.T @ ligand_rotation,
            receptor_rotation.T @ (ligand_translation - receptor_translation),
            start.mean(axis=0),
            positions(model["A"]).mean(axis=0),
            arguments.poses,
            rng,
        )
        rows = knotdock_values(arguments, poses, folder)

    columns = [("dockq", "DockQ"), ("fnat", "fnat"), ("irmsd", "iRMSD"), ("lrmsd", "LRMSD")]
    worst = dict.fromkeys((column for column, _ in columns), 0.0)
    failed, own_difference = [], 0.0
    for row, (rotation, translation) in zip(rows, poses):
        for atom, place in zip(model["B"].get_atoms(), start @ rotation.T + translation):
            atom.set_coord(place.astype("f"))
        theirs = dockq_values(model, native, alignments)
        if others:
            own = dockq_values(model, native, own_alignments)
            own_difference = max(own_difference, abs(theirs["DockQ"] - own["DockQ"]))
        bad = False
        for column, name in columns:
            # DockQ superposes in single precision, so that a ligand 500 Å away is only known to five digits.
            difference = abs(row[column] - theirs[name])
            allowed = max(arguments.tolerance, 1e-5 * abs(theirs[name]))
            worst[column] = max(worst[column], difference)
            # Written so that a NaN fails.
            bad |= not difference <= allowed
        if bad:
            failed.append((row, theirs))

    if failed:
        print(f"{len(failed)} of {len(poses)} poses differ by more than {arguments.tolerance}:")
        print("rank  " + "  ".join(f"{column:>10} {'(DockQ)':>10}" for column, _ in columns))
        for row, theirs in failed:
            print(f"{row['rank']:4d}  " + "  ".join(f"{row[c]:10.5f} {theirs[n]:10.5f}" for c, n in columns))
    largest = ", ".join(f"{column} {worst[column]:.2e}" for column, _ in columns)
    print(f"{len(poses)} poses, largest differences: {largest}")
    if others:
        print(f"for information: DockQ's own alignment pairs {', '.join(others[:5])}{' ...' * (len(others) > 5)}")
        print(
            "where the numbers say otherwise; with it DockQ's score would differ from its score here "
            f"by up to {own_difference:.2e}"
        )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
