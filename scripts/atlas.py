#!/usr/bin/env python3
"""The atlas: success against processor time, as settings move, on one or two sets of benchmark pairs, as a page and a picture.

    python3 scripts/atlas.py [--train NAME=RUNS [NAME=RUNS ...]] --eval NAME=RUNS [NAME=RUNS ...] --page docs/atlas.md --picture docs/images/atlas.svg

Each RUNS is the --out folder (or several, with commas between them) of a `scripts/benchmark.py` run; a setting has the same
NAME in both sets. Pairs that all settings of a set hold are compared, each setting over the turns that it has. Success is the
share of pairs with an acceptable pose among the first N, poses ranking, with its 95% interval by bootstrap over pairs; time is
the mean of CPU seconds a run. The docking benchmark's manifest has MEGADOCK's figures for the pairs of `eval`; they are a
point of their own.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import csv
import math
import statistics
from pathlib import Path

from compare import DEPTHS, draw_pairs, interval, named, read
from marks import cross, disc, frame, line, sheet, text
from whole_file import write

RESAMPLES = 10000
COLUMN = "first_acceptable_rank"
SETS = ("train", "eval")
COLOURS = {"train": "#0072b2", "eval": "#d55e00", "MEGADOCK": "#222222"}
PANEL, LEFT, TOP, GAP = (330, 250), 62, 40, 92


def main():
    options = parse_arguments()
    points = []
    for split in SETS:
        runs = {name: read(folders) for name, folders in getattr(options, split)}
        if runs:
            points += settings(split, runs)
            pairs = shared_pairs(split, runs)
    points += megadock(options.eval[0][1], pairs)
    write(options.picture, picture(points))
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
        found = [
            [statistics.fmean(row[COLUMN] <= depth for row in pair) for pair in by_pair] for depth in DEPTHS
        ]
        seconds = statistics.fmean(statistics.fmean(row["cpu_seconds"] for row in pair) for pair in by_pair)
        turns = sorted({len(pair) for pair in by_pair})
        points.append(point(split, name, found, seconds, "-".join(map(str, turns))))
    return points


def megadock(folders, pairs):
    """MEGADOCK's point, of the figures for some pairs that came with the benchmark."""
    rows = {}
    for folder in folders:
        with open(folder / "poses.csv", newline="") as file:
            rows |= {row["id"]: row for row in csv.DictReader(file) if row["id"] in pairs and row.get("megadock_cpu_s")}
    if not rows:
        return []
    ranks = [float(row["megadock_first_acceptable_rank"] or math.inf) for row in rows.values()]
    found = [[float(rank <= depth) for rank in ranks] for depth in DEPTHS]
    seconds = statistics.fmean(float(row["megadock_cpu_s"]) for row in rows.values())
    return [point("MEGADOCK", "MEGADOCK 4.1.3", found, seconds, 1)]


def point(split, name, found, seconds, turns):
    count = len(found[0])
    draws = draw_pairs(count, RESAMPLES)
    shares = []
    for values in found:
        low, high = interval(values, draws)
        shares.append((sum(values) / count, low / count, high / count))
    return {"set": split, "name": name, "seconds": seconds, "pairs": count, "turns": turns, "shares": shares}


def table(points):
    head = "| set | setting | pairs | turns | CPU s | " + " | ".join(f"top {depth}" for depth in DEPTHS) + " |"
    lines = [head, "|---" * (5 + len(DEPTHS)) + "|"]
    for p in points:
        cells = [f"{100 * mean:.0f} [{100 * low:.0f}, {100 * high:.0f}]" for mean, low, high in p["shares"]]
        split = "eval" if p["set"] == "MEGADOCK" else p["set"]
        lines.append(f"| {split} | {p['name']} | {p['pairs']} | {p['turns']} | {p['seconds']:.1f} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def picture(points):
    """A panel for each depth, the key below them; a setting's number stands beside its point."""
    names = list(dict.fromkeys(p["name"] for p in points if p["set"] != "MEGADOCK"))
    low = min(p["seconds"] for p in points) / 1.3
    high = max(p["seconds"] for p in points) * 1.3
    width, height = PANEL
    legend = TOP + 2 * (height + GAP) - 16
    total = (2 * (LEFT + width) + 30, legend + 18 * (1 + (len(names) + 1) // 2) + 30)
    marks = []
    for index, depth in enumerate(DEPTHS):
        x0 = LEFT + (index % 2) * (LEFT + width)
        y0 = TOP + (index // 2) * (height + GAP)

        def place(seconds, share):
            return x0 + width * math.log(seconds / low) / math.log(high / low), y0 + height * (1 - share)

        marks += axes(x0, y0, (low, high), place)
        marks.append(text(x0, y0 - 16, f"An acceptable pose among the first {depth}"))
        for p in points:
            marks += marks_of(p, index, names, place)
    for number, split in enumerate(dict.fromkeys(p["set"] for p in points if p["set"] != "MEGADOCK")):
        pairs = next(p["pairs"] for p in points if p["set"] == split)
        x = LEFT + 200 * number
        marks += [disc(x + 4, legend, COLOURS[split]), text(x + 14, legend, f"{split}, {pairs} pairs")]
    for index, name in enumerate(names):
        x, y = LEFT + (LEFT + width) * (index % 2), legend + 22 + 18 * (index // 2)
        marks.append(text(x, y, f"{index + 1}: {name}"))
    return sheet(*total, marks)


def axes(x0, y0, seconds, place):
    width, height = PANEL
    low, high = seconds
    marks = []
    for percent in range(0, 101, 20):
        _, y = place(low, percent / 100)
        marks += [line((x0, y), (x0 + width, y)), text(x0 - 6, y, f"{percent}%", "end")]
    for tick in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000):
        if low <= tick <= high:
            x, _ = place(tick, 0)
            marks += [line((x, y0), (x, y0 + height)), text(x, y0 + height + 14, str(tick), "middle")]
    words = text(x0 + width / 2, y0 + height + 34, "CPU seconds a pair", "middle")
    return marks + [frame(x0, y0, width, height), words]


def marks_of(p, index, names, place):
    """A point's interval, its sign and what it is."""
    colour = COLOURS[p["set"]]
    mean, bottom, top = p["shares"][index]
    x, y = place(p["seconds"], mean)
    # Intervals of the two sets would hide each other.
    x += {"train": -1.5, "eval": 1.5}.get(p["set"], 0)
    ends = [(x, place(1, share)[1]) for share in (bottom, top)]
    interval_of_point = line(*ends, colour, ' stroke-opacity="0.25"')
    if p["set"] == "MEGADOCK":
        return [interval_of_point, cross(x, y, colour), text(x - 9, y, "MEGADOCK", "end")]
    side, anchor = ((-7, "end"), (7, "start"))[p["set"] == "eval"]
    number = str(names.index(p["name"]) + 1)
    return [interval_of_point, disc(x, y, colour), text(x + side, y, number, anchor, fill=colour)]


def page(points, options):
    """The page between its words: those of an older page around the table stay."""
    begin, end = "<!-- made by scripts/atlas.py -->", "<!-- end -->"
    text = options.page.read_text() if options.page.exists() else f"# The atlas\n\n{begin}\n{end}\n"
    if begin not in text or end not in text:
        raise SystemExit(f"{options.page} has no lines {begin} and {end} between which the table goes")
    before, rest = text.split(begin, 1)
    after = rest.split(end, 1)[1]
    return f"{before}{begin}\n{table(points)}\n{end}{after}"


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    for split in SETS:
        parser.add_argument(f"--{split}", nargs="+", required=split == "eval", default=[], type=named, metavar="NAME=RUNS[,RUNS]",
                            help=f"settings and their runs on the pairs of {split}")
    parser.add_argument("--page", required=True, type=Path, help="page whose table is made anew")
    parser.add_argument("--picture", required=True, type=Path, help="SVG file")
    return parser.parse_args()


if __name__ == "__main__":
    main()
