#!/usr/bin/env python3
"""Docks predicted antibodies and nanobodies to their antigens, and counts the pairs with an acceptable pose.

    python3 scripts/benchmark/predicted.py FOLDER [--half design|test] [--knows KIND] [--out DIR] [-- OPTIONS]

OPTIONS are those of `knotdock dock`.

FOLDER holds a folder for each pair, with gzipped PDB files:

- An antibody: `antibody_model`, `antigen_model`, `true_complex` and `vague_epitope.csv` (columns chain, number).
- A nanobody: `nanobody_models` (models of one file), `antigen_unbound`, `true_complex`, and restraints for HADDOCK,
  `two_hit.tbl` and `loose.tbl`.

The antibody is the receptor, and the antigen is rotated at random first. In `true_complex` the antibody has the chains
of its model, and the antigen all others. Of the pairs in the order of their names the first, third and so on are the
design half, on which settings are chosen.

--knows gives what is known: `active`, the vague epitope as active residues; `site`, as the residues among which the
antibody binds; `two_hit` or `loose`, these restraints. --ensemble docks all models of a nanobody together.

Runs that are done are kept: use a new --out for other options. Needs Python 3.9 or later and nothing else.
"""

import argparse
import concurrent.futures
import csv
import json
import math
import shutil
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import names, ranks_of_run, read_text, write
from docking import find_program, measured, split_arguments, start_orientation

DEPTHS = (1, 5, 10, 20, 48, 100)
RESIDUES = ("active", "site")
RESTRAINTS = ("two_hit", "loose")


def main():
    options = parse_arguments()
    pairs = sorted(path for path in options.folder.iterdir() if path.is_dir())
    if options.half:
        pairs = pairs[options.half == "test" :: 2]
    pairs = [pair for pair in pairs if not options.ids or pair.name in options.ids]
    if not pairs:
        sys.exit(f"no pairs in {options.folder}")
    options.out.mkdir(parents=True, exist_ok=True)
    results, failed = {}, 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        futures = {pool.submit(dock, options, pair): pair.name for pair in pairs}
        for future in concurrent.futures.as_completed(futures):
            name = futures[future]
            try:
                results[name] = future.result()
                print(f"{name}: {results[name]}", file=sys.stderr)
            except Exception as error:  # it is this pair's alone
                failed += 1
                print(f"{name} FAILED: {error}", file=sys.stderr)
    print(table(results))
    sys.exit(failed > 0)


def parse_arguments():
    arguments, dock_options = split_arguments()
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n\n")[0], epilog="what follows -- goes to `knotdock dock`"
    )
    add = parser.add_argument
    add("folder", type=Path, metavar="FOLDER", help="a folder for each pair")
    add("--half", choices=("design", "test"), help="half of the pairs (default: all)")
    add("--ids", type=names, help="only these pairs, separated by commas")
    add("--knows", choices=(*RESIDUES, *RESTRAINTS), metavar="KIND", help="active, site, two_hit or loose")
    add("--ensemble", action="store_true", help="dock all models of a nanobody together")
    add("--knotdock", default="knotdock", help="the program (default: the one on the path)")
    add("--jobs", type=int, default=1, help="runs at a time (default: 1; a run uses all cores)")
    add("--out", type=Path, default=Path("predicted"), help="folder for runs (default: predicted)")
    options = parser.parse_args(arguments)
    options.dock_options = dock_options
    options.knotdock = find_program(parser, options.knotdock)
    return options


def dock(options, pair):
    """Docks one pair, unless that was done: the first ranks of acceptable clusters and poses, and the cost."""
    folder = options.out / pair.name
    record = folder / "result.json"
    if record.exists():
        return json.loads(record.read_text())
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    is_antibody = (pair / "antibody_model.pdb.gz").exists()
    antibody = models(read_text(pair / f"{'antibody_model' if is_antibody else 'nanobody_models'}.pdb.gz"))
    if not is_antibody:
        antibody = [as_chain_a(text) for text in antibody]
    if not options.ensemble:
        del antibody[1:]
    files = []
    for number, text in enumerate(antibody, 1):
        files.append(folder / f"antibody_{number}.pdb")
        files[-1].write_text(text)
    antigen = folder / "antigen.pdb"
    text = read_text(pair / f"antigen_{'model' if is_antibody else 'unbound'}.pdb.gz")
    antigen.write_text(start_orientation(text, pair.name, 0))
    command = [options.knotdock, "dock", str(files[0]), str(antigen), "-o", str(folder / "run"), "--quiet"]
    command += ["--no-cluster", "--write-top", "0"]
    for also in files[1:]:
        command += ["--receptor-also", str(also)]
    if options.knows in RESIDUES:
        with open(pair / "vague_epitope.csv", newline="") as file:
            residues = [f"{row['chain']}:{row['number']}" for row in csv.DictReader(file)]
        command += [f"--{options.knows}-ligand", ",".join(residues)]
    elif options.knows:
        restraints = folder / f"{options.knows}.tbl"
        restraints.write_text(read_text(pair / f"{options.knows}.tbl.gz"))
        command += ["--restraints", str(restraints)]
    cost = measured(command + options.dock_options, folder / "dock.log")
    native = pair / "true_complex.pdb.gz"
    own = chains(antibody[0])
    others = [chain for chain in chains(read_text(native)) if chain not in own]
    known = [f"--native-{side}={native}:{','.join(of)}" for side, of in (("receptor", own), ("ligand", others))]
    ranks = ranks_of_run(options.knotdock, folder / "run", known)
    result = {ranking: first["acceptable"] for ranking, first in ranks.items()}
    result["cpu_seconds"] = round(cost["cpu_seconds"], 1)
    write(record, json.dumps(result))
    return result


def models(text):
    """The models of PDB text, each as text: all of it if it has none marked."""
    parts = text.split("\nENDMDL")
    return [part for part in parts if "\nATOM" in part or part.startswith("ATOM")]


def as_chain_a(text):
    """PDB text with all atoms in chain A, which is the nanobody in its complex and its restraints."""
    lines = (line[:21] + "A" + line[22:] for line in text.splitlines() if line.startswith("ATOM"))
    return "\n".join(lines) + "\nEND\n"


def chains(text):
    """Names of the chains of PDB text, in its order."""
    return list(dict.fromkeys(line[21] for line in text.splitlines() if line.startswith("ATOM")))


def table(results):
    """Pairs with an acceptable cluster, and pose, among the first N, Markdown."""
    lines = ["| acceptable | " + " | ".join(f"top {depth}" for depth in DEPTHS) + " | pairs |", "|---" * 8 + "|"]
    for ranking in ("clusters", "poses"):
        first = [result[ranking] or math.inf for result in results.values()]
        hits = [sum(rank <= depth for rank in first) for depth in DEPTHS]
        lines.append(f"| {ranking} | " + " | ".join(map(str, hits)) + f" | {len(first)} |")
    return "\n".join(lines)


if __name__ == "__main__":
    main()
