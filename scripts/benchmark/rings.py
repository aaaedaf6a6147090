#!/usr/bin/env python3
"""Takes one molecule out of each known ring, docks it into a ring again, and tabulates at which rank that is found.

    python3 scripts/benchmark/rings.py FILE:A,B,C... [FILE:...] [--seeds 0,1,2] [--pairs] [-- OPTIONS]

OPTIONS are those of `knotdock dock`.

FILE is a PDB file, perhaps gzipped; the chains after the colon, one letter for each molecule, are its ring, and their
number is its symmetry's. The first of them is docked as it is in the file, with the side chains of the complex. So
ranks say whether the search finds a fit that exists, not how well unbound molecules are docked. Each is centred and
rotated at random, uniformly over SO(3), by the file's name and the seed alone. FILE:A,C+B,D names two rings face to
face, of dihedral symmetry: the first of them is docked, and copies stand for neighbours in what follows.

A cluster counts by its best pose, between neighbours, as scripts/docked_pairs.py says. With --pairs the same is done
without symmetry, two copies docked as any pair.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import CRITERIA, evaluate, first_ranks, read_text
from docking import find_program, measured, seeds, split_arguments, start_orientation


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
            for criterion in CRITERIA:
                cells.append(", ".join(str(result[criterion] or "-") for result in results))
            cells.append(f"{sum(result['cpu_seconds'] for result in results) / len(results):.1f}")
        print(f"| {name_of(ring)} | " + " | ".join(cells) + " |", flush=True)
    sys.exit(1 if failed else 0)


def columns(with_symmetry):
    kind = "ring" if with_symmetry else "pair"
    return [f"{kind}: acceptable", "near-native", "CPU s"]


def parse_arguments():
    arguments, dock_options = split_arguments()
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n\n")[0], epilog="what follows -- goes to `knotdock dock`"
    )
    add = parser.add_argument
    add("rings", nargs="+", type=ring_of, metavar="FILE:CHAINS", help="a known ring and its molecules, a chain each")
    add("--seeds", type=seeds, default=[0, 1, 2], help="start orientations of the molecule (default: 0,1,2)")
    add("--knotdock", default="knotdock", help="the program (default: the one on the path)")
    add("--out", type=Path, default=Path("rings"), help="folder for the runs (default: rings)")
    add("--pairs", action="store_true", help="dock two copies without symmetry, too")
    options = parser.parse_args(arguments)
    options.dock_options = dock_options
    options.knotdock = find_program(parser, options.knotdock)
    return options


def ring_of(text):
    path, _, chains = text.rpartition(":")
    if not re.fullmatch(r"\w(,\w)+(\+\w(,\w)+)?", chains):
        raise argparse.ArgumentTypeError(
            f"{text}: a file and two or more chains are needed, as in dimer.pdb:A,B, "
            "or two rings, as in tetramer.pdb:A,C+B,D"
        )
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
        # Any neighbours of a ring are placed relative to each other as the first two are.
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
    molecule.write_text(start_orientation("\n".join(atoms), path.name, seed))
    run = folder / ("ring" if with_symmetry else "pair")
    partner = ["--symmetry", symmetry_of(rings)] if with_symmetry else [str(molecule)]
    command = [options.knotdock, "dock", str(molecule), *partner, "-o", str(run)]
    command += ["--force", "--quiet", "--write-top", "1"]
    cost = measured(command + options.dock_options, folder / "dock.log")
    return {**cost, **first_ranks(evaluate(options.knotdock, run, native))}


if __name__ == "__main__":
    main()
