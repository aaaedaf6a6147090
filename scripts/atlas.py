#!/usr/bin/env python3
"""The atlas: success against processor time, as settings move, on two sets of benchmark pairs, as a page and a picture.

    python3 scripts/atlas.py --train NAME=RUNS [NAME=RUNS ...] --eval NAME=RUNS [NAME=RUNS ...] --page docs/atlas.md --picture docs/images/atlas.svg

Each RUNS is the --out folder (or several, with commas between them) of a `scripts/benchmark.py` run; a setting has the same NAME in both sets. Pairs that all settings of a set hold
are compared, each setting over the turns that it has. Success is the share of pairs with an acceptable pose among the first N, poses ranking, with
its 95% interval by bootstrap over pairs; time is the mean of CPU seconds a run. The docking benchmark's manifest has MEGADOCK's
figures for the pairs of `eval`; they are a point of their own.

Needs Python 3.9 or later and nothing else.
"""

import argparse
import csv
import html
import math
import random
import statistics
from pathlib import Path

from compare import DEPTHS, named, read

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
        points += settings(split, runs)
    points += megadock(options.eval[0][1][0] / "poses.csv")
    write(options.picture, picture(points))
    write(options.page, page(points, options))
    print(table(points))


def settings(split, runs):
    """Each setting of a set as a point."""
    shared = sorted(set.intersection(*({pair for pair, _ in rows} for rows in runs.values())))
    if not shared:
        raise SystemExit(f"no pair is in every run of {split}")
    points = []
    for name, rows in runs.items():
        by_pair = [[row for (pair, _), row in rows.items() if pair == wanted] for wanted in shared]
        found = [
            [statistics.fmean(row[COLUMN] <= depth for row in pair) for pair in by_pair] for depth in DEPTHS
        ]
        seconds = statistics.fmean(statistics.fmean(row["cpu_seconds"] for row in pair) for pair in by_pair)
        turns = sorted({len(pair) for pair in by_pair})
        points.append(point(split, name, found, seconds, "-".join(str(count) for count in (turns[0], turns[-1])[: len(turns)])))
    return points


def megadock(path):
    """MEGADOCK's point, of the figures that came with the benchmark."""
    with open(path, newline="") as file:
        rows = {row["id"]: row for row in csv.DictReader(file) if row["megadock_cpu_s"]}
    if not rows:
        return []
    ranks = [float(row["megadock_first_acceptable_rank"] or math.inf) for row in rows.values()]
    found = [[float(rank <= depth) for rank in ranks] for depth in DEPTHS]
    seconds = statistics.fmean(float(row["megadock_cpu_s"]) for row in rows.values())
    return [point("MEGADOCK", "MEGADOCK 4.1.3", found, seconds, 1)]


def point(split, name, found, seconds, turns):
    source = random.Random(1)
    count = len(found[0])
    draws = [[source.randrange(count) for _ in range(count)] for _ in range(RESAMPLES)]

    def share(values):
        means = sorted(sum(values[index] for index in draw) / count for draw in draws)
        return sum(values) / count, means[int(0.025 * (RESAMPLES - 1))], means[int(0.975 * (RESAMPLES - 1))]

    return {
        "set": split,
        "name": name,
        "seconds": seconds,
        "pairs": count,
        "turns": turns,
        "shares": [share(values) for values in found],
    }


def table(points):
    head = "| set | setting | pairs | turns | CPU s | " + " | ".join(f"top {depth}" for depth in DEPTHS) + " |"
    lines = [head, "|---" * (5 + len(DEPTHS)) + "|"]
    for p in points:
        cells = [f"{100 * mean:.0f} [{100 * low:.0f}, {100 * high:.0f}]" for mean, low, high in p["shares"]]
        split = "eval" if p["set"] == "MEGADOCK" else p["set"]
        lines.append(f"| {split} | {p['name']} | {p['pairs']} | {p['turns']} | {p['seconds']:.1f} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def picture(points):
    """A panel for each depth; a setting's number stands beside its point."""
    names = list(dict.fromkeys(p["name"] for p in points if p["set"] != "MEGADOCK"))
    low = min(p["seconds"] for p in points) / 1.3
    high = max(p["seconds"] for p in points) * 1.3
    width, height = PANEL
    total_width = 2 * (LEFT + width) + 30
    legend_top = TOP + 2 * (height + GAP) - 16
    total_height = legend_top + 18 * (1 + (len(names) + 1) // 2) + 30

    def across(seconds):
        return width * math.log(seconds / low) / math.log(high / low)

    marks = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{total_width}" height="{total_height}" '
        f'viewBox="0 0 {total_width} {total_height}" font-family="sans-serif" font-size="12">',
        f'<rect width="{total_width}" height="{total_height}" fill="white"/>',
    ]
    for index, depth in enumerate(DEPTHS):
        x0 = LEFT + (index % 2) * (LEFT + width)
        y0 = TOP + (index // 2) * (height + GAP)
        marks.append(f'<text x="{x0}" y="{y0 - 12}" font-weight="bold">An acceptable pose among the first {depth}</text>')
        for percent in range(0, 101, 20):
            y = y0 + height * (1 - percent / 100)
            marks.append(f'<line x1="{x0}" y1="{y:.1f}" x2="{x0 + width}" y2="{y:.1f}" stroke="#ddd"/>')
            marks.append(f'<text x="{x0 - 6}" y="{y + 4:.1f}" text-anchor="end">{percent}%</text>')
        for tick in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000):
            if low <= tick <= high:
                x = x0 + across(tick)
                marks.append(f'<line x1="{x:.1f}" y1="{y0}" x2="{x:.1f}" y2="{y0 + height}" stroke="#ddd"/>')
                marks.append(f'<text x="{x:.1f}" y="{y0 + height + 16}" text-anchor="middle">{tick}</text>')
        marks.append(f'<rect x="{x0}" y="{y0}" width="{width}" height="{height}" fill="none" stroke="#222"/>')
        marks.append(f'<text x="{x0 + width / 2}" y="{y0 + height + 34}" text-anchor="middle">CPU seconds a pair</text>')
        for p in points:
            colour = COLOURS[p["set"]]
            mean, bottom, top = p["shares"][index]
            x, y = x0 + across(p["seconds"]), y0 + height * (1 - mean)
            # Intervals of the two sets would hide each other.
            x += {"train": -1.5, "eval": 1.5}.get(p["set"], 0)
            marks.append(
                f'<line x1="{x:.1f}" y1="{y0 + height * (1 - bottom):.1f}" x2="{x:.1f}" '
                f'y2="{y0 + height * (1 - top):.1f}" stroke="{colour}" stroke-opacity="0.25"/>'
            )
            if p["set"] == "MEGADOCK":
                marks.append(f'<path d="M{x - 5:.1f} {y - 5:.1f}l10 10m0 -10l-10 10" stroke="{colour}" stroke-width="2"/>')
                marks.append(f'<text x="{x - 9:.1f}" y="{y + 4:.1f}" text-anchor="end">MEGADOCK</text>')
            else:
                marks.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="4" fill="{colour}"/>')
                side, anchor = ((-7, "end"), (7, "start"))[p["set"] == "eval"]
                number = names.index(p["name"]) + 1
                marks.append(
                    f'<text x="{x + side:.1f}" y="{y + 4:.1f}" fill="{colour}" text-anchor="{anchor}">{number}</text>'
                )
    y = legend_top
    for place, split in enumerate(SETS):
        pairs = next(p["pairs"] for p in points if p["set"] == split)
        x = LEFT + 160 * place
        marks.append(f'<circle cx="{x + 4}" cy="{y - 4}" r="4" fill="{COLOURS[split]}"/>')
        marks.append(f'<text x="{x + 14}" y="{y}">{split}, {pairs} pairs</text>')
    for index, name in enumerate(names):
        x, row = LEFT + (LEFT + width) * (index % 2), y + 20 + 18 * (index // 2)
        marks.append(f'<text x="{x}" y="{row}">{index + 1}: {html.escape(name)}</text>')
    return "\n".join(marks + ["</svg>"]) + "\n"


def page(points, options):
    """The page between its words: those of an older page around the table stay."""
    begin, end = "<!-- made by scripts/atlas.py -->", "<!-- end -->"
    text = options.page.read_text() if options.page.exists() else f"# The atlas\n\n{begin}\n{end}\n"
    if begin not in text or end not in text:
        raise SystemExit(f"{options.page} has no lines {begin} and {end} between which the table goes")
    before, rest = text.split(begin, 1)
    after = rest.split(end, 1)[1]
    return f"{before}{begin}\n{table(points)}\n{end}{after}"


def write(path, text):
    partial = path.with_name(path.name + ".partial")
    partial.write_text(text)
    partial.replace(path)


def parse_arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    for split in SETS:
        parser.add_argument(f"--{split}", nargs="+", required=True, type=named, metavar="NAME=RUNS[,RUNS]", help=f"settings and their runs on the pairs of {split}")
    parser.add_argument("--page", required=True, type=Path, help="page whose table is made anew")
    parser.add_argument("--picture", required=True, type=Path, help="SVG file")
    return parser.parse_args()


if __name__ == "__main__":
    main()
