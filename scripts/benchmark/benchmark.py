#!/usr/bin/env python3
"""Docks every pair of a benchmark folder and tabulates at which rank the known complex is found.

    python3 scripts/benchmark/benchmark.py DIR [--split eval] [--seeds 0,1,2] [--out DIR] [-- OPTIONS]

OPTIONS are those of `knotdock dock`.

DIR is laid out as scripts/docked_pairs.py says. Unbound files may lie superposed on the complex, so each ligand is
first centred and rotated at random, uniformly over SO(3), by the pair's id and the seed alone.

The --out folder gets two files for the ranking of all poses and two for that of the clusters, each by its best pose:

- `poses.csv` and `clusters.csv`: a row for each pair and seed.
- `poses.md` and `clusters.md`: a row for each pair, and how many pairs succeed among the first 1, 10, 100 and 1000, as
  the mean over the seeds.

Runs that are done are kept, and repeated only if the program, its options or the input changed. A pair that fails is
named and costs no other.

With --bound ligand, receptor or both the bound structures of these sides are docked, as when a known complex is taken
apart and docked again. With --also-bound they are docked beside the unbound ones, as an ensemble.

With --active N each docking gets N active residues of either side, as an experiment might find them. They are in
contact in the known complex, and are drawn by the pair's id and the seed. With --restraints it gets distances
likewise (scripts/benchmark/known_distances.py says which). With --predictions FOLDER it gets a predictor's
probabilities of residues to be in contact: FOLDER holds ID_r.csv and ID_l.csv for each pair, with the columns of
`knotdock dock --interface-receptor`.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import concurrent.futures
import hashlib
import json
import shutil
import subprocess
import sys
import threading
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import (
    PARTS,
    SPLITS,
    check_known,
    find_part,
    fold,
    in_fold,
    names,
    native_options,
    ranks_of_run,
    read_text,
    select,
    write,
)
from docking import find_program, measured, seeds, split_arguments, start_orientation
from known_distances import KINDS, restraint_options
from known_residues import active_residues
from tables import RANKINGS, markdown, ranks_csv

# Options of `knotdock dock` that this script sets itself.
OWNED = ("-o", "--output", "--force", "--rerun", "--native", "--native-receptor", "--native-ligand")


def main():
    options = parse_arguments()
    pairs = select_pairs(options)
    options.out.mkdir(parents=True, exist_ok=True)
    program = fingerprint(options.knotdock)
    jobs = [(pair, seed) for pair in pairs for seed in options.seeds]
    print(f"{len(pairs)} pairs, seeds {', '.join(map(str, options.seeds))}: {len(jobs)} runs", file=sys.stderr)
    results = {}
    say = threading.Lock()
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        futures = {pool.submit(run_one, options, program, pair, seed): (pair["id"], seed) for pair, seed in jobs}
        try:
            for done, future in enumerate(concurrent.futures.as_completed(futures), 1):
                name, seed = futures[future]
                result = future.result()
                results[name, seed] = result
                with say:
                    print(f"[{done}/{len(jobs)}] {name} seed {seed}: {describe(result)}", file=sys.stderr)
        except KeyboardInterrupt:
            pool.shutdown(cancel_futures=True)
            sys.exit(130)
    for ranking in RANKINGS:
        write(options.out / f"{ranking}.csv", ranks_csv(options, pairs, results, ranking))
        text = markdown(options, pairs, results, ranking, program)
        write(options.out / f"{ranking}.md", text)
        if ranking == "poses":
            print(text)
    print(f"tables in {options.out}", file=sys.stderr)
    sys.exit(1 if any("error" in result for result in results.values()) else 0)


def parse_arguments():
    arguments, dock_options = split_arguments()
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n\n")[0], epilog="what follows -- goes to `knotdock dock`"
    )
    add = parser.add_argument
    add("folder", type=Path, metavar="DIR", help="folder with manifest.csv and one folder for each pair")
    add("--split", default="eval", choices=SPLITS, help="pairs to run (default: eval)")
    add("--fold", type=fold, help="K/N: of the pairs in order of their ids every N-th from the K-th on, from 0")
    add("--ids", type=names, help="only these pairs, separated by commas")
    add("--seeds", type=seeds, default=[0, 1, 2], help="start orientations of the ligand (default: 0,1,2)")
    add("--knotdock", default="knotdock", help="the program (default: the one on the path)")
    add("--jobs", type=int, default=1, help="runs at a time (default: 1; a run uses all cores)")
    add("--out", type=Path, default=Path("benchmark"), help="folder for runs and tables (default: benchmark)")
    add("--bound", type=names, default=[], metavar="SIDES", help="dock the bound structure of receptor, ligand or both")
    add("--also-bound", type=names, default=[], metavar="SIDES", help="likewise, as a further conformation")
    add("--active", type=int, default=0, metavar="N", help="known contact residues of either side (default: 0)")
    add("--predictions", type=Path, metavar="FOLDER", help="interface predictions, ID_r.csv and ID_l.csv (default: none)")
    add("--restraints", choices=KINDS, help="known distances (default: none)")
    options = parser.parse_args(arguments)
    for owned in OWNED:
        if owned in dock_options:
            parser.error(f"this script sets {owned} itself")
    for sides in (options.bound, options.also_bound):
        if not set(sides) <= {"receptor", "ligand"}:
            parser.error("--bound and --also-bound take receptor, ligand, or both separated by a comma")
    options.dock_options = dock_options
    options.knotdock = find_program(parser, options.knotdock)
    # By content: a table that was written anew under its name makes old results stale, too.
    tables = (path for path in map(Path, dock_options) if path.is_file())
    options.tables = {str(path): checksum(path) for path in tables}
    return options


def select_pairs(options):
    pairs = select(options.folder, options.split)
    if options.ids:
        check_known(options.ids, pairs, options.split)
        pairs = [pair for pair in pairs if pair["id"] in options.ids]
    if options.fold:
        pairs = in_fold(pairs, *options.fold)
    if not pairs:
        sys.exit("no pair in this fold")
    return pairs


def checksum(path):
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def fingerprint(program):
    """Version and checksum of the program: a rebuilt one makes old results stale."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    return {"version": version, "sha256": checksum(program)}


def run_one(options, program, pair, seed):
    """Docks and measures one pair; never raises."""
    folder = options.out / pair["id"] / f"seed_{seed}"
    record = folder / "result.json"
    settings = {"program": program, "options": options.dock_options, "seed": seed}
    if options.tables:
        settings["tables"] = options.tables
    if options.active:
        settings["active"] = options.active
    if options.also_bound:
        settings["also_bound"] = options.also_bound
    if options.restraints:
        settings["restraints"] = options.restraints
    try:
        if options.predictions:
            settings["predictions"] = [checksum(path) for path in predictions(options.predictions, pair["id"]).values()]
        files = {part: find_part(options.folder / pair["id"], part) for part in PARTS}
        files |= {f"{side}_unbound": files[f"{side}_bound"] for side in options.bound}
        settings["inputs"] = {part: checksum(path) for part, path in files.items()}
        if record.exists():
            old = json.loads(record.read_text())
            if old.get("settings") == settings and "error" not in old and records_of(folder / "run"):
                return old
            # The run goes next, and a record of it must not outlive it.
            record.unlink()
        folder.mkdir(parents=True, exist_ok=True)
        result = dock_and_measure(options, folder, files, pair["id"], seed)
    except Exception as error:  # whatever it is, it is this pair's alone
        result = {"error": f"{type(error).__name__}: {error}"}
    result["settings"] = settings
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write(record, json.dumps(result, indent=1))
    except OSError as error:
        result.setdefault("error", str(error))
    return result


def dock_and_measure(options, folder, files, name, seed):
    """Docks one pair, and returns its cost and the first ranks of both rankings."""
    rotated = rotate(files["ligand_unbound"], folder / "ligand_rotated.pdb", name, seed)
    run = folder / "run"
    if run.exists():
        shutil.rmtree(run)
    command = [options.knotdock, "dock", str(files["receptor_unbound"]), str(rotated), "-o", str(run), "--quiet"]
    # Every pose is written with its cluster, so one run serves both rankings.
    for option, value in (("--no-cluster", []), ("--write-top", ["0"])):
        if option not in options.dock_options:
            command += [option, *value]
    if "receptor" in options.also_bound:
        command += ["--receptor-also", str(files["receptor_bound"])]
    if "ligand" in options.also_bound:
        command += ["--ligand-also", str(rotate(files["ligand_bound"], folder / "ligand_also.pdb", name, seed))]
    texts = {part: read_text(path) for part, path in files.items()}
    if options.active:
        command += active_residues(texts, name, seed, options.active)
    if options.restraints:
        command += restraint_options(options.restraints, texts, name, seed, folder / "restraints.csv")
    if options.predictions:
        for side, path in predictions(options.predictions, name).items():
            command += [f"--interface-{side}", str(path)]
    cost = measured(command + options.dock_options, folder / "dock.log")
    # The system's figure for a child can be that of this script before it became the child; the program's own is not.
    timings = [json.loads(record.read_text())["timing"] for record in records_of(run)]
    own_peak = max(timing["peak_memory_bytes"] or 0 for timing in timings)
    cost["peak_memory_bytes"] = own_peak or cost["peak_memory_bytes"]
    return {**cost, **ranks_of_run(options.knotdock, run, native_options(options.folder / name))}


def predictions(folder, name):
    """The table of each side's interface predictions."""
    return {side: folder / f"{name}_{side[0]}.csv" for side in ("receptor", "ligand")}


def rotate(path, rotated, name, seed):
    """Writes a ligand in its start orientation."""
    rotated.write_text(start_orientation(read_text(path), name, seed))
    return rotated


def records_of(run):
    """The record of a finished run, or those of the members of a finished ensemble."""
    if (run / "ensemble.json").exists():
        return sorted(run.glob("members/*/run.json"))
    return [run / "run.json"] if (run / "run.json").exists() else []


def describe(result):
    if "error" in result:
        return f"FAILED: {result['error']}"
    poses = result["poses"]
    return (
        f"acceptable at {poses['acceptable'] or '-'}, near-native at {poses['near_native'] or '-'} "
        f"of {poses['count']}, {result['cpu_seconds']:.1f} CPU s, {result['peak_memory_bytes'] / 1e6:.0f} MB"
    )


if __name__ == "__main__":
    main()
