#!/usr/bin/env python3
"""The atlas: success against processor time as settings change, on one or two sets of pairs, as a page and a picture.

    python3 scripts/benchmark/atlas.py [--train NAME=RUNS ...] --eval NAME=RUNS [NAME=RUNS ...] \\
        --page docs/results/atlas.md --picture docs/images/atlas.svg

Each RUNS is the --out folder (or several, with commas between them) of a `benchmark.py` run; a setting has the same
NAME in both sets. Pairs that all settings of a set hold are compared, each setting over the seeds that it has.

Success is the share of pairs with an acceptable pose among the first N, poses ranking, with its 95% interval by
bootstrap over pairs. Time is the mean of CPU seconds a run. The docking benchmark's manifest has MEGADOCK's figures
for the pairs of `eval`; they are a point of their own.

Needs Python 3.9 or later and matplotlib (PyPI).
"""

import argparse
import csv
import math
import statistics
import sys
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.lines import Line2D
from matplotlib.ticker import PercentFormatter

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from compare import draw_pairs, interval, named
from docked_pairs import DEPTHS, write
from tables import MEGADOCK, read_ranks

RESAMPLES = 10000
SETS = ("train", "eval")
COLOURS = {"train": "#0072b2", "eval": "#d55e00", "MEGADOCK": "#222222"}


def main():
    options = parse_arguments()
    points = []
    for split in SETS:
        runs = {name: read_ranks(folders) for name, folders in getattr(options, split)}
        if runs:
            points += settings(split, runs)
            pairs = shared_pairs(split, runs)
    points += megadock(options.eval[0][1], pairs)
    picture(points, options.picture)
    write(options.page, page(points, options))
    print(table(points))


def shared_pairs(split, runs):
    """The pairs that all settings of a set hold."""
    shared = sorted(set.intersection(*({pair for pair, _ in rows} for rows in runs.values())))
    if not shared:
        raise SystemExit(f"no pair is in every run of {split}")
    return shared


def settings(split, runs):
    """Each setting of a set as a point."""
    shared = shared_pairs(split, runs)
    points = []
    for name, rows in runs.items():
        by_pair = [[row for (pair, _), row in rows.items() if pair == wanted] for wanted in shared]
        found = [[statistics.fmean(row["acceptable"] <= depth for row in pair) for pair in by_pair] for depth in DEPTHS]
        seconds = statistics.fmean(statistics.fmean(row["cpu_seconds"] for row in pair) for pair in by_pair)
        seeds = sorted({len(pair) for pair in by_pair})
        points.append(point(split, name, found, seconds, "-".join(map(str, seeds))))
    return points


def megadock(folders, pairs):
    """MEGADOCK's point, of the figures for some pairs that came with the benchmark."""
    rows = {}
    for folder in folders:
        with open(folder / "poses.csv", newline="") as file:
            rows |= {
                row["id"]: row
                for row in csv.DictReader(file)
                if row["id"] in pairs and row.get(MEGADOCK["cpu_seconds"])
            }
    if not rows:
        return []
    ranks = [float(row[MEGADOCK["acceptable"]] or math.inf) for row in rows.values()]
    found = [[float(rank <= depth) for rank in ranks] for depth in DEPTHS]
    seconds = statistics.fmean(float(row[MEGADOCK["cpu_seconds"]]) for row in rows.values())
    return [point("MEGADOCK", "MEGADOCK 4.1.3", found, seconds, 1)]


def point(split, name, found, seconds, seeds):
    count = len(found[0])
    draws = draw_pairs(count, RESAMPLES)
    shares = []
    for values in found:
        low, high = interval(values, draws)
        shares.append((sum(values) / count, low / count, high / count))
    return {"set": split, "name": name, "seconds": seconds, "pairs": count, "seeds": seeds, "shares": shares}


def table(points):
    head = "| set | setting | pairs | seeds | CPU s | " + " | ".join(f"top {depth}" for depth in DEPTHS) + " |"
    lines = [head, "|---" * (5 + len(DEPTHS)) + "|"]
    for p in points:
        cells = [f"{100 * mean:.0f} [{100 * low:.0f}, {100 * high:.0f}]" for mean, low, high in p["shares"]]
        split = "eval" if p["set"] == "MEGADOCK" else p["set"]
        lines.append(
            f"| {split} | {p['name']} | {p['pairs']} | {p['seeds']} | {p['seconds']:.1f} | " + " | ".join(cells) + " |"
        )
    return "\n".join(lines)


def picture(points, path):
    """A panel for each depth, and the key below them; a setting's number is beside its point."""
    names = list(dict.fromkeys(p["name"] for p in points if p["set"] != "MEGADOCK"))
    figure, panels = plt.subplots(2, 2, figsize=(9, 9), layout="constrained")
    for index, (panel, depth) in enumerate(zip(panels.flat, DEPTHS)):
        panel.set_title(f"An acceptable pose among the first {depth}")
        panel.set_xscale("log")
        panel.set_ylim(0, 1)
        panel.yaxis.set_major_formatter(PercentFormatter(1))
        panel.xaxis.set_major_formatter("{x:g}")
        panel.set_xlabel("CPU seconds a pair")
        panel.grid(color="#dddddd")
        panel.set_axisbelow(True)
        for p in points:
            mean, low, high = p["shares"][index]
            mark, label = ("x", p["set"]) if p["set"] == "MEGADOCK" else ("o", str(names.index(p["name"]) + 1))
            side, align = (-7, "right") if p["set"] == "train" else (7, "left")
            place, colour = (p["seconds"], mean), COLOURS[p["set"]]
            panel.plot([p["seconds"]] * 2, [low, high], color=colour, alpha=0.25)
            panel.plot(*place, mark, color=colour)
            panel.annotate(label, place, (side, 0), textcoords="offset points", ha=align, va="center", color=colour)
    sets = {p["set"]: p["pairs"] for p in points if p["set"] != "MEGADOCK"}
    handles = [Line2D([], [], marker="o", ls="", color=COLOURS[split]) for split in sets]
    handles += [Line2D([], [], ls="") for _ in names]
    labels = [f"{split}, {pairs} pairs" for split, pairs in sets.items()]
    labels += [f"{number}: {name}" for number, name in enumerate(names, 1)]
    figure.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False)
    # Text stays text and ids are fixed, so that the same runs give the same file.
    with plt.rc_context({"svg.fonttype": "none", "svg.hashsalt": "atlas"}):
        figure.savefig(path, format="svg", metadata={"Date": None})


def page(points, options):
    """The page between its words: those of an older page around the table stay."""
    begin, end = "<!-- made by scripts/benchmark/atlas.py -->", "<!-- end -->"
    text = options.page.read_text() if options.page.exists() else f"# The atlas\n\n{begin}\n{end}\n"
    if begin not in text or end not in text:
        raise SystemExit(f"{options.page} has no lines {begin} and {end} between which the table goes")
    before, rest = text.split(begin, 1)
    after = rest.split(end, 1)[1]
    return f"{before}{begin}\n{table(points)}\n{end}{after}"


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    for split in SETS:
        parser.add_argument(
            f"--{split}",
            nargs="+",
            required=split == "eval",
            default=[],
            type=named,
            metavar="NAME=RUNS[,RUNS]",
            help=f"settings and their runs on the pairs of {split}",
        )
    parser.add_argument("--page", required=True, type=Path, help="page whose table is made anew")
    parser.add_argument("--picture", required=True, type=Path, help="SVG file")
    return parser.parse_args()


if __name__ == "__main__":
    main()
