#!/usr/bin/env python3
"""Docks every pair of a benchmark folder and tabulates at which rank the answer is found.

    python3 scripts/benchmark.py DIR [--split eval] [--seeds 0,1,2] [--out DIR] [-- options of `knotdock dock`]

DIR holds `manifest.csv` (columns `id` and `split`; others are optional) and for each pair a folder of its id with
`receptor_unbound`, `ligand_unbound` (docked) and `receptor_bound`, `ligand_bound` (the answer), each `.pdb` or
`.pdb.gz`. Unbound files may lie superposed on the complex, so each ligand is first centred and turned by a rotation drawn
uniformly from SO(3), from the pair's id and the seed alone.

Acceptable: ligand RMSD <= 10 A or interface RMSD <= 4 A. Near-native: interface RMSD <= 2.5 A. Both RMSDs are those of
`knotdock evaluate`.

Into the --out folder go, for the ranking of all poses and for that of the clusters (each by its best pose), `poses.csv`
and `clusters.csv` (a row for each pair and seed) and `poses.md` and `clusters.md` (a row for each pair, and how many pairs
succeed among the first 1, 10, 100 and 1000, as the mean over the seeds). Runs that are done are kept and not repeated
unless the program, its options or the input change. A pair that fails is named and costs no other.

With --attract N each docking is told N residues of either side that are in contact in the answer, drawn by the pair's id and the seed, as an experiment
might tell them.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import concurrent.futures
import csv
import gzip
import hashlib
import io
import json
import math
import os
import random
import shutil
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path

from known_residues import attraction
from whole_file import write

ACCEPTABLE_LIGAND_RMSD = 10.0  # A
ACCEPTABLE_INTERFACE_RMSD = 4.0  # A
NEAR_NATIVE_INTERFACE_RMSD = 2.5  # A
DEPTHS = (1, 10, 100, 1000)
RANKINGS = ("poses", "clusters")
CRITERIA = ("acceptable", "near_native")
MEGADOCK = {
    "acceptable": "megadock_first_acceptable_rank",
    "near_native": "megadock_first_irmsd_2.5_rank",
    "cpu_seconds": "megadock_cpu_s",
}
PARTS = ("receptor_unbound", "ligand_unbound", "receptor_bound", "ligand_bound")


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
        write_csv(options, pairs, results, ranking)
        text = markdown(options, pairs, results, ranking, program)
        write(options.out / f"{ranking}.md", text)
        if ranking == "poses":
            print(text)
    print(f"tables in {options.out}", file=sys.stderr)
    sys.exit(1 if any("error" in result for result in results.values()) else 0)


def split_arguments():
    """The script's own arguments, and what follows -- for `knotdock dock`."""
    arguments = sys.argv[1:]
    cut = arguments.index("--") if "--" in arguments else len(arguments)
    return arguments[:cut], arguments[cut + 1 :]


def seeds(text):
    return [int(part) for part in text.split(",")]


def find_program(parser, name):
    found = shutil.which(name)
    if found is None:
        parser.error(f"no program {name}; build it and name it with --knotdock target/release/knotdock")
    return found


def parse_arguments():
    arguments, dock_options = split_arguments()
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n\n")[0], epilog="what follows -- is handed to `knotdock dock`"
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder with manifest.csv and one folder for each pair")
    parser.add_argument(
        "--split",
        default="eval",
        choices=("eval", "train", "fit", "all"),
        help="pairs to run; `fit` is those of `train` without a relative in `eval` (default: eval)",
    )
    parser.add_argument("--fold", type=fold, help="K/N: of the chosen pairs in order of their ids every N-th from the K-th on, from 0")
    parser.add_argument("--ids", type=lambda text: text.split(","), help="only these pairs, separated by commas")
    parser.add_argument(
        "--seeds",
        type=seeds,
        default=[0, 1, 2],
        help="turns of the ligand, separated by commas (default: 0,1,2)",
    )
    parser.add_argument("--knotdock", default="knotdock", help="the program (default: the one on the path)")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time (default: 1; a run uses all cores)")
    parser.add_argument("--out", type=Path, default=Path("benchmark"), help="folder for runs and tables (default: benchmark)")
    parser.add_argument("--attract", type=int, default=0, metavar="N", help="residues of either side that each docking is told (default: 0)")
    options = parser.parse_args(arguments)
    for owned in ("-o", "--output", "--force", "--rerun", "--native", "--native-receptor", "--native-ligand"):
        if owned in dock_options:
            parser.error(f"{owned} is this script's own to set")
    options.dock_options = dock_options
    options.knotdock = find_program(parser, options.knotdock)
    # By content: a table that was written anew under its name makes old results stale, too.
    tables = (path for path in map(Path, dock_options) if path.is_file())
    options.tables = {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in tables}
    return options


def fold(text):
    """K/N as two numbers."""
    part, count = map(int, text.split("/"))
    if not 0 <= part < count:
        raise argparse.ArgumentTypeError(f"{text} is not K/N with 0 <= K < N")
    return part, count


def select_pairs(options):
    manifest = options.folder / "manifest.csv"
    if not manifest.is_file():
        sys.exit(f"{options.folder} holds no manifest.csv; the head of this script says how the folder is laid out")
    with open(manifest, newline="") as file:
        pairs = list(csv.DictReader(file))
    if options.split == "fit":
        pairs = [pair for pair in pairs if pair["split"] == "train" and not pair.get("near_eval", "").strip()]
    elif options.split != "all":
        pairs = [pair for pair in pairs if pair["split"] == options.split]
    if options.ids:
        unknown = set(options.ids) - {pair["id"] for pair in pairs}
        if unknown:
            sys.exit(f"not in split {options.split} of the manifest: {', '.join(sorted(unknown))}")
        pairs = [pair for pair in pairs if pair["id"] in options.ids]
    if options.fold:
        part, count = options.fold
        pairs = sorted(pairs, key=lambda pair: pair["id"])[part::count]
    if not pairs:
        sys.exit(f"no pair in split {options.split}")
    return pairs


def fingerprint(program):
    """Version and checksum of the program: a rebuilt one makes old results stale."""
    version = subprocess.run([program, "--version"], capture_output=True, text=True, check=True).stdout.strip()
    return {"version": version, "sha256": hashlib.sha256(Path(program).read_bytes()).hexdigest()}


def run_one(options, program, pair, seed):
    """Docks and measures one pair; never raises."""
    folder = options.out / pair["id"] / f"seed_{seed}"
    record = folder / "result.json"
    settings = {"program": program, "options": options.dock_options, "seed": seed}
    if options.tables:
        settings["tables"] = options.tables
    if options.attract:
        settings["attract"] = options.attract
    try:
        files = {part: find_part(options.folder / pair["id"], part) for part in PARTS}
        settings["inputs"] = {part: hashlib.sha256(path.read_bytes()).hexdigest() for part, path in files.items()}
        if record.exists():
            old = json.loads(record.read_text())
            if old.get("settings") == settings and "error" not in old and (folder / "run/run.json").exists():
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


def find_part(folder, part):
    for ending in (".pdb", ".pdb.gz"):
        path = folder / (part + ending)
        if path.exists():
            return path
    raise FileNotFoundError(f"no {part}.pdb or {part}.pdb.gz in {folder}")


def dock_and_measure(options, folder, files, name, seed):
    turned = folder / "ligand_turned.pdb"
    turned.write_text(turn(read_text(files["ligand_unbound"]), name, seed))
    run = folder / "run"
    if run.exists():
        shutil.rmtree(run)
    command = [options.knotdock, "dock", str(files["receptor_unbound"]), str(turned), "-o", str(run), "--quiet"]
    # Every pose is listed with its cluster, so one run serves both rankings.
    for option, value in (("--no-cluster", []), ("--write-top", ["0"])):
        if option not in options.dock_options:
            command += [option, *value]
    if options.attract:
        texts = {part: read_text(path) for part, path in files.items()}
        command += attraction(texts, name, seed, options.attract)
    cost = measured(command + options.dock_options, folder / "dock.log")
    # The system's figure for a child can be that of this script before it became the child; the program's own is not.
    own_peak = json.loads((run / "run.json").read_text())["timing"]["peak_memory_bytes"]
    cost["peak_memory_bytes"] = own_peak or cost["peak_memory_bytes"]
    native = ["--native-receptor", str(files["receptor_bound"]), "--native-ligand", str(files["ligand_bound"])]
    command = [options.knotdock, "evaluate", str(run), *native, "--json", "--quiet"]
    evaluation = subprocess.run(command, capture_output=True, text=True)
    if evaluation.returncode != 0:
        raise RuntimeError(f"evaluate: {evaluation.stderr.strip() or evaluation.returncode}")
    quality = {row["rank"]: row for row in json.loads(evaluation.stdout)["poses"]}
    with open(run / "poses.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    ranked = [quality[int(row["rank"])] for row in rows]
    # Rows come best first, so the first of a cluster is its best; clusters are numbered in their own order.
    clusters = {}
    for row, measure in zip(rows, ranked):
        clusters.setdefault(int(row["cluster"]), measure)
    return {
        **cost,
        "poses": first_ranks(ranked),
        "clusters": first_ranks([measure for _, measure in sorted(clusters.items())]),
    }


def read_text(path):
    data = path.read_bytes()
    return (gzip.decompress(data) if path.suffix == ".gz" else data).decode("latin-1")


def turn(text, name, seed):
    """PDB text with its atoms centred on the origin and turned uniformly at random."""
    lines = [line for line in text.splitlines() if line.startswith(("ATOM  ", "HETATM"))]
    points = [tuple(float(line[start : start + 8]) for start in (30, 38, 46)) for line in lines]
    center = [statistics.fmean(point[axis] for point in points) for axis in range(3)]
    rotation = random_rotation(name, seed)
    turned = []
    for line, point in zip(lines, points):
        moved = [sum(row[axis] * (point[axis] - center[axis]) for axis in range(3)) for row in rotation]
        turned.append(line[:30] + "".join(f"{value:8.3f}" for value in moved) + line[54:])
    return "\n".join(turned) + "\nEND\n"


def random_rotation(name, seed):
    """A rotation matrix uniform over SO(3) (Shoemake, Graphics Gems III, 1992, p. 124), fixed by name and seed."""
    digest = hashlib.sha256(f"{name} {seed}".encode()).digest()
    source = random.Random(int.from_bytes(digest, "big"))
    share, first, second = source.random(), 2 * math.pi * source.random(), 2 * math.pi * source.random()
    low, high = math.sqrt(1 - share), math.sqrt(share)
    x, y, z, w = low * math.sin(first), low * math.cos(first), high * math.sin(second), high * math.cos(second)
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def measured(command, log):
    """Runs a command and returns its cost; raises when it fails."""
    start = time.monotonic()
    with open(log, "w") as file:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=file, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        last = log.read_text(errors="replace").strip()[-500:]
        raise RuntimeError(f"dock ended with {process.returncode}: {last}")
    unit = 1 if sys.platform == "darwin" else 1024
    return {
        "cpu_seconds": usage.ru_utime + usage.ru_stime,
        "wall_seconds": time.monotonic() - start,
        "peak_memory_bytes": usage.ru_maxrss * unit,
    }


def first_ranks(ranked):
    """1-based ranks of the first acceptable and the first near-native pose, and how many poses there were."""
    ranks = {"count": len(ranked), "acceptable": None, "near_native": None}
    for rank, pose in enumerate(ranked, 1):
        irmsd = math.inf if pose["irmsd"] is None else pose["irmsd"]
        lrmsd = math.inf if pose["lrmsd"] is None else pose["lrmsd"]
        acceptable = lrmsd <= ACCEPTABLE_LIGAND_RMSD or irmsd <= ACCEPTABLE_INTERFACE_RMSD
        for criterion, met in (("acceptable", acceptable), ("near_native", irmsd <= NEAR_NATIVE_INTERFACE_RMSD)):
            if met and ranks[criterion] is None:
                ranks[criterion] = rank
    return ranks


def describe(result):
    if "error" in result:
        return f"FAILED: {result['error']}"
    poses = result["poses"]
    return (
        f"acceptable at {poses['acceptable'] or '-'}, near-native at {poses['near_native'] or '-'} of {poses['count']}, "
        f"{result['cpu_seconds']:.1f} CPU s, {result['peak_memory_bytes'] / 1e6:.0f} MB"
    )


def write_csv(options, pairs, results, ranking):
    known = [column for column in ("unbound_interface_rmsd_angstrom", *MEGADOCK.values()) if column in pairs[0]]
    header = ["id", "split", "seed", "first_acceptable_rank", "first_near_native_rank", ranking, "cpu_seconds"]
    header += ["wall_seconds", "peak_memory_bytes", "error", *known]
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(header)
    for pair in pairs:
        for seed in options.seeds:
            result = results[pair["id"], seed]
            ranks = result.get(ranking, {})
            row = [pair["id"], pair["split"], seed]
            row += [ranks.get(key) for key in ("acceptable", "near_native", "count")]
            row += [result.get(key) for key in ("cpu_seconds", "wall_seconds", "peak_memory_bytes", "error")]
            writer.writerow(row + [pair[column] for column in known])
    write(options.out / f"{ranking}.csv", table.getvalue())


def markdown(options, pairs, results, ranking, program):
    with_megadock = ranking == "poses" and MEGADOCK["acceptable"] in pairs[0]
    told = f", told {options.attract} residues of either side" if options.attract else ""
    ran = f"`{program['version']}`, options `{' '.join(options.dock_options) or 'default'}`{told}"
    seeds = ", ".join(map(str, options.seeds))
    lines = [f"# Ranking of {ranking}", "", f"{ran}; split `{options.split}`, {len(pairs)} pairs, seeds {seeds}.", ""]
    lines += [
        "First rank at which a pose is acceptable (ligand RMSD <= 10 Å or interface RMSD <= 4 Å) and near-native "
        "(interface RMSD <= 2.5 Å), one number for each seed; `-` where none of the list is.",
        "",
    ]
    header = ["pair", "acceptable", "near-native", "CPU s", "peak MB"]
    if with_megadock:
        header += ["MEGADOCK acceptable", "MEGADOCK near-native", "MEGADOCK CPU s"]
    table = [header]
    for pair in pairs:
        runs = [results[pair["id"], seed] for seed in options.seeds]
        row = [pair["id"]]
        for criterion in CRITERIA:
            row.append(", ".join("failed" if "error" in run else str(run[ranking][criterion] or "-") for run in runs))
        good = [run for run in runs if "error" not in run]
        row.append(f"{statistics.fmean(run['cpu_seconds'] for run in good):.1f}" if good else "-")
        row.append(f"{max(run['peak_memory_bytes'] for run in good) / 1e6:.0f}" if good else "-")
        if with_megadock:
            row += [pair[column] or ("-" if pair[MEGADOCK["cpu_seconds"]] else "") for column in MEGADOCK.values()]
        table.append(row)
    lines += rows_of(table) + ["", "Pairs that succeed among the first N, mean over the seeds:", ""]
    lines += rows_of(success_table(options, pairs, results, ranking, with_megadock))
    failed = sorted({name for (name, _), result in results.items() if "error" in result})
    if failed:
        lines += ["", f"Runs of {', '.join(failed)} failed and count as no success."]
    return "\n".join(lines) + "\n"


def success_table(options, pairs, results, ranking, with_megadock):
    table = [["", *(f"top {depth}" for depth in DEPTHS), "pairs"]]
    for criterion in CRITERIA:
        row = [criterion.replace("_", "-")]
        for depth in DEPTHS:
            hits = sum(
                (results[pair["id"], seed].get(ranking, {}).get(criterion) or math.inf) <= depth
                for pair in pairs
                for seed in options.seeds
            )
            row.append(f"{hits / len(options.seeds):.1f}")
        table.append([*row, str(len(pairs))])
    if with_megadock:
        measured_pairs = [pair for pair in pairs if pair[MEGADOCK["cpu_seconds"]]]
        for criterion in CRITERIA:
            ranks = [float(pair[MEGADOCK[criterion]] or math.inf) for pair in measured_pairs]
            row = [f"MEGADOCK {criterion.replace('_', '-')}", *(str(sum(rank <= depth for rank in ranks)) for depth in DEPTHS)]
            table.append([*row, str(len(measured_pairs))])
    return table


def rows_of(table):
    head, *body = ["| " + " | ".join(row) + " |" for row in table]
    return [head, "|" + "---|" * len(table[0]), *body]


if __name__ == "__main__":
    main()
