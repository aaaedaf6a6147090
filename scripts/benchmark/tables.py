"""Tables of a benchmark run, CSV and Markdown: first ranks by pair, and how many pairs succeed among the first N.

Imported by benchmark.py; compare.py and atlas.py read the CSV back.
"""

import csv
import io
import math
import statistics
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from docked_pairs import CRITERIA, DEPTHS

RANKINGS = ("poses", "clusters")
# Columns of the docking benchmark's manifest with another program's figures.
MEGADOCK = {
    "acceptable": "megadock_first_acceptable_rank",
    "near_native": "megadock_first_irmsd_2.5_rank",
    "cpu_seconds": "megadock_cpu_s",
}


def rank_column(criterion):
    """Column of a criterion's first rank."""
    return f"first_{criterion}_rank"


def read_ranks(folders, ranking="poses"):
    """Rows by pair and seed of several folders: first rank by criterion (infinite: not found) and `cpu_seconds`."""
    rows = {}
    for folder in folders:
        table = folder / f"{ranking}.csv"
        if not table.is_file():
            raise SystemExit(f"{folder} holds no {ranking}.csv; name the --out folder of a benchmark.py run")
        with open(table, newline="") as file:
            for row in csv.DictReader(file):
                if row["error"]:
                    raise SystemExit(
                        f"{table}: {row['id']}, seed {row['seed']} failed; run benchmark.py again, "
                        f"which repeats what failed: {row['error']}"
                    )
                ranks = {criterion: float(row[rank_column(criterion)] or math.inf) for criterion in CRITERIA}
                rows[row["id"], row["seed"]] = {**ranks, "cpu_seconds": float(row["cpu_seconds"] or "nan")}
    return rows


def ranks_csv(options, pairs, results, ranking):
    """A row for each pair and seed."""
    known = [column for column in ("unbound_interface_rmsd_angstrom", *MEGADOCK.values()) if column in pairs[0]]
    header = ["id", "split", "seed", *map(rank_column, CRITERIA), ranking, "cpu_seconds"]
    header += ["wall_seconds", "peak_memory_bytes", "error", *known]
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(header)
    for pair in pairs:
        for seed in options.seeds:
            result = results[pair["id"], seed]
            ranks = result.get(ranking, {})
            row = [pair["id"], pair["split"], seed]
            row += [ranks.get(key) for key in (*CRITERIA, "count")]
            row += [result.get(key) for key in ("cpu_seconds", "wall_seconds", "peak_memory_bytes", "error")]
            writer.writerow(row + [pair[column] for column in known])
    return table.getvalue()


def markdown(options, pairs, results, ranking, program):
    """A row for each pair, and the table of success."""
    with_megadock = ranking == "poses" and MEGADOCK["acceptable"] in pairs[0]
    known = f", {options.active} known contact residues of either side" if options.active else ""
    ran = f"`{program['version']}`, options `{' '.join(options.dock_options) or 'default'}`{known}"
    seeds = ", ".join(map(str, options.seeds))
    lines = [f"# Ranking of {ranking}", "", f"{ran}; split `{options.split}`, {len(pairs)} pairs, seeds {seeds}.", ""]
    lines += [
        "First rank at which a pose is acceptable (CAPRI's class acceptable or better) and near-native",
        "(interface RMSD <= 2.5 Å), one number for each seed; `-` where no pose is.",
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
    lines += rows_of(success(options, pairs, results, ranking, with_megadock))
    failed = sorted({name for (name, _), result in results.items() if "error" in result})
    if failed:
        lines += ["", f"Runs of {', '.join(failed)} failed and count as no success."]
    return "\n".join(lines) + "\n"


def success(options, pairs, results, ranking, with_megadock):
    """Pairs with a pose among the first N, by criterion."""
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
        measured = [pair for pair in pairs if pair[MEGADOCK["cpu_seconds"]]]
        for criterion in CRITERIA:
            ranks = [float(pair[MEGADOCK[criterion]] or math.inf) for pair in measured]
            hits = (str(sum(rank <= depth for rank in ranks)) for depth in DEPTHS)
            table.append([f"MEGADOCK {criterion.replace('_', '-')}", *hits, str(len(measured))])
    return table


def rows_of(table):
    """Lines of a Markdown table."""
    head, *body = ["| " + " | ".join(row) + " |" for row in table]
    return [head, "|" + "---|" * len(table[0]), *body]
