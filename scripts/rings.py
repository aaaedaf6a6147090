#!/usr/bin/env python3
"""Takes one molecule out of each known ring, turns it, docks it into a ring again, and tabulates at which rank that is found.

    python3 scripts/rings.py FILE:A,B,C... [FILE:...] [--seeds 0,1,2] [--knotdock PROGRAM] [--out DIR] [--pairs] [-- options of `knotdock dock`]

FILE is a PDB file, perhaps gzipped, and the chains after the colon, one letter for each molecule, are its ring; their number is its symmetry's. The
first of them is docked as it stands there, so that its side chains know their places: ranks say whether the search finds a fit that is there, not how well
unbound molecules are docked. Each is centred and turned by a rotation drawn uniformly from SO(3), from the file's name and the seed alone.
FILE:A,C+B,D names two rings face to face, of dihedral symmetry: the first of them is docked, and copies stand for neighbours in what follows.

A cluster is acceptable where its best pose has a ligand RMSD of at most 10 A or an interface RMSD of at most 4 A between neighbours, and near-native
with an interface RMSD of at most 2.5 A. With --pairs the same is done without symmetry, two copies docked as any pair.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import csv
import re
import subprocess
import sys
from pathlib import Path

from benchmark import find_program, first_ranks, measured, read_text, seeds, split_arguments, turn


def main():
    options = parse_arguments()
    symmetries = [True, False] if options.pairs else [True]
    print("| ring | " + " | ".join(column for ring in symmetries for column in columns(ring)) + " |")
    print("|---|" + "---|" * (3 * len(symmetries)))
    failed = False
    for ring in options.rings:
        cells = []
        for with_symmetry in symmetries:
            try:
                results = [dock(options, ring, seed, with_symmetry) for seed in options.seeds]
            except (OSError, RuntimeError) as error:
                print(f"{ring}: {error}", file=sys.stderr)
                failed = True
                cells += ["failed", "", ""]
                continue
            for criterion in ("acceptable", "near_native"):
                cells.append(", ".join(str(result[criterion] or "-") for result in results))
            cells.append(f"{sum(result['cpu_seconds'] for result in results) / len(results):.1f}")
        print(f"| {name_of(ring)} | " + " | ".join(cells) + " |", flush=True)
    sys.exit(1 if failed else 0)


def columns(with_symmetry):
    kind = "ring" if with_symmetry else "pair"
    return [f"{kind}: acceptable", "near-native", "CPU s"]


def parse_arguments():
    arguments, dock_options = split_arguments()
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0], epilog="what follows -- is handed to `knotdock dock`")
    parser.add_argument("rings", nargs="+", type=ring_of, metavar="FILE:CHAINS", help="a known ring and its molecules, a chain each")
    parser.add_argument("--seeds", type=seeds, default=[0, 1, 2], help="turns of the molecule, separated by commas (default: 0,1,2)")
    parser.add_argument("--knotdock", default="knotdock", help="the program (default: the one on the path)")
    parser.add_argument("--out", type=Path, default=Path("rings"), help="folder for the runs (default: rings)")
    parser.add_argument("--pairs", action="store_true", help="dock two copies without symmetry, too")
    options = parser.parse_args(arguments)
    options.dock_options = dock_options
    options.knotdock = find_program(parser, options.knotdock)
    return options


def ring_of(text):
    path, _, chains = text.rpartition(":")
    if not re.fullmatch(r"\w(,\w)+(\+\w(,\w)+)?", chains):
        raise argparse.ArgumentTypeError(f"{text}: a file and two or more chains are needed, as in dimer.pdb:A,B, or two rings, as in tetramer.pdb:A,C+B,D")
    rings = [ring.split(",") for ring in chains.split("+")]
    if len({len(ring) for ring in rings}) > 1:
        raise argparse.ArgumentTypeError(f"{text}: two rings have as many chains each")
    return Path(path), rings


def name_of(ring):
    path, rings = ring
    chains = f" {','.join(rings[0])}" if len(rings) == 2 else ""
    return f"{path.name.split('.')[0]} {symmetry_of(rings)}{chains}"


def symmetry_of(rings):
    return f"{'D' if len(rings) == 2 else 'C'}{len(rings[0])}"


def dock(options, ring, seed, with_symmetry):
    """Docks the first chain of a ring, or the first of two rings, and measures the clusters."""
    path, rings = ring
    if len(rings) == 2:
        docked = rings[0]
        sides = [f"{path}:{','.join(side)}" for side in rings]
        native = ["--native-receptor", sides[0], "--native-ligand", sides[1]]
    else:
        # Neighbours of a ring stand to each other as the first two do.
        docked = rings[0][:1]
        native = ["--native", f"{path}:{','.join(rings[0][:2])}"]
    folder = options.out / f"{re.sub('[ ,]', '_', name_of(ring))}_{seed}"
    folder.mkdir(parents=True, exist_ok=True)
    molecule = folder / "molecule.pdb"
    lines = read_text(path).splitlines()
    ends = [index for index, line in enumerate(lines) if line.startswith("ENDMDL")]
    first_model = lines[: ends[0]] if ends else lines
    atoms = [line for line in first_model if line.startswith(("ATOM  ", "HETATM")) and line[21] in docked]
    if not atoms:
        raise RuntimeError(f"{path} has no chain {', '.join(docked)}")
    molecule.write_text(turn("\n".join(atoms), path.name, seed))
    run = folder / ("ring" if with_symmetry else "pair")
    partner = ["--symmetry", symmetry_of(rings)] if with_symmetry else [str(molecule)]
    command = [options.knotdock, "dock", str(molecule), *partner, "-o", str(run), "--force", "--quiet", "--write-top", "1"]
    cost = measured(command + options.dock_options, folder / "dock.log")
    evaluation = subprocess.run(
        [options.knotdock, "evaluate", str(run), *native, "-o", str(folder / "measured.csv"), "--force", "--quiet"],
        capture_output=True,
        text=True,
    )
    if evaluation.returncode != 0:
        raise RuntimeError(f"evaluate: {evaluation.stderr.strip() or evaluation.returncode}")
    with open(folder / "measured.csv", newline="") as file:
        rows = [{key: float(row[key]) if row[key] else None for key in ("irmsd", "lrmsd")} for row in csv.DictReader(file)]
    return {**cost, **first_ranks(rows)}


if __name__ == "__main__":
    main()
