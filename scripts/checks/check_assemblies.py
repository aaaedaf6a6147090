#!/usr/bin/env python3
"""Checks the biological assemblies that knotdock builds against gemmi's (PyPI), atom by atom.

    python scripts/checks/check_assemblies.py target/release/knotdock FOLDER        # the files of check_gemmi.py
    python scripts/checks/check_assemblies.py target/release/knotdock FOLDER --few  # those of the smaller packages

`knotdock inspect --assembly` must build the first four assemblies that a file describes of the same atoms as gemmi.
Compared are names, residues, numbers, insertion codes, alternate locations, and positions within 0.01 Å. A copy that
gemmi has and knotdock lacks must lie within half an Ångström of one that it has, as those on axes of symmetry do.

Exit code 0: nothing differs; 1: something does; 2: the check could not be made.
"""

import argparse
import collections
import csv
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import gemmi

from check_gemmi import MEANT, fetched

MOST_ASSEMBLIES = 4
MOST_ATOMS = 200_000
EQUAL, ON_AXIS = 0.01, 0.51


def built(knotdock, path, name, table):
    """Positions by atom of an assembly as knotdock builds it, and the messages about it."""
    command = [
        knotdock,
        "inspect",
        str(path),
        "--assembly",
        name,
        "--atoms",
        str(table),
        "--force",
        "--json",
        "--quiet",
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    reported = json.loads(done.stdout)
    if done.returncode:
        return None, reported["error"]["message"]
    positions = collections.defaultdict(list)
    with open(table, newline="") as file:
        for row in csv.DictReader(file):
            if row["dropped"] != "assembly":
                key = (row["atom"], row["altloc"], row["residue"], int(row["number"]), row["insertion"])
                positions[key].append(tuple(float(row[axis]) for axis in "xyz"))
    return positions, reported["input"]["report"]["assembly"]


def expected(assembly, model):
    """The same as gemmi builds it."""
    positions = collections.defaultdict(list)
    for chain in gemmi.make_assembly(assembly, model, gemmi.HowToNameCopiedChain.AddNumber):
        for residue in chain:
            for atom in residue:
                altloc = atom.altloc.replace("\0", "").strip()
                key = (atom.name.upper(), altloc, residue.name, residue.seqid.num, residue.seqid.icode.strip())
                positions[key].append(tuple(atom.pos.tolist()))
    return positions


def differences(ours, theirs):
    """What differs, and how many copies on axes only gemmi has."""
    lines, on_axes = [], 0
    for key in set(ours) | set(theirs):
        for position in theirs.get(key, []):
            distance = min((math.dist(position, other) for other in ours.get(key, [])), default=math.inf)
            if distance > ON_AXIS:
                lines.append(f"only gemmi: {key} {position}")
        for position in ours.get(key, []):
            if all(math.dist(position, other) > EQUAL for other in theirs.get(key, [])):
                lines.append(f"only knotdock: {key} {position}")
        on_axes += len(theirs.get(key, [])) - len(ours.get(key, []))
    return lines, on_axes


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("knotdock")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--few", action="store_true", help="the files of the smaller packages, 27 MB of downloads")
    options = parser.parse_args()
    paths = fetched(options)
    if paths is None:
        return 2
    counts = collections.Counter()
    with tempfile.TemporaryDirectory() as scratch:
        for path in paths:
            try:
                structure = gemmi.read_structure(str(path), merge_chain_parts=False, format=gemmi.CoorFormat.Detect)
            except (ValueError, RuntimeError, OSError, IndexError):
                continue
            if len(structure) == 0 or structure[0].count_atom_sites() == 0:
                continue
            for assembly in list(structure.assemblies)[:MOST_ASSEMBLIES]:
                theirs = expected(assembly, structure[0])
                if sum(map(len, theirs.values())) > MOST_ATOMS:
                    continue
                ours, reported = built(options.knotdock, path, assembly.name, Path(scratch) / "atoms.csv")
                where = f"{path.relative_to(options.folder)}, assembly {assembly.name}"
                if ours is None:
                    # A file that was cut may have none of the assembly's chains left, and some cannot be read at all.
                    meant = (not theirs and "no atom" in reported) or any(part in str(path) for part in MEANT)
                    kind = "refused as meant" if meant else "REFUSED"
                    counts[kind] += 1
                    if kind == "REFUSED":
                        print(f"{where}: {reported}")
                    continue
                lines, on_axes = differences(ours, theirs)
                if on_axes != reported["on_axes"]:
                    lines.append(f"{reported['on_axes']} copies on axes by knotdock, {on_axes} by what gemmi has more")
                counts["DIFFER" if lines else "the same"] += 1
                counts["copies on axes"] += on_axes
                if reported["chains"] != reported["chains_in_file"]:
                    counts["of them more or fewer chains than the file"] += 1
                if lines:
                    print(f"{where}: {len(lines)} differences")
                    for line in lines[:3]:
                        print(f"  {line}")
    print(", ".join(f"{count} {what}" for what, count in sorted(counts.items())))
    if counts["the same"] < 5:
        print("too few assemblies were found", file=sys.stderr)
        return 2
    return 1 if counts["DIFFER"] or counts["REFUSED"] else 0


if __name__ == "__main__":
    sys.exit(main())
